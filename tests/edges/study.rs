//! Carries a case out: draws, tests by the program, tallies.

use crate::case::{Case, LimitKey, Simulated, Standing, Truth};
use rayon::prelude::*;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

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
    verdict: String,
}

/// One measurand of one case over all its recordings.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
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
    /// Median of the half width over that of the told oracle, where there is one.
    pub width: Option<f64>,
}

/// Draws `records` recordings from `first_seed` on, tests each by the program and sets the results against the truths.
pub fn run(case: &Case, records: usize, first_seed: u64) -> Vec<Tally> {
    let outcomes: Vec<Vec<Outcome>> =
        (0..records as u64).into_par_iter().map(|i| outcome(case, first_seed + i)).collect();
    let mut keys: Vec<(&str, Option<&str>)> = Vec::new();
    for truth in outcomes.iter().flatten().map(|o| &o.truth) {
        if !keys.contains(&(truth.id, truth.channel)) {
            keys.push((truth.id, truth.channel));
        }
    }
    for id in case.ids {
        assert!(keys.iter().any(|k| k.0 == *id), "{}: no truth of `{id}`", case.name);
    }
    let of = |key: (&str, Option<&str>)| -> Vec<&Outcome> {
        outcomes.iter().flatten().filter(|o| (o.truth.id, o.truth.channel) == key).collect()
    };
    keys.into_iter().map(|key| Tally::new(&of(key))).collect()
}

fn outcome(case: &Case, seed: u64) -> Vec<Outcome> {
    let simulated = (case.draw)(seed);
    let folder = tempfile::tempdir().unwrap();
    let result = tested(folder.path(), &simulated, case.name, seed);
    let rows = result["measurands"].as_array().unwrap();
    let found = |t: &Truth| {
        let same = |r: &&Value| r["id"] == t.id && t.channel.is_none_or(|c| r["channel"] == c);
        rows.iter().find(same).cloned().unwrap_or(Value::Null)
    };
    simulated
        .truths
        .into_iter()
        .map(|truth| {
            let row = found(&truth);
            let verdict = row["verdict"].as_str().unwrap_or("none").to_string();
            Outcome { stated: stated(&row), verdict, truth }
        })
        .collect()
}

/// Runs the program and reads its result.
fn tested(folder: &Path, simulated: &Simulated, case: &str, seed: u64) -> Value {
    std::fs::write(folder.join("r.csv"), &simulated.csv).unwrap();
    std::fs::write(folder.join("p.toml"), &simulated.procedure).unwrap();
    std::fs::write(folder.join("l.toml"), limits(&simulated.truths)).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_sagnac"));
    command.current_dir(folder).env("RAYON_NUM_THREADS", "1");
    command.args(["run", "p.toml", "r.csv", "--serial", "SN-0001", "--out", "o"]);
    if simulated.truths.iter().any(|t| t.limit.is_some()) {
        command.args(["--limits", "l.toml"]);
    }
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    let text = std::fs::read_to_string(folder.join("o/result.json"));
    let text = text.unwrap_or_else(|_| panic!("{case}, seed {seed}: {said}"));
    let result: Value = serde_json::from_str(&text).unwrap();
    assert!(result["measurands"].as_array().is_some_and(|m| !m.is_empty()), "{case}, seed {seed}: {said}");
    result
}

/// The limits file of the truths.
fn limits(truths: &[Truth]) -> String {
    let mut text = String::from(
        "format = \"limits/1\"\n[limits]\nid = \"edges\"\ntitle = \"Truths\"\nrevision = \"A\"\nfamily = \"SIMULATED\"\n\
         source = \"drawn\"\n",
    );
    let mut written: Vec<(&str, Option<&str>)> = Vec::new();
    for truth in truths {
        let Some(limit) = &truth.limit else { continue };
        // A limit of a channel judges its rows at all levels.
        let channel = truth.channel.map(|c| c.split('@').next().unwrap_or(c));
        if written.contains(&(truth.id, channel)) {
            continue;
        }
        written.push((truth.id, channel));
        let unit = sagnac::measurand::find(truth.id).map_or("", |m| m.unit);
        let key = match limit.key {
            LimitKey::Max => "max",
            LimitKey::Min => "min",
            LimitKey::MaxAbs => "max_abs",
        };
        text += &format!("[[limit]]\nmeasurand = \"{}\"\n{key} = \"{:.12} {unit}\"\n", truth.id, limit.value);
        if let Some(channel) = channel {
            text += &format!("channel = \"{channel}\"\n");
        }
    }
    text
}

/// What a row of `result.json` states.
fn stated(row: &Value) -> Stated {
    let bound = |key: &str| row[key]["value"].as_f64();
    match (row["interval"]["low"].as_f64(), row["interval"]["high"].as_f64()) {
        (Some(low), Some(high)) => Stated::Interval { low, high },
        _ => match (bound("lower_limit"), bound("upper_limit")) {
            (None, None) => Stated::Withheld,
            (low, high) => {
                Stated::Bound { low: low.unwrap_or(f64::NEG_INFINITY), high: high.unwrap_or(f64::INFINITY) }
            }
        },
    }
}

