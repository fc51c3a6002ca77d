//! Carries a case out: draws, tests, and sets what is stated against the truths.

use super::case::{Case, Simulated, Standing, Truth};
use crate::study::{Asked, Row};
use rayon::prelude::*;
use sagnac::estimate::Verdict;
use sagnac::record::MeasurandRecord;
use std::path::Path;

/// Tests a simulated unit, whose files lie in a folder: the rows of the result.
pub type Tester = dyn Fn(&Simulated, &Path) -> Result<Vec<MeasurandRecord>, String> + Sync;

/// What the program stated of one truth.
#[derive(Debug, Clone)]
enum Stated {
    /// A value with its interval.
    Interval { low: f64, high: f64 },
    /// Bounds without a value; an absent one is infinite.
    Bound { low: f64, high: f64 },
    /// Nothing.
    Withheld,
}

/// One truth set against what was stated.
struct Outcome {
    truth: Truth,
    stated: Stated,
    verdict: Option<Verdict>,
}

/// One measurand of one case over all its recordings.
#[derive(Debug, Clone)]
pub struct Tally {
    /// Measurand, and its channel where there are several.
    pub id: String,
    /// Recordings.
    pub records: usize,
    /// Recordings with a value and its interval.
    pub stated: usize,
    /// Recordings with a bound alone.
    pub bounded: usize,
    /// Intervals and bounds that hold the truth.
    pub held: usize,
    /// Where the units stand against their limit.
    pub standing: Standing,
    /// Recordings whose row passed.
    pub passed: usize,
    /// Recordings whose row failed.
    pub failed: usize,
    /// Median of the half width over that of the oracle, where there is one.
    pub width: Option<f64>,
}

