//! A linear drift.

use crate::effect::{Drivers, MeanModel, Param};

pub struct RateRamp;

static PARAMS: [Param; 1] = [Param::reported("slope_deg_h_per_h", "deg/h/h", -1e6, 1e6).signed()];

describe! {
    RateRamp, "rate_ramp", Mean in Time, needs [],
    confusers [ExcessRrw, WarmupExponential, UnobservedDriver],
    properties [slow]
}

impl MeanModel for RateRamp {
    fn applies(&self, drivers: &Drivers) -> bool {
        drivers.samples >= 8
    }

    /// Hours from the middle of the record.
    fn column(&self, _nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
        let middle = 0.5 * drivers.length_s();
        Some(drivers.of_time(|t| (t - middle) / 3600.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::sizing::numbers;

    #[test]
    fn a_ramp_turns_about_the_middle_of_the_record() {
        let drivers = Drivers { dt_s: 900.0, samples: 8, ..Drivers::default() };
        let course = RateRamp.course(&numbers([("slope_deg_h_per_h", 0.5)]), &drivers).unwrap();
        // Two hours: −1 h at the first sample, a quarter of an hour each.
        for (i, got) in course.iter().enumerate() {
            assert!((got - 0.5 * (0.25 * i as f64 - 1.0)).abs() < 1e-12, "{course:?}");
        }
    }
}
