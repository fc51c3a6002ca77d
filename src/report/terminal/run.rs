//! A run, an analysis, or a test of several phases.

use super::screen::{Terminal, verdict_style};
use super::table::{Align, Cell, Column, table};
use crate::i18n::{Lang, visible};
use crate::report::translator::Translator;
use crate::report::view::{PhaseView, Row, View};
use anstyle::Style;

/// The outcome: verdict, quantities, reasons, conditions that are not met, faults.
pub fn run(view: &View, lang: Lang, terminal: Terminal) -> String {
    let words = Translator { lang };
    let mut out = head(view, words, terminal);
    if view.phases.is_empty() {
        out += &terminal.indented(&view.contradicted);
        // A pass needs no reasons; what fails is read in the table first.
        let settled = matches!(view.verdict, "pass" | "none");
        if settled {
            out += &terminal.indented(reasons(view));
        }
        out += &quantities(view, words, terminal);
        if !settled && !reasons(view).is_empty() {
            out += &section("terminal.reasons", words, terminal);
            out += &terminal.indented(reasons(view));
        }
        out += &conditions(view, words, terminal);
    } else {
        out += &phases(&view.phases, words, terminal);
        out += &terminal.indented(&view.errors);
    }
    if !view.attempt.is_empty() {
        out += &format!("\n{}", terminal.indented(&view.attempt));
    }
    if let Some(explained) = &view.explained {
        out += &section("terminal.explained", words, terminal);
        out += &terminal.indented(&explained.summary);
    }
    out
}

/// Verdict, test, unit.
fn head(view: &View, words: Translator, terminal: Terminal) -> String {
    let verdict = terminal.verdict(&view.verdict_word.to_uppercase(), view.verdict);
    let serial = view.identity.iter().find(|f| f.label == words.t("report.serial")).map(|f| f.value.as_str());
    let serial = serial.filter(|s| *s != words.t("report.missing"));
    let file = view.files.first().map(|f| f.path.as_str()).filter(|_| view.phases.is_empty());
    let parts: Vec<String> = [Some(view.title.as_str()), serial, file]
        .into_iter()
        .flatten()
        .map(|part| visible(part).into_owned())
        .collect();
    terminal.headed(&verdict, &view.verdict_word, &parts.join(" · "))
}

/// Errors and reasons, each once; what is contradicted is told before.
fn reasons(view: &View) -> Vec<&String> {
    let mut out: Vec<&String> = vec![];
    for sentence in view.errors.iter().chain(&view.summary) {
        if !out.contains(&sentence) && !view.contradicted.contains(sentence) {
            out.push(sentence);
        }
    }
    out
}

fn section(key: &str, words: Translator, terminal: Terminal) -> String {
    format!("\n{}\n", terminal.heading(&words.t(key)))
}

/// Rows with a limit, failed and undecided first; without limits, those that have a value or a bound.
fn quantities(view: &View, words: Translator, terminal: Terminal) -> String {
    if view.judged.is_empty() {
        return without_limits(view, words, terminal);
    }
    let mut rows: Vec<&Row> = view.judged.iter().collect();
    rows.sort_by_key(|row| urgency(row.verdict));
    let columns = [
        column("quantity", Align::Left, false, words),
        column("value", Align::Right, false, words),
        column("interval", Align::Right, false, words),
        column("limit", Align::Right, false, words),
        column("margin", Align::Right, true, words),
        column("verdict", Align::Left, false, words),
    ];
    let cells: Vec<Vec<Cell>> = rows
        .iter()
        .map(|row| {
            vec![
                name(row, view.several_channels).into(),
                value(row, words).into(),
                interval(row, words).into(),
                row.limit.clone().into(),
                row.margin.clone().into(),
                Cell { text: row.verdict_word.clone(), style: verdict_style(row.verdict) },
            ]
        })
        .collect();
    let mut out = format!("\n{}", table(&columns, &cells, terminal));
    if !view.further.is_empty() {
        let count = view.further.len().to_string();
        let more = words.with("terminal.further", &[("n", &count)]);
        out += &terminal.indented([more]);
    }
    out
}

fn urgency(verdict: &str) -> usize {
    ["error", "fail", "indeterminate"].iter().position(|v| *v == verdict).unwrap_or(3)
}

