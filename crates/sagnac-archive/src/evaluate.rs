//! One recording through Sagnac: whatever happens is an outcome.
//!
//! This is the only file that calls the analysis.

use crate::outcome::{Failure, FailureKind, Outcome};
use crate::stores::{Fetched, fetch};
use chrono::{DateTime, SecondsFormat, Utc};
use sagnac::record::{RunRecord, explanation::Explanation};
use sagnac::{Analysis, Model, Procedure, Recording, UnitUnderTest};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::any::Any;
use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Duration;

/// How often what cannot be reached is tried.
const MAX_ATTEMPTS: u32 = 3;
/// Pause before the second attempt; it doubles.
const FIRST_PAUSE: Duration = Duration::from_millis(500);

/// Task for one recording. Files are given by path or address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Task<'a> {
    /// Measure what the recording shows, as `sagnac analyze` does.
    Analyze,
    /// Run a procedure, as `sagnac run` does.
    Run {
        /// The procedure (TOML).
        procedure: &'a str,
        /// Its limits (TOML), where they stand in a file of their own.
        limits: Option<&'a str>,
    },
    /// Find where the recording departs from a model, as `sagnac explain` does.
    Explain {
        /// The model (TOML).
        model: &'a str,
    },
}

/// One recording, and what is known of it.
#[derive(Debug, Clone, Copy)]
pub struct Order<'a> {
    /// Path or address of the recording.
    pub uri: &'a str,
    /// What to do with it.
    pub task: Task<'a>,
    /// The unit as a JSON object with the members of `unit_under_test` in `result.json`.
    pub unit: Option<&'a str>,
    /// Time of the evaluation, RFC 3339; the present time where it is left out.
    pub at: Option<&'a str>,
}

/// Evaluates one recording. A fault of the program, too, is data: it ends in [`FailureKind::Program`].
pub fn evaluate(order: &Order<'_>) -> Outcome {
    let mut pause = FIRST_PAUSE;
    for _ in 1..MAX_ATTEMPTS {
        match guarded(order) {
            Err(failure) if failure.kind == FailureKind::Access => std::thread::sleep(pause),
            done => return done.unwrap_or_else(Outcome::from),
        }
        pause *= 2;
    }
    guarded(order).unwrap_or_else(Outcome::from)
}

fn guarded(order: &Order<'_>) -> Result<Outcome, Failure> {
    catch_unwind(AssertUnwindSafe(|| evaluated(order))).unwrap_or_else(|cause| {
        let text = format!("{}: the evaluation broke off: {}", order.uri, panic_text(cause.as_ref()));
        Err(Failure::new(FailureKind::Program, text))
    })
}

fn panic_text(cause: &(dyn Any + Send)) -> &str {
    cause
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| cause.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no reason given")
}

fn evaluated(order: &Order<'_>) -> Result<Outcome, Failure> {
    let file = fetch(order.uri)?;
    let unit = order.unit.map(unit_of).transpose()?.unwrap_or_default();
    let at = order.at.map(time_of).transpose()?.unwrap_or_else(sagnac::moment::now);
    let shown = Shown { file: &file, uri: order.uri };
    let recording = Recording::open(file.path()).map_err(|e| shown.failure(&e))?;
    match order.task {
        Task::Analyze => {
            let analysis = Analysis { evaluated_at: Some(at), ..Analysis::default() };
            let result = analysis.run(&recording).map_err(|e| shown.failure(&e))?;
            let mut record = shown.record(result.record());
            let known = &mut record.unit_under_test;
            known.serial = unit.serial.clone().or_else(|| known.serial.take());
            known.family = unit.family.clone().or_else(|| known.family.take());
            known.fill(&unit);
            of_record(&record)
        }
        Task::Run { procedure, limits } => {
            let procedure = fetch(procedure)?;
            let limits = limits.map(fetch).transpose()?;
            let loaded = Procedure::load(procedure.path()).map_err(|e| shown.failure(&e))?;
            let loaded = match &limits {
                Some(limits) => loaded.with_limits(limits.path()).map_err(|e| shown.failure(&e))?,
                None => loaded,
            };
            let result = loaded.evaluated_at(at).run(&recording, &unit).map_err(|e| shown.failure(&e))?;
            of_record(&shown.record(result.record()))
        }
        Task::Explain { model } => {
            let model = fetch(model)?;
            let loaded = Model::load(model.path()).map_err(|e| shown.failure(&e))?;
            let explanation = sagnac::explain(&recording, &loaded).map_err(|e| shown.failure(&e))?;
            of_explanation(explanation.record(), &unit, at, hash_of_file(file.path(), order.uri)?)
        }
    }
}

fn unit_of(json: &str) -> Result<UnitUnderTest, Failure> {
    serde_json::from_str(json).map_err(|e| {
        let expected = "expected an object with members of unit_under_test, such as {\"serial\": \"SN-1\"}";
        Failure::new(FailureKind::Argument, format!("unit data `{json}`: {e}; {expected}"))
    })
}

