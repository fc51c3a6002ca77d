//! A transient that decays from the beginning of the record.

use super::reach::beginning_s;
use crate::effect::Drivers;

/// Decay from 1 at the beginning of the record, averaged over each sample.
pub(in crate::effect) fn decay(time_constant_s: f64, drivers: &Drivers) -> Vec<f64> {
    let before = drivers.start_s - beginning_s(drivers);
    let half = 0.5 * drivers.dt_s / time_constant_s;
    let averaged = if half < 1e-4 { 1.0 + half * half / 6.0 } else { half.min(600.0).sinh() / half };
    drivers.of_time(|t| averaged * (-(t + before) / time_constant_s).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

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
