//! The view of a proof: what was hidden, what was said, what was true, side by side, ready for the templates and for the
//! terminal.

use super::document::{Contents, Documented, Record};
use super::explain::{ExplainView, FileView, FitRow};
use super::number::{count, date_time, digits, duration, limit_digits};
use super::translator::{Field, Translator};
use super::view::FigureView;
use crate::figure::Figure;
use crate::i18n::{Lang, Localize};
use crate::output::Kind;
use crate::record::explanation::Explanation;
use crate::record::{
    ClaimOrigin, CourseRecord, HiddenKind, KnownRecord, ProofOutcome, ProofRecord, RuleRecord,
};
use crate::report::explain::Context;
use serde::Serialize;

/// Figures of the explanation while something was concealed begin so.
pub const CONCEALED: &str = "concealed_";

/// Figures of the explanation with the columns shown begin so.
pub const UNVEILED: &str = "unveiled_";

/// Something that was hidden.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HiddenRow {
    /// Name.
    pub name: String,
    /// What it is.
    pub what: String,
    /// SHA-256.
    pub sha256: String,
}

/// What an explanation said.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SaidView {
    /// Heading.
    pub title: String,
    /// Class of the verdict, for colours.
    pub verdict_class: &'static str,
    /// The verdict in a word.
    pub verdict_word: String,
    /// The verdict in sentences.
    pub summary: Vec<String>,
    /// The fit before and after.
    pub fit: Vec<FitRow>,
    /// What adding the effects does to the fit.
    pub fit_summary: String,
    /// Figures.
    pub figures: Vec<FigureView>,
}

/// Something known from elsewhere.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReferenceRow {
    /// What it is.
    pub what: String,
    /// Interval.
    pub known: String,
    /// What was found, with its interval; empty where nothing was.
    pub found: String,
    /// Unit.
    pub unit: String,
    /// Where it comes from.
    pub source: String,
}

/// A rule.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RuleRow {
    /// Which explanation it speaks of.
    pub when: String,
    /// What must hold.
    pub must: String,
    /// What was found.
    pub found: String,
    /// Whether it holds, in a word.
    pub word: String,
    /// Class of that word, for colours.
    pub class: &'static str,
}

/// An inferred course against something that was concealed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CourseRow {
    /// What it is held against.
    pub name: String,
    /// Correlation.
    pub correlation: String,
    /// Share of the mean square explained.
    pub share: String,
    /// Lag of the largest correlation.
    pub lag: String,
    /// Correlation there.
    pub at_lag: String,
}

/// A step of the protocol.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepView {
    /// What was done.
    pub what: String,
    /// Hashes: name and first digits.
    pub hashes: Vec<Field>,
}

/// Everything that a proof shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProofView {
    /// Class of the outcome, for colours.
    pub outcome_class: &'static str,
    /// The outcome in a word.
    pub outcome_word: String,
    /// Title.
    pub title: String,
    /// What is asked.
    pub question: String,
    /// The outcome in a sentence.
    pub summary: String,
    /// Recording, claim, confinement.
    pub identity: Vec<Field>,
    /// What was hidden.
    pub hidden: Vec<HiddenRow>,
    /// What was said: while something was concealed, and unveiled.
    pub said: Vec<SaidView>,
    /// What is known from elsewhere.
    pub references: Vec<ReferenceRow>,
    /// Rules.
    pub rules: Vec<RuleRow>,
    /// The inferred course against what was concealed.
    pub courses: Vec<CourseRow>,
    /// Figure of that.
    pub course_figure: Option<FigureView>,
    /// What was done.
    pub protocol: Vec<StepView>,
    /// Files of the folder.
    pub files: Vec<FileView>,
    /// Line at the foot of every page.
    pub footer: String,
    /// The program with its version.
    pub generator: String,
}

