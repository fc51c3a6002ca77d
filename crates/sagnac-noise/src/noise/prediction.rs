//! What identified noise predicts for the standard deviation of window means, and how far an observed one may lie from
//! it.
//!
//! The observed s² and the model come from the same record, so their errors are not independent. With an efficient fit
//! the covariance of s² with the predicted E\[s²\] equals the variance of the prediction (Hausman, Econometrica 46,
//! 1978), hence Var\[s² − E\] = Var\[s²\] − Var\[E\]: what the fit took from the record it cannot be tested against.
//! The ratio s²/E is read as χ² with the degrees of freedom of that variance.

use super::composite::{Composite, Described, Line, Part, Propagated};
use super::data::NoiseType;
use super::windows::edf_of_window_std;
use crate::estimate::{Interval, chi_square_quantile};
use crate::numeric::order::SortByNumber;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Share of the scatter of s² that is left to be tested at the least: a fit of few modes knows its own errors only
/// roughly.
const LEAST_LEFT: f64 = 0.06;
/// Share of the variance that a ramp or a line brings into the prediction and that the observed value does not share: the
/// fit weighs the record otherwise than a standard deviation does (set by simulation).
const UNSHARED_VARIANCE_SHARE: f64 = 0.01;
/// The covariance is that of the bound; fits of slow terms reach it to within a factor of 1.09 in the deviation
/// (measured), which is this in the degrees of freedom.
const FIT_EFFICIENCY: f64 = 0.85;

/// How an observed standard deviation stands to the predicted one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Agreement {
    /// The interval of observed over predicted holds 1.
    Consistent,
    /// Observed above: the record holds noise at low frequency that the model lacks.
    #[serde(rename = "missing_low_frequency_term")]
    Above,
    /// Observed below: the two do not belong to the same noise.
    #[serde(rename = "data_mismatch")]
    Below,
}

impl Agreement {
    /// Its id.
    pub fn id(self) -> &'static str {
        match self {
            Agreement::Consistent => "consistent",
            Agreement::Above => "missing_low_frequency_term",
            Agreement::Below => "data_mismatch",
        }
    }
}

/// The share of one part of a model in E\[s²\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// The part.
    pub part: Part,
    /// Its share; all sum to 1.
    pub share: f64,
}

/// What a model predicts for the standard deviation of adjacent window means.
#[derive(Debug, Clone, PartialEq)]
pub struct WindowPrediction {
    /// √E\[s²\], deg/h.
    pub sigma: f64,
    /// Parts with their shares, the largest first.
    pub shares: Vec<Share>,
    /// Standard uncertainty of `sigma` that comes from the parameters, deg/h.
    pub uncertainty: f64,
    /// Degrees of freedom of an observed s² about E\[s²\], noise and phases of lines; infinite where nothing scatters.
    pub scatter_dof: f64,
    /// Degrees of freedom of s²/E where both come from the same record.
    pub ratio_dof: f64,
}

/// The stochastic part of a model: a ramp and lines shift s² and do not scatter it.
fn scattering(model: &Composite) -> Composite {
    model.without_ramp().without_lines()
}

/// Variance of s² from the products of lines with noise, (deg/h)⁴, of which `part` counts for the share of a line's power
/// that window means pass.
fn crossed(
    model: &Composite,
    window_s: f64,
    windows: u64,
    noise_variance: f64,
    part: impl Fn(f64) -> f64,
) -> f64 {
    let of = |line: &Line| {
        let x = PI * line.frequency_hz * window_s;
        let passed = if x.abs() < 1e-9 { 1.0 } else { (x.sin() / x).powi(2) };
        4.0 * 0.5 * line.amplitude_deg_h.powi(2) * passed * part(passed) * noise_variance
    };
    model.lines.iter().map(of).sum::<f64>() / windows.max(1) as f64
}

/// Mean of e^{ikθ} over `n` steps, without its phase.
fn mean_of_turns(angle: f64, n: f64) -> f64 {
    let half = 0.5 * angle;
    // At whole turns the limit, with the sign of the numerator.
    if half.sin().abs() < 1e-9 { (n * half).cos() / half.cos() } else { (n * half).sin() / (n * half.sin()) }
}