fn time_of(text: &str) -> Result<DateTime<Utc>, Failure> {
    DateTime::parse_from_rfc3339(text).map(|t| t.to_utc()).map_err(|e| {
        let expected = "expected RFC 3339, such as 2026-05-04T10:00:00Z";
        Failure::new(FailureKind::Argument, format!("time of evaluation `{text}`: {e}; {expected}"))
    })
}

fn text_of(time: DateTime<Utc>) -> String {
    time.to_rfc3339_opts(SecondsFormat::Secs, true)
}

/// How a recording is named in results: by its address, never by that of a copy.
struct Shown<'a> {
    file: &'a Fetched,
    uri: &'a str,
}

impl Shown<'_> {
    fn name(&self, text: &str) -> String {
        if self.file.is_copy() {
            text.replace(&self.file.path().display().to_string(), self.uri)
        } else {
            text.to_owned()
        }
    }

    fn record(&self, record: &RunRecord) -> RunRecord {
        let mut record = record.clone();
        record.recording.iter_mut().for_each(|f| f.path = self.name(&f.path));
        record
    }

    fn failure(&self, e: &sagnac::Error) -> Failure {
        let kind = if e.is_configuration() {
            FailureKind::Configuration
        } else if e.is_not_evaluable() {
            FailureKind::NotEvaluable
        } else if e.is_argument() {
            FailureKind::Argument
        } else {
            FailureKind::Recording
        };
        Failure::new(kind, self.name(&e.to_string()))
    }
}

/// One line: indented text would be twice as long.
fn json(value: &impl Serialize) -> Result<String, Failure> {
    serde_json::to_string(value)
        .map_err(|e| Failure::new(FailureKind::Program, format!("the result cannot be written: {e}")))
}

fn of_record(record: &RunRecord) -> Result<Outcome, Failure> {
    let unit = &record.unit_under_test;
    Ok(Outcome {
        serial: unit.serial.clone(),
        family: unit.family.as_ref().map(|f| f.text().to_owned()),
        lot: unit.lot.clone(),
        verdict: Some(record.verdict.id().to_owned()),
        evaluated_at: Some(record.session.evaluated_at.clone()),
        recorded_at: record.recording.iter().find_map(|f| f.start.clone()),
        measurands: record.measurands.clone(),
        faults: record.integrity.faults.clone(),
        effects: vec![],
        hash: hash_of_record(record),
        samples: Some(record.recording.iter().map(|f| f.samples).sum()),
        result_json: Some(json(record)?),
        error: None,
    })
}

/// The hash of one file as it is; of several, the hash of their hashes in sequence.
fn hash_of_record(record: &RunRecord) -> Option<String> {
    match record.recording.as_slice() {
        [] => None,
        [one] => Some(one.sha256.clone()),
        several => {
            let hash = several.iter().fold(Sha256::new(), |hash, f| hash.chain_update(&f.sha256));
            Some(hexadecimal(hash))
        }
    }
}

fn of_explanation(
    found: &Explanation,
    unit: &UnitUnderTest,
    at: DateTime<Utc>,
    hash: String,
) -> Result<Outcome, Failure> {
    Ok(Outcome {
        serial: unit.serial.clone(),
        family: unit.family.as_ref().map(|f| f.text().to_owned()),
        lot: unit.lot.clone(),
        verdict: Some(found.verdict.id().to_owned()),
        evaluated_at: Some(text_of(at)),
        effects: found.effects.iter().map(|e| e.effect.clone().unwrap_or_else(|| e.kind.clone())).collect(),
        hash: Some(hash),
        result_json: Some(json(found)?),
        ..Outcome::default()
    })
}

/// SHA-256 of a file, hexadecimal.
///
/// # Errors
/// [`FailureKind::Access`] when it cannot be read to its end.
pub fn hash_of_file(path: &Path, named: &str) -> Result<String, Failure> {
    let failed = |e: std::io::Error| Failure::new(FailureKind::Access, format!("{named}: {e}"));
    let mut file = std::fs::File::open(path).map_err(failed)?;
    let (mut hash, mut bytes) = (Sha256::new(), vec![0; 1 << 16]);
    loop {
        let read = file.read(&mut bytes).map_err(failed)?;
        match bytes.get(..read) {
            Some(some) if read > 0 => hash.update(some),
            _ => return Ok(hexadecimal(hash)),
        }
    }
}

/// A finished SHA-256 as hexadecimal text.
pub fn hexadecimal(hash: Sha256) -> String {
    use std::fmt::Write;
    hash.finalize().iter().fold(String::with_capacity(64), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_broke_off_is_told() {
        let text = |cause: Box<dyn Any + Send>| panic_text(cause.as_ref()).to_owned();
        assert_eq!(text(Box::new("index")), "index");
        assert_eq!(text(Box::new("index 7".to_owned())), "index 7");
        assert_eq!(text(Box::new(7)), "no reason given");
    }

    #[test]
    fn unit_data_may_name_the_serial_number_only() {
        assert_eq!(unit_of(r#"{"serial": "SN-1"}"#).unwrap().serial.as_deref(), Some("SN-1"));
        let failure = unit_of("SN-1").unwrap_err();
        assert_eq!(failure.kind, FailureKind::Argument);
        assert!(failure.text.contains("expected an object"), "{}", failure.text);
    }
}
