//! The document of a lot: which units pass, why others do not, and every quantity over all units.

mod matrix;
mod quantity;
mod reasons;

pub(super) use matrix::Matrix;
pub(super) use reasons::{condition_reason, measurand_reason, reasons, several_channels};

use super::document::{Documented, Record};
use super::number::date_time;
use super::page::{self, Block, Column, Head, OnTerminal, Page, State, Table, Value};
use super::translator::Translator;
use crate::estimate::Verdict;
use crate::figure::Figure;
use crate::i18n::Lang;
use crate::output::Kind;
use crate::record::{ConditionStatus, LotRecord, LotUnit, SerialSource};

impl Documented for LotRecord {
    fn record(&self) -> Record<'_> {
        Record::Lot(self)
    }

    fn kind(&self) -> Kind {
        Kind::Lot
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.procedure.id)
    }

    fn made_at(&self) -> &str {
        &self.session.evaluated_at
    }

    fn program_version(&self) -> Option<&str> {
        Some(&self.program.version)
    }

    fn page(&self, _: &[Figure], lang: Lang) -> Page {
        pages(self, Translator { lang })
    }

    /// The worst verdict and how many units have which, the units, and the reasons of those that do not pass.
    fn on_terminal(&self, lang: Lang) -> Vec<Block> {
        let words = Translator { lang };
        let units = worst_first(&self.units);
        let mut out = vec![
            Block::Head(head(self, words)),
            Block::Table(table(&units, words).only(&["serial", "recording", "met", "verdict"])),
        ];
        for unit in units {
            let reasons = reasons(unit, words);
            if !reasons.is_empty() {
                out.push(Block::heading(unit.serial()));
                out.extend(reasons.into_iter().map(Block::Paragraph));
            }
        }
        out.push(Block::Hint(serials(&self.units, words)));
        out
    }
}

/// The line of a unit that is done, and below it the first reason where it does not pass.
pub fn unit_done(unit: &LotUnit, lang: Lang) -> Vec<Block> {
    let words = Translator { lang };
    let head = Head {
        title: format!("{} · {}", unit.serial(), unit.recording),
        verdict: verdict(unit.verdict, words),
        ..Head::default()
    };
    let reason = reasons(unit, words).into_iter().next();
    std::iter::once(Block::Head(head)).chain(reason.map(Block::Paragraph)).collect()
}

/// `index.csv`: one row a unit, plain numbers, empty where there is none; the same in every language.
pub fn csv(lot: &LotRecord) -> String {
    let units: Vec<&LotUnit> = lot.units.iter().collect();
    page::csv(&quantity::with_values(table(&units, Translator { lang: Lang::En }), &units))
}

fn pages(lot: &LotRecord, words: Translator) -> Page {
    let head = head(lot, words);
    let generator = format!("{} {}", lot.program.name, lot.program.version);
    let footer = [&revision(lot, words), &date_time(&lot.session.evaluated_at), &generator];
    let columns = ["serial", "verdict", "met", "reasons", "recording"];
    let mut units = table(&worst_first(&lot.units), words).only(&columns);
    units.class = "units small cards";
    let units = vec![Block::Table(units), Block::Hint(serials(&lot.units, words))];
    let quantities = quantity::table(&lot.units, words);
    let matrix = Matrix::new(&worst_first(&lot.units)).table(words);
    let matrix = matrix.map(|table| Block::section("", words.t("lot.matrix"), vec![Block::Table(table)]));
    let over_all = [
        Block::SummaryEnd,
        Block::section("", words.t("lot.quantities"), vec![Block::Table(quantities.clone())]),
    ];
    let identity = Block::identity(identity(lot, words));
    Page {
        title: [head.title.as_str(), &head.size, &head.verdict.word].join(" · "),
        footer: footer.map(String::as_str).join(" · "),
        blocks: [Block::Head(head), Block::section("", words.t("lot.units"), units)]
            .into_iter()
            .chain(over_all.into_iter().filter(|_| !quantities.rows.is_empty()))
            .chain(matrix)
            .chain([Block::section("identity", words.t("report.identity"), vec![identity])])
            .collect(),
        generator,
    }
}

fn verdict(verdict: Verdict, words: Translator) -> State {
    State { id: verdict.id().to_owned(), word: words.verdict(verdict) }
}

fn head(lot: &LotRecord, words: Translator) -> Head {
    Head {
        kind: words.t("lot.kind"),
        title: words.local(&lot.procedure.title),
        size: words.with("lot.size", &[("n", &lot.units.len().to_string())]),
        label: words.t("lot.worst"),
        verdict: verdict(lot.verdict, words),
        counts: lot.counts.present().into_iter().map(|(v, n)| (verdict(v, words), n)).collect(),
        is_signed: false,
    }
}

