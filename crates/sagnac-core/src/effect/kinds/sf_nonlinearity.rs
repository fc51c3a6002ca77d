//! A scale factor that depends on the size of the rate.

use crate::effect::shared::reach::varies;
use crate::effect::{
    Drivers, MeanModel, Param, Place, Regressors, Resolution, SearchContext, Sizing, Starts, Values, number,
};
use crate::numeric::range::Bounds;

pub struct SfNonlinearity;

static PARAMS: [Param; 2] = [
    Param::reported("cubic_ppm_at_max", "ppm", -1e5, 1e5).signed(),
    Param::inner("largest_rate_deg_s", "deg/s", 1e-12, 1e6),
];

describe! {
    SfNonlinearity, "sf_nonlinearity", Mean in InputRate, needs [TableRate],
    confusers ["sf_error", "saturation", "sf_asymmetry"]
}

fn largest(drivers: &Drivers) -> f64 {
    drivers.table_rate.iter().flatten().map(|r| r.abs()).fold(0.0, f64::max)
}

fn column(largest: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    let rate = drivers.table_rate.as_ref()?;
    (largest > 0.0).then(|| rate.iter().map(|r| 3600e-6 * r * (r / largest).powi(2)).collect())
}

impl MeanModel for SfNonlinearity {
    fn resolution(&self) -> Resolution {
        Resolution::FullRate
    }

    /// With a single size of rate the cubic term is a scale factor.
    fn applies(&self, drivers: &Drivers) -> bool {
        let most = largest(drivers);
        let between = |r: &f64| r.abs() > 0.1 * most && r.abs() < 0.9 * most;
        varies(drivers.table_rate.as_deref()) && drivers.table_rate.iter().flatten().any(between)
    }

    fn starts(&self, _drivers: &Drivers, _look: &SearchContext<'_>) -> Starts {
        Starts::linear()
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![]
    }

    fn regressors(&self, _shape: &[f64], drivers: &Drivers) -> Regressors {
        Regressors {
            columns: column(largest(drivers), drivers).into_iter().collect(),
            ..Regressors::default()
        }
    }

    fn parameters(&self, _shape: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<f64> {
        vec![coefficients.first().copied().unwrap_or(f64::NAN), largest(drivers)]
    }

    fn sizings(&self, _drivers: &Drivers) -> Vec<Sizing> {
        vec![Sizing::linear(&PARAMS[0])]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let coefficient = number(values, PARAMS[0].name)?;
        let at = number(values, PARAMS[1].name).unwrap_or_else(|| largest(drivers));
        Some(column(at, drivers)?.into_iter().map(|x| coefficient * x).collect())
    }

    fn places(&self, _shape: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        crate::effect::shared::reach::large_rates(drivers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Value;

    #[test]
    fn the_error_grows_with_the_square_of_the_rate_to_its_value_at_the_largest() {
        let drivers = Drivers { table_rate: Some(vec![-10.0, 5.0, 10.0]), ..Drivers::default() };
        let course = SfNonlinearity
            .course(&Values::from([("cubic_ppm_at_max".to_owned(), Value::Number(20.0))]), &drivers)
            .unwrap();
        // 36 000 deg/h · 20 ppm; at half the rate an eighth of it.
        for (got, expected) in course.iter().zip([-0.72, 0.09, 0.72]) {
            assert!((got - expected).abs() < 1e-12, "{course:?}");
        }
    }
}
