//! Monte Carlo of whole runs against simulated truth, in short: coverage of intervals, verdicts of units exactly at their
//! limit. The studies are `cargo xtask validate whole-runs lines`.

use sagnac_studies::whole_runs::{Tally, line_study, mixes, study};

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
    at_most(&format!("{} false lines", tally.name), tally.false_lines, tally.counts[0].records, 0.015);
    for row in &tally.counts {
        let what = format!("{} {} h {}", tally.name, tally.hours, row.id);
        at_least(&what, row.holds(), row.records, coverage);
        at_most(&format!("{what}, passed at the limit"), row.passed, row.records, false_pass);
        at_most(&format!("{what}, failed at the limit"), row.failed, row.records, false_pass);
    }
}

#[test]
fn intervals_hold_and_units_at_their_limit_rarely_pass() {
    if !crate::support::long::wanted("intervals_hold_and_units_at_their_limit_rarely_pass") {
        return;
    }
    for (i, mix) in mixes().into_iter().enumerate() {
        let tally = study(&mix, 10.0, 10.0, 40, 7_100_000 + 10_000 * i as u64);
        assert_honest(&tally, 0.92, 0.08);
    }
}

#[test]
fn intervals_hold_over_a_hundred_hours() {
    if !crate::support::long::wanted("intervals_hold_over_a_hundred_hours") {
        return;
    }
    let tally = study(&mixes()[1], 100.0, 10.0, 24, 7_200_000);
    assert_honest(&tally, 0.92, 0.08);
}

#[test]
fn frequency_and_amplitude_of_a_line_hold() {
    if !crate::support::long::wanted("frequency_and_amplitude_of_a_line_hold") {
        return;
    }
    for (i, excess) in [20.0, 300.0].into_iter().enumerate() {
        let tally = line_study(excess, 36_000, 100, 7_300_000 + 10_000 * i as u64);
        assert!(tally.found >= 99, "{} of 100 lines of excess {excess} found", tally.found);
        at_least("frequency", tally.frequency_holds, tally.found, 0.93);
        at_least("amplitude", tally.amplitude_holds, tally.found, 0.93);
        // Not by being wide: errors are of the size of the uncertainties.
        assert!(tally.frequency_rms > 0.6 && tally.amplitude_rms > 0.6, "{tally:?}");
    }
}
