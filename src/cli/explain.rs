//! `sagnac explain`: where, and because of what, a recording differs from its simulation.

use super::explain_args::{ExplainArgs, inputs, options, read, read_part, shown};
use super::job::{Frame, Job, Made, execute};
use super::place::{self, OutputPlace};
use super::{explain_jointly, next_step};
use crate::claim::Claim;
use crate::config::model;
use crate::effect::Column;
use crate::i18n::{Arg, EffectText, Lang, Note, effect_key, note};
use crate::ingest::{ReadOptions, are_several, files_read};
use crate::mismatch::{self, Options, Outcome};
use crate::output::{Kind, StagedFolder};
use crate::report::explain::Context;
use crate::report::{ExplanationResults, Results};
use crate::series::Series;
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
    execute(&args.output, lang, |_| {
        args.join.check(args.simulation.as_slice(), "join.help.other", lang)?;
        let options = options(args).map_err(|note| place::error(&note, lang))?;
        // A mistake in the model is said before a long recording is read.
        let stated = args.model.as_deref().map(model::load).transpose().map_err(|p| p.say(lang))?;
        Ok(Explaining { args, options, stated })
    })
}

/// The explanation of one recording.
struct Explaining<'a> {
    args: &'a ExplainArgs,
    options: Options,
    /// The claim of the model; `None` where it is identified from a simulation.
    stated: Option<Claim>,
}

/// A recording beside a claim.
struct Explained {
    claim: Claim,
    /// The file that the claim comes from.
    claim_file: String,
    /// True where the claim was identified from a simulated recording.
    identified: bool,
    outcome: Outcome,
}

impl Job for Explaining<'_> {
    fn begin(&self, frame: &Frame<'_>) -> Result<StagedFolder, String> {
        let args = self.args;
        let name = args.recording.first().map(|p| stem(p));
        let out = OutputPlace::new(args.out.as_deref(), "explain", name.as_deref(), frame.now);
        let simulation = files_read(args.simulation.as_slice(), &ReadOptions::default());
        let inputs = inputs(args, &args.recording, frame).files("simulation", &simulation);
        inputs.begin(&out, Kind::Explanation, frame.lang)
    }

    fn run(&self, _: &StagedFolder, frame: &mut Frame<'_>) -> Result<Made, String> {
        let (args, lang) = (self.args, frame.lang);
        let recording = read_part(args, &args.recording, frame)?;
        let hidden = &self.options.hide;
        if let Some(given) = hidden.iter().find(|c| c.is_other() && !recording.columns.contains_key(c)) {
            let others = recording.columns.keys().copied().filter(|c| c.is_other());
            let known: Vec<&str> = Column::KNOWN.into_iter().chain(others).map(Column::name).collect();
            let note = note!("explain.error.column", given = given.name());
            return Err(place::error(&note.with("known", known.join(", ")), lang));
        }
        let mut notes = recording.remarks();
        let explained = match (&self.stated, &args.simulation) {
            (Some(claim), _) => self.by_model(recording, claim, frame)?,
            (None, Some(simulation)) => self.by_simulation(&recording, simulation, &mut notes, frame)?,
            (None, None) => return Err(place::error(&"explain.error.both".into(), lang)),
        };
        let outcome = explained.outcome;
        let context = Context {
            recording: args.recording.iter().map(|p| shown(p)).collect::<Vec<_>>().join(", "),
            claim: explained.claim_file,
            identified: explained.identified,
            description: Some(explained.claim.description),
            explained_at: frame.stamp(),
            correction: outcome.correction.is_some(),
            notes,
        };
        Ok(Results::Explanation(Box::new(ExplanationResults::new(&outcome, context))).into())
    }

    fn next_step(&self, results: &Results, _: &Path) -> Option<Note> {
        let Results::Explanation(results) = results else { return None };
        let named = results.file.explanation.effects.iter().find(|e| !e.is_unnamed());
        named.map(|e| next_step::after_effect(&e.kind))
    }
}

impl Explaining<'_> {
    fn by_model(&self, recording: Series, claim: &Claim, frame: &mut Frame<'_>) -> Result<Explained, String> {
        let progress = &mut |p| frame.progress.explaining(p);
        let outcome = mismatch::explain(recording, claim, &self.options, progress);
        Ok(Explained {
            claim: claim.clone(),
            claim_file: self.args.model.as_deref().map(shown).unwrap_or_default(),
            identified: false,
            outcome: outcome.map_err(|note| place::error(&note, frame.lang))?,
        })
    }

    /// Identifies the claim from a simulated recording; `notes` gets what must be known of the two.
    fn by_simulation(
        &self,
        recording: &Series,
        simulation: &PathBuf,
        notes: &mut Vec<Note>,
        frame: &mut Frame<'_>,
    ) -> Result<Explained, String> {
        let series = read(self.args, std::slice::from_ref(simulation), frame)?;
        let progress = &mut |p| frame.progress.explaining(p);
        let taken = mismatch::explain_simulation(recording, series, &self.options, progress);
        let taken = taken.map_err(|note| place::error(&note, frame.lang))?;
        if taken.same {
            notes.push("explain.note.same_samples".into());
        }
        if !taken.shared.is_empty() {
            let titles = taken.shared.iter().map(|e| Arg::Key(effect_key(e.kind(), EffectText::Title)));
            let titles = Arg::Several(titles.collect(), ", ".into());
            notes.push(note!("explain.note.shared", effects = titles));
        }
        let (claim, outcome) = (taken.claim, taken.outcome);
        Ok(Explained { claim, claim_file: shown(simulation), identified: true, outcome })
    }
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
