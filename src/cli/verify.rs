//! `sagnac verify`: whether a folder of results is still what was written, and who signed it.

use super::options::renderer;
use super::{exit, place};
use crate::config::procedure::load;
use crate::i18n::{Lang, Localize, Note};
use crate::output::{Kind, LIMITS_FILE, PROCEDURE_FILE, sha256};
use crate::record::{self, RunKind, RunRecord};
use crate::signing::{self, Broken, Link, Role, SIGNATURES_FOLDER, Signers};
use crate::verify::{Finding, Folder, hashes, pages, pdf, stated_hashes, verdict};
use clap::Args;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// Folder of results, its record, or a PDF on its own
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Recording to compute the figures from anew; several files by repeating the option
    #[arg(long, value_name = "FILE")]
    recording: Vec<PathBuf>,
    /// Procedure of that computation [default: the copy in the folder]
    #[arg(long, value_name = "FILE", requires = "recording")]
    procedure: Option<PathBuf>,
    /// Keys that may sign, as `allowed_signers` of OpenSSH: a line for each, its owner first
    #[arg(long, value_name = "FILE")]
    signers: Option<PathBuf>,
    /// Folder of the templates that the pages were made with
    #[arg(long, value_name = "DIR")]
    templates: Option<PathBuf>,
}

pub fn main(args: &VerifyArgs, lang: Lang) -> Result<u8, String> {
    let say = |note: Note| place::error(&note, lang);
    if args.folder.extension().is_some_and(|e| e == "pdf") && Folder::at(&args.folder).is_err() {
        return of_pdf(&args.folder, lang);
    }
    let folder = Folder::at(&args.folder).map_err(say)?;
    let signers = args.signers.as_deref().map(|path| read_signers(path, lang)).transpose()?;
    let mut findings = hashes(&folder, SIGNATURES_FOLDER);
    findings.extend(pages(&folder, &renderer(args.templates.as_deref(), lang)?));
    let run: Option<RunRecord> = match folder.kind {
        Kind::Result => record::read::open(&folder.record_file()).ok(),
        _ => None,
    };
    if let Some(run) = &run {
        findings.extend(verdict(run));
        findings.extend(texts(&folder.path, run));
    }
    if !args.recording.is_empty() {
        findings.extend(anew(args, &folder, run.as_ref())?);
    } else if run.as_ref().is_some_and(|r| !r.recording.is_empty()) {
        findings.push(Finding::Unchecked("verify.no_recording".into()));
    }
    let required = required(&folder.path);
    findings.extend(signatures(&folder.path, signers.as_ref(), &required));
    Ok(told(&findings, lang))
}

/// Says what was found; gives the exit code.
fn told(findings: &[Finding], lang: Lang) -> u8 {
    let wrong = findings.iter().filter(|f| f.differs()).count();
    for finding in findings {
        let (mark, note) = match finding {
            Finding::Agrees(note) => ("✓", note),
            Finding::Differs(note) => ("✗", note),
            Finding::Unchecked(note) => ("–", note),
        };
        place::print(&format!("{mark} {}\n", note.say(lang)));
    }
    let total = Note::new(if wrong == 0 { "verify.whole" } else { "verify.broken" }).with("n", wrong);
    place::print(&format!("{}\n", total.say(lang)));
    if wrong == 0 { exit::PASS } else { exit::FAIL }
}

/// A PDF on its own: it is typeset anew from what is attached to it.
fn of_pdf(path: &Path, lang: Lang) -> Result<u8, String> {
    let bytes = record::read::bytes(path).map_err(|e| place::error(&e.note(path), lang))?;
    let scratch = tempfile::tempdir().map_err(|_| place::error(&"verify.no_scratch".into(), lang))?;
    Ok(told(&pdf(&bytes, scratch.path()), lang))
}

fn read_signers(path: &Path, lang: Lang) -> Result<Signers, String> {
    Signers::read(path).map_err(|(line, why)| {
        let note = Note::new(if line == 0 { "signing.signers_unreadable" } else { "signing.signers_line" });
        let note = note.with("path", place::shown(path)).with("line", line).with("reason", why);
        place::error(&note, lang)
    })
}

