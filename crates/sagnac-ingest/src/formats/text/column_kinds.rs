//! What the columns of a text hold, inferred from the fields of its first lines: numbers, stamps, halves of stamps.

use super::fields::{bare, words};
use super::number::{self, Field};
use super::rows::{FieldKind, Pair, fingerprint};
use super::separator::{Looks, looks};
use super::stamps::{self, DAY_S, Order, Shape, Stamp};
use super::user_options::{self, Contradiction};
use crate::column::DATES;
use crate::column_inference::InferredColumn;
use crate::{Column, Labels, RowMatch, StampOptions};
use sagnac_core::message::{Arg, Note, note};
use sagnac_core::recording::{ColumnRef, Role};

/// Seconds of a week.
const WEEK_S: f64 = 604_800.0;

/// Start of GPS time, 1980-01-06, in seconds from 1970.
const GPS_EPOCH_S: f64 = 315_964_800.0;

/// The columns of a text.
#[derive(Debug, Clone, Default)]
pub(super) struct Kinds {
    /// What each field holds.
    pub kinds: Vec<FieldKind>,
    /// Columns of two fields.
    pub pairs: Vec<Pair>,
    /// All columns: one for each field, then one for each pair.
    pub columns: Vec<Column>,
    /// Decision about stamps.
    pub notes: Vec<Note>,
    /// Words of the columns that hold few of them.
    pub labels: Vec<Labels>,
}

/// Kind of most fields of a column; `None` when none is filled.
pub(super) fn usual(cells: &[&[u8]], decimal: u8) -> Option<Looks> {
    let mut counts: Vec<(Looks, usize)> = Vec::new();
    for found in cells.iter().map(|c| looks(c, decimal)).filter(|l| *l != Looks::Empty) {
        match counts.iter_mut().find(|(l, _)| *l == found) {
            Some((_, n)) => *n += 1,
            None => counts.push((found, 1)),
        }
    }
    // Of equals the first one seen.
    counts.into_iter().rev().max_by_key(|(_, n)| *n).map(|(l, _)| l)
}

/// Tells the columns from the data lines looked at: `cells` by column.
///
/// # Errors
/// The column and a field of it that is not written as stated.
pub(super) fn find(
    names: &[String],
    units: &[Option<String>],
    cells: &[Vec<&[u8]>],
    decimal: u8,
    stated: &[StampOptions],
    only: Option<&RowMatch>,
) -> Result<Kinds, Contradiction> {
    let mut found = Kinds::default();
    let mut shapes: Vec<Option<Shape>> = cells
        .iter()
        .map(|column| match usual(column, decimal) {
            Some(Looks::Stamp(shape)) => Some(shape),
            _ => None,
        })
        .collect();
    // A date without separators is a number until its name and a clock beside it tell.
    if shapes.contains(&Some(Shape::Clock)) {
        for (i, shape) in shapes.iter_mut().enumerate() {
            let dates = Shape::Date(Order::YearFirst);
            let named = names.get(i).is_some_and(|n| has(n, &["date", "дата"]));
            let all = cells.get(i).is_some_and(|c| c.iter().all(|c| stamps::parse(bare(c), dates).is_some()));
            if shape.is_none() && named && all {
                *shape = Some(dates);
            }
        }
    }
    let of_stated = user_options::apply(names, cells, stated, &mut shapes)?;
    for (i, name) in names.iter().enumerate() {
        let shape = shapes.get(i).copied().flatten();
        let column = cells.get(i).map(Vec::as_slice).unwrap_or_default();
        let stamps: Vec<Stamp> = shape
            .map(|s| column.iter().filter_map(|c| stamps::parse(bare(c), s)).collect())
            .unwrap_or_default();
        let base_s = match (shape, stamps.first()) {
            (Some(s), Some(first)) if s.is_dated() => first.seconds.div_euclid(DAY_S) * DAY_S,
            _ => 0,
        };
        let mut described = Column {
            name: name.clone(),
            numeric: true,
            storage: "text".to_owned(),
            unit: units.get(i).cloned().flatten(),
            epoch_s: None,
            rollover_s: None,
            judged: None,
        };
        found.kinds.push(match shape {
            Some(shape) => {
                described.unit = Some("s".to_owned());
                if let Shape::Date(_) = shape {
                    described.storage = DATES.to_owned();
                }
                if shape.is_dated() {
                    described.epoch_s = Some(base_s as f64);
                }
                described.rollover_s = shape.rollover_s();
                found.notes.extend(shape_notes(name, shape, &stamps));
                FieldKind::Stamp { shape, base_s }
            }
            None => word(name, i, column, decimal, only, &mut found.labels),
        });
        found.columns.push(described);
    }
    for (first, second, name) in of_stated.dated {
        add_dated(&mut found, first, second, Some(name));
    }
    if found.pairs.is_empty() {
        date_and_clock(&mut found, &shapes);
    }
    if found.pairs.is_empty() && !shapes.iter().any(Option::is_some) {
        seconds_and_parts(&mut found, names, cells, decimal);
    }
    let week = of_stated.weeks.into_iter().next();
    if week.is_some() || of_stated.seconds.is_some() || found.pairs.is_empty() {
        week_and_seconds(&mut found, names, cells, decimal, week, of_stated.seconds);
    }
    Ok(found)
}

