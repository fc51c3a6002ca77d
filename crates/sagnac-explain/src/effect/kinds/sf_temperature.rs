//! A scale factor that depends on temperature.

use super::temp_linear::reference;
use crate::effect::shared::reach::{large_rates, reach, varies};
use crate::effect::shared::thermal::smooth;
use crate::effect::{Domain, Drivers, MeanModel, Param, Place};

pub struct SfTemperature;

static PARAMS: [Param; 1] = [Param::reported("coefficient_ppm_per_degC", "ppm/°C", -1e4, 1e4).signed()];

describe! {
    SfTemperature, "sf_temperature", Mean in Temperature, needs [TableRate, Temperature],
    confusers [SfError, TempLinear, SfNonlinearity],
    properties [carried_over]
}

/// True where the table moves.
pub(super) fn is_moving(drivers: &Drivers) -> bool {
    drivers.table_rate.iter().flatten().any(|r| *r != 0.0)
}

/// Rate of the table times the departure of a column from a reference, deg/h for 1 ppm a unit of the column.
pub(super) fn product(values: &[f64], reference: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    let rate = drivers.table_rate.as_ref()?;
    Some(rate.iter().zip(values).map(|(r, v)| 3600e-6 * r * (v - reference)).collect())
}

impl MeanModel for SfTemperature {
    fn applies(&self, drivers: &Drivers) -> bool {
        is_moving(drivers) && varies(drivers.temperature.as_deref())
    }

    fn column(&self, _nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
        product(smooth(drivers)?, reference(drivers), drivers)
    }

    fn places(&self, _nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let course = self.column(&[], drivers).unwrap_or_default();
        let mut out = reach(Domain::Temperature, smooth(drivers).unwrap_or(&[]), &course);
        out.extend(large_rates(drivers));
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::sizing::numbers;

    #[test]
    fn the_scale_factor_is_the_claimed_one_at_the_reference() {
        let drivers = Drivers {
            table_rate: Some(vec![10.0, 10.0]),
            temperature: Some(vec![20.0, 30.0]),
            ..Drivers::default()
        };
        let course = SfTemperature.course(&numbers([("coefficient_ppm_per_degC", 2.0)]), &drivers).unwrap();
        // 36 000 deg/h · 20 ppm.
        assert!(course[0] == 0.0 && (course[1] - 0.72).abs() < 1e-12, "{course:?}");
    }
}
