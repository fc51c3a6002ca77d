//! Repeatability of the bias from switching on to switching on.

use super::contrasts::{Contrasts, Means, coefficient};
use super::copied::{self, Copied};
use super::cut::{cut, span_s};
use super::flicker_marginal;
use super::gls;
use super::range::{self, PossibleMeans, Range};
use super::runs::Runs;
use crate::estimate::{Spread, chi_square_quantile};
use crate::numeric::reml::Combination;
use crate::rate_table::blocks::Blocks;
use nalgebra::{DMatrix, DVector};

/// One run of one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct RunMean {
    /// Phase or name of its file.
    pub name: String,
    /// Start and end of what was evaluated, s from the start of the recording.
    pub span_s: (f64, f64),
    /// First row.
    pub row: u64,
    /// Bias, deg/h.
    pub bias: Combination,
    /// Mean temperature, degC; NaN without one.
    pub temperature: f64,
}

/// A series of runs.
#[derive(Debug, Clone)]
pub struct Repeatability {
    /// Channel.
    pub channel: String,
    /// The runs.
    pub runs: Vec<RunMean>,
    /// Mean of the runs, each with the same weight, deg/h.
    pub mean: f64,
    /// Standard deviation between runs, their noise taken out, deg/h, and its confidence distribution.
    pub deviation: (f64, Spread),
    /// Standard deviation of the means as they are, deg/h.
    pub plain: f64,
    /// Range of the true biases of the runs, deg/h.
    pub range: Range,
    /// Change from the first run to the last by the line through all, what goes with their temperature left out, deg/h.
    pub trend: Option<Combination>,
    /// Correlation of the temperature of the runs with their order; `None` where no temperature tells.
    pub in_step: Option<f64>,
    /// Change with the temperature of the runs, what goes with their order left out.
    pub temperature: Option<OverTemperature>,
    /// Two runs that are one.
    pub copied: Option<Copied>,
}

/// What goes with the temperature of the runs.
#[derive(Debug, Clone, PartialEq)]
pub struct OverTemperature {
    /// Slope, deg/h/degC.
    pub slope: Combination,
    /// Standard deviation between runs that is left, deg/h.
    pub left: f64,
    /// Share of the variance between runs that goes with it.
    pub share: f64,
    /// Range of the temperatures, degC.
    pub range: f64,
}