impl Documented for ProofRecord {
    fn record(&self) -> Record<'_> {
        Record::Proof(self)
    }

    fn kind(&self) -> Kind {
        Kind::Proof
    }

    fn subject(&self) -> Option<&str> {
        Some(self.title.text())
    }

    fn made_at(&self) -> &str {
        &self.proved_at
    }

    fn program_version(&self) -> Option<&str> {
        Some(&self.program.version)
    }

    fn folder_name(&self) -> Option<&str> {
        None
    }

    fn contents(&self, figures: &[Figure], lang: Lang) -> Contents {
        Contents::view("proof", &ProofView::new(self, figures, lang), lang)
    }
}

impl ProofView {
    /// Builds the view.
    pub fn new(record: &ProofRecord, figures: &[Figure], lang: Lang) -> ProofView {
        let words = Translator { lang };
        let (outcome_class, outcome) = match record.outcome {
            ProofOutcome::Holds => ("pass", "holds"),
            ProofOutcome::Fails => ("fail", "fails"),
        };
        let failed = record.rules.iter().filter(|r| !r.holds).count();
        let counts = [("n", count(record.rules.len() as u64, lang)), ("failed", count(failed as u64, lang))];
        let counts = counts.each_ref().map(|(k, v)| (*k, v.as_str()));
        let of = |before: &'static str| {
            let own = figures.iter().enumerate().filter(move |(_, f)| f.id.starts_with(before));
            own.map(|(i, f)| FigureView::of(f, i + 1, words)).collect::<Vec<_>>()
        };
        let course = figures.iter().position(|f| !f.id.starts_with(CONCEALED) && !f.id.starts_with(UNVEILED));
        let said = |key: &str, explanation: &Explanation, figures| {
            let context = Context { explained_at: record.proved_at.clone(), ..Context::default() };
            let view = ExplainView::new(explanation, &[], &context, lang);
            SaidView {
                title: words.t(key),
                verdict_class: view.verdict_class,
                verdict_word: view.verdict_word,
                summary: view.summary,
                fit: view.fit,
                fit_summary: view.fit_summary,
                figures,
            }
        };
        let first = if record.hidden.is_empty() { "prove.when.only" } else { "prove.when.concealed" };
        let concealed = said(first, &record.concealed, of(CONCEALED));
        let unveiled = record.unveiled.as_ref().map(|u| said("prove.when.unveiled", u, of(UNVEILED)));
        let footer = [record.path.clone(), date_time(&record.proved_at), generator()];
        ProofView {
            outcome_class,
            outcome_word: words.t(&format!("prove.outcome.{outcome}")),
            title: record.title.in_language(lang.code()).to_owned(),
            question: record.question.in_language(lang.code()).to_owned(),
            summary: words.with(&format!("prove.summary.{outcome}"), &counts),
            identity: identity(record, words),
            hidden: record.hidden.iter().map(|h| hidden(h, words)).collect(),
            said: std::iter::once(concealed).chain(unveiled).collect(),
            references: record.references.iter().map(|r| reference(r, words)).collect(),
            rules: record.rules.iter().map(|r| rule(r, words)).collect(),
            courses: record.courses.iter().map(|c| course_row(c, words)).collect(),
            course_figure: course.and_then(|i| Some(FigureView::of(figures.get(i)?, i + 1, words))),
            protocol: record.protocol.iter().map(|s| step(s, words)).collect(),
            files: files(words),
            footer: footer.join(" · "),
            generator: generator(),
        }
    }
}

fn generator() -> String {
    format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"))
}