/// What a column without stamps holds: numbers, or words, of which the one is sought that rows are chosen by.
fn word(
    name: &str,
    position: usize,
    cells: &[&[u8]],
    decimal: u8,
    only: Option<&RowMatch>,
    labels: &mut Vec<Labels>,
) -> FieldKind {
    if usual(cells, decimal) != Some(Looks::Text) {
        return FieldKind::Number;
    }
    labels.push(Labels { column: position, rows: cells.iter().map(|c| words(c)).collect() });
    let sought = only.filter(|m| match &m.column {
        ColumnRef::Name(column) => column == name,
        ColumnRef::Position(p) => *p == position + 1,
    });
    sought.map_or(FieldKind::Number, |m| FieldKind::Word(fingerprint(m.value.as_bytes())))
}

fn shape_notes(name: &str, shape: Shape, stamps: &[Stamp]) -> Vec<Note> {
    let key = match shape {
        Shape::DateTime(Order::YearFirst) => "ingest.delimited.stamps_iso",
        Shape::DateTime(Order::DayFirst) => "ingest.delimited.stamps_day_first",
        Shape::DateTime(Order::MonthFirst) => "ingest.delimited.stamps_month_first",
        Shape::Date(_) => "ingest.delimited.stamps_date",
        Shape::Clock => "ingest.delimited.stamps_clock",
        Shape::MinuteClock => "ingest.delimited.stamps_minutes",
    };
    let mut notes = vec![Note::new(key).with("column", name)];
    if let Shape::DateTime(_) = shape {
        let zoned = stamps.iter().filter(|s| s.zoned).count();
        let zone = match zoned {
            0 => "ingest.delimited.zone_none",
            n if n == stamps.len() => "ingest.delimited.zone_all",
            _ => "ingest.delimited.zone_some",
        };
        notes.push(Note::new(zone).with("column", name));
    }
    notes
}

/// One column of a date and a clock: the two that stand side by side, or the only two.
fn date_and_clock(found: &mut Kinds, shapes: &[Option<Shape>]) {
    let of = |wanted: fn(&Shape) -> bool| -> Vec<usize> {
        let fits = |(i, s): (usize, &Option<Shape>)| s.filter(&wanted).map(|_| i);
        shapes.iter().enumerate().filter_map(fits).collect()
    };
    let (dates, clocks) = (of(|s| matches!(s, Shape::Date(_))), of(|s| *s == Shape::Clock));
    let beside = dates.iter().find_map(|&d| {
        let clock = clocks.iter().find(|&&c| c.abs_diff(d) == 1);
        clock.map(|&c| (d, c))
    });
    let only = match (dates.as_slice(), clocks.as_slice()) {
        ([d], [c]) => Some((*d, *c)),
        _ => None,
    };
    if let Some((first, second)) = beside.or(only) {
        add_dated(found, first, second, None);
    }
}

fn add_dated(found: &mut Kinds, first: usize, second: usize, name: Option<String>) {
    let epoch_s = found.columns.get(first).and_then(|c| c.epoch_s);
    let pair = Pair { first, second, offset: 0.0, scale: 1.0, divisor: 1.0 };
    add(found, pair, epoch_s, "ingest.delimited.stamps_two_columns", name);
}

/// One column of GPS week and seconds of week, stated or recognised by their names.
fn week_and_seconds(
    found: &mut Kinds,
    names: &[String],
    cells: &[Vec<&[u8]>],
    decimal: u8,
    stated: Option<(usize, usize, String)>,
    stated_seconds: Option<usize>,
) {
    let number = |i: usize| found.kinds.get(i) == Some(&FieldKind::Number);
    let values = |i: usize| -> Vec<f64> {
        let value = |c: &&[u8]| match number::field(c, decimal) {
            Field::Value(v) => Some(v),
            _ => None,
        };
        cells.get(i).map(|c| c.iter().filter_map(value).collect()).unwrap_or_default()
    };
    let named =
        |words: &[&str]| (0..names.len()).find(|&i| number(i) && names.get(i).is_some_and(|n| has(n, words)));
    let stated_second = stated.as_ref().map(|s| s.1).or(stated_seconds);
    let seconds = stated_second.or_else(|| {
        named(&["tow", "sow", "itow", "seconds_of_week", "time_of_week", "gps_seconds", "gpsseconds"])
    });
    let Some(second) = seconds else { return };
    let milliseconds = found.columns.get(second).and_then(|c| c.unit.as_deref()) == Some("ms")
        || names.get(second).is_some_and(|n| has(n, &["ms", "мс"]));
    let divisor = if milliseconds { 1e3 } else { 1.0 };
    let of_week = values(second);
    if of_week.is_empty() || !of_week.iter().all(|v| (0.0..=WEEK_S).contains(&(v / divisor))) {
        return;
    }
    let stated_first = stated.as_ref().map(|s| s.0);
    let week = stated_first.or_else(|| named(&["week", "gps_week", "gpsweek", "wn", "weeks", "неделя"]));
    let weeks = week.map(values).unwrap_or_default();
    let whole = !weeks.is_empty() && weeks.iter().all(|w| w.fract() == 0.0 && (0.0..=1e4).contains(w));
    match (week, weeks.first()) {
        (Some(first), Some(&offset)) if whole => {
            let pair = Pair { first, second, offset, scale: WEEK_S, divisor };
            add(
                found,
                pair,
                Some(GPS_EPOCH_S + offset * WEEK_S),
                "ingest.delimited.stamps_gps",
                stated.map(|s| s.2),
            );
        }
        _ => {
            if let Some(column) = found.columns.get_mut(second) {
                column.unit = Some(if milliseconds { "ms" } else { "s" }.to_owned());
                column.rollover_s = Some(WEEK_S);
                let note = note!("ingest.delimited.stamps_of_week", column = column.name.as_str());
                found.notes.push(note);
            }
        }
    }
}

