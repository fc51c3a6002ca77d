//! Warm-ups: their time and transient, and units that drift on when the record ends.

use super::evaluation::warm_up_rows;
use crate::bench::chamber::warm_up as switched_on;
use crate::bench::chance::{Chance, Noise};
use crate::coverage::{Coverage, over_seeds};
use crate::study::{Asked, Case, Row, Study};
use rayon::prelude::*;
use sagnac::temperature::start::Start;
use sagnac::temperature::track::Track;
use sagnac::temperature::warm_up::{WarmUpFindings, find};
use sagnac::temperature::{StartAsked, WarmUpTest};

/// Time and transient of warm-ups, and whether units that drift on are called settled.
pub static STUDY: Study = Study {
    id: "warm-up-intervals",
    title: "Warm-ups: time, transient and settling",
    method: "Two decays of random size and time in 8 h of white noise and flicker, with a band of 0.02 °/h. Single decays in records \
             of 3 and 5 h, of units that have settled within the band at the end and of such that have not: those must not be \
             called settled, and no lower bound of the time may lie above the truth.",
    records: 200,
    cases,
};

/// A simulated warm-up and what is found in it.
pub struct WarmUp {
    /// True warm-up time, s.
    pub time_s: f64,
    /// True transient, deg/h.
    pub transient_deg_h: f64,
    /// What is found.
    pub found: WarmUpFindings,
}

/// A unit at random that warms up in two decays.
pub fn warm_up_of(seed: u64) -> Option<WarmUp> {
    let mut chance = Chance::new(seed);
    let decays = [
        (chance.between(0.1, 0.5), chance.between(120.0, 600.0)),
        (chance.between(-0.2, 0.2), chance.between(900.0, 2500.0)),
    ];
    let model = Noise { n: chance.between(0.0005, 0.002), b: chance.between(0.0, 0.002), k: 0.0 };
    let (dt, count) = (5.0, 5760);
    let y = switched_on(&decays, 12.5, model, dt, count, seed);
    let mut track = Track::new(1, dt);
    track.push(0, &y, 0);
    let asked = WarmUpTest { band_deg_h: 0.02, final_share: 0.25, start: StartAsked::Declared };
    let f = find(&track.finish()?, 0, &asked, Start::Declared)?;
    let at = |t: f64| decays.iter().map(|(a, c)| a * (-t / c).exp()).sum::<f64>();
    let length = dt * count as f64;
    let end: f64 =
        (0..1000).map(|i| at(length * (0.75 + 0.25 * (i as f64 + 0.5) / 1000.0))).sum::<f64>() / 1000.0;
    let truth = (0..length as usize).rev().find(|t| (at(*t as f64) - end).abs() > 0.02).unwrap_or(0) as f64;
    Some(WarmUp { time_s: truth, transient_deg_h: at(0.0) - end, found: f })
}

/// What is found in a record of one decay (amplitude in deg/h, time constant in s) of a length in s, with N in deg/√h and a
/// band of 0.02 deg/h.
pub fn one_decay(decay: (f64, f64), length_s: f64, n: f64, seed: u64) -> WarmUpFindings {
    let dt = 5.0;
    let noise = Noise { n, b: 0.001, k: 0.0 };
    let y = switched_on(&[decay], 12.5, noise, dt, (length_s / dt) as usize, seed);
    let mut track = Track::new(1, dt);
    track.push(0, &y, 0);
    let asked = WarmUpTest { band_deg_h: 0.02, final_share: 0.25, start: StartAsked::Declared };
    find(&track.finish().expect("blocks"), 0, &asked, Start::Declared).expect("a course")
}

/// Lower bound of the warm-up time, s, where there is one.
pub fn bounded(found: &WarmUpFindings) -> Option<f64> {
    let rows = warm_up_rows(found);
    let time = rows.iter().find(|e| e.id == "warm_up_time").expect("a row");
    assert_eq!(time.value.is_none(), found.drifts_on() || found.too_short || time.upper_limit.is_some());
    time.lower_limit.map(|l| l.value)
}

/// A single decay: its name, its size in deg/h and time constant in s, and the length of the record in s.
const DECAYS: [(&str, f64, f64, f64); 7] = [
    ("settled", 0.3, 900.0, 10_800.0),
    ("settled, twelve time constants", 0.2, 1500.0, 18_000.0),
    ("four and a half time constants", 0.3, 2400.0, 10_800.0),
    ("just outside: 0.021 °/h to go", 0.3, 4060.0, 10_800.0),
    ("half a time constant", 0.3, 20_000.0, 10_800.0),
    ("a quarter of a time constant", 0.5, 40_000.0, 10_800.0),
    ("a weak drift: 0.15 °/h to go", 0.2, 40_000.0, 10_800.0),
];

fn cases() -> Vec<Case> {
    let first = |base: u64, seed: u64| base + 100_000_000 * (seed - 1);
    let mut cases =
        vec![Case::new("two decays", move |records, seed| two_decays(records, first(200_001, seed)))];
    for (name, amplitude, constant, length_s) in DECAYS {
        cases.push(Case::new(name, move |records, seed| {
            settling((amplitude, constant), length_s, records, first(210_001, seed))
        }));
    }
    cases
}

fn two_decays(records: u64, first: u64) -> Vec<Row> {
    let [time, transient] = over_seeds(first, records, |seed| {
        let Some(warm_up) = warm_up_of(seed) else { return Default::default() };
        let rows = warm_up_rows(&warm_up.found);
        let truths = [("warm_up_time", warm_up.time_s), ("turn_on_transient", warm_up.transient_deg_h)];
        truths.map(|(id, truth)| Coverage::of(rows.iter().find(|e| e.id == id), truth, None))
    });
    [time.rows("warm_up_time", Asked::Nothing), transient.rows("turn_on_transient", Asked::Nothing)].concat()
}

fn settling(decay: (f64, f64), length_s: f64, records: u64, first: u64) -> Vec<Row> {
    let (amplitude, constant) = decay;
    let truth = constant * f64::ln(amplitude / 0.02);
    // The rest of the decay is less than the band at the end of the record: settling is the truth.
    let settles = amplitude * (-length_s / constant).exp() < 0.02;
    let found: Vec<_> = (first..first + records)
        .into_par_iter()
        .map(|seed| {
            let found = one_decay(decay, length_s, 0.003, seed);
            (!found.drifts_on(), bounded(&found))
        })
        .collect();
    let called = found.iter().filter(|f| f.0).count() as u64;
    let bounds: Vec<f64> = found.iter().filter_map(|f| f.1).collect();
    let below = bounds.iter().filter(|least| **least <= truth).count() as u64;
    let asked = if settles { Asked::Nothing } else { Asked::AtMost(0.05) };
    let mut rows = vec![Row::share("warm_up_time", "the unit is called settled", asked, called, records)];
    if !bounds.is_empty() {
        let claim = "the lower bound lies below the truth";
        rows.push(Row::share("warm_up_time", claim, Asked::AtLeast(0.93), below, bounds.len() as u64));
    }
    rows
}
