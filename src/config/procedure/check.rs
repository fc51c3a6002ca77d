//! Validates procedures and limits files with no data.

use super::diagnostics::{Problem, Problems};
use super::limits::{LimitsFile, effective};
use super::load::{load, load_limits};
use super::model::{Loaded, Procedure};
use super::pairs::{self, Answer, LengthAnswer};
use super::phases::{Phase, Phased, is_phased, load_phased};
use super::tables::acceleration;
use crate::config::layout;
use crate::config::manifest::{self, Manifest, is_manifest};
use crate::config::model;
use crate::config::text_file;
use crate::i18n::{Arg, Lang, LocalText, Localize, Note, note, visible};
use crate::measurand;
use sagnac_ingest::layout::Layout;
use std::path::Path;

/// What a file turned out to be.
#[derive(Debug, Clone, PartialEq)]
pub enum Checked {
    /// A sound procedure.
    Procedure(Box<Loaded<Procedure>>),
    /// A sound limits file.
    Limits(Box<Loaded<LimitsFile>>),
    /// A manifest whose files are there and what it says.
    Manifest(Box<Manifest>),
    /// A layout of raw binary records.
    Layout(Box<Layout>),
    /// A sound procedure of several phases, whose procedures are sound too.
    Phased(Box<Phased>),
}

/// Reads a file as what its first table says it is, and every file that it names: a file with `[limits]` or `format = "limits/..."` is a limits file,
/// one with `format = "manifest/..."` a manifest, one with `format = "layout/..."` a layout, any other a procedure.
///
/// # Errors
/// Every problem of the file.
pub fn check(path: &Path) -> Result<Checked, Problems> {
    if is_manifest(path) {
        let manifest = manifest::load(path)?;
        manifest.options.layout.as_ref().map(|l| layout::load(&l.path)).transpose()?;
        Ok(Checked::Manifest(Box::new(manifest)))
    } else if says(path, |line| line.strip_prefix("format").is_some_and(|rest| rest.contains("\"layout/"))) {
        layout::load(path).map(|l| Checked::Layout(Box::new(l)))
    } else if is_phased(path) {
        let phased = load_phased(path)?;
        all_named(phased.phases.iter().map(|p| &p.procedure.value))?;
        Ok(Checked::Phased(Box::new(phased)))
    } else if is_limits(path) {
        load_limits(path).map(|l| Checked::Limits(Box::new(l)))
    } else {
        let procedure = load(path)?;
        all_named([&procedure.value].into_iter())?;
        Ok(Checked::Procedure(Box::new(procedure)))
    }
}

/// Reads every file that procedures name: a procedure whose layout or model is missing or wrong cannot be used.
fn all_named<'a>(procedures: impl Iterator<Item = &'a Procedure>) -> Result<(), Problems> {
    let mut found = Problems::default();
    for p in procedures {
        let layout = p.recording.read.layout.as_ref().map(|l| layout::load(&l.path)).and_then(Result::err);
        let model = p.explain.as_ref().map(|e| model::load(&e.model)).and_then(Result::err);
        found.list.extend([layout, model].into_iter().flatten().flat_map(|problems| problems.list));
    }
    if found.has_errors() { Err(found) } else { Ok(()) }
}

/// The result of checking several files, ready to be shown.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct CheckReport {
    /// A line for each file, its problems before it; the counts at the end where there are several.
    pub text: String,
    /// Files that cannot be used.
    pub failed: usize,
}