/// Evaluates the runs of a channel; `earth_deg_h` is taken out of every mean. `None` with fewer than two runs.
pub fn evaluate(blocks: &Blocks, runs: &Runs, gyro: usize, earth_deg_h: f64) -> Option<Repeatability> {
    let spans: Vec<(usize, usize)> = runs.list.iter().map(|r| r.blocks).collect();
    let count = spans.len();
    if count < 2 {
        return None;
    }
    let cut = cut(blocks, &spans, gyro)?.without_pauses();
    let n = cut.rows.len();
    let x = DMatrix::from_fn(n, count, |i, j| if cut.of[i] == j { 1.0 } else { 0.0 });
    let fixed = DMatrix::identity(n, n) * (1e-9 * cut.y.variance()).max(f64::MIN_POSITIVE);
    let components = [cut.rows.white(), cut.rows.angle(), cut.rows.flicker(), cut.rows.random_walk()];
    let fit = gls::pruned_fit(&cut.y, &x, &fixed, &components, 0)?;
    let temperature = |run: usize| {
        let of: Vec<f64> = (0..n).filter(|i| cut.of[*i] == run).map(|i| cut.temperature[i]).collect();
        of.iter().sum::<f64>() / of.len() as f64
    };
    let list: Vec<RunMean> = runs
        .list
        .iter()
        .enumerate()
        .map(|(i, run)| {
            let (first, last) = (&blocks.list[run.blocks.0], &blocks.list[run.blocks.1 - 1]);
            let c = fit.coefficient(i);
            RunMean {
                name: run.name.clone(),
                span_s: (span_s(blocks, first).0, span_s(blocks, last).1),
                row: first.first_row,
                bias: Combination { value: c.value - earth_deg_h, ..c },
                temperature: temperature(i),
            }
        })
        .collect();
    let means = Means { values: fit.coefficients.clone(), noise: fit.covariance.clone() };
    let ones = DMatrix::from_element(count, 1, 1.0);
    let contrasts = Contrasts::new(&means, &ones)?;
    // Without a strength of flicker that can be fitted there is the noise that was identified.
    let possible = flicker_marginal::means(&cut, &x, &fixed).unwrap_or_else(|| {
        let dof = fit.coefficient(0).dof;
        vec![PossibleMeans { weight: 1.0, values: means.values.clone(), noise: means.noise.clone(), dof }]
    });
    // The coefficient of the first of several courses over the runs, beside the others, and the variance that is left.
    let line = |over: &[&[f64]]| -> Option<(Combination, f64)> {
        let middle = |course: &[f64]| course.iter().sum::<f64>() / count as f64;
        let x = DMatrix::from_fn(count, over.len() + 1, |i, j| match j.checked_sub(1) {
            None => 1.0,
            Some(k) => over[k][i] - middle(over[k]),
        });
        let left = Contrasts::new(&means, &x)?.variance();
        Some((coefficient(&means, &x, 1, left)?, left))
    };
    let order: Vec<f64> = (0..count).map(|i| i as f64 / (count - 1) as f64).collect();
    let temperatures: Vec<f64> = list.iter().map(|r| r.temperature).collect();
    let span = temperatures.iter().fold(f64::NEG_INFINITY, |m, t| m.max(*t))
        - temperatures.iter().fold(f64::INFINITY, |m, t| m.min(*t));
    let known = count >= 4 && temperatures.iter().all(|t| t.is_finite()) && span > 1e-6;
    // A change with the order of the runs may be one of their temperature, and the reverse: each is stated beside the other.
    let trend = match known {
        true => line(&[&order, &temperatures]),
        false if count >= 4 => line(&[&order]),
        false => None,
    };
    let slope = known.then(|| Some((line(&[&temperatures, &order])?.0, line(&[&temperatures])?.1))).flatten();
    let whole = contrasts.variance();
    Some(Repeatability {
        channel: blocks.gyros.get(gyro)?.clone(),
        mean: list.iter().map(|r| r.bias.value).sum::<f64>() / count as f64,
        deviation: flicker_marginal::deviation(&possible).unwrap_or_else(|| contrasts.deviation()),
        plain: means.values.deviation_of_sample(),
        range: range::range(&possible)?,
        trend: trend.map(|l| l.0),
        in_step: known.then(|| correlation(&order, &temperatures)),
        temperature: slope.map(|(slope, left)| OverTemperature {
            slope,
            left: left.sqrt(),
            share: if whole > 0.0 { (1.0 - left / whole).clamp(0.0, 1.0) } else { 0.0 },
            range: span,
        }),
        copied: copied::find(blocks, &spans, gyro),
        runs: list,
    })
}

/// Correlation of two courses.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let middle = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (ma, mb) = (middle(a), middle(b));
    let product = |x: &[f64], mx: f64, y: &[f64], my: f64| -> f64 {
        x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum()
    };
    product(a, ma, b, mb) / (product(a, ma, a, ma) * product(b, mb, b, mb)).sqrt()
}

/// The standard deviation of a sample.
trait Sample {
    fn deviation_of_sample(&self) -> f64;
}

impl Sample for DVector<f64> {
    fn deviation_of_sample(&self) -> f64 {
        let mean = self.mean();
        (self.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (self.len().max(2) - 1) as f64).sqrt()
    }
}

/// Factors on a standard deviation of so many runs between which it lies, 95 %.
pub fn factors(runs: usize) -> (f64, f64) {
    let dof = runs.saturating_sub(1).max(1) as f64;
    let factor = |p: f64| (dof / chi_square_quantile(p, dof)).sqrt();
    (factor(0.975), factor(0.025))
}
