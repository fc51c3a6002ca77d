//! The view of a plan: words and printed numbers, ready for the templates and for the terminal.

mod print;
mod sentence;

pub use super::files::{PlanContext, PlanFile};

use sentence::step;

use super::document::{Contents, Documented, Record};
use super::explain::FileView;
use super::number::{date_time, digits, limit_digits, percent};
use super::translator::{Field, Translator};
use crate::figure::Figure;
use crate::i18n::Lang;
use crate::output::Kind;
use crate::plan::Plan;
use crate::plan::record::{AlternativePlan, CausePlan, PairPlan, PlanOutcome};
use print::{at_most, chance, title};
use serde::Serialize;

/// A step of the schedule.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepRow {
    /// Its number.
    pub number: usize,
    /// What to do.
    pub what: String,
}

/// An explanation of a cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AlternativeRow {
    /// Effect.
    pub kind: String,
    /// Its title.
    pub title: String,
    /// What the planned recording shows of it.
    pub shows_as: String,
    /// Probability that it is found, if it is true.
    pub found: String,
    /// Probability that it is named alone, if it is true.
    pub alone: String,
}

/// Two explanations under the schedule.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairRow {
    /// The one that is true.
    pub truth: String,
    /// The other.
    pub against: String,
    /// Distance in deviations of the noise.
    pub distance: String,
    /// Probability of telling them apart.
    pub probability: String,
    /// What decides.
    pub why: String,
}

/// A cause with its explanations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CauseView {
    /// Its number in the explanation.
    pub number: usize,
    /// Its explanations.
    pub alternatives: Vec<AlternativeRow>,
    /// Its pairs.
    pub pairs: Vec<PairRow>,
}

/// A schedule that was compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CandidateRow {
    /// What to do.
    pub what: Vec<String>,
    /// Length.
    pub hours: String,
    /// Probability of naming each explanation alone, if it is true.
    pub probabilities: Vec<String>,
    /// True for the one that was chosen.
    pub chosen: bool,
}

/// Everything that a plan shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlanView {
    /// Class of the outcome, for colours.
    pub outcome_class: &'static str,
    /// The outcome in a word.
    pub outcome_word: String,
    /// Case, or what was explained.
    pub title: String,
    /// The outcome in sentences.
    pub summary: Vec<String>,
    /// What must be known.
    pub remarks: Vec<String>,
    /// Explanation, model, budget.
    pub identity: Vec<Field>,
    /// The schedule.
    pub steps: Vec<StepRow>,
    /// Causes.
    pub causes: Vec<CauseView>,
    /// Schedules that were compared.
    pub candidates: Vec<CandidateRow>,
    /// Explanations in the order of the probabilities of candidates.
    pub heads: Vec<String>,
    /// Files of the folder.
    pub files: Vec<FileView>,
    /// Line at the foot of every page.
    pub footer: String,
    /// The program with its version.
    pub generator: String,
}

impl Documented for PlanFile {
    fn record(&self) -> Record<'_> {
        Record::Plan(self)
    }

    fn kind(&self) -> Kind {
        Kind::Plan
    }

    fn subject(&self) -> Option<&str> {
        Some(self.plan.case.as_str()).filter(|c| !c.is_empty())
    }

    fn made_at(&self) -> &str {
        &self.context.planned_at
    }

    fn contents(&self, _: &[Figure], lang: Lang) -> Contents {
        Contents::view("plan", &PlanView::new(self, lang), lang)
    }
}

