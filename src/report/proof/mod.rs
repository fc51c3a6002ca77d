//! The document of a proof: what was hidden, what was said, what was true, side by side.

use super::document::{Documented, Record};
use super::explain::{fit, fit_summary, lead as lead_of, verdict as verdict_of};
use super::generator;
use super::number::{count, date_time, digits, duration, limit_digits, percent};
use super::page::{
    Block, Head, Heading, Layout, Lead, Listed, OnTerminal, Page, Quantity, State, Step, Steps, Table, Value,
};
use super::translator::Translator;
use super::view::FigureView;
use crate::figure::Figure;
use crate::i18n::{Lang, Localize};
use crate::output::Kind;
use crate::record::explanation::Explanation;
use crate::record::{
    ClaimOrigin, CourseRecord, Hidden, HiddenKind, KnownRecord, ProofOutcome, ProofRecord, ProtocolStep,
    RuleRecord,
};

/// Figures of the explanation while something was concealed begin so.
pub const CONCEALED: &str = "concealed_";

/// Figures of the explanation with the columns shown begin so.
pub const UNVEILED: &str = "unveiled_";

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

    /// A folder is named after the file of the proof, which the verb knows.
    fn folder_name(&self) -> Option<&str> {
        None
    }

    fn made_at(&self) -> &str {
        &self.proved_at
    }

    fn program_version(&self) -> Option<&str> {
        Some(&self.program.version)
    }

    fn page(&self, figures: &[Figure], lang: Lang) -> Page {
        pages(self, figures, Translator { lang })
    }

    /// The outcome, what the engine said each time, and each rule with what was found.
    fn on_terminal(&self, lang: Lang) -> Vec<Block> {
        let words = Translator { lang };
        let head = head(self, words);
        let lead = Lead { id: head.verdict.id.clone(), sentences: vec![summary(self, words)] };
        let mut out = vec![Block::Head(head), Block::Lead(lead)];
        for said in Said::all(self, words) {
            let sentences = lead_of(said.of, words).sentences;
            out.push(Block::heading(said.title));
            out.extend(sentences.into_iter().map(Block::Paragraph));
        }
        out.push(Block::heading(words.t("prove.heading.rules")));
        out.push(Block::Table(rules(&self.rules, words)));
        out
    }
}

fn pages(record: &ProofRecord, figures: &[Figure], words: Translator) -> Page {
    let head = head(record, words);
    let question = record.question.in_language(words.lang.code()).to_owned();
    let lead = Lead { id: head.verdict.id.clone(), sentences: vec![question, summary(record, words)] };
    let said = Said::all(record, words);
    let footer = [record.path.clone(), date_time(&record.proved_at), generator()];
    let below = |key: &str, below: Vec<Block>| Block::section("", words.t(key), below);
    let course = |f: &Figure| !f.id.starts_with(CONCEALED) && !f.id.starts_with(UNVEILED);
    let drawn = drawn(figures, course, words).into_iter().take(1).collect::<Vec<_>>();
    let steps = Steps { class: "protocol", items: record.protocol.iter().map(|s| step(s, words)).collect() };
    let protocol = vec![Block::Hint(words.t("prove.hint.protocol")), Block::Steps(steps)];
    let courses = || {
        let hint = Block::Hint(words.t("prove.hint.courses"));
        below("prove.heading.courses", vec![Block::Table(courses(&record.courses, words)), hint])
    };
    Page {
        title: format!("{} · {}", head.kind, head.title),
        generator: generator(),
        footer: footer.join(" · "),
        blocks: [
            Block::Head(head),
            Block::Lead(lead),
            below("prove.heading.rules", vec![Block::Table(rules(&record.rules, words))]),
            Block::Section("beside", beside(record, &said, words)),
            Block::SummaryEnd,
        ]
        .into_iter()
        .chain((!record.courses.is_empty()).then(courses))
        .chain((!drawn.is_empty()).then_some(Block::Section("figures", drawn)))
        .chain(said.iter().map(|s| s.section(figures, words)))
        .chain([
            Block::section(
                "identity",
                words.t("prove.heading.facts"),
                vec![Block::identity(identity(record, words))],
            ),
            below("prove.heading.protocol", protocol),
            below("prove.heading.files", vec![files(words)]),
        ])
        .collect(),
    }
}

