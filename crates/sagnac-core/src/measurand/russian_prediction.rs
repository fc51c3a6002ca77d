//! What the identified noise predicts for the Russian drift, and the ratios of Russian to Allan values.

use super::allan_minimum::{lowest, minimum_edf};
use super::descriptor::Measurand;
use super::evidence::GyroEvidence;
use super::russian::{DRIFT_WINDOW_S, RANDOM_WALK_WINDOW_S, degrees_of_freedom, no_windows};
use crate::estimate::{Estimate, Spread, chi_square_quantile, normal_probability};
use crate::message::Note;
use crate::noise::composite::{Composite, Part, Propagated};
use crate::noise::data::NoiseType;
use crate::noise::prediction::{WindowPrediction, covariance_of, unseen_variance};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// The drift of 100-s means that the noise model predicts.
pub static RUSSIAN_DRIFT_100S_PREDICTED: Measurand = Measurand::at_rest(
    "russian_drift_100s_predicted",
    "deg/h",
    "what the identified noise predicts for 100-s means",
    |m, gyro, _| vec![drift_predicted(m, gyro)],
)
.needs_stillness()
.drift();

/// Drift of 100-s means over the smallest Allan deviation.
pub static RATIO_RUSSIAN_TO_ALLAN_BIAS: Measurand = Measurand::at_rest(
    "ratio_russian_to_allan_bias",
    "1",
    "Russian 100-s drift over the Allan minimum",
    |m, gyro, _| vec![bias_ratio(m, gyro)],
)
.needs_stillness();

/// Angle random walk of 10-s means over N.
pub static RATIO_RUSSIAN_TO_ALLAN_ARW: Measurand = Measurand::at_rest(
    "ratio_russian_to_allan_arw",
    "1",
    "Russian 10-s angle random walk over N",
    |m, gyro, _| vec![random_walk_ratio(m, gyro)],
)
.needs_stillness();

/// Least share of the variance of σ over 10 s that a ratio to N of the same record keeps.
const LEAST_LEFT: f64 = 0.12;
/// Normal score of a two-sided 95 %.
const NORMAL_95: f64 = 1.959_963_984_540_054;
/// Normal score of the coverage of upper limits.
const LIMIT_SCORE: f64 = 1.644_853_626_951_472_2;

/// Normal scores a spread is drawn through.
fn scores() -> impl Iterator<Item = f64> {
    (-16..=16).map(|i| 0.25 * f64::from(i))
}

/// Frequencies that make up window means, in cycles a window: a model that ends below says too little of them.
const NEEDED: f64 = 2.0;

/// The prediction for a window length with the spread of its σ; `None` where the record has no two windows, no model, or
/// one that ends below the frequencies that make up such means.
///
/// Upwards the spread holds what flicker and random walk would add at their upper limits where the model lacks them.
pub fn predicted(gyro: &GyroEvidence, window_s: f64) -> Option<(WindowPrediction, Spread)> {
    let windows = gyro.windows(window_s)?;
    let exact_s = windows.exact_s(gyro.tau0_s);
    let found = &gyro.identification;
    if found.highest_hz.is_some_and(|hz| hz < NEEDED / exact_s) {
        return None;
    }
    let p = WindowPrediction::of(&found.described, exact_s, windows.n, gyro.tau0_s)?;
    let present = found.described.model.parts();
    let unseen =
        [(NoiseType::Flicker, &found.bias_instability), (NoiseType::RateRandomWalk, &found.rate_random_walk)]
            .into_iter()
            .filter(|(term, _)| !present.contains(&Part::Term(*term)))
            .filter_map(|(term, e)| Some(unseen_variance(term, e.upper_limit?.value, exact_s, windows.n)))
            .fold(0.0, f64::max);
    let (variance, dof) = (p.sigma * p.sigma, p.known_dof());
    let curve = scores().map(|z| {
        let known = if dof < 1e9 {
            variance * dof / chi_square_quantile(normal_probability(-z), dof)
        } else {
            variance
        };
        let raised =
            if z > 0.0 { variance + (known - variance).hypot(unseen * z / LIMIT_SCORE) } else { known };
        (z, raised.sqrt())
    });
    let spread = Spread::Curve(curve.collect());
    Some((p, spread))
}

