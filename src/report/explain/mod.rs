//! The document of an explanation: where the mismatch is, what causes it and how large that is, what was gained.

mod effect;
mod method;
mod noticeable;
pub(in crate::report) mod print;
mod sentence;
mod tables;

pub use super::files::{Context, ExplainFile};
pub(super) use tables::{fit, fit_summary};

use super::document::{Documented, Record};
use super::generator;
use super::number::{count, date_time, digits, duration};
use super::page::{Block, Head, Lead, Page, State, Table};
use super::translator::Translator;
use super::view::FigureView;
use crate::figure::Figure;
use crate::i18n::Lang;
use crate::output::Kind;
use crate::record::ExplainedRecord;
use crate::record::explanation::Explanation;

/// What a report says of a recording that was set against the model of its family: the verdict in a word and in
/// sentences, or why there is none.
pub fn explained_summary(explained: &ExplainedRecord, lang: Lang) -> Vec<String> {
    let words = Translator { lang };
    match (&explained.explanation, &explained.error) {
        (Some(all), _) => sentence::verdict(all, words),
        (None, Some(error)) => vec![words.with("explain.not_compared", &[("reason", &words.say(error))])],
        (None, None) => vec![],
    }
}

impl Documented for ExplainFile {
    fn record(&self) -> Record<'_> {
        Record::Explanation(self)
    }

    fn kind(&self) -> Kind {
        Kind::Explanation
    }

    fn subject(&self) -> Option<&str> {
        Some(self.explanation.case.as_str()).filter(|c| !c.is_empty())
    }

    fn made_at(&self) -> &str {
        &self.context.explained_at
    }

    fn page(&self, figures: &[Figure], lang: Lang) -> Page {
        page(self, figures, Translator { lang })
    }

    fn on_terminal(&self, lang: Lang) -> Vec<Block> {
        on_terminal(&self.explanation, &self.context, lang)
    }
}

/// An explanation on a terminal: the verdict in sentences, each effect with its parameters, what was gained, the sizes that
/// would have been noticed.
pub fn on_terminal(all: &Explanation, context: &Context, lang: Lang) -> Vec<Block> {
    let words = Translator { lang };
    let effects = all.effects.iter().flat_map(|f| {
        let heading = Block::heading(effect::name(f, words));
        std::iter::once(heading).chain(effect::parameters(f, all, words).map(Block::Table))
    });
    let gained = fit_summary(all, words);
    let is_gained = all.effects.iter().any(|f| !f.is_unnamed()) && !gained.is_empty();
    let gained = is_gained.then(|| [Block::heading(words.t("terminal.gained")), Block::Paragraph(gained)]);
    [Block::Head(head(all, context, words)), Block::Lead(lead(all, words))]
        .into_iter()
        .chain(effects)
        .chain(gained.into_iter().flatten())
        .chain(noticeable::on_terminal(all, words))
        .collect()
}

fn page(file: &ExplainFile, figures: &[Figure], words: Translator) -> Page {
    let ExplainFile { explanation: all, context } = file;
    let head = head(all, context, words);
    let footer = [date_time(&context.explained_at), generator()];
    let hint = |key: &str| Block::Hint(words.t(key));
    let section = |key: &str, below: Vec<Block>| Block::section("", words.t(key), below);
    let filled = |table: Table| (!table.rows.is_empty()).then_some(table);
    let remarks = Block::remarks(context.notes.iter().map(|n| words.say(n)));
    let facts = std::iter::once(Block::identity(identity(all, context, words))).chain(remarks).collect();
    let drawn = figures.iter().zip(1..);
    let drawn: Vec<Block> =
        drawn.map(|(f, number)| Block::Figure(Box::new(FigureView::of(f, number, words)))).collect();
    let drawn =
        (!drawn.is_empty()).then(|| Block::section("figures", words.t("explain.step.figures"), drawn));
    let tried = match filled(tables::candidates(all, words)) {
        Some(table) => vec![hint("explain.step.what_hint"), Block::Table(table)],
        None => vec![Block::Paragraph(words.t("explain.step.what_none"))],
    };
    let columns = filled(tables::columns(all, words)).map(|table| {
        section("explain.columns.title", vec![hint("explain.columns.hint"), Block::Table(table)])
    });
    let stated = effect::stated_values(all, words)
        .map(|table| section("explain.stated.title", vec![hint("explain.stated.hint"), Block::Table(table)]));
    let gained = vec![
        Block::Paragraph(fit_summary(all, words)),
        hint("explain.step.better_hint"),
        Block::Table(fit("compact cards", all, words)),
    ];
    Page {
        title: format!("{} · {}", head.kind, head.title),
        generator: generator(),
        footer: footer.into_iter().filter(|p| !p.is_empty()).collect::<Vec<_>>().join(" · "),
        blocks: [
            Block::Head(head),
            Block::Lead(lead(all, words)),
            Block::section("identity", words.t("explain.fact.title"), facts),
            Block::SummaryEnd,
            section(
                "explain.step.where",
                vec![hint("explain.step.where_hint"), Block::Table(tables::tests(all, words))],
            ),
        ]
        .into_iter()
        .chain(drawn)
        .chain([section("explain.step.what", tried)])
        .chain(columns)
        .chain([section("explain.step.which", causes(all, words))])
        .chain(noticeable::section(all, words))
        .chain([section("explain.step.better", gained)])
        .chain(stated)
        .chain([
            Block::section("methods", words.t("explain.step.how"), method::blocks(words)),
            section("explain.step.files", vec![Block::files(files(all, context, words))]),
        ])
        .collect(),
    }
}