fn head(record: &ProofRecord, words: Translator) -> Head {
    let (id, outcome) = outcome(record);
    Head {
        kind: words.t("prove.kind"),
        title: record.title.in_language(words.lang.code()).to_owned(),
        label: words.t("prove.outcome.title"),
        verdict: State { id: id.to_owned(), word: words.t(&format!("prove.outcome.{outcome}")) },
        ..Head::default()
    }
}

/// Id of the colour of the outcome, and of its words.
fn outcome(record: &ProofRecord) -> (&'static str, &'static str) {
    match record.outcome {
        ProofOutcome::Holds => ("pass", "holds"),
        ProofOutcome::Fails => ("fail", "fails"),
    }
}

fn summary(record: &ProofRecord, words: Translator) -> String {
    let failed = record.rules.iter().filter(|r| !r.holds).count();
    let rules = count(record.rules.len() as u64, words.lang);
    let failed = count(failed as u64, words.lang);
    let (_, outcome) = outcome(record);
    words.with(&format!("prove.summary.{outcome}"), &[("n", &rules), ("failed", &failed)])
}

/// What was hidden, what was said, and what is known from elsewhere.
fn beside(record: &ProofRecord, said: &[Said<'_>], words: Translator) -> Vec<Block> {
    let is_hidden = !record.hidden.is_empty();
    let hint = if is_hidden { "prove.hint.hidden" } else { "prove.hint.nothing_hidden" };
    let hidden = is_hidden.then(|| Block::Table(hidden(&record.hidden, words)));
    let hidden = hidden.into_iter().chain([Block::Hint(words.t(hint))]).collect();
    let verdict = |s: &Said<'_>| {
        let verdict = Some(verdict_of(s.of, words));
        let heading = Heading { level: 3, text: s.title.clone().into(), verdict };
        let sentences = lead_of(s.of, words).sentences.into_iter().map(Block::Paragraph);
        std::iter::once(Block::Heading(heading)).chain(sentences).collect::<Vec<_>>()
    };
    let references = || {
        let table = Block::Table(references(&record.references, words));
        Block::section("", words.t("prove.heading.true"), vec![table])
    };
    [
        Block::section("", words.t("prove.heading.hidden"), hidden),
        Block::section("", words.t("prove.heading.said"), said.iter().flat_map(verdict).collect()),
    ]
    .into_iter()
    .chain((!record.references.is_empty()).then(references))
    .collect()
}

/// An explanation of the proof.
struct Said<'a> {
    title: String,
    /// Figures of it begin so.
    before: &'static str,
    of: &'a Explanation,
}