fn drift_predicted(m: &Measurand, gyro: &GyroEvidence) -> Estimate {
    let method = "whittle";
    let Some((p, spread)) = predicted(gyro, DRIFT_WINDOW_S) else {
        let none = m.not_identifiable(&gyro.channel, None, method);
        let note = if gyro.windows(DRIFT_WINDOW_S).is_some() {
            Note::new("note.beyond_model").with("window_s", DRIFT_WINDOW_S)
        } else {
            no_windows(gyro, DRIFT_WINDOW_S)
        };
        return none.note(note);
    };
    m.measured(&gyro.channel, p.sigma, spread, method)
}

/// σ over 100 s over the smallest Allan deviation, as a ratio of two deviations with their degrees of freedom.
fn bias_ratio(m: &Measurand, gyro: &GyroEvidence) -> Estimate {
    let method = "overlapping_allan";
    let both = gyro.windows(DRIFT_WINDOW_S).filter(|w| w.standard_deviation > 0.0).zip(lowest(gyro));
    let Some((windows, minimum)) = both else {
        let none = m.not_identifiable(&gyro.channel, None, method);
        return none.note(Note::new("compare.note.lacks_a_side"));
    };
    let value = windows.standard_deviation / minimum.point.deviation;
    let (above, below) = (degrees_of_freedom(gyro, windows), minimum_edf(gyro, minimum));
    let spread = FisherSnedecor::new(above, below).map_or(Spread::Unknown, |law| {
        let at = |z: f64| (z, value / law.inverse_cdf(normal_probability(-z)).sqrt());
        Spread::Curve(scores().map(at).filter(|p| p.1.is_finite()).collect())
    });
    m.measured(&gyro.channel, value, spread, method)
}

/// The angle random walk from 10-s means over the fitted N. Both come from one record, so what they share cancels.
fn random_walk_ratio(m: &Measurand, gyro: &GyroEvidence) -> Estimate {
    let method = "whittle";
    let found = &gyro.identification;
    let windows = gyro.windows(RANDOM_WALK_WINDOW_S).filter(|w| w.standard_deviation > 0.0);
    let read = found.read_angle_random_walk();
    let level = |m: &Composite| found.plateau.as_ref().map_or(m.terms.n, |p| p.level(m));
    let ratio = windows.zip(read.value).and_then(|(windows, n)| {
        let exact_s = windows.samples as f64 * gyro.tau0_s;
        let p = WindowPrediction::of(&found.described, exact_s, windows.n, gyro.tau0_s)?;
        let expected =
            |m: &Composite| m.expected_variance(exact_s, windows.n, gyro.tau0_s).unwrap_or(f64::NAN);
        let Propagated { value: variance, standard_uncertainty: u_n } = found.described.propagate(level);
        let shared = covariance_of(&found.described, (level, n), (expected, p.sigma * p.sigma));
        let variance = variance * variance;
        // The interval of N may be wider: it allows for terms that the description lacks; and the description may hold
        // quantisation that was not claimed.
        let own = read.interval95().map_or(0.0, |i| (i.high - i.low) / (2.0 * NORMAL_95));
        let moved = n - variance.sqrt();
        let unshared = (own * own - u_n * u_n).max(0.0) + moved * moved;
        let scatter = 2.0 / p.scatter_dof;
        let relative = scatter + (2.0 * u_n / n).powi(2) - 4.0 * shared / (n * p.sigma * p.sigma);
        let dof = 2.0 / (relative.max(LEAST_LEFT * scatter) + 4.0 * unshared / (n * n));
        let value = 10f64.sqrt() * windows.standard_deviation / 60.0 / n;
        Some((value, Spread::ChiSquare { dof }))
    });
    match ratio {
        Some((value, spread)) => m.measured(&gyro.channel, value, spread, method),
        None => m.not_identifiable(&gyro.channel, None, method).note(Note::new("compare.note.lacks_a_side")),
    }
}
