//! The page of a day of a watched folder: what was tested, and what was not and why.

use super::document::{Documented, Record};
use super::lot::reasons;
use super::number::date_time;
use super::page::{Block, Column, Head, Page, State, Table, Value};
use super::translator::Translator;
use crate::estimate::Verdict;
use crate::figure::Figure;
use crate::i18n::Lang;
use crate::output::Kind;
use crate::record::{DayRecord, DayTest, HookState};

/// Folder of the results, relative to that of a day.
pub const RESULTS_FROM_DAY: &str = "../../results";

impl Documented for DayRecord {
    fn record(&self) -> Record<'_> {
        Record::Day(self)
    }

    fn kind(&self) -> Kind {
        Kind::Day
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.day)
    }

    fn made_at(&self) -> &str {
        &self.made_at
    }

    fn program_version(&self) -> Option<&str> {
        Some(&self.program.version)
    }

    fn page(&self, _: &[Figure], lang: Lang) -> Page {
        pages(self, Translator { lang })
    }

    /// The worst verdict with the counts, and what was not tested: each test was told when it was done.
    fn on_terminal(&self, lang: Lang) -> Vec<Block> {
        let words = Translator { lang };
        let untested = (!self.untested.is_empty()).then(|| Block::Table(untested(self, words)));
        std::iter::once(Block::Head(head(self, words))).chain(untested).collect()
    }
}

fn pages(day: &DayRecord, words: Translator) -> Page {
    let head = head(day, words);
    let generator = format!("{} {}", day.program.name, day.program.version);
    let section = |key: &str, table: Table| {
        (!table.rows.is_empty()).then(|| Block::section("", words.t(key), vec![Block::Table(table)]))
    };
    let nothing = day.tests.is_empty().then(|| Block::Hint(words.t("day.nothing")));
    let identity = Block::identity(identity(day, words));
    Page {
        title: [head.kind.as_str(), &head.title].join(" · "),
        footer: [&head.title, &date_time(&day.made_at), &generator].map(String::as_str).join(" · "),
        blocks: std::iter::once(Block::Head(head))
            .chain(section("day.tests", tests(day, words)))
            .chain(nothing)
            .chain(section("day.untested", untested(day, words)))
            .chain([Block::section("identity", words.t("report.identity"), vec![identity])])
            .collect(),
        generator,
    }
}

fn verdict(verdict: Verdict, words: Translator) -> State {
    State { id: verdict.id().to_owned(), word: words.verdict(verdict) }
}

fn head(day: &DayRecord, words: Translator) -> Head {
    Head {
        kind: words.t("day.kind"),
        title: day.day.clone(),
        size: words.with("day.size", &[("n", &day.tests.len().to_string())]),
        label: words.t("lot.worst"),
        verdict: if day.tests.is_empty() { State::default() } else { verdict(day.verdict, words) },
        counts: day.counts.present().into_iter().map(|(v, n)| (verdict(v, words), n)).collect(),
        is_signed: false,
    }
}

/// The tests, the last one first.
fn tests(day: &DayRecord, words: Translator) -> Table {
    let all = || day.tests.iter().rev();
    let link = |t: &DayTest| Value::Link {
        text: t.unit.serial().to_owned(),
        to: format!("{RESULTS_FROM_DAY}/{}/report.html", t.unit.folder),
    };
    let hook = |t: &DayTest| match t.hook {
        HookState::None => String::new(),
        state => words.name("day.hook", state.id()),
    };
    let why = |t: &DayTest| Value::List { items: reasons(&t.unit, words), ordered: false };
    let table = Table::new("units small cards", day.tests.len())
        .column(Column::text("serial", words.t("report.serial")), all().map(link))
        .column(
            Column::text("verdict", words.t("report.verdict")),
            all().map(|t| Value::State(verdict(t.unit.verdict, words))),
        )
        .column(Column::text("reasons", words.t("report.reasons")).class("why"), all().map(why))
        .column(
            Column::text("recording", words.t("report.recording")).class("recording"),
            all().map(|t| t.unit.recording.clone()),
        )
        .column(Column::text("procedure", words.t("report.procedure")), all().map(|t| t.procedure.clone()))
        .column(words.column("day.column.tested_at"), all().map(|t| date_time(&t.tested_at)));
    if day.tests.iter().all(|t| t.hook == HookState::None) {
        return table;
    }
    table.column(words.column("day.column.hook"), all().map(hook))
}

fn untested(day: &DayRecord, words: Translator) -> Table {
    let why = day.untested.iter().map(|u| words.say(&u.why));
    Table::new("cards", day.untested.len())
        .column(
            Column::text("recording", words.t("report.recording")),
            day.untested.iter().map(|u| u.recording.clone()),
        )
        .column(Column::text("reason", words.t("report.reasons")).class("why"), why)
}

fn identity(day: &DayRecord, words: Translator) -> Vec<(String, String)> {
    let rows = [
        ("day.watched", day.watched.clone()),
        ("day.made_at", date_time(&day.made_at)),
        ("report.program", format!("{} {}", day.program.name, day.program.version)),
    ];
    rows.map(|(key, value)| (words.t(key), value)).into()
}
