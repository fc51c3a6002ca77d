//! The document of several recordings that are explained together: what they share, and what each says alone and with
//! the others.

mod sentence;

pub use super::files::{JointContext, JointFile};

use super::document::{Documented, Record};
use super::explain::print::{capital, difference, parameter, title, value, verdict};
use super::generator;
use super::number::{date_time, digits};
use super::page::{Block, Head, Layout, Lead, Listed, Page, Quantity, State, Table, Value};
use super::translator::Translator;
use crate::effect::{Domain, find};
use crate::figure::Figure;
use crate::i18n::{EffectText, Lang, effect_text};
use crate::mismatch::finding::ParameterValue;
use crate::mismatch::joint::record::{Brief, JointExplanation, JointRecording, SharedEffect, SharedIn};
use crate::output::Kind;

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

    fn page(&self, _: &[Figure], lang: Lang) -> Page {
        pages(self, Translator { lang })
    }

    /// The verdict in sentences, each shared effect with its parameters, and the recordings.
    fn on_terminal(&self, lang: Lang) -> Vec<Block> {
        let words = Translator { lang };
        let all = &self.explanation;
        let head = head(self, words);
        let lead = Lead { id: head.verdict.id.clone(), sentences: sentence::summary(all, words) };
        let mut out = vec![Block::Head(head), Block::Lead(lead)];
        for shared in &all.shared {
            out.push(Block::heading(effect_title(shared, words)));
            out.extend(parameters(shared, words).map(Block::Table));
            out.extend(sentence::shared(shared, words).into_iter().map(Block::Paragraph));
        }
        out.push(Block::heading(words.t("joint.heading.recordings")));
        out.push(Block::Table(recordings(all, words)));
        out
    }
}

fn pages(file: &JointFile, words: Translator) -> Page {
    let JointFile { explanation: all, context } = file;
    let head = head(file, words);
    let footer = [date_time(&context.explained_at), generator()];
    let remarks = context.notes.iter().map(|n| words.say(n));
    let sentences = sentence::summary(all, words).into_iter().chain(remarks).collect();
    let lead = Lead { id: head.verdict.id.clone(), sentences };
    let hint = |key: &str| Block::Hint(words.t(key));
    let effects = |heading: &str, hint: Option<Block>, effects: &[SharedEffect]| {
        let each = effects.iter().flat_map(|s| effect(s, all, words));
        Block::section("", words.t(heading), hint.into_iter().chain(each).collect())
    };
    let shared = (!all.shared.is_empty()).then(|| effects("joint.heading.shared", None, &all.shared));
    let unlike = (!all.unlike.is_empty())
        .then(|| effects("joint.heading.unlike", Some(hint("joint.hint.unlike")), &all.unlike));
    let identity = vec![Block::identity(identity(file, words))];
    let recordings = vec![hint("joint.hint.recordings"), Block::Table(recordings(all, words))];
    let method = vec![Block::Paragraph(words.t("joint.method"))];
    Page {
        title: format!("{} · {}", head.kind, head.title),
        generator: generator(),
        footer: footer.into_iter().filter(|p| !p.is_empty()).collect::<Vec<_>>().join(" · "),
        blocks: [
            Block::Head(head),
            Block::Lead(lead),
            Block::section("identity", words.t("joint.heading.facts"), identity),
        ]
        .into_iter()
        .chain(shared)
        .chain(unlike)
        .chain([
            Block::SummaryEnd,
            Block::section("", words.t("joint.heading.recordings"), recordings),
            Block::section("", words.t("joint.heading.method"), method),
            Block::section("", words.t("joint.heading.files"), vec![files(words)]),
        ])
        .collect(),
    }
}

fn head(file: &JointFile, words: Translator) -> Head {
    let (id, word) = verdict(file.explanation.verdict, words);
    Head {
        kind: words.t("joint.kind"),
        title: file.subject().unwrap_or(&file.context.claim).to_owned(),
        label: words.t("explain.verdict.title"),
        verdict: State { id: id.to_owned(), word },
        ..Head::default()
    }
}

/// Title of an effect with its kind as the files have it.
fn effect_title(s: &SharedEffect, words: Translator) -> Value {
    Value::Named { text: capital(&sentence::effect(s, words)), id: s.kind.clone() }
}

/// An effect: its parameters, what is said of it, each recording, and what happens in the instrument or around it.
fn effect(s: &SharedEffect, all: &JointExplanation, words: Translator) -> Vec<Block> {
    let id = s.effect.as_deref().unwrap_or(&s.kind);
    let mechanism = effect_text(id, EffectText::Mechanism, words.lang).to_owned();
    std::iter::once(Block::subheading(effect_title(s, words)))
        .chain(parameters(s, words).map(Block::Table))
        .chain(sentence::shared(s, words).into_iter().map(Block::Paragraph))
        .chain([Block::Table(in_recordings(s, all, words)), Block::Hint(mechanism)])
        .collect()
}

