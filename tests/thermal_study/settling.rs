//! Units that drift on when a warm-up record ends.

use crate::chamber::{Noise, warm_up as switched_on};
use crate::{first, runs, warm_up_rows};
use sagnac::temperature::start::Start;
use sagnac::temperature::track::Track;
use sagnac::temperature::warm_up::{WarmUpFindings, find};
use sagnac::temperature::{StartAsked, WarmUpTest};

/// A record of one decay, with a band of 0.02 deg/h.
fn found(decay: (f64, f64), length_s: f64, n: f64, seed: u64) -> WarmUpFindings {
    let dt = 5.0;
    let noise = Noise { n, b: 0.001, k: 0.0 };
    let y = switched_on(&[decay], 12.5, noise, dt, (length_s / dt) as usize, seed);
    let mut track = Track::new(1, dt);
    track.push(0, &y, 0);
    let asked = WarmUpTest { band_deg_h: 0.02, final_share: 0.25, start: StartAsked::Declared };
    find(&track.finish().unwrap(), 0, &asked, Start::Declared).unwrap()
}

/// The row of the time, and whether it is bounded from below only.
fn bounded(found: &WarmUpFindings) -> Option<f64> {
    let rows = warm_up_rows(found);
    let time = rows.iter().find(|e| e.id == "warm_up_time").unwrap();
    assert_eq!(time.value.is_none(), found.drifts_on() || found.too_short || time.upper_limit.is_some());
    time.lower_limit.map(|l| l.value)
}

#[test]
fn a_unit_that_drifts_on_is_not_called_warm() {
    // 0.3 and 0.5 deg/h that decay in two and four lengths of the record: 0.17 and 0.38 deg/h are still to go.
    for (amplitude, constant, seed) in [(0.3, 20_000.0, 1), (0.5, 40_000.0, 2), (-0.3, 20_000.0, 3)] {
        let f = found((amplitude, constant), 10_800.0, 0.003, seed);
        assert!(f.drifts_on(), "{amplitude} {constant}: {:?}", f.settled);
        // No time is stated, and no bound goes beyond the record.
        assert!(bounded(&f).is_none_or(|least| least <= 10_800.0), "{:?}", f.settled);
    }
}

#[test]
fn a_unit_that_settles_keeps_its_time() {
    for (amplitude, constant, seed) in [(0.3, 900.0, 4), (-0.5, 600.0, 5)] {
        let f = found((amplitude, constant), 10_800.0, 0.003, seed);
        assert!(!f.drifts_on() && !f.too_short, "{:?}", f.settled);
        let i = f.time.spread.interval(f.time.value, 0.95).unwrap();
        let truth = constant * (f64::abs(amplitude) / 0.02).ln();
        assert!((i.low..=i.high).contains(&truth), "{truth} in {i:?}");
    }
    let rests = found((0.0, 900.0), 10_800.0, 0.003, 6);
    assert!(!rests.drifts_on(), "{:?}", rests.settled);
}

#[test]
#[ignore = "minutes; see the head of main.rs"]
fn units_called_settled_are() {
    for (name, amplitude, constant, length_s) in [
        ("settled", 0.3, 900.0, 10_800.0),
        ("settled, twelve time constants", 0.2, 1500.0, 18_000.0),
        ("four and a half time constants", 0.3, 2400.0, 10_800.0),
        ("just outside: 0.021 deg/h to go", 0.3, 4060.0, 10_800.0),
        ("half a time constant", 0.3, 20_000.0, 10_800.0),
        ("a quarter of a time constant", 0.5, 40_000.0, 10_800.0),
        ("a weak drift: 0.15 deg/h to go", 0.2, 40_000.0, 10_800.0),
    ] {
        let (mut called, mut below, mut bounds) = (0, 0, 0);
        let truth = constant * f64::ln(amplitude / 0.02);
        for seed in first(210_001)..first(210_001) + runs() {
            let f = found((amplitude, constant), length_s, 0.003, seed);
            called += u64::from(!f.drifts_on());
            if let Some(least) = bounded(&f) {
                bounds += 1;
                below += u64::from(least <= truth);
            }
        }
        eprintln!("{name:<34} called settled {called}/{}, lower bounds {below} of {bounds} hold", runs());
    }
}
