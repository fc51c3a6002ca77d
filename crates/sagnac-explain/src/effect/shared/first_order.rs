//! A first-order delay: of a column, of which the fit finds the time constant, and of the unknown state at the beginning of the
//! record. A coil is behind its thermometer in this way.

use super::reach::beginning_s;
use super::search::{best_of, log_grid};
use super::thermal::smooth;
use crate::effect::{Drivers, MeanModel, SearchContext, Starts};
use crate::numeric::range::Bounds;

/// The temperature behind a first-order delay that begins settled, °C. Between samples the temperature is taken for a
/// straight line.
pub(in crate::effect) fn delayed(t: &[f64], time_constant_s: f64, dt_s: f64) -> Vec<f64> {
    let Some(first) = t.first() else { return vec![] };
    let a = dt_s / time_constant_s;
    let (kept, lost) = ((-a).exp(), -(-a).exp_m1());
    let mut at = *first;
    let mut out = Vec::with_capacity(t.len());
    out.push(at);
    for pair in t.windows(2) {
        // Response to a line from one sample to the next: it trails behind by the time constant.
        let slope = pair[1] - pair[0];
        at = kept * at + lost * pair[0] + slope * (1.0 - lost / a);
        out.push(at);
    }
    out
}

/// Decay from 1 at the beginning of the record, averaged over each sample.
pub(in crate::effect) fn decay(time_constant_s: f64, drivers: &Drivers) -> Vec<f64> {
    let before = drivers.start_s - beginning_s(drivers);
    let half = 0.5 * drivers.dt_s / time_constant_s;
    let averaged = if half < 1e-4 { 1.0 + half * half / 6.0 } else { half.min(600.0).sinh() / half };
    drivers.of_time(|t| averaged * (-(t + before) / time_constant_s).exp())
}

/// The delayed temperature, °C; `None` without a temperature or for what is no time constant.
pub(in crate::effect) fn late(time_constant_s: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    let t = smooth(drivers)?;
    (time_constant_s > 0.0 && time_constant_s.is_finite()).then(|| delayed(t, time_constant_s, drivers.dt_s))
}

/// Bounds of the time constant, s: behind a delay that is long against the record every temperature is a straight line.
pub(in crate::effect) fn bounds(drivers: &Drivers) -> Vec<Bounds> {
    let low = drivers.dt_s;
    vec![Bounds::new(low, (0.25 * drivers.length_s()).max(4.0 * low))]
}

/// Points from which the search for the time constant begins.
pub(in crate::effect) fn starts(
    course: &dyn MeanModel,
    drivers: &Drivers,
    context: &SearchContext<'_>,
) -> Starts {
    let Bounds { low, high } = bounds(drivers)[0];
    let grid = log_grid(low, high, 24);
    let points = best_of(course, grid.into_iter().map(|t| vec![t]), 2, drivers, context);
    Starts { points, trials: (high / low).ln().max(1.0) }
}

/// Remainder of the unknown state at the beginning of the record, for a time constant as the only nonlinear parameter.
pub(in crate::effect) fn initial_state(nonlinear_parameters: &[f64], drivers: &Drivers) -> Vec<Vec<f64>> {
    nonlinear_parameters.iter().filter(|t| **t > 0.0).map(|t| decay(*t, drivers)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delayed_ramp_trails_by_the_time_constant() {
        let ramp: Vec<f64> = (0..4000).map(|i| 0.01 * f64::from(i)).collect();
        let (dt, time) = (0.5, 40.0);
        let late = delayed(&ramp, time, dt);
        // T − τ·dT/dt·(1 − e^(−t/τ)).
        for i in [1usize, 10, 100, 3999] {
            let t = i as f64 * dt;
            let expected = ramp[i] - time * 0.02 * (1.0 - (-t / time).exp());
            assert!((late[i] - expected).abs() < 1e-9, "{i}");
        }
        assert!(delayed(&[], 1.0, 1.0).is_empty());
    }

    #[test]
    fn a_decay_is_averaged_over_each_sample_and_begins_with_the_record() {
        // Each sample averages 10 of 1 s: the first is about the time 0, 4.5 s behind the beginning.
        let drivers = Drivers { dt_s: 10.0, samples: 3, averaged: 10, ..Drivers::default() };
        let time = 7.0;
        for (i, got) in decay(time, &drivers).iter().enumerate() {
            let middle = 4.5 + 10.0 * i as f64;
            let integral = time * ((5.0 - middle) / time).exp() - time * ((-5.0 - middle) / time).exp();
            assert!((got - integral / 10.0).abs() < 1e-12, "{i}: {got}");
        }
        // A decay over many records is level.
        assert!(decay(1e9, &drivers).iter().all(|x| (x - 1.0).abs() < 1e-6));
    }
}
