//! MAT files of version 4: for every variable five whole numbers, its name, its numbers column by column.

use super::variables::{NumericArray, Variables};
use crate::Candidate;
use crate::binary::column_stream::{Coding, Stream};
use crate::binary::positioned_file::PositionedFile;
use crate::byte_stream::io_error;
use crate::error::{IngestError, IngestErrorKind};
use crate::layout::{ByteOrder, Field, NumberType};
use sagnac_core::message::{Note, note};
use std::sync::Arc;

/// Length of what stands before the name of a variable, bytes.
const HEADER: u64 = 20;

/// Longest name, bytes.
const MAX_NAME_BYTES: u32 = 256;

/// Most variables of a file.
const MAX_VARIABLES: usize = 4096;

/// The header of a variable.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Header {
    order: ByteOrder,
    kind: NumberType,
    /// 0: numbers, 1: text, 2: sparse.
    class: u32,
    rows: u32,
    columns: u32,
    complex: bool,
    name_bytes: u32,
}

/// Reads the header of a variable; `None` when it is none.
fn header(bytes: &[u8]) -> Option<Header> {
    let (words, _) = bytes.get(..HEADER as usize)?.as_chunks::<4>();
    let with = |order: ByteOrder| {
        let word = |i: usize| {
            let b = words.get(i)?;
            Some(match order {
                ByteOrder::Little => u32::from_le_bytes(*b),
                ByteOrder::Big => u32::from_be_bytes(*b),
            })
        };
        let mopt = word(0)?;
        let (machine, zero, precision, class) = (mopt / 1000, mopt / 100 % 10, mopt / 10 % 10, mopt % 10);
        let kind = match precision {
            0 => NumberType::F64,
            1 => NumberType::F32,
            2 => NumberType::I32,
            3 => NumberType::I16,
            4 => NumberType::U16,
            5 => NumberType::U8,
            _ => return None,
        };
        let fits = machine == u32::from(order == ByteOrder::Big) && zero == 0 && class <= 2;
        let (complex, name_bytes) = (word(3)?, word(4)?);
        let sound = fits && complex <= 1 && (1..=MAX_NAME_BYTES).contains(&name_bytes);
        let (rows, columns) = (word(1)?, word(2)?);
        (sound && rows < 1 << 31 && columns < 1 << 31).then_some(Header {
            order,
            kind,
            class,
            rows,
            columns,
            complex: complex == 1,
            name_bytes,
        })
    };
    with(ByteOrder::Little).or_else(|| with(ByteOrder::Big))
}

/// A name as MATLAB allows it, with the zero behind it.
fn name(bytes: &[u8]) -> Option<String> {
    let (name, rest) = bytes.split_at(bytes.iter().position(|b| *b == 0)?);
    let text = std::str::from_utf8(name).ok()?;
    let sound = text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && rest.iter().all(|b| *b == 0);
    sound.then(|| text.to_owned())
}

/// True when a file begins as one of version 4 does.
pub(super) fn recognises(head: &[u8]) -> bool {
    let start = HEADER as usize;
    header(head).is_some_and(|h| head.get(start..start + h.name_bytes as usize).and_then(name).is_some())
}

/// Looks at every variable of a file.
pub(super) fn walk(file: &Candidate, at: &Arc<PositionedFile>) -> Result<Variables, IngestError> {
    let mut found = Variables::default();
    let mut next = 0u64;
    let damaged = |key: &'static str, at: u64, hint: &'static str| {
        IngestError::new(IngestErrorKind::Damaged, &file.path, Note::new(key).with("at", at)).hint(hint)
    };
    while next < at.size {
        if found.streams.len() >= MAX_VARIABLES {
            let note = note!("ingest.binary.too_many_columns", most = MAX_VARIABLES);
            return Err(IngestError::new(IngestErrorKind::Damaged, &file.path, note)
                .hint("ingest.hint.give_recording"));
        }
        let mut head = vec![0; HEADER as usize + MAX_NAME_BYTES as usize];
        let n = at.read(next, &mut head).map_err(|e| io_error(&file.path, &e))?;
        head.truncate(n);
        let bad = || damaged("ingest.mat.no_variable", next, "ingest.hint.damaged");
        let h = header(&head).ok_or_else(bad)?;
        let start = HEADER as usize;
        let name = head.get(start..start + h.name_bytes as usize).and_then(name).ok_or_else(bad)?;
        let data_at = next + HEADER + u64::from(h.name_bytes);
        let count = u64::from(h.rows) * u64::from(h.columns);
        let bytes = count
            .checked_mul(h.kind.bytes() as u64)
            .and_then(|b| b.checked_mul(1 + u64::from(h.complex)))
            .filter(|b| *b <= at.size.saturating_sub(data_at))
            .ok_or_else(|| damaged("ingest.mat.cut_4", next, "ingest.hint.cut_off"))?;
        let field = Field::plain(0, h.kind, h.order);
        let values = |most: u64| {
            let mut data = vec![0; (count.min(most) as usize).saturating_mul(h.kind.bytes())];
            at.read(data_at, &mut data).map_err(|e| io_error(&file.path, &e))?;
            let mut values = Vec::new();
            field.decode(&data, h.kind.bytes(), &mut values);
            Ok::<_, IngestError>(values)
        };
        match h.class {
            1 => {
                let characters = values(400)?.into_iter().filter_map(|v| char::from_u32(v as u32));
                found.keep(&name, &characters.collect::<String>());
            }
            2 => found.leave(&name, "ingest.mat.sparse".into()),
            _ if h.complex => found.leave(&name, "ingest.mat.complex".into()),
            _ if count == 0 => found.leave(&name, "ingest.mat.empty".into()),
            _ if count == 1 => found.scalar(&name, values(1)?.first().copied().unwrap_or(f64::NAN)),
            _ => {
                let dimensions = vec![u64::from(h.rows), u64::from(h.columns)];
                let stream = found.streams.len();
                found.streams.push(Stream {
                    name: name.clone(),
                    from: data_at,
                    length: bytes,
                    coding: Coding::Stored,
                });
                found.numbers.push(NumericArray { name, owner: None, dimensions, field, stream, offset: 0 });
            }
        }
        next = data_at + bytes;
    }
    Ok(found)
}
