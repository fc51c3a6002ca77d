//! A scale factor that depends on temperature.

use crate::effect::shared::reach::{reach, varies};
use crate::effect::shared::thermal::smooth;
use crate::effect::{Domain, Drivers, Param, Place};

pub struct SfTemperature;

static PARAMS: [Param; 1] = [Param::reported("coefficient_ppm_per_degC", "ppm/°C", -1e4, 1e4).signed()];

describe! {
    SfTemperature, "sf_temperature", Mean in Temperature, needs [TableRate, Temperature],
    confusers ["sf_error", "temp_linear", "sf_nonlinearity"]
}

fn column(drivers: &Drivers) -> Option<Vec<f64>> {
    let from = drivers.claim.temperature.map_or(20.0, |t| t.reference_degc);
    let (rate, t) = (drivers.table_rate.as_ref()?, smooth(drivers)?);
    Some(rate.iter().zip(t).map(|(r, t)| 3600e-6 * r * (t - from)).collect())
}

fn places(drivers: &Drivers) -> Vec<Place> {
    let course = column(drivers).unwrap_or_default();
    let mut out = reach(Domain::Temperature, smooth(drivers).unwrap_or(&[]), &course);
    out.extend(crate::effect::shared::reach::large_rates(drivers));
    out
}

linear! { SfTemperature, replaces None, places places }

fn applies(drivers: &Drivers) -> bool {
    let moving = drivers.table_rate.as_ref().is_some_and(|r| r.iter().any(|r| *r != 0.0));
    moving && varies(drivers.temperature.as_deref())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{MeanModel, Value, Values};

    #[test]
    fn the_scale_factor_is_the_claimed_one_at_the_reference() {
        let drivers = Drivers {
            table_rate: Some(vec![10.0, 10.0]),
            temperature: Some(vec![20.0, 30.0]),
            ..Drivers::default()
        };
        let course = SfTemperature
            .course(&Values::from([("coefficient_ppm_per_degC".to_owned(), Value::Number(2.0))]), &drivers)
            .unwrap();
        // 36 000 deg/h · 20 ppm.
        assert!(course[0] == 0.0 && (course[1] - 0.72).abs() < 1e-12, "{course:?}");
    }
}