/// The copies of procedure and limits against the hashes in the record.
fn texts(folder: &Path, run: &RunRecord) -> Vec<Finding> {
    let Some(procedure) = &run.procedure else { return vec![] };
    let limits = procedure.limits.as_ref().map(|l| (LIMITS_FILE, &l.sha256));
    std::iter::once((PROCEDURE_FILE, &procedure.sha256))
        .chain(limits)
        .filter_map(|(name, stated)| {
            let bytes = std::fs::read(folder.join(name)).ok()?;
            let note = Note::new("verify.not_that_text").with("name", name);
            (sha256(&bytes) != *stated).then_some(Finding::Differs(note))
        })
        .collect()
}

/// The roles that the procedure of a folder asks to sign.
fn required(folder: &Path) -> Vec<Role> {
    let path = folder.join(PROCEDURE_FILE);
    if !path.is_file() {
        return vec![];
    }
    load(&path).map(|p| p.value.report.signatures).unwrap_or_default()
}

/// The signatures of a folder, and whether those that the procedure asks for are there.
fn signatures(folder: &Path, signers: Option<&Signers>, required: &[Role]) -> Vec<Finding> {
    let files = signing::files_of(folder, stated_hashes(folder).into_keys());
    let links = signing::chain(folder, &files);
    let mut findings: Vec<Finding> = links.iter().flat_map(|link| of_link(link, signers)).collect();
    let mut used: Vec<String> = vec![];
    for role in required {
        let own = |l: &&Link| {
            let good = l.broken.is_empty() && l.role() == Some(*role);
            good && l.fingerprint().is_some_and(|f| !used.contains(&f))
        };
        match links.iter().find(own).and_then(Link::fingerprint) {
            Some(fingerprint) => used.push(fingerprint),
            None => findings.push(Finding::Differs(
                Note::new("verify.role_missing").with("role", crate::i18n::Arg::key("signer", role.id())),
            )),
        }
    }
    findings
}

fn of_link(link: &Link, signers: Option<&Signers>) -> Vec<Finding> {
    let name = || link.name.clone();
    if !link.broken.is_empty() {
        let broken = |b: &Broken| {
            let note = |key: &'static str| Note::new(key).with("name", name());
            Finding::Differs(match b {
                Broken::NoStatement => note("verify.link.no_statement"),
                Broken::Unsigned => note("verify.link.unsigned"),
                Broken::Signature(why) => note("verify.link.signature").with("reason", why.as_str()),
                Broken::Rewritten => note("verify.link.rewritten"),
                Broken::File(file) => note("verify.link.file").with("file", file.as_str()),
                Broken::Unsaid(file) => note("verify.link.unsaid").with("file", file.as_str()),
                Broken::Previous => note("verify.link.previous"),
            })
        };
        return link.broken.iter().map(broken).collect();
    }
    let (Some(statement), Some(key)) = (&link.statement, &link.key) else { return vec![] };
    let said = &statement.predicate;
    let note = |key_name: &'static str| {
        Note::new(key_name)
            .with("name", name())
            .with("role", crate::i18n::Arg::key("signer", said.role.id()))
            .with("at", crate::report::number::date_time(&said.signed_at))
            .with("key", link.fingerprint().unwrap_or_default())
    };
    let mut findings = vec![match signers.map(|s| s.owner(key)) {
        Some(Some(owner)) => Finding::Agrees(note("verify.signed_by").with("owner", owner)),
        Some(None) => Finding::Differs(note("verify.signed_by_stranger")),
        None => {
            let named = said.name.clone();
            Finding::Agrees(match named {
                Some(named) => note("verify.signed_as").with("owner", named),
                None => note("verify.signed"),
            })
        }
    }];
    findings.extend(said.waivers.iter().map(|w| {
        Finding::Unchecked(
            Note::new("verify.waived")
                .with("name", name())
                .with("row", w.row.as_str())
                .with("reason", w.reason.as_str()),
        )
    }));
    findings
}

