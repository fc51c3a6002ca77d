//! Jumps back and forth between two levels.

mod chain;
mod detect;
mod dwell;
mod path;

use super::markov::MarkovLong;
use crate::effect::{
    Background, Detection, Detector, Domain, Drivers, Effect, JumpDetector, Jumps, Param, Place, Pulses,
    Reported, Samples, Value, Values, list, number,
};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

pub struct RandomTelegraph;

static PARAMS: [Param; 3] = [
    Param::reported("amplitude_deg_h", "deg/h", -1e6, 1e6),
    Param::reported("mean_dwell_s", "s", 1e-6, 1e8),
    Param::inner("first_level", "", -1.0, 1.0),
];

/// Instants of the jumps, where they are known.
const SWITCHES_LIST: &str = "switches_time_s";

describe! {
    RandomTelegraph, "random_telegraph", Samples in Time, needs [],
    confusers [BiasStep, MarkovLong, UnobservedDriver],
    lists [Param::inner(SWITCHES_LIST, "s", f64::MIN, f64::MAX)],
    with {
        /// The course of known jumps.
        fn claimed_course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
            let switches = list(values, SWITCHES_LIST);
            if switches.is_empty() || switches.iter().any(|t| !t.is_finite()) {
                return None;
            }
            let amplitude = number(values, PARAMS[0].name)?;
            let first = if number(values, PARAMS[2].name).unwrap_or(-1.0) < 0.0 { -0.5 } else { 0.5 };
            Some(course(amplitude * first, switches, drivers))
        }
    }
}

/// A level that changes its sign at instants; each sample is the mean over its interval.
fn course(first_level: f64, switches: &[f64], drivers: &Drivers) -> Vec<f64> {
    let mut out = vec![first_level; drivers.samples];
    let mut change = -2.0 * first_level;
    for at in switches {
        let place = (at - drivers.start_s) / drivers.dt_s + 0.5;
        let from = place.floor().clamp(0.0, drivers.samples as f64) as usize;
        for (i, y) in out.iter_mut().enumerate().skip(from) {
            *y += change * (i as f64 + 1.0 - place).clamp(0.0, 1.0);
        }
        change = -change;
    }
    out
}

/// The same for many jumps, in one pass.
fn simulated(amplitude: f64, dwell_s: f64, drivers: &Drivers, rng: &mut Xoshiro256PlusPlus) -> Vec<f64> {
    let mut level = if rng.random::<bool>() { 0.5 * amplitude } else { -0.5 * amplitude };
    let mut next = -dwell_s * (1.0 - rng.random::<f64>()).ln();
    let dt = drivers.dt_s;
    (0..drivers.samples)
        .map(|i| {
            let (begin, end) = (i as f64 * dt, (i + 1) as f64 * dt);
            let (mut at, mut sum) = (begin, 0.0);
            while next < end {
                sum += level * (next - at);
                (at, level) = (next, -level);
                // A thousandth of a sample at least: shorter stays average out whatever their number.
                next += (-dwell_s * (1.0 - rng.random::<f64>()).ln()).max(1e-3 * dt);
            }
            (sum + level * (end - at)) / dt
        })
        .collect()
}

impl Samples for RandomTelegraph {
    fn apply(&self, values: &Values, drivers: &Drivers, seed: u64, rate: &mut [f64], _keep: &mut [bool]) {
        let drawn = || {
            let (amplitude, dwell) = (number(values, PARAMS[0].name)?, number(values, PARAMS[1].name)?);
            let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
            (dwell > 0.0).then(|| simulated(amplitude, dwell, drivers, &mut rng))
        };
        if let Some(course) = self.claimed_course(values, drivers).or_else(drawn) {
            rate.iter_mut().zip(course).for_each(|(y, c)| *y += c);
        }
    }

    fn detector(&self) -> Detector {
        Detector::Jumps(&RandomTelegraph)
    }
}

/// Fewest samples at a level that distinguish jumps from a process.
const FEWEST_AT_A_LEVEL: f64 = 6.0;
/// Half widths of the interval of the amplitude within which a stated one is that which was found.
const AS_STATED: f64 = 2.0;

impl RandomTelegraph {
    fn stated_size(stated: &Values) -> Option<(f64, f64)> {
        Some((number(stated, PARAMS[0].name)?.abs(), number(stated, PARAMS[1].name)?))
    }
}