/// The units: errors first, then failed, undecided, and passed ones; else in the order of the record.
fn worst_first(units: &[LotUnit]) -> Vec<&LotUnit> {
    let mut units: Vec<&LotUnit> = units.iter().collect();
    units.sort_by_key(|u| std::cmp::Reverse(u.verdict.max(Verdict::Pass)));
    units
}

/// Columns that every unit has: a row each.
fn table(units: &[&LotUnit], words: Translator) -> Table {
    let all = |of: fn(&LotUnit) -> String| units.iter().map(move |u| of(u)).collect::<Vec<_>>();
    let link =
        |u: &&LotUnit| Value::Link { text: u.serial().to_owned(), to: format!("./{}/report.html", u.folder) };
    let state = |u: &&LotUnit| Value::State(verdict(u.verdict, words));
    let why = |u: &&LotUnit| Value::List { items: reasons(u, words), ordered: false };
    let hashes = |u: &LotUnit| u.files.iter().map(|f| f.sha256.as_str()).collect::<Vec<_>>().join(" ");
    let program = |name: &str| Column::text(name, "");
    Table::new("", units.len())
        .column(
            Column::text("serial", words.t("report.serial")).short(words.name("terminal_column", "unit")),
            units.iter().map(link),
        )
        .column(program("serial_from"), all(|u| u.serial_from.id().to_owned()))
        .column(Column::text("verdict", words.t("report.verdict")), units.iter().map(state))
        .column(
            Column::text("recording", words.t("report.recording"))
                .class("recording")
                .on_terminal(OnTerminal::Optional),
            all(|u| u.recording.clone()),
        )
        .column(program("sha256"), all(hashes))
        .column(program("folder"), all(|u| u.folder.clone()))
        .column(program("limits"), all(|u| u.measurands.len().to_string()))
        .column(program("limits_met"), all(|u| count(u, Verdict::Pass)))
        .column(
            Column::text("met", words.name("terminal_column", "met")).class("whole").for_pages(),
            units.iter().map(|u| met(u, words)),
        )
        .column(program("limits_failed"), all(|u| count(u, Verdict::Fail)))
        .column(program("limits_undecided"), all(|u| count(u, Verdict::Indeterminate)))
        .column(program("conditions_not_met"), all(|u| not_met(u).to_string()))
        .column(Column::text("reasons", words.t("report.reasons")).class("why"), units.iter().map(why))
}

fn count(unit: &LotUnit, verdict: Verdict) -> String {
    unit.measurands.iter().filter(|m| m.verdict == verdict).count().to_string()
}

fn not_met(unit: &LotUnit) -> usize {
    unit.conditions.iter().filter(|c| c.status == ConditionStatus::Invalid).count()
}

/// How many limits are met, in words; empty without a limit.
fn met(unit: &LotUnit, words: Translator) -> String {
    if unit.measurands.is_empty() {
        return String::new();
    }
    let all = unit.measurands.len().to_string();
    words.with("terminal.met", &[("met", &count(unit, Verdict::Pass)), ("all", &all)])
}

/// How many serial numbers were taken from where.
fn serials(units: &[LotUnit], words: Translator) -> String {
    let of = |source: SerialSource| units.iter().filter(|u| u.serial_from == source).count();
    let parts: Vec<String> = SerialSource::ALL
        .into_iter()
        .map(|source| (source, of(source)))
        .filter(|(_, n)| *n > 0)
        .map(|(source, n)| format!("{} ({n})", words.name("serial_from", source.id())))
        .collect();
    words.with("lot.serials", &[("sources", &parts.join("; "))])
}

fn revision(lot: &LotRecord, words: Translator) -> String {
    let p = &lot.procedure;
    words.with("report.id_revision", &[("id", &p.id), ("revision", &p.revision)])
}

fn identity(lot: &LotRecord, words: Translator) -> Vec<(String, String)> {
    let limits = lot.procedure.limits.as_ref().map(|l| {
        let id = words.with("report.id_revision", &[("id", &l.id), ("revision", &l.revision)]);
        format!("{} ({id})", words.local(&l.title))
    });
    let rows = [
        ("report.procedure", Some(revision(lot, words))),
        ("report.standard", lot.procedure.standard.as_ref().map(|s| words.local(s))),
        ("report.limits", limits),
        ("report.station", lot.session.station.clone()),
        ("report.operator", lot.session.operator.clone()),
        ("report.evaluated_at", Some(date_time(&lot.session.evaluated_at))),
        ("report.program", Some(format!("{} {}", lot.program.name, lot.program.version))),
    ];
    rows.map(|(key, value)| (words.t(key), value.unwrap_or_default())).into()
}
