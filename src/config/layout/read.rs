//! The layout of the records of a raw binary file, read from TOML with every problem at its place.

use super::tables::{ChecksumKeys, FieldKeys, LAYOUT_FILE, LayoutTables};
use crate::config::diagnostics::{Problems, Span};
use crate::config::read_tables::checked;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::table::Table;
use crate::config::text_file::{self, Wording};
use crate::i18n::note;
use crate::units::{Affine, Unit};
use sagnac_ingest::layout::{ByteOrder, Field, NumberType};
use sagnac_ingest::layout::{Checksum, Layout, LayoutColumn, MAX_COLUMNS, MAX_RECORD_BYTES, Sum};
use std::collections::BTreeSet;
use std::path::Path;

/// Messages for a layout that cannot be read at all.
const READ_MESSAGES: Wording = Wording { unreadable: "layout.unreadable", folder: "layout.folder" };

/// Longest sync word, bytes.
const MAX_SYNC_BYTES: usize = 16;

/// Reads a layout file.
///
/// # Errors
/// Every problem of the file, each with its place; a file that cannot be read is one problem without a place.
pub fn load(path: &Path) -> Result<Layout, Problems> {
    parse(&path.display().to_string(), &text_file::bytes(path, &READ_MESSAGES)?)
}

/// Reads a layout from the bytes of a file; `name` stands in diagnostics.
///
/// # Errors
/// Every problem of the text.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Layout, Problems> {
    let (layout, problems) = checked(&text_file::source(name, bytes)?, &LAYOUT_FILE, build);
    layout.flatten().ok_or(problems)
}

/// The whole number of a key.
fn whole(value: Option<f64>, section: &Section, key: &str, reader: &mut Reader<'_>) -> Option<u64> {
    let value = value?;
    if value.fract() != 0.0 || value < 0.0 {
        let message = note!("reading.whole", key);
        reader.error(&section.span_of(key), message, None);
        return None;
    }
    Some(value as u64)
}

fn size(value: Option<f64>, section: &Section, key: &str, reader: &mut Reader<'_>) -> Option<usize> {
    whole(value, section, key, reader).and_then(|n| usize::try_from(n).ok())
}

fn build(root: &Section, reader: &mut Reader<'_>) -> Option<Layout> {
    let tables = LayoutTables::read(root);
    let order = if tables.byte_order == "big" { ByteOrder::Big } else { ByteOrder::Little };
    let sync = sync(tables.sync.as_deref(), root, reader);
    let header_bytes = whole(tables.header_bytes, root, "header_bytes", reader).unwrap_or(0);
    let declared = size(tables.record_bytes, root, "record_bytes", reader);
    let mut columns = Vec::new();
    let mut taken: Vec<Taken> = Vec::new();
    if !sync.is_empty() {
        taken.push(Taken { from: 0, to: sync.len(), bits: false, what: "sync".to_owned() });
    }
    let mut next = sync.len();
    for keys in &tables.fields {
        if let Some(end) = field(keys, order, next, &mut columns, &mut taken, reader) {
            next = end;
        }
    }
    names(&tables.fields, root, &columns, reader);
    if columns.len() > MAX_COLUMNS {
        let message = note!("layout.columns", most = MAX_COLUMNS);
        reader.error(&root.span_of("field"), message, None);
    }
    let mut end = taken.iter().map(|t| t.to).max().unwrap_or(0);
    let checksum = tables.checksum.as_ref().and_then(|keys| {
        let checksum = checksum(keys, order, declared.unwrap_or(end), declared.is_some(), reader)?;
        let what = "checksum".to_owned();
        let place = Taken { from: checksum.at, to: checksum.at + checksum.sum.bytes(), bits: false, what };
        overlap(&place, &taken, &keys.section.span, reader);
        end = end.max(place.to);
        Some(checksum)
    });
    let record_bytes = declared.unwrap_or(end);
    if record_bytes < end {
        let last = taken.iter().max_by_key(|t| t.to).filter(|t| t.to == end);
        let what = last.map_or("checksum", |t| t.what.as_str());
        let message = note!("layout.too_short", bytes = record_bytes, what, end);
        let help = note!("layout.write_bytes", end);
        reader.error(&root.span_of("record_bytes"), message, Some(help));
    }
    if record_bytes > MAX_RECORD_BYTES {
        let message = note!("layout.too_long", most = MAX_RECORD_BYTES, bytes = record_bytes);
        reader.error(&root.span, message, None);
        return None;
    }
    if let Some(c) = &checksum
        && c.to > record_bytes
    {
        let at = tables.checksum.map(|keys| keys.section.span_of("to")).unwrap_or_default();
        reader.error(&at, note!("layout.to_beyond", bytes = record_bytes), None);
    }
    (record_bytes > 0).then_some(Layout {
        header_bytes,
        record_bytes,
        sync,
        sample_rate_hz: tables.sample_rate_hz,
        checksum,
        columns,
    })
}