/// Variance of s² over the phases of the lines, (deg/h)⁴: E\[s²\] is their mean, and a record has one of them. With D
/// the mean turn from window to window, a line of amplitude A after averaging gives
/// ½ (A²/2 · n/(n − 1))² (D(2θ) − D(θ)²)². It counts where a line beats slowly with the windows or these are few.
fn phased(model: &Composite, window_s: f64, windows: u64) -> f64 {
    let n = windows as f64;
    let of = |line: &Line| {
        let x = PI * line.frequency_hz * window_s;
        let passed = if x.abs() < 1e-9 { 1.0 } else { (x.sin() / x).powi(2) };
        let mean = 0.5 * line.amplitude_deg_h.powi(2) * passed * n / (n - 1.0);
        let turned = mean_of_turns(4.0 * x, n) - mean_of_turns(2.0 * x, n).powi(2);
        0.5 * (mean * turned).powi(2)
    };
    if windows < 2 { 0.0 } else { model.lines.iter().map(of).sum() }
}

impl WindowPrediction {
    /// The prediction for `windows` means over `window_s` of a record of samples over `tau0_s`; `None` below two
    /// windows or for an empty model.
    pub fn of(described: &Described, window_s: f64, windows: u64, tau0_s: f64) -> Option<WindowPrediction> {
        let expected = |m: &Composite| m.expected_variance(window_s, windows, tau0_s).unwrap_or(f64::NAN);
        let Propagated { value: total, standard_uncertainty: u_total } = described.propagate(expected);
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        let part = |p: Part| {
            let share = described.model.part_expected_variance(p, window_s, windows, tau0_s)? / total;
            Some(Share { part: p, share })
        };
        let mut shares = described.model.parts().into_iter().map(part).collect::<Option<Vec<Share>>>()?;
        shares.sort_descending_by(|a| a.share);
        let noise = Described { model: scattering(&described.model), ..described.clone() };
        let Propagated { value: noise_total, standard_uncertainty: u_noise } = noise.propagate(expected);
        let edf = edf_of_window_std(windows, window_s, |t| noise.model.mean_variance(t, tau0_s))
            .unwrap_or(windows.saturating_sub(1).max(1) as f64);
        let scatter = if noise_total > 0.0 { 2.0 / edf * (noise_total / total).powi(2) } else { 0.0 };
        let known = (u_noise / total).powi(2);
        let shifted = ((u_total * u_total - u_noise * u_noise) / (total * total)).max(0.0);
        let left = (scatter - known).max(LEAST_LEFT * scatter) + UNSHARED_VARIANCE_SHARE * shifted;
        let phased = phased(&described.model, window_s, windows) / (total * total);
        let products = |part: fn(f64) -> f64| {
            crossed(&described.model, window_s, windows, noise_total, part) / (total * total)
        };
        // What the fitted amplitude of a line shares with s² cannot be tested; a window mean folds noise of other
        // frequencies onto that of the line.
        let left = left + products(|passed| 1.0 - passed) + phased;
        Some(WindowPrediction {
            sigma: total.sqrt(),
            shares,
            uncertainty: 0.5 * u_total / total.sqrt(),
            scatter_dof: 2.0 / (scatter + products(|_| 1.0) + phased),
            ratio_dof: 2.0 / left,
        })
    }

    /// Observed over predicted with the interval of what their true ratio may be.
    pub fn ratio(&self, observed: f64, coverage: f64) -> Option<(f64, Interval)> {
        let ratio = observed / self.sigma;
        let dof = self.ratio_dof;
        if !(ratio.is_finite() && ratio > 0.0 && dof > 0.0 && dof.is_finite()) {
            return None;
        }
        let tail = 0.5 * (1.0 - coverage);
        let at = |p: f64| ratio * (dof / chi_square_quantile(p, dof)).sqrt();
        Some((ratio, Interval { low: at(1.0 - tail), high: at(tail), coverage }))
    }

    /// The verdict on an observed value at 95 %.
    pub fn agreement(&self, observed: f64) -> Option<Agreement> {
        let (_, interval) = self.ratio(observed, 0.95)?;
        Some(if interval.low > 1.0 {
            Agreement::Above
        } else if interval.high < 1.0 {
            Agreement::Below
        } else {
            Agreement::Consistent
        })
    }

    /// Degrees of freedom with which E\[s²\] itself is known from the parameters; infinite when exactly.
    pub fn known_dof(&self) -> f64 {
        FIT_EFFICIENCY * 0.5 * (self.sigma / self.uncertainty).powi(2)
    }
}

/// Covariance of two quantities computed from the model, to first order, each with a scale that makes it of the size of 1.
pub fn covariance_of(
    described: &Described,
    (a, size_a): (impl Fn(&Composite) -> f64, f64),
    (b, size_b): (impl Fn(&Composite) -> f64, f64),
) -> f64 {
    let square = |sign: f64| {
        let sum = described.propagate(|m| a(m) / size_a + sign * b(m) / size_b);
        sum.standard_uncertainty.powi(2)
    };
    0.25 * (square(1.0) - square(-1.0)) * size_a * size_b
}

