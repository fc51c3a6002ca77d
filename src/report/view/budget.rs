//! Uncertainty budgets: what the uncertainty of each quantity is made of.

use super::part::Part;
use super::rows::Row;
use crate::estimate::{Component, InputQuantity};
use crate::record::InstrumentRecord;
use crate::report::number::{NOTHING, digits, percent};
use crate::report::page::{Block, Heading, Table};
use crate::report::translator::Translator;

/// Significant digits of an uncertainty.
const UNCERTAINTY_DIGITS: usize = 2;
/// Significant digits of a sensitivity.
const SENSITIVITY_DIGITS: usize = 3;

/// Difference from 1 that a share of the variance has by rounding alone.
const SHARE_ROUNDING: f64 = 1e-9;

/// A component with the row that it is of.
struct Line<'a> {
    row: &'a Row<'a>,
    component: &'a Component,
    /// True for the largest component of its row.
    is_first: bool,
}

/// The budgets of all quantities with more than the scatter of their readings, and the names of the others.
pub fn section(part: &Part<'_>) -> Vec<Block> {
    let words = part.words;
    let rows = part.judged.iter().chain(&part.further).filter(|r| !r.of.budget.is_empty());
    let (single, several): (Vec<&Row<'_>>, Vec<&Row<'_>>) = rows.partition(|r| is_of_readings(&r.of.budget));
    if several.is_empty() && single.is_empty() {
        return vec![];
    }
    let mut below = vec![];
    if !several.is_empty() {
        below.extend([Block::Hint(words.t("budget.hint")), Block::Table(table(part, &several))]);
    }
    if !single.is_empty() {
        let mut names: Vec<String> = single.iter().map(|r| r.name_in(part.several_channels, words)).collect();
        names.dedup();
        below.push(Block::Hint(words.with("budget.readings_alone", &[("names", &names.join("; "))])));
    }
    let heading = Heading { level: 2, text: words.t("budget.title").into(), verdict: None };
    vec![Block::Section("budget", vec![Block::Fold(heading, below)])]
}

/// True where the readings alone make the uncertainty.
fn is_of_readings(budget: &[Component]) -> bool {
    budget.iter().all(|c| c.input == InputQuantity::Readings)
}

fn table(part: &Part<'_>, rows: &[&Row<'_>]) -> Table {
    let words = part.words;
    let lines: Vec<Line<'_>> = rows
        .iter()
        .flat_map(|row| {
            let line = move |(i, component): (usize, _)| Line { row, component, is_first: i == 0 };
            row.of.budget.iter().enumerate().map(line)
        })
        .collect();
    let each = |of: &dyn Fn(&Line<'_>) -> String| lines.iter().map(of).collect::<Vec<_>>();
    let name = |l: &Line<'_>| {
        if l.is_first { l.row.name_in(part.several_channels, words) } else { String::new() }
    };
    let instruments = &part.record.instruments;
    Table::new("units small cards", lines.len())
        .column(words.column("report.quantity"), each(&name))
        .column(
            words.column("budget.component"),
            each(&|l| words.name("budget.input", l.component.input.id())),
        )
        .column(words.column("budget.source"), each(&|l| source(l.component, instruments, words)))
        .column(words.number_column("budget.standard_uncertainty"), each(&|l| input(l.component, words)))
        .column(words.column("budget.law"), each(&|l| law(l.component, words)))
        .column(
            words.number_column("budget.sensitivity"),
            each(&|l| digits(l.component.sensitivity, SENSITIVITY_DIGITS, words.lang)),
        )
        .column(words.number_column("budget.contribution"), each(&|l| contribution(l, words)))
        .column(words.number_column("budget.share"), each(&|l| share(l.component, words)))
        .column(words.column("budget.common_to"), each(&|l| common_to(l.component, words)))
}

/// How the uncertainty is known; the certificate that states it, where an instrument brings one.
fn source(component: &Component, instruments: &[InstrumentRecord], words: Translator) -> String {
    let source = words.name("budget.source_name", component.source.id());
    let of = |i: &&InstrumentRecord| i.component == Some(component.input) && i.certificate.is_some();
    match instruments.iter().find(of) {
        Some(i) => {
            let dated = i.calibrated.as_deref().map(|day| format!(" ({day})")).unwrap_or_default();
            format!("{source} {}{dated}", i.certificate.as_deref().unwrap_or_default())
        }
        None => source,
    }
}

fn input(component: &Component, words: Translator) -> String {
    let number = digits(component.standard_uncertainty, UNCERTAINTY_DIGITS, words.lang);
    words.quantity(&number, &component.unit)
}

/// The law, with its degrees of freedom where they are limited.
fn law(component: &Component, words: Translator) -> String {
    let law = words.name("budget.law_name", component.law.id());
    match component.degrees_of_freedom {
        Some(dof) => words.with("budget.law_dof", &[("law", &law), ("dof", &digits(dof, 2, words.lang))]),
        None => law,
    }
}

fn contribution(line: &Line<'_>, words: Translator) -> String {
    let number = digits(line.component.contribution, UNCERTAINTY_DIGITS, words.lang);
    words.quantity(&number, &line.row.of.unit)
}

/// Part of the variance; a component alone has all of it.
fn share(component: &Component, words: Translator) -> String {
    let whole = 1.0 - component.share_of_variance < SHARE_ROUNDING;
    if whole { words.t("budget.whole") } else { percent(component.share_of_variance, words.lang) }
}

fn common_to(component: &Component, words: Translator) -> String {
    component.common_to.map_or_else(|| NOTHING.to_owned(), |c| words.name("budget.common_name", c.id()))
}
