//! The document of a rehearsal: how likely the test passes, fails or stays open, what costs its hours, and the shortest length that keeps the risk.

use super::document::{Documented, Record};
use super::history::share;
use super::number::{date_time, digits, limit, limit_digits, percent};
use super::page::{Block, Column, Head, Lead, OnTerminal, Page, State, Table, Value};
use super::translator::Translator;
use crate::figure::Figure;
use crate::i18n::Lang;
use crate::output::Kind;
use crate::record::{NeededLength, NominalValue, RehearsalRecord, RehearsedLength, VerdictCounts};

impl Documented for RehearsalRecord {
    fn record(&self) -> Record<'_> {
        Record::Rehearsal(self)
    }

    fn kind(&self) -> Kind {
        Kind::Rehearsal
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.procedure.id)
    }

    fn made_at(&self) -> &str {
        &self.made_at
    }

    fn program_version(&self) -> Option<&str> {
        Some(&self.program.version)
    }

    fn page(&self, _: &[Figure], lang: Lang) -> Page {
        let words = Translator { lang };
        let generator = format!("{} {}", self.program.name, self.program.version);
        let identity = Block::identity(identity(self, words));
        let method = vec![Block::Paragraph(words.t("rehearsal.method"))];
        let head = head(self, words);
        Page {
            title: [head.kind.as_str(), &head.title].join(" · "),
            footer: [&head.title, &date_time(&self.made_at), &generator].map(String::as_str).join(" · "),
            blocks: body(self, words)
                .into_iter()
                .chain([
                    Block::section("", words.t("rehearsal.heading.method"), method),
                    Block::section("identity", words.t("report.identity"), vec![identity]),
                ])
                .collect(),
            generator,
        }
    }

    fn on_terminal(&self, lang: Lang) -> Vec<Block> {
        body(self, Translator { lang })
    }
}

/// What stands on the page and on the terminal.
fn body(record: &RehearsalRecord, words: Translator) -> Vec<Block> {
    let mut blocks = vec![Block::Head(head(record, words)), Block::Lead(lead(record, words))];
    let section = |key: &str, table: Table| Block::section("", words.t(key), vec![Block::Table(table)]);
    blocks.push(section("rehearsal.heading.lengths", lengths(record, words)));
    if !record.needed.is_empty() {
        blocks.push(section("rehearsal.heading.needed", needed(record, words)));
    }
    for length in &record.lengths {
        let hours = hours(length.length_h, words);
        let heading = |key: &str| words.with(key, &[("length", &hours)]);
        let rows = vec![Block::Table(rows(length, words))];
        blocks.push(Block::section("", heading("rehearsal.heading.rows"), rows));
        if !length.levels.is_empty() {
            let levels = vec![Block::Table(levels(length, words))];
            blocks.push(Block::section("", heading("rehearsal.heading.levels"), levels));
        }
    }
    blocks.push(section("rehearsal.heading.nominal", nominal(record, words)));
    blocks
}

fn head(record: &RehearsalRecord, words: Translator) -> Head {
    let (id, key) = match record.shortest_h {
        Some(_) => ("pass", "rehearsal.outcome.decides"),
        None => ("indeterminate", "rehearsal.outcome.open"),
    };
    Head {
        kind: words.t("rehearsal.kind"),
        title: words.local(&record.procedure.title),
        label: words.t("rehearsal.outcome.title"),
        verdict: State { id: id.to_owned(), word: words.t(key) },
        ..Head::default()
    }
}

/// The answer in sentences: the shortest length, the row that costs the hours, and what must be known.
fn lead(record: &RehearsalRecord, words: Translator) -> Lead {
    let risk = percent(record.stated_risk, words.lang);
    let shortest = match record.shortest_h {
        Some(h) => words.with("rehearsal.shortest", &[("length", &hours(h, words)), ("risk", &risk)]),
        None => words.with("rehearsal.none_keeps", &[("risk", &risk)]),
    };
    let costs = record.needed.first().map(|n| {
        let name = words.name("measurand", &n.id);
        match n.needed_h {
            Some(h) => words.with("rehearsal.costs", &[("name", &name), ("length", &hours(h, words))]),
            None => words.with("rehearsal.never", &[("name", &name)]),
        }
    });
    let notes = record.notes.iter().map(|n| words.say(n));
    Lead {
        id: head(record, words).verdict.id,
        sentences: [shortest].into_iter().chain(costs).chain(notes).collect(),
    }
}

/// A length in hours.
fn hours(length_h: f64, words: Translator) -> String {
    words.quantity(&limit(length_h, words.lang), "h")
}

/// Shares of pass, fail and neither, in percent.
fn shares(counts: &VerdictCounts, words: Translator) -> [String; 3] {
    let of = |n: usize| match counts.total() {
        0 => "–".to_owned(),
        all => format!("{}\u{202f}%", limit_digits(100.0 * n as f64 / all as f64, 3, words.lang)),
    };
    [of(counts.pass), of(counts.fail), of(counts.indeterminate + counts.error + counts.none)]
}

/// Headings of the shares of pass, fail and neither.
const OF_TEST: [&str; 3] = ["rehearsal.column.pass", "rehearsal.column.fail", "rehearsal.column.open"];
const OF_WHOLE: [&str; 3] =
    ["rehearsal.column.whole_pass", "rehearsal.column.whole_fail", "rehearsal.column.whole_open"];
