//! The view of several recordings that are explained together: words and printed numbers, ready for the templates and for
//! the terminal.

mod sentence;

pub use super::files::{JointContext, JointFile};

use super::document::{Contents, Documented, Record};
use super::explain::print::{capital, difference, parameter, title, value, verdict};
use super::explain::{FileView, ParameterRow};
use super::number::{date_time, digits};
use super::translator::{Field, Translator};
use crate::effect::{Domain, find};
use crate::figure::Figure;
use crate::i18n::{EffectText, Lang, effect_text};
use crate::mismatch::joint::record::{Brief, JointExplanation, SharedEffect, SharedIn};
use crate::output::Kind;
use serde::Serialize;

/// A shared effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SharedView {
    /// Title.
    pub title: String,
    /// Kind as the files have it.
    pub kind: String,
    /// What is said of it.
    pub sentences: Vec<String>,
    /// What happens in the instrument or around it.
    pub mechanism: String,
    /// Parameters.
    pub parameters: Vec<ParameterRow>,
    /// Each recording.
    pub of: Vec<SharedInRow>,
    /// True where each recording has a coefficient of its own to show.
    pub has_alone: bool,
}

/// A shared effect in one recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SharedInRow {
    /// The recording.
    pub name: String,
    /// The coefficient as this recording alone has it.
    pub alone: String,
    /// Gain by the shared law.
    pub gain: String,
    /// Gain by the law of the others.
    pub predicted: String,
}

/// A recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordingRow {
    /// Its name.
    pub name: String,
    /// Its own page.
    pub page: String,
    /// Verdict and effects without the others.
    pub alone: String,
    /// Class of that verdict.
    pub alone_class: &'static str,
    /// Verdict and effects beside what is shared.
    pub together: String,
    /// Class of that verdict.
    pub together_class: &'static str,
}

/// Everything that a joint explanation shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointView {
    /// Class of the verdict, for colours.
    pub verdict_class: &'static str,
    /// The verdict in a word.
    pub verdict_word: String,
    /// Case, or the claim.
    pub title: String,
    /// The verdict in sentences.
    pub summary: Vec<String>,
    /// What must be known.
    pub remarks: Vec<String>,
    /// Claim, number of recordings.
    pub identity: Vec<Field>,
    /// Shared effects.
    pub shared: Vec<SharedView>,
    /// Effects on which the recordings do not agree.
    pub unlike: Vec<SharedView>,
    /// Recordings.
    pub recordings: Vec<RecordingRow>,
    /// Files of the folder.
    pub files: Vec<FileView>,
    /// Line at the foot of every page.
    pub footer: String,
    /// The program with its version.
    pub generator: String,
}

impl Documented for JointFile {
    fn record(&self) -> Record<'_> {
        Record::Joint(self)
    }

    fn kind(&self) -> Kind {
        Kind::Joint
    }

    fn subject(&self) -> Option<&str> {
        Some(self.explanation.case.as_str()).filter(|c| !c.is_empty())
    }

    fn made_at(&self) -> &str {
        &self.context.explained_at
    }

    fn contents(&self, _: &[Figure], lang: Lang) -> Contents {
        Contents::view("joint", &JointView::new(self, lang), lang)
    }
}

impl JointView {
    /// Builds the view.
    pub fn new(file: &JointFile, lang: Lang) -> JointView {
        let words = Translator { lang };
        let JointFile { explanation: all, context } = file;
        let (verdict_class, verdict_word) = verdict(all.verdict, words);
        let generator = format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"));
        let footer = [date_time(&context.explained_at), generator.clone()];
        let recording = |r: &crate::mismatch::joint::record::JointRecording| {
            let (alone_class, alone) = brief(&r.alone, words);
            let (together_class, together) = brief(&r.together, words);
            let page = format!("{}/report.html", r.folder);
            RecordingRow { name: r.name.clone(), page, alone, alone_class, together, together_class }
        };
        JointView {
            verdict_class,
            verdict_word,
            title: if all.case.is_empty() { context.claim.clone() } else { all.case.clone() },
            summary: sentence::summary(all, words),
            remarks: context.notes.iter().map(|n| words.say(n)).collect(),
            identity: identity(file, words),
            shared: all.shared.iter().map(|s| shared(s, all, words)).collect(),
            unlike: all.unlike.iter().map(|s| shared(s, all, words)).collect(),
            recordings: all.recordings.iter().map(recording).collect(),
            files: files(words),
            footer: footer.into_iter().filter(|p| !p.is_empty()).collect::<Vec<_>>().join(" · "),
            generator,
        }
    }
}

