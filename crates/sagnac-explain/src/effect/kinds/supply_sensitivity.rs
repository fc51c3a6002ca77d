//! The bias follows the supply voltage.

use crate::effect::{Drivers, MeanModel, Param};

pub struct SupplySensitivity;

static PARAMS: [Param; 1] = [Param::reported("coefficient_deg_h_per_V", "deg/h/V", -1e5, 1e5).signed()];

describe! {
    SupplySensitivity, "supply_sensitivity", Mean in Supply, needs [Supply],
    confusers [TempLinear, BiasStep, UnobservedDriver],
    properties [carried_over]
}

impl MeanModel for SupplySensitivity {
    /// Voltage about its mean.
    fn column(&self, _nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
        let supply = drivers.supply.as_ref()?;
        let mean = supply.iter().sum::<f64>() / supply.len().max(1) as f64;
        Some(supply.iter().map(|u| u - mean).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::sizing::numbers;

    #[test]
    fn the_bias_follows_the_voltage_about_its_mean() {
        let drivers = Drivers { supply: Some(vec![5.0, 5.2, 4.8, 5.0]), ..Drivers::default() };
        let course =
            SupplySensitivity.course(&numbers([("coefficient_deg_h_per_V", -3.0)]), &drivers).unwrap();
        for (got, expected) in course.iter().zip([0.0, -0.6, 0.6, 0.0]) {
            assert!((got - expected).abs() < 1e-12, "{course:?}");
        }
    }
}
