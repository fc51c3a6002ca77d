//! A scale factor that depends on the size of the rate.

use crate::effect::mean::first;
use crate::effect::shared::reach::{largest_rate, varies};
use crate::effect::{Drivers, MeanModel, Param, Values, number};

pub struct SfNonlinearity;

static PARAMS: [Param; 2] = [
    Param::reported("cubic_ppm_at_max", "ppm", -1e5, 1e5).signed(),
    Param::inner("largest_rate_deg_s", "deg/s", 1e-12, 1e6),
];

describe! {
    SfNonlinearity, "sf_nonlinearity", Mean in InputRate, needs [TableRate],
    confusers [SfError, Saturation, SfAsymmetry],
    properties [carried_over]
}

/// The cubic term, deg/h for 1 ppm at the largest rate.
fn cubic(largest: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    let rate = drivers.table_rate.as_ref()?;
    (largest > 0.0).then(|| rate.iter().map(|r| 3600e-6 * r * (r / largest).powi(2)).collect())
}

impl MeanModel for SfNonlinearity {
    /// With a single size of rate the cubic term is a scale factor.
    fn applies(&self, drivers: &Drivers) -> bool {
        let most = largest_rate(drivers);
        let between = |r: &f64| r.abs() > 0.1 * most && r.abs() < 0.9 * most;
        varies(drivers.table_rate.as_deref()) && drivers.table_rate.iter().flatten().any(between)
    }

    fn column(&self, _nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
        cubic(largest_rate(drivers), drivers)
    }

    fn parameters(&self, _nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<f64> {
        vec![first(coefficients), largest_rate(drivers)]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let coefficient = number(values, PARAMS[0].name)?;
        let at = number(values, PARAMS[1].name).unwrap_or_else(|| largest_rate(drivers));
        Some(cubic(at, drivers)?.into_iter().map(|x| coefficient * x).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::sizing::numbers;

    #[test]
    fn the_error_grows_with_the_square_of_the_rate_to_its_value_at_the_largest() {
        let drivers = Drivers { table_rate: Some(vec![-10.0, 5.0, 10.0]), ..Drivers::default() };
        let course = SfNonlinearity.course(&numbers([("cubic_ppm_at_max", 20.0)]), &drivers).unwrap();
        // 36 000 deg/h · 20 ppm; at half the rate an eighth of it.
        for (got, expected) in course.iter().zip([-0.72, 0.09, 0.72]) {
            assert!((got - expected).abs() < 1e-12, "{course:?}");
        }
    }
}
