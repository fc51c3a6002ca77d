//! A smooth contribution that follows a quantity which was not recorded.

use crate::effect::shared::knots::{Knots, values_of_knots};
use crate::effect::shared::markov::starts_between;
use crate::effect::shared::search::log_grid;
use crate::effect::shared::sinusoid::averaged;
use crate::effect::{
    ClaimedByCourse, Domain, Drivers, Knot, ModeBin, Param, Place, SpectralContext, SpectralSizing, Spectrum,
    Values, list,
};
use crate::noise::composite::{Composite, Damped, Sampling};
use crate::numeric::range::Bounds;
use std::f64::consts::PI;

pub struct UnobservedDriver;

static PARAMS: [Param; 2] =
    [Param::inner("driver_rms_deg_h", "deg/h", 0.0, 1e6), Param::inner("driver_time_s", "s", 1e-6, 1e8)];

const KNOT_TIMES: &str = "knots_time_s";
const KNOT_VALUES: &str = "knots_deg_h";

describe! {
    UnobservedDriver, "unobserved_driver", Spectrum in Time, needs [],
    confusers [ExcessRrw, MarkovLong, RateRamp, WarmupExponential],
    lists [Param::inner(KNOT_TIMES, "s", f64::MIN, f64::MAX), Param::inner(KNOT_VALUES, "deg/h", -1e6, 1e6)],
    properties [free_form],
    with {
        /// Straight lines between knots, the first and last values held outside.
        fn claimed_course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
            let knots = Knots::new(list(values, KNOT_TIMES), list(values, KNOT_VALUES))?;
            Some((0..drivers.samples).map(|i| knots.at(drivers.time_s(i))).collect())
        }
        fn claimed_by_course(&self) -> Option<&'static dyn ClaimedByCourse> {
            Some(&UnobservedDriver)
        }
    }
}

/// Fewest knots of a course from which its size and pace can be estimated.
const FEWEST_KNOTS: usize = 8;

impl ClaimedByCourse for UnobservedDriver {
    fn values(&self, knots: &[Knot]) -> Values {
        values_of_knots(knots, KNOT_TIMES, KNOT_VALUES).into()
    }

    /// Root mean square, and the time that it takes a smooth process to change by as much: its slope is the one over the
    /// other.
    fn process(&self, claimed: &Values) -> Option<Vec<f64>> {
        let (times, knots) = (list(claimed, KNOT_TIMES), list(claimed, KNOT_VALUES));
        if knots.len() < FEWEST_KNOTS || times.len() != knots.len() {
            return None;
        }
        let n = knots.len() as f64;
        let mean = knots.iter().sum::<f64>() / n;
        let rms = (knots.iter().map(|k| (k - mean).powi(2)).sum::<f64>() / n).sqrt();
        let slopes =
            times.windows(2).zip(knots.windows(2)).map(|(t, k)| ((k[1] - k[0]) / (t[1] - t[0])).powi(2));
        let slope = (slopes.sum::<f64>() / (n - 1.0)).sqrt();
        (rms > 0.0 && slope > 0.0 && slope.is_finite()).then(|| vec![rms, rms / slope])
    }
}

fn split(fitted: &[f64]) -> (f64, f64) {
    (fitted.first().copied().unwrap_or(0.0), fitted.get(1).copied().unwrap_or(1.0).max(1e-12))
}

/// Step of the derivative by the logarithm of the time.
const LOG_STEP: f64 = 1e-3;

impl Spectrum for UnobservedDriver {
    fn scales_with(&self, parameter: usize) -> Option<f64> {
        (parameter == 0).then_some(2.0)
    }

    /// Exact in single modes: with a = 1/T the covariance is (1 − a d/da) e^(−a|t|), and the power of a mode is the same
    /// of that of a Markov process.
    fn densities(&self, fitted: &[f64], bins: &[ModeBin]) -> Vec<f64> {
        let Some(first) = bins.first() else { return vec![] };
        let (rms, time) = split(fitted);
        let corner = 1.0 / (2.0 * PI * time);
        let markov = |factor: f64| {
            let process = Damped { rms_deg_h: rms, frequency_hz: 0.0, decay_time_s: time / factor };
            process.modes(first.samples, first.dt_s, Sampling::Averaging)
        };
        let (at, faster, slower) = (markov(1.0), markov(LOG_STEP.exp()), markov((-LOG_STEP).exp()));
        // The ends of the record, at which a mode has no slope and the process has one, add their own k⁻⁴.
        let ends = time / (first.samples as f64 * first.dt_s);
        let one = |bin: &ModeBin| {
            let x = (bin.frequency_hz / corner).powi(2);
            if bin.modes == 1 && x < 3e4 {
                let slope = (faster.power(bin.mode) - slower.power(bin.mode)) / (2.0 * LOG_STEP);
                return (at.power(bin.mode) - slope).max(0.0);
            }
            let of_samples = averaged(bin.frequency_hz * bin.dt_s).powi(2);
            let ends = 1.0 + if x > 1.0 { ends } else { 0.0 };
            2.0 * rms * rms / (PI * corner) / (1.0 + x).powi(2) * of_samples * ends
        };
        bins.iter().map(one).collect()
    }

