//! Autocorrelation of the record and, below each, of what the model leaves: at short lags (full rate) and at long lags
//! (block means). Flicker, Markov noise and disturbances show here more clearly than in the Allan deviation.

use super::draw;
use crate::estimate::normal_quantile;
use crate::figure::{Figure, Panel, Style};
use crate::i18n::note;
use crate::measurand::GyroEvidence;
use crate::noise::autocorrelation::{Autocorrelation, of_series, of_spectrum};
use crate::noise::residual::ResidualCorrelation;

/// Lags shown at the full rate.
const SHORT_LAGS: usize = 60;
/// Lags shown of the block means.
const LONG_LAGS: usize = 200;
/// Block means that the long lags are computed from at least.
const MIN_BLOCKS: usize = 64;

/// Share of the axis of the record that the lags of the residual fill at least, to stand below it.
const MIN_AXIS_SHARE: f64 = 0.4;

/// Draws the autocorrelation; `None` when the record is too short or constant.
pub fn figure(gyro: &GyroEvidence) -> Option<Figure> {
    let blocks = gyro.blocks();
    let means = blocks.about_first();
    let full_rate = if blocks.block_len == 1 {
        of_series(&means, SHORT_LAGS.min(means.len() / 4))
    } else {
        of_spectrum(gyro.spectrum(), SHORT_LAGS)
    };
    let (mut panels, mut remarks) = (Vec::new(), Vec::new());
    if let Some(acf) = full_rate.filter(|a| a.coefficients.len() > 4) {
        panels.push(panel(&acf, gyro.tau0_s, "axis.lag", true));
        let fit = &gyro.goodness;
        let left = if blocks.block_len == 1 { &fit.correlation } else { &fit.sample_correlation };
        let lags = acf.coefficients.len() - 1;
        panels.extend(left.as_ref().map(|left| residual(left, lags, "axis.lag")));
    }
    // The long panel spans about a quarter of the record in at most LONG_LAGS steps.
    let merge = (means.len() / (4 * LONG_LAGS)).max(1);
    if merge * blocks.block_len as usize > 1 && means.len() / merge >= MIN_BLOCKS {
        let coarse: Vec<f64> = means.chunks(merge).map(mean_of_present).collect();
        if let Some(acf) = of_series(&coarse, LONG_LAGS.min(coarse.len() / 4)) {
            let block_s = gyro.tau0_s * blocks.block_len as f64 * merge as f64;
            panels.push(panel(&acf, block_s, "axis.lag_of_means", false));
            remarks.push(note!("figure.remark.autocorrelation_blocks", seconds = block_s));
            if let (Some(left), true) = (&gyro.goodness.correlation, blocks.block_len > 1) {
                let lags = left.coefficients.len();
                // Far shorter lags would be one stroke at the edge of the axis above.
                let spans =
                    lags as f64 * left.step_s >= MIN_AXIS_SHARE * (acf.coefficients.len() as f64 * block_s);
                let lag = if spans { "axis.lag_of_means" } else { "lag_axis.of_residual" };
                panels.push(residual(left, lags, lag));
                remarks.push(note!("figure.fit.residual_blocks", seconds = left.step_s));
            }
        }
    }
    (!panels.is_empty()).then(|| {
        draw::figure(
            "autocorrelation",
            "figure.title.autocorrelation",
            &gyro.channel,
            gyro.several,
            panels,
            remarks,
        )
    })
}

/// What the model leaves, with the band that a correct model keeps: narrower at lags that the fit follows.
fn residual(left: &ResidualCorrelation, lags: usize, lag: &'static str) -> Panel {
    let at = |i: usize| (i + 1) as f64 * left.step_s;
    let points: Vec<(f64, f64)> =
        left.coefficients.iter().take(lags).enumerate().map(|(i, r)| (at(i), *r)).collect();
    let half = normal_quantile(0.975);
    let band =
        left.deviation.iter().take(lags).enumerate().map(|(i, d)| (at(i), -half * d, half * d)).collect();
    draw::panel(
        draw::linear(lag, "s"),
        draw::linear("figure.fit.correlation_left", ""),
        vec![
            draw::band(band, Style::Muted, "figure.fit.correct_model"),
            draw::line(points.clone(), Style::SecondData, "figure.fit.whitened"),
            draw::points(points, Style::SecondData, "figure.fit.whitened"),
        ],
    )
}

fn mean_of_present(values: &[f64]) -> f64 {
    let (sum, n) = values.iter().filter(|v| v.is_finite()).fold((0.0, 0u32), |(sum, n), v| (sum + v, n + 1));
    if n == 0 { f64::NAN } else { sum / f64::from(n) }
}

fn panel(acf: &Autocorrelation, step_s: f64, lag: &'static str, marked: bool) -> Panel {
    let points: Vec<(f64, f64)> =
        acf.coefficients.iter().enumerate().skip(1).map(|(k, r)| (k as f64 * step_s, *r)).collect();
    let last = points.last().map_or(step_s, |p| p.0);
    let band = acf.white_band;
    let mut layers = vec![
        draw::band(vec![(0.0, -band, band), (last, -band, band)], Style::Muted, "figure.legend.white_band"),
        draw::line(points.clone(), Style::Data, "figure.legend.data"),
    ];
    if marked {
        layers.push(draw::points(points, Style::Data, "figure.legend.data"));
    }
    draw::panel(draw::linear(lag, "s"), draw::linear("axis.autocorrelation", ""), layers)
}
