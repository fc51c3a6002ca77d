//! `junit.xml`: the verdicts of a lot for systems of continuous integration; the same in every language.
//!
//! A unit is a `testsuite`; each condition and each quantity with a limit is a `testcase` of it. A failed limit is a
//! `failure`. What is undecided, or was not tested as required, is `skipped`. A unit that could not be tested is an
//! `error` of the case `test`.

use super::reasons::{condition_reason, measurand_reason, reasons, several_channels};
use crate::estimate::Verdict;
use crate::i18n::{Lang, Localize};
use crate::record::{
    ConditionStatus, LotCondition, LotFile, LotRecord, LotUnit, MeasurandRecord, RecordingFile, RunRecord,
    SerialSource,
};
use crate::report::translator::Translator;
use chrono::DateTime;
use quick_junit::{NonSuccessKind, Report, SerializeError, TestCase, TestCaseStatus, TestSuite};

/// The document.
///
/// # Errors
/// What keeps it from being written as XML.
pub fn junit(lot: &LotRecord) -> Result<String, SerializeError> {
    let mut report = Report::new(lot.procedure.title.text());
    let at = DateTime::parse_from_rfc3339(&lot.session.evaluated_at).ok();
    if let Some(at) = at {
        report.set_timestamp(at);
    }
    for unit in &lot.units {
        let mut suite = suite(unit, &lot.procedure.id);
        if let Some(at) = at {
            suite.set_timestamp(at);
        }
        report.add_test_suite(suite);
    }
    report.to_string()
}

/// The document of a run of a procedure: one unit.
///
/// # Errors
/// What keeps it from being written as XML.
pub fn junit_of_run(run: &RunRecord) -> Result<String, SerializeError> {
    let Some(procedure) = &run.procedure else { return Report::new("").to_string() };
    let of = |f: &RecordingFile| LotFile { path: f.path.clone(), sha256: f.sha256.clone() };
    let unit = LotUnit {
        unit_under_test: run.unit_under_test.clone(),
        serial_from: SerialSource::Recording,
        recording: run.recording.first().map(|f| f.path.clone()).unwrap_or_default(),
        files: run.recording.iter().map(of).collect(),
        folder: String::new(),
        verdict: run.verdict,
        summary: run.summary.clone(),
        conditions: run.conditions.iter().map(LotCondition::of).collect(),
        measurands: run.measurands.iter().filter(|m| m.limit.is_some()).cloned().collect(),
        errors: run.errors.clone(),
    };
    let mut report = Report::new(procedure.title.text());
    if let Ok(at) = DateTime::parse_from_rfc3339(&run.session.evaluated_at) {
        report.set_timestamp(at);
    }
    report.add_test_suite(suite(&unit, &procedure.id));
    report.to_string()
}

fn suite(unit: &LotUnit, procedure: &str) -> TestSuite {
    let mut suite = TestSuite::new(unit.serial());
    for (name, value) in [
        ("verdict", unit.verdict.id()),
        ("serial_from", if unit.folder.is_empty() { "" } else { unit.serial_from.id() }),
        ("recording", unit.recording.as_str()),
        ("folder", unit.folder.as_str()),
    ] {
        // A run on its own has no folder in a lot.
        if !value.is_empty() {
            suite.add_property((name, value));
        }
    }
    let of = |name: String, phase: Option<&str>, status| {
        let mut case = TestCase::new(name, status);
        let parts = [Some(procedure), phase, Some(unit.serial())];
        case.set_classname(parts.into_iter().flatten().collect::<Vec<_>>().join("."));
        case
    };
    let several = several_channels(unit);
    for (i, c) in unit.conditions.iter().enumerate() {
        // Several instruments or channels have the same condition.
        let same = |other: &&LotCondition| other.id == c.id && other.phase == c.phase;
        let before = unit.conditions.iter().take(i).filter(same).count();
        let name = if before > 0 { format!("{}[{}]", c.id, before + 1) } else { c.id.clone() };
        let mut case = of(name, c.phase.as_deref(), of_condition(c));
        if let Some(remark) = c.message.as_ref().filter(|_| c.status == ConditionStatus::Remark) {
            case.set_system_out(remark.say(Lang::En));
        }
        suite.add_test_case(case);
    }
    for m in &unit.measurands {
        let name = if several { format!("{}[{}]", m.id, m.channel) } else { m.id.clone() };
        suite.add_test_case(of(name, m.phase.as_deref(), of_measurand(m, several)));
    }
    if let Some(status) = of_whole(unit) {
        suite.add_test_case(of("test".to_owned(), None, status));
    }
    suite
}

fn of_condition(c: &LotCondition) -> TestCaseStatus {
    match condition_reason(c, Translator { lang: Lang::En }) {
        Some(reason) => skipped(&reason, "condition"),
        None => TestCaseStatus::success(),
    }
}

fn of_measurand(m: &MeasurandRecord, several_channels: bool) -> TestCaseStatus {
    let reason = measurand_reason(m, several_channels, Translator { lang: Lang::En }).unwrap_or_default();
    match m.verdict {
        Verdict::Pass => TestCaseStatus::success(),
        Verdict::Fail => non_success(NonSuccessKind::Failure, &reason, "limit"),
        Verdict::Error => non_success(NonSuccessKind::Error, &reason, "error"),
        Verdict::Indeterminate | Verdict::None => skipped(&reason, "indeterminate"),
    }
}

/// What the cases of a unit do not tell: that it could not be tested, or why nothing was decided.
fn of_whole(unit: &LotUnit) -> Option<TestCaseStatus> {
    let sentences = || reasons(unit, Translator { lang: Lang::En }).join("\n");
    let undecided = unit.measurands.iter().any(|m| m.verdict == Verdict::Indeterminate)
        || unit.conditions.iter().any(|c| c.status == ConditionStatus::Invalid);
    match unit.verdict {
        Verdict::Error => Some(non_success(NonSuccessKind::Error, &sentences(), "error")),
        Verdict::Indeterminate if !undecided => Some(skipped(&sentences(), "indeterminate")),
        Verdict::None => Some(skipped(&sentences(), "no_limits")),
        _ => None,
    }
}

fn non_success(kind: NonSuccessKind, reason: &str, id: &str) -> TestCaseStatus {
    let mut status = TestCaseStatus::non_success(kind);
    status.set_message(reason).set_type(id);
    status
}

fn skipped(reason: &str, id: &str) -> TestCaseStatus {
    let mut status = TestCaseStatus::skipped();
    status.set_message(reason).set_type(id);
    status
}
