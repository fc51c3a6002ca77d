//! A linear drift.

use crate::effect::{
    Drivers, MeanModel, Param, Place, Regressors, SearchContext, Sizing, Starts, Values, number,
};
use crate::numeric::range::Bounds;

pub struct RateRamp;

static PARAMS: [Param; 1] = [Param::reported("slope_deg_h_per_h", "deg/h/h", -1e6, 1e6).signed()];

describe! {
    RateRamp, "rate_ramp", Mean in Time, needs [],
    confusers ["excess_rrw", "warmup_exponential", "unobserved_driver"]
}

/// Hours from the middle of the record.
fn hours(drivers: &Drivers) -> Vec<f64> {
    let middle = 0.5 * drivers.length_s();
    drivers.of_time(|t| (t - middle) / 3600.0)
}

impl MeanModel for RateRamp {
    fn applies(&self, drivers: &Drivers) -> bool {
        drivers.samples >= 8
    }

    fn starts(&self, _drivers: &Drivers, _look: &SearchContext<'_>) -> Starts {
        Starts::linear()
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![]
    }

    fn regressors(&self, _shape: &[f64], drivers: &Drivers) -> Regressors {
        Regressors { columns: vec![hours(drivers)], ..Regressors::default() }
    }

    fn parameters(&self, _shape: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        vec![coefficients.first().copied().unwrap_or(f64::NAN)]
    }

    fn sizings(&self, _drivers: &Drivers) -> Vec<Sizing> {
        vec![Sizing::linear(&PARAMS[0])]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let slope = number(values, PARAMS[0].name)?;
        Some(hours(drivers).into_iter().map(|h| slope * h).collect())
    }

    fn places(&self, _shape: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        crate::effect::shared::reach::record(drivers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Value;

    #[test]
    fn a_ramp_turns_about_the_middle_of_the_record() {
        let drivers = Drivers { dt_s: 900.0, samples: 8, ..Drivers::default() };
        let course = RateRamp
            .course(&Values::from([("slope_deg_h_per_h".to_owned(), Value::Number(0.5))]), &drivers)
            .unwrap();
        // Two hours: −1 h at the first sample, a quarter of an hour each.
        for (i, got) in course.iter().enumerate() {
            assert!((got - 0.5 * (0.25 * i as f64 - 1.0)).abs() < 1e-12, "{course:?}");
        }
    }
}
