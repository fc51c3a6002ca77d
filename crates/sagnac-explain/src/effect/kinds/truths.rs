//! Records with every column moving, and parameters of a truth for each course, for the tests of the catalogue.

use crate::effect::{ClaimedMean, Column, Drivers, Earth, Effect, OtherDriver, Temperature, Value, Values};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::PI;

/// White noise.
pub fn noise(seed: u64, n: usize, sigma: f64) -> Vec<f64> {
    let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
    (0..n)
        .map(|_| {
            let e: f64 = StandardNormal.sample(&mut rng);
            sigma * e
        })
        .collect()
}

/// Plateaus, sweeps and reversals of a table.
fn profile(t: f64) -> f64 {
    let sweep = 2.0 * (2.0 * PI * t / 170.0).sin() * (2.0 * PI * t / 1900.0).cos();
    match (t / 250.0) as usize % 4 {
        0 => 0.0,
        1 => 6.0,
        2 => sweep,
        _ => -9.0 * (2.0 * PI * t / 83.0).sin(),
    }
}

/// A record of 50 minutes with every column moving.
pub fn drivers() -> Drivers {
    let (n, dt) = (6000usize, 0.5);
    let time = |i: usize| i as f64 * dt;
    let series = |f: &dyn Fn(f64) -> f64| Some((0..n).map(|i| f(time(i))).collect::<Vec<f64>>());
    let mut angle = 0.0;
    let table_angle = (0..n)
        .map(|i| {
            angle += profile(time(i)) * dt;
            f64::rem_euclid(angle - 0.5 * profile(time(i)) * dt, 360.0)
        })
        .collect();
    Drivers {
        dt_s: dt,
        start_s: 1000.0,
        samples: n,
        averaged: 1,
        temperature: series(&|t| 25.0 + 15.0 * (2.0 * PI * t / 2100.0).sin() + 3.0 * (t / 300.0).cos()),
        smooth_temperature: None,
        table_rate: series(&profile),
        table_angle: Some(table_angle),
        outer_rate: series(&|t| if t % 700.0 < 300.0 { 3.0 } else { -1.0 }),
        supply: series(&|t| 27.0 + 0.5 * (t / 41.0).sin()),
        others: series(&|t| 1010.0 + 4.0 * (t / 390.0).sin() + 0.001 * t)
            .map(|values| OtherDriver {
                column: Column::of_name("pressure_hPa"),
                smooth: values.clone(),
                values,
            })
            .into_iter()
            .collect(),
        lines: vec![],
        claim: ClaimedMean {
            bias_deg_h: -3.0,
            temperature: Some(Temperature { coefficient_deg_h_per_degc: 0.02, reference_degc: 20.0 }),
            scale_factor_ppm: Some(12.0),
            earth: None,
        },
    }
}

/// The same length in days, for what needs days; at rest.
fn days() -> Drivers {
    let n = 6000;
    let temperature = Some((0..n).map(|i| 20.0 + (f64::from(i) / 500.0).sin()).collect());
    Drivers { dt_s: 60.0, samples: n as usize, averaged: 1, temperature, ..Drivers::default() }
}

/// A table at headings, with the Earth rate in the claim.
fn headings() -> Drivers {
    let all = drivers();
    let earth = Some(Earth { latitude_deg: 56.0, azimuth_deg: 12.0 });
    Drivers { table_rate: None, claim: ClaimedMean { scale_factor_ppm: None, earth, ..all.claim }, ..all }
}

