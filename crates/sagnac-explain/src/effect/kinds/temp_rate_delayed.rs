//! Bias proportional to the rate of change of a temperature behind a delay: that of the coil, of which the thermometer on the
//! housing is ahead. It is reported as bias proportional to the rate of change of temperature.

use super::temp_rate::RATE_COEFFICIENT;
use crate::effect::shared::first_order::{self, late};
use crate::effect::shared::reach::reach;
use crate::effect::shared::thermal::{range, smooth};
use crate::effect::{Domain, Drivers, MeanModel, Param, Place, SearchContext, Starts};
use crate::numeric::range::Bounds;

pub struct TempRateDelayed;

static PARAMS: [Param; 2] = [RATE_COEFFICIENT, Param::inner("time_constant_s", "s", 1e-6, 1e6)];

describe! {
    TempRateDelayed, "temp_rate_delayed", Mean in TemperatureRate, needs [Temperature],
    confusers [TempRate, ThermalLag, TempHysteresis],
    properties [slow, reported_as TempRate]
}

/// Rate of change of the delayed temperature, °C/min: the difference from the present one over the time constant.
fn rate(time_constant_s: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    let t = smooth(drivers)?;
    let late = late(time_constant_s, drivers)?;
    Some(late.iter().zip(t).map(|(d, t)| 60.0 * (t - d) / time_constant_s).collect())
}

impl MeanModel for TempRateDelayed {
    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        first_order::starts(self, drivers, context)
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        first_order::bounds(drivers)
    }

    fn column(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
        rate(*nonlinear_parameters.first()?, drivers)
    }

    fn initial_state(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Vec<Vec<f64>> {
        first_order::initial_state(nonlinear_parameters, drivers)
    }

    fn state_deviation(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<f64> {
        Some(60.0 * range(drivers)? / nonlinear_parameters.first()?)
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let rate = self.column(nonlinear_parameters, drivers);
        rate.map_or_else(Vec::new, |r| reach(Domain::TemperatureRate, &r, &r))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Values;
    use crate::effect::sizing::numbers;

    #[test]
    fn behind_a_ramp_the_rate_rises_to_that_of_the_ramp() {
        // 0.02 °C/s are 1.2 °C/min: after one time constant 1 − 1/e of it.
        let ramp: Vec<f64> = (0..1000).map(|i| 0.02 * f64::from(i)).collect();
        let drivers = Drivers { dt_s: 1.0, samples: 1000, temperature: Some(ramp), ..Drivers::default() };
        let rate = |time: f64| super::rate(time, &drivers);
        let got = rate(40.0).unwrap();
        assert!(got[0] == 0.0 && (got[999] - 1.2).abs() < 1e-9, "{}", got[999]);
        assert!((got[40] - 1.2 * (1.0 - (-1f64).exp())).abs() < 1e-9, "{}", got[40]);
        assert!(rate(0.0).is_none() && rate(f64::INFINITY).is_none());
        // Stated, it is the coefficient times the same.
        let stated = numbers([(PARAMS[0].name, -3.0), (PARAMS[1].name, 40.0)]);
        let course = TempRateDelayed.course(&stated, &drivers).unwrap();
        assert!(
            (course[999] + 3.6).abs() < 1e-9 && TempRateDelayed.course(&Values::new(), &drivers).is_none()
        );
    }
}
