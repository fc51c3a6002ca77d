//! The truths of a bench, and a fit that knows its noise.

use crate::bench::EARTH;
use crate::bench::rate_table::{RateTable, Recorded};
use nalgebra::{DMatrix, DVector};
use sagnac::rate_table::design::Extra;
use sagnac::rate_table::noise::Rows;
use sagnac::rate_table::{TableRun, scale_factor};
use std::collections::BTreeMap;

/// Truths of a bench at the rates of a run, from its own formulas.
pub fn truths(
    bench: &RateTable,
    recorded: &Recorded,
    found: &scale_factor::ScaleFactor,
) -> Vec<(&'static str, f64)> {
    let gain =
        1.0 + 1e-6 * (bench.error_ppm + bench.ppm_per_c * (found.response.temperature - bench.reference_c));
    let axial = (1.0 - bench.tilt * bench.tilt).sqrt();
    let vertical = EARTH * bench.latitude.to_radians().sin();
    let x = &found.response.levels;
    let y: Vec<f64> = x
        .iter()
        .map(|w| gain * axial * (w + vertical) + bench.curve(*w) + bench.bias + recorded.drift)
        .collect();
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let slope = x.iter().zip(&y).map(|(a, b)| (a - mx) * (b - my)).sum::<f64>()
        / x.iter().map(|a| (a - mx).powi(2)).sum::<f64>();
    let offset = my - slope * mx;
    let left: Vec<f64> = x.iter().zip(&y).map(|(a, b)| b - slope * a - offset).collect();
    let ppm = 1e6 / (slope * bench.full_scale());
    let largest = left.iter().fold(0.0, |m: f64, v| m.max(v.abs())) * ppm;
    let of_rate = x
        .iter()
        .zip(&left)
        .filter(|(r, _)| r.abs() > 17_000.0)
        .fold(0.0, |m: f64, (r, v)| m.max((v / r).abs()))
        * 1e6
        / slope;
    let rms = (left.iter().map(|v| v * v).sum::<f64>() / n).sqrt() * ppm;
    let signs = DMatrix::from_fn(x.len(), 3, |i, j| [1.0, x[i].max(0.0), x[i].min(0.0)][j]);
    let halves = (signs.transpose() * &signs).cholesky().expect("a design");
    let halves = halves.solve(&(signs.transpose() * DVector::from_column_slice(&y)));
    vec![
        ("scale_factor_asymmetry", 1e6 * (halves[1] - halves[2]) / slope),
        ("scale_factor_error", 1e6 * (slope - 1.0)),
        ("scale_factor_bias", offset),
        ("scale_factor_nonlinearity", largest),
        ("scale_factor_nonlinearity_of_rate", of_rate),
        ("scale_factor_residual", rms),
        ("scale_factor_odd", bench.cubic_ppm / slope),
        ("scale_factor_even", bench.even_ppm / slope),
        ("scale_factor_hysteresis", bench.hysteresis_ppm / slope),
        ("scale_factor_temperature_sensitivity", bench.ppm_per_c),
        ("table_harmonic_1", EARTH * bench.latitude.to_radians().cos() * bench.tilt),
        ("table_harmonic_2", 0.0),
        // Where cycles do not differ, what noise makes of them is measured and has no truth here.
        ("scale_factor_repeatability", if bench.cycle_ppm > 0.0 { bench.cycle_ppm } else { f64::NAN }),
    ]
}

