//! Monte Carlo of whole runs against simulated truth: coverage of intervals, verdicts of units exactly at their limit.
//!
//! Every record goes through `run::execute`, as a file would. The short studies run with every test; the long ones by
//! `cargo test --release --test coverage -- --ignored --nocapture` (`RECORDS` sets their size).

mod coverage_support;

use coverage_support::{Mix, Tally, line_study, records, study};
use sagnac::noise::model::NoiseModel;

fn model(n: f64, b: f64, k: f64) -> NoiseModel {
    NoiseModel { n, b, k, ..Default::default() }
}

fn mixes() -> [Mix; 4] {
    [
        Mix { name: "N", model: model(0.0023, 0.0, 0.0) },
        Mix { name: "N+B", model: model(0.002, 0.006, 0.0) },
        Mix { name: "N+K", model: model(0.0023, 0.0, 0.006) },
        Mix { name: "N+B+K", model: model(0.002, 0.004, 0.006) },
    ]
}

/// Asserts a share of at least `least`, less three standard deviations of a count of this size.
fn at_least(what: &str, hits: usize, of: usize, least: f64) {
    let slack = 3.0 * (least * (1.0 - least) / of as f64).sqrt();
    let share = hits as f64 / of as f64;
    assert!(share >= least - slack, "{what}: {share:.3} of {of}, {least} expected");
}

fn at_most(what: &str, hits: usize, of: usize, most: f64) {
    at_least(what, of - hits, of, 1.0 - most);
}

fn assert_honest(tally: &Tally, coverage: f64, false_pass: f64) {
    at_most(&format!("{} false lines", tally.name), tally.false_lines, tally.rows[0].records, 0.015);
    for row in &tally.rows {
        let what = format!("{} {} h {}", tally.name, tally.hours, row.id);
        at_least(&what, row.holds(), row.records, coverage);
        at_most(&format!("{what}, passed at the limit"), row.passed, row.records, false_pass);
        at_most(&format!("{what}, failed at the limit"), row.failed, row.records, false_pass);
    }
}

#[test]
fn intervals_hold_and_units_at_their_limit_rarely_pass() {
    for (i, mix) in mixes().into_iter().enumerate() {
        let tally = study(&mix, 10.0, 10.0, 40, 7_100_000 + 10_000 * i as u64);
        assert_honest(&tally, 0.92, 0.08);
    }
}

#[test]
fn intervals_hold_over_a_hundred_hours() {
    let tally = study(&mixes()[1], 100.0, 10.0, 24, 7_200_000);
    assert_honest(&tally, 0.92, 0.08);
}

#[test]
fn frequency_and_amplitude_of_a_line_hold() {
    for (i, excess) in [20.0, 300.0].into_iter().enumerate() {
        let tally = line_study(excess, 36_000, 100, 7_300_000 + 10_000 * i as u64);
        assert!(tally.found >= 99, "{} of 100 lines of excess {excess} found", tally.found);
        at_least("frequency", tally.frequency_holds, tally.found, 0.93);
        at_least("amplitude", tally.amplitude_holds, tally.found, 0.93);
        // Not by being wide: errors are of the size of the uncertainties.
        assert!(tally.frequency_rms > 0.6 && tally.amplitude_rms > 0.6, "{tally:?}");
    }
}

#[test]
#[ignore = "long study: minutes"]
fn long_study_of_intervals_and_verdicts() {
    let records = records(1000);
    for hours in [10.0, 100.0] {
        for (i, mix) in mixes().into_iter().enumerate() {
            let seed = 7_500_000 + 100_000 * i as u64 + 1_000_000 * hours as u64;
            let tally = study(&mix, hours, 10.0, records, seed);
            tally.print();
            assert_honest(&tally, 0.92, 0.08);
        }
    }
}

#[test]
#[ignore = "long study: a minute"]
fn long_study_of_lines() {
    let records = records(1000);
    for (j, samples) in [9_000, 36_000, 360_000].into_iter().enumerate() {
        for (i, excess) in [5.0, 10.0, 30.0, 100.0, 1000.0].into_iter().enumerate() {
            let seed = 8_000_000 + 100_000 * i as u64 + 1_000_000 * j as u64;
            let tally = line_study(excess, samples, records.min(36_000_000 / samples as u64 * 4), seed);
            println!("{samples:>7} samples, peak {excess:>6} of the floor: {tally}");
            at_least("frequency", tally.frequency_holds, tally.found, 0.92);
        }
    }
}
