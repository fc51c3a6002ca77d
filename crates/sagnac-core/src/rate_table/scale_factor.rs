//! Scale factor and what belongs to it, from a series of steps.
//!
//! The line is that of least squares through the means of the levels, each with the same weight. K is output per input;
//! outputs are read with the nominal scale factor of the procedure, so that K = 1 is a unit that is just as stated.

use super::design::Extra;
use super::largest::{Largest, largest};
use super::model::{self, Response};
use super::setup::Setup;
use super::steps::{Steps, TableRun};
use crate::numeric::reml::Combination;
use crate::units::RateUnit;
use nalgebra::{DMatrix, DVector};

/// Name of the method of estimates that come from the line.
pub const METHOD: &str = "table_levels";

/// One step against the line.
#[derive(Debug, Clone, PartialEq)]
pub struct StepResidual {
    /// Position of the step in [`Steps::list`].
    pub step: usize,
    /// Output about the line, deg/h.
    pub residual: f64,
    /// Standard uncertainty of it, deg/h.
    pub standard: f64,
}

/// A channel evaluated.
#[derive(Debug, Clone)]
pub struct ScaleFactor {
    /// Channel.
    pub channel: String,
    /// Its response.
    pub response: Response,
    /// Scale factor, output per input.
    pub factor: f64,
    /// Bias of the line, deg/h, the Earth rate included.
    pub bias: f64,
    /// Full scale, deg/h.
    pub full_scale: f64,
    /// Residual of each level about the line, deg/h, with its standard uncertainty.
    pub levels: Vec<(f64, f64)>,
    /// Each step about the line.
    pub steps: Vec<StepResidual>,
    /// The largest residual of a level, deg/h.
    pub largest: Option<Largest>,
    /// The largest residual of a level relative to its rate, with that rate, deg/h.
    pub largest_of_rate: Option<(Largest, f64)>,
    /// Covariance of the residuals of the levels, (deg/h)².
    pub covariance: DMatrix<f64>,
    /// Offset and slope of the line from the means of the levels.
    line: DMatrix<f64>,
}

/// The extras that a recording can show.
fn recorded(extras: &[Extra], run: &TableRun) -> Vec<Extra> {
    let shown = |extra: &&Extra| match extra {
        Extra::Approach => true,
        Extra::TiltOverTemperature => false,
        Extra::BiasOverTemperature | Extra::ScaleOverTemperature => run.blocks.has_temperature,
        Extra::Cosine(_) | Extra::Sine(_) => run.blocks.has_angle,
    };
    extras.iter().filter(shown).copied().collect()
}

/// Evaluates the gyro channel of this number; `None` when the steps do not give a line. `extras` is what the model of the
/// response holds beside the rate, where the recording shows it.
pub fn evaluate(run: &TableRun, channel: usize, setup: &Setup, extras: &[Extra]) -> Option<ScaleFactor> {
    let response = model::fit(&run.steps, channel, setup, &recorded(extras, run))?;
    let l = response.levels.len();
    let a = DMatrix::from_fn(l, 2, |i, j| if j == 0 { 1.0 } else { response.levels[i] });
    let line = (a.transpose() * &a).try_inverse()? * a.transpose();
    let means = DVector::from_vec(response.level_means());
    let fitted = &line * &means;
    let rest = DMatrix::identity(l, l) - &a * &line;
    let residuals = &rest * &means;
    let covariance = &rest * response.level_covariance() * rest.transpose();
    let factor = response.slope + fitted[1];
    let full_scale = setup
        .full_scale_deg_h
        .unwrap_or_else(|| response.levels.iter().fold(0.0, |m: f64, r| m.max(r.abs())));
    let dof = |level: usize| {
        let weights: Vec<f64> = rest.row(level).iter().copied().collect();
        response.of_levels(&weights).dof
    };
    let found = largest(residuals.as_slice(), &covariance, &dof);
    let from = setup.of_rate_from_deg_h.unwrap_or(0.1 * full_scale) * 0.995;
    let high: Vec<usize> = (0..l).filter(|i| response.levels[*i].abs() >= from && from > 0.0).collect();
    let of_rate = {
        let scale = |i: usize| 1.0 / response.levels[high[i]].abs();
        let values: Vec<f64> = (0..high.len()).map(|i| residuals[high[i]] * scale(i)).collect();
        let c = DMatrix::from_fn(high.len(), high.len(), |i, j| {
            covariance[(high[i], high[j])] * scale(i) * scale(j)
        });
        largest(&values, &c, &|i| dof(high[i])).map(|found| {
            let rate = response.levels[high[found.at]];
            (found, rate)
        })
    };
    let levels =
        (0..l).map(|i| (residuals[i], covariance[(i, i)].max(0.0).sqrt())).collect::<Vec<(f64, f64)>>();
    let steps = step_residuals(&run.steps, &response, &levels);
    Some(ScaleFactor {
        channel: run.blocks.gyros.get(channel)?.clone(),
        factor,
        bias: fitted[0],
        full_scale,
        levels,
        steps,
        largest: found,
        largest_of_rate: of_rate,
        line,
        covariance,
        response,
    })
}

