//! Scale factor and bias at every soak: one model of all soaks, in which the shape of the response is common.
//!
//! Every rate has its mean, and every soak but the first its change of the scale factor and of the bias. All that is stated of the
//! temperature is a difference between soaks, so the first one is no more certain than the others.

use super::design::Design;
use super::model::TAKEN_FROM;
use super::setup::Setup;
use super::soaks::{self, Soak};
use super::steps::TableRun;
use crate::message::{Note, note};
use crate::numeric::reml::{Combination, Fit};
use nalgebra::{DMatrix, DVector};

/// Soaks from which their scatter about a parabola is known where each goes through its rates once.
const MIN_SOAKS_FOR_SCATTER: usize = 5;
/// Coefficients of that parabola.
const PARABOLA_COEFFICIENTS: usize = 3;

/// Scatter of the scale factor between single cycles, where soaks alone show it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scatter {
    /// Variance, ppm².
    pub variance: f64,
    /// Its degrees of freedom.
    pub dof: f64,
}

/// The scale factor of a channel over temperature.
#[derive(Debug, Clone)]
pub struct ScaleOverTemperature {
    /// Soaks in order of time.
    pub soaks: Vec<Soak>,
    /// Soaks of one temperature together, by rising temperature: positions among `soaks`.
    pub points: Vec<Vec<usize>>,
    /// Scatter between cycles from the soaks; `None` where they repeat their rates, so that the fit itself knows it.
    pub scatter: Option<Scatter>,
    /// Offset, deg/h, and slope of the line at the first soak, as weights of the coefficients.
    line: [DVector<f64>; 2],
    /// Slope that the fit is made about.
    slope: f64,
    /// That slope relative to the mean scale factor of the points, which what is stated in ppm is a part of.
    relative: f64,
    /// Number of levels: the changes of the scale factor stand behind them, those of the bias behind these.
    levels: usize,
    fit: Fit,
}

/// Evaluates the gyro channel of this number.
///
/// # Errors
/// Why the recording does not show it.
pub fn evaluate(run: &TableRun, channel: usize, setup: &Setup) -> Result<ScaleOverTemperature, Note> {
    let tolerance = setup.soak_tolerance_deg_c;
    let soaks = soaks::find(&run.steps, tolerance);
    let points = soaks::by_temperature(&soaks, tolerance);
    if points.len() < 2 {
        return Err(note!("soaks.one_temperature", n = points.len()));
    }
    let repeated = soaks::in_cycles(&run.steps, &soaks);
    let undetermined = || note!("soaks.undetermined");
    let once = || soaks::as_cycles(&run.steps, &soaks);
    let chosen = repeated.clone().unwrap_or_else(|| super::steps::Steps { cycles: 1, ..once() });
    let design = Design::new(&chosen, channel, setup, &[]).ok_or_else(undetermined)?;
    let soak_of_row = rows_of(&design, &soaks);
    let change = |of: &dyn Fn(usize) -> f64| -> Vec<DVector<f64>> {
        let column = |soak| {
            DVector::from_fn(soak_of_row.len(), |i, _| if soak_of_row[i] == soak { of(i) } else { 0.0 })
        };
        (1..soaks.len()).map(column).collect()
    };
    let of_rate = |design: &Design, i: usize| 1e-6 * design.slope * design.rate[i];
    let biases = change(&|_| 1.0);
    let factors = change(&|i| of_rate(&design, i));
    let columns: Vec<DVector<f64>> =
        design.of_levels.iter().chain(&factors).chain(&biases).cloned().collect();
    let (fit, _) = design.fit(&columns, TAKEN_FROM).ok_or_else(undetermined)?;
    let scatter = match repeated {
        Some(_) => None,
        None if soaks.len() < MIN_SOAKS_FOR_SCATTER => {
            return Err(note!("soaks.one_cycle", least = MIN_SOAKS_FOR_SCATTER));
        }
        None => {
            let design = Design::new(&once(), channel, setup, &[]).ok_or_else(undetermined)?;
            let x = centred(&soak_of_row.iter().map(|s| soaks[*s].temperature).collect::<Vec<f64>>());
            let powers = [1, 2].map(|p| DVector::from_fn(x.len(), |i, _| of_rate(&design, i) * x[i].powi(p)));
            let columns: Vec<DVector<f64>> =
                design.of_levels.iter().chain(&powers).chain(&biases).cloned().collect();
            Some(scatter_of(&design, &columns, soaks.len()).ok_or_else(undetermined)?)
        }
    };
    let line = line_of(&design, columns.len()).ok_or_else(undetermined)?;
    let mut found = ScaleOverTemperature {
        points,
        scatter,
        line,
        slope: design.slope,
        relative: 1.0,
        levels: design.levels.len(),
        fit,
        soaks,
    };
    let factors: Vec<f64> = found.at_points().iter().map(|p| p.factor.value).collect();
    found.relative = found.slope * factors.len() as f64 / factors.iter().sum::<f64>();
    Ok(found)
}

