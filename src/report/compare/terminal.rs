//! The short table of the terminal.

use super::CompareView;
use crate::i18n::{Lang, lookup, visible};

/// The table of a comparison, columns in line.
pub fn table(view: &CompareView, lang: Lang) -> String {
    let t = |key: &str| lookup(lang, key).unwrap_or(key).to_owned();
    let (head, rows): (Vec<String>, Vec<Vec<String>>) = match &view.published {
        Some(p) => (
            [
                "compare.column.unit",
                "compare.column.sigma100",
                "compare.column.bias_instability",
                "compare.column.printed",
                "compare.column.computed",
                "compare.column.arw",
                "compare.column.n_allan",
                "compare.column.over_six_n",
                "compare.column.steep",
            ]
            .map(t)
            .to_vec(),
            p.rows
                .iter()
                .map(|r| {
                    let ratio = if r.flagged { format!("{} !", r.device) } else { r.device.clone() };
                    vec![
                        ratio,
                        r.sigma100.clone(),
                        r.bias_instability.clone(),
                        r.ratio_printed.clone(),
                        r.ratio.clone(),
                        r.arw_russian.clone(),
                        r.n.clone(),
                        r.over_six_n.clone(),
                        r.steep.clone(),
                    ]
                })
                .collect(),
        ),
        None => (
            [
                "compare.column.unit",
                "compare.column.length",
                "compare.column.n",
                "compare.column.sigma100",
                "compare.column.minimum",
                "compare.column.ratio",
                "compare.column.null",
                "compare.column.arw",
                "compare.column.n_allan",
                "compare.column.ratio",
                "compare.column.over",
                "compare.column.verdict",
            ]
            .map(t)
            .to_vec(),
            view.units
                .iter()
                .map(|u| {
                    let minimum = u.rules.first();
                    vec![
                        u.label.clone(),
                        u.length.clone(),
                        u.n.clone(),
                        u.sigma100.value.clone(),
                        minimum.map(|r| r.figure.value.clone()).unwrap_or_default(),
                        minimum.map(|r| r.ratio.value.clone()).unwrap_or_default(),
                        u.null.clone(),
                        u.arw.value.clone(),
                        u.n_allan.value.clone(),
                        u.arw_ratio.value.clone(),
                        u.over.value.clone(),
                        u.agreement.clone(),
                    ]
                })
                .collect(),
        ),
    };
    let one_line = |cell: &String| visible(cell).into_owned();
    let rows: Vec<Vec<String>> = rows.iter().map(|r| r.iter().map(one_line).collect()).collect();
    let mut out = aligned(&head, &rows);
    out.push_str(&format!("{}\n", t("compare.more.units")));
    if view.published.as_ref().is_some_and(|p| p.rows.iter().any(|r| r.flagged)) {
        out.push_str(&format!("{}\n", t("compare.more.flagged")));
    }
    out.push('\n');
    if let Some(p) = &view.published {
        for row in p.rows.iter().filter(|r| r.flagged) {
            for remark in &row.remarks {
                out.push_str(&format!("{}: {}\n", visible(&row.device), visible(remark)));
            }
        }
        p.remarks.iter().for_each(|r| out.push_str(&format!("{r}\n")));
    } else {
        for unit in &view.units {
            for sentence in unit.says.iter().chain(&unit.missing) {
                out.push_str(&format!("{}: {}\n", visible(&unit.label), visible(sentence)));
            }
        }
        for l in &view.limits {
            out.push_str(&format!(
                "{}: {} {} ({}): {}\n",
                visible(&l.unit),
                l.quantity,
                l.value,
                l.limit,
                l.verdict_word
            ));
        }
    }
    out
}

/// Columns as wide as their widest entry, the first to the left, numbers to the right.
fn aligned(head: &[String], rows: &[Vec<String>]) -> String {
    let width = |i: usize| {
        let cells = rows.iter().filter_map(|r| r.get(i)).chain(head.get(i));
        cells.map(|c| c.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let line = |cells: &[String]| {
        let mut out = String::new();
        for (i, (cell, width)) in cells.iter().zip(&widths).enumerate() {
            let pad = " ".repeat(width - cell.chars().count());
            let text = if i == 0 || i + 1 == cells.len() && rows.iter().all(|r| r.len() > 9) {
                format!("{cell}{pad}")
            } else {
                format!("{pad}{cell}")
            };
            if i > 0 {
                out.push_str("  ");
            }
            out.push_str(&text);
        }
        format!("{}\n", out.trim_end())
    };
    let mut out = line(head);
    rows.iter().for_each(|r| out.push_str(&line(r)));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_in_line() {
        let text = |list: &[&str]| list.iter().map(|s| (*s).to_owned()).collect::<Vec<String>>();
        let out = aligned(&text(&["unit", "σ"]), &[text(&["а", "12.5"]), text(&["long", "3"])]);
        assert_eq!(out, "unit     σ\nа     12.5\nlong     3\n");
    }
}
