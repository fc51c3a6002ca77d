//! Different scale factors for positive and negative rate.

use crate::effect::{Drivers, MeanModel, Param};
use crate::numeric::range::{Bounds, ends};

pub struct SfAsymmetry;

static PARAMS: [Param; 1] = [Param::reported("asymmetry_ppm", "ppm", -1e5, 1e5).signed()];

describe! {
    SfAsymmetry, "sf_asymmetry", Mean in InputRate, needs [TableRate],
    confusers [SfError, SfNonlinearity, TempLinear],
    properties [carried_over]
}

impl MeanModel for SfAsymmetry {
    /// Rates of one sign alone cannot show it.
    fn applies(&self, drivers: &Drivers) -> bool {
        let Some(rate) = &drivers.table_rate else { return false };
        let Bounds { low, high } = ends(rate);
        low.is_finite() && high.is_finite() && low < -0.01 * high.abs() && high > 0.01 * low.abs()
    }

    fn column(&self, _nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
        Some(drivers.table_rate.as_ref()?.iter().map(|r| 1800e-6 * r.abs()).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::sizing::numbers;

    #[test]
    fn both_signs_of_the_rate_are_off_by_half_of_the_asymmetry() {
        let drivers = Drivers { table_rate: Some(vec![-2.0, 0.0, 2.0]), ..Drivers::default() };
        let course = SfAsymmetry.course(&numbers([("asymmetry_ppm", 100.0)]), &drivers).unwrap();
        // 7200 deg/h · 50 ppm.
        for (got, expected) in course.iter().zip([0.36, 0.0, 0.36]) {
            assert!((got - expected).abs() < 1e-12, "{course:?}");
        }
        assert!(SfAsymmetry.applies(&drivers));
        assert!(!SfAsymmetry.applies(&Drivers { table_rate: Some(vec![0.0, 2.0]), ..Drivers::default() }));
    }
}
