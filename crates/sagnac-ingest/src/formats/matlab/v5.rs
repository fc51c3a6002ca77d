//! MAT files of version 5 and 7: the variables and where their numbers stand.

use super::element_reader::{COMPRESSED, ElementReader, MATRIX, Tag, damaged, number_type, text, wholes};
use super::variables::{NumericArray, Variables};
use crate::Candidate;
use crate::binary::column_stream::{Coding, Stream, stream_error};
use crate::binary::positioned_file::PositionedFile;
use crate::error::{IngestError, IngestErrorKind};
use crate::layout::{ByteOrder, Field};
use sagnac_core::message::{Note, note};
use std::io;
use std::sync::Arc;

/// Length of the header of the file, bytes.
const HEADER: u64 = 128;

/// Most variables and fields of a file.
const MAX_VARIABLES: usize = 4096;

/// Longest text that is kept, bytes.
const MAX_TEXT_BYTES: u64 = 800;

/// Byte order of a file of version 5, found at the end of its header; `None` for any other file.
pub(super) fn byte_order(head: &[u8]) -> Option<ByteOrder> {
    match head.get(124..128)? {
        [0, 1, b'I', b'M'] => Some(ByteOrder::Little),
        [1, 0, b'M', b'I'] => Some(ByteOrder::Big),
        _ => None,
    }
}

/// Looks at every variable of a file.
pub(super) fn walk(
    file: &Candidate,
    at: &Arc<PositionedFile>,
    order: ByteOrder,
) -> Result<Variables, IngestError> {
    let mut found = Variables::default();
    let mut next = HEADER;
    while next < at.size {
        if found.streams.len() >= MAX_VARIABLES {
            let note = note!("ingest.binary.too_many_columns", most = MAX_VARIABLES);
            return Err(IngestError::new(IngestErrorKind::Damaged, &file.path, note)
                .hint("ingest.hint.give_recording"));
        }
        let fail = |e: io::Error| element_error(file, next, &e);
        let raw =
            Stream { name: format!("@{next}"), from: next, length: at.size - next, coding: Coding::Stored };
        let mut elements = ElementReader::new(raw.open(at), order);
        let tag = elements.tag().map_err(fail)?;
        if tag.bytes > at.size.saturating_sub(next.saturating_add(tag.at)) {
            let note = note!("ingest.mat.cut", at = next, declared = tag.bytes);
            return Err(
                IngestError::new(IngestErrorKind::Damaged, &file.path, note).hint("ingest.hint.cut_off")
            );
        }
        let stream = found.streams.len();
        match tag.kind {
            COMPRESSED => {
                let packed = Stream { from: next + tag.at, length: tag.bytes, coding: Coding::Zlib, ..raw };
                let mut inner = ElementReader::new(packed.open(at), order);
                let tag = inner.tag().map_err(fail)?;
                if tag.kind == MATRIX {
                    matrix(&mut inner, &mut found, stream, None).map_err(fail)?;
                }
                found.streams.push(named(packed, &found, stream));
            }
            MATRIX => {
                matrix(&mut elements, &mut found, stream, None).map_err(fail)?;
                found.streams.push(named(raw, &found, stream));
            }
            _ => {}
        }
        next = next.saturating_add(tag.at).saturating_add(tag.bytes);
    }
    Ok(found)
}

/// The diagnostic of an element that cannot be read.
fn element_error(file: &Candidate, at: u64, error: &io::Error) -> IngestError {
    let (note, hint) = match error.kind() {
        io::ErrorKind::UnexpectedEof => (note!("ingest.mat.element_short"), "ingest.hint.cut_off"),
        io::ErrorKind::InvalidData | io::ErrorKind::InvalidInput => {
            let note = note!("ingest.mat.element_damaged", reason = error.to_string());
            (note, "ingest.hint.copy_again")
        }
        _ => return stream_error(&file.path, &at.to_string(), error),
    };
    IngestError::new(IngestErrorKind::Damaged, &file.path, note.with("at", at)).hint(hint)
}

/// The stream under the name of the variable that is in it.
fn named(stream: Stream, found: &Variables, index: usize) -> Stream {
    match found.numbers.iter().find(|n| n.stream == index) {
        Some(numbers) => {
            Stream { name: numbers.owner.clone().unwrap_or_else(|| numbers.name.clone()), ..stream }
        }
        None => stream,
    }
}

