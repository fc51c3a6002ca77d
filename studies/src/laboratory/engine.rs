//! The engine, as a caller of the library sees it.

use super::answer::Answer;
use super::case::Case;
use super::folder;
use sagnac::export::{Csv, Json};
use sagnac::{Error, Lang, Model, Recording, explain};
use std::path::Path;

/// What the engine says of a case, and its verdict with the augmented claim where that is asked for.
pub struct Said {
    /// The answer.
    pub answer: Answer,
    /// Verdict of the second explanation.
    pub again: Option<String>,
}

/// Explains a folder and leaves `explain.json`, `correction.csv` and `augmented.toml` in it; with `again`, also the verdict
/// of the explanation with `augmented.toml`, as `again.txt`.
///
/// # Errors
/// What the engine cannot read or explain, as text.
pub fn explain_folder(folder: &Path, again: bool) -> Result<(), String> {
    let say = |e: Error| format!("{}: {e}", folder.display());
    let recording = Recording::open(folder.join("recording.csv")).map_err(say)?;
    let model = Model::load(folder.join("model.toml")).map_err(say)?;
    let explanation = explain(&recording, &model).map_err(say)?;
    explanation.write(folder, &[&Json, &Csv], Lang::En).map_err(say)?;
    if again {
        let augmented = Model::load(folder.join("augmented.toml")).map_err(say)?;
        let second = explain(&recording, &augmented).map_err(say)?;
        std::fs::write(folder.join(AGAIN), second.verdict().id())
            .map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    Ok(())
}

/// File with the verdict of the second explanation.
pub const AGAIN: &str = "again.txt";

/// Explains a case through a folder, which is left to the caller.
///
/// # Errors
/// What cannot be written, read or explained, as text.
pub fn explain_case(case: &Case, at: &Path, again: bool) -> Result<Said, String> {
    let failed = |e: std::io::Error| format!("{}: {e}", case.truth.case);
    folder::write(case, at).map_err(failed)?;
    explain_folder(at, again)?;
    let answer = Answer::read(at).map_err(failed)?;
    let answer = answer.ok_or_else(|| format!("{}: no answer", case.truth.case))?;
    let again = again.then(|| std::fs::read_to_string(at.join(AGAIN)).map_err(failed)).transpose()?;
    Ok(Said { answer, again })
}