/// Checks files one by one, and each limits file with the procedures among them that it belongs to. `answer` says which
/// limits cannot be decided, `length` how long a record must be for slow terms.
pub fn check_report(
    paths: &[&Path],
    lang: Lang,
    answer: Answer<'_>,
    length: LengthAnswer<'_>,
) -> CheckReport {
    let checked: Vec<(&Path, Result<Checked, Problems>)> = paths.iter().map(|p| (*p, check(p))).collect();
    let procedures: Vec<&Loaded<Procedure>> = checked
        .iter()
        .filter_map(|(_, c)| match c {
            Ok(Checked::Procedure(p)) => Some(&**p),
            _ => None,
        })
        .collect();
    let mut report = CheckReport::default();
    let mut told: Vec<Problem> = vec![];
    for (path, found) in &checked {
        let name = visible(&path.display().to_string()).into_owned();
        match found {
            Ok(checked) => {
                for warning in warnings(checked, &procedures, answer) {
                    if told.contains(&warning) {
                        continue;
                    }
                    report.text.push_str(&format!("{}\n", warning.say(lang)));
                    told.push(warning);
                }
                let said: Vec<String> = sentences(checked, &procedures).iter().map(|s| s.say(lang)).collect();
                report.text.push_str(&format!("{name}: {}\n", said.join("; ")));
                for told in lengths(checked, &procedures, length) {
                    report.text.push_str(&format!("  {}\n", told.say(lang)));
                }
            }
            Err(problems) => {
                report.failed += 1;
                let summary = count(problems.list.len(), "check.one_problem", "check.problems").say(lang);
                report.text.push_str(&format!("{}\n{name}: {summary}\n", problems.say(lang)));
            }
        }
    }
    if paths.len() > 1 {
        let total = note!("check.total", files = paths.len(), failed = report.failed);
        report.text.push_str(&format!("{}\n", total.with("warnings", told.len()).say(lang)));
    }
    report
}

/// Remarks on a sound file.
fn warnings(checked: &Checked, procedures: &[&Loaded<Procedure>], answer: Answer<'_>) -> Vec<Problem> {
    match checked {
        Checked::Procedure(p) => p.warnings.iter().cloned().chain(pairs::of_procedure(p, answer)).collect(),
        Checked::Limits(l) => {
            l.warnings.iter().cloned().chain(pairs::of_limits(l, procedures, answer)).collect()
        }
        Checked::Manifest(_) | Checked::Layout(_) => vec![],
        Checked::Phased(p) => p.phases.iter().flat_map(of_phase).collect(),
    }
}

/// How long a record must be for the slow terms that a sound file limits or gives typical values for.
fn lengths(checked: &Checked, procedures: &[&Loaded<Procedure>], length: LengthAnswer<'_>) -> Vec<Note> {
    match checked {
        Checked::Procedure(p) => pairs::lengths_of_procedure(p, length),
        Checked::Limits(l) => pairs::lengths_of_limits(l, procedures, length),
        Checked::Manifest(_) | Checked::Layout(_) | Checked::Phased(_) => vec![],
    }
}

/// Description of a sound file, in clauses.
fn sentences(checked: &Checked, procedures: &[&Loaded<Procedure>]) -> Vec<Note> {
    match checked {
        Checked::Procedure(p) => std::iter::once(procedure_sentence(p))
            .chain(determined_terms(p))
            .chain(nameless_instruments([&**p]))
            .collect(),
        Checked::Limits(l) => {
            let names: Vec<&str> =
                pairs::belonging(&l.value, procedures).iter().map(|p| p.value.id.as_str()).collect();
            let with = note!("check.with_procedures", names = names.join(", "));
            std::iter::once(limits_sentence(l)).chain((!names.is_empty()).then_some(with)).collect()
        }
        Checked::Manifest(m) => vec![manifest_sentence(m)],
        Checked::Layout(l) => vec![layout_sentence(l)],
        Checked::Phased(p) => {
            let nameless = nameless_instruments(p.phases.iter().map(|phase| &phase.procedure));
            std::iter::once(phased_sentence(p)).chain(nameless).collect()
        }
    }
}

