//! The document of a plan: the schedule of the next test, what it tells apart and why.

mod print;
mod sentence;

pub use super::files::{PlanContext, PlanFile};

use sentence::step;

use super::document::{Documented, Record};
use super::generator;
use super::number::{date_time, digits, limit_digits, percent};
use super::page::{Block, Column, Head, Lead, OnTerminal, Page, State, Step, Steps, Table, Value};
use super::translator::Translator;
use crate::figure::Figure;
use crate::i18n::Lang;
use crate::output::Kind;
use crate::plan::Plan;
use crate::plan::record::{AlternativePlan, CausePlan, PairPlan, PlanOutcome};
use print::{at_most, chance, title};

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

    fn page(&self, _: &[Figure], lang: Lang) -> Page {
        pages(self, Translator { lang })
    }

    /// The outcome in sentences, the schedule step by step, the explanations of each cause with what decides between
    /// them.
    fn on_terminal(&self, lang: Lang) -> Vec<Block> {
        let words = Translator { lang };
        let mut out = vec![Block::Head(head(self, words)), Block::Lead(lead(self, words))];
        let steps = steps(&self.plan, words);
        if !steps.items.is_empty() {
            out.extend([Block::heading(words.t("plan.heading.schedule")), Block::Steps(steps)]);
        }
        for cause in &self.plan.causes {
            out.push(Block::heading(words.t("plan.heading.alternatives")));
            out.push(Block::Table(alternatives(cause, words)));
            out.extend(cause.pairs.iter().map(|p| Block::Paragraph(sentence::why(p, words))));
        }
        out
    }
}

fn pages(file: &PlanFile, words: Translator) -> Page {
    let PlanFile { plan, context } = file;
    let head = head(file, words);
    let footer = [date_time(&context.planned_at), generator()];
    let identity = vec![Block::identity(identity(file, words))];
    let hint = |key: &str| Block::Hint(words.t(key));
    let schedule = |steps| {
        let below = vec![Block::Steps(steps), hint("plan.hint.schedule")];
        Block::section("", words.t("plan.heading.schedule"), below)
    };
    let cause = |cause: &CausePlan| {
        let pairs = (!cause.pairs.is_empty()).then(|| Block::Table(pairs(&cause.pairs, words)));
        let below = [hint("plan.hint.alternatives"), Block::Table(alternatives(cause, words))];
        let number = cause.cause.to_string();
        let heading = words.with("plan.heading.cause", &[("number", &number)]);
        Block::section("", heading, below.into_iter().chain(pairs).collect())
    };
    let compared = || {
        let below = vec![hint("plan.hint.candidates"), Block::Table(candidates(plan, words))];
        Block::section("", words.t("plan.heading.candidates"), below)
    };
    let method = vec![Block::Paragraph(words.t("plan.method"))];
    Page {
        title: format!("{} · {}", head.kind, head.title),
        generator: generator(),
        footer: footer.into_iter().filter(|p| !p.is_empty()).collect::<Vec<_>>().join(" · "),
        blocks: [
            Block::Head(head),
            Block::Lead(lead(file, words)),
            Block::section("identity", words.t("plan.heading.facts"), identity),
        ]
        .into_iter()
        .chain(Some(steps(plan, words)).filter(|s| !s.items.is_empty()).map(schedule))
        .chain(plan.causes.iter().map(cause))
        .chain((!plan.candidates.is_empty()).then(compared))
        .chain([
            Block::section("", words.t("plan.heading.method"), method),
            Block::section("", words.t("plan.heading.files"), vec![files(plan, words)]),
        ])
        .collect(),
    }
}

fn head(file: &PlanFile, words: Translator) -> Head {
    let (id, word) = match file.plan.outcome {
        PlanOutcome::Decides => ("pass", words.t("plan.outcome.decides")),
        PlanOutcome::NothingToDecide => ("pass", words.t("plan.outcome.nothing_to_decide")),
        PlanOutcome::TooShort => ("indeterminate", words.t("plan.outcome.too_short")),
        PlanOutcome::Undecidable => ("fail", words.t("plan.outcome.undecidable")),
    };
    Head {
        kind: words.t("plan.kind"),
        title: file.subject().unwrap_or(&file.context.explained).to_owned(),
        label: words.t("plan.outcome.title"),
        verdict: State { id: id.to_owned(), word },
        ..Head::default()
    }
}

