//! The published tables, printed.

use crate::acceptance::compare::published::{Checked, CheckedRow, Row1};
use crate::i18n::{Lang, decimal, lookup};
use crate::report::number::{digits, limit};
use crate::report::translator::Translator;
use serde::Serialize;

/// The tables with their checks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PublishedView {
    /// Where they are printed.
    pub source: String,
    /// Table 2.
    pub rows: Vec<RowView>,
    /// Table 1: device, bias instability, N, coil.
    pub table1: Vec<[String; 4]>,
    /// What angle random walk alone gives: T/τ_max, 5 %, median, 95 %.
    pub null: Vec<[String; 4]>,
    /// Remarks on the whole.
    pub remarks: Vec<String>,
}

/// A row of Table 2.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RowView {
    /// Device.
    pub device: String,
    /// Printed and computed numbers.
    pub sigma100: String,
    /// Bias instability.
    pub bias_instability: String,
    /// Ratio as printed.
    pub ratio_printed: String,
    /// Ratio as it follows.
    pub ratio: String,
    /// Russian angle random walk.
    pub arw_russian: String,
    /// N.
    pub n: String,
    /// Ratio as printed.
    pub arw_ratio_printed: String,
    /// Ratio as it follows.
    pub arw_ratio: String,
    /// 6·N.
    pub six_n: String,
    /// σ100 over 6·N.
    pub over_six_n: String,
    /// Cross-over, h.
    pub crossover_h: String,
    /// σ10/σ100.
    pub steep: String,
    /// What does not follow.
    pub remarks: Vec<String>,
    /// Whether something does not follow.
    pub flagged: bool,
}

impl PublishedView {
    /// Prints the tables.
    pub(super) fn new(checked: &Checked, words: Translator) -> PublishedView {
        let lang = words.lang;
        let first = |r: &Row1| {
            [
                device(&r.device, lang),
                decimal(&r.bias_instability, lang),
                decimal(&r.n, lang),
                lengths(&r.coil, words),
            ]
        };
        PublishedView {
            source: words.t("compare.published.cited"),
            rows: checked.rows.iter().map(|r| row(r, words)).collect(),
            table1: checked.table1.iter().map(first).collect(),
            null: checked
                .null
                .iter()
                .map(|n| {
                    let [low, median, high] = n.ratio.map(|v| digits(v, 2, lang));
                    [limit(n.length_over_tau_max, lang), low, median, high]
                })
                .collect(),
            remarks: checked.remarks.iter().map(|n| words.say(n)).collect(),
        }
    }
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

fn row(r: &CheckedRow, words: Translator) -> RowView {
    let printed = |text: &str| decimal(text, words.lang);
    let p = &r.printed;
    let computed = |v: f64| digits(v, 3, words.lang);
    RowView {
        device: device(&r.device, words.lang),
        sigma100: printed(&p.sigma100),
        bias_instability: printed(&p.bias_instability),
        ratio_printed: printed(&p.bias_ratio),
        ratio: computed(r.ratio),
        arw_russian: printed(&p.arw_russian),
        n: printed(&p.n),
        arw_ratio_printed: printed(&p.arw_ratio),
        arw_ratio: computed(r.arw_ratio),
        six_n: computed(r.six_n),
        over_six_n: computed(r.over_six_n),
        crossover_h: digits(r.crossover_h, 2, words.lang),
        steep: computed(r.sigma10_over_sigma100),
        remarks: r.remarks.iter().map(|n| words.say(n)).collect(),
        flagged: r.flagged,
    }
}