/// Computes the result from the recording anew, in a process of its own, and compares what was measured.
///
/// # Errors
/// The diagnostic where there is nothing to compute from.
fn anew(args: &VerifyArgs, folder: &Folder, run: Option<&RunRecord>) -> Result<Vec<Finding>, String> {
    let Some(run) = run else { return Ok(vec![Finding::Unchecked("verify.not_computed".into())]) };
    let unchecked = |note: Note| Ok(vec![Finding::Unchecked(note)]);
    let Ok(scratch) = tempfile::tempdir() else { return unchecked("verify.no_scratch".into()) };
    let Ok(program) = std::env::current_exe() else { return unchecked("verify.no_scratch".into()) };
    let mut command = Command::new(program);
    match run.kind {
        RunKind::Run => {
            let procedure = args.procedure.clone().unwrap_or_else(|| folder.path.join(PROCEDURE_FILE));
            // The settings of the user may name a store, which must not keep this check as another attempt.
            command.arg("run").arg(procedure).args(&args.recording).arg("--no-store");
            let limits = folder.path.join(LIMITS_FILE);
            if run.procedure.as_ref().is_some_and(|p| p.limits.is_some()) && limits.is_file() {
                command.arg("--limits").arg(limits);
            }
        }
        RunKind::Analyze => {
            command.arg("analyze").args(&args.recording);
        }
    }
    if let Some(serial) = &run.unit_under_test.serial {
        command.args(["--serial", serial]);
    }
    let out = scratch.path().join("anew");
    command.arg("--out").arg(&out).arg("--quiet");
    let ran = command.output();
    let made = std::fs::read(out.join(Kind::Result.record_file())).ok();
    let made: Option<Value> = made.and_then(|bytes| serde_json::from_slice(&bytes).ok());
    let Some(made) = made else {
        let said = ran.map(|o| String::from_utf8_lossy(&o.stderr).trim().to_owned()).unwrap_or_default();
        return Ok(vec![Finding::Differs(Note::new("verify.cannot_compute").with("reason", said))]);
    };
    let bytes = std::fs::read(folder.record_file()).unwrap_or_default();
    let stated: Value = serde_json::from_slice(&bytes).unwrap_or_default();
    Ok(compare(&stated, &made))
}

/// A record without the places from which limits were read: a copy stands elsewhere.
fn without_paths(record: &Value) -> Value {
    let mut record = record.clone();
    for row in record["measurands"].as_array_mut().into_iter().flatten() {
        if let Some(limit) = row["limit"].as_object_mut() {
            limit.remove("source");
        }
    }
    record
}

/// What two records of the same test say of the same recording.
fn compare(stated: &Value, made: &Value) -> Vec<Finding> {
    let hashes = |record: &Value| -> Vec<String> {
        let files = record["recording"].as_array().cloned().unwrap_or_default();
        files.iter().map(|f| f["sha256"].as_str().unwrap_or_default().to_owned()).collect()
    };
    if hashes(stated) != hashes(made) {
        return vec![Finding::Differs("verify.other_recording".into())];
    }
    let inputs = |record: &Value| -> BTreeMap<String, String> {
        serde_json::from_value(record["inputs"].clone()).unwrap_or_default()
    };
    let (own, other) = (inputs(stated), inputs(made));
    let unlike: Vec<&str> = own
        .keys()
        .chain(other.keys())
        .filter(|name| own.get(*name) != other.get(*name))
        .map(String::as_str)
        .collect();
    if !unlike.is_empty() {
        let note = Note::new("verify.other_inputs").with("names", unlike.join(", "));
        return vec![Finding::Unchecked(note)];
    }
    let versions = [&stated["program"]["version"], &made["program"]["version"]];
    let version = |i: usize| versions[i].as_str().unwrap_or_default().to_owned();
    let (stated, made) = (without_paths(stated), without_paths(made));
    let differing: Vec<&str> = ["verdict", "measurands", "noise_models", "conditions"]
        .into_iter()
        .filter(|k| stated[k] != made[k])
        .collect();
    let n = stated["measurands"].as_array().map_or(0, Vec::len);
    match (differing.is_empty(), version(0) == version(1)) {
        (true, _) => vec![Finding::Agrees(Note::new("verify.computed").with("n", n))],
        (false, true) => {
            vec![Finding::Differs(Note::new("verify.computed_differs").with("names", differing.join(", ")))]
        }
        (false, false) => vec![Finding::Unchecked(
            Note::new("verify.computed_by_other").with("written", version(0)).with("this", version(1)),
        )],
    }
}
