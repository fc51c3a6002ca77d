//! Simulated tests evaluated as a run does, without the acceptance around it, and a unit at random.

use crate::bench::chamber::{Recorded, Unit};
use crate::bench::chance::{Chance, Noise};
use sagnac::estimate::Estimate;
use sagnac::measurand::{TURN_ON_TRANSIENT, WARM_UP_TIME, find};
use sagnac::temperature::TemperatureTest;
use sagnac::temperature::findings::{Findings, findings, schedule};
use sagnac::temperature::track::Track;
use sagnac::temperature::warm_up::WarmUpFindings;

/// The rows of a measurand over temperature.
pub fn over_temperature(id: &str, found: &Findings) -> Vec<Estimate> {
    find(id).map_or_else(Vec::new, |m| m.evaluate_temperature("rate", found))
}

/// The rows of a warm-up.
pub fn warm_up_rows(found: &WarmUpFindings) -> Vec<Estimate> {
    [&TURN_ON_TRANSIENT, &WARM_UP_TIME].into_iter().flat_map(|m| m.evaluate_warm_up("rate", found)).collect()
}

fn asked() -> TemperatureTest {
    TemperatureTest {
        channel: "temp".into(),
        command: None,
        low_deg_c: -40.0,
        high_deg_c: 60.0,
        end_tolerance_deg_c: 2.0,
        overshoot_deg_c: Some(3.0),
        ramp_rate_deg_c_h: None,
        ramp_rate_tolerance: 0.1,
        slowest_deg_c_h: 4.0,
        fastest_deg_c_h: 62.0,
        dwell_s: None,
        dwell_drift_deg_c_h: 1.0,
        ramps_each_way: 1,
        sensor_uncertainty_deg_c: 0.05,
        coverage_factor: 2.0,
        zones_deg_c: vec![-40.0, -15.0, 10.0, 35.0, 60.0],
        residual_average_s: 100.0,
        highest_order: 6,
        segments: vec![],
    }
}

/// What a test between −40 and +60 °C finds in a recording.
pub fn found(r: &Recorded) -> Findings {
    let mut track = Track::new(2, r.dt);
    track.push(0, &r.rate, 0);
    track.push(1, &r.temperature, 0);
    let means = track.finish().expect("blocks");
    let test = asked();
    let s = schedule(&means, 1, None, &test);
    findings(&means, 0, 1, s, &test)
}

/// A unit at random: a navigation-grade coil, every effect plainly there.
pub fn unit(chance: &mut Chance) -> Unit {
    let sign = |c: &mut Chance| if c.uniform() < 0.5 { -1.0 } else { 1.0 };
    Unit {
        a: [
            sign(chance) * chance.between(2e-4, 2e-3),
            sign(chance) * chance.between(2e-6, 2e-5),
            sign(chance) * chance.between(0.0, 1.5e-7),
        ],
        shupe: sign(chance) * chance.between(0.01, 0.08),
        lag_s: chance.between(300.0, 1500.0),
        hysteresis: (sign(chance) * chance.between(0.003, 0.012), chance.between(1.0, 5.0)),
        noise: Noise {
            n: chance.between(0.001, 0.003),
            b: chance.between(0.0, 0.003),
            k: chance.between(0.0, 0.002),
        },
        level: 12.4,
    }
}
