//! A scale factor that differs from the claimed one.

use crate::effect::{Drivers, MeanModel, Nuisance, Param};

pub struct SfError;

static PARAMS: [Param; 1] = [Param::reported("error_ppm", "ppm", -1e5, 1e5).signed().corrects_claim()];

describe! {
    SfError, "sf_error", Mean in InputRate, needs [TableRate],
    confusers [SfAsymmetry, SfNonlinearity, SfTemperature, TimeOffset]
}

impl MeanModel for SfError {
    fn replaces(&self) -> Option<Nuisance> {
        Some(Nuisance::ScaleFactor)
    }

    fn column(&self, _nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
        Some(drivers.table_rate.as_ref()?.iter().map(|r| 3600e-6 * r).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Values;
    use crate::effect::sizing::numbers;

    #[test]
    fn a_millionth_of_one_deg_s_is_0_0036_deg_h() {
        let drivers = Drivers { table_rate: Some(vec![-2.0, 0.0, 5.0]), ..Drivers::default() };
        let course = SfError.course(&numbers([("error_ppm", 50.0)]), &drivers).unwrap();
        for (got, expected) in course.iter().zip([-0.36, 0.0, 0.9]) {
            assert!((got - expected).abs() < 1e-12, "{course:?}");
        }
        assert!(SfError.course(&Values::new(), &drivers).is_none());
    }
}
