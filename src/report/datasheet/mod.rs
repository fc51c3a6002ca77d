//! The document of a data sheet: the quantities of a lot with their bounds, and where every value comes from.

mod customer;
mod quantity;
mod shared;

use super::document::{Documented, Record};
use super::number::date_time;
use super::page::{Block, Head, Page, Table, Value};
use super::translator::Translator;
use super::view::FigureView;
use crate::acceptance::datasheet::figures::figure_id;
use crate::figure::Figure;
use crate::i18n::{Lang, Localize};
use crate::output::Kind;
use crate::record::{DataSheet, SheetAudience, SheetResult};
use quantity::Printed;
use shared::{condition, pairs_section, promise, size, title};

impl Documented for DataSheet {
    fn record(&self) -> Record<'_> {
        Record::DataSheet(self)
    }

    fn kind(&self) -> Kind {
        Kind::DataSheet
    }

    fn subject(&self) -> Option<&str> {
        self.model.as_deref()
    }

    fn made_at(&self) -> &str {
        &self.made_at
    }

    fn program_version(&self) -> Option<&str> {
        Some(&self.program.version)
    }

    fn page(&self, figures: &[Figure], lang: Lang) -> Page {
        pages(self, figures, Translator { lang })
    }

    /// The quantities with their medians and bounds, and what must be known.
    fn on_terminal(&self, lang: Lang) -> Vec<Block> {
        let words = Translator { lang };
        let columns = ["quantity", "units", "typical", "bound_true", "bound_measured", "largest"];
        let heading = format!("{} · {}", title(self, words), size(self, words));
        let table = quantity::table(&Printed::all(self, words), words).only(&columns);
        [Block::heading(heading), Block::Table(table)]
            .into_iter()
            .chain(promise(self, words).map(Block::Hint))
            .chain(self.notes.iter().map(|n| Block::Paragraph(n.say(lang))))
            .collect()
    }
}

fn pages(sheet: &DataSheet, figures: &[Figure], words: Translator) -> Page {
    let generator = format!("{} {}", sheet.program.name, sheet.program.version);
    let head = Head {
        kind: words.t("datasheet.kind"),
        title: title(sheet, words),
        size: size(sheet, words),
        ..Head::default()
    };
    let all = Printed::all(sheet, words);
    let is_for_customers = sheet.audience == SheetAudience::Customer;
    let kind = if is_for_customers { words.t("datasheet.customer.kind") } else { head.kind.clone() };
    let title = format!("{} · {kind}", head.title);
    let blocks = if is_for_customers {
        // One curve of each kind fits on the page; the others stand in the annex.
        let of = |kind| curves(sheet, figures, kind, words);
        let (mut shown, mut others) = (vec![], vec![]);
        for mut of_kind in [of(CurveKind::SigmaTau), of(CurveKind::OverTemperature)].map(Vec::into_iter) {
            shown.extend(of_kind.next());
            others.extend(of_kind);
        }
        let annex =
            [customer::annex(words)].into_iter().chain(detailed(sheet, &all, figures, words, others, None));
        // The summary has ended with the page for customers.
        let annex = annex.filter(|block| *block != Block::SummaryEnd);
        customer::blocks(sheet, &all, shown, words).into_iter().chain(annex).collect()
    } else {
        let of = |kind| curves(sheet, figures, kind, words);
        let curves = of(CurveKind::SigmaTau).into_iter().chain(of(CurveKind::OverTemperature)).collect();
        let below = detailed(sheet, &all, figures, words, curves, pairs_section(sheet, words));
        std::iter::once(Block::Head(head)).chain(below).collect()
    };
    Page { title, footer: format!("{} · {generator}", date_time(&sheet.made_at)), blocks, generator }
}

/// Kinds of curves over the units of a lot.
#[derive(Debug, Clone, Copy)]
enum CurveKind {
    SigmaTau,
    OverTemperature,
}

/// The curves of a kind, as they are drawn.
fn curves(sheet: &DataSheet, figures: &[Figure], kind: CurveKind, words: Translator) -> Vec<FigureView> {
    let ids: Vec<String> = match kind {
        CurveKind::SigmaTau => sheet.curves.iter().map(|c| format!("sigma_tau_{}", c.channel)).collect(),
        CurveKind::OverTemperature => {
            sheet.temperature_curves.iter().map(|c| format!("over_temperature_{}", c.channel)).collect()
        }
    };
    ids.iter().filter_map(|id| FigureView::find(figures, id, words)).collect()
}

/// What an engineer reads of a sheet, below its head.
fn detailed(
    sheet: &DataSheet,
    all: &[Printed<'_>],
    figures: &[Figure],
    words: Translator,
    curves: Vec<FigureView>,
    pairs: Option<Block>,
) -> Vec<Block> {
    let generator = format!("{} {}", sheet.program.name, sheet.program.version);
    let notes = Block::remarks(sheet.notes.iter().map(|n| n.say(words.lang)));
    let quantities = [Block::Table(quantity::table(all, words)), Block::Hint(words.t("datasheet.reading"))];
    let curves = curves.into_iter().map(|f| {
        Block::Section("figures", vec![Block::Figure(Box::new(FigureView { is_titled: true, ..f }))])
    });
    let each = all.iter().enumerate();
    let each = each.map(|(i, q)| q.section(FigureView::find(figures, &figure_id(i), words)));
    let facts = identity(sheet, words, &generator).into_iter();
    let facts = facts.chain(sheet.conditions.iter().map(|c| condition(c, words)));
    promise(sheet, words)
        .map(Block::Hint)
        .into_iter()
        .chain([
            Block::section(
                "",
                words.t("datasheet.quantities"),
                quantities.into_iter().chain(notes).collect(),
            ),
            Block::section("identity", words.t("datasheet.conditions"), vec![Block::identity(facts)]),
        ])
        .chain(pairs)
        .chain(curves)
        .chain((!all.is_empty()).then_some(Block::SummaryEnd))
        .chain(each)
        .chain([Block::section(
            "",
            words.t("datasheet.results"),
            vec![Block::Table(results(&sheet.results, words))],
        )])
        .collect()
}

fn identity(sheet: &DataSheet, words: Translator, generator: &str) -> Vec<(String, String)> {
    let p = &sheet.procedure;
    let revision = words.with("report.id_revision", &[("id", &p.id), ("revision", &p.revision)]);
    let rows = [
        ("report.procedure", if p.id.is_empty() { String::new() } else { revision }),
        ("datasheet.made_at", date_time(&sheet.made_at)),
        ("report.program", generator.to_owned()),
    ];
    rows.map(|(key, value)| (words.t(key), value)).into()
}

/// The results that count, each with its file.
fn results(results: &[SheetResult], words: Translator) -> Table {
    let verdict = |r: &SheetResult| Value::state(r.verdict.id(), words.verdict(r.verdict));
    let file = |r: &SheetResult| format!("{} · SHA-256 {}", r.path, r.sha256);
    Table::new("sources cards", results.len())
        .column(words.column("report.serial"), results.iter().map(|r| r.serial.clone()))
        .column(
            words.column("datasheet.column.lot").class("whole"),
            results.iter().map(|r| r.lot.clone().unwrap_or_default()),
        )
        .column(words.column("report.verdict"), results.iter().map(verdict))
        .column(words.column("report.file").class("hash"), results.iter().map(file))
}
