//! The bias follows the supply voltage.

use crate::effect::shared::reach::{reach, varies};
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, Resolution, SearchContext, Sizing, Starts, Values,
    number,
};
use crate::numeric::range::Bounds;

pub struct SupplySensitivity;

static PARAMS: [Param; 1] = [Param::reported("coefficient_deg_h_per_V", "deg/h/V", -1e5, 1e5).signed()];

describe! {
    SupplySensitivity, "supply_sensitivity", Mean in Supply, needs [Supply],
    confusers ["temp_linear", "bias_step", "unobserved_driver"]
}

/// Voltage about its mean.
fn voltage(drivers: &Drivers) -> Option<Vec<f64>> {
    let supply = drivers.supply.as_ref()?;
    let mean = supply.iter().sum::<f64>() / supply.len().max(1) as f64;
    Some(supply.iter().map(|u| u - mean).collect())
}

impl MeanModel for SupplySensitivity {
    fn resolution(&self) -> Resolution {
        Resolution::FullRate
    }

    fn applies(&self, drivers: &Drivers) -> bool {
        varies(drivers.supply.as_deref())
    }

    fn starts(&self, _drivers: &Drivers, _look: &SearchContext<'_>) -> Starts {
        Starts::linear()
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![]
    }

    fn regressors(&self, _shape: &[f64], drivers: &Drivers) -> Regressors {
        Regressors { columns: voltage(drivers).into_iter().collect(), ..Regressors::default() }
    }

    fn parameters(&self, _shape: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        vec![coefficients.first().copied().unwrap_or(f64::NAN)]
    }

    fn sizings(&self, _drivers: &Drivers) -> Vec<Sizing> {
        vec![Sizing::linear(&PARAMS[0])]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let coefficient = number(values, PARAMS[0].name)?;
        Some(voltage(drivers)?.into_iter().map(|u| coefficient * u).collect())
    }

    fn places(&self, _shape: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let supply = drivers.supply.as_deref().unwrap_or(&[]);
        reach(Domain::Supply, supply, supply)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Value;

    #[test]
    fn the_bias_follows_the_voltage_about_its_mean() {
        let drivers = Drivers { supply: Some(vec![5.0, 5.2, 4.8, 5.0]), ..Drivers::default() };
        let course = SupplySensitivity
            .course(&Values::from([("coefficient_deg_h_per_V".to_owned(), Value::Number(-3.0))]), &drivers)
            .unwrap();
        for (got, expected) in course.iter().zip([0.0, -0.6, 0.6, 0.0]) {
            assert!((got - expected).abs() < 1e-12, "{course:?}");
        }
    }
}
