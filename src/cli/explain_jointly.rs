//! `sagnac explain A B ...`: what several recordings of one unit share, and what each shows besides.

use super::explain_args::{ExplainArgs, inputs, options, read_part, shown};
use super::job::{Frame, Job, Made, execute};
use super::next_step;
use super::place::{self, OutputPlace};
use super::progress::{Measure, Progress};
use crate::claim::Claim;
use crate::config::model;
use crate::i18n::{Lang, Localize, Note, note};
use crate::ingest::{RecordingError, each_of};
use crate::mismatch::Options;
use crate::mismatch::joint::{JointOutcome, JointProgress, Recording, explain_jointly};
use crate::output::{Kind, StagedFolder};
use crate::report::explain::Context;
use crate::report::joint::{JointContext, JointFile};
use crate::report::{ExplanationResults, JointResults, Results};
use std::path::{Path, PathBuf};

/// The files of the recordings that are named, patterns among them.
///
/// # Errors
/// The diagnostic of a pattern that matches nothing.
pub fn files(args: &ExplainArgs, lang: Lang) -> Result<Vec<PathBuf>, String> {
    let mut files = vec![];
    for named in &args.recording {
        files.extend(each_of(named).map_err(|e| RecordingError::from(e).say(lang))?);
    }
    Ok(files)
}

/// Explains several recordings together.
///
/// # Errors
/// The diagnostic, in words; it names the recording.
pub fn main(args: &ExplainArgs, files: Vec<PathBuf>, lang: Lang) -> Result<u8, String> {
    execute(&args.output, lang, |_| {
        let say = |note: Note| place::error(&note, lang);
        let model = args.model.clone().ok_or_else(|| say("explain.error.several_need_model".into()))?;
        let options = options(args).map_err(say)?;
        let claim = model::load(&model).map_err(|p| p.say(lang))?;
        Ok(ExplainingJointly { args, files, options, model, claim })
    })
}

/// The explanation of several recordings together.
struct ExplainingJointly<'a> {
    args: &'a ExplainArgs,
    files: Vec<PathBuf>,
    options: Options,
    model: PathBuf,
    claim: Claim,
}

impl Job for ExplainingJointly<'_> {
    fn begin(&self, frame: &Frame<'_>) -> Result<StagedFolder, String> {
        let case = Some(self.claim.case.as_str()).filter(|c| !c.is_empty());
        let out = OutputPlace::new(self.args.out.as_deref(), "explain", case, frame.now);
        inputs(self.args, &self.files, frame).begin(&out, Kind::Joint, frame.lang)
    }

    fn run(&self, _: &StagedFolder, frame: &mut Frame<'_>) -> Result<Made, String> {
        let lang = frame.lang;
        let mut recordings = vec![];
        for (i, file) in self.files.iter().enumerate() {
            let series = read_part(self.args, std::slice::from_ref(file), frame)?;
            let folder = format!("recordings/{:02}-{}", i + 1, folder_name(file));
            recordings.push(Recording { name: shown(file), folder, series });
        }
        let remarks: Vec<Vec<Note>> = recordings.iter().map(|r| r.series.remarks()).collect();
        let count = self.files.len();
        let progress = &mut |p| tell(p, count, &mut frame.progress, lang);
        let outcome = explain_jointly(recordings, &self.claim, &self.options, progress);
        let outcome = outcome.map_err(|e| {
            let file = self.files.get(e.recording).map(|f| shown(f)).unwrap_or_default();
            let note = note!("explain.error.of_recording", file);
            place::error(&note.with("reason", e.note), lang)
        })?;
        let results = results(&outcome, shown(&self.model), frame.stamp(), remarks);
        Ok(Results::Joint(Box::new(results)).into())
    }

    fn next_step(&self, results: &Results, _: &Path) -> Option<Note> {
        let Results::Joint(results) = results else { return None };
        results.file.explanation.shared.first().map(|s| next_step::after_effect(&s.kind))
    }
}

fn results(
    outcome: &JointOutcome,
    claim: String,
    explained_at: String,
    remarks: Vec<Vec<Note>>,
) -> JointResults {
    let each = outcome.recordings.iter().zip(&outcome.explanation.recordings).zip(remarks);
    let each = each.map(|((explained, recording), notes)| {
        let context = Context {
            recording: recording.name.clone(),
            claim: claim.clone(),
            explained_at: explained_at.clone(),
            correction: explained.correction.is_some(),
            notes,
            ..Context::default()
        };
        Some(ExplanationResults::new(explained, context))
    });
    JointResults {
        recordings: each.collect(),
        tables: vec![("augmented.toml".to_owned(), model::write(&outcome.augmented))],
        file: JointFile {
            explanation: outcome.explanation.clone(),
            context: JointContext { claim, explained_at, notes: vec![] },
        },
    }
}

/// Says how far the work is, and with which recording.
fn tell(p: JointProgress, recordings: usize, progress: &mut Progress, lang: Lang) {
    let Some(recording) = p.recording else { return progress.explaining(p.of) };
    let doing = note!(
        "explain.progress.of_recording",
        doing = Note::new(p.of.doing).say(lang),
        k = recording + 1,
        n = recordings
    );
    progress.update(&doing.say(lang), Measure::Steps, p.of.done, p.of.total);
}

/// The name of a file as a folder may have it.
fn folder_name(path: &Path) -> String {
    let name = path.file_stem().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let allowed = |c: char| if c.is_alphanumeric() || matches!(c, '-' | '_') { c } else { '-' };
    name.chars().map(allowed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_has_no_name_that_leads_out_of_it() {
        assert_eq!(folder_name(Path::new("a/unit 7.v2.csv")), "unit-7-v2");
        assert_eq!(folder_name(Path::new("..")), "");
    }
}
