//! Any stamps through the clock and the tracker.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sagnac::numeric::range::{settled, usable};
use sagnac::recording::clock::{Clock, Tracker};

fuzz_target!(|stamps: Vec<f64>| {
    // As a reader hands them over: nothing beyond 1e60, nothing but zero below 1e-60.
    let stamps: Vec<f64> =
        stamps.into_iter().map(|t| if usable(t) { settled(t) } else { f64::NAN }).collect();
    sagnac_fuzz::watched(8 * stamps.len(), || {
        let Ok(clock) = Clock::probe(&stamps) else { return };
        assert!(clock.interval_s > 0.0 && clock.interval_s.is_finite(), "{clock:?}");
        let mut tracker = Tracker::new(clock);
        for (i, stamp) in stamps.iter().enumerate() {
            if !tracker.take_unbroken(std::slice::from_ref(stamp)) {
                tracker.step(*stamp, stamps.get(i + 1).copied());
            }
        }
        assert!(!tracker.mean_interval_s().is_nan());
    });
});
