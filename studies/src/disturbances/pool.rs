//! Shares over all units that a kind of disturbance was tried on, for every measurand and for all together.

use crate::edges::case::Standing;
use crate::edges::tally::Tally;
use crate::study::{Asked, Row};

/// Row of all measurands together.
const EVERY_MEASURAND: &str = "every measurand";

/// Counts over units and their recordings.
#[derive(Debug, Clone, Default, PartialEq)]
struct Counts {
    records: usize,
    given: usize,
    bounded: usize,
    held: usize,
    /// Recordings of units that should rarely pass, and those that passed.
    may_not_pass: usize,
    wrong_passes: usize,
    /// Recordings of units that should rarely fail, and those that failed.
    may_not_fail: usize,
    wrong_failures: usize,
}

impl Counts {
    fn add(&mut self, t: &Tally) {
        self.records += t.records;
        self.given += t.given();
        self.bounded += t.bounded;
        self.held += t.held;
        if matches!(t.standing, Standing::AtLimit | Standing::Bad) {
            self.may_not_pass += t.records;
            self.wrong_passes += t.wrong_passes();
        }
        if matches!(t.standing, Standing::AtLimit | Standing::Good) {
            self.may_not_fail += t.records;
            self.wrong_failures += t.wrong_failures();
        }
    }

    /// Every claim that something was counted for.
    fn rows(&self, of: &str) -> Vec<Row> {
        let holds = if self.bounded == 0 { Asked::Between(0.93, 0.99) } else { Asked::AtLeast(0.93) };
        let rare = Asked::AtMost(0.05);
        let claims = [
            ("a unit at its limit passes", rare, self.wrong_passes, self.may_not_pass),
            ("a unit at its limit fails", rare, self.wrong_failures, self.may_not_fail),
            ("what is stated holds the truth", holds, self.held, self.given),
            ("nothing is stated", Asked::Nothing, self.records - self.given, self.records),
        ];
        let counted = claims.into_iter().filter(|(.., n)| *n > 0);
        counted.map(|(claim, asked, hits, n)| Row::share(of, claim, asked, hits as u64, n as u64)).collect()
    }
}

/// Rows of tallies of one kind of disturbance: of every measurand, and of all.
pub(super) fn rows(tallies: &[Tally]) -> Vec<Row> {
    let mut all = Counts::default();
    let mut each: Vec<(&str, Counts)> = vec![];
    for tally in tallies {
        all.add(tally);
        // A channel, level or zone stands behind the name of its measurand.
        let id = tally.id.split(' ').next().unwrap_or(&tally.id);
        match each.iter_mut().find(|(name, _)| *name == id) {
            Some((_, counts)) => counts.add(tally),
            None => {
                let mut counts = Counts::default();
                counts.add(tally);
                each.push((id, counts));
            }
        }
    }
    let of_each = each.iter().flat_map(|(id, counts)| counts.rows(&format!("`{id}`")));
    all.rows(EVERY_MEASURAND).into_iter().chain(of_each).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tallies_of_one_measurand_are_counted_together() {
        let tally = |id: &str, standing, passed| Tally {
            id: id.into(),
            records: 10,
            stated: 8,
            bounded: 0,
            held: 7,
            standing,
            passed,
            failed: 1,
            width: None,
        };
        let rows = rows(&[
            tally("bias_shift rate@1", Standing::AtLimit, 3),
            tally("bias_shift rate@2", Standing::Good, 9),
            tally("static_bias", Standing::Unlimited, 0),
        ]);
        let measured = |of: &str, claim: &str| {
            let row = rows.iter().find(|r| r.quantity == of && r.claim == claim);
            row.and_then(|r| Some(((r.measured? * r.of as f64).round() as u64, r.of)))
        };
        assert_eq!(measured("`bias_shift`", "a unit at its limit passes"), Some((3, 10)));
        assert_eq!(measured("`bias_shift`", "a unit at its limit fails"), Some((2, 20)));
        assert_eq!(measured(EVERY_MEASURAND, "what is stated holds the truth"), Some((21, 24)));
        assert_eq!(measured("`static_bias`", "a unit at its limit passes"), None);
        assert_eq!(measured("`static_bias`", "nothing is stated"), Some((2, 10)));
    }
}