/// The soak of each row.
fn rows_of(design: &Design, soaks: &[Soak]) -> Vec<usize> {
    let of_step: Vec<usize> = soaks.iter().enumerate().flat_map(|(at, s)| vec![at; s.steps.len()]).collect();
    design.step.iter().map(|step| of_step[*step]).collect()
}

/// Values from −1 to 1 over their range.
fn centred(values: &[f64]) -> Vec<f64> {
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    values.iter().map(|v| (2.0 * v - low - high) / (high - low)).collect()
}

/// Scatter of the soaks about a parabola over temperature: cycles that differ scatter by it, and so does a hysteresis.
fn scatter_of(design: &Design, columns: &[DVector<f64>], soaks: usize) -> Option<Scatter> {
    let (fit, names) = design.fit(columns, f64::NEG_INFINITY)?;
    let at = names.iter().position(|name| *name == "cycle")?;
    let full = design.rate.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
    let ppm = 1e6 / (design.slope * full);
    let dof = soaks.checked_sub(PARABOLA_COEFFICIENTS)? as f64;
    Some(Scatter { variance: fit.variance_components[at] * ppm * ppm, dof })
}

/// Offset and slope of the line of least squares through the means of the levels, as weights of so many coefficients.
fn line_of(design: &Design, coefficients: usize) -> Option<[DVector<f64>; 2]> {
    let levels = &design.levels;
    let a = DMatrix::from_fn(levels.len(), 2, |i, j| if j == 0 { 1.0 } else { levels[i] });
    let line = (a.transpose() * &a).try_inverse()? * a.transpose();
    let weights = |row: usize| {
        DVector::from_fn(coefficients, |i, _| if i < levels.len() { line[(row, i)] } else { 0.0 })
    };
    Some([weights(0), weights(1)])
}

/// Scale factor and bias at a temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Temperature, degC.
    pub temperature: f64,
    /// Scale factor, output per input.
    pub factor: Combination,
    /// Output of the line at rest, deg/h: the bias with the Earth rate along the axis.
    pub bias: Combination,
}

impl ScaleOverTemperature {
    /// Mean temperature of a point, degC.
    pub fn temperature_of(&self, point: usize) -> f64 {
        let own = &self.points[point];
        own.iter().map(|s| self.soaks[*s].temperature).sum::<f64>() / own.len() as f64
    }

    /// Temperatures of the points, degC, rising.
    pub fn temperatures(&self) -> Vec<f64> {
        (0..self.points.len()).map(|p| self.temperature_of(p)).collect()
    }

    /// Weights of the coefficients from weights of the soaks, behind the levels and so many coefficients more.
    fn of_soaks(&self, weights: &[f64], behind: usize, size: f64) -> DVector<f64> {
        let first = self.levels + behind;
        let mut all = DVector::zeros(self.fit.coefficients.len());
        weights.iter().skip(1).enumerate().for_each(|(i, w)| all[first + i] = size * w);
        all
    }

    /// Sum over the scale factors of the soaks with these weights, which add up to zero, ppm.
    pub fn contrast(&self, weights: &[f64]) -> Combination {
        let by_fit = self.fit.combine(&self.of_soaks(weights, 0, self.relative));
        let Some(scatter) = self.scatter else { return by_fit };
        let between = scatter.variance * weights.iter().map(|w| w * w).sum::<f64>();
        let within = by_fit.standard.powi(2);
        let total = within + between;
        let squares = within * within / by_fit.dof + between * between / scatter.dof;
        let dof = if squares > 0.0 { total * total / squares } else { by_fit.dof };
        Combination { standard: total.sqrt(), dof, ..by_fit }
    }

    /// Covariance of several such sums, ppm².
    pub fn covariance(&self, contrasts: &[Vec<f64>]) -> DMatrix<f64> {
        let columns: Vec<DVector<f64>> =
            contrasts.iter().map(|w| self.of_soaks(w, 0, self.relative)).collect();
        let a = DMatrix::from_columns(&columns);
        let by_fit = a.transpose() * &self.fit.covariance * &a;
        let between = self.scatter.map_or(0.0, |s| s.variance);
        let dot =
            |i: usize, j: usize| contrasts[i].iter().zip(&contrasts[j]).map(|(a, b)| a * b).sum::<f64>();
        DMatrix::from_fn(contrasts.len(), contrasts.len(), |i, j| by_fit[(i, j)] + between * dot(i, j))
    }

