//! The response of an open-loop interferometer: output over rate is a sine.
//!
//! y = A·[1 + α(T − T̄)]·sin(κ(Ω − Ω₀)) + b + β(T − T̄), where κΩ is the phase of Sagnac. κ changes with the wavelength of
//! the source, and with it with temperature. κ is sought; all else is linear once κ is given.

use super::design::{is_linearly_independent, slope_of};
use super::noise::Rows;
use super::steps::Steps;
use crate::numeric::optimize::golden_section;
use crate::numeric::reml::{self, Fit};
use nalgebra::{DMatrix, DVector};

/// Smallest phase at full scale at which κ is sought, rad.
const MIN_PHASE_RAD: f64 = 0.02;
/// Largest phase at full scale at which κ is sought, rad.
const MAX_PHASE_RAD: f64 = 3.0;

/// Phases at which the search over them begins.
const PHASE_GRID_POINTS: usize = 60;

/// A fitted sine.
#[derive(Debug, Clone)]
pub struct Sine {
    /// The fit: its columns are constant, sine, cosine, κ, and with a temperature bias, gain and phase over temperature.
    pub fit: Fit,
    /// κ, rad per deg/h.
    pub kappa: f64,
    /// Standard uncertainty of it.
    pub kappa_standard: f64,
    /// Slope at zero rate, output per input.
    pub slope: f64,
    /// Slope of the straight line through all rates.
    pub mean_slope: f64,
    /// Root mean square of what is left, deg/h of input at the mean slope.
    pub rms: f64,
    /// The same of the straight line.
    pub rms_of_line: f64,
    /// Degrees of freedom of what is left.
    pub dof: f64,
    /// Range of the temperature, degC; 0 where it is not known or does not change.
    pub temperature_range: f64,
    /// Each row: step, and what is left, deg/h.
    pub rows: Vec<(usize, f64)>,
}

/// Position of the column of the slope.
pub const SLOPE_COLUMN: usize = 1;
/// Position of the column of κ.
const KAPPA_COLUMN: usize = 3;
/// Position of the change of the amplitude with temperature, 1e-6/degC times the slope.
pub const GAIN_OVER_TEMPERATURE: usize = 5;

struct Data {
    rate: Vec<f64>,
    y: DVector<f64>,
    /// Temperatures about their mean; empty where they are not known.
    temperature: Vec<f64>,
}

impl Data {
    fn columns(&self, kappa: f64) -> Vec<DVector<f64>> {
        let column = |f: &dyn Fn(usize) -> f64| DVector::from_fn(self.rate.len(), |i, _| f(i));
        let sine = |i: usize| (kappa * self.rate[i]).sin() / kappa;
        let mut list =
            vec![column(&|_| 1.0), column(&sine), column(&|i| (1.0 - (kappa * self.rate[i]).cos()) / kappa)];
        if !self.temperature.is_empty() {
            list.push(column(&|i| self.temperature[i]));
            list.push(column(&|i| 1e-6 * self.temperature[i] * sine(i)));
            // Change of κ with temperature, and of the gain with its square.
            list.push(column(&|i| 1e-6 * self.temperature[i] * self.along(kappa, i)));
            list.push(column(&|i| 1e-6 * self.temperature[i] * self.temperature[i] * sine(i)));
        }
        list
    }

    /// κ times the derivative of the sine by κ.
    fn along(&self, kappa: f64, i: usize) -> f64 {
        let phase = kappa * self.rate[i];
        self.rate[i] * phase.cos() - phase.sin() / kappa
    }

    /// Sum of squares that is left at κ.
    fn left(&self, kappa: f64) -> f64 {
        let x = DMatrix::from_columns(&self.columns(kappa));
        let scaled = scale(x);
        match (scaled.transpose() * &scaled).cholesky() {
            Some(normal) => {
                let b = normal.solve(&(scaled.transpose() * &self.y));
                (&self.y - &scaled * b).norm_squared()
            }
            None => f64::INFINITY,
        }
    }
}

/// Columns of length one.
fn scale(mut x: DMatrix<f64>) -> DMatrix<f64> {
    for mut c in x.column_iter_mut() {
        let size = c.norm();
        if size > 0.0 {
            c /= size;
        }
    }
    x
}

