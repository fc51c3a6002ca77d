//! The generalised method of wavelet moments (Guerrier, Skaloud, Stebler and Victoria-Feser, JASA 108, 2013): Haar
//! wavelet variances, which are half the overlapping Allan variances, matched to those of the model with weights
//! 1/variance. As its users do, it is given which terms there are.

use super::allan::Point;
use super::mixes::TAU0_S;
use nalgebra::{DMatrix, DVector};
use sagnac::noise::composite::{Composite, Parameter};

/// A parameter this much below its start counts as not found.
const VANISHED: f64 = 1e-3;

/// Fits the structure of `truth`, from there on; `None` where a parameter vanishes.
pub fn fit(points: &[Point], truth: &Composite, parameters: &[Parameter]) -> Vec<Option<f64>> {
    // Large-sample variance of a wavelet variance with η = windows/2 equivalent degrees of freedom (Percival 1995).
    let weight: Vec<f64> =
        points.iter().map(|p| (0.5 * (0.5 * p.windows).max(1.0)).sqrt() / p.variance).collect();
    let residuals = |model: &Composite| -> DVector<f64> {
        DVector::from_iterator(
            points.len(),
            points.iter().zip(&weight).map(|(p, w)| w * (p.variance - model.allan_variance(p.tau_s, TAU0_S))),
        )
    };
    let mut model = truth.clone();
    let mut rest = residuals(&model);
    let mut damping = 1e-3;
    for _ in 0..100 {
        let mut jacobian = DMatrix::zeros(points.len(), parameters.len());
        for (j, p) in parameters.iter().enumerate() {
            let (at, step) = (model.value(*p), 1e-4f64);
            let up = residuals(&model.with(*p, at * step.exp()));
            let down = residuals(&model.with(*p, at * (-step).exp()));
            jacobian.set_column(j, &((down - up) / (2.0 * step)));
        }
        let gradient = jacobian.transpose() * &rest;
        let normal = jacobian.transpose() * &jacobian;
        let before = rest.norm_squared();
        let mut gained = 0.0;
        for _ in 0..12 {
            let mut damped = normal.clone();
            for i in 0..parameters.len() {
                damped[(i, i)] += damping * normal[(i, i)] + 1e-12;
            }
            let Some(step) = damped.cholesky().map(|c| c.solve(&gradient)) else { break };
            let mut trial = model.clone();
            for (p, d) in parameters.iter().zip(step.iter()) {
                let start = truth.value(*p);
                let next = model.value(*p) * d.clamp(-1.0, 1.0).exp();
                trial = trial.with(*p, next.clamp(1e-4 * start, 1e4 * start));
            }
            let next = residuals(&trial);
            if next.norm_squared() < before {
                gained = before - next.norm_squared();
                (model, rest) = (trial, next);
                damping *= 0.3;
                break;
            }
            damping *= 5.0;
        }
        if gained <= 1e-9 * before {
            break;
        }
    }
    parameters.iter().map(|p| Some(model.value(*p)).filter(|v| *v > VANISHED * truth.value(*p))).collect()
}
