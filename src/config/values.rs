//! Single values: texts, numbers, dates, words, quantities, each checked against its kind.

use super::diagnostics::Span;
use super::quantity::{self, QuantityError};
use super::reader::{Reader, Value, for_example, shorten};
use super::role_words;
use super::section::{Allowance, Entry, Given, Look, Named, Taus};
use super::spec::{KeySpec, Kind, Range, Word};
use super::texts::{Blank, local, text};
use crate::effect::EFFECTS;
use crate::i18n::{Note, note};
use crate::measurand::Measurand;
use crate::recording::ColumnRef;
use crate::units::Unit;
use chrono::NaiveDate;
use sagnac_core::spelling::nearest;
use toml::de::DeValue;

/// Most averaging times in a list.
const MAX_TAUS: usize = 1000;

/// Most looks at a growing test.
const MAX_LOOKS: usize = 100;

/// Shares of a length that a look may be at.
const LOOK_SHARES: Range = Range { low: 0.0, high: 1.0, open: true };

/// Most numbers in a list.
const MAX_NUMBERS: usize = 100_000;

/// Most names in a table of values.
const MAX_NAMES: usize = 100;

/// Reads a value that is no table.
pub(crate) fn scalar(reader: &mut Reader<'_>, value: Value<'_>) -> Option<Entry> {
    match value.key.kind {
        Kind::Text | Kind::Format(_) => text(reader, value, Blank::Refused).map(Entry::Text),
        Kind::LocalText => local(reader, value, Blank::Refused).map(Entry::LocalText),
        Kind::LocalRemark => local(reader, value, Blank::Allowed).map(Entry::LocalText),
        Kind::Id => id(reader, value).map(Entry::Text),
        Kind::Flag => match value.toml {
            DeValue::Boolean(flag) => Some(Entry::Flag(*flag)),
            _ => reader.wrong(value),
        },
        Kind::Number(range) => {
            let Some(given) = number(value.toml) else { return reader.wrong(value) };
            in_range(reader, value, given, range, "").then_some(Entry::Number(given))
        }
        Kind::Numbers(range) => numbers(reader, value, range).map(Entry::Numbers),
        Kind::Values => named(reader, value).map(Entry::Values),
        Kind::Remark => text(reader, value, Blank::Allowed).map(Entry::Text),
        Kind::Date => date(reader, value).map(Entry::Date),
        Kind::Choice(words) => word(reader, value, words).map(Entry::Word),
        Kind::Choices(words) => {
            let DeValue::Array(items) = value.toml else { return reader.wrong(value) };
            let found = items
                .iter()
                .filter_map(|v| word(reader, value.with(v.get_ref(), &v.span()), words))
                .collect();
            Some(Entry::Words(found))
        }
        Kind::Columns(words) => {
            let DeValue::Array(items) = value.toml else { return reader.wrong(value) };
            // A name that is a known one but for its case is a slip, and no other column.
            let slip = |name: &str| {
                words.iter().any(|(known, _)| *known != name && known.eq_ignore_ascii_case(name))
            };
            let mut names = vec![];
            for item in items {
                let span = item.span();
                let item = value.with(item.get_ref(), &span);
                let Some(name) = text(reader, item, Blank::Refused) else { continue };
                if slip(&name) {
                    word(reader, item, words);
                } else {
                    names.push(name);
                }
            }
            Some(Entry::Names(names))
        }
        Kind::Command => {
            let DeValue::Array(items) = value.toml else { return reader.wrong(value) };
            let words = items
                .iter()
                .filter_map(|item| text(reader, value.with(item.get_ref(), &item.span()), Blank::Allowed));
            Some(Entry::Names(words.collect()))
        }
        Kind::Effects => {
            let DeValue::Array(items) = value.toml else { return reader.wrong(value) };
            let mut ids = vec![];
            for item in items {
                let span = item.span();
                let item = value.with(item.get_ref(), &span);
                ids.extend(text(reader, item, Blank::Refused).and_then(|id| effect(&id, &span, reader)));
            }
            Some(Entry::Names(ids))
        }
        Kind::Quantity { unit, difference, range } => {
            quantity_in(reader, value, unit, difference, range).map(Entry::Number)
        }
        Kind::UnitText => unit(reader, value).map(Entry::Unit),
        Kind::Column => column(reader, value).map(Entry::Column),
        Kind::Taus => taus(reader, value).map(Entry::Taus),
        Kind::Looks => looks(reader, value).map(Entry::Looks),
        Kind::Allowance => allowance(reader, value).map(Entry::Allowance),
        Kind::Measurand => {
            let name = text(reader, value, Blank::Refused)?;
            reader.measurand(&name, &inside_quotes(reader, &name, value.span)).map(Entry::Measurand)
        }
        Kind::QuantityBy(_)
        | Kind::QuantityMap
        | Kind::Table(_)
        | Kind::Tables(_)
        | Kind::TableOrTables(_) => reader.wrong(value),
    }
}