/// Standard deviations of a least-squares fit that knows the noise, for what is linear in the response.
pub fn told(
    bench: &RateTable,
    run: &TableRun,
    found: &scale_factor::ScaleFactor,
) -> BTreeMap<&'static str, f64> {
    let r = &found.response;
    let parts: Vec<_> = run
        .steps
        .list
        .iter()
        .enumerate()
        .flat_map(|(s, step)| step.parts.iter().map(move |p| (s, step, p)))
        .collect();
    let n = parts.len();
    let rows = Rows {
        mid_s: parts.iter().map(|p| p.2.mid_s).collect(),
        length_s: parts.iter().map(|p| p.2.length_s).collect(),
        step: parts.iter().map(|p| p.0).collect(),
    };
    let count = r.levels.len();
    let mean = |(a, b): (f64, f64), order: u8, f: fn(f64) -> f64| {
        let k = f64::from(order) * std::f64::consts::TAU / 1_296_000.0;
        (0..400).map(|i| f(k * (a + (b - a) * (f64::from(i) + 0.5) / 400.0))).sum::<f64>() / 400.0
    };
    let x = DMatrix::from_fn(n, count + r.extras.len(), |i, j| {
        let (_, step, part) = &parts[i];
        match j.checked_sub(count).map(|e| r.extras[e]) {
            None => f64::from(u8::from(step.level == j)),
            Some(Extra::Approach) => f64::from(step.approach),
            Some(Extra::ScaleOverTemperature) => {
                (part.temperature - r.temperature) * r.slope * part.rate * 1e-6
            }
            Some(Extra::BiasOverTemperature) => part.temperature - r.temperature,
            // The outer axis rests here.
            Some(Extra::TiltOverTemperature) => 0.0,
            Some(Extra::Cosine(order)) => mean(part.angle, order, f64::cos),
            Some(Extra::Sine(order)) => mean(part.angle, order, f64::sin),
        }
    });
    let mut v = rows.white() * bench.n.powi(2)
        + rows.angle() * bench.reading_arcsec.powi(2)
        + rows.flicker() * bench.b.powi(2)
        + rows.random_walk() * bench.k.powi(2);
    for i in 0..n {
        for j in 0..n {
            if parts[i].1.cycle == parts[j].1.cycle {
                v[(i, j)] += (1e-6 * bench.cycle_ppm).powi(2) * parts[i].2.rate * parts[j].2.rate;
            }
        }
    }
    let weighted = v.cholesky().expect("noise").solve(&x);
    let covariance = (x.transpose() * weighted).cholesky().expect("a design").inverse();
    let levels = covariance.view((0, 0), (count, count)).into_owned();
    let of = |columns: usize, row: &dyn Fn(&DMatrix<f64>) -> Vec<f64>, entry: &dyn Fn(f64, usize) -> f64| {
        let a = DMatrix::from_fn(count, columns, |i, j| entry(r.levels[i], j));
        let h = (a.transpose() * &a).try_inverse().expect("a design") * a.transpose();
        let w = DVector::from_vec(row(&h));
        w.dot(&(&levels * &w)).sqrt()
    };
    let full = bench.full_scale();
    let power = |x: f64, j: usize| (x / full).powi(j as i32);
    let sign = |x: f64, j: usize| [1.0, x.max(0.0), x.min(0.0)][j];
    let row = |i: usize| move |h: &DMatrix<f64>| h.row(i).iter().copied().collect::<Vec<f64>>();
    let ppm = 1e6 / full;
    let mut out = BTreeMap::from([
        ("scale_factor_error", ppm * of(2, &row(1), &power)),
        ("scale_factor_bias", of(2, &row(0), &power)),
        ("scale_factor_odd", ppm * of(4, &row(3), &power)),
        ("scale_factor_even", ppm * of(4, &row(2), &power)),
        ("scale_factor_asymmetry", 1e6 * of(3, &|h| (h.row(1) - h.row(2)).iter().copied().collect(), &sign)),
    ]);
    for (id, extra, factor) in [
        ("scale_factor_hysteresis", Extra::Approach, 2.0 * ppm),
        ("scale_factor_temperature_sensitivity", Extra::ScaleOverTemperature, 1.0),
    ] {
        if let Some(at) = r.extras.iter().position(|e| *e == extra) {
            out.insert(id, factor * covariance[(count + at, count + at)].sqrt());
        }
    }
    out
}