    fn starts(&self, context: &SpectralContext<'_>) -> Vec<Vec<f64>> {
        let Bounds { low, high } = self.bounds(context)[1];
        let markov = starts_between(1.5 * low, high / 1.5, context);
        markov.into_iter().map(|s| s.into_iter().rev().collect()).collect()
    }

    fn bounds(&self, context: &SpectralContext<'_>) -> Vec<Bounds> {
        let (dt, n) = context.bins.first().map_or((1.0, 64), |b| (b.dt_s, b.samples));
        let length = n as f64 * dt;
        vec![Bounds::new(1e-9, 1e9), Bounds::new((20.0 * dt).max(0.002 * length), 2.0 * length)]
    }

    fn trials(&self, context: &SpectralContext<'_>) -> f64 {
        let Bounds { low, high } = self.bounds(context)[1];
        (high / low).ln().max(1.0)
    }

    /// A claimed driver is a course through its knots and no noise.
    fn claimed_parameters(&self, _values: &Values) -> Option<Vec<f64>> {
        None
    }

    /// Its course is simulated from knots: see `Effect::claimed_course`.
    fn compose(&self, _fitted: &[f64], _dt_s: f64, _noise: &mut Composite) {}

    /// Times from a fiftieth of the record to its length.
    fn sizing(&self, context: &SpectralContext<'_>) -> Option<SpectralSizing> {
        let Bounds { low, high } = self.bounds(context)[1];
        let times = log_grid((0.01 * high).max(low), 0.5 * high, 5).into_iter();
        let places = times.map(|time| vec![1.0, time]).collect();
        Some(SpectralSizing { parameter: &PARAMS[0], position: 0, falls: false, places })
    }

    /// Times count from the first sample.
    fn places(&self, fitted: &[f64], context: &SpectralContext<'_>) -> Vec<Place> {
        let Some(bin) = context.bins.first() else { return vec![] };
        let length = bin.samples as f64 * bin.dt_s;
        let (_, time) = split(fitted);
        let from = 0.5 / length;
        let to = (3.0 / (2.0 * PI * time)).clamp(from, 0.5 / bin.dt_s);
        vec![
            Place { domain: Domain::Time, from: 0.0, to: length },
            Place { domain: Domain::Frequency, from, to },
        ]
    }

    fn has_course(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The covariance of means over 1 s, summed over all pairs of samples.
    fn summed(time: f64, k: usize, n: usize) -> f64 {
        let covariance = |lag: f64| (1.0 + lag.abs() / time) * (-lag.abs() / time).exp();
        let steps = 400;
        let averaged: Vec<f64> = (0..n)
            .map(|lag| {
                let one = |i: usize| {
                    let w = (i as f64 + 0.5) / (steps / 2) as f64 - 1.0;
                    (1.0 - w.abs()) * covariance(lag as f64 + w) / (steps / 2) as f64
                };
                (0..steps).map(one).sum()
            })
            .collect();
        let phase = |i: usize| (PI * k as f64 * (i as f64 + 0.5) / n as f64).cos();
        let mut sum = 0.0;
        for i in 0..n {
            for j in 0..n {
                sum += 2.0 / n as f64 * phase(i) * phase(j) * averaged[i.abs_diff(j)];
            }
        }
        sum
    }

    #[test]
    fn a_stated_course_has_the_size_and_the_pace_of_its_knots() {
        // Deviations ±2 about 5, a change of 4 each 10 s: a slope of 0.4 √(9/9) deg/h/s.
        let knots: Vec<Knot> = (0..10)
            .map(|i| Knot { at: 10.0 * f64::from(i), value: if i % 2 == 0 { 7.0 } else { 3.0 } })
            .collect();
        let fitted = UnobservedDriver.process(&UnobservedDriver.values(&knots)).unwrap();
        assert!((fitted[0] - 2.0).abs() < 1e-12 && (fitted[1] - 5.0).abs() < 1e-12, "{fitted:?}");
        assert!(UnobservedDriver.process(&UnobservedDriver.values(&knots[..7])).is_none());
    }

    #[test]
    fn modes_agree_with_the_covariance_summed_over_all_pairs() {
        let n = 200;
        for time in [25.0, 120.0, 300.0] {
            let bin = |mode, modes| ModeBin {
                frequency_hz: mode as f64 / (2.0 * n as f64),
                mode,
                modes,
                samples: n,
                dt_s: 1.0,
                even_ends: false,
            };
            for k in [1usize, 2, 5, 12, 13, 30] {
                let (exact, sum) = (UnobservedDriver.density(&[1.0, time], &bin(k, 1)), summed(time, k, n));
                assert!((exact / sum - 1.0).abs() < 0.01, "{time} {k}: {exact} {sum}");
            }
            // Even and odd modes take the slopes at the ends with different signs; the closed form has their mean.
            let ratio = |k| UnobservedDriver.density(&[1.0, time], &bin(k, 2)) / summed(time, k, n);
            let mean = 0.5 * (ratio(30) + ratio(31));
            assert!((mean - 1.0).abs() < 0.03, "{time}: {mean}");
        }
    }
}