/// The bytes of the sync word.
fn sync(text: Option<&str>, root: &Section, reader: &mut Reader<'_>) -> Vec<u8> {
    let Some(text) = text else { return Vec::new() };
    let digits: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    let plain = digits.strip_prefix("0x").unwrap_or(&digits);
    let byte = |pair: &[u8]| std::str::from_utf8(pair).ok().and_then(|p| u8::from_str_radix(p, 16).ok());
    let hex = plain.bytes().all(|b| b.is_ascii_hexdigit());
    let bytes: Option<Vec<u8>> = plain.as_bytes().chunks(2).map(byte).collect();
    match bytes {
        Some(bytes)
            if hex && plain.len().is_multiple_of(2) && (1..=MAX_SYNC_BYTES).contains(&bytes.len()) =>
        {
            bytes
        }
        _ => {
            let help = note!("layout.write_sync", most = MAX_SYNC_BYTES);
            reader.error(&root.span_of("sync"), "layout.sync", Some(help));
            Vec::new()
        }
    }
}

/// Bytes of the record that are in use.
struct Taken {
    from: usize,
    to: usize,
    /// True when only some bits of them are.
    bits: bool,
    what: String,
}

fn overlap(place: &Taken, taken: &[Taken], span: &Span, reader: &mut Reader<'_>) {
    let clash = |t: &&Taken| t.from < place.to && place.from < t.to && !(t.bits && place.bits);
    if let Some(other) = taken.iter().find(clash) {
        let message = note!("layout.overlap", one = place.what.as_str(), other = other.what.as_str());
        reader.error(span, message, Some("layout.own_bytes".into()));
    }
}

/// Reads a field; gives the byte behind it.
fn field(
    keys: &FieldKeys,
    order: ByteOrder,
    next: usize,
    columns: &mut Vec<LayoutColumn>,
    taken: &mut Vec<Taken>,
    reader: &mut Reader<'_>,
) -> Option<usize> {
    let section = &keys.section;
    let (storage, kind) = keys.number_type.and_then(number_type)?;
    let given = section.entry("offset").is_some();
    let from = if given { size(keys.offset, section, "offset", reader)? } else { next };
    let count = size(keys.count, section, "count", reader)?;
    let to =
        count.checked_mul(kind.bytes()).and_then(|n| n.checked_add(from)).filter(|n| *n <= MAX_RECORD_BYTES);
    let Some(to) = to else {
        let message = note!("layout.field_beyond", most = MAX_RECORD_BYTES);
        reader.error(&section.span_of("offset"), message, None);
        return None;
    };
    let name = keys.name.clone()?;
    let bits = bits(keys, kind, reader);
    if keys.scale == Some(0.0) {
        reader.error(&section.span_of("scale"), "layout.scale", None);
    }
    let (unit, rollover_s) = (keys.unit.clone(), keys.rolls_over_s);
    let is_time = |u: &Unit| Unit::parse("s").is_ok_and(|s| s.same_dimension(u));
    if rollover_s.is_some() && !unit.as_ref().is_some_and(is_time) {
        let help = Some("layout.unit_of_time".into());
        reader.error(&section.span_of("rolls_over"), "layout.no_rollover", help);
    }
    let conversion = Affine { factor: keys.scale.unwrap_or_default(), offset: keys.offset_value };
    let place = Taken { from, to, bits: bits.is_some(), what: name.clone() };
    overlap(&place, taken, &section.span, reader);
    taken.push(place);
    for i in 0..count {
        let offset = from + i * kind.bytes();
        columns.push(LayoutColumn {
            name: if count == 1 { name.clone() } else { format!("{name}[{i}]") },
            storage,
            unit: unit.clone(),
            rollover_s,
            field: Field { bits, conversion, ..Field::plain(offset, kind, order) },
        });
    }
    Some(to)
}

