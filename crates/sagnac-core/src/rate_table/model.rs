//! The response of one channel: a mean for every level of rate, and what else moves the output.

use super::design::{Design, Extra};
use super::setup::Setup;
use super::steps::Steps;
use crate::numeric::reml::{Combination, Fit};
use nalgebra::{DMatrix, DVector};

/// Gain of twice the log-likelihood from which a kind of noise that is not always there is taken for real: by chance it
/// comes about in one test of ten.
pub(super) const TAKEN_FROM: f64 = 1.64;

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
    let design = Design::new(steps, channel, setup, wanted)?;
    let columns: Vec<DVector<f64>> = design.of_levels.iter().chain(&design.of_extras).cloned().collect();
    let (fit, names) = design.fit(&columns, TAKEN_FROM)?;
    let noise = names.into_iter().zip(fit.variance_components.iter().copied()).collect();
    Some(Response {
        rows: design.step.iter().copied().zip(fit.residuals.iter().copied()).collect(),
        noise,
        fit,
        slope: design.slope,
        levels: design.levels,
        extras: design.extras,
        hidden: design.hidden,
        temperature: design.temperature,
        temperature_range: design.temperature_range,
    })
}