const OF_ROW: [&str; 3] =
    ["rehearsal.column.row_pass", "rehearsal.column.row_fail", "rehearsal.column.row_open"];

/// A table with the shares of verdicts behind its own columns.
fn with_shares(
    table: Table,
    headings: [&str; 3],
    on_terminal: OnTerminal,
    counts: &[VerdictCounts],
    words: Translator,
) -> Table {
    headings.into_iter().enumerate().fold(table, |table, (i, key)| {
        let column = words.number_column(key).on_terminal(on_terminal);
        table.column(column, counts.iter().map(|c| shares(c, words).into_iter().nth(i).unwrap_or_default()))
    })
}

fn lengths(record: &RehearsalRecord, words: Translator) -> Table {
    let all = || record.lengths.iter();
    let risk = |s: &Option<_>| s.as_ref().map_or_else(|| "–".to_owned(), |s| share(s, words));
    let table = Table::new("cards", record.lengths.len())
        .column(words.number_column("rehearsal.column.length"), all().map(|l| hours(l.length_h, words)));
    let counts: Vec<VerdictCounts> = all().map(|l| l.nominal).collect();
    with_shares(table, OF_TEST, OnTerminal::Shown, &counts, words)
        .column(words.column("rehearsal.column.producer"), all().map(|l| risk(&l.producers_risk)))
        .column(words.column("rehearsal.column.consumer"), all().map(|l| risk(&l.consumers_risk)))
}

fn named(id: &str, words: Translator) -> Value {
    Value::Named { text: words.name("measurand", id), id: id.to_owned() }
}

fn needed(record: &RehearsalRecord, words: Translator) -> Table {
    let all = || record.needed.iter();
    let at = |n: &NeededLength| words.quantity(&limit(n.limit, words.lang), &n.unit);
    let length = |n: &NeededLength| match n.needed_h {
        Some(h) => words.quantity(&digits(h, 2, words.lang), "h"),
        None => words.t("rehearsal.above_1000_h"),
    };
    Table::new("cards", record.needed.len())
        .column(words.column("rehearsal.column.quantity"), all().map(|n| named(&n.id, words)))
        .column(words.column("rehearsal.column.channel"), all().map(|n| n.channel.clone()))
        .column(words.number_column("rehearsal.column.limit"), all().map(at))
        .column(words.number_column("rehearsal.column.needed"), all().map(length))
}

fn rows(length: &RehearsedLength, words: Translator) -> Table {
    let all = || length.rows.iter();
    let table = Table::new("cards", length.rows.len())
        .column(words.column("rehearsal.column.quantity"), all().map(|r| named(&r.id, words)))
        .column(words.column("rehearsal.column.channel"), all().map(|r| words.channel(&r.channel, &r.id)));
    with_shares(table, OF_TEST, OnTerminal::Shown, &all().map(|r| r.counts).collect::<Vec<_>>(), words)
}

fn levels(length: &RehearsedLength, words: Translator) -> Table {
    let all = || length.levels.iter();
    let table = Table::new("cards", length.levels.len())
        .column(words.column("rehearsal.column.quantity"), all().map(|l| named(&l.id, words)))
        .column(
            words.number_column("rehearsal.column.factor"),
            all().map(|l| limit_digits(l.factor, 3, words.lang)),
        )
        .column(
            words.number_column("rehearsal.column.value").on_terminal(OnTerminal::Hidden),
            all().map(|l| words.quantity(&digits(l.value, 3, words.lang), &l.unit)),
        );
    let table =
        with_shares(table, OF_WHOLE, OnTerminal::Shown, &all().map(|l| l.whole).collect::<Vec<_>>(), words);
    // A terminal has no room for the shares of the row beside those of the test.
    with_shares(table, OF_ROW, OnTerminal::Hidden, &all().map(|l| l.row).collect::<Vec<_>>(), words)
}

fn nominal(record: &RehearsalRecord, words: Translator) -> Table {
    let all = || record.nominal.iter();
    let value = |n: &NominalValue| words.quantity(&digits(n.value, 4, words.lang), &n.unit);
    Table::new("cards", record.nominal.len())
        .column(words.column("rehearsal.column.quantity"), all().map(|n| named(&n.id, words)))
        .column(words.number_column("rehearsal.column.value"), all().map(value))
        .column(
            Column::text("from", words.t("rehearsal.column.from")),
            all().map(|n| words.name("rehearsal.from", n.from.id())),
        )
}

fn identity(record: &RehearsalRecord, words: Translator) -> Vec<(String, String)> {
    let number = |v: f64| limit_digits(v, 6, words.lang);
    let rows = [
        ("report.procedure", Some(record.procedure.id.clone())),
        ("rehearsal.limits", record.procedure.limits.as_ref().map(|l| l.id.clone())),
        ("rehearsal.model", record.model.clone()),
        ("rehearsal.units", Some(record.units.to_string())),
        ("rehearsal.rate", Some(words.quantity(&number(record.sample_rate_hz), "Hz"))),
        ("rehearsal.seed", Some(record.seed.to_string())),
        ("rehearsal.made_at", Some(date_time(&record.made_at))),
        ("report.program", Some(format!("{} {}", record.program.name, record.program.version))),
    ];
    rows.into_iter().filter_map(|(key, value)| Some((words.t(key), value?))).collect()
}