/// Reads what stands between the tag of an array and its numbers. `owner`: the structure it is a field of, and the
/// name of the field.
fn matrix(
    elements: &mut ElementReader,
    found: &mut Variables,
    stream: usize,
    owner: Option<(&str, &str)>,
) -> io::Result<()> {
    let order = elements.order;
    let flags = elements.tag()?;
    let flags =
        *wholes(&elements.data(&flags)?, order).first().ok_or_else(|| damaged("an array has no flags"))?;
    let class = flags & 0xff;
    if class == 17 {
        return opaque(elements, found, owner);
    }
    let tag = elements.tag()?;
    let dimensions: Vec<u64> = wholes(&elements.data(&tag)?, order).into_iter().map(u64::from).collect();
    let tag = elements.tag()?;
    let own = String::from_utf8_lossy(&elements.data(&tag)?).into_owned();
    let name = owner.map_or_else(|| own.clone(), |(structure, field)| format!("{structure}.{field}"));
    if name.is_empty() {
        // What MATLAB keeps for its objects stands behind the variables without a name.
        return Ok(());
    }
    let count = dimensions.iter().try_fold(1u64, |all, n| all.checked_mul(*n));
    let count = count.ok_or_else(|| damaged("the size of an array makes no sense"))?;
    let mut leave = |key: &'static str| found.leave(&name, Note::new(key));
    match class {
        1 => leave("ingest.mat.cell"),
        2 if owner.is_some() => leave("ingest.mat.nested"),
        2 if count != 1 => leave("ingest.mat.structures"),
        2 => return structure(elements, found, stream, &name),
        3 => leave("ingest.mat.object"),
        4 => {
            let tag = elements.tag()?;
            if tag.bytes <= MAX_TEXT_BYTES {
                let data = elements.data(&tag)?;
                found.keep(&name, &text(tag.kind, &data, order));
            }
        }
        5 => leave("ingest.mat.sparse"),
        6..=15 if flags & 0x0800 != 0 => leave("ingest.mat.complex"),
        6..=15 if count == 0 => leave("ingest.mat.empty"),
        6..=15 => return numbers(elements, found, stream, owner, name, (dimensions, count)),
        _ => leave("ingest.mat.object"),
    }
    Ok(())
}

/// Notes where the numbers of an array stand.
fn numbers(
    elements: &mut ElementReader,
    found: &mut Variables,
    stream: usize,
    owner: Option<(&str, &str)>,
    name: String,
    (dimensions, count): (Vec<u64>, u64),
) -> io::Result<()> {
    let tag: Tag = elements.tag()?;
    let kind = number_type(tag.kind).ok_or_else(|| damaged("an array holds data of an unknown type"))?;
    if count.checked_mul(kind.bytes() as u64) != Some(tag.bytes) {
        return Err(damaged("the size of an array does not fit its data"));
    }
    let field = Field::plain(0, kind, elements.order);
    if count == 1 {
        let data = elements.data(&tag)?;
        let mut value = Vec::new();
        field.decode(&data, kind.bytes(), &mut value);
        found.scalar(&name, value.first().copied().unwrap_or(f64::NAN));
        return Ok(());
    }
    let owner = owner.map(|(structure, _)| structure.to_owned());
    found.numbers.push(NumericArray { name, owner, dimensions, field, stream, offset: tag.at });
    Ok(())
}

/// Looks at the fields of a structure.
fn structure(
    elements: &mut ElementReader,
    found: &mut Variables,
    stream: usize,
    name: &str,
) -> io::Result<()> {
    let tag = elements.tag()?;
    let length = wholes(&elements.data(&tag)?, elements.order).first().copied().unwrap_or(0) as usize;
    let tag = elements.tag()?;
    let names = elements.data(&tag)?;
    let fields: Vec<String> = names
        .chunks(length.clamp(1, 1 << 16))
        .map(|n| String::from_utf8_lossy(n.split(|b| *b == 0).next().unwrap_or_default()).into_owned())
        .collect();
    for field in fields.iter().take(MAX_VARIABLES) {
        let tag = elements.tag()?;
        if tag.kind != MATRIX {
            return Err(damaged("a field of a structure is no array"));
        }
        // An empty field has no array at all.
        if tag.bytes > 0 {
            matrix(elements, found, stream, Some((name, field)))?;
        }
        elements.pass(&tag)?;
    }
    Ok(())
}

/// An object of a class of MATLAB, such as a timetable: its values are kept in a way that is not published.
fn opaque(
    elements: &mut ElementReader,
    found: &mut Variables,
    owner: Option<(&str, &str)>,
) -> io::Result<()> {
    let mut words = Vec::new();
    for _ in 0..3 {
        let tag = elements.tag()?;
        words.push(String::from_utf8_lossy(&elements.data(&tag)?).into_owned());
    }
    let [name, _, class] = words.as_slice() else { return Ok(()) };
    let name = owner.map_or_else(|| name.clone(), |(structure, field)| format!("{structure}.{field}"));
    let class = crate::error::shorten(class);
    found.leave(&name, note!("ingest.mat.class", class));
    found.has_objects = true;
    Ok(())
}