/// The id of an effect of the catalogue, or `unknown`; anything else is reported.
fn effect(id: &str, span: &Span, reader: &mut Reader<'_>) -> Option<String> {
    let known = || EFFECTS.iter().map(|e| e.kind()).chain(["unknown"]);
    if known().any(|k| k == id) {
        return Some(id.to_owned());
    }
    let help = match nearest(id, known()) {
        Some(near) => note!("keyed.help.did_you_mean_value", value = near),
        None => note!("model_file.help.kinds"),
    };
    let at = reader.source.inside_quotes(span);
    reader.error(&at, note!("model_file.no_kind", kind = shorten(id)), Some(help));
    None
}

fn id(reader: &mut Reader<'_>, value: Value<'_>) -> Option<String> {
    let given = text(reader, value, Blank::Refused)?;
    let plain = given.chars().all(|c| c.is_ascii_alphanumeric() || "_-.".contains(c));
    if plain && given.len() <= 64 && given.starts_with(|c: char| c.is_ascii_alphanumeric()) {
        return Some(given);
    }
    let message = note!("keyed.no_name", given = shorten(&given), key = value.key.name);
    reader.error(value.span, message, Some("keyed.help.name".into()));
    None
}

/// A TOML number as a float; `None` for anything else and for what a float cannot hold.
fn number(value: &DeValue<'_>) -> Option<f64> {
    let parsed = match value {
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok().map(|i| i as f64),
        DeValue::Float(f) => f.as_str().parse::<f64>().ok(),
        _ => None,
    };
    parsed.filter(|v| v.is_finite())
}

/// The numbers of a list; `None` where it is none, is empty or too long, or holds anything else.
fn list(value: &DeValue<'_>) -> Option<Vec<f64>> {
    match value {
        DeValue::Array(items) if !items.is_empty() && items.len() <= MAX_NUMBERS => {
            items.iter().map(|v| number(v.get_ref())).collect()
        }
        _ => None,
    }
}

fn numbers(reader: &mut Reader<'_>, value: Value<'_>, range: Range) -> Option<Vec<f64>> {
    let Some(found) = list(value.toml) else { return reader.wrong(value) };
    found.iter().all(|v| in_range(reader, value, *v, range, "")).then_some(found)
}

/// A table of names with numbers or lists of numbers. What the names mean is not known here.
fn named(reader: &mut Reader<'_>, value: Value<'_>) -> Option<Vec<Named>> {
    let DeValue::Table(table) = value.toml else { return reader.wrong(value) };
    let mut found = vec![];
    for (name, value) in table.iter().take(MAX_NAMES) {
        let given = match number(value.get_ref()) {
            Some(number) => Some(Given::Number(number)),
            None => match value.get_ref() {
                DeValue::String(text) => Some(Given::Text(text.to_string())),
                other => list(other).map(Given::List),
            },
        };
        let Some(given) = given else {
            let message = note!("keyed_more.no_value", name = shorten(name.get_ref()));
            reader.error(&value.span(), message, Some("keyed_more.help.value".into()));
            continue;
        };
        found.push(Named { name: name.get_ref().to_string(), at: name.span(), given, span: value.span() });
    }
    Some(found)
}

fn in_range(reader: &mut Reader<'_>, value: Value<'_>, number: f64, range: Range, unit: &str) -> bool {
    let fits = range.holds(number);
    if !fits {
        let message = note!("keyed.out_of_range", key = value.key.name, range = range.describe(unit));
        reader.error(value.span, message, Some(for_example(value.key)));
    }
    fits
}

