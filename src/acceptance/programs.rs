//! Rows that programs of the user give, by the protocol `measurand/1`: a line of JSON in, a line of JSON out.
//!
//! A program whose file has another hash is not run. Whatever goes wrong with one leaves its own rows open and no other.

use super::derived::own_row;
use super::handed::{HandedFiles, Handing, fill};
use super::test_kind::{Progress, Reading, Run};
use crate::config::contained_files::folder_of;
use crate::config::procedure::EffectiveLimits;
use crate::config::program::ProgramSpec;
use crate::confined::{self, End, Ended, Kept, Reach, Task};
use crate::estimate::{Estimate, Spread};
use crate::i18n::{Note, io_reason, note};
use crate::output::sha256_of_file;
use crate::record::{MeasurandRecord, UnitUnderTest};
use crate::units::Unit;
use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;

/// Version of the protocol.
const PROTOCOL: &str = "measurand/1";

/// Method of these rows.
const METHOD: &str = "program";

/// Most that a program may answer, bytes.
const MAX_ANSWER_BYTES: usize = 1 << 20;

/// Most characters of a text of a program that are kept.
const MAX_TEXT_CHARACTERS: usize = 300;

/// What a program is asked.
#[derive(Serialize)]
struct Question<'a> {
    format: &'static str,
    program: &'a str,
    version: &'a str,
    procedure: Named<'a>,
    unit: &'a UnitUnderTest,
    returns: Vec<Returned<'a>>,
    /// Sample interval, s.
    sample_interval_s: f64,
    #[serde(flatten)]
    files: &'a HandedFiles,
    /// Folder in which the program may write.
    scratch: &'a Path,
}

/// A procedure by name.
#[derive(Serialize)]
struct Named<'a> {
    id: &'a str,
    revision: &'a str,
}

/// A quantity that is asked for.
#[derive(Serialize)]
struct Returned<'a> {
    id: &'a str,
    unit: &'a str,
}

/// What a program answers.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Answer {
    format: String,
    estimates: Vec<AnsweredEstimate>,
}

/// One quantity of an answer.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AnsweredEstimate {
    id: String,
    #[serde(default)]
    unit: Option<String>,
    #[serde(default)]
    value: Option<f64>,
    /// Lowest and highest value with 95 %.
    #[serde(default)]
    interval: Option<[f64; 2]>,
    #[serde(default)]
    standard_uncertainty: Option<f64>,
    /// Why there is no value.
    #[serde(default)]
    unresolved: Option<String>,
}

/// A quantity that a program gave, or did not give.
pub(super) struct Given<'p> {
    id: &'p str,
    unit: &'p Unit,
    estimate: Estimate,
}

/// Folders of one program.
struct Folders {
    /// Removed with all that is in it.
    whole: TempDir,
}

impl Folders {
    fn new() -> io::Result<Folders> {
        let folders = Folders { whole: tempfile::tempdir()? };
        std::fs::create_dir(folders.input())?;
        std::fs::create_dir(folders.scratch())?;
        Ok(folders)
    }

    /// What the program reads.
    fn input(&self) -> PathBuf {
        self.whole.path().join("input")
    }

    /// Where it may write.
    fn scratch(&self) -> PathBuf {
        self.whole.path().join("scratch")
    }
}

