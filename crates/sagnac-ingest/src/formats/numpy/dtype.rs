//! NumPy's descriptions of element types as fields of a record.

use super::literal::Literal;
use crate::layout::MAX_COLUMNS;
use crate::layout::{ByteOrder, Field, NumberType, Ticks};

/// Deepest nesting of structures that is followed.
const MAX_DEPTH: usize = 8;

/// One number, or something that is none, within an element.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Leaf {
    /// Names from outside to inside, joined by points; empty for an element that is a number itself.
    pub name: String,
    /// Type as NumPy writes it.
    pub storage: String,
    /// Where the number stands; `None` where it is none that is read.
    pub field: Option<Field>,
    /// True for dates, whose ticks have no zero yet; false for durations and plain numbers.
    pub date: bool,
}

/// An element type.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Element {
    /// Its numbers.
    pub leaves: Vec<Leaf>,
    /// Its length, bytes.
    pub bytes: usize,
    /// Types looked at so far: fields without numbers must not make the reading endless.
    seen: usize,
}

/// Why a type cannot be read.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum TypeFault {
    /// Python objects: reading them would run code from the file.
    Objects,
    /// Not a type, as far as is known here.
    Unknown(String),
    /// More fields than a recording has.
    TooMany,
}

/// Reads the description of an element type.
pub(super) fn element(descr: &Literal) -> Result<Element, TypeFault> {
    let mut out = Element { leaves: Vec::new(), bytes: 0, seen: 0 };
    append(&mut out, "", descr, 0)?;
    Ok(out)
}

fn append(out: &mut Element, name: &str, descr: &Literal, depth: usize) -> Result<(), TypeFault> {
    let unknown = || TypeFault::Unknown(format!("{descr:?}").chars().take(60).collect());
    if depth > MAX_DEPTH {
        return Err(unknown());
    }
    out.seen += 1;
    if out.seen > 4 * MAX_COLUMNS || out.leaves.len() > MAX_COLUMNS {
        return Err(TypeFault::TooMany);
    }
    match descr {
        Literal::Text(text) => {
            let (leaf, bytes) = simple(name, text, out.bytes)?;
            out.bytes = out.bytes.checked_add(bytes).ok_or_else(unknown)?;
            // Fields without a name fill the record up to its alignment.
            if !(text.contains('V') && leaf.field.is_none()) {
                out.leaves.push(leaf);
            }
        }
        Literal::List(fields) => {
            for field in fields {
                append_field(out, name, field.list().ok_or_else(unknown)?, depth, unknown)?;
            }
        }
        _ => return Err(unknown()),
    }
    Ok(())
}

/// Appends a field of a record, described by its label, its type and perhaps a shape.
fn append_field(
    out: &mut Element,
    name: &str,
    parts: &[Literal],
    depth: usize,
    unknown: impl Fn() -> TypeFault,
) -> Result<(), TypeFault> {
    let [label, kind, rest @ ..] = parts else { return Err(unknown()) };
    let label = match label {
        Literal::List(pair) => pair.last().and_then(Literal::text),
        label => label.text(),
    };
    let label = label.ok_or_else(&unknown)?;
    let inner = if name.is_empty() { label.to_owned() } else { format!("{name}.{label}") };
    let Some(shape) = rest.first() else { return append(out, &inner, kind, depth + 1) };
    let count = count(shape).ok_or_else(unknown)?;
    if count > MAX_COLUMNS {
        return Err(TypeFault::TooMany);
    }
    (0..count).try_for_each(|i| append(out, &format!("{inner}[{i}]"), kind, depth + 1))
}

/// Number of elements of a shape.
fn count(shape: &Literal) -> Option<usize> {
    let dimensions = match shape {
        Literal::Whole(n) => return usize::try_from(*n).ok(),
        shape => shape.list()?,
    };
    dimensions.iter().try_fold(1usize, |all, d| all.checked_mul(usize::try_from(d.whole()?).ok()?))
}