fn date(reader: &mut Reader<'_>, value: Value<'_>) -> Option<NaiveDate> {
    let parsed = match value.toml {
        DeValue::Datetime(stamp) if stamp.time.is_none() && stamp.offset.is_none() => stamp
            .date
            .and_then(|d| NaiveDate::from_ymd_opt(i32::from(d.year), u32::from(d.month), u32::from(d.day))),
        DeValue::String(text) => NaiveDate::parse_from_str(text.trim(), "%Y-%m-%d").ok(),
        DeValue::Datetime(_) => None,
        _ => return reader.wrong(value),
    };
    if parsed.is_none() {
        let message = note!("keyed.no_date", key = value.key.name);
        reader.error(value.span, message, Some(note!("keyed.help.date", key = value.key.name)));
    }
    parsed
}

fn word(reader: &mut Reader<'_>, value: Value<'_>, words: &'static [Word]) -> Option<&'static str> {
    let DeValue::String(given) = value.toml else { return reader.wrong(value) };
    if let Some((known, _)) = words.iter().find(|(known, _)| known == given) {
        return Some(known);
    }
    let role = || (value.key.name == "role").then(|| role_words::meant(given)).flatten();
    let meant = role().filter(|role| words.iter().any(|(known, _)| known == role));
    let help = match meant.or_else(|| nearest(given, words.iter().map(|(known, _)| *known))) {
        Some(near) => note!("keyed.help.did_you_mean_value", value = near),
        None => {
            let all: Vec<&str> = words.iter().map(|(known, _)| *known).collect();
            note!("keyed.help.one_of", values = all.join(", "))
        }
    };
    let at = inside_quotes(reader, given, value.span);
    reader.error(&at, no_value(given, value.key), Some(help));
    None
}

fn unit(reader: &mut Reader<'_>, value: Value<'_>) -> Option<Unit> {
    let given = text(reader, value, Blank::Refused)?;
    match Unit::parse(&given) {
        Ok(unit) => Some(unit),
        Err(e) => {
            let at = inside_quotes(reader, &given, value.span);
            reader.error(&at, e.note(), Some("keyed.help.units".into()));
            None
        }
    }
}

fn column(reader: &mut Reader<'_>, value: Value<'_>) -> Option<ColumnRef> {
    match value.toml {
        DeValue::String(_) => text(reader, value, Blank::Refused).map(ColumnRef::Name),
        DeValue::Integer(_) => match number(value.toml) {
            Some(position) if (1.0..=100_000.0).contains(&position) => {
                Some(ColumnRef::Position(position as usize))
            }
            _ => {
                reader.error(value.span, "keyed.counted_from_1", None);
                None
            }
        },
        _ => reader.wrong(value),
    }
}

fn allowance(reader: &mut Reader<'_>, value: Value<'_>) -> Option<Allowance> {
    match value.toml {
        DeValue::Integer(_) => match number(value.toml) {
            Some(count) if count >= 0.0 => Some(Allowance::Count(count as u64)),
            _ => {
                reader.error(value.span, note!("keyed.no_count", key = value.key.name), None);
                None
            }
        },
        DeValue::String(_) => quantity_in(reader, value, "1", false, Range::SHARE).map(Allowance::Share),
        _ => reader.wrong(value),
    }
}

fn taus(reader: &mut Reader<'_>, value: Value<'_>) -> Option<Taus> {
    match value.toml {
        DeValue::String(name) => match name.as_ref() {
            "octave" => Some(Taus::Octave),
            "decade" => Some(Taus::Decade),
            "all" => Some(Taus::All),
            other => {
                let at = inside_quotes(reader, other, value.span);
                reader.error(&at, no_value(other, value.key), Some(value.key.kind.describe()));
                None
            }
        },
        DeValue::Array(items) if !items.is_empty() && items.len() <= MAX_TAUS => {
            let list: Vec<f64> = items
                .iter()
                .filter_map(|v| {
                    quantity_in(reader, value.with(v.get_ref(), &v.span()), "s", false, Range::POSITIVE)
                })
                .collect();
            Some(Taus::List(list))
        }
        _ => reader.wrong(value),
    }
}

/// Looks of a growing test; each item that is none is reported.
fn looks(reader: &mut Reader<'_>, value: Value<'_>) -> Option<Vec<Look>> {
    let DeValue::Array(items) = value.toml else { return reader.wrong(value) };
    if items.is_empty() || items.len() > MAX_LOOKS {
        return reader.wrong(value);
    }
    let one = |item: Value<'_>, reader: &mut Reader<'_>| {
        let is_percent = matches!(item.toml, DeValue::String(text) if text.trim_end().ends_with('%'));
        if is_percent {
            return quantity_in(reader, item, "1", false, LOOK_SHARES).map(Look::Share);
        }
        match number(item.toml) {
            Some(share) => in_range(reader, item, share, LOOK_SHARES, "").then_some(Look::Share(share)),
            None => quantity_in(reader, item, "s", false, Range::POSITIVE).map(Look::Time),
        }
    };
    Some(items.iter().filter_map(|v| one(value.with(v.get_ref(), &v.span()), reader)).collect())
}

fn quantity_in(
    reader: &mut Reader<'_>,
    value: Value<'_>,
    unit: &str,
    difference: bool,
    range: Range,
) -> Option<f64> {
    let number = quantity_text(reader, value, unit, difference)?;
    in_range(reader, value, number, range, unit).then_some(number)
}

/// The unit of a quantity that follows from elsewhere.
pub(crate) enum UnitBy {
    /// One unit.
    Known(String),
    /// That of the result, one of these.
    Recorded(&'static [&'static str]),
}

