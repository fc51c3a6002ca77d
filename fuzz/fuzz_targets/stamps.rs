//! Any stamps through the clock and the tracker.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sagnac::recording::timebase::{Clock, Tracker};

fuzz_target!(|stamps: Vec<f64>| {
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