/// Runs the programs of a procedure on the evaluated part of a recording.
///
/// # Errors
/// Those of reading the recording once more.
pub(super) fn given<'r>(reading: &Reading<'r>, progress: Progress<'_>) -> Run<Vec<Given<'r>>> {
    let programs = &reading.request.procedure.programs;
    if programs.is_empty() {
        return Ok(vec![]);
    }
    let not_handed = |e: io::Error| note!("program.not_handed", reason = io_reason(&e));
    let mut ready: Vec<Result<(Folders, usize), Note>> = vec![];
    let mut handings: Vec<Handing> = vec![];
    for program in programs {
        let begun = checked(program).and_then(|()| {
            let folders = Folders::new().map_err(not_handed)?;
            let handing = Handing::begin(&folders.input(), &program.channels, reading).map_err(not_handed)?;
            Ok((folders, handing))
        });
        ready.push(begun.map(|(folders, handing)| {
            handings.push(handing);
            (folders, handings.len() - 1)
        }));
    }
    if !handings.is_empty() {
        fill(reading, &mut handings, progress)?;
    }
    let mut filled: Vec<Option<io::Result<HandedFiles>>> =
        handings.into_iter().map(|handing| Some(handing.end())).collect();
    let mut rows = vec![];
    for (program, ready) in programs.iter().zip(ready) {
        let answer = ready.and_then(|(folders, place)| {
            let files = filled.get_mut(place).and_then(Option::take);
            let files = files.unwrap_or_else(|| Err(io::ErrorKind::Other.into())).map_err(not_handed)?;
            answered(program, reading, &folders, &files)
        });
        rows.extend(estimates(program, answer));
    }
    Ok(rows)
}

/// The rows of what programs gave, judged by the limits that hold.
pub(super) fn rows(given: &[Given<'_>], limits: &EffectiveLimits) -> Vec<MeasurandRecord> {
    given.iter().map(|g| own_row(&g.estimate, g.id, g.unit, limits)).collect()
}

/// Compares the hash of a program with the stated one.
fn checked(program: &ProgramSpec) -> Result<(), Note> {
    let Some((_, path)) = &program.file else { return Err("program.not_beside".into()) };
    match sha256_of_file(path) {
        None => Err("program.unreadable".into()),
        Some(found) if found != program.sha256 => {
            Err(note!("program.hash", found, stated = program.sha256.as_str()))
        }
        Some(_) => Ok(()),
    }
}

/// Asks a program; gives its answer, and what it was kept from.
fn answered(
    program: &ProgramSpec,
    reading: &Reading<'_>,
    folders: &Folders,
    files: &HandedFiles,
) -> Result<(Answer, Kept), Note> {
    let ended = asked(program, reading, folders, files)?;
    let said = text(&ended.said);
    match ended.end {
        End::Late => return Err(note!("program.late", seconds = program.timeout_s)),
        End::TooMuch => return Err(note!("program.too_much", bytes = MAX_ANSWER_BYTES)),
        End::Own(status) if !status.success() => {
            let code = status.code().map_or_else(|| status.to_string(), |code| code.to_string());
            return Err(note!("program.failed", code, said));
        }
        End::Own(_) => {}
    }
    // A file that changed while it ran may not be the one that ran.
    checked(program)?;
    let garbage = |reason: String| note!("program.garbage", reason = text(&reason));
    let lines = std::str::from_utf8(&ended.out).map_err(|e| garbage(e.to_string()))?;
    let answer: Answer = serde_json::from_str(lines.trim()).map_err(|e| garbage(e.to_string()))?;
    if answer.format != PROTOCOL {
        return Err(note!("program.format", found = text(&answer.format), expected = PROTOCOL));
    }
    let is_asked = |id: &str| program.returns.iter().any(|(own, _)| own == id);
    if let Some(other) = answer.estimates.iter().find(|e| !is_asked(&e.id)) {
        return Err(note!("program.unknown_id", id = text(&other.id)));
    }
    let several = |id: &str| answer.estimates.iter().filter(|e| e.id == id).count() > 1;
    if let Some((id, _)) = program.returns.iter().find(|(id, _)| several(id)) {
        return Err(note!("program.answered_twice", id = id.as_str()));
    }
    Ok((answer, ended.kept))
}

/// Runs a program.
fn asked(
    program: &ProgramSpec,
    reading: &Reading<'_>,
    folders: &Folders,
    files: &HandedFiles,
) -> Result<Ended, Note> {
    let (place, path) = program.file.as_ref().ok_or_else(|| note!("program.not_beside"))?;
    let (input, scratch, home) = (folders.input(), folders.scratch(), folder_of(path));
    let procedure = reading.procedure();
    let question = Question {
        format: PROTOCOL,
        program: &program.id,
        version: &program.version,
        procedure: Named { id: &procedure.id, revision: &procedure.revision },
        unit: &reading.request.unit,
        returns: program.returns.iter().map(|(id, unit)| Returned { id, unit: unit.text() }).collect(),
        sample_interval_s: reading.tau0_s,
        files,
        scratch: &scratch,
    };
    let not_started = |e: io::Error| note!("program.not_started", reason = io_reason(&e));
    let mut line = serde_json::to_vec(&question).map_err(|e| not_started(e.into()))?;
    line.push(b'\n');
    let mut command: Vec<OsString> = program.command.iter().map(OsString::from).collect();
    if let Some(word) = command.get_mut(*place) {
        *word = path.into();
    }
    let mut read: Vec<&Path> = vec![home, &input];
    read.extend(program.reads.iter().map(PathBuf::as_path));
    confined::run(Task {
        command: &command,
        folder: home,
        input: line,
        patience: Duration::from_secs_f64(program.timeout_s),
        max_output_bytes: MAX_ANSWER_BYTES,
        reach: Reach { read: &read, write: &[&scratch] },
    })
    .map_err(not_started)
}

/// An estimate for every quantity of a program.
fn estimates<'p>(program: &'p ProgramSpec, answer: Result<(Answer, Kept), Note>) -> Vec<Given<'p>> {
    let own = note!(
        "program.own",
        program = program.id.as_str(),
        version = program.version.as_str(),
        sha256 = program.sha256.as_str()
    );
    let (answer, why, kept) = match answer {
        Ok((answer, kept)) => (Some(answer), None, Some(kept)),
        Err(why) => (None, Some(why), None),
    };
    let freedom = kept.and_then(|kept| match kept {
        Kept { files: false, .. } => Some(note!("program.not_confined")),
        Kept { network: false, .. } => Some(note!("program.network_open")),
        _ => None,
    });
    let given = |(id, unit): &'p (String, Unit)| {
        let answered = answer.as_ref().and_then(|a| a.estimates.iter().find(|e| e.id == *id));
        let found = match (&why, answered) {
            (Some(why), _) => Err(why.clone()),
            (None, None) => Err(note!("program.not_answered")),
            (None, Some(answered)) => estimate(answered, unit),
        };
        let not_shown = |why| Estimate::not_identifiable("", "", None, "", METHOD).note(why);
        let mut estimate = found.unwrap_or_else(not_shown).note(own.clone());
        estimate.notes.extend(freedom.clone());
        Given { id, unit, estimate }
    };
    program.returns.iter().map(given).collect()
}