/// Class of a brief explanation, and its verdict with its effects.
fn brief(brief: &Brief, words: Translator) -> (&'static str, String) {
    let (class, word) = verdict(brief.verdict, words);
    if brief.effects.is_empty() {
        return (class, word);
    }
    let effects: Vec<String> = brief.effects.iter().map(|e| title(e, words)).collect();
    (class, format!("{word}: {}", effects.join(&words.t("number.list"))))
}

fn name_of(recording: usize, all: &JointExplanation) -> String {
    recording.checked_sub(1).and_then(|i| all.recordings.get(i)).map_or_else(String::new, |r| r.name.clone())
}

fn shared(s: &SharedEffect, all: &JointExplanation, words: Translator) -> SharedView {
    let id = s.effect.as_deref().unwrap_or(&s.kind);
    let row = |o: &SharedIn| {
        let name = s.parameters.keys().find(|n| n.as_str() != "rms_deg_h").map_or("", String::as_str);
        SharedInRow {
            name: name_of(o.recording, all),
            alone: o.alone.as_ref().map(|p| value(name, p, words).whole).unwrap_or_default(),
            gain: difference(o.gain, words),
            predicted: difference(o.predicted_gain, words),
        }
    };
    SharedView {
        title: capital(&sentence::effect(s, words)),
        kind: s.kind.clone(),
        sentences: sentence::shared(s, words),
        mechanism: effect_text(id, EffectText::Mechanism, words.lang).to_owned(),
        parameters: s.parameters.iter().map(|(name, p)| parameter_row(name, p, s, words)).collect(),
        has_alone: s.of.iter().any(|o| o.alone.is_some()),
        of: s.of.iter().map(row).collect(),
    }
}

fn parameter_row(
    name: &str,
    p: &crate::mismatch::finding::ParameterValue,
    s: &SharedEffect,
    words: Translator,
) -> ParameterRow {
    let printed = value(name, p, words);
    // A coefficient of any column has the unit of the column, which its name tells.
    let by_column = p.unit.is_empty()
        && find(s.effect.as_deref().unwrap_or(&s.kind)).is_some_and(|e| e.domain() == Domain::Driver);
    let unit = match s.column.as_deref().filter(|_| by_column) {
        Some(column) => words.with("joint.per_column", &[("column", column)]),
        None => words.unit(&p.unit),
    };
    ParameterRow {
        name: parameter(name, words),
        id: name.to_owned(),
        value: printed.value,
        interval: printed.interval,
        unit,
        claimed: String::new(),
    }
}

fn identity(file: &JointFile, words: Translator) -> Vec<Field> {
    let JointFile { explanation: all, context } = file;
    let rows = [
        ("explain.fact.claim", context.claim.clone()),
        ("explain.fact.case", all.case.clone()),
        ("joint.fact.recordings", all.recordings.len().to_string()),
        ("explain.fact.alpha", digits(all.alpha, 1, words.lang)),
    ];
    let field = |(key, value): (&str, String)| Field { label: words.t(key), value };
    rows.into_iter().filter(|(_, value)| !value.trim().is_empty()).map(field).collect()
}

fn files(words: Translator) -> Vec<FileView> {
    let rows = [
        ("joint.json", "joint.wrote.for_programs"),
        ("augmented.toml", "joint.wrote.augmented"),
        ("recordings/*/", "joint.wrote.recordings"),
        ("report.html", "joint.wrote.page"),
        ("report.md", "joint.wrote.markdown"),
    ];
    rows.into_iter().map(|(name, key)| FileView { name: name.to_owned(), what: words.t(key) }).collect()
}
