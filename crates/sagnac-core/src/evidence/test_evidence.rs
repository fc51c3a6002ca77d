//! Small evidence with known numbers, for the tests of the measurands beside it, and what reads rows back.

use super::{GyroEvidence, TableEvidence};
use crate::estimate::{Estimate, Spread};
use crate::message::Arg;
use crate::noise::data::{DeviationPoint, NoiseType};
use crate::noise::digest::{DigestPlan, RateAccumulator};
use crate::noise::intervals::BoundedPoint;
use crate::noise::windows::WindowStatistics;
use crate::numeric::order::SortNumbers;
use crate::numeric::reml::{self, Combination, Fit};
use crate::rate_table::design::Extra;
use crate::rate_table::scale_factor::{self, ScaleFactor};
use crate::rate_table::steps::{Part, Step, Steps};
use crate::rate_table::{Setup, TableRun};
use crate::temperature::TemperatureTest;
use nalgebra::{DMatrix, DVector};

/// A gyro of which nothing was recorded, at a sample interval of 0.5 s: tests put in what they need.
pub fn gyro() -> GyroEvidence {
    let digest = RateAccumulator::new(DigestPlan::new(0.5)).finish();
    GyroEvidence::identify("g".into(), digest, 0.5, 0.01, None)
}

/// A point of σ(τ).
pub fn point(m: u64, deviation: f64, edf: f64) -> BoundedPoint {
    BoundedPoint {
        point: DeviationPoint { m, terms: 100, stride: 1, deviation },
        noise: NoiseType::AngleRandomWalk,
        edf,
        interval95: None,
        interval68: None,
    }
}

/// Window means, as they are stated.
pub fn windows(window_s: f64, samples: u64, n: u64, standard_deviation: f64) -> WindowStatistics {
    WindowStatistics {
        window_s,
        samples,
        n,
        mean: 0.0,
        standard_deviation,
        means: None,
        per_stretch: vec![n],
    }
}

/// A combination of many degrees of freedom.
pub fn combination(value: f64, standard: f64) -> Combination {
    Combination { value, standard, dof: 1e9 }
}

/// A fit with these coefficients and covariance, known exactly (1e9 degrees of freedom).
pub fn fitted(coefficients: &[f64], covariance: DMatrix<f64>) -> Fit {
    let p = coefficients.len();
    let x = DMatrix::from_fn(2 * p, p, |i, j| f64::from(i % p == j));
    let y = DVector::from_fn(2 * p, |i, _| coefficients[i % p]);
    let mut fit = reml::fit(&y, &x, &DMatrix::identity(2 * p, 2 * p), &[]).unwrap();
    fit.covariance = covariance;
    fit
}

/// One part of a step at a rate and a time, with its output.
pub fn part(at: usize, rate: f64, output: f64) -> Part {
    Part {
        mid_s: 10.0 * at as f64 + 5.0,
        length_s: 10.0,
        rate,
        outer: 0.0,
        temperature: f64::NAN,
        gyro: vec![output],
        angle: (f64::NAN, f64::NAN),
    }
}

/// Steps of rates, deg/h, with the output of each, in cycles of so many. Every step has two parts that scatter about it.
pub fn steps(rates: &[f64], outputs: &[f64], cycle: usize) -> Steps {
    let mut levels = rates.to_vec();
    levels.sort_ascending();
    levels.dedup();
    let step = |(i, (rate, output)): (usize, (&f64, &f64))| Step {
        from_s: 20.0 * i as f64,
        to_s: 20.0 * (i + 1) as f64,
        first_row: 20 * i as u64,
        end_row: 20 * (i as u64 + 1),
        rate: *rate,
        nominal: *rate,
        outer: 0.0,
        temperature: f64::NAN,
        gyro: vec![*output],
        turns: 0.0,
        level: levels.iter().position(|l| l == rate).unwrap(),
        approach: 0,
        cycle: i / cycle,
        parts: vec![part(2 * i, *rate, output + 0.5), part(2 * i + 1, *rate, output - 0.5)],
        unsettled: None,
    };
    let list: Vec<Step> = rates.iter().zip(outputs).enumerate().map(step).collect();
    Steps { cycles: rates.len() / cycle, list, levels, too_short: 0 }
}

/// Steps of an output that follows the rate exactly, one each, with the line through them.
///
/// The means of the levels about the slope, and the coefficients of extras behind them, are those given, with their
/// covariance; factor, bias, residuals of the levels and full scale are for the test to set.
pub fn line(
    rates: &[f64],
    means: &[f64],
    extras: &[Extra],
    covariance: DMatrix<f64>,
) -> (Steps, ScaleFactor) {
    let steps = steps(rates, rates, rates.len());
    let mut run = TableRun { steps: steps.clone(), ..TableRun::default() };
    run.blocks.gyros = vec!["g".into()];
    let mut line = scale_factor::evaluate(&run, 0, &Setup::default(), &[]).unwrap();
    line.response.fit = fitted(means, covariance);
    line.response.extras = extras.to_vec();
    (steps, line)
}

