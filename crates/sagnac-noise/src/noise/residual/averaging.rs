//! Allan variance of the record over that of the model, octave by octave.
//!
//! The variance at each τ is a scaled χ² with the degrees of freedom of the whole description. Neighbouring octaves
//! share data, and fitted parameters follow the record: both are in the covariance of the scores.

use super::super::composite::{Composite, Described};
use super::super::data::DeviationPoint;
use super::grid::Grid;
use super::null::probability_of_largest;
use super::spectrum::log_gradients;
use super::view::{Departure, Judged, View};
use crate::noise::identification::misfit::normal_score;
use nalgebra::DMatrix;

/// Degrees of freedom below which an octave is not judged.
const LEAST_EDF: f64 = 6.0;
/// Largest averaging time judged, as a share of the record.
const LARGEST_SHARE: f64 = 0.125;
/// Share of its variance that the fit leaves an octave at least, for the covariance of the fit is an estimate.
const LEAST_LEFT: f64 = 0.5;
/// Score from which a neighbouring octave belongs to the same departure.
const MIN_NEIGHBOUR_SCORE: f64 = 2.0;
/// Lags per averaging time in the sum of squared covariances.
const PER_TAU: f64 = 16.0;
/// Averaging times up to which covariances are summed.
const COVARIANCE_SPAN_TAUS: f64 = 12.0;
/// Decay times of the slowest process up to which covariances are summed.
const COVARIANCE_SPAN_DECAYS: f64 = 3.0;
/// Most lags summed for such a process.
const MOST_LAGS: f64 = 20_000.0;

/// One octave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OctaveRatio {
    /// Averaging time, s.
    pub tau_s: f64,
    /// Allan variance of the record over that of the model.
    pub ratio: f64,
    /// Degrees of freedom under the model.
    pub edf: f64,
    /// Standard normal score under a correct, fitted model.
    pub score: f64,
}

/// Equivalent degrees of freedom of an overlapping Allan variance under a whole description: M² r₀²/Σ (M − |l|) r_l²
/// over the covariances r of its terms.
pub fn degrees_of_freedom(model: &Composite, point: &DeviationPoint, tau0_s: f64) -> f64 {
    let tau_s = point.m as f64 * tau0_s;
    let noise =
        Composite { terms: model.terms.with(crate::noise::data::NoiseType::RateRamp, 0.0), ..model.clone() };
    // Minus half the variance of an increment of angle over t: the generalised autocovariance of the angle.
    let angle = |t: f64| {
        let t = t.abs();
        if t < 0.5 * tau0_s { 0.0 } else { -0.5 * t * t * noise.mean_variance(t, tau0_s) }
    };
    let term = |t: f64| {
        6.0 * angle(t) - 4.0 * (angle(t - tau_s) + angle(t + tau_s))
            + angle(t - 2.0 * tau_s)
            + angle(t + 2.0 * tau_s)
    };
    let stride = (point.stride.max(1) as f64).max((point.m as f64 / PER_TAU).floor());
    let terms = (point.terms as f64 * point.stride.max(1) as f64 / stride).max(1.0);
    let first = term(0.0);
    let slowest_s =
        noise.quasi_periodic.iter().chain(&noise.markov).map(|d| d.decay_time_s).fold(0.0, f64::max);
    // A line never decays.
    let slowest_s = if noise.lines.is_empty() { slowest_s } else { f64::INFINITY };
    let span = (COVARIANCE_SPAN_TAUS * point.m as f64)
        .max((COVARIANCE_SPAN_DECAYS * slowest_s / tau0_s).min(MOST_LAGS * stride));
    let most = (span / stride).min(terms - 1.0).max(0.0) as u64;
    let mut sum = terms;
    for lag in 1..=most {
        let r = term(lag as f64 * stride * tau0_s) / first;
        sum += 2.0 * (terms - lag as f64) * r * r;
    }
    let edf = terms * terms / sum;
    if edf.is_finite() && edf > 0.0 { edf } else { 0.0 }
}

/// The octaves that can be judged.
pub(super) fn octaves(
    points: &[DeviationPoint],
    described: &Described,
    length_s: f64,
    tau0_s: f64,
) -> Vec<(OctaveRatio, f64)> {
    let judged: Vec<(&DeviationPoint, f64)> = points
        .iter()
        .filter(|p| {
            p.m.is_power_of_two() && p.deviation > 0.0 && p.m as f64 * tau0_s <= LARGEST_SHARE * length_s
        })
        .map(|p| (p, degrees_of_freedom(&described.model, p, tau0_s)))
        .filter(|(_, edf)| *edf >= LEAST_EDF)
        .collect();
    let variances = |model: &Composite| -> Vec<f64> {
        judged.iter().map(|(p, _)| model.allan_variance(p.m as f64 * tau0_s, tau0_s)).collect()
    };
    judged
        .iter()
        .zip(variances(&described.model))
        .map(|((p, edf), expected)| {
            let tau_s = p.m as f64 * tau0_s;
            (OctaveRatio { tau_s, ratio: p.deviation.powi(2) / expected, edf: *edf, score: 0.0 }, p.m as f64)
        })
        .filter(|(o, _)| o.ratio.is_finite())
        .collect()
}

