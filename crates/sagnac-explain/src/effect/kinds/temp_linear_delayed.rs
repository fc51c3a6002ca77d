//! A linear temperature coefficient that differs from the claimed one and acts behind a delay: on the temperature of the coil, of
//! which the thermometer on the housing is ahead. It is reported as a linear coefficient that differs.

use super::temp_linear::{LINEAR_COEFFICIENT, claimed, reference};
use crate::effect::shared::first_order::{self, late};
use crate::effect::shared::thermal;
use crate::effect::{Drivers, MeanModel, Param, SearchContext, Starts};
use crate::numeric::range::Bounds;

pub struct TempLinearDelayed;

static PARAMS: [Param; 2] = [LINEAR_COEFFICIENT, Param::inner("time_constant_s", "s", 1e-6, 1e6)];

describe! {
    TempLinearDelayed, "temp_linear_delayed", Mean in Temperature, needs [Temperature],
    confusers [TempLinear, ThermalLag, TempHysteresis],
    properties [slow, carried_over, reported_as TempLinear]
}

/// The delayed temperature from that at which the claimed dependence is 0, °C.
fn temperature(time_constant_s: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    let mut late = late(time_constant_s, drivers)?;
    late.iter_mut().for_each(|t| *t -= reference(drivers));
    Some(late)
}

impl MeanModel for TempLinearDelayed {
    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        first_order::starts(self, drivers, context)
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        first_order::bounds(drivers)
    }

    fn claimed_coefficient(&self, drivers: &Drivers) -> f64 {
        claimed(drivers)
    }

    fn column(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
        temperature(*nonlinear_parameters.first()?, drivers)
    }

    fn initial_state(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Vec<Vec<f64>> {
        first_order::initial_state(nonlinear_parameters, drivers)
    }

    fn state_deviation(&self, _nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<f64> {
        thermal::range(drivers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::sizing::numbers;
    use crate::effect::{ClaimedMean, Temperature, Values};

    #[test]
    fn behind_a_ramp_the_bias_is_that_of_a_time_constant_before() {
        // 0.02 °C/s from the reference on: the delayed temperature is 40 s · 0.02 °C/s behind.
        let ramp: Vec<f64> = (0..1000).map(|i| 20.0 + 0.02 * f64::from(i)).collect();
        let stated = Temperature { coefficient_deg_h_per_degc: 0.5, reference_degc: 20.0 };
        let claim = ClaimedMean { temperature: Some(stated), ..Default::default() };
        let drivers =
            Drivers { dt_s: 1.0, samples: 1000, temperature: Some(ramp), claim, ..Drivers::default() };
        // 2 deg/h/°C in all, of which the claim has 0.5.
        let values = numbers([(PARAMS[0].name, 2.0), (PARAMS[1].name, 40.0)]);
        let course = TempLinearDelayed.course(&values, &drivers).unwrap();
        assert!(course[0] == 0.0 && (course[999] - 1.5 * (19.98 - 0.8)).abs() < 1e-9, "{}", course[999]);
        assert_eq!(TempLinearDelayed.parameters(&[40.0], &[1.5], &drivers), [2.0, 40.0]);
        assert!(temperature(0.0, &drivers).is_none() && temperature(f64::INFINITY, &drivers).is_none());
        assert!(TempLinearDelayed.course(&Values::new(), &drivers).is_none());
    }
}
