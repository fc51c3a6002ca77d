//! Isolated groups of outlying samples.

use crate::effect::{Drivers, Param, Samples, Values, list, number};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

pub struct OutlierBursts;

static PARAMS: [Param; 3] = [
    Param::reported("count", "", 1.0, 1e5).whole(),
    Param::inner("size_deg_h", "deg/h", 0.0, 1e9),
    Param::inner("duration_s", "s", 0.0, 1e6),
];

/// First instant, length and size of each burst.
const TIMES: &str = "bursts_time_s";
const DURATIONS: &str = "bursts_duration_s";
const SIZES: &str = "bursts_size_deg_h";

describe! {
    OutlierBursts, "outlier_bursts", Samples in Time, needs [],
    confusers ["noise_variance_time", "bias_step", "excess_arw"],
    lists [
        Param::inner(TIMES, "s", f64::MIN, f64::MAX),
        Param::inner(DURATIONS, "s", 0.0, 1e6),
        Param::inner(SIZES, "deg/h", 0.0, 1e9)
    ]
}

/// A burst: first instant s, length s, size deg/h.
struct Burst(f64, f64, f64);

fn bursts(values: &Values, drivers: &Drivers, rng: &mut Xoshiro256PlusPlus) -> Vec<Burst> {
    let one = |name: &str, fallback: f64| number(values, name).filter(|x| x.is_finite()).unwrap_or(fallback);
    let (size, duration) = (one(PARAMS[1].name, 0.0), one(PARAMS[2].name, drivers.dt_s));
    let times = list(values, TIMES);
    if !times.is_empty() {
        let of = |name: &str, i: usize, fallback: f64| list(values, name).get(i).copied().unwrap_or(fallback);
        return (0..times.len())
            .map(|i| Burst(times[i], of(DURATIONS, i, duration), of(SIZES, i, size)))
            .collect();
    }
    let count = one(PARAMS[0].name, 0.0).clamp(0.0, 1e5) as usize;
    (0..count)
        .map(|_| Burst(drivers.start_s + rng.random::<f64>() * drivers.length_s(), duration, size))
        .collect()
}

impl Samples for OutlierBursts {
    /// Bursts at the listed instants, else `count` of them anywhere; every sample of one is disturbed on its own.
    fn apply(&self, values: &Values, drivers: &Drivers, seed: u64, rate: &mut [f64], _keep: &mut [bool]) {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        for Burst(time, duration, size) in bursts(values, drivers, &mut rng) {
            let first = ((time - drivers.start_s) / drivers.dt_s).round();
            let samples = (duration / drivers.dt_s).round().max(1.0);
            if !(first.is_finite() && samples.is_finite()) {
                continue;
            }
            let (from, to) = (first.max(0.0) as usize, (first + samples).max(0.0) as usize);
            for y in rate.iter_mut().take(to).skip(from) {
                let e: f64 = StandardNormal.sample(&mut rng);
                *y += size * e;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Value;

    #[test]
    fn only_the_listed_samples_are_disturbed_and_the_seed_fixes_them() {
        let drivers = Drivers { dt_s: 0.5, start_s: 10.0, samples: 40, ..Drivers::default() };
        let list = |x: &[f64]| Value::List(x.to_vec());
        let values = Values::from([
            (TIMES.to_owned(), list(&[12.0, 27.0])),
            (DURATIONS.to_owned(), list(&[1.5, 0.5])),
            (SIZES.to_owned(), list(&[10.0, 20.0])),
        ]);
        let run = |seed| {
            let mut rate = vec![0.0; 40];
            OutlierBursts.apply(&values, &drivers, seed, &mut rate, &mut [true; 40]);
            rate
        };
        let hit: Vec<usize> = run(1).iter().enumerate().filter(|(_, y)| **y != 0.0).map(|(i, _)| i).collect();
        assert_eq!(hit, [4, 5, 6, 34]);
        assert_eq!(run(1), run(1));
        assert_ne!(run(1), run(2));
    }

    #[test]
    fn a_count_gives_so_many_bursts() {
        let drivers = Drivers { dt_s: 1.0, samples: 100_000, ..Drivers::default() };
        let values = Values::from([
            ("count".to_owned(), Value::Number(12.0)),
            ("size_deg_h".to_owned(), Value::Number(5.0)),
        ]);
        let mut rate = vec![0.0; 100_000];
        OutlierBursts.apply(&values, &drivers, 3, &mut rate, &mut []);
        assert_eq!(rate.iter().filter(|y| **y != 0.0).count(), 12);
    }
}