fn head(all: &Explanation, context: &Context, words: Translator) -> Head {
    let title = if all.case.is_empty() { &context.recording } else { &all.case };
    Head {
        kind: words.t("explain.kind"),
        title: title.clone(),
        label: words.t("explain.verdict.title"),
        verdict: verdict(all, words),
        ..Head::default()
    }
}

/// Verdict of an explanation.
pub(super) fn verdict(all: &Explanation, words: Translator) -> State {
    let (id, word) = print::verdict(all.verdict, words);
    State { id: id.to_owned(), word }
}

/// The verdict in sentences.
pub(super) fn lead(all: &Explanation, words: Translator) -> Lead {
    Lead { id: verdict(all, words).id, sentences: sentence::verdict(all, words) }
}

/// The causes, a section each.
fn causes(all: &Explanation, words: Translator) -> Vec<Block> {
    if all.effects.is_empty() {
        return vec![Block::Paragraph(words.t("explain.step.which_none"))];
    }
    let sections = all.effects.iter().zip(1..).map(|(f, number)| effect::section(number, f, all, words));
    std::iter::once(Block::Hint(words.t("explain.step.which_hint"))).chain(sections).collect()
}

fn identity(all: &Explanation, context: &Context, words: Translator) -> Vec<(String, String)> {
    let r = &all.recording;
    let mut out = vec![];
    let mut put = |key: &str, value: String| {
        if !value.trim().is_empty() {
            out.push((words.t(key), value));
        }
    };
    put("explain.fact.recording", context.recording.clone());
    let claim = if context.identified { "explain.fact.simulation" } else { "explain.fact.claim" };
    put(claim, context.claim.clone());
    put("explain.fact.case", all.case.clone());
    put(
        "explain.fact.description",
        context.description.as_ref().map_or_else(String::new, |d| words.local(d)),
    );
    put("explain.fact.rows", count(r.rows as u64, words.lang));
    put("explain.fact.missing", count(r.missing as u64, words.lang));
    put("explain.fact.interval", duration(r.sample_interval_s, words.lang));
    put("explain.fact.length", duration(r.duration_s(), words.lang));
    let list = |names: &[String]| names.join(&words.t("number.list"));
    let in_file = |name: &String| {
        let column = all.columns.iter().find(|c| c.name == *name);
        column.and_then(|c| c.recorded_as.as_ref()).unwrap_or(name).clone()
    };
    put("explain.fact.columns", list(&r.columns.iter().map(in_file).collect::<Vec<_>>()));
    put("explain.fact.hidden", list(&r.hidden));
    put("explain.fact.alpha", digits(all.alpha, 1, words.lang));
    out
}

fn files(all: &Explanation, context: &Context, words: Translator) -> Vec<(String, String)> {
    let mut names = vec![("explain.json", "explain.wrote.for_programs")];
    if context.correction {
        names.push(("correction.csv", "explain.wrote.correction"));
    }
    names.push(("augmented.toml", "explain.wrote.augmented"));
    if all.effects.iter().any(|f| f.other_causes().next().is_some()) {
        names.push(("alternatives.toml", "explain.wrote.alternatives"));
    }
    names.push(("report.html", "explain.wrote.page"));
    names.push(("report.md", "explain.wrote.markdown"));
    names.push(("figures/*.svg", "explain.wrote.figures"));
    names.into_iter().map(|(name, key)| (name.to_owned(), words.t(key))).collect()
}
