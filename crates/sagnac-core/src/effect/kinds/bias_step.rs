//! One jump of the bias.

use crate::effect::{
    Domain, Drivers, Effect, MeanModel, Model, Param, Place, Regressors, SearchContext, Starts, Values,
    number,
};
use crate::numeric::range::Bounds;

pub struct BiasStep;

static PARAMS: [Param; 2] = [
    Param::reported("step_deg_h", "deg/h", -1e6, 1e6).signed(),
    Param::reported("time_s", "s", f64::MIN, f64::MAX),
];

impl Effect for BiasStep {
    fn kind(&self) -> &'static str {
        "bias_step"
    }
    fn params(&self) -> &'static [Param] {
        &PARAMS
    }
    fn domain(&self) -> Domain {
        Domain::Time
    }
    fn confusers(&self) -> &'static [&'static str] {
        &["heading_change", "random_telegraph", "excess_rrw"]
    }
    fn model(&self) -> Model {
        Model::Mean(&BiasStep)
    }
}

/// A step at `at_s` seconds after the first sample, the sample that it falls into averaged.
pub(super) fn step(drivers: &Drivers, at_s: f64) -> Vec<f64> {
    let dt = drivers.dt_s;
    drivers.of_time(|t| ((t - at_s) / dt + 0.5).clamp(0.0, 1.0))
}

/// Instants at which a step gains most, s after the first sample; the best first.
pub(super) fn instants(drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
    let n = drivers.samples;
    if n < 8 {
        return Starts { points: vec![], trials: 1.0 };
    }
    // The gain is (Σ_{i ≥ j} w_i)²/2 over z'C⁻¹z, and the latter varies slowly with the instant: it is computed at some
    // and interpolated.
    let points = 48.min(n / 4);
    let at = |p: usize| 1.0 + (n as f64 - 2.0) * p as f64 / points as f64;
    let weight = |j: f64| {
        let modes = crate::numeric::cosine::dct2(&step(drivers, (j - 0.5) * drivers.dt_s));
        modes.iter().zip(context.powers).skip(1).map(|(z, p)| z * z / p).sum::<f64>()
    };
    let weights: Vec<f64> = (0..=points).map(|p| weight(at(p))).collect();
    let mut sum: f64 = 0.0;
    let mut gains = vec![0.0; n];
    for j in (1..n).rev() {
        sum += context.score[j];
        let x = (j as f64 - at(0)) / (at(1) - at(0));
        let p = (x.max(0.0) as usize).min(points - 1);
        let w = weights[p] + (weights[p + 1] - weights[p]) * (x - p as f64).clamp(0.0, 1.0);
        gains[j] = if w > 0.0 { 0.5 * sum * sum / w } else { 0.0 };
    }
    let mut points = vec![];
    let apart = (n / 50).max(1);
    for _ in 0..3 {
        let best = (1..n).max_by(|a, b| gains[*a].total_cmp(&gains[*b])).unwrap_or(1);
        if gains[best] <= 0.0 {
            break;
        }
        points.push(vec![(best as f64 - 0.5) * drivers.dt_s]);
        gains[best.saturating_sub(apart)..(best + apart).min(n)].fill(0.0);
    }
    // Instants closer than the time in which the noise lets a step be placed are one; in white noise each counts.
    Starts { points, trials: (n as f64).powf(0.75) }
}

impl MeanModel for BiasStep {
    fn applies(&self, drivers: &Drivers) -> bool {
        drivers.samples >= 8
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        instants(drivers, context)
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        vec![Bounds::new(0.5 * drivers.dt_s, drivers.length_s() - 1.5 * drivers.dt_s)]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        Regressors {
            columns: nonlinear_parameters.iter().map(|at| step(drivers, *at)).collect(),
            ..Regressors::default()
        }
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<f64> {
        match (nonlinear_parameters, coefficients) {
            ([at], [size]) => vec![*size, drivers.start_s + at],
            _ => vec![f64::NAN; 2],
        }
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let (size, at) = (number(values, "step_deg_h")?, number(values, "time_s")? - drivers.start_s);
        Some(step(drivers, at).into_iter().map(|s| size * s).collect())
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let Some(at) = nonlinear_parameters.first().map(|at| drivers.start_s + at) else { return vec![] };
        let half = (0.01 * drivers.length_s()).max(2.0 * drivers.dt_s);
        vec![Place { domain: Domain::Time, from: at - half, to: at + half }]
    }
}