impl UnitBy {
    /// That of a measurand.
    pub(crate) fn of(measurand: &Measurand) -> UnitBy {
        if measurand.unit.is_empty() {
            UnitBy::Recorded(measurand.recorded_in)
        } else {
            UnitBy::Known(measurand.unit.to_owned())
        }
    }
}

/// Reads a quantity whose unit follows from elsewhere.
pub(crate) fn quantity_by(reader: &mut Reader<'_>, value: Value<'_>, unit: &UnitBy) -> Option<Entry> {
    let units = match unit {
        UnitBy::Known(unit) => return quantity_text(reader, value, unit, false).map(Entry::Number),
        UnitBy::Recorded(units) => *units,
    };
    let as_recorded_help = || as_recorded_help(units);
    let DeValue::String(text) = value.toml else {
        reader.error(value.span, note!("keyed.no_unit", name = value.key.name), Some(as_recorded_help()));
        return None;
    };
    match quantity::parse_as_recorded(text, units) {
        Ok((number, unit)) => Some(Entry::AsRecorded(number, unit)),
        Err(QuantityError { message, help, .. }) => {
            let at = inside_quotes(reader, text, value.span);
            reader.error(&at, message, Some(help.unwrap_or_else(as_recorded_help)));
            None
        }
    }
}

/// How a quantity is written whose unit is as recorded.
pub(crate) fn as_recorded_help(units: &[&str]) -> Note {
    let key = if units.contains(&"1") { "keyed_more.help.as_recorded" } else { "keyed_more.help.per_level" };
    Note::new(key).with("units", units.join(", "))
}

fn quantity_text(reader: &mut Reader<'_>, value: Value<'_>, unit: &str, difference: bool) -> Option<f64> {
    let bare = matches!(value.key.kind, Kind::QuantityBy(_) | Kind::QuantityMap);
    match value.toml {
        DeValue::String(text) => match quantity::parse(text, unit, difference, bare) {
            Ok(number) => Some(number),
            Err(QuantityError { span: part, message, help }) => {
                let inner = inside_quotes(reader, text, value.span);
                let at = if inner == *value.span {
                    inner
                } else {
                    inner.start + part.start..inner.start + part.end
                };
                reader.error(&at, message, Some(help.unwrap_or_else(|| quantity_help(value.key, unit))));
                None
            }
        },
        DeValue::Integer(_) | DeValue::Float(_) => {
            let message = note!("keyed.no_unit", name = value.key.name);
            reader.error(value.span, message, Some(quantity_help(value.key, unit)));
            None
        }
        _ => reader.wrong(value),
    }
}

/// How a quantity is written. The example of a key stands in only where its unit is the one needed: a guessed unit
/// would turn hours into seconds.
fn quantity_help(key: &KeySpec, unit: &str) -> Note {
    match key.kind {
        Kind::QuantityBy(_) | Kind::QuantityMap => note!("keyed.help.quantity_like", unit),
        _ => note!("keyed.help.quantity", key = key.name, example = key.example),
    }
}

/// A word that a key does not know.
fn no_value(given: &str, key: &KeySpec) -> Note {
    note!("keyed.no_value", given = shorten(given), key = key.name)
}

/// The place of a text between its quotes; the whole value where escapes make the two differ.
fn inside_quotes(reader: &Reader<'_>, text: &str, span: &Span) -> Span {
    let inner = reader.source.inside_quotes(span);
    if reader.source.text.get(inner.clone()) == Some(text) { inner } else { span.clone() }
}
