//! The words: file, columns, time base, faults.

use super::columns::{Content, Listed};
use super::gather::{Seen, TimeBase};
use super::layout::{Page, word};
use super::quantity::{count, plain, time};
use super::{show_gyro, support};
use crate::ingest::{ChannelFacts, Packing, Source};
use crate::recording::Role;
use crate::text::Note;
use crate::units::Unit;

/// Faults listed one by one.
const LISTED: usize = 3;

/// Everything that was found, in words.
pub(super) fn text(source: &Source, seen: &Seen) -> String {
    let mut page = Page::default();
    page.title(&source.path().display().to_string());
    file(&mut page, source, seen);
    columns(&mut page, seen);
    time_base(&mut page, seen);
    faults(&mut page, seen);
    show_gyro::gyros(&mut page, seen);
    show_gyro::others(&mut page, seen);
    support::statements(&mut page, seen);
    page.finish()
}

fn file(page: &mut Page, source: &Source, seen: &Seen) {
    page.heading(&word("inspect.file"));
    let key = match source.packing() {
        Packing::Plain => "inspect.format_plain",
        Packing::Gzip | Packing::Zstd => "inspect.format_packed",
    };
    let format = Note::new(key).with("format", source.format()).with("packing", source.packing().id());
    page.note(&word("inspect.format"), &format);
    page.row(&word("inspect.rows"), &count(seen.report.rows));
    if seen.report.facts.bytes > 0 {
        let size = Note::new("inspect.bytes").with("bytes", count(seen.report.facts.bytes));
        page.note(&word("inspect.size"), &size);
        page.row("SHA-256", &seen.report.facts.sha256);
    }
    for (i, note) in source.notes().iter().enumerate() {
        page.note(&if i == 0 { word("inspect.reader") } else { String::new() }, note);
    }
    for (i, (key, value)) in source.metadata().iter().enumerate() {
        page.row(
            &if i == 0 { word("inspect.stated.label") } else { String::new() },
            &format!("{key}: {value}"),
        );
    }
    if let Some(serial) = source.stated_serial() {
        page.note("", &Note::new("inspect.stated.serial").with("serial", serial));
    }
}

fn columns(page: &mut Page, seen: &Seen) {
    page.heading(&word("inspect.columns"));
    let mut rows = vec![vec![
        word("inspect.name"),
        word("inspect.role"),
        word("inspect.unit"),
        word("inspect.least"),
        word("inspect.greatest"),
        word("inspect.mean"),
        word("inspect.no_value"),
    ]];
    let mut remarks = Vec::new();
    for (place, column) in seen.listed.iter().enumerate() {
        let slot = seen.places.iter().position(|p| *p == place);
        let facts = slot.and_then(|s| seen.report.channels.get(s));
        rows.push(row(column, facts, seen.report.tau0_nominal_s));
        remarks.extend(remark(column, facts));
    }
    page.table(&rows, 3);
    for remark in remarks {
        page.note(&word("inspect.remark"), &remark);
    }
}

fn row(column: &Listed, facts: Option<&ChannelFacts>, tau0_s: f64) -> Vec<String> {
    let name = column.name.clone();
    let Some(facts) = facts else {
        let role = match column.content {
            Content::Text(_) => word("inspect.text"),
            _ => word("inspect.empty"),
        };
        return vec![name, role];
    };
    let guess = &column.guess;
    let unit = match (guess.unit.text(), guess.unit_is_named) {
        ("1", _) => "-".to_owned(),
        (unit, true) => unit.to_owned(),
        (unit, false) => format!("{unit}?"),
    };
    let recorded = |value: f64| as_recorded(value, facts, &guess.unit, tau0_s);
    let digits = digits(recorded(facts.values.min), recorded(facts.values.max));
    let shown = |value: f64| if value.is_finite() { figure(recorded(value), digits) } else { "-".into() };
    let none = match facts.values.non_finite {
        0 => "-".to_owned(),
        n => count(n),
    };
    let v = &facts.values;
    // What rounding leaves of a mean that is zero.
    let mean = if v.mean.abs() < 1e-12 * v.min.abs().max(v.max.abs()) { 0.0 } else { v.mean };
    vec![name, facts.role.id().replace('_', " "), unit, shown(v.min), shown(v.max), shown(mean), none]
}