/// An answered estimate in the unit of its row.
fn estimate(answered: &AnsweredEstimate, unit: &Unit) -> Result<Estimate, Note> {
    if let Some(reason) = &answered.unresolved {
        return Err(note!("program.unresolved", reason = text(reason)));
    }
    let (Some(value), Some(given)) = (answered.value, answered.unit.as_deref()) else {
        return Err("program.no_value".into());
    };
    let factor = Unit::parse(given).ok().and_then(|given| given.factor_to(unit).ok());
    let factor =
        factor.ok_or_else(|| note!("external.other_unit", given = text(given), unit = unit.text()))?;
    let spread = match (answered.interval, answered.standard_uncertainty) {
        (Some([low, high]), None) if low <= value && value <= high => {
            Spread::of_interval(factor * low, factor * value, factor * high)
        }
        (None, Some(standard)) if standard >= 0.0 => {
            Spread::Normal { standard_uncertainty: factor * standard }
        }
        (None, None) => return Err("program.no_interval".into()),
        _ => return Err("program.interval".into()),
    };
    Ok(Estimate::measured("", "", factor * value, "", spread, METHOD))
}

/// A text of a program, of bounded length.
fn text(of: &str) -> String {
    of.chars().take(MAX_TEXT_CHARACTERS).collect()
}
