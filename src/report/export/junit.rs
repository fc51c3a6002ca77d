//! `junit.xml`, for systems of continuous integration: the verdicts of a lot or of a run; the same in every language.
//!
//! A unit is a `testsuite`; each condition and each quantity with a limit is a `testcase` of it. A failed limit is a
//! `failure`. What is undecided, or was not tested as required, is `skipped`. A unit that could not be tested is an
//! `error` of the case `test`.

use super::xml::{Xml, empty, leaf, node, xml_document};
use super::{ExportedFile, Exporter};
use crate::estimate::Verdict;
use crate::i18n::{Lang, Localize};
use crate::record::{
    ConditionStatus, LotCondition, LotFile, LotRecord, LotUnit, MeasurandRecord, ProcedureRecord,
    RecordingFile, RunRecord, SerialSource,
};
use crate::report::lot::{condition_reason, measurand_reason, reasons, several_channels};
use crate::report::translator::Translator;
use crate::report::{Document, Renderer, ReportError};
use chrono::DateTime;
use std::io;

/// The verdicts of a lot or of a run as `junit.xml`; of other results nothing.
pub struct Junit;

impl Exporter for Junit {
    fn id(&self) -> &'static str {
        "junit"
    }

    fn files(&self, document: &Document<'_>, _: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let text = match (document.lot(), document.run()) {
            (Some(record), _) => of_lot(record)?,
            (None, Some(run)) => match &run.procedure {
                Some(procedure) => of_run(run, procedure)?,
                None => return Ok(vec![]),
            },
            _ => return Ok(vec![]),
        };
        Ok(vec![ExportedFile::new("junit.xml", text)])
    }
}

/// A unit as the document has it.
struct Suite<'a> {
    serial: &'a str,
    properties: Vec<(&'static str, &'a str)>,
    cases: Vec<Case>,
}

/// A condition, a quantity with a limit, or the test as a whole.
struct Case {
    name: String,
    class: String,
    not_passed: Option<NotPassed>,
    remark: Option<String>,
}

/// Why a case is not passed.
struct NotPassed {
    outcome: Outcome,
    kind: &'static str,
    reason: String,
}

/// Outcomes other than a pass.
#[derive(Clone, Copy, PartialEq)]
enum Outcome {
    Failure,
    Error,
    Skipped,
}

impl Outcome {
    /// Name of its element in a case.
    fn element(self) -> &'static str {
        match self {
            Outcome::Failure => "failure",
            Outcome::Error => "error",
            Outcome::Skipped => "skipped",
        }
    }

    fn because(self, kind: &'static str, reason: String) -> NotPassed {
        NotPassed { outcome: self, kind, reason }
    }
}

fn of_lot(lot: &LotRecord) -> Result<Vec<u8>, ReportError> {
    let suites: Vec<Suite<'_>> = lot.units.iter().map(|unit| suite(unit, &lot.procedure.id)).collect();
    document(lot.procedure.title.text(), &lot.session.evaluated_at, &suites)
}

/// The document of a run of a procedure: one unit.
fn of_run(run: &RunRecord, procedure: &ProcedureRecord) -> Result<Vec<u8>, ReportError> {
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
    document(procedure.title.text(), &run.session.evaluated_at, &[suite(&unit, &procedure.id)])
}