fn identity(record: &ProofRecord, words: Translator) -> Vec<Field> {
    let lang = words.lang;
    let recording = &record.recording;
    let length = duration(recording.rows as f64 * recording.sample_interval_s, lang);
    let claim = match record.claim {
        ClaimOrigin::Model => "prove.claim.model",
        ClaimOrigin::Part => "prove.claim.part",
        ClaimOrigin::OtherOutput => "prove.claim.other_output",
    };
    let path = if recording.simulated { "prove.fact.simulated" } else { "prove.fact.recording" };
    let confined = if record.confined { "prove.confined.kernel" } else { "prove.confined.folder" };
    let rows = words
        .with("prove.fact.rows_of", &[("rows", &count(recording.rows as u64, lang)), ("length", &length)]);
    let fields = [
        (path, recording.path.clone()),
        ("prove.fact.sha256", recording.sha256.clone()),
        ("prove.fact.rows", rows),
        ("prove.fact.shown", recording.shown.join(", ")),
        ("prove.fact.decoys", recording.decoys.join(", ")),
        ("prove.fact.claim", words.t(claim)),
        ("prove.fact.engine", words.t(confined)),
    ];
    let field = |(key, value): (&str, String)| Field { label: words.t(key), value };
    fields.into_iter().filter(|(_, value)| !value.is_empty()).map(field).collect()
}

fn hidden(hidden: &crate::record::Hidden, words: Translator) -> HiddenRow {
    let key = match hidden.what {
        HiddenKind::Column => "prove.hidden.column",
        HiddenKind::Added => "prove.hidden.added",
        HiddenKind::Simulated => "prove.hidden.simulated",
    };
    HiddenRow { name: hidden.name.clone(), what: words.t(key), sha256: hidden.sha256.clone() }
}

fn reference(known: &KnownRecord, words: Translator) -> ReferenceRow {
    let lang = words.lang;
    let interval = known.interval.map(|[low, high]| {
        if low == high {
            limit_digits(low, 6, lang)
        } else {
            format!("{} … {}", limit_digits(low, 6, lang), limit_digits(high, 6, lang))
        }
    });
    let found = known.found.as_ref().map(|f| {
        let [low, high] = f.ci95.map(|v| digits(v, 4, lang));
        let value = digits(f.value, 4, lang);
        words.with("explain.with_interval", &[("value", &value), ("interval", &format!("{low} … {high}"))])
    });
    ReferenceRow {
        what: known.what.in_language(lang.code()).to_owned(),
        known: interval.unwrap_or_default(),
        found: found.unwrap_or_default(),
        unit: known.unit.as_deref().map(|u| words.unit(u)).unwrap_or_default(),
        source: known.source.in_language(lang.code()).to_owned(),
    }
}

fn rule(rule: &RuleRecord, words: Translator) -> RuleRow {
    let (class, word) = if rule.holds { ("pass", "prove.rule.holds") } else { ("fail", "prove.rule.fails") };
    RuleRow {
        when: words.t(&format!("prove.short.{}", rule.when)),
        must: rule.must.say(words.lang),
        found: rule.found.say(words.lang),
        word: words.t(word),
        class,
    }
}

fn course_row(course: &CourseRecord, words: Translator) -> CourseRow {
    let lang = words.lang;
    let share = course.recovered_share.unwrap_or(course.correlation * course.correlation);
    CourseRow {
        name: course.name.clone(),
        correlation: digits(course.correlation, 3, lang),
        share: super::number::percent(share, lang),
        lag: duration(course.lag_s, lang),
        at_lag: digits(course.correlation_at_lag, 3, lang),
    }
}

fn step(step: &crate::record::ProtocolStep, words: Translator) -> StepView {
    let hash = |(name, hash): (&String, &String)| Field { label: name.clone(), value: hash.clone() };
    StepView {
        what: words.t(&format!("prove.step.{}", step.step)),
        hashes: step.sha256.iter().map(hash).collect(),
    }
}

fn files(words: Translator) -> Vec<FileView> {
    let rows = [
        ("proof.json", "prove.wrote.for_programs"),
        ("model.toml", "prove.wrote.claim"),
        ("report.html", "prove.wrote.page"),
        ("report.md", "prove.wrote.markdown"),
    ];
    rows.map(|(name, key)| FileView { name: name.to_owned(), what: words.t(key) }).to_vec()
}
