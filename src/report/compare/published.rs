//! The published tables, printed.

use crate::acceptance::compare::published::{Checked, CheckedRow, Row1, Row2};
use crate::i18n::{Lang, decimal, lookup};
use crate::report::number::{digits, limit};
use crate::report::page::{Block, Column, Quantity, Table, Value};
use crate::report::translator::Translator;

/// The columns of a terminal.
const ON_TERMINAL: [&str; 9] = [
    "device_marked",
    "sigma100_deg_h",
    "bias_instability_deg_h",
    "ratio_printed",
    "ratio_computed",
    "arw_russian_deg_rt_h",
    "n_deg_rt_h",
    "sigma100_over_six_n",
    "sigma10_over_sigma100",
];

/// Table 2 with what was computed from each row: a device a row.
pub(super) fn table(checked: &Checked, words: Translator) -> Table {
    let rows = &checked.rows;
    let program = |name: &str| Column::text(name, "");
    let column = |name: &str, head: &str| Column::number(name, words.t(&format!("compare.column.{head}")));
    let printed = |value: fn(&CheckedRow) -> f64, text: fn(&Row2) -> &str| {
        rows.iter().map(move |r| quantity(value(r), decimal(text(&r.printed), words.lang)))
    };
    let computed = |value: fn(&CheckedRow) -> f64, count: usize| {
        rows.iter().map(move |r| quantity(value(r), digits(value(r), count, words.lang)))
    };
    let ids = |r: &CheckedRow| r.remarks.iter().map(|n| n.id.as_ref()).collect::<Vec<&str>>().join(";");
    Table::new("ratios", rows.len())
        .column(program("device"), rows.iter().map(|r| r.device.clone()))
        .column(
            Column::text("device_marked", words.t("compare.column.unit")).for_pages(),
            rows.iter().map(|r| marked(r, words.lang)),
        )
        .column(column("sigma100_deg_h", "sigma100"), printed(|r| r.sigma100, |p| &p.sigma100))
        .column(
            column("bias_instability_deg_h", "bias_instability"),
            printed(|r| r.bias_instability, |p| &p.bias_instability),
        )
        .column(column("ratio_printed", "printed"), printed(|r| r.ratio_printed, |p| &p.bias_ratio))
        .column(column("ratio_computed", "computed"), computed(|r| r.ratio, 3).map(Value::strong))
        .column(column("arw_russian_deg_rt_h", "arw"), printed(|r| r.arw_russian, |p| &p.arw_russian))
        .column(column("n_deg_rt_h", "n_allan"), printed(|r| r.n, |p| &p.n))
        .column(column("arw_ratio_printed", "printed"), printed(|r| r.arw_ratio_printed, |p| &p.arw_ratio))
        .column(column("arw_ratio_computed", "computed"), computed(|r| r.arw_ratio, 3).map(Value::strong))
        .column(column("six_n_deg_h", "six_n"), computed(|r| r.six_n, 3))
        .column(column("sigma100_over_six_n", "over_six_n"), computed(|r| r.over_six_n, 3))
        .column(column("crossover_h", "crossover"), computed(|r| r.crossover_h, 2))
        .column(column("sigma10_over_sigma100", "steep"), computed(|r| r.sigma10_over_sigma100, 3))
        .column(program("n_table1_deg_rt_h"), rows.iter().map(|r| r.n_table1))
        .column(program("remarks"), rows.iter().map(ids))
}

/// The tables as printed, with what follows from each row.
pub(super) fn blocks(checked: &Checked, words: Translator) -> Vec<Block> {
    let source = words.with("compare.published.source", &[("source", &words.t("compare.published.cited"))]);
    let of_device = |r: &CheckedRow| {
        let remarks = Block::remarks(r.remarks.iter().map(|n| words.say(n)));
        std::iter::once(Block::subheading(device(&r.device, words.lang))).chain(remarks).collect::<Vec<_>>()
    };
    // Columns without a head are for programs.
    let table2 = Block::Table(table(checked, words).with(|c| !c.head.is_empty()));
    let table2 = [table2, Block::Hint(words.t("compare.more.flagged"))].into_iter();
    let whole = Block::remarks(checked.remarks.iter().map(|n| words.say(n)));
    let whole = whole.into_iter().chain([Block::Table(null(checked, words))]);
    vec![
        Block::Hint(format!("{source} {}", words.t("compare.more.units"))),
        Block::section(
            "",
            words.t("compare.published.table2"),
            table2.chain(checked.rows.iter().flat_map(of_device)).collect(),
        ),
        Block::section("", words.t("compare.published.whole"), whole.collect()),
        Block::section(
            "",
            words.t("compare.published.table1"),
            vec![Block::Table(table1(&checked.table1, words))],
        ),
    ]
}

