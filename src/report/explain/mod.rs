//! The view of an explanation: words and printed numbers, ready for the templates and for the terminal.

mod effect;
mod method;
mod noticeable;
pub(in crate::report) mod print;
mod sentence;
mod tables;

pub use effect::{EffectView, EquivalentView, ParameterRow, StatedRow};
pub use method::MethodView;
pub use noticeable::{NotComputedRow, NoticeableRow};
pub(super) use tables::fit_table;
pub use tables::{CandidateRow, ColumnRow, FitRow, TestRow};

use super::number::{count, date_time, digits, duration};
use super::translator::{Field, Translator};
use super::view::FigureView;
use crate::figure::Figure;
use crate::i18n::{Lang, LocalText, Note};
use crate::record::ExplainedRecord;
use crate::record::explanation::{Explanation, MismatchVerdict};
use serde::{Deserialize, Serialize};

/// What `explain.json` holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExplainFile {
    /// The findings.
    #[serde(flatten)]
    pub explanation: Explanation,
    /// What its page shows besides.
    pub context: Context,
}

/// Where an explanation comes from and goes to.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Context {
    /// The recording, as named by the user.
    pub recording: String,
    /// The claim, as named by the user.
    pub claim: String,
    /// True when the claim was identified from a simulated recording.
    pub identified: bool,
    /// What the claim says of itself.
    #[serde(flatten, with = "crate::record::local::description")]
    pub description: Option<LocalText>,
    /// RFC 3339.
    pub explained_at: String,
    /// True when `correction.csv` is written.
    pub correction: bool,
    /// What must be known of the recording.
    #[serde(with = "crate::record::message::notes")]
    pub notes: Vec<Note>,
}

/// A file of the folder.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FileView {
    /// Name.
    pub name: String,
    /// What it is.
    pub what: String,
}

/// Everything that an explanation shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExplainView {
    /// The verdict.
    pub verdict: MismatchVerdict,
    /// Class of the verdict, for colours.
    pub verdict_class: &'static str,
    /// The verdict in a word.
    pub verdict_word: String,
    /// Case and description.
    pub title: String,
    /// The verdict in sentences.
    pub summary: Vec<String>,
    /// Recording and claim.
    pub identity: Vec<Field>,
    /// What must be known of the recording.
    pub remarks: Vec<String>,
    /// Family-wise probability, before and after.
    pub family: [String; 2],
    /// Significance asked for.
    pub alpha: String,
    /// Tests of the residual, the most significant first.
    pub tests: Vec<TestRow>,
    /// The candidates tried.
    pub candidates: Vec<CandidateRow>,
    /// Columns of the recording.
    pub columns: Vec<ColumnRow>,
    /// Sizes of effects that would have been noticed, the most useful first.
    pub noticeable: Vec<NoticeableRow>,
    /// Kinds without such a size.
    pub not_computed: Vec<NotComputedRow>,
    /// Causes.
    pub effects: Vec<EffectView>,
    /// The fit before and after.
    pub fit: Vec<FitRow>,
    /// What adding the effects does to the fit, in a sentence.
    pub fit_summary: String,
    /// True when nothing was added.
    pub unchanged: bool,
    /// What the claim states.
    pub stated: Vec<StatedRow>,
    /// How it was found.
    pub methods: Vec<MethodView>,
    /// Figures.
    pub figures: Vec<FigureView>,
    /// Files of the folder.
    pub files: Vec<FileView>,
    /// Line at the foot of every page.
    pub footer: String,
    /// The program with its version.
    pub generator: String,
}

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

impl ExplainView {
    /// Builds the view.
    pub fn new(all: &Explanation, figures: &[Figure], context: &Context, lang: Lang) -> ExplainView {
        let words = Translator { lang };
        let (verdict_class, verdict_word) = print::verdict(all.verdict, words);
        let generator = super::generator();
        let title = if all.case.is_empty() { context.recording.clone() } else { all.case.clone() };
        let effects = all.effects.iter().enumerate();
        let footer = [date_time(&context.explained_at), generator.clone()];
        ExplainView {
            verdict: all.verdict,
            verdict_class,
            verdict_word,
            title,
            summary: sentence::verdict(all, words),
            identity: identity(all, context, words),
            remarks: context.notes.iter().map(|n| words.say(n)).collect(),
            family: [all.family_p_value, all.family_p_value_after].map(|p| print::chance(p, words)),
            alpha: digits(all.alpha, 1, lang),
            tests: tables::tests(all, words),
            candidates: tables::candidates(all, words),
            columns: tables::columns(all, words),
            noticeable: noticeable::sizes(all, words),
            not_computed: noticeable::not_computed(all, words),
            effects: effects.map(|(i, f)| EffectView::new(i + 1, f, all, words)).collect(),
            fit: tables::fit(all, words),
            fit_summary: tables::fit_summary(all, words),
            unchanged: all.effects.iter().all(|f| f.is_unnamed()),
            stated: effect::stated_rows(all, words),
            methods: method::all(words),
            figures: figures.iter().enumerate().map(|(i, f)| FigureView::of(f, i + 1, words)).collect(),
            files: files(all, context, words),
            footer: footer.into_iter().filter(|p| !p.is_empty()).collect::<Vec<_>>().join(" · "),
            generator,
        }
    }
}

fn identity(all: &Explanation, context: &Context, words: Translator) -> Vec<Field> {
    let r = &all.recording;
    let mut out = vec![];
    let mut put = |key: &str, value: String| {
        if !value.trim().is_empty() {
            out.push(Field { label: words.t(key), value });
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

fn files(all: &Explanation, context: &Context, words: Translator) -> Vec<FileView> {
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
    let row = |(name, key): (&str, &str)| FileView { name: name.to_owned(), what: words.t(key) };
    names.into_iter().map(row).collect()
}
