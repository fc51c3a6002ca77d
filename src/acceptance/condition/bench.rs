//! The bench of the test: released by a check that passed, or being checked.

use super::facts::{Condition, Facts, record};
use crate::record::{ConditionRecord, Evidence};

pub(super) struct ReleasedBench;

impl Condition for ReleasedBench {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let Some(on_bench) = &facts.on_bench else { return vec![] };
        let demanded = on_bench.bench.released_within_s.map(|_| {
            let release = on_bench.release(facts.bench_checks);
            let evidence = if release.is_dated { Evidence::Recorded } else { Evidence::Declared };
            let age = release.age_s.map(|s| ("age_h", s / 3600.0));
            let observed: Vec<(&str, f64)> = age.into_iter().collect();
            let judged = record("bench", release.status, &observed, Some(on_bench.required()), release.note);
            ConditionRecord { evidence: Some(evidence), ..judged }
        });
        let checked = on_bench.bench.releases_for_s.map(|for_s| {
            let (status, note) = on_bench.releases(for_s);
            record("bench", status, &[], None, note)
        });
        demanded.into_iter().chain(checked).collect()
    }
}