/// Parameters of a truth for each course: drivers, numbers in the order of its parameters, list if any. White noise of
/// 0.05 deg/h is added to it.
pub fn truth(kind: &str) -> (Drivers, Vec<f64>) {
    match kind {
        "temp_linear" => (drivers(), vec![0.023]),
        "temp_linear_delayed" => (drivers(), vec![0.023, 170.0]),
        "temp_polynomial" => (drivers(), vec![25.0, 15.0]),
        "temp_rate" => (drivers(), vec![0.02]),
        "temp_rate_delayed" => (drivers(), vec![0.02, 170.0]),
        "thermal_lag" => (drivers(), vec![130.0]),
        "temp_hysteresis" => (drivers(), vec![0.05, 2.0, 0.0, 1.0]),
        "temp_hysteresis_loops" => (drivers(), vec![0.06, 25.0, 15.0]),
        "warmup_exponential" => (drivers(), vec![0.2, 210.0]),
        "rate_ramp" => (drivers(), vec![0.1]),
        "diurnal" => (days(), vec![0.02, 86_400.0, 40.0]),
        "line" => (drivers(), vec![0.2345, 0.01, 117.0]),
        "comb" => (drivers(), vec![0.0612]),
        "bias_step" => (drivers(), vec![0.05, 2111.3]),
        // At one heading: a table that turns shows the new heading in all its projections.
        "heading_change" => (Drivers { table_angle: None, ..drivers() }, vec![0.05, 2111.3]),
        "earth_rate_projection" => (headings(), vec![0.02, -20.0]),
        "table_harmonic" => (headings(), vec![3.0, 0.02, 77.0]),
        "reset_ripple" => (drivers(), vec![911.0, 0.05, 33.0, -2.95]),
        "sf_error" => (drivers(), vec![-4.0]),
        "sf_asymmetry" => (drivers(), vec![5.0]),
        "sf_nonlinearity" => (drivers(), vec![6.0, 9.0]),
        "sf_temperature" => (drivers(), vec![0.4]),
        "dead_zone" => (drivers(), vec![150.0, 0.8, 0.0]),
        "saturation" => (drivers(), vec![8.99]),
        "cross_axis" => (drivers(), vec![0.02]),
        "supply_sensitivity" => (drivers(), vec![0.05]),
        "temp_response" => (drivers(), vec![25.0, 15.0]),
        "column_driver" => (drivers(), vec![f64::NAN, 1010.0, 5.0]),
        "sf_driver" => (drivers(), vec![20.0, 27.0]),
        "sf_unrecorded" => (drivers(), vec![1000.0, 3000.0]),
        "time_offset" => (drivers(), vec![3.21]),
        "clock_drift" => (drivers(), vec![-870.0]),
        "column_law" => (drivers(), vec![]),
        "column_product" => (drivers(), vec![0.0, 25.0, 15.0, 27.0, 0.5]),
        "column_curve" => (drivers(), vec![0.0, 27.0, 0.5]),
        "drifting_line" => (drivers(), vec![0.2345, 1e-5, 0.015, 117.0, 2499.75]),
        _ => panic!("{kind}"),
    }
}

/// Values of an effect: numbers in the order of its parameters, NaN left out, and lists.
pub fn values(effect: &dyn Effect, numbers: &[f64], lists: Vec<(&'static str, Vec<f64>)>) -> Values {
    let numbers = effect.params().iter().zip(numbers).filter(|(_, x)| x.is_finite());
    let numbers = numbers.map(|(p, x)| (p.name.to_owned(), Value::Number(*x)));
    numbers.chain(lists.into_iter().map(|(name, x)| (name.to_owned(), Value::List(x)))).collect()
}

/// Every value of a truth.
pub fn true_values(effect: &dyn Effect, numbers: &[f64]) -> Values {
    let lists = match effect.kind() {
        "temp_polynomial" => vec![("coefficients_deg_h", vec![0.01, 0.05, -0.03])],
        "temp_hysteresis_loops" => vec![("coefficients_deg_h", vec![0.01, 0.02, 0.01, 0.01, 0.02])],
        "sf_unrecorded" => vec![("coefficients_ppm", vec![2.0, -3.0])],
        "column_law" => vec![
            ("centers", vec![1010.0, 25.0]),
            ("half_ranges", vec![5.0, 15.0]),
            ("coefficients_deg_h", vec![0.01]),
        ],
        "column_product" => vec![("coefficients_deg_h", vec![0.03, 0.0, 0.01])],
        "column_curve" => vec![("coefficients_deg_h", vec![0.01, 0.03])],
        "comb" => vec![
            ("harmonics", vec![1.0, 2.0, 4.0]),
            ("coefficients_deg_h", vec![0.03, 0.0, 0.0, 0.02, 0.015, 0.01]),
        ],
        // A curve, a delay and a play at once.
        "temp_response" | "column_driver" => vec![
            ("terms", vec![1.0, 2.0, 12.0, 13.0]),
            ("scales", vec![0.0, 0.0, 375.0, 0.2]),
            ("coefficients_deg_h", vec![0.02, -0.03, 0.04, 0.02]),
        ],
        _ => vec![],
    };
    let column = match effect.kind() {
        "column_driver" => Some("pressure_hPa"),
        "sf_driver" => Some("supply_v"),
        _ => None,
    };
    let terms = (effect.kind() == "column_law").then_some("rate pressure_hPa * value temp_degC");
    let text = |name: &str, text: &str| (name.to_owned(), Value::Text(text.to_owned()));
    let texts = column.map(|c| text("column", c)).into_iter().chain(terms.map(|t| text("terms", t)));
    values(effect, numbers, lists).into_iter().chain(texts).collect()
}