/// Parameters of an effect; none where it has none.
fn parameters(s: &SharedEffect, words: Translator) -> Option<Table> {
    let printed: Vec<_> = s.parameters.iter().map(|(name, p)| (name, p, value(name, p, words))).collect();
    let quantities = printed.iter().map(|(_, p, printed)| Quantity {
        number: Some(p.value),
        printed: printed.value.clone(),
        unit: unit(p, s, words),
    });
    let table = Table::new("cards", s.parameters.len())
        .column(
            words.column("explain.column.parameter"),
            printed.iter().map(|(name, ..)| parameter(name, words)),
        )
        .column(words.number_column("report.value"), quantities)
        .column(
            words.number_column("explain.column.interval").listed(Listed::Bracketed),
            printed.iter().map(|(.., printed)| printed.interval.clone()),
        )
        .units(words.t("report.unit"))
        .laid_out(Layout::Grid, Layout::List);
    (!s.parameters.is_empty()).then_some(table)
}

/// Unit of a parameter. A coefficient of any column has the unit of the column, which its name tells.
fn unit(p: &ParameterValue, s: &SharedEffect, words: Translator) -> String {
    let by_column = p.unit.is_empty()
        && find(s.effect.as_deref().unwrap_or(&s.kind)).is_some_and(|e| e.domain() == Domain::Driver);
    match s.column.as_deref().filter(|_| by_column) {
        Some(column) => words.with("joint.per_column", &[("column", column)]),
        None => words.unit(&p.unit),
    }
}

/// An effect in each recording.
fn in_recordings(s: &SharedEffect, all: &JointExplanation, words: Translator) -> Table {
    let name = |o: &SharedIn| {
        let recording = o.recording.checked_sub(1).and_then(|i| all.recordings.get(i));
        recording.map_or_else(String::new, |r| r.name.clone())
    };
    let coefficient = s.parameters.keys().find(|n| n.as_str() != "rms_deg_h").map_or("", String::as_str);
    let alone =
        |o: &SharedIn| o.alone.as_ref().map(|p| value(coefficient, p, words).whole).unwrap_or_default();
    let mut table =
        Table::new("cards", s.of.len()).column(words.column("joint.column.recording"), s.of.iter().map(name));
    if s.of.iter().any(|o| o.alone.is_some()) {
        table = table.column(words.number_column("joint.column.coefficient"), s.of.iter().map(alone));
    }
    table
        .column(words.number_column("joint.column.gain"), s.of.iter().map(|o| difference(o.gain, words)))
        .column(
            words.number_column("joint.column.predicted"),
            s.of.iter().map(|o| difference(o.predicted_gain, words)),
        )
}

/// Findings of each recording without the others, and beside the shared ones.
fn recordings(all: &JointExplanation, words: Translator) -> Table {
    let link =
        |r: &JointRecording| Value::Link { text: r.name.clone(), to: format!("{}/report.html", r.folder) };
    Table::new("cards", all.recordings.len())
        .column(words.column("joint.column.recording"), all.recordings.iter().map(link))
        .column(words.column("joint.column.alone"), all.recordings.iter().map(|r| brief(&r.alone, words)))
        .column(
            words.column("joint.column.together"),
            all.recordings.iter().map(|r| brief(&r.together, words)),
        )
}

/// The verdict of a brief explanation with its effects.
fn brief(brief: &Brief, words: Translator) -> String {
    let (_, word) = verdict(brief.verdict, words);
    if brief.effects.is_empty() {
        return word;
    }
    let effects: Vec<String> = brief.effects.iter().map(|e| title(e, words)).collect();
    format!("{word}: {}", effects.join(&words.t("number.list")))
}

fn identity(file: &JointFile, words: Translator) -> Vec<(String, String)> {
    let JointFile { explanation: all, context } = file;
    let rows = [
        ("explain.fact.claim", context.claim.clone()),
        ("explain.fact.case", all.case.clone()),
        ("joint.fact.recordings", all.recordings.len().to_string()),
        ("explain.fact.alpha", digits(all.alpha, 1, words.lang)),
    ];
    rows.map(|(key, value)| (words.t(key), value)).into()
}

fn files(words: Translator) -> Block {
    let rows = [
        ("joint.json", "joint.wrote.for_programs"),
        ("augmented.toml", "joint.wrote.augmented"),
        ("recordings/*/", "joint.wrote.recordings"),
        ("report.html", "joint.wrote.page"),
        ("report.md", "joint.wrote.markdown"),
    ];
    Block::files(rows.map(|(name, key)| (name.to_owned(), words.t(key))))
}
