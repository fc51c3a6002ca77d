//! Units that drift on when a warm-up record ends.

use sagnac_studies::thermal::warm_up::{bounded, one_decay};

#[test]
fn a_unit_that_drifts_on_is_not_called_warm() {
    // 0.3 and 0.5 deg/h that decay in two and four lengths of the record: 0.17 and 0.38 deg/h are still to go.
    for (amplitude, constant, seed) in [(0.3, 20_000.0, 1), (0.5, 40_000.0, 2), (-0.3, 20_000.0, 3)] {
        let f = one_decay((amplitude, constant), 10_800.0, 0.003, seed);
        assert!(f.drifts_on(), "{amplitude} {constant}: {:?}", f.settled);
        // No time is stated, and no bound goes beyond the record.
        assert!(bounded(&f).is_none_or(|least| least <= 10_800.0), "{:?}", f.settled);
    }
}

#[test]
fn a_unit_that_settles_keeps_its_time() {
    for (amplitude, constant, seed) in [(0.3, 900.0, 4), (-0.5, 600.0, 5)] {
        let f = one_decay((amplitude, constant), 10_800.0, 0.003, seed);
        assert!(!f.drifts_on() && !f.too_short, "{:?}", f.settled);
        let i = f.time.spread.interval(f.time.value, 0.95).unwrap();
        let truth = constant * (f64::abs(amplitude) / 0.02).ln();
        assert!((i.low..=i.high).contains(&truth), "{truth} in {i:?}");
    }
    let rests = one_decay((0.0, 900.0), 10_800.0, 0.003, 6);
    assert!(!rests.drifts_on(), "{:?}", rests.settled);
}