fn without_limits(view: &View, words: Translator, terminal: Terminal) -> String {
    let (shown, absent): (Vec<&Row>, Vec<&Row>) =
        view.further.iter().partition(|row| row.identifiable || !row.bound.is_empty());
    let columns = [
        column("quantity", Align::Left, false, words),
        column("value", Align::Right, false, words),
        column("interval", Align::Right, false, words),
        column("read", Align::Left, true, words),
    ];
    let cells: Vec<Vec<Cell>> = shown
        .iter()
        .map(|row| {
            let read = if row.place.is_empty() {
                row.method.clone()
            } else {
                format!("{}, {}", row.method, row.place)
            };
            vec![
                name(row, view.several_channels).into(),
                value(row, words).into(),
                interval(row, words).into(),
                Cell { text: read, style: Style::new().dimmed() },
            ]
        })
        .collect();
    let mut out =
        if cells.is_empty() { String::new() } else { format!("\n{}", table(&columns, &cells, terminal)) };
    let lines: Vec<String> = view
        .evidence
        .lines
        .iter()
        .map(|l| {
            let args =
                [("frequency", l.frequency.as_str()), ("amplitude", &l.amplitude), ("period", &l.period)];
            words.with("terminal.line", &args)
        })
        .collect();
    if !lines.is_empty() {
        out += &section("terminal.lines", words, terminal);
        out += &terminal.indented(lines);
    }
    if !absent.is_empty() {
        let names: Vec<String> = absent.iter().map(|row| name(row, view.several_channels)).collect();
        let sentence = words.with("terminal.absent", &[("names", &names.join("; "))]);
        out.push('\n');
        out += &terminal.indented([sentence]);
    }
    out
}

fn column(id: &str, align: Align, optional: bool, words: Translator) -> Column {
    Column { head: words.name("terminal_column", id), align, optional }
}

fn name(row: &Row, several_channels: bool) -> String {
    if several_channels { format!("{} · {}", row.name, row.channel) } else { row.name.clone() }
}

fn value(row: &Row, words: Translator) -> String {
    if row.identifiable && row.bound.is_empty() {
        if row.value.contains(char::is_numeric) {
            words.joined(&row.value, &row.unit)
        } else {
            row.value.clone()
        }
    } else {
        "–".to_owned()
    }
}

/// The interval, or the bound of a quantity without a value.
fn interval(row: &Row, words: Translator) -> String {
    if row.bound.is_empty() { row.interval.clone() } else { words.joined(&row.bound, &row.unit) }
}

/// Conditions that are not met or remarked on, broken budgets of faults, what is declared only.
fn conditions(view: &View, words: Translator, terminal: Terminal) -> String {
    let mut out = String::new();
    let odd: Vec<_> = view.evidence.conditions.iter().filter(|c| c.status == "remark").collect();
    // A broken budget is a reason of the verdict.
    let faults: Vec<String> = view
        .evidence
        .faults
        .found_faults
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
    if !view.declared.is_empty() {
        let note = words.with("cli.declared", &[("names", &view.declared.join(", "))]);
        out += &format!("\n{}", terminal.indented([note]));
    }
    out
}

/// A line for each phase, and below it the reasons of those that do not pass.
fn phases(phases: &[PhaseView], words: Translator, terminal: Terminal) -> String {
    let columns = [
        column("phase", Align::Left, false, words),
        column("met", Align::Left, false, words),
        column("verdict", Align::Left, false, words),
    ];
    let rows: Vec<Vec<Cell>> = phases
        .iter()
        .map(|p| {
            let judged = p.view.iter().flat_map(|v| &v.judged);
            let (mut met, mut all) = (0, 0);
            for row in judged {
                all += 1;
                met += usize::from(row.verdict == "pass");
            }
            let counted = words.with("terminal.met", &[("met", &met.to_string()), ("all", &all.to_string())]);
            let counted = if all == 0 { String::new() } else { counted };
            let verdict = Cell { text: p.verdict_word.clone(), style: verdict_style(p.verdict) };
            vec![p.title.clone().into(), counted.into(), verdict]
        })
        .collect();
    let mut out = format!("\n{}", table(&columns, &rows, terminal));
    for p in phases.iter().filter(|p| p.verdict != "pass") {
        out += &format!("\n{}\n", terminal.heading(&visible(&p.title)));
        match p.view.first() {
            Some(view) => out += &terminal.indented(view.errors.iter().chain(&view.summary)),
            None => out += &terminal.indented(&p.summary),
        }
    }
    out
}
