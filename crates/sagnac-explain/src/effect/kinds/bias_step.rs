//! One jump of the bias.

use crate::effect::shared::heading::odds_of_same_step;
use crate::effect::shared::step::{around, instant_bounds, instants, sizing, step};
use crate::effect::{
    ClaimedMean, Drivers, Later, MeanModel, Param, Place, Regressors, SearchContext, Sizing, Starts, Values,
    number,
};
use crate::numeric::range::Bounds;

pub struct BiasStep;

static PARAMS: [Param; 2] = [
    Param::reported("step_deg_h", "deg/h", -1e6, 1e6).signed(),
    Param::reported("time_s", "s", f64::MIN, f64::MAX).instant(),
];

describe! {
    BiasStep, "bias_step", Mean in Time, needs [],
    confusers [HeadingChange, RandomTelegraph, ExcessRrw],
    properties [slow, family Jump, reversed_pair UnobservedDriver],
    with {
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
        vec![instant_bounds(drivers)]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        Regressors::columns(nonlinear_parameters.iter().map(|at| step(drivers, *at)))
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
        let (size, at) = (number(values, PARAMS[0].name)?, number(values, PARAMS[1].name)? - drivers.start_s);
        Some(step(drivers, at).into_iter().map(|s| size * s).collect())
    }

    /// Those of a change of heading added where it is the same step.
    fn odds(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> f64 {
        let same = nonlinear_parameters.first().and_then(|at| odds_of_same_step(*at, drivers));
        same.map_or(0.0, |odds| odds.exp().ln_1p())
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        nonlinear_parameters.first().map(|at| around(*at, drivers)).into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Earth;

    #[test]
    fn a_step_at_rest_has_the_odds_of_a_change_of_heading_too() {
        let mut drivers = Drivers { dt_s: 1.0, samples: 1000, ..Drivers::default() };
        assert!((BiasStep.odds(&[500.0], &drivers).exp() - 1.0 - (-2f64).exp()).abs() < 1e-12);
        drivers.claim.earth = Some(Earth { latitude_deg: 60.0, azimuth_deg: 40.0 });
        assert!((BiasStep.odds(&[500.0], &drivers).exp() - 1.0 - (-0.1f64).exp()).abs() < 1e-12);
        // A table that turns then tells the two apart.
        drivers.table_angle = Some((0..1000).map(|i| if i < 500 { 10.0 } else { 25.0 }).collect());
        assert_eq!(BiasStep.odds(&[500.0], &drivers), 0.0);
    }
}
