//! Predicted power of a test against simulated records, in short. The study is `cargo xtask validate predicted-power`.

use sagnac::estimate::Verdict;
use sagnac_studies::predicted_power::{LIMITS, upper_limits};
use sagnac_studies::record_lengths::SLOW;

/// Records of each unit.
const RECORDS: u64 = 24;

/// The prediction in figures, and the simulated share within what the study allows it and three deviations of so few.
fn agrees(what: &str, predicted: f64, figure: f64, hits: u64) {
    assert!((predicted - figure).abs() < 0.005, "{what}: predicted {predicted}, {figure} before");
    let share = hits as f64 / RECORDS as f64;
    let chance = 3.0 * (predicted * (1.0 - predicted) / RECORDS as f64).sqrt();
    assert!((share - predicted).abs() < 0.1 + chance, "{what}: predicted {predicted}, simulated {share}");
}

#[test]
fn predicted_power_agrees_with_simulation() {
    for (limited, (fails, passes)) in LIMITS.iter().zip([(0.841, 0.752), (0.646, 0.948)]) {
        let (name, power) = (limited.term.id(), limited.predicted().unwrap());
        let over = limited.simulated(1.5, Verdict::Fail, RECORDS, 40_000);
        let under = limited.simulated(0.5, Verdict::Pass, RECORDS, 40_000);
        agrees(&format!("{name} fails"), power.fail_probability_at_1_5, fails, over);
        agrees(&format!("{name} passes"), power.pass_probability_at_half, passes, under);
    }
}

#[test]
fn expected_limit_is_the_median_of_simulated_limits() {
    let (expected, median) = upper_limits(25, 0).unwrap();
    // A limit scatters by a fourth of itself, the median of 25 by a twentieth.
    assert!((median / expected - 1.0).abs() < 0.2, "expected {expected}, median {median}");
}

#[test]
fn stated_lengths_of_records_resolve_b_and_k() {
    // The sizes whose records are short: the study has them all.
    for slow in [SLOW[2], SLOW[5]] {
        let hours = slow.resolved_h().unwrap();
        let resolved = slow.resolved(hours, RECORDS, 700);
        let in_a_quarter = slow.resolved(0.25 * hours, RECORDS, 700);
        // Of 24 records at 0.8, fewer than 13 come by chance in one of a thousand tests.
        assert!(resolved >= 13, "{slow:?}: {resolved} of {RECORDS} in {hours} h");
        assert!(in_a_quarter < resolved, "{slow:?}: {in_a_quarter} in a quarter, {resolved} in the whole");
    }
}
