//! A run, an analysis, or a test of several phases.

use super::screen::{Terminal, verdict_style};
use super::table::{Align, Cell, Column, table};
use crate::estimate::Verdict;
use crate::i18n::visible;
use crate::report::explain::explained_summary;
use crate::report::translator::Translator;
use crate::report::view::{self, Part, Phase, Row};
use anstyle::Style;

/// Axes at most that stand beside each other in a table.
const MAX_AXES: usize = 4;

/// The outcome: verdict, quantities, reasons, conditions that are not met, faults. `in_phases`: what a test of several
/// phases found in each.
pub(super) fn run(whole: &Part<'_>, in_phases: &[Phase<'_>], terminal: Terminal) -> String {
    let words = whole.words;
    let mut out = head(whole, in_phases.is_empty(), terminal);
    if in_phases.is_empty() {
        out += &terminal.indented(contradicted(whole));
        // A pass needs no reasons; what fails is read in the table first.
        let settled = matches!(whole.record.verdict, Verdict::Pass | Verdict::None);
        let reasons = reasons(whole);
        if settled {
            out += &terminal.indented(&reasons);
        }
        out += &quantities(whole, terminal);
        if !settled && !reasons.is_empty() {
            out += &section("terminal.reasons", words, terminal);
            out += &terminal.indented(&reasons);
        }
        out += &conditions(whole, terminal);
    } else {
        out += &phases(in_phases, words, terminal);
        out += &terminal.indented(whole.errors());
    }
    let attempt = whole.attempt();
    if !attempt.is_empty() {
        out += &format!("\n{}", terminal.indented(attempt));
    }
    if let Some(explained) = &whole.record.explained {
        out += &section("terminal.explained", words, terminal);
        out += &terminal.indented(explained_summary(explained, words.lang));
    }
    out
}

/// Verdict, test, unit; the file that was read where it is one test.
fn head(whole: &Part<'_>, is_single: bool, terminal: Terminal) -> String {
    let (record, words) = (whole.record, whole.words);
    let word = words.verdict(record.verdict);
    let verdict = terminal.verdict(&word.to_uppercase(), record.verdict.id());
    let serial = record.unit_under_test.serial.as_deref().filter(|s| !s.trim().is_empty());
    let read = record.recording.first().map(|f| f.path.as_str());
    let file = read.or(record.procedure.as_ref().map(|p| p.path.as_str())).filter(|_| is_single);
    let title = whole.title();
    let parts: Vec<String> = [Some(title.as_str()), serial, file]
        .into_iter()
        .flatten()
        .map(|part| visible(part).into_owned())
        .collect();
    terminal.headed(&verdict, &word, &parts.join(" · "))
}

/// The reason that a check contradicts what a row rests on.
const CONTRADICTED: &str = "summary.contradicted";

/// What checks contradict: the first of the reasons.
fn contradicted(whole: &Part<'_>) -> Vec<String> {
    let notes = whole.record.summary.iter().filter(|n| n.id == CONTRADICTED);
    notes.map(|n| whole.words.say(n)).collect()
}

/// Errors and reasons, each once; what is contradicted is told before.
fn reasons(whole: &Part<'_>) -> Vec<String> {
    let contradicted = contradicted(whole);
    let mut out: Vec<String> = vec![];
    for sentence in whole.errors().into_iter().chain(whole.summary()) {
        if !out.contains(&sentence) && !contradicted.contains(&sentence) {
            out.push(sentence);
        }
    }
    out
}

fn section(key: &str, words: Translator, terminal: Terminal) -> String {
    format!("\n{}\n", terminal.heading(&words.t(key)))
}

/// Rows with a limit, failed and undecided first; without limits, those that have a value or a bound.
fn quantities(part: &Part<'_>, terminal: Terminal) -> String {
    let words = part.words;
    if part.judged.is_empty() {
        return without_limits(part, terminal);
    }
    let mut rows: Vec<&Row<'_>> = part.judged.iter().collect();
    rows.sort_by_key(|row| urgency(row.of.verdict.id()));
    let columns = [
        column("quantity", Align::Left, None, words),
        column("value", Align::Right, None, words),
        column("interval", Align::Right, Some(1), words),
        column("limit", Align::Right, None, words),
        column("margin", Align::Right, Some(0), words),
        column("verdict", Align::Left, None, words),
    ];
    let cells: Vec<Vec<Cell>> = rows
        .iter()
        .map(|row| {
            vec![
                row.name_in(part.several_channels, words).into(),
                value(row, words).into(),
                interval(row, words).into(),
                row.limit(words).into(),
                row.margin(words).into(),
                Cell { text: view::verdict_word(row.of, words), style: verdict_style(row.of.verdict.id()) },
            ]
        })
        .collect();
    let mut out = format!("\n{}", table(&columns, &cells, terminal));
    if !part.further.is_empty() {
        let count = part.further.len().to_string();
        let more = words.with("terminal.further", &[("n", &count)]);
        out += &terminal.indented([more]);
    }
    out
}