/// The instruments of procedures that nobody can find again, each once.
fn nameless_instruments<'a>(procedures: impl IntoIterator<Item = &'a Loaded<Procedure>>) -> Option<Note> {
    let mut names: Vec<&LocalText> = vec![];
    for instrument in procedures.into_iter().flat_map(|p| &p.value.instruments) {
        let nameless = instrument.serial.as_deref().is_none_or(|s| s.trim().is_empty());
        if nameless && !names.contains(&&instrument.name) {
            names.push(&instrument.name);
        }
    }
    let list: Vec<Arg> = names.into_iter().map(|name| Arg::from(name.clone())).collect();
    (!list.is_empty()).then(|| note!("check.no_serial", names = Arg::Several(list, ", ".into())))
}

/// Warnings about a phase: what its own files say, and that no verdict can come from them.
fn of_phase(phase: &Phase) -> Vec<Problem> {
    let mut found = phase.procedure.warnings.clone();
    let effective = effective(&phase.procedure, phase.limits.as_ref());
    found.extend(effective.warnings);
    let unjudged = (effective.set.count() == 0)
        .then(|| note!("check.no_limits", procedure = phase.procedure.value.id.as_str()));
    let path = phase.limits.as_ref().map_or(phase.procedure.path.as_str(), |l| l.path.as_str());
    found.extend(effective.idle.or(unjudged).map(|note| Problem::remark_on_file(path, note)));
    found
}

/// A count with its noun: one key for one, another for any other number.
fn count(n: usize, one: &'static str, several: &'static str) -> Note {
    if n == 1 { Note::new(one) } else { Note::new(several).with("n", n) }
}

fn procedure_sentence(p: &Loaded<Procedure>) -> Note {
    let p = &p.value;
    let key = if p.limits.count() == 0 { "check.procedure_no_limits" } else { "check.procedure" };
    Note::new(key)
        .with("id", p.id.as_str())
        .with("revision", p.revision.as_str())
        .with("channels", count(p.channels.len(), "check.one_channel", "check.channels"))
        .with("measurands", count(p.measurands.len(), "check.one_measurand", "check.measurands"))
        .with("limits", count(p.limits.count(), "check.one_limit", "check.limits"))
}

/// What positions in the field of gravity determine.
fn determined_terms(p: &Loaded<Procedure>) -> Vec<Note> {
    let expected = &p.value.limits.expected;
    let n = expected.iter().find(|e| *e.measurand == measurand::ANGLE_RANDOM_WALK).map(|e| e.value);
    let test = p.value.acceleration_test.as_ref();
    test.map_or_else(Vec::new, |test| acceleration::determined(test, n))
}

fn limits_sentence(l: &Loaded<LimitsFile>) -> Note {
    let l = &l.value;
    let key = if l.set.count() == 0 { "check.limits_file_no_limits" } else { "check.limits_file" };
    Note::new(key)
        .with("id", l.id.as_str())
        .with("revision", l.revision.as_str())
        .with("limits", count(l.set.count(), "check.one_limit", "check.limits"))
        .with("references", count(l.set.references.len(), "check.one_reference", "check.references"))
}

fn manifest_sentence(m: &Manifest) -> Note {
    note!("manifest.sound", count = m.files.len())
}

fn layout_sentence(l: &Layout) -> Note {
    note!("layout.sound", bytes = l.record_bytes, count = l.names().count())
}

fn phased_sentence(p: &Phased) -> Note {
    let phases: Vec<&str> = p.phases.iter().map(|phase| phase.id.as_str()).collect();
    note!(
        "phases.sound",
        id = p.identity.id.as_str(),
        revision = p.identity.revision.as_str(),
        phases = phases.join(", ")
    )
}

/// True when the file says that it holds limits.
fn is_limits(path: &Path) -> bool {
    says(path, |line| {
        line == "[limits]" || line.strip_prefix("format").is_some_and(|rest| rest.contains("\"limits/"))
    })
}

/// True when a line of a file is as wanted. Nothing is reported here: reading does that.
fn says(path: &Path, wanted: impl Fn(&str) -> bool) -> bool {
    text_file::peek(path).is_some_and(|text| text.lines().map(str::trim).any(wanted))
}
