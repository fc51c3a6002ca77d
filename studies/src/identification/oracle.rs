//! A maximum-likelihood fit given the true structure: what nobody could do much better than.
//!
//! Fisher scoring in the logarithms of the parameters, the ramp by least squares; intervals from the profile of the
//! deviance.

use super::whittle::{Data, Layout};
use sagnac::noise::composite::{Composite, Parameter};
use sagnac::noise::data::NoiseType;

/// Rise of the deviance at the ends of a 95 % interval, as a normal score.
const SCORE: f64 = 1.959_964;
/// How far a parameter may move from its start, in its logarithm.
const REACH: f64 = 7.0;

/// The ramp, which is no part of the spectrum.
pub const RAMP: Parameter = Parameter::Coefficient(NoiseType::RateRamp);

/// A best model.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The best model.
    pub model: Composite,
    /// −2 ln L of it, up to a constant.
    pub deviance: f64,
}

/// A fit that knows the structure.
pub struct Oracle<'a> {
    /// Modes of the record.
    pub layout: &'a Layout,
    /// Their powers.
    pub data: &'a Data,
    /// What is free.
    pub parameters: &'a [Parameter],
    /// Where fits start: the truth, or an equivalent of it in another structure.
    pub start: &'a Composite,
}

impl Oracle<'_> {
    /// The maximum; `fixed` holds one parameter where it is.
    pub fn maximise(&self, from: &Composite, fixed: Option<Parameter>) -> Fit {
        let free: Vec<Parameter> =
            self.parameters.iter().copied().filter(|p| *p != RAMP && Some(*p) != fixed).collect();
        let ramp_free = self.parameters.contains(&RAMP) && fixed != Some(RAMP);
        let mut model = from.clone();
        let mut expected = self.layout.expected(&model);
        let mut deviance = self.layout.deviance(self.data, &expected, model.terms.r);
        for _ in 0..60 {
            let before = deviance;
            if ramp_free {
                model.terms.r = self.layout.ramp(self.data, &expected).0;
                deviance = self.layout.deviance(self.data, &expected, model.terms.r);
            }
            let (mut information, gradient) =
                self.layout.scoring(Some((self.data, model.terms.r)), &model, &expected, &free);
            for i in 0..free.len() {
                // A parameter that has vanished must not make the matrix singular.
                information[(i, i)] += 1e-9 + 1e-9 * information[(i, i)];
            }
            let Some(step) = information.cholesky().map(|c| c.solve(&gradient)) else { break };
            let mut scale = (1.0 / step.amax().max(1e-12)).min(1.0);
            for _ in 0..25 {
                let mut trial = model.clone();
                for (p, d) in free.iter().zip(step.iter()) {
                    let start = self.start.value(*p);
                    let limits = (start * (-REACH).exp(), start * REACH.exp());
                    trial = trial.with(*p, (model.value(*p) * (scale * d).exp()).clamp(limits.0, limits.1));
                }
                let density = self.layout.expected(&trial);
                let value = self.layout.deviance(self.data, &density, trial.terms.r);
                if value < deviance {
                    (model, expected, deviance) = (trial, density, value);
                    break;
                }
                scale *= 0.4;
            }
            if before - deviance < 1e-6 {
                break;
            }
        }
        Fit { model, deviance }
    }

    /// The maximum from the start.
    pub fn fit(&self) -> Fit {
        self.maximise(self.start, None)
    }

    /// 95 % interval of a parameter from the profile about the maximum, first guess `sigma` (of the logarithm; of the
    /// value for the ramp).
    pub fn interval(&self, best: &Fit, parameter: Parameter, sigma: f64) -> (f64, f64) {
        let value = best.model.value(parameter);
        let side = |direction: f64| {
            let at = |distance: f64| {
                if parameter == RAMP {
                    value + direction * distance
                } else {
                    value * (direction * distance).exp()
                }
            };
            let mut distance = SCORE * sigma;
            for _ in 0..6 {
                let held = self.maximise(&best.model.with(parameter, at(distance)), Some(parameter));
                let score = (held.deviance - best.deviance).max(0.0).sqrt();
                if (score / SCORE - 1.0).abs() < 0.01 {
                    break;
                }
                distance *= (SCORE / score.max(1e-3)).clamp(0.4, 2.5);
            }
            at(distance)
        };
        (side(-1.0), side(1.0))
    }
}