    /// Weights of the soaks that give the mean of a point.
    pub fn mean_of(&self, point: usize) -> Vec<f64> {
        let own = &self.points[point];
        let mut weights = vec![0.0; self.soaks.len()];
        own.iter().for_each(|s| weights[*s] = 1.0 / own.len() as f64);
        weights
    }

    /// Weights of the soaks that give the slope of the line of least squares through the points, 1/degC.
    pub fn slope_weights(&self) -> Vec<f64> {
        let temperatures = self.temperatures();
        let mean = temperatures.iter().sum::<f64>() / temperatures.len() as f64;
        let square: f64 = temperatures.iter().map(|t| (t - mean).powi(2)).sum();
        let mut weights = vec![0.0; self.soaks.len()];
        for (point, temperature) in temperatures.iter().enumerate() {
            for (w, m) in weights.iter_mut().zip(self.mean_of(point)) {
                *w += m * (temperature - mean) / square;
            }
        }
        weights
    }

    /// Standard deviation of the sum over the temperatures of the soaks with these weights, by the scatter of their steps.
    pub fn temperature_scatter(&self, weights: &[f64]) -> f64 {
        let own = weights.iter().zip(&self.soaks).map(|(w, s)| (w * s.temperature_standard).powi(2));
        own.sum::<f64>().sqrt()
    }

    /// Weights of the soaks that give the difference of two points.
    pub fn difference(&self, first: usize, second: usize) -> Vec<f64> {
        self.mean_of(first).iter().zip(self.mean_of(second)).map(|(a, b)| a - b).collect()
    }

    /// Weights of the soaks that give the difference between heating and cooling at a point, at one temperature by the slope of the
    /// line; `None` where it was not reached both ways.
    pub fn both_ways(&self, point: usize) -> Option<Vec<f64>> {
        let own = &self.points[point];
        let way = |direction: i8| -> Vec<usize> {
            own.iter().copied().filter(|s| self.soaks[*s].direction == direction).collect()
        };
        let (up, down) = (way(1), way(-1));
        if up.is_empty() || down.is_empty() {
            return None;
        }
        let mean =
            |of: &[usize]| of.iter().map(|s| self.soaks[*s].temperature).sum::<f64>() / of.len() as f64;
        let apart = mean(&up) - mean(&down);
        let mut weights: Vec<f64> = self.slope_weights().iter().map(|w| -apart * w).collect();
        up.iter().for_each(|s| weights[*s] += 1.0 / up.len() as f64);
        down.iter().for_each(|s| weights[*s] -= 1.0 / down.len() as f64);
        Some(weights)
    }