impl JumpDetector for RandomTelegraph {
    fn find(&self, background: &Background<'_>, rival_gain: &dyn Fn() -> f64) -> Option<Jumps> {
        let drivers = background.drivers;
        let found = detect::telegraph(background, rival_gain)?;
        let n = found.path.len().max(1) as f64;
        let share = found.path.iter().map(|p| p * p).sum::<f64>() / n;
        let rms = found.amplitude_deg_h.abs() * share.sqrt();
        let [low, high] = found.amplitude_ci95.map(|a| a.abs() * share.sqrt());
        let (amplitude, dwell) = (&PARAMS[0], &PARAMS[1]);
        let jumps: Vec<usize> =
            (1..found.path.len()).filter(|i| found.path[*i] != found.path[*i - 1]).collect();
        let (first, last) = (*jumps.first()?, *jumps.last()?);
        let detection = Detection {
            reported: vec![
                Reported::new(amplitude.name, amplitude.unit, found.amplitude_deg_h, found.amplitude_ci95),
                Reported::new(dwell.name, dwell.unit, found.mean_dwell_s, found.dwell_ci95),
                Reported::new("rms_deg_h", "deg/h", rms, [low.min(high), low.max(high)]),
            ],
            stated: Values::from([
                (amplitude.name.to_owned(), Value::Number(found.amplitude_deg_h)),
                (dwell.name.to_owned(), Value::Number(found.mean_dwell_s)),
            ]),
            places: vec![Place {
                domain: Domain::Time,
                from: drivers.time_s(first),
                to: drivers.time_s(last),
            }],
            gain: found.gain,
            parameters: found.parameters,
            p_value: found.p_value,
        };
        let resolved = found.mean_dwell_s >= FEWEST_AT_A_LEVEL * drivers.dt_s && !found.regular;
        let detect::Telegraph { course, chance, rival_gain, pulses, .. } = found;
        let pulses = pulses.map(|v| Pulses { count: v.count, each_s: v.length * drivers.dt_s });
        Some(Jumps { course, detection, chance, rival_gain, resolved, pulses })
    }

    fn agrees(&self, stated: &Values, found: &Detection) -> bool {
        let found = found.reported(PARAMS[0].name);
        RandomTelegraph::stated_size(stated).zip(found).is_some_and(|((amplitude, _), found)| {
            let [low, high] = found.ci95;
            (found.value - amplitude).abs() < 0.5 * AS_STATED * (high - low)
        })
    }

    /// A Markov process: the autocovariance of the jumps is (amplitude/2)² exp(−2|t|/dwell).
    fn process(&self, stated: &Values) -> Option<(&'static dyn Effect, Vec<f64>)> {
        let (amplitude, dwell_s) = RandomTelegraph::stated_size(stated)?;
        Some((&MarkovLong, vec![0.5 * dwell_s, 0.5 * amplitude]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::sizing::numbers;

    #[test]
    fn the_autocovariance_is_that_of_the_telegraph_process() {
        let drivers = Drivers { dt_s: 1.0, samples: 400_000, ..Drivers::default() };
        let (amplitude, dwell) = (2.0, 50.0);
        let mut rate = vec![0.0; drivers.samples];
        let values = numbers([("amplitude_deg_h", amplitude), ("mean_dwell_s", dwell)]);
        RandomTelegraph.apply(&values, &drivers, 7, &mut rate, &mut []);
        for lag in [10usize, 25, 50] {
            let got =
                rate.iter().zip(&rate[lag..]).map(|(a, b)| a * b).sum::<f64>() / (rate.len() - lag) as f64;
            let expected = (-2.0 * lag as f64 / dwell).exp();
            // 4000 correlation times of 25 s each: about 0.012 of scatter.
            assert!((got - expected).abs() < 0.05, "{lag}: {got} {expected}");
        }
        assert!(rate.iter().all(|y| y.abs() <= 1.0 + 1e-12));
    }

    #[test]
    fn stated_jumps_have_the_process_of_their_spectrum_and_agree_within_their_interval() {
        let stated = |amplitude: f64| numbers([("amplitude_deg_h", amplitude), ("mean_dwell_s", 30.0)]);
        let (effect, fitted) = RandomTelegraph.process(&stated(-2.0)).unwrap();
        assert_eq!((effect.kind(), fitted), ("markov_long", vec![15.0, 1.0]));
        assert!(RandomTelegraph.process(&Values::new()).is_none());
        let found = Detection {
            reported: vec![Reported::new("amplitude_deg_h", "deg/h", 2.0, [1.9, 2.1])],
            ..Detection::default()
        };
        assert!(
            RandomTelegraph.agrees(&stated(-2.19), &found) && !RandomTelegraph.agrees(&stated(2.21), &found)
        );
    }

    #[test]
    fn known_jumps_are_averaged_in_the_sample_that_they_fall_into() {
        let drivers = Drivers { dt_s: 1.0, start_s: 100.0, samples: 6, ..Drivers::default() };
        let values = Values::from([
            ("amplitude_deg_h".to_owned(), Value::Number(2.0)),
            (SWITCHES_LIST.to_owned(), Value::List(vec![101.75, 104.0])),
        ]);
        let course = RandomTelegraph.claimed_course(&values, &drivers).unwrap();
        assert_eq!(course, [-1.0, -1.0, 0.5, 1.0, 0.0, -1.0]);
    }

    #[test]
    fn the_dwell_is_counted_in_seconds_whatever_the_sampling() {
        let drivers = Drivers { dt_s: 0.25, samples: 400_000, ..Drivers::default() };
        let mut rate = vec![0.0; drivers.samples];
        let values = numbers([("amplitude_deg_h", 2.0), ("mean_dwell_s", 20.0)]);
        RandomTelegraph.apply(&values, &drivers, 5, &mut rate, &mut []);
        // exp(−2·5/20) after 5 s, 20 samples; 10 000 correlation times.
        let got = rate.iter().zip(&rate[20..]).map(|(a, b)| a * b).sum::<f64>() / 399_980.0;
        assert!((got - (-0.5f64).exp()).abs() < 0.04, "{got}");
    }
}
