//! The bad-data drill: samples corrupted in every way of the list. Each corruption is caught by a diagnostic that names
//! it, or changes neither the verdict nor, within their intervals, the values. What catches what was written by hand.
//!
//! With every test each corruption goes through a short sample, one in three through a long one; all through all:
//! `cargo test --test it drill -- --ignored`.
//! `SAGNAC_WRITE_DRILL=1 cargo test --test it drill` does that and writes the table to docs/drill.md.

mod corruptions;
mod expected;
mod other_kinds;
mod recording;
mod run;

use corruptions::corrupt;
use expected::{CASES, Expect};
use sagnac::estimate::Verdict;
use sagnac::record::{ConditionStatus, MeasurandRecord, RunRecord};
use std::fmt::Write;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

type Result = std::result::Result<RunRecord, String>;

/// What no recording reveals: the end of the document.
const NOT_REVEALED: &str = include_str!("not_revealed.md");

/// The samples, in the order of every table.
const SAMPLES: [&str; 4] = ["pass", "fail", "indeterminate", "faults"];

/// What is different from the run of the sound sample, beyond what the intervals allow.
fn difference(sound: &RunRecord, spoilt: &RunRecord) -> Option<String> {
    if sound.verdict != spoilt.verdict {
        return Some(format!("the verdict is {:?} and was {:?}", spoilt.verdict, sound.verdict));
    }
    if sound.measurands.len() != spoilt.measurands.len() {
        return Some("another number of rows".into());
    }
    for (a, b) in sound.measurands.iter().zip(&spoilt.measurands) {
        if (&a.id, a.verdict) != (&b.id, b.verdict) {
            return Some(format!("{}: {:?} and was {:?}", b.id, b.verdict, a.verdict));
        }
        if let (Some(value), Some(interval)) = (b.value, &a.interval)
            && !(interval.low <= value && value <= interval.high)
        {
            return Some(format!("{}: {value} is outside {} to {}", b.id, interval.low, interval.high));
        }
    }
    None
}

/// The sentence that catches, or what is missing.
fn judge(expect: Expect, sound: &RunRecord, result: &Result) -> std::result::Result<String, String> {
    let condition = |id: &str, fragment: &str, invalid: bool| -> std::result::Result<String, String> {
        let record = result.as_ref().map_err(|e| format!("refused: {e}"))?;
        let kind = |c: &str| c.split('.').next() == Some(id);
        let wanted =
            |s: ConditionStatus| s == ConditionStatus::Invalid || !invalid && s == ConditionStatus::Remark;
        let caught =
            record.conditions.iter().find(|c| kind(&c.id) && wanted(c.status) && c.note.contains(fragment));
        if invalid && record.verdict.id() != "indeterminate" {
            return Err(format!("the verdict is {}", record.verdict.id()));
        }
        let other = || record.conditions.iter().filter(|c| c.status != ConditionStatus::Ok);
        caught.map(|c| format!("{}: {}", c.id, c.note)).ok_or_else(|| {
            other().map(|c| format!("\n    {:?} {}: {}", c.status, c.id, c.note)).collect::<String>()
        })
    };
    match expect {
        Expect::Same => match result {
            Ok(record) => difference(sound, record).map_or_else(|| Ok("unchanged".into()), Err),
            Err(e) => Err(format!("refused: {e}")),
        },
        Expect::Condition(id, fragment) => condition(id, fragment, false),
        Expect::Invalid(id, fragment) => condition(id, fragment, true),
        Expect::Fault(kind, fragment) => {
            let record = result.as_ref().map_err(|e| format!("refused: {e}"))?;
            let faults = || record.integrity.faults.iter();
            let caught = faults().find(|f| f.kind == kind && f.seen.note.contains(fragment));
            let seen =
                || faults().take(5).map(|f| format!("\n    {}: {}", f.kind, f.seen.note)).collect::<String>();
            caught.map(|f| format!("{}, row {}: {}", f.kind, f.row, f.seen.note)).ok_or_else(seen)
        }
        Expect::Fails(id) => {
            let record = result.as_ref().map_err(|e| format!("refused: {e}"))?;
            let fails = |m: &&MeasurandRecord| m.id == id && m.verdict == Verdict::Fail;
            let row = record.measurands.iter().find(fails);
            row.map(|m| format!("not named; {} fails: {:.3e} {}", m.id, m.value.unwrap_or_default(), m.unit))
                .ok_or_else(|| format!("{id} does not fail"))
        }
        Expect::Refused(fragment) => match result {
            Err(e) if e.contains(fragment) => Ok(format!("refused: {e}")),
            Err(e) => Err(format!("refused: {e}")),
            Ok(record) => Err(format!("read; the verdict is {:?}", record.verdict)),
        },
        Expect::RefusedOrSame(fragment) => match result {
            Err(_) => judge(Expect::Refused(fragment), sound, result),
            Ok(_) => judge(Expect::Same, sound, result),
        },
    }
}

fn drilled(folder: &Path, what: &str, sample: &str) -> Result {
    let path = folder.join(if what == "gzip" { "recording.csv.gz" } else { "recording.csv" });
    std::fs::write(&path, corrupt(what, sample)).unwrap();
    let by_position = what.ends_with("column_by_position");
    run::run(folder, &path, |text| {
        assert!(text.contains("column = \"rate_deg_h\""));
        if by_position { text.replace("column = \"rate_deg_h\"", "column = 2") } else { text }
    })
}