fn document(title: &str, evaluated_at: &str, suites: &[Suite<'_>]) -> Result<Vec<u8>, ReportError> {
    let at = DateTime::parse_from_rfc3339(evaluated_at).ok();
    let at = at.map(|at| at.format("%Y-%m-%dT%H:%M:%S%.3f%:z").to_string());
    let all = suites.iter().flat_map(|suite| &suite.cases);
    xml_document(|xml| {
        counting(xml, "testsuites", title, all.collect(), at.as_deref(), |xml| {
            suites.iter().try_for_each(|suite| {
                let cases = suite.cases.iter().collect();
                counting(xml, "testsuite", suite.serial, cases, at.as_deref(), |xml| write_suite(xml, suite))
            })
        })
    })
}

/// An element that states how many cases it has and what came of them.
fn counting(
    xml: &mut Xml,
    element: &str,
    name: &str,
    cases: Vec<&Case>,
    at: Option<&str>,
    inner: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    let count = |outcome: Outcome| {
        let is = |case: &&&Case| case.not_passed.as_ref().is_some_and(|n| n.outcome == outcome);
        cases.iter().filter(is).count().to_string()
    };
    let tests = cases.len().to_string();
    let [skipped, failures, errors] = [Outcome::Skipped, Outcome::Failure, Outcome::Error].map(count);
    let mut attributes = vec![
        ("name", name),
        ("tests", &tests),
        ("skipped", &skipped),
        ("failures", &failures),
        ("errors", &errors),
    ];
    attributes.extend(at.map(|at| ("timestamp", at)));
    node(xml, element, &attributes, inner)
}

fn write_suite(xml: &mut Xml, suite: &Suite<'_>) -> io::Result<()> {
    if !suite.properties.is_empty() {
        node(xml, "properties", &[], |xml| {
            let property = |(name, value)| empty(xml, "property", &[("name", name), ("value", value)]);
            suite.properties.iter().copied().try_for_each(property)
        })?;
    }
    suite.cases.iter().try_for_each(|case| write_case(xml, case))
}

fn write_case(xml: &mut Xml, case: &Case) -> io::Result<()> {
    let attributes = [("name", case.name.as_str()), ("classname", case.class.as_str())];
    if case.not_passed.is_none() && case.remark.is_none() {
        return empty(xml, "testcase", &attributes);
    }
    node(xml, "testcase", &attributes, |xml| {
        if let Some(NotPassed { outcome, kind, reason }) = &case.not_passed {
            empty(xml, outcome.element(), &[("message", reason), ("type", kind)])?;
        }
        case.remark.iter().try_for_each(|remark| leaf(xml, "system-out", &[], remark))
    })
}

fn suite<'a>(unit: &'a LotUnit, procedure: &str) -> Suite<'a> {
    let mut properties = vec![
        ("verdict", unit.verdict.id()),
        ("serial_from", if unit.folder.is_empty() { "" } else { unit.serial_from.id() }),
        ("recording", unit.recording.as_str()),
        ("folder", unit.folder.as_str()),
    ];
    // A run on its own has no folder in a lot.
    properties.retain(|(_, value)| !value.is_empty());
    let of = |name: String, phase: Option<&str>, not_passed| {
        let parts = [Some(procedure), phase, Some(unit.serial())];
        let class = parts.into_iter().flatten().collect::<Vec<_>>().join(".");
        Case { name, class, not_passed, remark: None }
    };
    let several = several_channels(unit);
    let mut cases = vec![];
    for (i, c) in unit.conditions.iter().enumerate() {
        // Several instruments or channels have the same condition.
        let same = |other: &&LotCondition| other.id == c.id && other.phase == c.phase;
        let before = unit.conditions.iter().take(i).filter(same).count();
        let name = if before > 0 { format!("{}[{}]", c.id, before + 1) } else { c.id.clone() };
        let remark = c.message.as_ref().filter(|_| c.status == ConditionStatus::Remark);
        let remark = remark.map(|remark| remark.say(Lang::En));
        cases.push(Case { remark, ..of(name, c.phase.as_deref(), of_condition(c)) });
    }
    for m in &unit.measurands {
        let name = if several { format!("{}[{}]", m.id, m.channel) } else { m.id.clone() };
        cases.push(of(name, m.phase.as_deref(), of_measurand(m, several)));
    }
    cases.extend(of_whole(unit).map(|not_passed| of("test".to_owned(), None, Some(not_passed))));
    Suite { serial: unit.serial(), properties, cases }
}

fn of_condition(c: &LotCondition) -> Option<NotPassed> {
    let reason = condition_reason(c, Translator { lang: Lang::En });
    reason.map(|reason| Outcome::Skipped.because("condition", reason))
}

fn of_measurand(m: &MeasurandRecord, several_channels: bool) -> Option<NotPassed> {
    let reason = measurand_reason(m, several_channels, Translator { lang: Lang::En }).unwrap_or_default();
    match m.verdict {
        Verdict::Pass => None,
        Verdict::Fail => Some(Outcome::Failure.because("limit", reason)),
        Verdict::Error => Some(Outcome::Error.because("error", reason)),
        Verdict::Indeterminate | Verdict::None => Some(Outcome::Skipped.because("indeterminate", reason)),
    }
}

/// What the cases of a unit do not tell: that it could not be tested, or why nothing was decided.
fn of_whole(unit: &LotUnit) -> Option<NotPassed> {
    let sentences = || reasons(unit, Translator { lang: Lang::En }).join("\n");
    let undecided = unit.measurands.iter().any(|m| m.verdict == Verdict::Indeterminate)
        || unit.conditions.iter().any(|c| c.status == ConditionStatus::Invalid);
    match unit.verdict {
        Verdict::Error => Some(Outcome::Error.because("error", sentences())),
        Verdict::Indeterminate if !undecided => Some(Outcome::Skipped.because("indeterminate", sentences())),
        Verdict::None => Some(Outcome::Skipped.because("no_limits", sentences())),
        _ => None,
    }
}
