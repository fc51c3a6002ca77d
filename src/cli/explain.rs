//! `sagnac explain`: where, and because of what, a recording differs from its simulation.

use super::explain_args::{ExplainArgs, options, read, shown};
use super::inputs::Inputs;
use super::place::{self, OutputPlace};
use super::printer::Printer;
use super::{exit, explain_jointly, next_step};
use crate::config::model;
use crate::effect::Column;
use crate::i18n::{Arg, EffectText, Lang, Note, effect_key};
use crate::ingest::{ReadOptions, are_several, files_read};
use crate::mismatch;
use crate::mismatch::finding::MismatchVerdict;
use crate::moment;
use crate::output::Kind;
use crate::report::explain::{Context, ExplainView};
use crate::report::{ExplanationResults, Results, terminal};
use chrono::SecondsFormat;
use std::path::{Path, PathBuf};

/// Explains a recording, or several together.
///
/// # Errors
/// The diagnostic, in words.
pub fn main(args: &ExplainArgs, lang: Lang) -> Result<u8, String> {
    if !args.join.join && are_several(&args.recording) {
        let files = explain_jointly::files(args, lang)?;
        if files.len() > 1 {
            return explain_jointly::main(args, files, lang);
        }
    }
    single(args, lang)
}

fn single(args: &ExplainArgs, lang: Lang) -> Result<u8, String> {
    let say = |note: Note| place::error(&note, lang);
    let simulation: Vec<PathBuf> = args.simulation.clone().into_iter().collect();
    args.join.check(&simulation, "join.help.other", lang)?;
    let options = options(args).map_err(say)?;
    let writer = args.output.writer(lang)?;
    // What is wrong with the model is said before a long recording is read.
    let stated = args.model.as_deref().map(model::load).transpose().map_err(|p| p.say(lang))?;
    let now = moment::now();
    let name = args.recording.first().map(|p| stem(p));
    let out = OutputPlace::new(args.out.as_deref(), "explain", name.as_deref(), now);
    let printer = Printer::new(&args.output, lang);
    let mut progress = printer.progress();
    progress.stage("progress.inputs");
    let folder = Inputs::new(args.output.force)
        .recording(&args.recording, &args.read.options())
        .file("model", args.model.as_deref())
        .files("simulation", &files_read(&simulation, &ReadOptions::default()))
        .options(&(
            (&args.rate, &args.unit, args.sample_rate, &args.read),
            (&args.hide, &args.without, args.alpha, args.max_effects),
        ))
        .beside(args.output.templates.as_deref())
        .begin(&out, Kind::Explanation, lang)?;

    let recording = read(args, &args.recording, &mut progress, lang)?;
    if let Some(given) = options.hide.iter().find(|c| c.is_other() && !recording.columns.contains_key(c)) {
        let others = recording.columns.keys().copied().filter(|c| c.is_other());
        let known: Vec<&str> = Column::KNOWN.into_iter().chain(others).map(Column::name).collect();
        let note = Note::new("explain.error.column").with("given", given.name());
        return Err(say(note.with("known", known.join(", "))));
    }
    let mut notes = recording.remarks();
    let (claim, outcome, named, identified) = match (stated, args.simulation.as_deref()) {
        (Some(claim), _) => {
            let path = args.model.as_deref().map(shown).unwrap_or_default();
            let outcome = mismatch::explain(recording, &claim, &options, &mut |p| progress.explaining(p));
            (claim, outcome.map_err(say)?, path, false)
        }
        (None, Some(simulation)) => {
            let series = read(args, &[simulation.to_owned()], &mut progress, lang)?;
            let taken =
                mismatch::explain_simulation(&recording, series, &options, &mut |p| progress.explaining(p));
            let taken = taken.map_err(say)?;
            if taken.same {
                notes.push("explain.note.same_samples".into());
            }
            if !taken.shared.is_empty() {
                let titles = taken.shared.iter().map(|e| Arg::Key(effect_key(e.kind(), EffectText::Title)));
                let titles = Arg::Several(titles.collect(), ", ".into());
                notes.push(Note::new("explain.note.shared").with("effects", titles));
            }
            (taken.claim, taken.outcome, shown(simulation), true)
        }
        (None, None) => return Err(say("explain.error.both".into())),
    };
    progress.stage("progress.writing");

    let context = Context {
        recording: args.recording.iter().map(|p| shown(p)).collect::<Vec<_>>().join(", "),
        claim: named,
        identified,
        description: Some(claim.description.clone()),
        explained_at: now.to_rfc3339_opts(SecondsFormat::Secs, true),
        correction: outcome.correction.is_some(),
        notes,
    };
    let view = ExplainView::new(&outcome.explanation, &[], &context, lang);
    let results = Results::Explanation(Box::new(ExplanationResults::new(&outcome, context)));
    let folder = writer.publish(&results, folder)?;
    drop(progress);
    printer.outcome(&folder, Kind::Explanation, |t| terminal::explanation(&view, lang, t))?;
    let named = view.effects.iter().find(|e| !e.unknown);
    printer.next_step(named.map(|e| next_step::after_effect(&e.kind)).as_ref());
    Ok(match outcome.explanation.verdict {
        MismatchVerdict::Consistent => exit::PASS,
        MismatchVerdict::Mismatch => exit::FAIL,
        MismatchVerdict::UnknownMismatch => exit::INDETERMINATE,
    })
}

/// The name of a file without its endings.
fn stem(path: &Path) -> String {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    name.split('.').find(|part| !part.is_empty()).unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_named_after_the_recording() {
        assert_eq!(stem(Path::new("a/unit-7.csv.gz")), "unit-7");
        assert_eq!(stem(Path::new(".hidden")), "hidden");
    }
}
