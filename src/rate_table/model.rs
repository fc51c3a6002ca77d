//! The response of one channel: a mean for every level of rate, and what else moves the output.

use super::noise::Rows;
use super::steps::{Part, Steps};
use super::{Setup, blocks::TURN_ARCSEC};
use crate::numeric::reml::{self, Combination, Fit};
use nalgebra::{DMatrix, DVector};

/// Gain of twice the log-likelihood from which a kind of noise that is not always there is taken for real: by chance it
/// comes about in one test of ten.
pub(super) const TAKEN_FROM: f64 = 1.64;

/// What moves the output beside the rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extra {
    /// Half the difference between rates reached from below and from above, deg/h.
    Approach,
    /// Change of the scale factor with temperature, 1e-6/degC.
    ScaleOverTemperature,
    /// Change of the bias with temperature, deg/h/degC.
    BiasOverTemperature,
    /// cos ψ of the table angle, deg/h.
    Cosine(u8),
    /// sin ψ of the table angle, deg/h.
    Sine(u8),
}

/// The fitted response of a channel.
#[derive(Debug, Clone)]
pub struct Response {
    /// The model over levels and extras. Outputs are fitted about `slope` times the rate.
    pub fit: Fit,
    /// Slope that the fit is made about.
    pub slope: f64,
    /// Mean rate of the levels, deg/h.
    pub levels: Vec<f64>,
    /// Extras in the model, in the order of the columns behind the levels.
    pub extras: Vec<Extra>,
    /// Extras that were asked for and that the test does not show.
    pub hidden: Vec<Extra>,
    /// Mean temperature of the test, degC.
    pub temperature: f64,
    /// Range of the temperature, degC.
    pub temperature_range: f64,
    /// Rows: step, and what the response leaves of each, deg/h.
    pub rows: Vec<(usize, f64)>,
    /// Strengths of the noise by name.
    pub noise: Vec<(&'static str, f64)>,
}

impl Response {
    /// A combination of the means of levels.
    pub fn of_levels(&self, weights: &[f64]) -> Combination {
        let mut w = DVector::zeros(self.fit.coefficients.len());
        for (to, from) in w.iter_mut().zip(weights) {
            *to = *from;
        }
        self.fit.combine(&w)
    }

    /// The coefficient of an extra.
    pub fn extra(&self, extra: Extra) -> Option<Combination> {
        let at = self.extras.iter().position(|e| *e == extra)?;
        Some(self.fit.coefficient(self.levels.len() + at))
    }

    /// Covariance of the coefficients of two extras; 0 where one is not in the model.
    pub fn covariance_of(&self, first: Extra, second: Extra) -> f64 {
        let at = |e: Extra| self.extras.iter().position(|x| *x == e).map(|i| i + self.levels.len());
        at(first).zip(at(second)).map_or(0.0, |p| self.fit.covariance[p])
    }

    /// Covariance of the means of levels, (deg/h)².
    pub fn level_covariance(&self) -> DMatrix<f64> {
        let l = self.levels.len();
        self.fit.covariance.view((0, 0), (l, l)).into_owned()
    }