fn urgency(verdict: &str) -> usize {
    ["error", "fail", "indeterminate"].iter().position(|v| *v == verdict).unwrap_or(3)
}

fn without_limits(part: &Part<'_>, terminal: Terminal) -> String {
    let words = part.words;
    let is_shown = |row: &&Row<'_>| row.of.identifiable || !view::bound_alone(row.of, words).is_empty();
    let (shown, absent): (Vec<&Row<'_>>, Vec<&Row<'_>>) = part.further.iter().partition(is_shown);
    let columns = [
        column("quantity", Align::Left, None, words),
        column("value", Align::Right, None, words),
        column("interval", Align::Right, Some(1), words),
        column("read", Align::Left, Some(0), words),
    ];
    let cells: Vec<Vec<Cell>> = shown
        .iter()
        .map(|row| {
            let (method, place) = (row.method(words), view::place(row.of, words));
            let read = if place.is_empty() { method } else { format!("{method}, {place}") };
            vec![
                row.name_in(part.several_channels, words).into(),
                value(row, words).into(),
                interval(row, words).into(),
                Cell { text: read, style: Style::new().dimmed() },
            ]
        })
        .collect();
    let (reason, absent) = main_reason(part, absent);
    let mut out = reason.map_or_else(String::new, |r| format!("\n{}", terminal.indented([r])));
    if !cells.is_empty() {
        let (columns, cells) = by_axis(&shown, words).unwrap_or_else(|| (columns.into(), cells));
        out += &format!("\n{}", table(&columns, &cells, terminal));
    }
    let lines = view::line_sentences(part.record, words);
    if !lines.is_empty() {
        out += &section("terminal.lines", words, terminal);
        out += &terminal.indented(lines);
    }
    if !absent.is_empty() {
        let names: Vec<String> = absent.iter().map(|row| row.name_in(part.several_channels, words)).collect();
        let sentence = words.with("terminal.absent", &[("names", &names.join("; "))]);
        out.push('\n');
        out += &terminal.indented([sentence]);
    }
    out
}

/// Quantities without a value that one reason must explain to stand before all else.
const MIN_WITH_ONE_REASON: usize = 6;

/// The reason that most quantities without a value share, and those that have another.
fn main_reason<'a, 'b>(part: &Part<'a>, absent: Vec<&'b Row<'a>>) -> (Option<String>, Vec<&'b Row<'a>>) {
    let shared = |note: usize| absent.iter().filter(|row| row.footnotes.contains(&note)).count();
    let most = (1..=part.footnotes.len()).max_by_key(|note| shared(*note));
    let Some(note) = most.filter(|n| shared(*n) >= MIN_WITH_ONE_REASON && 2 * shared(*n) > absent.len())
    else {
        return (None, absent);
    };
    let reason = note.checked_sub(1).and_then(|i| part.footnotes.get(i)).cloned();
    (reason, absent.into_iter().filter(|row| !row.footnotes.contains(&note)).collect())
}

/// Columns and rows of a table of quantities by axis, where several channels have the same ones.
fn by_axis(shown: &[&Row<'_>], words: Translator) -> Option<(Vec<Column>, Vec<Vec<Cell>>)> {
    let mut axes: Vec<&str> = vec![];
    let mut ids: Vec<&str> = vec![];
    for row in shown {
        // A row of one temperature, ramp or level is none of an axis.
        if row.of.channel.contains('@') {
            return None;
        }
        axes.extend((!axes.contains(&row.of.channel.as_str())).then_some(row.of.channel.as_str()));
        ids.extend((!ids.contains(&row.of.id.as_str())).then_some(row.of.id.as_str()));
    }
    if axes.len() < 2 || axes.len() > MAX_AXES {
        return None;
    }
    let axis = |axis: &&str| Column { head: (*axis).to_owned(), align: Align::Right, left_out: None };
    let mut columns = vec![column("quantity", Align::Left, None, words)];
    columns.extend(axes.iter().map(axis));
    columns.push(column("unit_of_quantity", Align::Left, None, words));
    let rows = ids.iter().filter_map(|id| {
        let of = |axis: &str| shown.iter().find(|row| row.of.id == *id && row.of.channel == axis);
        let first = shown.iter().find(|row| row.of.id == *id)?;
        let number = |row: &&Row<'_>| {
            let bound = view::bound_alone(row.of, words);
            if row.of.identifiable && bound.is_empty() { view::value(row.of, words) } else { bound }
        };
        let mut cells: Vec<Cell> = vec![first.name(words).into()];
        cells.extend(axes.iter().map(|a| Cell::from(of(a).map_or_else(|| "–".to_owned(), number))));
        cells.push(Cell { text: words.unit(&first.of.unit), style: Style::new().dimmed() });
        Some(cells)
    });
    let rows = rows.collect();
    Some((columns, rows))
}

