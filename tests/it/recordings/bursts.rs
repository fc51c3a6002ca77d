//! Host stamps in bursts: a uniform clock whose samples a logger writes batch by batch. Rate, missing samples and N are
//! those of the samples, or the recording is refused.

use crate::support::synthetic::white;
use crate::support::{measurand, result, sagnac};
use rand::{RngExt as _, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;
use tempfile::tempdir;

const HZ: f64 = 99.3;
/// Angle random walk of the samples, deg/sqrt h.
const N: f64 = 0.2;

/// What a logger does.
#[derive(Clone, Copy)]
struct Logger {
    rows: u64,
    /// Least and most samples of a batch; where both are 0 the host asks at a fixed period.
    batch: (u64, u64),
    /// Period at which the host asks, s.
    poll_s: f64,
    /// Step of the stamps within a batch and its scatter, s.
    step_s: f64,
    scatter_s: f64,
    /// Largest delay of a batch, s.
    delay_s: f64,
    /// Rounding of the stamps, s; 0: microseconds.
    round_s: f64,
    /// Share of single samples and of whole batches that are lost.
    lost: f64,
    lost_batches: f64,
    /// Samples that are lost in a row: where and how many.
    gap: (u64, u64),
    /// Change of the rate over the record.
    drift: f64,
    start_s: f64,
}

const PLAIN: Logger = Logger {
    rows: 30_000,
    batch: (10, 10),
    poll_s: 0.0,
    step_s: 1.6e-3,
    scatter_s: 2e-4,
    delay_s: 1e-3,
    round_s: 0.0,
    lost: 0.0,
    lost_batches: 0.0,
    gap: (0, 0),
    drift: 0.0,
    start_s: 0.0,
};

/// The text of the recording and the samples that are missing between its first and last row.
fn logged(l: &Logger, seed: u64) -> (String, u64) {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let tau = 1.0 / HZ;
    let time = |i: u64| i as f64 * tau * (1.0 + l.drift * i as f64 / l.rows as f64);
    let mut text = "time_s,rate_deg_h\n".to_owned();
    let (mut next, mut free, mut kept, mut first, mut last) = (0, 0.0f64, 0, None, 0);
    while next < l.rows {
        let (end, ready) = if l.poll_s > 0.0 {
            let edge = ((time(next) / l.poll_s).floor() + 1.0) * l.poll_s;
            let mut end = next;
            while end < l.rows && time(end) < edge {
                end += 1;
            }
            (end, edge)
        } else {
            let end = (next + rng.random_range(l.batch.0..=l.batch.1)).min(l.rows);
            (end, time(end - 1))
        };
        let mut stamp = (ready + l.delay_s * rng.random::<f64>()).max(free);
        let whole = rng.random_bool(l.lost_batches);
        for i in next..end {
            let gone = whole || rng.random_bool(l.lost) || (l.gap.0..l.gap.0 + l.gap.1).contains(&i);
            if !gone || i == 0 {
                let shown = if l.round_s > 0.0 { (stamp / l.round_s).round() * l.round_s } else { stamp };
                let rate = white(seed, i) * N * 60.0 * HZ.sqrt();
                text.push_str(&format!("{:.6},{rate:.4}\n", l.start_s + shown));
                (kept, last) = (kept + 1, i);
                first.get_or_insert(i);
            }
            stamp += l.step_s + l.scatter_s * (2.0 * rng.random::<f64>() - 1.0);
        }
        free = stamp;
        next = end;
    }
    (text, last - first.unwrap() + 1 - kept)
}

/// What is wrong with what the program says of a logger; `None` where nothing is. `must` be read, or may be refused.
fn judged(dir: &Path, name: &str, logger: &Logger, must: bool) -> Option<String> {
    let (text, missing) = logged(logger, 7);
    std::fs::write(dir.join("r.csv"), text).unwrap();
    let _ = std::fs::remove_dir_all(dir.join("a"));
    let said = sagnac(dir, &["analyze", "r.csv", "--out", "a"]);
    if said.code != 0 {
        let refused = said.code == 2 && format!("{said:?}").contains("those of delivery");
        return (must || !refused).then(|| format!("{name}: {said:?}"));
    }
    let r = result(&dir.join("a"));
    let hz = 1.0 / r["recording"][0]["sample_interval_s"].as_f64().unwrap();
    let found = r["integrity"]["missing_samples"].as_u64().unwrap();
    let n = measurand(&r, "angle_random_walk")["value"].as_f64().unwrap();
    let told = r["conditions"].as_array().unwrap().iter().any(|c| {
        let note = c["note"].as_str().unwrap();
        c["id"] == "time_base" && (note.contains("come in batches") || note.contains("in packets"))
    });
    let mean_hz = HZ / (1.0 + logger.drift);
    let right = (hz / mean_hz - 1.0).abs() < 1e-4
        && found.abs_diff(missing) <= 1 + missing / 200
        && (n / N - 1.0).abs() < 0.03
        && told;
    (!right).then(|| format!("{name}: {hz} Hz, {found} of {missing} missing, N {n}, told {told}"))
}

#[test]
fn batches_give_the_rate_the_losses_and_the_noise_of_the_samples() {
    let dir = tempdir().unwrap();
    let poll = Logger { batch: (0, 0), step_s: 1e-4, scatter_s: 2e-5, ..PLAIN };
    let cases = [
        ("ten by ten", PLAIN),
        ("six by six", Logger { batch: (6, 6), ..PLAIN }),
        ("two by two", Logger { batch: (2, 2), ..PLAIN }),
        ("one or two", Logger { batch: (1, 2), step_s: 2e-4, scatter_s: 5e-5, ..PLAIN }),
        ("one or two, one stamp", Logger { batch: (1, 2), step_s: 0.0, scatter_s: 0.0, ..PLAIN }),
        ("one to three", Logger { batch: (1, 3), step_s: 2e-4, scatter_s: 5e-5, ..PLAIN }),
        ("500 by 500", Logger { batch: (500, 500), step_s: 1e-4, scatter_s: 1e-5, ..PLAIN }),
        ("one stamp", Logger { step_s: 0.0, scatter_s: 0.0, ..PLAIN }),
        ("one stamp, any size", Logger { batch: (1, 20), step_s: 0.0, scatter_s: 0.0, ..PLAIN }),
        ("any size", Logger { batch: (5, 15), step_s: 5e-5, scatter_s: 1e-5, ..PLAIN }),
        ("slow transfer", Logger { step_s: 5e-3, scatter_s: 5e-4, ..PLAIN }),
        ("milliseconds", Logger { round_s: 1e-3, ..PLAIN }),
        ("late by half an interval", Logger { delay_s: 5e-3, ..PLAIN }),
        ("from 1970", Logger { start_s: 1.7e9, ..PLAIN }),
        ("drift of 100 ppm", Logger { drift: 1e-4, ..PLAIN }),
        ("a long gap", Logger { gap: (20_000, 5_000), ..PLAIN }),
        ("a gap of 33", Logger { gap: (9_000, 33), ..PLAIN }),
        ("lost batches", Logger { lost_batches: 0.02, ..PLAIN }),
        ("lost samples", Logger { lost: 0.001, ..PLAIN }),
        ("asked at 64 ms", Logger { poll_s: 0.064, ..poll }),
        ("asked at 100 ms", Logger { poll_s: 0.1, round_s: 1e-3, ..poll }),
        ("asked at 64 ms, lost samples", Logger { poll_s: 0.064, lost: 0.0005, ..poll }),
    ];
    let wrong: Vec<String> = cases.iter().filter_map(|(name, l)| judged(dir.path(), name, l, true)).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn batches_that_tell_no_clock_are_refused_or_right() {
    let dir = tempdir().unwrap();
    let cases = [
        ("any size, slow transfer", Logger { batch: (1, 20), ..PLAIN }),
        ("any size, lost batches", Logger { batch: (1, 20), lost_batches: 0.1, ..PLAIN }),
        ("any size, lost samples", Logger { batch: (1, 20), lost: 0.01, ..PLAIN }),
        ("late by four intervals", Logger { delay_s: 40e-3, ..PLAIN }),
        ("a third lost", Logger { lost: 0.3, ..PLAIN }),
        ("one in twenty lost", Logger { lost: 0.05, ..PLAIN }),
        ("milliseconds, any size", Logger { batch: (1, 20), round_s: 1e-3, ..PLAIN }),
        ("asked at 33 ms", Logger { batch: (0, 0), poll_s: 0.033, delay_s: 5e-3, ..PLAIN }),
        ("asked, slow transfer, lost", Logger { batch: (0, 0), poll_s: 0.064, lost: 0.02, ..PLAIN }),
    ];
    let wrong: Vec<String> =
        cases.iter().filter_map(|(name, l)| judged(dir.path(), name, l, false)).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn rows_that_are_now_and_then_delivered_together_lose_nothing() {
    // One delivery in thirty holds two rows: the first of them was there an interval before.
    let dir = tempdir().unwrap();
    let mut wrong = Vec::new();
    for (name, apart_s, digits) in [("one stamp", 0.0, 6), ("two stamps", 2e-4, 6), ("milliseconds", 2e-4, 3)]
    {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(11);
        let mut text = String::from("time_s,rate_deg_h\n");
        let mut i = 0u64;
        while i < 60_000 {
            let together: u64 = if rng.random_bool(1.0 / 30.0) { 2 } else { 1 };
            let stamp = (i + together - 1) as f64 / HZ + 1e-3 * rng.random::<f64>();
            for j in 0..together {
                let rate = white(7, i + j) * N * 60.0 * HZ.sqrt();
                text.push_str(&format!("{:.digits$},{rate:.4}\n", stamp + j as f64 * apart_s));
            }
            i += together;
        }
        std::fs::write(dir.path().join("r.csv"), text).unwrap();
        let _ = std::fs::remove_dir_all(dir.path().join("a"));
        let said = sagnac(dir.path(), &["analyze", "r.csv", "--out", "a"]);
        assert_eq!(said.code, 0, "{name}: {said:?}");
        let r = result(&dir.path().join("a"));
        let hz = 1.0 / r["recording"][0]["sample_interval_s"].as_f64().unwrap();
        let missing = r["integrity"]["missing_samples"].as_u64().unwrap();
        let n = measurand(&r, "angle_random_walk")["value"].as_f64().unwrap();
        if (hz / HZ - 1.0).abs() > 1e-4 || missing > 6 || (n / N - 1.0).abs() > 0.03 {
            wrong.push(format!("{name}: {hz} Hz, {missing} missing, N {n}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn rows_written_twice_and_gaps_of_an_even_clock_stay_what_they_are() {
    let dir = tempdir().unwrap();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(12);
    let (mut text, mut twice, mut missing) = (String::from("time_s,rate_deg_h\n"), 0u64, 0u64);
    let mut i = 0u64;
    while i < 40_000 {
        if i > 0 && rng.random_bool(0.0005) {
            let gap: u64 = rng.random_range(1..40);
            (i, missing) = (i + gap, missing + gap);
        }
        let stamp = i as f64 / HZ + 5e-4 * (2.0 * rng.random::<f64>() - 1.0);
        let row = format!("{stamp:.6},{:.4}\n", white(9, i) * N * 60.0 * HZ.sqrt());
        text.push_str(&row);
        if rng.random_bool(0.01) {
            text.push_str(&row);
            twice += 1;
        }
        i += 1;
    }
    std::fs::write(dir.path().join("r.csv"), text).unwrap();
    let said = sagnac(dir.path(), &["analyze", "r.csv", "--out", "a"]);
    assert_eq!(said.code, 0, "{said:?}");
    let r = result(&dir.path().join("a"));
    let count = |id: &str| r["integrity"][id].as_u64().unwrap();
    let (lost, doubled) = (count("missing_samples"), count("duplicate_timestamps"));
    assert!(lost.abs_diff(missing) <= 2, "{lost} of {missing}");
    assert!(doubled.abs_diff(twice) <= 2, "{doubled} of {twice}");
}
