//! The rows of a channel, what moves them beside the rate, and the kinds of noise they may have.

use super::blocks::TURN_ARCSEC;
use super::noise::Rows;
use super::setup::Setup;
use super::steps::{Part, Steps};
use crate::numeric::reml::{self, Fit};
use nalgebra::{DMatrix, DVector};

/// What moves the output beside the rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extra {
    /// Half the difference between rates reached from below and from above, deg/h.
    Approach,
    /// Change of the scale factor with temperature, 1e-6/degC.
    ScaleOverTemperature,
    /// Change of the bias with temperature, deg/h/degC.
    BiasOverTemperature,
    /// Change of the tilts with temperature, where the outer axis turns; no column of the response to the inner axis.
    TiltOverTemperature,
    /// cos ψ of the table angle, deg/h.
    Cosine(u8),
    /// sin ψ of the table angle, deg/h.
    Sine(u8),
}

/// A kind of noise: its name, and the covariance of the rows that it makes at a strength of one.
type Kind = (&'static str, DMatrix<f64>);

/// Rows of the fit of a channel.
pub struct Design {
    /// Step of each row.
    pub step: Vec<usize>,
    /// Rate of each row, deg/h.
    pub rate: Vec<f64>,
    /// Slope that the fit is made about.
    pub slope: f64,
    /// Outputs about that slope, deg/h.
    pub left: DVector<f64>,
    /// Mean rate of the levels, deg/h.
    pub levels: Vec<f64>,
    /// One column for every level.
    pub of_levels: Vec<DVector<f64>>,
    /// One for every extra that has one.
    pub of_extras: Vec<DVector<f64>>,
    /// Extras that have a column.
    pub extras: Vec<Extra>,
    /// Extras that the test does not show.
    pub hidden: Vec<Extra>,
    /// Mean temperature of the test, degC.
    pub temperature: f64,
    /// Range of the temperature, degC; 0 without one.
    pub temperature_range: f64,
    /// Covariance of the noise that is known, (deg/h)².
    pub fixed: DMatrix<f64>,
    /// Noise of the rate itself and of readings.
    pub quick: Vec<Kind>,
    /// Drift over the test.
    pub slow: Vec<Kind>,
    /// What may differ between steps and between cycles.
    pub further: Vec<Kind>,
}

impl Design {
    /// `None` when the steps do not determine a response.
    pub fn new(steps: &Steps, channel: usize, setup: &Setup, wanted: &[Extra]) -> Option<Design> {
        let rows = steps.rows_of(channel);
        let n = rows.len();
        let y: Vec<f64> = rows.iter().map(|(_, p)| p.gyro[channel]).collect();
        let rate: Vec<f64> = rows.iter().map(|(_, p)| p.rate).collect();
        let slope = slope_of(&rate, &y)?;
        // Levels that have rows, in order.
        let mut level_of: Vec<usize> = rows.iter().map(|(s, _)| steps.list[*s].level).collect();
        let mut present = level_of.clone();
        present.sort_unstable();
        present.dedup();
        level_of.iter_mut().for_each(|l| *l = present.iter().position(|p| p == l).unwrap_or(0));
        let count = present.len();
        if count < 2 || n < count + 2 {
            return None;
        }
        let mut levels = vec![(0.0, 0.0); count];
        for (l, r) in level_of.iter().zip(&rate) {
            levels[*l] = (levels[*l].0 + r, levels[*l].1 + 1.0);
        }
        let temperatures: Vec<f64> = rows.iter().map(|(_, p)| p.temperature).collect();
        let known = temperatures.iter().all(|t| t.is_finite());
        let temperature = temperatures.iter().sum::<f64>() / n as f64;
        let range = temperatures.iter().fold(f64::NEG_INFINITY, |m, t| m.max(*t))
            - temperatures.iter().fold(f64::INFINITY, |m, t| m.min(*t));
        // The mean of a level is that at the mean rate of the level.
        let left = DVector::from_fn(n, |i, _| y[i] - slope * rate[i]);
        let of_levels: Vec<DVector<f64>> = (0..count)
            .map(|l| DVector::from_fn(n, |i, _| if level_of[i] == l { 1.0 } else { 0.0 }))
            .collect();
        let of_rows = |value: &dyn Fn(usize) -> f64| DVector::from_fn(n, |i, _| value(i));
        let mut columns = of_levels.clone();
        let (mut extras, mut hidden) = (Vec::new(), Vec::new());
        for extra in wanted {
            let column = match extra {
                Extra::Approach => Some(of_rows(&|i| f64::from(steps.list[rows[i].0].approach))),
                Extra::ScaleOverTemperature if known => {
                    Some(of_rows(&|i| (temperatures[i] - temperature) * slope * rate[i] * 1e-6))
                }
                Extra::BiasOverTemperature if known => Some(of_rows(&|i| temperatures[i] - temperature)),
                Extra::Cosine(order) => harmonic(&rows, *order, true),
                Extra::Sine(order) => harmonic(&rows, *order, false),
                _ => None,
            };
            match column.filter(|c| is_linearly_independent(c, &columns)) {
                Some(c) => {
                    columns.push(c);
                    extras.push(*extra);
                }
                None => hidden.push(*extra),
            }
        }
        let grid = Rows {
            mid_s: rows.iter().map(|(_, p)| p.mid_s).collect(),
            length_s: rows.iter().map(|(_, p)| p.length_s).collect(),
            step: rows.iter().map(|(s, _)| *s).collect(),
        };
        let (quick, further) = kinds(steps, &rows, &rate, &grid);
        let scatter = left.variance().max(f64::MIN_POSITIVE);
        let read = slope * setup.angle_uncertainty_arcsec;
        let readings = if setup.by_angle { grid.angle() * (read * read) } else { DMatrix::zeros(n, n) };
        Some(Design {
            slow: vec![("flicker", grid.flicker()), ("random_walk", grid.random_walk())],
            quick,
            further,
            fixed: readings + DMatrix::identity(n, n) * (1e-9 * scatter),
            of_extras: columns.split_off(count),
            of_levels,
            levels: levels.iter().map(|(sum, n)| sum / n).collect(),
            temperature,
            temperature_range: if known { range } else { 0.0 },
            extras,
            hidden,
            step: grid.step,
            rate,
            slope,
            left,
        })
    }

    /// Fits columns with quick and slow noise, and with each further kind where twice the log-likelihood gains more than
    /// `taken_from` by it. Gives the fit and the names of its strengths.
    pub fn fit(&self, columns: &[DVector<f64>], taken_from: f64) -> Option<(Fit, Vec<&'static str>)> {
        let x = DMatrix::from_columns(columns);
        let (mut names, mut components): (Vec<_>, Vec<_>) =
            self.quick.iter().chain(&self.slow).map(|(name, v)| (*name, v.clone())).unzip();
        let mut fit = reml::fit(&self.left, &x, &self.fixed, &components)?;
        for (name, component) in &self.further {
            components.push(component.clone());
            match reml::fit(&self.left, &x, &self.fixed, &components) {
                Some(better) if better.twice_log_likelihood > fit.twice_log_likelihood + taken_from => {
                    fit = better;
                    names.push(*name);
                }
                _ => {
                    components.pop();
                }
            }
        }
        Some((fit, names))
    }
}

/// The noise of the rate itself and of readings, and what may differ between steps and between cycles.
fn kinds(steps: &Steps, rows: &[(usize, &Part)], rate: &[f64], grid: &Rows) -> (Vec<Kind>, Vec<Kind>) {
    let visited_again = steps.list.len() > steps.levels.len();
    let divided = steps.list.iter().any(|s| s.parts.len() > 1);
    let mut quick = vec![("white", grid.white())];
    // One row a step: a reading at the ends cannot be told from what is white.
    if divided {
        quick.push(("angle", grid.angle()));
    }
    let mut further: Vec<Kind> = Vec::new();
    if visited_again && divided {
        further.push(("step", grid.shared(&grid.step)));
    }
    if steps.cycles >= 2 {
        let cycle: Vec<usize> = rows.iter().map(|(s, _)| steps.list[*s].cycle).collect();
        let full = rate.iter().fold(0.0, |m: f64, r| m.max(r.abs())).max(1e-12);
        let alike = |i, j| if cycle[i] == cycle[j] { rate[i] * rate[j] / (full * full) } else { 0.0 };
        further.push(("cycle", DMatrix::from_fn(rows.len(), rows.len(), alike)));
    }
    (quick, further)
}

/// Least squares through the middle of both: the slope that residuals are taken about. `None` without two rates.
pub fn slope_of(x: &[f64], y: &[f64]) -> Option<f64> {
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sxx: f64 = x.iter().map(|v| (v - mx) * (v - mx)).sum();
    let sxy: f64 = x.iter().zip(y).map(|(a, b)| (a - mx) * (b - my)).sum();
    (sxx > 0.0).then(|| sxy / sxx).filter(|s| s.is_finite() && *s != 0.0)
}

/// True when a column is not made of the others.
pub fn is_linearly_independent(column: &DVector<f64>, others: &[DVector<f64>]) -> bool {
    let size = column.norm();
    if !(size > 0.0 && size.is_finite()) {
        return false;
    }
    let x = DMatrix::from_columns(others);
    let Some(normal) = (x.transpose() * &x).cholesky() else { return false };
    let rest = column - &x * normal.solve(&(x.transpose() * column));
    rest.norm() > 0.02 * size
}

/// The mean over each row of cos or sin of a multiple of the table angle; `None` without an angle.
fn harmonic(rows: &[(usize, &Part)], order: u8, cosine: bool) -> Option<DVector<f64>> {
    let per_arcsec = f64::from(order) * 2.0 * std::f64::consts::PI / TURN_ARCSEC;
    let mean = |(a, b): (f64, f64)| {
        let (a, b) = (a * per_arcsec, b * per_arcsec);
        match ((b - a).abs() > 1e-6, cosine) {
            (true, true) => (b.sin() - a.sin()) / (b - a),
            (true, false) => (a.cos() - b.cos()) / (b - a),
            (false, true) => a.cos(),
            (false, false) => a.sin(),
        }
    };
    let values: Vec<f64> = rows.iter().map(|(_, p)| mean(p.angle)).collect();
    values.iter().all(|v| v.is_finite()).then(|| DVector::from_vec(values))
}