/// A type that is one text, such as `<f8`.
fn simple(name: &str, text: &str, offset: usize) -> Result<(Leaf, usize), TypeFault> {
    let unknown = || TypeFault::Unknown(text.chars().take(60).collect());
    let mut chars = text.chars();
    let (order, code) = match chars.next() {
        Some('<' | '|') => (ByteOrder::Little, chars.next()),
        Some('=') => {
            (if cfg!(target_endian = "big") { ByteOrder::Big } else { ByteOrder::Little }, chars.next())
        }
        Some('>') => (ByteOrder::Big, chars.next()),
        other => (ByteOrder::Little, other),
    };
    let rest = chars.as_str();
    let code = code.ok_or_else(unknown)?;
    let (digits, metadata) = rest.split_once('[').map_or((rest, None), |(d, m)| (d, m.strip_suffix(']')));
    let size: usize = if digits.is_empty() { 1 } else { digits.parse().map_err(|_| unknown())? };
    let mut leaf = Leaf { name: name.to_owned(), storage: text.to_owned(), field: None, date: false };
    let kind = match (code, size) {
        ('b', 1) | ('u', 1) => Some(NumberType::U8),
        ('?', _) => {
            return Ok((Leaf { field: Some(Field::plain(offset, NumberType::U8, order)), ..leaf }, 1));
        }
        ('i', 1) => Some(NumberType::I8),
        ('i', 2) => Some(NumberType::I16),
        ('i', 4) => Some(NumberType::I32),
        ('i', 8) => Some(NumberType::I64),
        ('u', 2) => Some(NumberType::U16),
        ('u', 4) => Some(NumberType::U32),
        ('u', 8) => Some(NumberType::U64),
        ('f', 2) => Some(NumberType::F16),
        ('f', 4) => Some(NumberType::F32),
        ('f', 8) => Some(NumberType::F64),
        ('M' | 'm', 8) => {
            leaf.date = code == 'M';
            leaf.field = metadata.and_then(tick).map(|tick_s| Field {
                ticks: Some(Ticks { zero: 0, tick_s }),
                ..Field::plain(offset, NumberType::I64, order)
            });
            return Ok((leaf, 8));
        }
        ('O', _) => return Err(TypeFault::Objects),
        // Characters are four bytes each.
        ('U', n) => return Ok((leaf, n.checked_mul(4).ok_or_else(unknown)?)),
        ('S' | 'a' | 'V' | 'c' | 'f', n) => return Ok((leaf, n)),
        _ => return Err(unknown()),
    };
    leaf.field = kind.map(|kind| Field::plain(offset, kind, order));
    Ok((leaf, size))
}

/// Length of a tick such as `ns` or `10ms`, s; `None` for months and years, which have none.
fn tick(unit: &str) -> Option<(f64, f64)> {
    let letters = unit.trim_start_matches(|c: char| c.is_ascii_digit());
    let digits = unit.strip_suffix(letters).unwrap_or_default();
    let count: u32 = if digits.is_empty() { 1 } else { digits.parse().ok()? };
    let (factor, divisor) = match letters {
        "W" => (604_800.0, 1.0),
        "D" => (86_400.0, 1.0),
        "h" => (3600.0, 1.0),
        "m" => (60.0, 1.0),
        "s" => (1.0, 1.0),
        "ms" => (1.0, 1e3),
        "us" | "μs" => (1.0, 1e6),
        "ns" => (1.0, 1e9),
        "ps" => (1.0, 1e12),
        "fs" => (1.0, 1e15),
        "as" => (1.0, 1e18),
        _ => return None,
    };
    (count > 0).then_some((factor * f64::from(count), divisor))
}

#[cfg(test)]
mod tests {
    use super::super::literal::parse;
    use super::*;

    #[test]
    fn structures_give_named_places() {
        let descr =
            "[('t', '<M8[10us]'), ('g', '>i2', (2,)), ('', '|V4'), ('in', [('x', '|u1'), ('s', '<U3')])]";
        let e = element(&parse(descr).unwrap()).unwrap();
        assert_eq!(e.bytes, 8 + 4 + 4 + 1 + 12);
        let places: Vec<_> = e.leaves.iter().map(|l| (l.name.as_str(), l.field.map(|f| f.offset))).collect();
        assert_eq!(
            places,
            [("t", Some(0)), ("g[0]", Some(8)), ("g[1]", Some(10)), ("in.x", Some(16)), ("in.s", None)]
        );
        assert_eq!(e.leaves[0].field.unwrap().ticks.unwrap().tick_s, (10.0, 1e6));
        assert!(e.leaves[0].date && !e.leaves[1].date);
    }

    #[test]
    fn objects_and_nonsense_are_refused() {
        let of = |text: &str| element(&parse(text).unwrap()).unwrap_err();
        assert_eq!(of("'|O'"), TypeFault::Objects);
        assert_eq!(of("[('a', '|O')]"), TypeFault::Objects);
        assert_eq!(of("'<q3'"), TypeFault::Unknown("<q3".into()));
        assert_eq!(of("[('a', '<f8', (9999999, 9999999))]"), TypeFault::TooMany);
        assert!(matches!(of("[('a',)]"), TypeFault::Unknown(_)));
        assert!(matches!(of("'<U9999999999999999999'"), TypeFault::Unknown(_)));
    }
}
