//! The level of the noise depends on the input rate.

use crate::effect::{Drivers, Param, Samples, Values, number};

pub struct NoiseVarianceRate;

static PARAMS: [Param; 2] = [Param::reported("ratio", "", 1e-3, 1e3), Param::inner("exponent", "", 1.0, 2.0)];

describe! {
    NoiseVarianceRate, "noise_variance_rate", Samples in InputRate, needs [TableRate],
    confusers ["noise_variance_time", "sf_nonlinearity", "reset_ripple"]
}

impl Samples for NoiseVarianceRate {
    fn apply(&self, values: &Values, drivers: &Drivers, _seed: u64, rate: &mut [f64], _keep: &mut [bool]) {
        let (Some(ratio), Some(table)) = (number(values, PARAMS[0].name), &drivers.table_rate) else {
            return;
        };
        let largest = table.iter().map(|r| r.abs()).fold(0.0, f64::max);
        if largest <= 0.0 {
            return;
        }
        let exponent = number(values, PARAMS[1].name).unwrap_or(2.0);
        let gain = |i: usize| {
            let share = table.get(i).map_or(0.0, |r| (r.abs() / largest).powf(exponent));
            (1.0 + (ratio * ratio - 1.0) * share).max(0.0).sqrt()
        };
        crate::effect::shared::noise_level::scale(drivers, rate, gain);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Value;

    #[test]
    fn the_level_is_the_claimed_one_at_rest_and_the_ratio_at_the_largest_rate() {
        let table = vec![0.0, 5.0, -10.0, 10.0];
        let drivers =
            Drivers { dt_s: 1.0, samples: 4, table_rate: Some(table.clone()), ..Drivers::default() };
        let mut rate: Vec<f64> = table.iter().map(|r| 3600.0 * r + 1.0).collect();
        let values = Values::from([("ratio".to_owned(), Value::Number(2.0))]);
        NoiseVarianceRate.apply(&values, &drivers, 1, &mut rate, &mut [true; 4]);
        let left: Vec<f64> = rate.iter().zip(&table).map(|(y, r)| y - 3600.0 * r).collect();
        for (got, expected) in left.iter().zip([1.0, 1.75f64.sqrt(), 2.0, 2.0]) {
            assert!((got - expected).abs() < 1e-9);
        }
    }
}
