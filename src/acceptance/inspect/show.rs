//! The words: file, columns, time base, faults.

use super::collect::{Inspection, TimeBase};
use super::columns::{Content, Listed};
use super::layout::{NO_LABEL, Page, word};
use super::quantity::{count, plain, time};
use super::{show_gyro, support};
use crate::i18n::{Arg, Lang, Localize, Note, decimal, note};
use crate::ingest::{ChannelFacts, Packing, Source};
use crate::recording::Role;
use crate::recording::clock::Measured;
use crate::units::Unit;
use std::collections::BTreeMap;

/// Faults listed one by one.
const MAX_LISTED: usize = 3;

/// Everything that was found, in words.
pub(super) fn text(source: &Source, found: &Inspection, lang: Lang) -> String {
    let mut page = Page::new(lang);
    page.title(&source.path().display().to_string());
    file(&mut page, source, found);
    columns(&mut page, found);
    time_base(&mut page, found);
    faults(&mut page, found);
    show_gyro::gyros(&mut page, found);
    show_gyro::others(&mut page, found);
    support::statements(&mut page, found);
    page.finish()
}

fn file(page: &mut Page, source: &Source, found: &Inspection) {
    page.heading(word("inspect.file"));
    let key = match source.packing() {
        Packing::Plain => "inspect.format_plain",
        Packing::Gzip | Packing::Zstd => "inspect.format_packed",
    };
    let format = Note::new(key).with("format", source.format()).with("packing", source.packing().id());
    page.row(word("inspect.format"), format);
    page.row(word("inspect.rows"), count(found.report.rows));
    if found.report.files.len() > 1 {
        joined(page, found);
    }
    if found.report.facts.bytes > 0 && found.report.files.len() < 2 {
        let size = note!("inspect.bytes", bytes = count(found.report.facts.bytes));
        page.row(word("inspect.size"), size);
        page.row("SHA-256", found.report.facts.sha256.as_str());
    }
    for (i, note) in source.notes().iter().enumerate() {
        page.row(if i == 0 { word("inspect.reader") } else { NO_LABEL.into() }, note.clone());
    }
    for (i, (key, value)) in source.metadata().iter().enumerate() {
        let label = if i == 0 { word("inspect.stated.label") } else { NO_LABEL.into() };
        page.row(label, format!("{key}: {value}"));
    }
    for serial in source.stated_serials() {
        page.row(NO_LABEL, note!("inspect.stated.serial", serial));
    }
}

/// The files of a recording of several.
fn joined(page: &mut Page, found: &Inspection) {
    for file in &found.report.files {
        let note = note!(
            "time_base.file",
            file = file.path.display().to_string(),
            rows = count(file.facts.rows),
            start = file.start.clone().unwrap_or_else(|| "-".to_owned()),
            length = if found.time.is_known() { time(file.duration_s) } else { "-".into() },
            sha256 = file.facts.sha256.as_str()
        );
        page.row(word("time_base.joined"), note);
    }
}

fn columns(page: &mut Page, found: &Inspection) {
    page.heading(word("inspect.columns"));
    let lang = page.lang();
    let header = [
        word("inspect.name"),
        word("inspect.role"),
        word("inspect.unit"),
        word("inspect.least"),
        word("inspect.greatest"),
        word("inspect.mean"),
        word("inspect.no_value"),
    ];
    let mut rows = vec![header.map(|w| w.say(lang)).to_vec()];
    let mut remarks = Vec::new();
    // By place in the file; a column that was not read has none.
    let facts: BTreeMap<usize, &ChannelFacts> =
        found.places.iter().copied().zip(&found.report.channels).collect();
    for (place, column) in found.listed.iter().enumerate() {
        let facts = facts.get(&place).copied();
        rows.push(row(column, facts, found.report.tau0_nominal_s, lang));
        remarks.extend(remark(column, facts));
    }
    page.table(&rows, 3);
    for remark in remarks {
        page.row(word("inspect.remark"), remark);
    }
}