/// Significant digits in which values between two extremes can be told apart.
fn digits(min: f64, max: f64) -> usize {
    let ratio = min.abs().max(max.abs()) / (max - min);
    if ratio.is_finite() && ratio > 1.0 { (4 + ratio.log10().ceil() as usize).clamp(6, 12) } else { 6 }
}

/// A value for the table: plain between 1e-4 and 1e9.
fn figure(value: f64, digits: usize) -> String {
    let exponent = value.abs().log10().floor();
    if value == 0.0 || !(-4.0..9.0).contains(&exponent) {
        return plain(value, digits);
    }
    let decimals = (digits as f64 - 1.0 - exponent).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A value of a channel in the unit of the file.
fn as_recorded(value: f64, facts: &ChannelFacts, unit: &Unit, tau0_s: f64) -> f64 {
    let (value, inside) = match facts.role {
        Role::AngleIncrement => (value * tau0_s, "arcsec"),
        _ => (value, facts.unit_inside.as_str()),
    };
    Unit::parse(inside).and_then(|inside| inside.convert(value, unit)).unwrap_or(value)
}

fn remark(column: &Listed, facts: Option<&ChannelFacts>) -> Option<Note> {
    let about = |key| Note::new(key).with("column", column.name.as_str());
    match &column.content {
        Content::Text(sample) if column.guess.role == Role::Time => {
            return Some(about("inspect.time_is_text").with("sample", sample.as_str()));
        }
        Content::Nothing => return Some(about("inspect.nothing_in_it")),
        _ => {}
    }
    let facts = facts?;
    if column.counts_of_a_gyro() {
        return Some(about("inspect.gyro_in_counts"));
    }
    if facts.values.count > 0 && facts.values.min == facts.values.max {
        return Some(about("inspect.never_changes"));
    }
    let unitless = matches!(column.guess.role, Role::Auxiliary | Role::Counter);
    let guessed = !column.guess.unit_is_named && !unitless;
    guessed.then(|| Note::new("inspect.unit_guessed").with("reason", column.guess.reason.as_str()))
}

fn time_base(page: &mut Page, seen: &Seen) {
    page.heading(&word("inspect.time_base"));
    let label = |key| word(key);
    let report = &seen.report;
    match &seen.time {
        TimeBase::Rows(why) | TimeBase::Declared(_, why) => {
            if let Some(why) = why {
                page.note(
                    &label("inspect.source"),
                    &Note::new("inspect.stamps_unusable").with("why", why.as_str()),
                );
            }
        }
        TimeBase::Stamps(name) => {
            let key = if name.to_lowercase().contains("nominal") {
                "inspect.stamps_nominal"
            } else {
                "inspect.stamps"
            };
            page.note(&label("inspect.source"), &Note::new(key).with("column", name.as_str()));
        }
    }
    match &seen.time {
        TimeBase::Rows(_) => {
            let note = Note::new("inspect.rows_counted").with("rows", count(report.rows));
            page.note(&label("inspect.rate"), &note);
            return;
        }
        TimeBase::Declared(hz, _) => {
            let note = Note::new("inspect.declared").with("rate", plain(*hz, 6));
            page.note(&label("inspect.source"), &note);
        }
        TimeBase::Stamps(_) => {}
    }
    let rate = Note::new("inspect.rate_is")
        .with("rate", plain(1.0 / seen.tau0_s, 6))
        .with("interval", interval(seen.tau0_s));
    page.note(&label("inspect.rate"), &rate);
    if let (TimeBase::Stamps(_), Some(given)) = (&seen.time, seen.declared_hz) {
        let off = (given * seen.tau0_s - 1.0) * 100.0;
        let note = Note::new("inspect.rate_given").with("given", plain(given, 6)).with("off", plain(off, 2));
        page.note("", &note);
    }
    page.row(&label("inspect.length"), &time(report.duration_s));
    if let TimeBase::Stamps(_) = seen.time {
        if let Some(start) = &report.start {
            page.row(&label("inspect.start"), start);
        } else {
            let start = format!("{:.3}", report.first_stamp_s);
            let start = start.trim_end_matches('0').trim_end_matches('.');
            page.note(&label("inspect.start"), &Note::new("inspect.start_at").with("s", start));
        }
        if let Some(jitter) = report.jitter_s {
            let note = if jitter > 1e-6 * seen.tau0_s {
                Note::new("inspect.jitter_is")
                    .with("jitter", time(jitter))
                    .with("percent", plain(100.0 * jitter / seen.tau0_s, 2))
            } else {
                Note::new("inspect.jitter_none")
            };
            page.note(&label("inspect.jitter"), &note);
        }
        let i = &report.integrity;
        let note = match (i.gaps, i.duplicate_timestamps, i.backward_timestamps) {
            (0, 0, 0) => Note::new("inspect.unbroken"),
            (gaps, duplicate, backward) => Note::new("inspect.broken")
                .with("gaps", gaps)
                .with("missing", i.missing_samples)
                .with("duplicate", duplicate)
                .with("backward", backward),
        };
        page.note(&label("inspect.breaks"), &note);
        list(page, seen, &["gap", "duplicate_timestamp", "backward_timestamp"]);
    }
}

/// A sample interval with enough digits to tell it from the nominal one.
fn interval(s: f64) -> String {
    if s < 0.1 { format!("{} ms", plain(s * 1e3, 7)) } else { format!("{} s", plain(s, 7)) }
}

fn faults(page: &mut Page, seen: &Seen) {
    page.heading(&word("inspect.faults"));
    let i = &seen.report.integrity;
    let kinds = [
        (word("fault.non_finite"), i.non_finite, "inspect.non_finite"),
        (word("fault.unparsable"), i.unparsable, "inspect.unparsable"),
        (word("fault.outlier"), i.outliers, "inspect.outliers"),
        (word("fault.saturated"), i.saturated, "inspect.saturated"),
        (word("fault.stuck"), i.stuck, "inspect.stuck"),
    ];
    let gyros = seen.channels.iter().any(|c| c.role.is_gyro());
    if kinds.iter().all(|(_, n, _)| *n == 0) {
        let key = if gyros { "inspect.no_fault" } else { "inspect.no_fault_plain" };
        page.note(&word("inspect.values"), &Note::new(key));
        return;
    }
    for (label, n, key) in kinds.iter().filter(|(_, n, _)| *n > 0) {
        page.note(label, &Note::new(key).with("n", count(*n)));
    }
    list(page, seen, &["non_finite", "unparsable", "outlier", "saturated", "stuck"]);
}

/// The first faults of some kinds, where they are.
fn list(page: &mut Page, seen: &Seen, kinds: &[&str]) {
    let all = seen.report.integrity.faults.iter().filter(|f| kinds.contains(&f.kind.as_str()));
    let timed = seen.time.is_known();
    for fault in all.take(LISTED) {
        let place = match fault.time_s.filter(|_| timed) {
            Some(t) => Note::new("inspect.fault_at_time")
                .with("row", fault.row)
                .with("time", format!("{:.6}", t).trim_end_matches('0').trim_end_matches('.')),
            None => Note::new("inspect.fault_at").with("row", fault.row),
        };
        let channel = fault.channel.as_deref().filter(|c| !fault.note.contains(c));
        let channel = channel.map_or_else(String::new, |c| format!("`{c}`: "));
        let row = format!("{}: {channel}{}", super::layout::say(&place), fault.note);
        page.row("", &row);
    }
}