impl<'a> Said<'a> {
    /// What was said while something was concealed, and with it shown.
    fn all(record: &'a ProofRecord, words: Translator) -> Vec<Said<'a>> {
        let said = |key: &str, of: &'a Explanation, before| Said { title: words.t(key), before, of };
        let first = if record.hidden.is_empty() { "prove.when.only" } else { "prove.when.concealed" };
        let concealed = said(first, &record.concealed, CONCEALED);
        let unveiled = record.unveiled.as_ref().map(|u| said("prove.when.unveiled", u, UNVEILED));
        std::iter::once(concealed).chain(unveiled).collect()
    }

    /// Its figures, and the fit before and after.
    fn section(&self, figures: &[Figure], words: Translator) -> Block {
        let mut below = drawn(figures, |f| f.id.starts_with(self.before), words);
        below.push(Block::Table(fit("cards", self.of, words)));
        below.push(Block::Paragraph(fit_summary(self.of, words)));
        Block::section("figures", self.title.clone(), below)
    }
}

/// Some of the figures, each with its number among all.
fn drawn(figures: &[Figure], of: impl Fn(&Figure) -> bool, words: Translator) -> Vec<Block> {
    let own = figures.iter().zip(1..).filter(|(f, _)| of(f));
    own.map(|(f, number)| Block::Figure(Box::new(FigureView::of(f, number, words)))).collect()
}

fn identity(record: &ProofRecord, words: Translator) -> Vec<(String, String)> {
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
    fields.map(|(key, value)| (words.t(key), value)).into()
}

fn hidden(hidden: &[Hidden], words: Translator) -> Table {
    let what = |h: &Hidden| {
        words.t(match h.what {
            HiddenKind::Column => "prove.hidden.column",
            HiddenKind::Added => "prove.hidden.added",
            HiddenKind::Simulated => "prove.hidden.simulated",
        })
    };
    let hash = words.column("prove.fact.sha256");
    Table::new("", hidden.len())
        .column(words.column("prove.column.name"), hidden.iter().map(|h| Value::Code(h.name.clone())))
        .column(words.column("prove.column.what"), hidden.iter().map(what))
        .column(
            hash.class("hash").listed(Listed::Below("SHA-256 ".into())),
            hidden.iter().map(|h| Value::Digest(h.sha256.clone())),
        )
        .laid_out(Layout::List, Layout::Grid)
}

/// Facts known from elsewhere, and the finding for each.
fn references(all: &[KnownRecord], words: Translator) -> Table {
    let lang = words.lang;
    let unit = |r: &KnownRecord| r.unit.as_deref().map(|u| words.unit(u)).unwrap_or_default();
    let known = |r: &KnownRecord| {
        let printed = r.interval.map(|[low, high]| {
            let ends = [low, high].map(|v| limit_digits(v, 6, lang));
            if low == high { ends.into_iter().next().unwrap_or_default() } else { ends.join(" … ") }
        });
        Quantity { number: None, printed: printed.unwrap_or_default(), unit: unit(r) }
    };
    let found = |r: &KnownRecord| {
        let printed = r.found.as_ref().map(|f| {
            let interval = f.ci95.map(|v| digits(v, 4, lang)).join(" … ");
            let value = digits(f.value, 4, lang);
            words.with("explain.with_interval", &[("value", &value), ("interval", &interval)])
        });
        let number = r.found.as_ref().map(|f| f.value);
        Quantity { number, printed: printed.unwrap_or_default(), unit: unit(r) }
    };
    let found_word = words.t("prove.column.found");
    Table::new("", all.len())
        .column(words.column("prove.column.quantity"), all.iter().map(|r| r.what.in_language(lang.code())))
        .column(words.number_column("prove.column.known"), all.iter().map(known))
        .column(
            words.number_column("prove.column.found").listed(Listed::Below(format!("{found_word}: "))),
            all.iter().map(found),
        )
        .units(words.t("prove.column.unit"))
        .column(
            words.column("prove.column.source").class("hint").listed(Listed::Below(String::new())),
            all.iter().map(|r| r.source.in_language(lang.code())),
        )
        .laid_out(Layout::List, Layout::Grid)
}

fn rules(rules: &[RuleRecord], words: Translator) -> Table {
    let holds = |r: &RuleRecord| {
        let (id, key) = if r.holds { ("pass", "prove.rule.holds") } else { ("fail", "prove.rule.fails") };
        Value::state(id, words.t(key))
    };
    Table::new("cards", rules.len())
        .column(
            words.column("prove.column.must"),
            rules.iter().map(|r| Value::Sentence(r.must.say(words.lang))),
        )
        .column(
            words.column("prove.column.when").on_terminal(OnTerminal::Bracketed),
            rules.iter().map(|r| words.t(&format!("prove.short.{}", r.when))),
        )
        .column(
            words.column("prove.column.found"),
            rules.iter().map(|r| Value::Sentence(r.found.say(words.lang))),
        )
        .column(words.column("prove.column.holds"), rules.iter().map(holds))
}

/// Inferred courses, each against something that was concealed.
fn courses(courses: &[CourseRecord], words: Translator) -> Table {
    let lang = words.lang;
    let share = |c: &CourseRecord| percent(c.recovered_share.unwrap_or(c.correlation * c.correlation), lang);
    Table::new("cards", courses.len())
        .column(words.column("prove.column.name"), courses.iter().map(|c| Value::Code(c.name.clone())))
        .column(
            words.number_column("prove.column.correlation"),
            courses.iter().map(|c| digits(c.correlation, 3, lang)),
        )
        .column(words.number_column("prove.column.share"), courses.iter().map(share))
        .column(words.number_column("prove.column.lag"), courses.iter().map(|c| duration(c.lag_s, lang)))
        .column(
            words.number_column("prove.column.at_lag"),
            courses.iter().map(|c| digits(c.correlation_at_lag, 3, lang)),
        )
}

fn step(step: &ProtocolStep, words: Translator) -> Step {
    let hash = |(name, hash): (&String, &String)| (name.clone(), hash.clone());
    Step {
        text: words.t(&format!("prove.step.{}", step.step)),
        hashes: step.sha256.iter().map(hash).collect(),
    }
}

fn files(words: Translator) -> Block {
    let rows = [
        ("proof.json", "prove.wrote.for_programs"),
        ("model.toml", "prove.wrote.claim"),
        ("report.html", "prove.wrote.page"),
        ("report.md", "prove.wrote.markdown"),
    ];
    Block::files(rows.map(|(name, key)| (name.to_owned(), words.t(key))))
}
