//! Sensitivity to the rate about the other axis.

use crate::effect::{Drivers, MeanModel, Param};

pub struct CrossAxis;

static PARAMS: [Param; 1] = [Param::reported("misalignment_mrad", "mrad", -200.0, 200.0).signed()];

describe! {
    CrossAxis, "cross_axis", Mean in OuterRate, needs [OuterRate],
    confusers [SfError, EarthRateProjection]
}

impl MeanModel for CrossAxis {
    fn column(&self, _nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
        Some(drivers.outer_rate.as_ref()?.iter().map(|r| 3.6 * r).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::sizing::numbers;

    #[test]
    fn a_milliradian_sees_a_thousandth_of_the_other_axis() {
        let drivers = Drivers { outer_rate: Some(vec![10.0, -5.0]), ..Drivers::default() };
        let course = CrossAxis.course(&numbers([("misalignment_mrad", 2.0)]), &drivers).unwrap();
        assert!((course[0] - 72.0).abs() < 1e-12 && (course[1] + 36.0).abs() < 1e-12, "{course:?}");
    }
}
