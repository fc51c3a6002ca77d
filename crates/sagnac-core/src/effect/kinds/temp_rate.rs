//! Bias proportional to the rate of change of temperature.

use crate::effect::shared::reach::{reach, varies};
use crate::effect::shared::thermal::rate;
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Sizing, Starts, Values, number,
};
use crate::numeric::range::Bounds;

pub struct TempRate;

/// Bias for a rate of change of temperature.
pub(super) const COEFFICIENT: Param =
    Param::reported("coefficient_deg_h_per_degC_per_min", "deg/h/(°C/min)", -1e6, 1e6).signed();

static PARAMS: [Param; 1] = [COEFFICIENT];

describe! {
    TempRate, "temp_rate", Mean in TemperatureRate, needs [Temperature],
    confusers ["thermal_lag", "temp_hysteresis", "temp_linear"]
}

impl MeanModel for TempRate {
    fn applies(&self, drivers: &Drivers) -> bool {
        varies(drivers.temperature.as_deref()) && varies(rate(drivers).as_deref())
    }

    fn starts(&self, _drivers: &Drivers, _look: &SearchContext<'_>) -> Starts {
        Starts::linear()
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![]
    }

    fn regressors(&self, _shape: &[f64], drivers: &Drivers) -> Regressors {
        Regressors { columns: rate(drivers).into_iter().collect(), ..Regressors::default() }
    }

    fn parameters(&self, _shape: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        vec![coefficients.first().copied().unwrap_or(f64::NAN)]
    }

    fn sizings(&self, _drivers: &Drivers) -> Vec<Sizing> {
        vec![Sizing::linear(&PARAMS[0])]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let coefficient = number(values, PARAMS[0].name)?;
        Some(rate(drivers)?.into_iter().map(|r| coefficient * r).collect())
    }

    fn places(&self, _shape: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        rate(drivers).map_or_else(Vec::new, |r| reach(Domain::TemperatureRate, &r, &r))
    }
}