/// True when a corruption goes through a sample with every test: each through one of 10.6 h, one in three through one of
/// 100 h.
fn in_turn(case: usize, sample: usize) -> bool {
    sample == 2 + (case / 2) % 2 || case.is_multiple_of(3) && sample == (case / 3) % 2
}

#[test]
fn every_corruption_is_caught_by_name_or_changes_nothing() {
    let whole = std::env::var_os("SAGNAC_WRITE_DRILL").is_some();
    drill(&|case, sample| whole || in_turn(case, sample));
}

#[test]
#[ignore = "minutes; see the head of the file"]
fn every_corruption_of_every_sample_is_caught_by_name_or_changes_nothing() {
    drill(&|_, _| true);
}

fn drill(wanted: &(dyn Fn(usize, usize) -> bool + Sync)) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let dir = tempfile::tempdir().unwrap();
    let sound: Vec<RunRecord> = SAMPLES
        .iter()
        .map(|s| run::run(dir.path(), &root.join(format!("samples/unit-{s}.csv")), |t| t).unwrap())
        .collect();
    let verdicts: Vec<&str> = sound.iter().map(|r| r.verdict.id()).collect();
    assert_eq!(verdicts, ["pass", "fail", "indeterminate", "indeterminate"]);
    assert!(CASES.len() >= 30);
    let only = std::env::var("SAGNAC_DRILL").ok();
    let next = AtomicUsize::new(0);
    let outcomes = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                let own = tempfile::tempdir().unwrap();
                loop {
                    let task = next.fetch_add(1, Ordering::Relaxed);
                    let (case, sample) = (task / SAMPLES.len(), task % SAMPLES.len());
                    let Some((what, expected)) = CASES.get(case) else { break };
                    if !wanted(case, sample) || only.as_ref().is_some_and(|o| !what.contains(o.as_str())) {
                        continue;
                    }
                    let begun = std::time::Instant::now();
                    let result = drilled(own.path(), what, SAMPLES[sample]);
                    if only.is_some() {
                        println!("{what} on {}: {:.2?}", SAMPLES[sample], begun.elapsed());
                    }
                    let judged = judge(expected[sample], &sound[sample], &result)
                        .map(|said| said.replace(&format!("{}/", own.path().display()), ""));
                    if let (Err(why), true) = (&judged, only.is_some()) {
                        println!("  {what}: {:?}: {why}", expected[sample]);
                    }
                    outcomes.lock().unwrap().push((case, sample, judged));
                }
            });
        }
    });
    let mut outcomes = outcomes.into_inner().unwrap();
    outcomes.sort_by_key(|(case, sample, _)| (*case, *sample));
    let asked = (0..CASES.len() * SAMPLES.len()).filter(|t| wanted(t / SAMPLES.len(), t % SAMPLES.len()));
    assert!(only.is_some() || outcomes.len() == asked.count(), "{} runs", outcomes.len());
    let missed: Vec<String> = outcomes
        .iter()
        .filter_map(|(case, sample, judged)| {
            let (what, expected) = CASES[*case];
            let why = judged.as_ref().err()?;
            Some(format!("{what} on {}: expected {:?}, found {why}", SAMPLES[*sample], expected[*sample]))
        })
        .collect();
    assert!(missed.is_empty(), "{} missed:\n{}", missed.len(), missed.join("\n"));
    if std::env::var_os("SAGNAC_WRITE_DRILL").is_some() {
        let said = outcomes.into_iter().map(|(_, _, judged)| judged.unwrap_or_default()).collect::<Vec<_>>();
        std::fs::write(root.join("docs/drill.md"), table(&said)).unwrap();
    }
}

#[test]
fn the_document_says_what_no_recording_reveals() {
    let document = std::fs::read_to_string(crate::support::shipped("docs/drill.md")).unwrap();
    assert!(document.ends_with(NOT_REVEALED));
    let errors = || NOT_REVEALED.lines().filter(|l| l.starts_with("| ")).skip(1);
    assert!(errors().count() >= 25);
    assert!(errors().all(|l| l.split(" | ").count() == 2), "an error has something that reveals it");
}

/// The table of the document.
fn table(said: &[String]) -> String {
    let unchanged = said.iter().filter(|s| *s == "unchanged").count();
    let unnamed = said.iter().filter(|s| s.starts_with("not named")).count();
    let mut out = format!(
        "# Bad-data drill\n\nEach of the {} corruptions below was applied to {} sample recordings. A cell gives the message that \
         reports the corruption.\n\n| outcome | runs |\n|---|--:|\n| reported by name | {} |\n| unchanged: the verdict is the \
         same, and each value stays within its interval | {unchanged} |\n| not named: no message names the corruption, but the \
         unit fails its limits | {unnamed} |\n\nWritten by `SAGNAC_WRITE_DRILL=1 cargo test --test it drill`.\n\n\
         | corruption | {} |\n|---|{}\n",
        CASES.len(),
        SAMPLES.len(),
        said.len() - unchanged - unnamed,
        SAMPLES.join(" | "),
        "---|".repeat(SAMPLES.len())
    );
    for ((what, _), cells) in CASES.iter().zip(said.chunks(SAMPLES.len())) {
        let cells: Vec<String> = cells.iter().map(|c| c.replace('|', "\\|").replace('\n', " ")).collect();
        let _ = writeln!(out, "| {} | {} |", what.replace('_', " "), cells.join(" | "));
    }
    out + NOT_REVEALED
}