/// Steps about the line: the residual of their level, and what is left of their own rows.
fn step_residuals(steps: &Steps, response: &Response, levels: &[(f64, f64)]) -> Vec<StepResidual> {
    let mut seen: Vec<usize> = steps.list.iter().map(|s| s.level).collect();
    seen.sort_unstable();
    seen.dedup();
    let mut out = Vec::new();
    for (s, step) in steps.list.iter().enumerate() {
        let own: Vec<f64> = response.rows.iter().filter(|(i, _)| *i == s).map(|(_, r)| *r).collect();
        let Some(level) = seen.iter().position(|l| *l == step.level) else { continue };
        if own.is_empty() {
            continue;
        }
        let visits = steps.list.iter().filter(|o| o.level == step.level).count() as f64;
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        out.push(StepResidual {
            step: s,
            residual: levels[level].0 + mean,
            standard: levels[level].1 * visits.sqrt(),
        });
    }
    out
}

impl ScaleFactor {
    /// Standard uncertainty of the scale factor from what scatters.
    pub fn factor_uncertainty(&self) -> f64 {
        self.slope().standard
    }

    /// Output of the line where the input of the table and this rate, deg/h, cancel one another: offset and slope of the
    /// line are correlated, and near the rates of the test they hardly scatter together.
    pub fn output_without(&self, rate_deg_h: f64) -> Combination {
        let weights: Vec<f64> =
            (0..self.line.ncols()).map(|i| self.line[(0, i)] - rate_deg_h * self.line[(1, i)]).collect();
        let found = self.response.of_levels(&weights);
        Combination { value: self.bias - rate_deg_h * self.factor, ..found }
    }

    /// Offset of the line, deg/h.
    pub fn offset(&self) -> Combination {
        self.of_line(0)
    }

    /// Slope of the line about that of the fit.
    pub fn slope(&self) -> Combination {
        self.of_line(1)
    }

    /// Magnitude of the change of the scale factor with temperature, ppm/degC; 0 where it was not asked for or not shown.
    pub fn temperature_slope(&self) -> f64 {
        self.response.extra(Extra::ScaleOverTemperature).map_or(0.0, |c| c.value.abs())
    }

    /// Output of 1 deg/h as a part of full scale, ppm.
    pub fn ppm_of_full_scale(&self) -> f64 {
        1e6 / (self.factor * self.full_scale)
    }

    /// Unit that the rates of the table read well in.
    pub fn rate_unit(&self) -> RateUnit {
        RateUnit::up_to(self.response.levels.iter().fold(0.0, |m: f64, l| m.max(l.abs())))
    }

    /// Offset (0) or slope about the fitted one (1) of the line.
    fn of_line(&self, row: usize) -> Combination {
        let weights: Vec<f64> = self.line.row(row).iter().copied().collect();
        self.response.of_levels(&weights)
    }
}
