//! A claim identified from a simulated recording: what `explain --simulation` holds a recording against.
//!
//! The mean is fitted by generalised least squares on the columns, the noise is identified from what it leaves, and both
//! once more. How well each value is known becomes the uncertainty of the claim.

mod mean;
mod noise;

use super::Progress;
use crate::claim::{Claim, Uncertainty};
use crate::effect::Column;
use crate::message::{Note, note};
use crate::noise::model::NoiseModel;
use crate::series::Series;

/// Fewest rows from which a claim is identified.
const MIN_ROWS: usize = 256;
/// Rounds of mean and noise.
const MEAN_NOISE_ROUNDS: u64 = 2;

/// Identifies a claim from a recording.
///
/// # Errors
/// Fails when the recording is too short, or when all its samples are equal.
pub fn identify(series: &Series, progress: &mut dyn FnMut(Progress)) -> Result<Claim, Note> {
    let rows = series.rate_deg_h.len();
    if rows < MIN_ROWS {
        return Err(note!("explain.error.short", rows, needed = MIN_ROWS));
    }
    let mut step = |done| {
        progress(Progress { doing: "explain.progress.identifying", done, total: 2 * MEAN_NOISE_ROUNDS })
    };
    step(0);
    let columns = mean::Columns::new(series);
    let mut fitted = columns.fit(series, None);
    step(1);
    if !has_noise(series, &fitted.residual) {
        return Err("explain.error.no_noise".into());
    }
    let mut found = noise::identify(series, &fitted.residual);
    for round in 1..MEAN_NOISE_ROUNDS {
        step(2 * round);
        fitted = columns.fit(series, Some(&found.composite));
        step(2 * round + 1);
        found = noise::identify(series, &fitted.residual);
    }
    step(2 * MEAN_NOISE_ROUNDS);
    let [n, b, k, q] = [found.n, found.b, found.k, found.q];
    if [n, b, k, q].iter().all(|c| c.value <= 0.0 && c.at_most <= 0.0) {
        return Err("explain.error.no_noise".into());
    }
    Ok(claim(series, &fitted, &found))
}

/// True for a residual beyond the rounding of the arithmetic.
fn has_noise(series: &Series, residual: &[f64]) -> bool {
    const ROUNDING_SHARE: f64 = 1e-11;
    let largest = |values: &[f64]| values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let columns = series.columns.get(&Column::TableRate).map_or(0.0, |rate| 3600.0 * largest(rate));
    largest(residual) > ROUNDING_SHARE * largest(&series.rate_deg_h).max(columns)
}

fn claim(series: &Series, mean: &mean::FittedMean, noise: &noise::FittedNoise) -> Claim {
    let [n, b, k, q] = [noise.n, noise.b, noise.k, noise.q];
    // No claim states a deviation beyond this: it knows nothing of the value.
    let deviation = |d: f64| if d.is_finite() { d.min(1e6) } else { 1e6 };
    Claim {
        case: String::new(),
        description: Default::default(),
        sample_rate_hz: 1.0 / series.sample_interval_s,
        columns: Some(series.columns.keys().copied().collect::<Vec<Column>>()),
        noise: NoiseModel { n: n.value, b: b.value, k: k.value, r: 0.0, q: q.value },
        quantization_lsb_arcsec: q.value * 12f64.sqrt(),
        mean: mean.claimed,
        uncertainty: Uncertainty {
            n_rel: deviation(n.relative),
            b_rel: deviation(b.relative),
            k_rel: deviation(k.relative),
            n_at_most_deg_rt_h: deviation(n.at_most),
            b_at_most_deg_h: deviation(b.at_most),
            k_at_most_deg_h_rt_h: deviation(k.at_most),
            bias_deg_h: deviation(mean.bias_sd),
            temperature_coefficient_deg_h_per_degc: deviation(mean.temperature_sd),
            scale_factor_ppm: deviation(mean.scale_factor_sd),
            ..Uncertainty::default()
        },
        effects: noise.effects.clone(),
    }
}

#[cfg(test)]
#[path = "identify/tests.rs"]
mod tests;