impl PlanView {
    /// Builds the view.
    pub fn new(file: &PlanFile, lang: Lang) -> PlanView {
        let words = Translator { lang };
        let PlanFile { plan, context } = file;
        let (outcome_class, outcome_word) = match plan.outcome {
            PlanOutcome::Decides => ("pass", words.t("plan.outcome.decides")),
            PlanOutcome::NothingToDecide => ("pass", words.t("plan.outcome.nothing_to_decide")),
            PlanOutcome::TooShort => ("indeterminate", words.t("plan.outcome.too_short")),
            PlanOutcome::Undecidable => ("fail", words.t("plan.outcome.undecidable")),
        };
        let generator = format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"));
        let footer = [date_time(&context.planned_at), generator.clone()];
        let steps = plan.schedule.iter().flat_map(|s| &s.schedule.steps).enumerate();
        let candidates = plan.candidates.iter().enumerate();
        PlanView {
            outcome_class,
            outcome_word,
            title: if plan.case.is_empty() { context.explained.clone() } else { plan.case.clone() },
            summary: sentence::summary(plan, words),
            remarks: context.notes.iter().map(|n| words.say(n)).collect(),
            identity: identity(file, words),
            steps: steps.map(|(i, s)| StepRow { number: i + 1, what: step(s, words) }).collect(),
            causes: plan.causes.iter().map(|c| cause(c, words)).collect(),
            candidates: candidates
                .map(|(i, c)| CandidateRow {
                    what: c.schedule.steps.iter().map(|s| step(s, words)).collect(),
                    hours: limit_digits(c.duration_h, 3, lang),
                    probabilities: c.probabilities.iter().map(|p| chance(*p, words)).collect(),
                    chosen: i == 0 && plan.schedule.is_some(),
                })
                .collect(),
            heads: plan.causes.iter().flat_map(|c| &c.alternatives).map(|a| title(&a.kind, words)).collect(),
            files: files(plan, words),
            footer: footer.into_iter().filter(|p| !p.is_empty()).collect::<Vec<_>>().join(" · "),
            generator,
        }
    }
}

fn cause(cause: &CausePlan, words: Translator) -> CauseView {
    let alternative = |a: &AlternativePlan| AlternativeRow {
        kind: a.kind.clone(),
        title: title(&a.kind, words),
        shows_as: match &a.shows_as {
            None => words.t("plan.shows.nothing"),
            Some(kind) if *kind == a.kind => words.t("plan.shows.itself"),
            Some(kind) => title(kind, words),
        },
        found: chance(a.found, words),
        alone: at_most(a.probability, words),
    };
    let pair = |p: &PairPlan| PairRow {
        truth: title(&p.truth, words),
        against: title(&p.against, words),
        distance: digits(p.squared_distance.sqrt(), 2, words.lang),
        probability: chance(p.probability, words),
        why: sentence::why(p, words),
    };
    CauseView {
        number: cause.cause,
        alternatives: cause.alternatives.iter().map(alternative).collect(),
        pairs: cause.pairs.iter().map(pair).collect(),
    }
}

fn identity(file: &PlanFile, words: Translator) -> Vec<Field> {
    let PlanFile { plan, context } = file;
    let hours = words.with("plan.hours", &[("hours", &limit_digits(plan.budget_h, 3, words.lang))]);
    let rows = [
        ("plan.fact.explained", context.explained.clone()),
        ("plan.fact.model", context.model.clone()),
        ("plan.fact.case", plan.case.clone()),
        ("plan.fact.budget", hours),
        ("plan.fact.asked", percent(plan.asked, words.lang)),
    ];
    let field = |(key, value): (&str, String)| Field { label: words.t(key), value };
    rows.into_iter().filter(|(_, value)| !value.trim().is_empty()).map(field).collect()
}

fn files(plan: &Plan, words: Translator) -> Vec<FileView> {
    let schedule = plan.schedule.as_ref().map(|_| ("schedule.toml", "plan.wrote.schedule"));
    let always = [
        ("plan.json", "plan.wrote.for_programs"),
        ("report.html", "plan.wrote.page"),
        ("report.md", "plan.wrote.markdown"),
    ];
    let row = |(name, key): (&str, &str)| FileView { name: name.to_owned(), what: words.t(key) };
    schedule.into_iter().chain(always).map(row).collect()
}