fn row(column: &Listed, facts: Option<&ChannelFacts>, tau0_s: f64, lang: Lang) -> Vec<String> {
    let name = column.name.clone();
    let Some(facts) = facts else {
        let role = match column.content {
            Content::Text(_) => word("inspect.text"),
            _ => word("inspect.empty"),
        };
        return vec![name, role.say(lang)];
    };
    let guess = &column.guess;
    let unit = match (guess.unit.text(), guess.unit_is_named) {
        ("1", _) => "-".to_owned(),
        (unit, true) => unit.to_owned(),
        (unit, false) => format!("{unit}?"),
    };
    let recorded = |value: f64| as_recorded(value, facts, &guess.unit, tau0_s);
    let digits = digits(recorded(facts.values.min), recorded(facts.values.max));
    let shown = |value: f64| {
        if value.is_finite() { decimal(&figure(recorded(value), digits), lang) } else { "-".into() }
    };
    let none = match facts.values.non_finite {
        0 => "-".to_owned(),
        n => count(n),
    };
    let v = &facts.values;
    // What rounding leaves of a mean that is zero.
    let mean = if v.mean.abs() < 1e-12 * v.min.abs().max(v.max.abs()) { 0.0 } else { v.mean };
    let role = Arg::key("role", facts.role.id()).say(lang);
    vec![name, role, unit, shown(v.min), shown(v.max), shown(mean), none]
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
        return plain(value, digits).say(Lang::En);
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
    guessed.then(|| note!("inspect.unit_guessed", reason = column.guess.reason.clone()))
}

fn time_base(page: &mut Page, found: &Inspection) {
    page.heading(word("inspect.time_base"));
    let report = &found.report;
    let source = |page: &mut Page, note: Note| page.row(word("inspect.source"), note);
    match &found.time {
        TimeBase::Rows(Some(why)) | TimeBase::Declared(_, Some(why)) => {
            source(page, note!("inspect.stamps_unusable", why = why.clone()));
        }
        TimeBase::Rows(None) | TimeBase::Declared(_, None) => {}
        TimeBase::Stamps(name) => {
            let nominal = name.to_lowercase().contains("nominal");
            let key = if nominal { "inspect.stamps_nominal" } else { "inspect.stamps" };
            source(page, Note::new(key).with("column", name.as_str()));
        }
    }
    if let TimeBase::Rows(_) = &found.time {
        let note = note!("inspect.rows_counted", rows = count(report.rows));
        page.row(word("inspect.rate"), note);
        return;
    }
    if let TimeBase::Declared(hz, _) = &found.time {
        source(page, note!("inspect.declared", rate = plain(*hz, 6)));
    }
    let rate =
        note!("inspect.rate_is", rate = plain(1.0 / found.tau0_s, 6), interval = interval(found.tau0_s));
    page.row(word("inspect.rate"), rate);
    let stamped = matches!(found.time, TimeBase::Stamps(_));
    if stamped {
        rate_of_stamps(page, found);
    }
    page.row(word("inspect.length"), time(report.duration_s));
    if stamped {
        stamps(page, found);
    }
}

/// Notes on a sample rate that is measured from stamps.
fn rate_of_stamps(page: &mut Page, found: &Inspection) {
    if let Some(given) = found.declared_hz {
        let off = (given * found.tau0_s - 1.0) * 100.0;
        let note = note!("inspect.rate_given", given = plain(given, 6), off = plain(off, 2));
        page.row(NO_LABEL, note);
    }
    if let Some(clock) = &found.report.clock {
        clock_facts(page, clock);
    }
    for note in &found.report.notes {
        page.row(NO_LABEL, note.clone());
    }
}

/// Where the stamps start, how they scatter and where they break.
fn stamps(page: &mut Page, found: &Inspection) {
    let report = &found.report;
    if let Some(start) = &report.start {
        page.row(word("inspect.start"), start.as_str());
    } else {
        let start = decimals(report.first_stamp_s, 3);
        page.row(word("inspect.start"), note!("inspect.start_at", s = start));
    }
    if let Some(jitter) = report.jitter_s {
        let note = if jitter > 1e-6 * found.tau0_s {
            note!(
                "inspect.jitter_is",
                jitter = time(jitter),
                percent = plain(100.0 * jitter / found.tau0_s, 2)
            )
        } else {
            note!("inspect.jitter_none")
        };
        page.row(word("inspect.jitter"), note);
    }
    let i = &report.integrity;
    let note = match (i.gaps, i.duplicate_timestamps, i.backward_timestamps) {
        (0, 0, 0) => note!("inspect.unbroken"),
        (gaps, duplicate, backward) => {
            note!("inspect.broken", gaps, missing = i.missing_samples, duplicate, backward)
        }
    };
    page.row(word("inspect.breaks"), note);
    list(page, found, &["gap", "duplicate_timestamp", "backward_timestamp", "rollover"]);
}