/// The outcome in sentences, and what must be known.
fn lead(file: &PlanFile, words: Translator) -> Lead {
    let remarks = file.context.notes.iter().map(|n| words.say(n));
    let sentences = sentence::summary(&file.plan, words).into_iter().chain(remarks).collect();
    Lead { id: head(file, words).verdict.id, sentences }
}

fn steps(plan: &Plan, words: Translator) -> Steps {
    let all = plan.schedule.iter().flat_map(|s| &s.schedule.steps);
    let item = |s| Step { text: step(s, words), hashes: vec![] };
    Steps { class: "steps", items: all.map(item).collect() }
}

/// The explanations of a cause.
fn alternatives(cause: &CausePlan, words: Translator) -> Table {
    let all = || cause.alternatives.iter();
    let named = |a: &AlternativePlan| Value::Named { text: title(&a.kind, words), id: a.kind.clone() };
    let shows_as = |a: &AlternativePlan| match &a.shows_as {
        None => words.t("plan.shows.nothing"),
        Some(kind) if *kind == a.kind => words.t("plan.shows.itself"),
        Some(kind) => title(kind, words),
    };
    let found = words.number_column("plan.column.found").on_terminal(OnTerminal::Hidden);
    Table::new("cards", cause.alternatives.len())
        .column(words.column("plan.column.alternative"), all().map(named))
        .column(words.column("plan.column.shows_as"), all().map(shows_as))
        .column(found, all().map(|a| chance(a.found, words)))
        .column(words.number_column("plan.column.alone"), all().map(|a| at_most(a.probability, words)))
}

/// Two explanations each, and how the schedule tells them apart.
fn pairs(pairs: &[PairPlan], words: Translator) -> Table {
    let distance = |p: &PairPlan| digits(p.squared_distance.sqrt(), 2, words.lang);
    Table::new("cards", pairs.len())
        .column(words.column("plan.column.truth"), pairs.iter().map(|p| title(&p.truth, words)))
        .column(words.column("plan.column.against"), pairs.iter().map(|p| title(&p.against, words)))
        .column(words.number_column("plan.column.distance"), pairs.iter().map(distance))
        .column(words.number_column("plan.column.told"), pairs.iter().map(|p| chance(p.probability, words)))
        .column(words.column("plan.column.why"), pairs.iter().map(|p| sentence::why(p, words)))
}

/// The schedules that were compared, the chosen one first.
fn candidates(plan: &Plan, words: Translator) -> Table {
    let all = || plan.candidates.iter();
    let what = all().map(|c| Value::List {
        items: c.schedule.steps.iter().map(|s| step(s, words)).collect(),
        ordered: true,
    });
    let schedules = Table::new("compared", plan.candidates.len())
        .column(words.column("plan.column.schedule"), what)
        .column(
            words.number_column("plan.column.hours"),
            all().map(|c| limit_digits(c.duration_h, 3, words.lang)),
        );
    let explanations = plan.causes.iter().flat_map(|c| &c.alternatives).enumerate();
    let mut table = explanations.fold(schedules, |table, (i, a)| {
        let named_alone = |p: Option<&f64>| p.map(|p| chance(*p, words)).unwrap_or_default();
        table.column(
            Column::number(&a.kind, title(&a.kind, words)),
            all().map(|c| named_alone(c.probabilities.get(i))),
        )
    });
    if let Some(first) = table.rows.first_mut() {
        first.chosen = plan.schedule.is_some();
    }
    table
}

fn identity(file: &PlanFile, words: Translator) -> Vec<(String, String)> {
    let PlanFile { plan, context } = file;
    let hours = words.with("plan.hours", &[("hours", &limit_digits(plan.budget_h, 3, words.lang))]);
    let rows = [
        ("plan.fact.explained", context.explained.clone()),
        ("plan.fact.model", context.model.clone()),
        ("plan.fact.case", plan.case.clone()),
        ("plan.fact.budget", hours),
        ("plan.fact.asked", percent(plan.asked, words.lang)),
    ];
    rows.map(|(key, value)| (words.t(key), value)).into()
}

fn files(plan: &Plan, words: Translator) -> Block {
    let schedule = plan.schedule.as_ref().map(|_| ("schedule.toml", "plan.wrote.schedule"));
    let always = [
        ("plan.json", "plan.wrote.for_programs"),
        ("report.html", "plan.wrote.page"),
        ("report.md", "plan.wrote.markdown"),
    ];
    Block::files(schedule.into_iter().chain(always).map(|(name, key)| (name.to_owned(), words.t(key))))
}