/// Table 2 with the remarks on its rows, and on the whole.
pub(super) fn on_terminal(checked: &Checked, words: Translator) -> Vec<Block> {
    let of_device = |r: &CheckedRow| {
        let name = device(&r.device, words.lang);
        r.remarks.iter().map(|n| format!("{name}: {}", words.say(n))).collect::<Vec<_>>()
    };
    let flagged = || checked.rows.iter().filter(|r| r.flagged);
    let is_marked = flagged().next().is_some();
    [Block::Table(table(checked, words).only(&ON_TERMINAL)), Block::Paragraph(words.t("compare.more.units"))]
        .into_iter()
        .chain(is_marked.then(|| Block::Paragraph(words.t("compare.more.flagged"))))
        .chain(Block::remarks(flagged().flat_map(of_device)))
        .chain(Block::remarks(checked.remarks.iter().map(|n| words.say(n))))
        .collect()
}

/// A number as it is printed. The units stand above the table.
fn quantity(number: f64, printed: String) -> Value {
    Quantity { number: Some(number), printed, unit: String::new() }.into()
}

/// The name of a device, with a mark where its row has an inconsistency.
fn marked(row: &CheckedRow, lang: Lang) -> String {
    let name = device(&row.device, lang);
    if row.flagged { format!("{name} !") } else { name }
}

/// What angle random walk alone gives: 5, 50 and 95 % of the ratio by record length over the longest averaging time.
fn null(checked: &Checked, words: Translator) -> Table {
    let rows = &checked.null;
    let ratio = |i: usize| {
        let printed = move |v: &f64| digits(*v, 2, words.lang);
        rows.iter().map(move |n| n.ratio.get(i).map(printed).unwrap_or_default())
    };
    Table::new("budget", rows.len())
        .column(
            words.number_column("compare.column.span"),
            rows.iter().map(|n| limit(n.length_over_tau_max, words.lang)),
        )
        .column(Column::number("low", "5 %"), ratio(0))
        .column(Column::number("median", "50 %"), ratio(1))
        .column(Column::number("high", "95 %"), ratio(2))
}

/// Table 1 as printed.
fn table1(rows: &[Row1], words: Translator) -> Table {
    let printed = |text: &str| decimal(text, words.lang);
    Table::new("budget", rows.len())
        .column(words.column("compare.column.unit"), rows.iter().map(|r| device(&r.device, words.lang)))
        .column(
            words.number_column("compare.column.bias_instability"),
            rows.iter().map(|r| printed(&r.bias_instability)),
        )
        .column(words.number_column("compare.column.n_allan"), rows.iter().map(|r| printed(&r.n)))
        .column(words.column("compare.column.coil"), rows.iter().map(|r| lengths(&r.coil, words)))
}

/// Lengths as printed, their units in the language of the report.
fn lengths(printed: &str, words: Translator) -> String {
    let named = |text: String, unit: &str, key: &str| {
        text.replace(&format!(" {unit}"), &format!(" {}", words.t(key)))
    };
    let text = named(decimal(printed, words.lang), "km", "compare.more.km");
    named(text, "mm", "compare.more.mm")
}

/// The name of a device: Russian ones have Latin letters in the data alone.
fn device(name: &str, lang: Lang) -> String {
    let spelt = [
        ("OIUS", "compare.device.oius"),
        ("TIUS", "compare.device.tius"),
        ("BChE", "compare.device.bche"),
        ("Optolink", "compare.device.optolink"),
        ("Fizoptika", "compare.device.fizoptika"),
    ];
    spelt.iter().fold(name.to_owned(), |name, (latin, key)| {
        lookup(lang, key).map_or_else(|| name.clone(), |own| name.replace(latin, own))
    })
}
