//! Isolated groups of outlying samples.

mod detect;

use crate::effect::{
    Detection, Detector, Domain, Drivers, FlatResidual, OutlierDetector, Outliers, Param, Place, Reported,
    Samples, Value, Values, list, number,
};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

pub struct OutlierBursts;

static PARAMS: [Param; 3] = [
    Param::reported("count", "", 1.0, 1e5).count(1.0),
    Param::inner("size_deg_h", "deg/h", 0.0, 1e9),
    Param::inner("duration_s", "s", 0.0, 1e6),
];

/// First instant, length and size of each burst.
const TIMES_LIST: &str = "bursts_time_s";
const DURATIONS_LIST: &str = "bursts_duration_s";
const SIZES_LIST: &str = "bursts_size_deg_h";

describe! {
    OutlierBursts, "outlier_bursts", Samples in Time, needs [],
    confusers [NoiseVarianceTime, BiasStep, ExcessArw],
    lists [
        Param::inner(TIMES_LIST, "s", f64::MIN, f64::MAX),
        Param::inner(DURATIONS_LIST, "s", 0.0, 1e6),
        Param::inner(SIZES_LIST, "deg/h", 0.0, 1e9)
    ],
    properties [short_events]
}

/// A burst: first instant s, length s, size deg/h.
struct Burst(f64, f64, f64);

fn bursts(values: &Values, drivers: &Drivers, rng: &mut Xoshiro256PlusPlus) -> Vec<Burst> {
    let one = |name: &str, fallback: f64| number(values, name).filter(|x| x.is_finite()).unwrap_or(fallback);
    let (size, duration) = (one(PARAMS[1].name, 0.0), one(PARAMS[2].name, drivers.dt_s));
    let times = list(values, TIMES_LIST);
    if !times.is_empty() {
        let of = |name: &str, i: usize, fallback: f64| list(values, name).get(i).copied().unwrap_or(fallback);
        return (0..times.len())
            .map(|i| Burst(times[i], of(DURATIONS_LIST, i, duration), of(SIZES_LIST, i, size)))
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

    fn detector(&self) -> Detector {
        Detector::Outliers(&OutlierBursts)
    }
}

impl OutlierDetector for OutlierBursts {
    fn find(&self, residual: &FlatResidual<'_>) -> Option<Outliers> {
        detect::bursts(residual)
    }

    fn describe(&self, found: &Outliers, removed: &[f64], drivers: &Drivers) -> Option<Detection> {
        let count = found.groups.len() as f64;
        let n = removed.len().max(1) as f64;
        let mean = removed.iter().sum::<f64>() / n;
        let rms = (removed.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / n).sqrt();
        let spread = 1.96 / (2.0 * found.samples.len().max(1) as f64).sqrt();
        let size = |g: &(usize, usize)| {
            let inside = &removed[g.0..g.0 + g.1];
            (inside.iter().map(|r| r * r).sum::<f64>() / inside.len().max(1) as f64).sqrt()
        };
        let list = |f: &dyn Fn(&(usize, usize)) -> f64| Value::List(found.groups.iter().map(f).collect());
        let stated = Values::from([
            (PARAMS[0].name.to_owned(), Value::Number(count)),
            (TIMES_LIST.to_owned(), list(&|g| drivers.time_s(g.0))),
            (DURATIONS_LIST.to_owned(), list(&|g| g.1 as f64 * drivers.dt_s)),
            (SIZES_LIST.to_owned(), list(&size)),
        ]);
        let (first, last) = (found.groups.first()?, found.groups.last()?);
        let largest = found.samples.iter().map(|i| removed[*i].abs()).fold(0.0, f64::max);
        let places = vec![
            Place {
                domain: Domain::Time,
                from: drivers.time_s(first.0) - drivers.dt_s,
                to: drivers.time_s(last.0 + last.1),
            },
            Place { domain: Domain::Amplitude, from: 0.3 * largest, to: largest },
        ];
        Some(Detection {
            reported: vec![
                Reported::new(PARAMS[0].name, PARAMS[0].unit, count, [count, count + found.missed as f64]),
                Reported::new("rms_deg_h", "deg/h", rms, [rms * (-spread).exp(), rms * spread.exp()]),
            ],
            stated,
            places,
            gain: found.gain,
            parameters: found.parameters,
            p_value: found.p_value,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::sizing::numbers;

    #[test]
    fn only_the_listed_samples_are_disturbed_and_the_seed_fixes_them() {
        let drivers = Drivers { dt_s: 0.5, start_s: 10.0, samples: 40, ..Drivers::default() };
        let list = |x: &[f64]| Value::List(x.to_vec());
        let values = Values::from([
            (TIMES_LIST.to_owned(), list(&[12.0, 27.0])),
            (DURATIONS_LIST.to_owned(), list(&[1.5, 0.5])),
            (SIZES_LIST.to_owned(), list(&[10.0, 20.0])),
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
    fn groups_are_described_by_what_was_taken_out() {
        let drivers = Drivers { dt_s: 0.5, start_s: 10.0, samples: 10, ..Drivers::default() };
        let mut removed = vec![0.0; 10];
        (removed[2], removed[3], removed[7]) = (3.0, -4.0, 5.0);
        let found = Outliers {
            groups: vec![(2, 2), (7, 1)],
            samples: vec![2, 3, 7],
            missed: 1,
            deviation: 3.0,
            gain: 20.0,
            parameters: 5,
            p_value: 1e-6,
        };
        let told = OutlierBursts.describe(&found, &removed, &drivers).unwrap();
        let value = |name: &str| told.reported(name).unwrap();
        assert_eq!((value("count").value, value("count").ci95), (2.0, [2.0, 3.0]));
        // Mean 0.4, mean square 5.
        assert!((value("rms_deg_h").value - 4.84f64.sqrt()).abs() < 1e-12);
        assert_eq!(list(&told.stated, SIZES_LIST), [12.5f64.sqrt(), 5.0]);
        assert_eq!(
            (list(&told.stated, TIMES_LIST), list(&told.stated, DURATIONS_LIST)),
            (&[11.0, 13.5][..], &[1.0, 0.5][..])
        );
        assert_eq!((told.places[0].from, told.places[0].to, told.places[1].to), (10.5, 14.0, 5.0));
    }

    #[test]
    fn a_count_gives_so_many_bursts() {
        let drivers = Drivers { dt_s: 1.0, samples: 100_000, ..Drivers::default() };
        let values = numbers([("count", 12.0), ("size_deg_h", 5.0)]);
        let mut rate = vec![0.0; 100_000];
        OutlierBursts.apply(&values, &drivers, 3, &mut rate, &mut []);
        assert_eq!(rate.iter().filter(|y| **y != 0.0).count(), 12);
    }
}