impl Tally {
    fn new(outcomes: &[&Outcome]) -> Tally {
        let first = &outcomes[0].truth;
        let count = |test: &dyn Fn(&Outcome) -> bool| outcomes.iter().filter(|o| test(o)).count();
        let held = |o: &Outcome| match o.stated {
            Stated::Interval { low, high } | Stated::Bound { low, high } => {
                low <= o.truth.value && o.truth.value <= high
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
            id: first.channel.map_or(first.id.to_string(), |c| format!("{} {c}", first.id)),
            records: outcomes.len(),
            stated: count(&|o| matches!(o.stated, Stated::Interval { .. })),
            bounded: count(&|o| matches!(o.stated, Stated::Bound { .. })),
            held: count(&held),
            standing: outcomes.iter().map(|o| o.truth.standing()).max().unwrap_or(Standing::Unlimited),
            passed: count(&|o| o.verdict == "pass"),
            failed: count(&|o| o.verdict == "fail"),
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

    /// What is asked of the full study and missed by more than two standard deviations of sampling.
    pub fn misses(&self) -> Vec<String> {
        let slack = |share: f64, of: usize| 2.0 * (share * (1.0 - share) / of.max(1) as f64).sqrt();
        let mut misses = Vec::new();
        if self.given() > 0 && self.coverage() < 0.93 - slack(0.93, self.given()) {
            misses.push(format!("coverage {:.3}", self.coverage()));
        }
        let most =
            if self.bounded > 0 || self.width.is_none() { 1.0 } else { 0.97 + slack(0.97, self.given()) };
        if self.coverage() > most {
            misses.push(format!("coverage {:.3}", self.coverage()));
        }
        for (what, count) in [("passes", self.wrong_passes()), ("failures", self.wrong_failures())] {
            let share = count as f64 / self.records as f64;
            if share > 0.05 + slack(0.05, self.records) {
                misses.push(format!("wrong {what} {share:.3}"));
            }
        }
        if let Some(width) = self.width.filter(|w| *w > 1.5) {
            misses.push(format!("width {width:.2}"));
        }
        misses
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

    /// One line for the terminal.
    pub fn line(&self) -> String {
        let share = |count: usize| count as f64 / self.records.max(1) as f64;
        let width = self.width.map_or_else(|| "-".to_string(), |w| format!("{w:.2}"));
        let misses = self.misses();
        let verdict =
            if misses.is_empty() { "holds".to_string() } else { format!("MISS {}", misses.join(", ")) };
        format!(
            "{}: {} records, {:.2} with a value, {:.2} bounded, coverage {:.3}, width {width}, {:?}: passed {:.3}, failed {:.3}: {verdict}",
            self.id,
            self.records,
            share(self.stated),
            share(self.bounded),
            self.coverage(),
            self.standing,
            share(self.passed),
            share(self.failed),
        )
    }
}

fn binomial(of: usize, k: usize) -> f64 {
    (0..k).map(|i| (of - i) as f64 / (i + 1) as f64).product()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tally(held: usize, of: usize) -> Tally {
        Tally {
            id: "x".into(),
            records: of,
            stated: of,
            bounded: 0,
            held,
            standing: Standing::AtLimit,
            passed: 0,
            failed: 0,
            width: Some(1.0),
        }
    }

    #[test]
    fn a_short_study_finds_what_no_accident_explains() {
        assert_eq!(tally(6, 8).certainly_wrong(), None);
        assert!(tally(3, 8).certainly_wrong().is_some());
        assert!(Tally { passed: 5, ..tally(8, 8) }.certainly_wrong().is_some());
        assert_eq!(Tally { passed: 8, standing: Standing::Good, ..tally(8, 8) }.certainly_wrong(), None);
    }

    #[test]
    fn a_long_study_is_held_to_what_is_asked() {
        assert!(tally(950, 1000).misses().is_empty());
        assert_eq!(tally(900, 1000).misses(), ["coverage 0.900"]);
        assert_eq!(tally(995, 1000).misses(), ["coverage 0.995"]);
        assert_eq!(Tally { failed: 120, ..tally(950, 1000) }.misses(), ["wrong failures 0.120"]);
        assert_eq!(Tally { width: Some(2.0), ..tally(950, 1000) }.misses(), ["width 2.00"]);
    }

    #[test]
    fn a_truth_stands_where_its_limit_puts_it() {
        assert_eq!(Truth::new("x", -2.0).max_abs(2.0).standing(), Standing::AtLimit);
        assert_eq!(Truth::new("x", -2.0).max_abs(2.1).standing(), Standing::Good);
        assert_eq!(Truth::new("x", 1.0).min(2.0).standing(), Standing::Bad);
        assert_eq!(Truth::new("x", 1.0).oracle(0.1).on("y").standing(), Standing::Unlimited);
        assert_eq!(Truth::new("x", 1.0).max(0.5).standing(), Standing::Bad);
    }
}