fn column(id: &str, align: Align, left_out: Option<u8>, words: Translator) -> Column {
    Column { head: words.name("terminal_column", id), align, left_out }
}

fn value(row: &Row<'_>, words: Translator) -> String {
    if row.of.identifiable && view::bound_alone(row.of, words).is_empty() {
        let value = view::value(row.of, words);
        if value.contains(char::is_numeric) { words.quantity(&value, &row.of.unit) } else { value }
    } else {
        "–".to_owned()
    }
}

/// The interval, or the bound of a quantity without a value.
fn interval(row: &Row<'_>, words: Translator) -> String {
    let bound = view::bound_alone(row.of, words);
    if bound.is_empty() { view::interval(row.of, words) } else { words.quantity(&bound, &row.of.unit) }
}

/// Conditions that are not met or remarked on, broken budgets of faults, what is declared only.
fn conditions(part: &Part<'_>, terminal: Terminal) -> String {
    let (record, words) = (part.record, part.words);
    let mut out = String::new();
    let odd: Vec<view::Condition> =
        view::conditions(record, words).into_iter().filter(|c| c.status == "remark").collect();
    // A broken budget is a reason of the verdict.
    let faults: Vec<String> = view::FaultKinds::new(record, words)
        .found
        .iter()
        .filter(|f| f.status != "invalid")
        .map(|f| words.with("terminal.fault", &[("name", &f.name), ("found", &f.found)]))
        .collect();
    if !odd.is_empty() {
        out += &section("terminal.conditions", words, terminal);
        for c in &odd {
            let found = if c.note.is_empty() { &c.found } else { &c.note };
            let args = [("name", c.name.as_str()), ("required", &c.required), ("found", found)];
            let key = if c.required.is_empty() { "terminal.condition_plain" } else { "terminal.condition" };
            out += &terminal.marked(&c.status_word, c.status, &words.with(key, &args));
        }
    }
    if !faults.is_empty() {
        let sentence = words.with("terminal.faults", &[("faults", &faults.join("; "))]);
        out += &format!("\n{}", terminal.indented([sentence]));
    }
    let declared = view::declared(record, words);
    if !declared.is_empty() {
        let note = words.with("cli.declared", &[("names", &declared.join(", "))]);
        out += &format!("\n{}", terminal.indented([note]));
    }
    out
}

/// A line for each phase, and below it the reasons of those that do not pass.
fn phases(phases: &[Phase<'_>], words: Translator, terminal: Terminal) -> String {
    let columns = [
        column("phase", Align::Left, None, words),
        column("met", Align::Left, None, words),
        column("verdict", Align::Left, None, words),
    ];
    let rows: Vec<Vec<Cell>> = phases
        .iter()
        .map(|p| {
            let judged = p.part.iter().flat_map(|part| &part.judged);
            let (mut met, mut all) = (0, 0);
            for row in judged {
                all += 1;
                met += usize::from(row.of.verdict == Verdict::Pass);
            }
            let counted = words.with("terminal.met", &[("met", &met.to_string()), ("all", &all.to_string())]);
            let counted = if all == 0 { String::new() } else { counted };
            let verdict = p.phase.verdict;
            let verdict = Cell { text: words.verdict(verdict), style: verdict_style(verdict.id()) };
            vec![p.title(words).into(), counted.into(), verdict]
        })
        .collect();
    let mut out = format!("\n{}", table(&columns, &rows, terminal));
    for p in phases.iter().filter(|p| p.phase.verdict != Verdict::Pass) {
        out += &format!("\n{}\n", terminal.heading(&visible(&p.title(words))));
        match &p.part {
            Some(part) => out += &terminal.indented(part.errors().into_iter().chain(part.summary())),
            None => out += &terminal.indented(p.summary(words)),
        }
    }
    out
}
