//! `sagnac verify`: whether a folder of results is still what was written, and who signed it.

use super::options::renderer;
use super::{exit, place};
use crate::i18n::{Arg, Lang, Localize, Note, io_reason, note};
use crate::moment;
use crate::record;
use crate::report::signatures::row_name;
use crate::signing::{self, Signers};
use crate::verify::{
    Anew, Finding, Folder, Signing, anew, contents, pdf, run_of, signatures, stated_hashes,
    waits_for_recording,
};
use chrono::{DateTime, Utc};
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// Folder of results, its record, or a PDF on its own
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Recording to recompute the figures from, or those of the units of a lot; several files by repeating the option
    #[arg(long, value_name = "FILE")]
    recording: Vec<PathBuf>,
    /// Procedure of that computation [default: the copy in the folder]
    #[arg(long, value_name = "FILE", requires = "recording")]
    procedure: Option<PathBuf>,
    /// Limits of that computation [default: the copy in the folder]
    #[arg(long, value_name = "FILE", requires = "recording")]
    limits: Option<PathBuf>,
    /// Keys that may sign, as `allowed_signers` of OpenSSH: a line for each, its owner first
    #[arg(long, value_name = "FILE")]
    signers: Option<PathBuf>,
    /// Moment at which keys must be valid, such as 20260301 or 202603011200Z [default: now]
    #[arg(long, value_name = "TIME", requires = "signers")]
    at: Option<String>,
    /// Folder of the templates that the pages were made with
    #[arg(long, value_name = "DIR")]
    templates: Option<PathBuf>,
    /// Further options that the result was made with, behind `--`, such as `-- --taus all`
    #[arg(last = true, value_name = "OPTION", requires = "recording")]
    options: Vec<String>,
}

pub fn main(args: &VerifyArgs, lang: Lang) -> Result<u8, String> {
    let say = |note: Note| place::error(&note, lang);
    if args.folder.extension().is_some_and(|e| e == "pdf") && Folder::at(&args.folder).is_err() {
        return of_pdf(&args.folder, lang);
    }
    let folder = Folder::at(&args.folder).map_err(say)?;
    let signers = args.signers.as_deref().map(|path| read_signers(path, lang)).transpose()?;
    let at = moment(args.at.as_deref()).map_err(say)?;
    let mut findings = contents(&folder, &renderer(args.templates.as_deref(), lang)?);
    findings.extend(verdict_waived(&folder));
    if args.recording.is_empty() {
        if run_of(&folder).is_some_and(|run| !run.recording.is_empty()) {
            findings.push(Finding::Unchecked("verify.no_recording".into()));
        }
    } else {
        // What only the recording gives is computed from it below.
        findings.retain(|f| !waits_for_recording(f));
        let how = Anew {
            recording: &args.recording,
            procedure: args.procedure.as_deref(),
            limits: args.limits.as_deref(),
            templates: args.templates.as_deref(),
            options: &args.options,
        };
        findings.extend(anew(&folder, how));
    }
    findings.extend(signatures(&folder, Signing { signers: signers.as_ref(), at }));
    Ok(told(&findings, lang))
}

/// Says what was found; gives the exit code.
fn told(findings: &[Finding], lang: Lang) -> u8 {
    let count = |of: fn(&Finding) -> bool| findings.iter().filter(|f| of(f)).count();
    let wrong = count(Finding::differs);
    let undone = count(|f| matches!(f, Finding::Undone(_)));
    for finding in findings {
        let mark = match finding {
            Finding::Agrees(_) => "✓",
            Finding::Differs(_) => "✗",
            Finding::Undone(_) => "?",
            Finding::Unchecked(_) => "–",
        };
        place::print(&format!("{mark} {}\n", finding.note().say(lang)));
    }
    let (key, n, code) = match (wrong, undone) {
        (0, 0) => ("verify.whole", 0, exit::PASS),
        (0, _) => ("verify.incomplete", undone, exit::INDETERMINATE),
        _ => ("verify.broken", wrong, exit::FAIL),
    };
    place::print(&format!("{}\n", Note::new(key).with("n", n).say(lang)));
    code
}

/// A PDF on its own: it is typeset anew from what is attached to it.
fn of_pdf(path: &Path, lang: Lang) -> Result<u8, String> {
    let bytes = record::read::bytes(path).map_err(|e| place::error(&e.note(path), lang))?;
    let scratch = tempfile::tempdir().map_err(|_| place::error(&"verify.no_scratch".into(), lang))?;
    Ok(told(&pdf(&bytes, scratch.path()), lang))
}

/// The moment at which keys must be valid.
fn moment(given: Option<&str>) -> Result<DateTime<Utc>, Note> {
    match given {
        None => Ok(moment::now()),
        Some(text) => signing::moment(text).map_err(|_| note!("signing.moment", given = text)),
    }
}

/// Reads a list of signers; lines that are passed over are said.
fn read_signers(path: &Path, lang: Lang) -> Result<Signers, String> {
    let note = |key: &'static str| Note::new(key).with("path", place::shown(path));
    let signers = Signers::read(path)
        .map_err(|e| place::error(&note("signing.signers_unreadable").with("reason", io_reason(&e)), lang))?;
    for bad in &signers.passed_over {
        let why = Arg::Key(bad.fault.key().to_owned());
        let note = note("signing.signers_line").with("line", bad.line).with("why", why);
        place::eprint_diagnostic(&place::warning(&note, lang));
    }
    Ok(signers)
}

/// The verdict of a result beside the rows that signatures let pass in spite of it; the verdict stays what it is.
fn verdict_waived(folder: &Folder) -> Option<Finding> {
    let run = run_of(folder)?;
    let files = signing::files_of(&folder.path, stated_hashes(&folder.path).into_keys());
    let links = signing::chain(&folder.path, &files);
    let held = links.iter().filter(|link| link.broken.is_empty()).filter_map(|link| link.statement.as_ref());
    let rows: Vec<Arg> =
        held.flat_map(|statement| &statement.predicate.waivers).map(|w| row_name(&w.row)).collect();
    let note = note!("verify.verdict_waived", verdict = Arg::key("verdict", run.verdict.id()));
    (!rows.is_empty()).then(|| Finding::Unchecked(note.with("rows", Arg::Several(rows, "; ".into()))))
}