/// A test over temperature from −40 to 60 degC.
pub fn asked() -> TemperatureTest {
    TemperatureTest {
        channel: String::new(),
        command: None,
        low_deg_c: -40.0,
        high_deg_c: 60.0,
        end_tolerance_deg_c: 1.0,
        overshoot_deg_c: None,
        ramp_rate_deg_c_h: None,
        ramp_rate_tolerance: 0.1,
        slowest_deg_c_h: 1.0,
        fastest_deg_c_h: 100.0,
        dwell_s: None,
        dwell_drift_deg_c_h: 1.0,
        ramps_each_way: 1,
        sensor_uncertainty_deg_c: 0.1,
        coverage_factor: 2.0,
        zones_deg_c: vec![],
        residual_average_s: 100.0,
        highest_order: 3,
        segments: vec![],
    }
}

/// A diagonal covariance.
pub fn diagonal(variances: &[f64]) -> DMatrix<f64> {
    DMatrix::from_diagonal(&DVector::from_row_slice(variances))
}

/// Evidence of a table with this line.
pub fn on_table<'a>(setup: &'a Setup, steps: &'a Steps, line: Option<ScaleFactor>) -> TableEvidence<'a> {
    TableEvidence { line, ..TableEvidence::new(0, "g", setup, steps) }
}

/// Two numbers agree to rounding.
#[track_caller]
pub fn near(found: f64, expected: f64) {
    within(found, expected, 1e-9);
}

/// Two numbers agree to a relative error.
#[track_caller]
pub fn within(found: f64, expected: f64, relative: f64) {
    let close = (found - expected).abs() <= relative * expected.abs().max(1e-300) || found == expected;
    assert!(close, "{found} in place of {expected}");
}

/// A row states a value by a method, and no limit.
#[track_caller]
pub fn shows(row: &Estimate, value: f64, method: &str) {
    near(row.value.expect("a value"), value);
    assert_eq!((row.method, row.upper_limit, row.lower_limit), (method, None, None));
}

/// A row has no value; what it is at most, where that is stated, has 95 %.
#[track_caller]
pub fn withholds(row: &Estimate, at_most: Option<f64>, method: &str) {
    assert_eq!((row.value, row.method, &row.spread), (None, method, &Spread::Unknown));
    assert_eq!(row.upper_limit.is_some(), at_most.is_some(), "{:?}", row.upper_limit);
    if let (Some(limit), Some(expected)) = (row.upper_limit, at_most) {
        near(limit.value, expected);
        assert_eq!(limit.coverage, 0.95);
    }
}

/// Keys of the notes of a row.
pub fn notes(row: &Estimate) -> Vec<&str> {
    row.notes.iter().map(|n| n.id.as_ref()).collect()
}

/// An argument of a note of a row.
#[track_caller]
pub fn told<'a>(row: &'a Estimate, note: &str, name: &str) -> &'a Arg {
    let note = row.notes.iter().find(|n| n.id == note).expect("a note");
    note.args.get(name).expect("an argument")
}

/// A number in a note of a row.
#[track_caller]
pub fn number(row: &Estimate, note: &str, name: &str) -> f64 {
    told(row, note, name).number().expect("a number")
}

/// Standard uncertainty and degrees of freedom of a row with Student's law.
#[track_caller]
pub fn student(row: &Estimate) -> (f64, f64) {
    match row.spread {
        Spread::StudentT { standard_uncertainty, dof } => (standard_uncertainty, dof),
        ref other => panic!("{other:?}"),
    }
}

/// Standard uncertainty of a row with the normal law.
#[track_caller]
pub fn normal(row: &Estimate) -> f64 {
    match row.spread {
        Spread::Normal { standard_uncertainty } => standard_uncertainty,
        ref other => panic!("{other:?}"),
    }
}

/// Degrees of freedom of a row with the law of χ².
#[track_caller]
pub fn chi_square(row: &Estimate) -> f64 {
    match row.spread {
        Spread::ChiSquare { dof } => dof,
        ref other => panic!("{other:?}"),
    }
}

/// Points of a row with a curve.
#[track_caller]
pub fn curve(row: &Estimate) -> &[(f64, f64)] {
    match &row.spread {
        Spread::Curve(points) => points,
        other => panic!("{other:?}"),
    }
}