/// Mask and shift of a field.
fn bits(keys: &FieldKeys, kind: NumberType, reader: &mut Reader<'_>) -> Option<(u64, u32)> {
    let section = &keys.section;
    let given = |key: &str| section.entry(key).is_some();
    let key = if given("mask") { "mask" } else { "shift" };
    if !given("mask") && !given("shift") {
        return None;
    }
    if !kind.is_whole() {
        let message = note!("layout.needs_whole", key);
        reader.error(&section.span_of(key), message, None);
        return None;
    }
    let width = 8 * kind.bytes() as u32;
    let all = u64::MAX >> (64 - width);
    let mask = if given("mask") { whole(keys.mask, section, "mask", reader)? } else { all };
    let shift = if given("shift") { whole(keys.shift, section, "shift", reader)? as u32 } else { 0 };
    if mask == 0 || mask & !all != 0 {
        let message = note!("layout.mask", width = u64::from(width));
        reader.error(&section.span_of("mask"), message, None);
        return None;
    }
    if shift >= width || mask >> shift == 0 {
        reader.error(&section.span_of("shift"), "layout.shift", None);
        return None;
    }
    Some((mask, shift))
}

fn number_type(word: &'static str) -> Option<(&'static str, NumberType)> {
    Some((
        word,
        match word {
            "u8" => NumberType::U8,
            "i8" => NumberType::I8,
            "u16" => NumberType::U16,
            "i16" => NumberType::I16,
            "u24" => NumberType::U24,
            "i24" => NumberType::I24,
            "u32" => NumberType::U32,
            "i32" => NumberType::I32,
            "u64" => NumberType::U64,
            "i64" => NumberType::I64,
            "f32" => NumberType::F32,
            "f64" => NumberType::F64,
            _ => return None,
        },
    ))
}

fn names(fields: &[FieldKeys], root: &Section, columns: &[LayoutColumn], reader: &mut Reader<'_>) {
    let mut seen = BTreeSet::new();
    for keys in fields {
        let Some(name) = keys.name.as_deref() else { continue };
        if !seen.insert(name) {
            let message = note!("layout.field_twice", name);
            reader.error(&keys.section.span_of("name"), message, Some("layout.own_name".into()));
        }
    }
    let all: BTreeSet<&str> = columns.iter().map(|c| c.name.as_str()).collect();
    if all.len() < columns.len() && seen.len() == fields.len() {
        reader.error(&root.span_of("field"), "layout.columns_twice", None);
    }
}

fn checksum(
    keys: &ChecksumKeys,
    order: ByteOrder,
    end: usize,
    is_declared: bool,
    reader: &mut Reader<'_>,
) -> Option<Checksum> {
    let section = &keys.section;
    let word = keys.sum?;
    let sum = Sum::of(word)?;
    let given = |key: &str| section.entry(key).is_some();
    let at = match (given("offset"), is_declared) {
        (true, _) => size(keys.offset, section, "offset", reader)?,
        (false, true) => end.saturating_sub(sum.bytes()),
        (false, false) => end,
    };
    let from = size(keys.from, section, "from", reader)?;
    let to = if given("to") { size(keys.to, section, "to", reader)? } else { at };
    if at > MAX_RECORD_BYTES {
        reader.error(&section.span_of("offset"), "layout.offset", None);
        return None;
    }
    if from >= to {
        let key = if given("to") { "to" } else { "from" };
        let message = note!("layout.no_bytes", from, to);
        reader.error(&section.span_of(key), message, None);
        return None;
    }
    if from < at + sum.bytes() && at < to {
        let key = if given("to") { "to" } else { "from" };
        let message = "layout.own_sum";
        reader.error(&section.span_of(key), message, Some(note!("layout.stands_at", at)));
        return None;
    }
    Some(Checksum { sum, word, at, from, to, order })
}

#[cfg(test)]
#[path = "read_tests.rs"]
mod tests;