/// Addition of a term that was not shown to E\[s²\] at its upper limit, (deg/h)².
pub fn unseen_variance(term: NoiseType, limit: f64, window_s: f64, windows: u64) -> f64 {
    limit * limit * super::russian::unit_expected_variance(term, window_s, windows).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::composite::Parameter;
    use crate::noise::model::NoiseModel;

    fn described(model: NoiseModel, parameters: Vec<Parameter>, variances: &[f64]) -> Described {
        let covariance = (0..variances.len())
            .map(|i| (0..variances.len()).map(|j| if i == j { variances[i] } else { 0.0 }).collect())
            .collect();
        Described { model: model.into(), parameters, covariance }
    }

    #[test]
    fn white_noise_predicts_six_n_and_its_own_scatter() {
        let n = 0.0023;
        let white = Parameter::Coefficient(NoiseType::AngleRandomWalk);
        let d = described(NoiseModel { n, ..Default::default() }, vec![white], &[(0.004 * n).powi(2)]);
        let p = WindowPrediction::of(&d, 100.0, 360, 1.0).unwrap();
        assert!((p.sigma - 6.0 * n).abs() < 1e-15);
        assert!((p.uncertainty / (6.0 * 0.004 * n) - 1.0).abs() < 1e-6);
        // u(s)/s = 1/√(2·359): 3.7 %.
        assert!((p.scatter_dof - 359.0).abs() < 0.01);
        // 2/359 − (2·0.004)² is what is left to be tested.
        assert!((p.ratio_dof / (2.0 / (2.0 / 359.0 - 0.008f64.powi(2))) - 1.0).abs() < 1e-3);
        assert_eq!(p.agreement(6.0 * n), Some(Agreement::Consistent));
        assert_eq!(p.agreement(6.0 * n * 1.1), Some(Agreement::Above));
        // TIUS-500 of the founding paper: 22 % below what its own N predicts.
        assert_eq!(p.agreement(0.78 * 6.0 * n), Some(Agreement::Below));
    }

    #[test]
    fn the_phase_of_a_line_scatters_as_it_does_over_all_phases() {
        let (window_s, windows) = (100.0, 5u64);
        for (frequency_hz, least) in [(0.0013, 1e-3), (0.00493, 1e-3), (0.0321, 1e-9), (0.0101, 1e-9)] {
            let line = Line { amplitude_deg_h: 0.3, frequency_hz };
            let model = Composite { lines: vec![line], ..Composite::default() };
            // s² of the means of the line itself, by integrating it, over 720 phases.
            let turn = 2.0 * PI * frequency_hz;
            let of = |phase: f64| {
                let at = |t: f64| -0.3 * (turn * t + phase).cos() / turn;
                let means: Vec<f64> = (0..windows)
                    .map(|k| (at((k + 1) as f64 * window_s) - at(k as f64 * window_s)) / window_s)
                    .collect();
                let mean = means.iter().sum::<f64>() / means.len() as f64;
                means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (means.len() - 1) as f64
            };
            let all: Vec<f64> = (0..720).map(|i| of(f64::from(i) * PI / 360.0)).collect();
            let mean = all.iter().sum::<f64>() / 720.0;
            let variance = all.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / 720.0;
            let found = phased(&model, window_s, windows);
            assert!(variance > least * 1e-3 * mean * mean, "{frequency_hz}");
            assert!((found / variance - 1.0).abs() < 1e-6, "{frequency_hz}: {found} {variance}");
        }
    }

    #[test]
    fn shares_sum_to_one_and_the_ramp_does_not_scatter() {
        let model = NoiseModel { n: 0.002, b: 0.006, k: 0.004, r: 0.01, q: 0.1 };
        let d = described(model, vec![], &[]);
        let p = WindowPrediction::of(&d, 100.0, 360, 1.0).unwrap();
        assert!((p.shares.iter().map(|s| s.share).sum::<f64>() - 1.0).abs() < 1e-12);
        assert_eq!(p.shares[0].part, Part::Term(NoiseType::RateRamp));
        let alone = described(NoiseModel { r: 0.01, ..Default::default() }, vec![], &[]);
        let p = WindowPrediction::of(&alone, 100.0, 360, 1.0).unwrap();
        // R τ √(n(n+1)/12) with τ in hours.
        assert!((p.sigma / (0.01 / 36.0 * (360.0f64 * 361.0 / 12.0).sqrt()) - 1.0).abs() < 1e-9);
        assert_eq!((p.scatter_dof.is_finite(), p.ratio(p.sigma, 0.95)), (false, None));
        assert_eq!(WindowPrediction::of(&Described::default(), 100.0, 360, 1.0), None);
        assert_eq!(WindowPrediction::of(&d, 100.0, 1, 1.0), None);
    }
}