/// How well the stamps tell the rate, and whether it drifts.
fn clock_facts(page: &mut Page, clock: &Measured) {
    let ppm = clock.uncertainty_s / clock.interval_s * 1e6;
    if ppm > 0.001 {
        page.row(NO_LABEL, note!("time_base.uncertainty", ppm = plain(ppm, 2)));
    }
    if let (Some(drift), Some(sigma)) = (clock.drift, clock.drift_uncertainty)
        && drift.abs() > 4.0 * sigma
        && drift.abs() > 1e-7
    {
        let note = note!("time_base.drift", ppm = plain(drift * 1e6, 2));
        page.row(NO_LABEL, note.with("sigma", plain(sigma * 1e6, 2)));
    }
}

/// A sample interval with enough digits to tell it from the nominal one.
fn interval(s: f64) -> Note {
    let (key, value) = if s < 0.1 { ("amount.ms", s * 1e3) } else { ("amount.s", s) };
    Note::new(key).with("value", plain(value, 7))
}

/// A number with at most so many decimals, whatever its size.
fn decimals(value: f64, count: usize) -> Arg {
    Arg::decimals(value, count)
}

fn faults(page: &mut Page, found: &Inspection) {
    page.heading(word("inspect.faults"));
    let i = &found.report.integrity;
    let kinds = [
        (word("fault.non_finite"), i.non_finite, "inspect.non_finite"),
        (word("fault.unparsable"), i.unparsable, "inspect.unparsable"),
        (word("fault.outlier"), i.outliers, "inspect.outliers"),
        (word("fault.saturated"), i.saturated, "inspect.saturated"),
        (word("fault.stuck"), i.stuck, "inspect.stuck"),
        (word("fault.repeated"), i.repeated, "repeated.inspect"),
        (word("fault.implausible"), i.implausible, "plausible.inspect"),
        (word("fault.cut_off"), i.cut_off, "plausible.inspect_cut_off"),
    ];
    let gyros = found.channels.iter().any(|c| c.role.is_gyro());
    if kinds.iter().all(|(_, n, _)| *n == 0) {
        let key = if gyros { "inspect.no_fault" } else { "inspect.no_fault_plain" };
        page.row(word("inspect.values"), Note::new(key));
        return;
    }
    for (label, n, key) in kinds.iter().filter(|(_, n, _)| *n > 0) {
        page.row(label.clone(), Note::new(*key).with("n", count(*n)));
    }
    list(
        page,
        found,
        &["non_finite", "unparsable", "outlier", "saturated", "stuck", "repeated", "implausible", "cut_off"],
    );
}

/// The first faults of some kinds, where they are.
fn list(page: &mut Page, found: &Inspection, kinds: &[&str]) {
    let all = found.report.integrity.faults.iter().filter(|f| kinds.contains(&f.kind.as_str()));
    let timed = found.time.is_known();
    for fault in all.take(MAX_LISTED) {
        let place = match fault.time_s.filter(|_| timed) {
            Some(t) => note!("inspect.fault_at_time", row = fault.row, time = decimals(t, 6)),
            None => note!("inspect.fault_at", row = fault.row),
        };
        let channel = fault.channel.as_deref().filter(|c| !fault.seen.say(Lang::En).contains(c));
        let what = Arg::from(fault.seen.clone());
        let row = match channel {
            Some(channel) => note!("inspect.fault_of", channel),
            None => note!("inspect.fault_row"),
        };
        let row = match &fault.file {
            Some(file) => note!(
                "time_base.fault_in",
                file = file.as_str(),
                row = row.with("place", place).with("what", what)
            ),
            None => row.with("place", place).with("what", what),
        };
        page.row(NO_LABEL, row);
    }
}