/// Fits a sine to the steps of a channel; `None` where the response does not bend.
pub fn fit(steps: &Steps, channel: usize) -> Option<Sine> {
    let rows = steps.rows_of(channel);
    let rate: Vec<f64> = rows.iter().map(|(_, p)| p.rate).collect();
    let outputs: Vec<f64> = rows.iter().map(|(_, p)| p.gyro[channel]).collect();
    let mean_slope = slope_of(&rate, &outputs)?;
    let n = rows.len();
    let full = rate.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
    let temperatures: Vec<f64> = rows.iter().map(|(_, p)| p.temperature).collect();
    let mean = temperatures.iter().sum::<f64>() / n as f64;
    let range = temperatures.iter().fold(f64::NEG_INFINITY, |m, t| m.max(*t))
        - temperatures.iter().fold(f64::INFINITY, |m, t| m.min(*t));
    let varies = range.is_finite() && range > 0.0;
    let temperature = if varies { temperatures.iter().map(|t| t - mean).collect() } else { vec![] };
    let data = Data { rate, y: DVector::from_vec(outputs), temperature };
    if n < data.columns(MAX_PHASE_RAD / full).len() + 3 {
        return None;
    }
    let kappa = search(|phase| data.left(phase / full)) / full;
    if !(kappa * full > MIN_PHASE_RAD * 1.02 && kappa * full < MAX_PHASE_RAD * 0.98) {
        return None;
    }
    let mut columns = data.columns(kappa);
    let bend = DVector::from_fn(n, |i, _| data.along(kappa, i) / kappa);
    if !is_linearly_independent(&bend, &columns[..2]) {
        return None;
    }
    columns.insert(KAPPA_COLUMN, bend);
    let x = DMatrix::from_columns(&columns);
    let sizes: Vec<f64> = x.column_iter().map(|c| c.norm()).collect();
    let grid = Rows {
        mid_s: rows.iter().map(|(_, p)| p.mid_s).collect(),
        length_s: rows.iter().map(|(_, p)| p.length_s).collect(),
        step: rows.iter().map(|(s, _)| *s).collect(),
    };
    // An error that repeats at a rate (of the table's gear, of a response that is no pure sine) is common to its steps.
    let level: Vec<usize> = rows.iter().map(|(s, _)| steps.list[*s].level).collect();
    let components = [grid.white(), grid.flicker(), grid.shared(&level)];
    let fixed = DMatrix::identity(n, n) * (1e-9 * data.y.variance());
    let fitted = reml::fit(&data.y, &scale(x.clone()), &fixed, &components)?.rescaled(&sizes);
    let dof = (n - columns.len()) as f64;
    let plain = ordinary(&x, &data.y)?;
    let left = &data.y - &x * plain;
    let slope = fitted.coefficient(SLOPE_COLUMN);
    let bent = fitted.coefficient(KAPPA_COLUMN);
    let straight = DMatrix::from_columns(&[columns[0].clone(), DVector::from_vec(data.rate.clone())]);
    let of_line = &data.y - &straight * ordinary(&straight, &data.y)?;
    let rms = |r: &DVector<f64>| (r.norm_squared() / n as f64).sqrt() / mean_slope.abs();
    Some(Sine {
        kappa: kappa + bent.value / slope.value,
        kappa_standard: (bent.standard / slope.value).abs(),
        slope: slope.value,
        mean_slope,
        rms: rms(&left),
        rms_of_line: rms(&of_line),
        dof,
        temperature_range: if varies { range } else { 0.0 },
        rows: rows.iter().zip(left.iter()).map(|((s, _), r)| (*s, r / mean_slope)).collect(),
        fit: fitted,
    })
}

/// Least squares with columns brought to one length.
fn ordinary(x: &DMatrix<f64>, y: &DVector<f64>) -> Option<DVector<f64>> {
    let sizes: Vec<f64> = x.column_iter().map(|c| c.norm()).collect();
    let scaled = scale(x.clone());
    let mut b = (scaled.transpose() * &scaled).cholesky()?.solve(&(scaled.transpose() * y));
    for (v, s) in b.iter_mut().zip(&sizes) {
        *v /= s;
    }
    Some(b)
}

/// The phase at full scale with the least cost: a grid, then golden sections.
fn search(cost: impl Fn(f64) -> f64) -> f64 {
    let (from, to) = (MIN_PHASE_RAD, MAX_PHASE_RAD);
    let at = |i: usize| from * (to / from).powf(i as f64 / (PHASE_GRID_POINTS - 1) as f64);
    let best = (0..PHASE_GRID_POINTS).min_by(|a, b| cost(at(*a)).total_cmp(&cost(at(*b)))).unwrap_or(0);
    golden_section(at(best.saturating_sub(1)), at((best + 1).min(PHASE_GRID_POINTS - 1)), 60, cost)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rate_table::steps::{Part, Step};

    #[test]
    fn a_pure_sine_comes_back() {
        // 0.25 rad per rad/s over ±150 deg/s: the phase of an open-loop gyro; gain −400 ppm/degC.
        let per_deg_h = 0.25 / 206_264.8;
        let mut steps = Steps::default();
        for i in 0..240usize {
            let level = i % 61;
            let rate = (level as f64 - 30.0) * 5.0 * 3600.0;
            let temperature = 48.0 + 5.0 * (i as f64 / 37.0).sin();
            let gain = 1.0 - 400e-6 * (temperature - 48.0);
            let jitter = 3.0 * ((i * 7919 % 101) as f64 / 50.0 - 1.0);
            let y = gain * (per_deg_h * rate).sin() / per_deg_h + 30.0 + jitter;
            let part = Part {
                mid_s: i as f64 * 16.0,
                length_s: 16.0,
                rate,
                outer: f64::NAN,
                temperature,
                gyro: vec![y],
                angle: (f64::NAN, f64::NAN),
            };
            steps.list.push(Step {
                from_s: i as f64 * 16.0,
                to_s: i as f64 * 16.0 + 16.0,
                first_row: i as u64 + 1,
                end_row: i as u64 + 2,
                rate,
                nominal: rate,
                outer: f64::NAN,
                temperature,
                gyro: vec![y],
                turns: 0.0,
                level,
                approach: 0,
                cycle: 0,
                parts: vec![part],
                unsettled: None,
            });
        }
        let found = fit(&steps, 0).unwrap();
        assert!((found.kappa / per_deg_h - 1.0).abs() < 1e-4, "{}", found.kappa / per_deg_h);
        let gain = found.fit.coefficient(GAIN_OVER_TEMPERATURE).value / found.slope;
        assert!((gain + 400.0).abs() < 2.0, "{gain}");
        assert!(found.rms < 2.5 && found.rms_of_line > 1000.0, "{} {}", found.rms, found.rms_of_line);
    }
}