/// Scores the octaves and finds the one that departs most, with its neighbours.
pub(super) fn judge(
    points: &[DeviationPoint],
    described: &Described,
    grid: &Grid,
    tau0_s: f64,
) -> (Vec<OctaveRatio>, Option<Judged>) {
    let octaves = octaves(points, described, grid.length_s, tau0_s);
    let count = octaves.len();
    let mut ratios: Vec<OctaveRatio> = octaves.iter().map(|o| o.0).collect();
    if count < 3 {
        return (ratios, None);
    }
    let taus: Vec<f64> = ratios.iter().map(|o| o.tau_s).collect();
    let shares: Vec<Vec<f64>> = octaves.iter().map(|(_, m)| grid.allan_shares(*m, tau0_s)).collect();
    let product = |i: usize, j: usize| -> f64 {
        let pairs = shares[i].iter().zip(&shares[j]).zip(&grid.dof);
        pairs.map(|((a, b), dof)| 2.0 * a * b / dof).sum()
    };
    // The diagonal is that of the terms really summed: ends of the record count less in them.
    let scale: Vec<f64> = (0..count).map(|i| (2.0 / ratios[i].edf / product(i, i)).sqrt()).collect();
    let gradient =
        log_gradients(described, |model| taus.iter().map(|t| model.allan_variance(*t, tau0_s)).collect());
    let parameters = gradient.len();
    let explained = inverse(grid.information());
    let covariance = DMatrix::from_fn(count, count, |i, j| {
        let mut fit = 0.0;
        for p in 0..parameters {
            for q in 0..parameters {
                fit += gradient[p][i] * explained[(p, q)] * gradient[q][j];
            }
        }
        scale[i] * scale[j] * product(i, j) - fit
    });
    let deviation: Vec<f64> =
        (0..count).map(|i| covariance[(i, i)].max(LEAST_LEFT * 2.0 / ratios[i].edf).sqrt()).collect();
    for (o, deviation) in ratios.iter_mut().zip(&deviation) {
        o.score = normal_score(o.ratio * o.edf, o.edf) * (2.0 / o.edf).sqrt() / deviation;
    }
    let correlation = DMatrix::from_fn(count, count, |i, j| {
        if i == j { 1.0 } else { (covariance[(i, j)] / (deviation[i] * deviation[j])).clamp(-1.0, 1.0) }
    });
    let Some(worst) = (0..count).max_by(|a, b| ratios[*a].score.abs().total_cmp(&ratios[*b].score.abs()))
    else {
        return (ratios, None);
    };
    let statistic = ratios[worst].score.abs();
    if !statistic.is_finite() {
        return (ratios, None);
    }
    if correlation.iter().any(|v| !v.is_finite()) {
        return (ratios, None);
    }
    let p_value = probability_of_largest(statistic, correlation);
    let same = |o: &OctaveRatio| o.score * ratios[worst].score.signum() >= MIN_NEIGHBOUR_SCORE;
    let from = (0..worst).rev().take_while(|i| same(&ratios[*i])).last().unwrap_or(worst);
    let to = (worst + 1..count).take_while(|i| same(&ratios[*i])).last().unwrap_or(worst);
    let judged = Judged {
        view: View::AveragingTime,
        statistic,
        p_value,
        departure: Departure {
            from: ratios[from].tau_s,
            to: ratios[to].tau_s,
            excess: ratios[worst].ratio.sqrt() - 1.0,
        },
    };
    (ratios, Some(judged))
}

/// Inverse of an information matrix; zeros where it has none.
fn inverse(information: DMatrix<f64>) -> DMatrix<f64> {
    let n = information.nrows();
    // Decompositions of an empty matrix, or of one with values that are no numbers, do not end.
    if n == 0 || information.iter().any(|v| !v.is_finite()) {
        return DMatrix::zeros(n, n);
    }
    let scale: Vec<f64> = (0..n)
        .map(|i| if information[(i, i)] > 0.0 { information[(i, i)].sqrt().recip() } else { 0.0 })
        .collect();
    let scaled = DMatrix::from_fn(n, n, |i, j| {
        let v = information[(i, j)] * scale[i] * scale[j];
        if i == j && v == 0.0 { 1.0 } else { v }
    });
    scaled.pseudo_inverse(1e-9).map_or_else(
        |_| DMatrix::zeros(n, n),
        |inverse| DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] * scale[i] * scale[j]),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::model::NoiseModel;

    #[test]
    fn degrees_of_freedom_are_those_of_the_exact_covariance_sum() {
        // White noise, 2049 phase points (integrated rate): published beside the combined algorithm.
        let white = Composite::from(NoiseModel { n: 1.0, ..Default::default() });
        for (m, expected) in [(1u64, 1364.9), (2, 1169.1), (8, 374.6), (64, 45.8)] {
            let point = DeviationPoint { m, terms: 2049 - 2 * m, stride: 1, deviation: 1.0 };
            let edf = degrees_of_freedom(&white, &point, 1.0);
            assert!((edf / expected - 1.0).abs() < 0.02, "{m}: {edf} {expected}");
        }
    }
}