    /// Scale factor and bias at every temperature, both ways averaged.
    pub fn at_points(&self) -> Vec<Point> {
        let changes = self.soaks.len() - 1;
        let of = |point: usize| {
            let weights = self.mean_of(point);
            let factor = &self.line[1] + self.of_soaks(&weights, 0, 1e-6 * self.slope);
            let bias = &self.line[0] + self.of_soaks(&weights, changes, 1.0);
            let factor = self.fit.combine(&factor);
            let between =
                self.scatter.map_or(0.0, |s| s.variance) * weights.iter().map(|w| w * w).sum::<f64>();
            let standard = factor.standard.hypot(1e-6 * self.slope * between.sqrt());
            let factor = Combination { value: self.slope + factor.value, standard, ..factor };
            Point { temperature: self.temperature_of(point), factor, bias: self.fit.combine(&bias) }
        };
        (0..self.points.len()).map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::compensation::ScaleCompensation;
    use super::super::soaks::tests::recorded;
    use super::*;

    const RATES: [f64; 3] = [1e5, 0.0, -1e5];

    /// A run through the rates, so many times at each temperature, of a unit with these deviations, ppm, and biases, deg/h.
    fn run(soaks: &[(f64, f64, f64)], cycles: usize) -> TableRun {
        let of_soak = |(temperature, ppm, bias): &(f64, f64, f64)| {
            let output = |rate: &f64| (*rate, rate * (1.0 + 1e-6 * ppm) + bias, *temperature);
            RATES.iter().cycle().take(RATES.len() * cycles).map(output).collect::<Vec<_>>()
        };
        let steps = recorded(&soaks.iter().flat_map(of_soak).collect::<Vec<_>>());
        let mut run = TableRun { steps, ..TableRun::default() };
        run.blocks.gyros = vec!["g".into()];
        run
    }

    /// Two numbers agree to a part of the second.
    fn within(found: f64, expected: f64, part: f64) {
        assert!((found - expected).abs() <= part * expected.abs(), "{found} {expected}");
    }

    fn found(soaks: &[(f64, f64, f64)], cycles: usize) -> ScaleOverTemperature {
        evaluate(&run(soaks, cycles), 0, &Setup::default()).unwrap()
    }

    /// Up and back: 3 ppm/degC, 4 ppm more by heating at 20 degC; −40 is first, and at the end.
    const LOOP: [(f64, f64, f64); 5] = [
        (-40.0, -120.0, 1.0),
        (20.0, 62.0, 2.0),
        (80.0, 240.0, 3.0),
        (20.5, 59.5, 2.0),
        (-40.0, -120.0, 1.0),
    ];

    #[test]
    fn differences_of_soaks_are_those_of_the_unit_in_parts_of_its_scale_factor() {
        let unit = found(&LOOP, 2);
        assert_eq!(unit.points, [vec![0, 4], vec![1, 3], vec![2]]);
        assert_eq!(unit.scatter, None);
        // Relative to the mean factor of 1 + 60.25e-6.
        let mean = 1.0 + 1e-6 * (240.0 - 120.0 + 60.75) / 3.0;
        let whole = unit.contrast(&unit.difference(2, 0));
        within(whole.value, 360.0 / mean, 1e-7);
        assert!(whole.standard > 0.0 && whole.dof > 5.0, "{whole:?}");
        // The line through −40, 20.25, 80 degC and −120, 60.75, 240 ppm.
        within(unit.contrast(&unit.slope_weights()).value, 3.0 / mean, 1e-3);
        // Both ways at one temperature: 62 − 59.5 + 0.5·3.
        within(unit.contrast(&unit.both_ways(1).unwrap()).value, 4.0, 1e-3);
        assert_eq!((unit.both_ways(0), unit.both_ways(2)), (None, None));
    }

    #[test]
    fn the_covariance_of_differences_is_that_of_each() {
        for cycles in [1, 2] {
            let unit = found(&LOOP, cycles);
            let list = vec![unit.difference(2, 0), unit.difference(1, 0), unit.slope_weights()];
            let covariance = unit.covariance(&list);
            for (i, weights) in list.iter().enumerate() {
                within(covariance[(i, i)].sqrt(), unit.contrast(weights).standard, 1e-9);
            }
        }
    }

    #[test]
    fn the_compensation_table_has_factor_and_bias_of_every_temperature() {
        let unit = found(&LOOP, 2);
        let table = ScaleCompensation::of(&unit, "g", Some("S"), 1e5);
        assert_eq!(table.temperature_deg_c, [-40.0, 20.25, 80.0]);
        let close = |found: &[f64], expected: [f64; 3]| {
            found.iter().zip(expected).for_each(|(f, e)| assert!((f - e).abs() < 1e-6, "{found:?}"));
        };
        close(&table.scale_factor_error_ppm, [-120.0, 60.75, 240.0]);
        close(&table.bias_deg_h, [1.0, 2.0, 3.0]);
        assert!(table.header().contains("COMP_G_SF_POINTS 3"), "{}", table.header());
    }

    #[test]
    fn soaks_gone_through_once_scatter_about_a_parabola() {
        // Orthogonal polynomials of five even temperatures leave of these what follows.
        let off = [0.0, 500.0, 300.0, 100.0, -800.0];
        let soaks: Vec<(f64, f64, f64)> =
            off.iter().enumerate().map(|(i, ppm)| (20.0 * i as f64, *ppm, 0.0)).collect();
        let unit = found(&soaks, 1);
        let scatter = unit.scatter.unwrap();
        within(scatter.dof, 2.0, 1e-9);
        let (linear, square) = ([-2.0, -1.0, 0.0, 1.0, 2.0], [2.0, -1.0, -2.0, -1.0, 2.0]);
        let dot = |a: &[f64; 5], b: &[f64; 5]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let left = dot(&off, &off) - dot(&off, &linear).powi(2) / 10.0 - dot(&off, &square).powi(2) / 14.0;
        assert!((scatter.variance - left / 2.0).abs() < 0.15 * left / 2.0, "{scatter:?} {left}");
    }

    #[test]
    fn what_a_recording_does_not_show_is_named() {
        let why = |soaks: &[(f64, f64, f64)], cycles| {
            evaluate(&run(soaks, cycles), 0, &Setup::default()).map(|_| ()).map_err(|n| n.id.into_owned())
        };
        assert_eq!(why(&LOOP[..1], 2), Err("soaks.one_temperature".to_owned()));
        assert_eq!(why(&LOOP[..3], 1), Err("soaks.one_cycle".to_owned()));
        assert_eq!(why(&LOOP[..3], 2), Ok(()));
    }
}
