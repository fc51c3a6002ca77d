//! One jump of the bias.

use super::unobserved_driver::UnobservedDriver;
use crate::effect::shared::step::{instants, sizing, step};
use crate::effect::{
    ClaimedMean, Domain, Drivers, Effect, Family, Later, MeanModel, Param, Place, Regressors, SearchContext,
    Sizing, Starts, Values, number,
};
use crate::numeric::range::Bounds;

pub struct BiasStep;

static PARAMS: [Param; 2] = [
    Param::reported("step_deg_h", "deg/h", -1e6, 1e6).signed(),
    Param::reported("time_s", "s", f64::MIN, f64::MAX).instant(),
];

describe! {
    BiasStep, "bias_step", Mean in Time, needs [],
    confusers ["heading_change", "random_telegraph", "excess_rrw"],
    with {
        fn family(&self) -> Option<Family> {
            Some(Family::Jump)
        }
        fn reversed_pair(&self) -> Option<&'static dyn Effect> {
            Some(&UnobservedDriver)
        }
        fn later(&self, _values: &Values, _claim: &ClaimedMean) -> Later {
            Later::Nothing
        }
    }
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

    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        vec![sizing(&PARAMS[0], &PARAMS[1], drivers)]
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
