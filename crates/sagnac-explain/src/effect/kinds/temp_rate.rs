//! Bias proportional to the rate of change of temperature.

use crate::effect::shared::reach::varies;
use crate::effect::shared::thermal::rate;
use crate::effect::{Drivers, MeanModel, Param};

pub struct TempRate;

/// Bias for a rate of change of temperature.
pub(super) const RATE_COEFFICIENT: Param =
    Param::reported("coefficient_deg_h_per_degC_per_min", "deg/h/(°C/min)", -1e6, 1e6).signed();

static PARAMS: [Param; 1] = [RATE_COEFFICIENT];

describe! {
    TempRate, "temp_rate", Mean in TemperatureRate, needs [Temperature],
    confusers [ThermalLag, TempHysteresis, TempLinear],
    properties [slow, carried_over, law Rate]
}

impl MeanModel for TempRate {
    fn applies(&self, drivers: &Drivers) -> bool {
        varies(drivers.temperature.as_deref()) && varies(rate(drivers).as_deref())
    }

    fn column(&self, _nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
        rate(drivers)
    }
}
