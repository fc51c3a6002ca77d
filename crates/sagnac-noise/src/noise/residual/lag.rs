//! Autocorrelation of the whitened residual: of the block means, and of single samples from the averaged periodogram
//! where blocks hold several.
//!
//! Source: Box and Pierce, JASA 65 (1970) 1509: fitted parameters take a part of the variance of the first lags.

use super::super::composite::Described;
use super::super::spectral_record::SpectralRecord;
use super::grid::Grid;
use super::null::{Fitted, at_most_bonferroni};
use super::spectrum::ModelSpectrum;
use super::view::{Departure, Judged, View};
use super::whiten::Whitened;
use crate::noise::model::{Bin, Spectral};
use sagnac_fft::{Complex, real_inverse};

/// Lags that are looked at, at most.
const MAX_LAGS: usize = 120;
/// Share of the variance of a lag that the fit must leave.
const LEAST_LEFT: f64 = 0.05;

/// Autocorrelation of a whitened residual, and what a correct model allows.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualCorrelation {
    /// Step of the lags, s.
    pub step_s: f64,
    /// Coefficients at lags 1, 2, …
    pub coefficients: Vec<f64>,
    /// Standard deviation of each under a correct model whose parameters were fitted.
    pub deviation: Vec<f64>,
    /// Probability of a larger departure if the model is right: of the largest lag, and of all together.
    pub p_value: f64,
    /// The larger of the two statistics as a score.
    pub statistic: f64,
    /// Place of the lag that departs most, counted from 1.
    pub worst: usize,
}

fn judged(step_s: f64, coefficients: Vec<f64>, values: f64, grid: &Grid) -> Option<ResidualCorrelation> {
    let lags = coefficients.len();
    if lags < 4 || coefficients.iter().any(|c| !c.is_finite()) {
        return None;
    }
    let root = values.sqrt();
    let gradient: Vec<Vec<f64>> = grid
        .lag_gradients(lags, step_s)
        .into_iter()
        .map(|g| g.into_iter().map(|q| q * root).collect())
        .collect();
    let fitted = Fitted::new(lags, &gradient, &grid.information());
    let variance: Vec<f64> = (0..lags)
        .map(|i| {
            let mut one = vec![0.0; lags];
            one[i] = 1.0;
            fitted.variance(&one)
        })
        .collect();
    let shown = |i: usize, s: f64| if variance[i] > LEAST_LEFT { s / variance[i].sqrt() } else { 0.0 };
    let largest = |s: &[f64]| s.iter().enumerate().map(|(i, v)| shown(i, *v).abs()).fold(0.0, f64::max);
    let squares = |s: &[f64]| s.iter().map(|v| v * v).sum::<f64>();
    let scores: Vec<f64> = coefficients.iter().map(|r| r * root).collect();
    let (one, all) = (largest(&scores), squares(&scores));
    let of_one = at_most_bonferroni(fitted.probability(one, largest), one, lags);
    let of_all = fitted.probability(all, squares);
    let worst =
        (0..lags).max_by(|a, b| shown(*a, scores[*a]).abs().total_cmp(&shown(*b, scores[*b]).abs()))?;
    Some(ResidualCorrelation {
        step_s,
        deviation: variance.iter().map(|v| v.sqrt() / root).collect(),
        coefficients,
        // Two looks at the same lags.
        p_value: (2.0 * of_one.min(of_all)).min(1.0),
        statistic: one,
        worst: worst + 1,
    })
}

/// Of the whitened block means.
pub(super) fn of_blocks(whitened: &Whitened, grid: &Grid) -> Option<ResidualCorrelation> {
    let count = whitened.values.len();
    let lags = MAX_LAGS.min(count / 10);
    let found = super::super::autocorrelation::of_series(&whitened.values, lags)?;
    // The biased estimate is small by the pairs that a lag lacks, and by the mean that was taken out.
    let n = count as f64;
    let coefficients = found
        .coefficients
        .iter()
        .enumerate()
        .skip(1)
        .map(|(k, r)| (r + 1.0 / n) * (n / (n - k as f64)).sqrt())
        .collect();
    judged(whitened.step_s, coefficients, whitened.modes as f64, grid)
}

/// Of single samples, from the ratio of the averaged periodogram to the model.
pub(super) fn of_samples(
    record: &SpectralRecord<'_>,
    described: &Described,
    grid: &Grid,
) -> Option<ResidualCorrelation> {
    let welch = record.welch.filter(|w| record.blocks.block_len > 1 && w.density.len() > 64)?;
    let tau0_s = record.tau0_s;
    let step_hz = 1.0 / (welch.segment_len as f64 * tau0_s);
    let spectrum = ModelSpectrum { model: &described.model, tau0_s };
    let masks = record.masks();
    let last = welch.segment_len / 2;
    let (mut sum, mut used) = (0.0, 0usize);
    let mut ratios: Vec<Complex<f64>> = (0..=last)
        .map(|k| {
            let frequency_hz = k as f64 * step_hz;
            // The lowest bins lost power with the mean of each segment; the last one has one degree of freedom.
            if k < 3 || k == last || masks.iter().any(|m| m.hides(frequency_hz, 2.0 * step_hz, tau0_s, true))
            {
                return Complex::new(0.0, 0.0);
            }
            let bin = Bin { frequency_hz, tau_s: tau0_s, filling: 1.0, mode: 0, blocks: 0, segment: 0 };
            let ratio = welch.density.get(k).copied().unwrap_or(0.0) * tau0_s / spectrum.density(&bin);
            (sum, used) = (sum + ratio, used + 1);
            Complex::new(ratio, 0.0)
        })
        .collect();
    if used < 32 || sum.is_nan() || sum <= 0.0 {
        return None;
    }
    let mean = sum / used as f64;
    for r in ratios.iter_mut().filter(|r| r.re != 0.0) {
        r.re = r.re / mean - 1.0;
    }
    let inverse = real_inverse(welch.segment_len);
    let mut time = inverse.make_output_vec();
    if inverse.process(&mut ratios, &mut time).is_err() {
        return None;
    }
    let lags = MAX_LAGS.min(welch.segment_len / 16);
    let coefficients: Vec<f64> =
        time.iter().skip(1).take(lags).map(|c| c / welch.segment_len as f64).collect();
    let values = welch.averages_in_sums * used as f64;
    judged(tau0_s, coefficients, values, grid)
}

/// The view of lags: of single samples where there is such a look, and of block means.
pub(super) fn judge(found: &[&ResidualCorrelation]) -> Option<Judged> {
    let worst = found.iter().min_by(|a, b| a.p_value.total_cmp(&b.p_value))?;
    let at = worst.worst as f64 * worst.step_s;
    Some(Judged {
        view: View::Lag,
        statistic: worst.statistic,
        p_value: (found.len() as f64 * worst.p_value).min(1.0),
        departure: Departure {
            from: at,
            to: at,
            excess: worst.coefficients.get(worst.worst - 1).copied().unwrap_or(0.0),
        },
    })
}
