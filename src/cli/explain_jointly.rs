//! `sagnac explain A B ...`: what several recordings of one unit share, and what each shows besides.

use super::explain_args::{ExplainArgs, options, read, shown};
use super::inputs::Inputs;
use super::place::{self, OutputPlace};
use super::printer::Printer;
use super::progress::Progress;
use super::{exit, next_step};
use crate::config::model;
use crate::i18n::{Lang, Localize, Note};
use crate::ingest::{RecordingError, each_of};
use crate::mismatch::finding::MismatchVerdict;
use crate::mismatch::joint::{JointOutcome, JointProgress, Recording, explain_jointly};
use crate::moment;
use crate::output::Kind;
use crate::report::explain::Context;
use crate::report::joint::{JointContext, JointFile};
use crate::report::{Documented, ExplanationResults, JointResults, Results, page};
use chrono::SecondsFormat;
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
    let say = |note: Note| place::error(&note, lang);
    let Some(path) = args.model.as_deref() else {
        return Err(say("explain.error.several_need_model".into()));
    };
    let options = options(args).map_err(say)?;
    let writer = args.output.writer(lang)?;
    let claim = model::load(path).map_err(|p| p.say(lang))?;
    let now = moment::now();
    let out = OutputPlace::new(
        args.out.as_deref(),
        "explain",
        Some(claim.case.as_str()).filter(|c| !c.is_empty()),
        now,
    );
    let printer = Printer::new(&args.output, lang);
    let mut progress = printer.progress();
    progress.stage("progress.inputs");
    let folder = Inputs::new(args.output.force)
        .recording(&files, &args.read.options())
        .file("model", Some(path))
        .options(&(
            (&args.rate, &args.unit, args.sample_rate, &args.read),
            (&args.hide, &args.without, args.alpha, args.max_effects),
        ))
        .beside(args.output.templates.as_deref())
        .begin(&out, Kind::Joint, lang)?;

    let mut recordings = vec![];
    for (i, file) in files.iter().enumerate() {
        let series = read(args, std::slice::from_ref(file), &mut progress, lang)?;
        let folder = format!("recordings/{:02}-{}", i + 1, folder_name(file));
        recordings.push(Recording { name: shown(file), folder, series });
    }
    let remarks: Vec<Vec<Note>> = recordings.iter().map(|r| r.series.remarks()).collect();
    let count = files.len();
    let outcome = explain_jointly(recordings, &claim, &options, &mut |p| tell(p, count, &mut progress, lang));
    let outcome = outcome.map_err(|e| {
        let file = files.get(e.recording).map(|f| shown(f)).unwrap_or_default();
        say(Note::new("explain.error.of_recording").with("file", file).with("reason", e.note))
    })?;
    progress.stage("progress.writing");
    let explained_at = now.to_rfc3339_opts(SecondsFormat::Secs, true);
    let results = results(&outcome, shown(path), explained_at, remarks);
    let told = results.file.on_terminal(lang);
    let folder = writer.publish(&Results::Joint(Box::new(results)), folder)?;
    drop(progress);
    printer.outcome(&folder, Kind::Joint, |t| page::terminal(&told, t))?;
    let named = outcome.explanation.shared.first().map(|s| next_step::after_effect(&s.kind));
    printer.next_step(named.as_ref());
    Ok(match outcome.explanation.verdict {
        MismatchVerdict::Consistent => exit::PASS,
        MismatchVerdict::Mismatch => exit::FAIL,
        MismatchVerdict::UnknownMismatch => exit::INDETERMINATE,
    })
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
    let doing = Note::new("explain.progress.of_recording")
        .with("doing", Note::new(p.of.doing).say(lang))
        .with("k", recording + 1)
        .with("n", recordings);
    progress.update(&doing.say(lang), super::progress::Measure::Steps, p.of.done, p.of.total);
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