/// One column of seconds and parts of a second, as ROS writes them: whole seconds beside nanoseconds below 1e9.
fn seconds_and_parts(found: &mut Kinds, names: &[String], cells: &[Vec<&[u8]>], decimal: u8) {
    let values = |i: usize| -> Vec<f64> {
        let value = |c: &&[u8]| match number::field(c, decimal) {
            Field::Value(v) => Some(v),
            _ => None,
        };
        cells.get(i).map(|c| c.iter().filter_map(value).collect()).unwrap_or_default()
    };
    let number = |i: usize| found.kinds.get(i) == Some(&FieldKind::Number);
    let named = |list: &[&str]| {
        (0..names.len()).find(|&i| {
            let last = names.get(i).map(|n| n.to_lowercase());
            let last = last.as_deref().and_then(|n| n.rsplit(|c: char| !c.is_alphanumeric()).next());
            number(i) && last.is_some_and(|w| list.contains(&w))
        })
    };
    let Some(first) = named(&["sec", "secs", "seconds"]) else { return };
    let parts: [(&[&str], f64); 3] = [
        (&["nsec", "nsecs", "nanosec", "nanosecs", "nanoseconds"], 1e9),
        (&["usec", "usecs", "microsec", "microseconds"], 1e6),
        (&["msec", "msecs", "millisec", "milliseconds"], 1e3),
    ];
    for (words, divisor) in parts {
        let Some(second) = named(words) else { continue };
        let (whole, of) = (values(first), values(second));
        let fits = whole.iter().all(|v| v.fract() == 0.0) && of.iter().all(|v| (0.0..divisor).contains(v));
        // Parts that never fall are a clock of their own.
        let falls = of.iter().zip(of.get(1..).unwrap_or_default()).any(|(a, b)| b < a);
        let Some(offset) = whole.first().copied().filter(|_| fits && (falls || whole.len() < 3)) else {
            continue;
        };
        let is_date = (9e8..3e9).contains(&offset);
        let pair = Pair { first, second, offset, scale: 1.0, divisor };
        add(found, pair, is_date.then_some(offset), "ingest.delimited.stamps_in_parts", None);
        // Each for itself tells no sample from the next.
        for index in [first, second] {
            if let Some(column) = found.columns.get_mut(index) {
                column.judged = Some(InferredColumn { role: Role::Auxiliary, ..column.by_name() });
            }
        }
        return;
    }
}

fn add(found: &mut Kinds, pair: Pair, epoch_s: Option<f64>, key: &'static str, name_stated: Option<String>) {
    let name = |i: usize| found.columns.get(i).map_or("", |c| c.name.as_str());
    let (first, second) = (name(pair.first).to_owned(), name(pair.second).to_owned());
    let joined = name_stated.unwrap_or_else(|| format!("{first}+{second}"));
    found.notes.push(
        Note::new(key).with("first", first).with("second", second).with("column", Arg::Text(joined.clone())),
    );
    found.pairs.push(pair);
    found.columns.push(Column {
        name: joined,
        numeric: true,
        storage: "text".to_owned(),
        unit: Some("s".to_owned()),
        epoch_s,
        rollover_s: None,
        judged: None,
    });
}

/// True when a name, its words joined by `_`, is one of these or begins or ends with one.
fn has(name: &str, words: &[&str]) -> bool {
    let lower = name.to_lowercase();
    let parts: Vec<&str> = lower.split(|c: char| !c.is_alphanumeric()).filter(|p| !p.is_empty()).collect();
    let joined = format!("_{}_", parts.join("_"));
    words.iter().any(|w| joined.contains(&format!("_{w}_")))
}
