//! What the identified noise predicts for the Russian drift, and the ratios of Russian to Allan values.

use super::allan_minimum::{lowest, minimum_edf};
use super::descriptor::Measurand;
use super::evidence::GyroEvidence;
use super::russian::{DRIFT_WINDOW_S, RANDOM_WALK_WINDOW_S, degrees_of_freedom, no_windows};
use crate::estimate::{
    Estimate, SCORE_ONE_SIDED_95, SCORE_TWO_SIDED_95, Spread, chi_square_quantile, normal_probability,
};
use crate::message::note;
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
        let raised = if z > 0.0 {
            variance + (known - variance).hypot(unseen * z / SCORE_ONE_SIDED_95)
        } else {
            known
        };
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
            note!("note.beyond_model", window_s = DRIFT_WINDOW_S)
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
        return none.note(note!("compare.note.lacks_a_side"));
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
        let own = read.interval95().map_or(0.0, |i| (i.high - i.low) / (2.0 * SCORE_TWO_SIDED_95));
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
        None => m.not_identifiable(&gyro.channel, None, method).note(note!("compare.note.lacks_a_side")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::Options;
    use super::super::test_evidence::{
        chi_square, curve, gyro, notes, number, point, shows, windows, withholds, within,
    };
    use super::*;
    use crate::estimate::UpperLimit;
    use crate::noise::composite::{Described, Parameter};
    use crate::noise::model::NoiseModel;

    const N: f64 = 0.002;

    /// White noise of N known to a hundredth, with 37 windows of 100 s and 360 of 10 s.
    fn with(u_n: f64) -> GyroEvidence {
        let mut gyro = gyro();
        gyro.digest.windows = vec![windows(100.0, 200, 37, 0.012), windows(10.0, 20, 360, 0.03)];
        let model = NoiseModel { n: N, ..Default::default() };
        gyro.identification.allowed = model.into();
        gyro.identification.described = Described {
            model: model.into(),
            parameters: vec![Parameter::Coefficient(NoiseType::AngleRandomWalk)],
            covariance: vec![vec![u_n * u_n]],
        };
        gyro.identification.angle_random_walk.value = Some(N);
        gyro.identification.angle_random_walk.spread = Spread::Normal { standard_uncertainty: u_n };
        gyro
    }

    fn row(m: &Measurand, gyro: &GyroEvidence) -> Estimate {
        m.evaluate_gyro(gyro, &Options { remove_earth_rate: false }).remove(0)
    }

    /// What the spread of the prediction has at a score, without terms that are not seen: that of χ² with
    /// 0.85/2·(N/u)² degrees of freedom.
    fn known(z: f64, share: f64) -> f64 {
        let dof = 0.425 / (share * share);
        Spread::ChiSquare { dof }.bound(6.0 * N, normal_probability(z)).unwrap()
    }

    #[test]
    fn white_noise_predicts_six_n_over_100_s() {
        let found = row(&RUSSIAN_DRIFT_100S_PREDICTED, &with(0.1 * N));
        within(found.value.unwrap(), 6.0 * N, 1e-9);
        assert_eq!((found.method, notes(&found)), ("whittle", vec![]));
        let points = curve(&found);
        assert_eq!((points.len(), points[0].0, points[32].0), (33, -4.0, 4.0));
        for i in [0, 10, 16, 20, 32] {
            within(points[i].1, known(points[i].0, 0.1), 1e-6);
        }
        // Known exactly, it has no spread.
        let exact = row(&RUSSIAN_DRIFT_100S_PREDICTED, &with(0.0));
        assert!(curve(&exact).iter().all(|(_, v)| (v / (6.0 * N) - 1.0).abs() < 1e-9));
    }

    #[test]
    fn terms_that_are_not_seen_widen_the_prediction_upwards() {
        let at_most = |value| Some(UpperLimit { value, coverage: 0.95 });
        let mut gyro = with(0.1 * N);
        gyro.identification.bias_instability.upper_limit = at_most(0.004);
        // B² n ln n/((n − 1)π) and K² n τ/6 with τ in h, n = 37.
        let flicker = 0.004f64.powi(2) * 37.0 * 37f64.ln() / (36.0 * std::f64::consts::PI);
        let walk = |k: f64| k * k * 37.0 * 100.0 / 3600.0 / 6.0;
        let check = |gyro: &GyroEvidence, unseen: f64| {
            let found = row(&RUSSIAN_DRIFT_100S_PREDICTED, gyro);
            for (z, value) in curve(&found) {
                let (variance, plain) = ((6.0 * N).powi(2), known(*z, 0.1).powi(2));
                let raised = variance + (plain - variance).hypot(unseen * z / SCORE_ONE_SIDED_95);
                within(*value, if *z > 0.0 { raised } else { plain }.sqrt(), 1e-6);
            }
        };
        check(&gyro, flicker);
        // The larger of both counts, and none that the model has.
        gyro.identification.rate_random_walk.upper_limit = at_most(0.02);
        assert!(walk(0.02) > flicker);
        check(&gyro, walk(0.02));
        gyro.identification.described.model.terms.k = 1e-9;
        check(&gyro, flicker);
    }

    #[test]
    fn a_prediction_needs_windows_and_a_model_that_reaches_their_frequencies() {
        let mut gyro = with(0.1 * N);
        gyro.identification.highest_hz = Some(0.02);
        assert!(row(&RUSSIAN_DRIFT_100S_PREDICTED, &gyro).value.is_some());
        gyro.identification.highest_hz = Some(0.0199);
        let none = row(&RUSSIAN_DRIFT_100S_PREDICTED, &gyro);
        withholds(&none, None, "whittle");
        assert_eq!(number(&none, "note.beyond_model", "window_s"), 100.0);
        gyro.digest.windows[0].n = 1;
        assert_eq!(notes(&row(&RUSSIAN_DRIFT_100S_PREDICTED, &gyro)), ["note.russian_too_short"]);
    }

    #[test]
    fn the_ratio_to_the_minimum_is_that_of_two_variances() {
        let mut gyro = with(0.0);
        gyro.digest.samples = 1000;
        // Two degrees of freedom each: F has the probability x/(1 + x).
        gyro.digest.windows[0].n = 3;
        gyro.octaves = vec![point(100, 0.003, 2.0)];
        let found = row(&RATIO_RUSSIAN_TO_ALLAN_BIAS, &gyro);
        shows(&found, 4.0, "overlapping_allan");
        let points = curve(&found);
        assert_eq!(points.len(), 33);
        for (z, value) in points {
            let p = normal_probability(-z);
            within(*value, 4.0 / (p / (1.0 - p)).sqrt(), 1e-3);
        }
        gyro.digest.windows[0].standard_deviation = 0.0;
        let none = row(&RATIO_RUSSIAN_TO_ALLAN_BIAS, &gyro);
        withholds(&none, None, "overlapping_allan");
        assert_eq!(notes(&none), ["compare.note.lacks_a_side"]);
        let mut without = with(0.0);
        without.octaves = vec![];
        withholds(&row(&RATIO_RUSSIAN_TO_ALLAN_BIAS, &without), None, "overlapping_allan");
    }

    /// Degrees of freedom of the ratio to N: the scatter 2/359 of the variance of 360 means, less what the fit shares with
    /// it. With E = 360 N², E and N share 720 N·u², and Var(ln ratio²) is 2/359 + 4u²/n² − 4·720 N u²/(n·360 N²).
    fn ratio_dof(n: f64, u: f64, own: f64) -> f64 {
        let scatter = 2.0 / 359.0;
        let relative = scatter + 4.0 * u * u / (n * n) - 8.0 * u * u / (n * N);
        let unshared = (own * own - u * u).max(0.0) + (n - N) * (n - N);
        2.0 / (relative.max(0.12 * scatter) + 4.0 * unshared / (n * n))
    }

    #[test]
    fn what_the_ratio_to_n_shares_with_its_fit_cancels() {
        let value = |n: f64| 10f64.sqrt() * 0.03 / 60.0 / n;
        // N as fitted; N read elsewhere with a wider interval; a fit so poor that hardly anything is left.
        for (n, u, own) in [(N, 0.01 * N, 0.01 * N), (1.05 * N, 0.01 * N, 0.02 * N), (N, 0.1 * N, 0.05 * N)] {
            let mut gyro = with(u);
            let read = &mut gyro.identification.angle_random_walk;
            (read.value, read.spread) = (Some(n), Spread::Normal { standard_uncertainty: own });
            let found = row(&RATIO_RUSSIAN_TO_ALLAN_ARW, &gyro);
            shows(&found, value(n), "whittle");
            within(chi_square(&found), ratio_dof(n, u, own), 1e-5);
        }
        // Without an interval nothing beside the fit is known.
        let mut gyro = with(0.01 * N);
        gyro.identification.angle_random_walk.spread = Spread::Unknown;
        within(chi_square(&row(&RATIO_RUSSIAN_TO_ALLAN_ARW, &gyro)), ratio_dof(N, 0.01 * N, 0.0), 1e-5);
    }

    #[test]
    fn a_walk_in_the_description_counts_at_the_length_of_the_windows() {
        // E gains K² n τ/6 (τ in h) of 360 windows of 10 s, which the fit of N shares nothing of.
        let (u, k) = (0.01 * N, 0.05);
        let mut gyro = with(u);
        gyro.identification.described.model.terms.k = k;
        let described = &gyro.identification.described;
        let scatter = 2.0 / WindowPrediction::of(described, 10.0, 360, 0.5).unwrap().scatter_dof;
        let expected = 360.0 * N * N + k * k * 360.0 * 10.0 / 3600.0 / 6.0;
        let relative = scatter + 4.0 * u * u / (N * N) - 4.0 * 720.0 * N * u * u / (N * expected);
        let found = row(&RATIO_RUSSIAN_TO_ALLAN_ARW, &gyro);
        within(chi_square(&found), 2.0 / relative, 1e-5);
    }

    #[test]
    fn a_ratio_to_n_needs_both_sides() {
        let mut gyro = with(0.01 * N);
        gyro.identification.angle_random_walk.value = None;
        let none = row(&RATIO_RUSSIAN_TO_ALLAN_ARW, &gyro);
        withholds(&none, None, "whittle");
        assert_eq!(notes(&none), ["compare.note.lacks_a_side"]);
        let mut gyro = with(0.01 * N);
        gyro.digest.windows[1].standard_deviation = 0.0;
        withholds(&row(&RATIO_RUSSIAN_TO_ALLAN_ARW, &gyro), None, "whittle");
    }
}
