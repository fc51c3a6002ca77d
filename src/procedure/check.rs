//! Validates procedures and limits files with no data.

use super::diagnostics::{Problem, Problems};
use super::limits::{LimitsFile, effective};
use super::load::{load, load_limits};
use super::model::{Loaded, Procedure};
use crate::ingest::manifest::{self, Manifest, is_manifest};
use crate::text::{Lang, Note};
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
}

/// Reads a file as what its first table says it is: a file with `[limits]` or `format = "limits/..."` is a limits file,
/// one with `format = "manifest/..."` a manifest, any other a procedure.
///
/// # Errors
/// Every problem of the file.
pub fn check(path: &Path) -> Result<Checked, Problems> {
    if is_manifest(path) {
        manifest::load(path).map(|m| Checked::Manifest(Box::new(m)))
    } else if is_limits(path) {
        load_limits(path).map(|l| Checked::Limits(Box::new(l)))
    } else {
        load(path).map(|p| Checked::Procedure(Box::new(p)))
    }
}

/// The result of checking several files, ready to be shown.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct CheckReport {
    /// One paragraph a file, problems first.
    pub text: String,
    /// Files that cannot be used.
    pub failed: usize,
}

/// Checks files one by one. With `limits`, each procedure is also checked against those limits.
pub fn check_report(paths: &[&Path], limits: Option<&Loaded<LimitsFile>>) -> CheckReport {
    check_report_with(paths, limits, |_, _| vec![])
}

/// As [`check_report`]; `extra` gives further warnings for a procedure with its limits, such as those of
/// [`super::power::warnings`].
pub fn check_report_with(
    paths: &[&Path],
    limits: Option<&Loaded<LimitsFile>>,
    extra: impl Fn(&Loaded<Procedure>, Option<&Loaded<LimitsFile>>) -> Vec<Problem>,
) -> CheckReport {
    let mut report = CheckReport::default();
    for path in paths {
        match check(path) {
            Ok(checked) => {
                let (sentence, warnings) = match &checked {
                    Checked::Procedure(p) => {
                        let mut warnings = p.warnings.clone();
                        warnings.extend(effective(p, limits).warnings);
                        warnings.extend(extra(p, limits));
                        (procedure_sentence(p), warnings)
                    }
                    Checked::Limits(l) => (limits_sentence(l), l.warnings.clone()),
                    Checked::Manifest(m) => (manifest_sentence(m), vec![]),
                };
                for warning in warnings {
                    report.text.push_str(&format!("{warning}\n"));
                }
                report.text.push_str(&format!("{}: {sentence}\n", path.display()));
            }
            Err(problems) => {
                report.failed += 1;
                let summary = count(problems.list.len(), "problem");
                report.text.push_str(&format!("{problems}\n{}: {summary}\n", path.display()));
            }
        }
    }
    report
}

fn count(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}

fn procedure_sentence(p: &Loaded<Procedure>) -> String {
    let p = &p.value;
    format!(
        "procedure `{}` revision {}: {}, {}, {}; sound",
        p.id,
        p.revision,
        count(p.channels.len(), "channel"),
        count(p.measurands.len(), "measurand"),
        count(p.limits.limits.len(), "limit")
    )
}

fn limits_sentence(l: &Loaded<LimitsFile>) -> String {
    let l = &l.value;
    format!(
        "limits `{}` revision {}: {}, {}; sound",
        l.id,
        l.revision,
        count(l.set.limits.len(), "limit"),
        count(l.set.references.len(), "reference value")
    )
}

fn manifest_sentence(m: &Manifest) -> String {
    Note::new("manifest.sound").with("count", m.files.len()).say(Lang::En)
}

/// True when the beginning of the file says that it holds limits. Nothing is reported here: reading does that.
fn is_limits(path: &Path) -> bool {
    let Ok(bytes) = super::load::bytes_of(path) else { return false };
    let text = String::from_utf8_lossy(&bytes);
    let mut lines = text.lines().map(str::trim);
    lines.any(|line| {
        line == "[limits]" || line.strip_prefix("format").is_some_and(|rest| rest.contains("\"limits/"))
    })
}
