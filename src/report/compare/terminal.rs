//! The short table of the terminal.

use super::published::RowView;
use super::{CompareView, PublishedView, UnitView};
use crate::i18n::{Lang, lookup, visible};

/// A table: its head and its rows.
type Cells = (Vec<&'static str>, Vec<Vec<String>>);

/// The table of a comparison, columns in line, with what is said of each unit below it.
pub fn table(view: &CompareView, lang: Lang) -> String {
    let t = |key: &str| lookup(lang, key).unwrap_or(key).to_owned();
    let (head, rows) = view.published.as_ref().map_or_else(|| of_units(view), of_published);
    let head: Vec<String> = head.into_iter().map(|column| t(&format!("compare.column.{column}"))).collect();
    let one_line = |cell: &String| visible(cell).into_owned();
    let rows: Vec<Vec<String>> = rows.iter().map(|r| r.iter().map(one_line).collect()).collect();
    let mut out = aligned(&head, &rows);
    out.push_str(&format!("{}\n", t("compare.more.units")));
    if let Some(p) = &view.published {
        let flagged = p.rows.iter().filter(|r| r.flagged);
        let remarks: Vec<(&String, &String)> =
            flagged.flat_map(|r| r.remarks.iter().map(move |remark| (&r.device, remark))).collect();
        let head =
            if remarks.is_empty() { String::new() } else { format!("{}\n", t("compare.more.flagged")) };
        out.push_str(&format!("{head}\n"));
        for (device, remark) in remarks {
            out.push_str(&format!("{}: {}\n", visible(device), visible(remark)));
        }
        p.remarks.iter().for_each(|r| out.push_str(&format!("{r}\n")));
        return out;
    }
    out.push('\n');
    for unit in &view.units {
        for sentence in unit.summary.iter().chain(&unit.missing) {
            out.push_str(&format!("{}: {}\n", visible(&unit.label), visible(sentence)));
        }
    }
    for l in &view.limits {
        let (unit, verdict) = (visible(&l.unit), &l.verdict_word);
        out.push_str(&format!("{unit}: {} {} ({}): {verdict}\n", l.quantity, l.value, l.limit));
    }
    out
}

fn of_published(published: &PublishedView) -> Cells {
    let head = vec![
        "unit",
        "sigma100",
        "bias_instability",
        "printed",
        "computed",
        "arw",
        "n_allan",
        "over_six_n",
        "steep",
    ];
    let row = |r: &RowView| {
        let device = if r.flagged { format!("{} !", r.device) } else { r.device.clone() };
        let cells = [
            &device,
            &r.sigma100,
            &r.bias_instability,
            &r.ratio_printed,
            &r.ratio,
            &r.arw_russian,
            &r.n,
            &r.over_six_n,
            &r.steep,
        ];
        cells.map(String::clone).to_vec()
    };
    (head, published.rows.iter().map(row).collect())
}

fn of_units(view: &CompareView) -> Cells {
    let head = vec![
        "unit", "length", "n", "sigma100", "minimum", "ratio", "null", "arw", "n_allan", "ratio", "over",
        "verdict",
    ];
    let row = |u: &UnitView| {
        let minimum = u.rules.first();
        let (figure, ratio) =
            minimum.map(|r| (r.figure.value.clone(), r.ratio.value.clone())).unwrap_or_default();
        let cells = [
            &u.label,
            &u.length,
            &u.n,
            &u.sigma100.value,
            &figure,
            &ratio,
            &u.null,
            &u.arw.value,
            &u.n_allan.value,
            &u.arw_ratio.value,
            &u.over.value,
            &u.agreement,
        ];
        cells.map(String::clone).to_vec()
    };
    (head, view.units.iter().map(row).collect())
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
