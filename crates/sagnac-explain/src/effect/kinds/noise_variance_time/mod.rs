//! The level of the noise changes during the record.

mod forms;

use crate::effect::shared::knots::{Knots, values_of_knots};
use crate::effect::shared::noise_level::scale;
use crate::effect::{
    Detector, Drivers, FlatResidual, Law, Level, LevelDetector, LevelLaw, Param, Samples, Values, list,
    number,
};

pub struct NoiseVarianceTime;

static PARAMS: [Param; 1] = [Param::reported("ratio", "", 1.0, 1e3)];

/// Names of the lists of instants and of the ratios to the claimed level there.
const KNOT_TIMES: &str = "knots_time_s";
const KNOT_RATIOS: &str = "knots_ratio";

describe! {
    NoiseVarianceTime, "noise_variance_time", Samples in Time, needs [],
    confusers [OutlierBursts, NoiseVarianceDriver, NoiseVarianceRate],
    lists [
        Param::inner(KNOT_TIMES, "s", f64::MIN, f64::MAX),
        Param::inner(KNOT_RATIOS, "", 0.0, 1e3)
    ]
}

impl Samples for NoiseVarianceTime {
    /// Without knots the level rises from the claimed one to `ratio` times that over the record.
    fn apply(&self, values: &Values, drivers: &Drivers, _seed: u64, rate: &mut [f64], _keep: &mut [bool]) {
        if let Some(knots) = Knots::new(list(values, KNOT_TIMES), list(values, KNOT_RATIOS)) {
            scale(drivers, rate, |i| knots.at(drivers.time_s(i)).max(0.0));
        } else if let Some(ratio) = number(values, PARAMS[0].name) {
            let last = drivers.samples.max(2) as f64 - 1.0;
            scale(drivers, rate, |i| 1.0 + (ratio - 1.0) * i as f64 / last);
        }
    }

    fn detector(&self) -> Detector {
        Detector::Level(&NoiseVarianceTime)
    }
}

impl LevelDetector for NoiseVarianceTime {
    /// The best form over time.
    fn laws(&self, residual: &FlatResidual<'_>, samples: &[usize]) -> Vec<LevelLaw> {
        forms::over_time(residual, samples).into_iter().collect()
    }

    fn instants_of_change(&self, samples: usize) -> Option<f64> {
        Some(forms::instants_of_change(samples))
    }

    fn stated(&self, level: &Level, _drivers: &Drivers) -> Values {
        let Law::Time(knots) = &level.law else { return Values::new() };
        values_of_knots(knots, KNOT_TIMES, KNOT_RATIOS).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::sizing::numbers;
    use crate::effect::{ClaimedMean, Value};

    #[test]
    fn deviations_are_scaled_about_the_claimed_mean() {
        let claim = ClaimedMean { bias_deg_h: 5.0, ..ClaimedMean::default() };
        let drivers = Drivers { dt_s: 1.0, start_s: 100.0, samples: 5, claim, ..Drivers::default() };
        let mut rate = vec![6.0, 4.0, 6.0, 4.0, 6.0];
        let list = |x: &[f64]| Value::List(x.to_vec());
        let values = Values::from([
            (KNOT_TIMES.to_owned(), list(&[100.0, 104.0])),
            (KNOT_RATIOS.to_owned(), list(&[1.0, 3.0])),
        ]);
        NoiseVarianceTime.apply(&values, &drivers, 1, &mut rate, &mut [true; 5]);
        assert_eq!(rate, [6.0, 3.5, 7.0, 2.5, 8.0]);
        let mut rate = vec![6.0; 5];
        let values = numbers([("ratio", 2.0)]);
        NoiseVarianceTime.apply(&values, &drivers, 1, &mut rate, &mut [true; 5]);
        assert_eq!(rate, [6.0, 6.25, 6.5, 6.75, 7.0]);
    }
}
