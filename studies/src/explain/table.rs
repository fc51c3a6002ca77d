//! Counts of scores.

use super::score::Score;

/// One case that was explained and scored.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// Name of the case.
    pub name: String,
    /// What its report was worth.
    pub score: Score,
    /// Widths of stated intervals over those of a fit that knows the truth.
    pub width_ratios: Vec<f64>,
    /// Removed variance over that of a fit that knows the truth.
    pub removed_ratio: Option<f64>,
    /// Closed loop: the recording, a fresh one, one of another case, and one without the effect against the augmented claim.
    pub closes: Option<[bool; 4]>,
    /// Exit code that the program gave.
    pub exit: Option<i32>,
}

/// Counts over rows.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Cases.
    pub cases: usize,
    /// Called a mismatch.
    pub detected: usize,
    /// The right name comes first.
    pub first: usize,
    /// The right name or an equivalent.
    pub class: usize,
    /// All effects left out are named.
    pub all_named: usize,
    /// More are named than were left out.
    pub surplus: usize,
    /// Found in the right place.
    pub located: usize,
    /// Intervals that hold the truth.
    pub inside: usize,
    /// Intervals that have a truth.
    pub intervals: usize,
    /// Called unknown.
    pub unknown: usize,
    /// Figures agree with the verdict.
    pub sane: usize,
    /// Held-out log-likelihood gains.
    pub held_out: usize,
    /// Steps of the closed loop that give what they should.
    pub loops: [usize; 4],
    /// Cases whose loop was closed.
    pub looped: usize,
    /// Median width over that of a fit that knows the truth.
    pub width_ratio: Option<f64>,
    /// Median share of the variance that the correction removes.
    pub removed: Option<f64>,
    /// Median of that over the same of a fit that knows the truth.
    pub removed_ratio: Option<f64>,
}

/// The middle value.
pub fn median(mut x: Vec<f64>) -> Option<f64> {
    x.retain(|v| v.is_finite());
    x.sort_by(f64::total_cmp);
    let n = x.len();
    (n > 0).then(|| 0.5 * (x[(n - 1) / 2] + x[n / 2]))
}

impl Tally {
    /// Counts over rows.
    pub fn of<'a>(rows: impl Iterator<Item = &'a Row> + Clone) -> Tally {
        let count = |f: &dyn Fn(&Row) -> bool| rows.clone().filter(|r| f(r)).count();
        let covered = || rows.clone().flat_map(|r| &r.score.covered);
        Tally {
            cases: rows.clone().count(),
            detected: count(&|r| r.score.detected),
            first: count(&|r| r.score.first),
            class: count(&|r| r.score.class),
            all_named: count(&|r| r.score.all_named),
            surplus: count(&|r| r.score.surplus > 0),
            located: count(&|r| r.score.located),
            inside: covered().filter(|c| c.inside).count(),
            intervals: covered().count(),
            unknown: count(&|r| r.score.verdict == "unknown-mismatch"),
            sane: count(&|r| r.score.sane),
            held_out: count(&|r| r.score.held_out_gain > 0.0),
            loops: std::array::from_fn(|i| count(&|r| r.closes.is_some_and(|c| c[i]))),
            looped: count(&|r| r.closes.is_some()),
            width_ratio: median(rows.clone().flat_map(|r| r.width_ratios.clone()).collect()),
            removed: median(rows.clone().filter_map(|r| r.score.removed).collect()),
            removed_ratio: median(rows.clone().filter_map(|r| r.removed_ratio).collect()),
        }
    }
}