    /// Means of levels about the slope, deg/h.
    pub fn level_means(&self) -> Vec<f64> {
        self.fit.coefficients.iter().take(self.levels.len()).copied().collect()
    }
}

/// Fits the response of a channel; `None` when the steps do not determine it.
pub fn fit(steps: &Steps, channel: usize, setup: &Setup, wanted: &[Extra]) -> Option<Response> {
    let rows: Vec<(usize, &Part)> = steps
        .list
        .iter()
        .enumerate()
        .flat_map(|(s, step)| step.parts.iter().map(move |p| (s, p)))
        .filter(|(_, p)| p.gyro.get(channel).is_some_and(|g| g.is_finite()) && p.rate.is_finite())
        .collect();
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
    let levels: Vec<f64> = levels.iter().map(|(sum, n)| sum / n).collect();
    let temperatures: Vec<f64> = rows.iter().map(|(_, p)| p.temperature).collect();
    let known = temperatures.iter().all(|t| t.is_finite());
    let temperature = temperatures.iter().sum::<f64>() / n as f64;
    let range = temperatures.iter().fold(f64::NEG_INFINITY, |m, t| m.max(*t))
        - temperatures.iter().fold(f64::INFINITY, |m, t| m.min(*t));
    // The mean of a level is that at the mean rate of the level.
    let z = DVector::from_fn(n, |i, _| y[i] - slope * rate[i]);
    let mut columns: Vec<DVector<f64>> =
        (0..count).map(|l| DVector::from_fn(n, |i, _| if level_of[i] == l { 1.0 } else { 0.0 })).collect();
    let (mut extras, mut hidden) = (Vec::new(), Vec::new());
    for extra in wanted {
        let column = match extra {
            Extra::Approach => Some(DVector::from_fn(n, |i, _| f64::from(steps.list[rows[i].0].approach))),
            Extra::ScaleOverTemperature if known => {
                Some(DVector::from_fn(n, |i, _| (temperatures[i] - temperature) * slope * rate[i] * 1e-6))
            }
            Extra::BiasOverTemperature if known => {
                Some(DVector::from_fn(n, |i, _| temperatures[i] - temperature))
            }
            Extra::Cosine(order) => harmonic(&rows, *order, true),
            Extra::Sine(order) => harmonic(&rows, *order, false),
            _ => None,
        };
        match column.filter(|c| stands_out(c, &columns)) {
            Some(c) => {
                columns.push(c);
                extras.push(*extra);
            }
            None => hidden.push(*extra),
        }
    }
    let x = DMatrix::from_columns(&columns);
    let grid = Rows {
        mid_s: rows.iter().map(|(_, p)| p.mid_s).collect(),
        length_s: rows.iter().map(|(_, p)| p.length_s).collect(),
        step: rows.iter().map(|(s, _)| *s).collect(),
    };
    let mut names: Vec<&'static str> = vec!["white", "angle", "flicker", "random_walk"];
    let mut components = vec![grid.white(), grid.angle(), grid.flicker(), grid.random_walk()];
    let visited_again = steps.list.len() > steps.levels.len();
    let divided = steps.list.iter().any(|s| s.parts.len() > 1);
    // What may differ between steps and between cycles, taken only where the test speaks for it.
    let mut further: Vec<(&'static str, DMatrix<f64>)> = Vec::new();
    if visited_again && divided {
        further.push(("step", grid.shared(&grid.step)));
    }
    if !divided {
        // One row a step: a reading at the ends cannot be told from what is white.
        names.remove(1);
        components.remove(1);
    }
    if steps.cycles >= 2 {
        let cycle: Vec<usize> = rows.iter().map(|(s, _)| steps.list[*s].cycle).collect();
        let full = rate.iter().fold(0.0, |m: f64, r| m.max(r.abs())).max(1e-12);
        let alike = |i, j| if cycle[i] == cycle[j] { rate[i] * rate[j] / (full * full) } else { 0.0 };
        further.push(("cycle", DMatrix::from_fn(n, n, alike)));
    }
    let scatter = z.variance().max(f64::MIN_POSITIVE);
    let read = slope * setup.angle_uncertainty_arcsec;
    let readings = if setup.by_angle { grid.angle() * (read * read) } else { DMatrix::zeros(n, n) };
    let fixed = readings + DMatrix::identity(n, n) * (1e-9 * scatter);
    let mut fit = reml::fit(&z, &x, &fixed, &components)?;
    for (name, component) in further {
        components.push(component);
        match reml::fit(&z, &x, &fixed, &components) {
            Some(better) if better.twice_log_likelihood > fit.twice_log_likelihood + TAKEN_FROM => {
                fit = better;
                names.push(name);
            }
            _ => {
                components.pop();
            }
        }
    }
    let left = rows.iter().zip(fit.residuals.iter()).map(|((s, _), r)| (*s, *r)).collect();
    let noise = names.into_iter().zip(fit.strengths.iter().copied()).collect();
    Some(Response {
        fit,
        slope,
        levels,
        extras,
        hidden,
        temperature,
        temperature_range: if known { range } else { 0.0 },
        rows: left,
        noise,
    })
}

/// Least squares through the middle of both: the slope that residuals are taken about. `None` without two rates.
pub(super) fn slope_of(x: &[f64], y: &[f64]) -> Option<f64> {
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sxx: f64 = x.iter().map(|v| (v - mx) * (v - mx)).sum();
    let sxy: f64 = x.iter().zip(y).map(|(a, b)| (a - mx) * (b - my)).sum();
    (sxx > 0.0).then(|| sxy / sxx).filter(|s| s.is_finite() && *s != 0.0)
}

/// True when a column is not made of the others.
pub(super) fn stands_out(column: &DVector<f64>, others: &[DVector<f64>]) -> bool {
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