/// Draws `records` recordings from `first_seed` on, tests each and sets the results against the truths.
pub fn run(case: &Case, records: usize, first_seed: u64, test: &Tester) -> Vec<Tally> {
    let outcomes: Vec<Vec<Outcome>> =
        (0..records as u64).into_par_iter().map(|i| outcome(case, first_seed + i, test)).collect();
    let mut names: Vec<String> = Vec::new();
    for name in outcomes.iter().flatten().map(|o| o.truth.name()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    for id in &case.ids {
        let told = outcomes.iter().flatten().any(|o| o.truth.id == *id);
        assert!(told, "{}: no truth of `{id}`", case.name);
    }
    let of = |name: &String| {
        outcomes.iter().flatten().filter(|o| o.truth.name() == *name).collect::<Vec<&Outcome>>()
    };
    names.iter().map(|name| Tally::new(&of(name))).collect()
}

fn outcome(case: &Case, seed: u64, test: &Tester) -> Vec<Outcome> {
    let simulated = (case.draw)(seed);
    let folder = tempfile::tempdir().expect("a temporary folder");
    simulated.write(folder.path()).expect("files of a temporary folder");
    let rows = match test(&simulated, folder.path()) {
        Ok(rows) => rows,
        Err(_) if case.may_be_refused => vec![],
        Err(e) => panic!("{}, seed {seed}: {e}", case.name),
    };
    assert!(case.may_be_refused || !rows.is_empty(), "{}, seed {seed}: no rows", case.name);
    let found = |t: &Truth| {
        rows.iter().find(|r| r.id == t.id && t.channel.as_ref().is_none_or(|channel| r.channel == *channel))
    };
    simulated
        .truths
        .into_iter()
        .map(|truth| {
            let row = found(&truth);
            let stated = row.map_or(Stated::Withheld, stated);
            Outcome { stated, verdict: row.map(|r| r.verdict), truth }
        })
        .collect()
}

/// What a row of a result states. A row that a check contradicts shows its numbers as contradicted, and states none of them.
fn stated(row: &MeasurandRecord) -> Stated {
    if !row.objections.is_empty() {
        return Stated::Withheld;
    }
    let finite = |v: f64| Some(v).filter(|v| v.is_finite());
    let interval = row.interval.and_then(|i| Some((finite(i.low)?, finite(i.high)?)));
    let low = row.lower_limit.and_then(|l| finite(l.value));
    let high = row.upper_limit.and_then(|l| finite(l.value));
    match (interval, low, high) {
        (Some((low, high)), ..) => Stated::Interval { low, high },
        (None, None, None) => Stated::Withheld,
        (None, low, high) => {
            Stated::Bound { low: low.unwrap_or(f64::NEG_INFINITY), high: high.unwrap_or(f64::INFINITY) }
        }
    }
}

impl Tally {
    fn new(outcomes: &[&Outcome]) -> Tally {
        let first = &outcomes[0].truth;
        let count = |test: &dyn Fn(&Outcome) -> bool| outcomes.iter().filter(|o| test(o)).count();
        let held = |o: &Outcome| match o.stated {
            Stated::Interval { low, high } | Stated::Bound { low, high } => {
                (o.truth.at_least || low <= o.truth.value) && o.truth.value <= high
            }
            Stated::Withheld => false,
        };
        let mut ratios: Vec<f64> = outcomes
            .iter()
            .filter_map(|o| match (&o.stated, o.truth.oracle) {
                (Stated::Interval { low, high }, Some(oracle)) => Some(0.5 * (high - low) / oracle),
                _ => None,
            })
            .collect();
        ratios.sort_by(f64::total_cmp);
        Tally {
            id: first.name(),
            records: outcomes.len(),
            stated: count(&|o| matches!(o.stated, Stated::Interval { .. })),
            bounded: count(&|o| matches!(o.stated, Stated::Bound { .. })),
            held: count(&held),
            standing: outcomes.iter().map(|o| o.truth.standing()).max().unwrap_or(Standing::Unlimited),
            passed: count(&|o| o.verdict == Some(Verdict::Pass)),
            failed: count(&|o| o.verdict == Some(Verdict::Fail)),
            width: (!ratios.is_empty()).then(|| ratios[ratios.len() / 2]),
        }
    }

    /// Intervals and bounds that were given.
    pub fn given(&self) -> usize {
        self.stated + self.bounded
    }

    /// Share of the given intervals and bounds that hold the truth.
    pub fn coverage(&self) -> f64 {
        self.held as f64 / self.given().max(1) as f64
    }

    /// Passes of units that should rarely pass.
    pub fn wrong_passes(&self) -> usize {
        if matches!(self.standing, Standing::AtLimit | Standing::Bad) { self.passed } else { 0 }
    }

    /// Failures of units that should rarely fail.
    pub fn wrong_failures(&self) -> usize {
        if matches!(self.standing, Standing::AtLimit | Standing::Good) { self.failed } else { 0 }
    }

    /// Rows of a study. Bounds may hold the truth always.
    pub fn rows(&self) -> Vec<Row> {
        let records = self.records as u64;
        let share =
            |claim: &str, asked, hits: usize, of: u64| Row::share(&self.id, claim, asked, hits as u64, of);
        let two_sided = self.bounded == 0 && self.width.is_some();
        let asked = if two_sided { Asked::Between(0.93, 0.97) } else { Asked::AtLeast(0.93) };
        let mut rows = vec![];
        if self.given() > 0 {
            rows.push(share("95 % interval or bound holds the truth", asked, self.held, self.given() as u64));
        }
        rows.push(share("a value is stated", Asked::Nothing, self.stated, records));
        rows.push(share("a bound alone is stated", Asked::Nothing, self.bounded, records));
        let passes = |claim: &str, asked| share(claim, asked, self.passed, records);
        let failures = |claim: &str, asked| share(claim, asked, self.failed, records);
        match self.standing {
            Standing::Unlimited => {}
            Standing::Good => rows.extend([
                passes("a unit within its limit passes", Asked::Nothing),
                failures("a unit within its limit fails", Asked::AtMost(0.05)),
            ]),
            Standing::AtLimit => rows.extend([
                passes("a unit at its limit passes", Asked::AtMost(0.05)),
                failures("a unit at its limit fails", Asked::AtMost(0.05)),
            ]),
            Standing::Bad => rows.extend([
                passes("a unit beyond its limit passes", Asked::AtMost(0.05)),
                failures("a unit beyond its limit fails", Asked::Nothing),
            ]),
        }
        if let Some(width) = self.width {
            let claim = "median width over that of an oracle that knows all else";
            rows.push(Row::number(&self.id, claim, Asked::AtMost(1.5), width, self.stated as u64));
        }
        rows
    }

    /// What no accident explains, even in a short study: chances below one in ten thousand.
    pub fn certainly_wrong(&self) -> Option<String> {
        let by_chance = |count: usize, of: usize, share: f64| -> f64 {
            (count..=of)
                .map(|k| binomial(of, k) * share.powi(k as i32) * (1.0 - share).powi((of - k) as i32))
                .sum()
        };
        let lost = self.given() - self.held;
        let worst = [
            ("intervals without the truth", lost, self.given()),
            ("wrong passes", self.wrong_passes(), self.records),
            ("wrong failures", self.wrong_failures(), self.records),
        ];
        let found = worst.iter().find(|(_, count, of)| *count > 0 && by_chance(*count, *of, 0.07) < 1e-4);
        found.map(|(what, count, of)| format!("{}: {count} {what} of {of}", self.id))
    }
}

fn binomial(of: usize, k: usize) -> f64 {
    (0..k).map(|i| (of - i) as f64 / (i + 1) as f64).product()
}
