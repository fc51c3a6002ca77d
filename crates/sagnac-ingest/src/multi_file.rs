//! Several files as one recording: the same columns, read one after the other, never more than one file open.

use super::byte_stream::digest;
use super::error::{IngestError, IngestErrorKind};
use super::source::{NoNumbers, PartFacts, ReadSeveral, SeveralFiles, Source, open_with};
use super::{Column, FileFacts, OnBlock, Opened, ReadOptions};
use crate::column_inference::stem;
use sagnac_core::message::{Note, note};
use sagnac_core::units::Affine;
use sagnac_core::units::Unit;
use std::path::{Path, PathBuf};

/// Most statements of the files about themselves that are kept.
const MAX_METADATA: usize = 256;

/// Most files of a recording.
pub const MAX_FILES: usize = 10_000;

/// One file of a recording of several.
struct Part {
    /// The file.
    source: Source,
    /// For each column of the recording: its place in this file, and the conversion to the unit of the first file.
    columns: Vec<(usize, Affine)>,
    /// Hash that its manifest states.
    stated_sha256: Option<String>,
}

/// One file of a recording of several.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PartSpec {
    /// Path.
    pub path: PathBuf,
    /// SHA-256 that the file must have, hexadecimal.
    pub sha256: Option<String>,
    /// Phase of the test that it belongs to.
    pub phase: Option<String>,
}

/// Opens files that follow each other as one recording. `name` stands for the whole in diagnostics; `contiguous`: each
/// file continues the one before without a gap.
///
/// # Errors
/// The error of [`open_with`] for one of them; columns that differ; a file that is listed twice.
pub fn open(
    name: &Path,
    specs: &[PartSpec],
    contiguous: bool,
    options: &ReadOptions,
) -> Result<Source, IngestError> {
    let error = |path: &Path, note: Note| IngestError::new(IngestErrorKind::Parts, path, note);
    if specs.len() > MAX_FILES {
        let note = note!("ingest.joined.too_many", count = specs.len(), most = MAX_FILES);
        return Err(error(name, note));
    }
    let mut parts: Vec<Part> = Vec::new();
    let mut first: Option<Vec<Column>> = None;
    for spec in specs {
        let source = open_with(&spec.path, options)?;
        let columns = match &first {
            None => (0..source.columns().len()).map(|i| (i, Affine::IDENTITY)).collect(),
            Some(columns) => {
                match_columns(columns, &source, specs.first().map_or(name, |s| s.path.as_path()))?
            }
        };
        first.get_or_insert_with(|| source.columns().to_vec());
        parts.push(Part { source, columns, stated_sha256: spec.sha256.clone() });
    }
    let none = || error(name, note!("ingest.joined.none"));
    let Some(columns) = first else { return Err(none()) };
    refuse_duplicates(&parts)?;
    let rows = parts.iter().map(|p| p.source.rows_estimate()).sum::<Option<u64>>();
    let mut notes = vec![note!("ingest.joined.note", count = parts.len())];
    for note in parts.iter().flat_map(|p| p.source.notes()) {
        if notes.len() < 64 && !notes.contains(note) {
            notes.push(note.clone());
        }
    }
    let mut metadata: Vec<(String, String)> = Vec::new();
    for pair in parts.iter().flat_map(|p| p.source.metadata()) {
        if metadata.len() < MAX_METADATA && !metadata.contains(pair) {
            metadata.push(pair.clone());
        }
    }
    let stated = parts.first().and_then(|p| p.source.stated_sample_rate_hz());
    let described = Opened {
        labels: Vec::new(),
        bad_blocks: Vec::new(),
        columns,
        rows_estimate: rows,
        cut_off: parts.iter().flat_map(|p| p.source.cut_off()).cloned().collect(),
        notes,
        metadata,
        stated_sample_rate_hz: stated,
        table: super::in_memory::nothing().table,
    };
    let sensors = parts.iter().find_map(|p| p.source.sensors()).cloned();
    let files = specs.iter().map(|s| (s.path.clone(), s.phase.clone())).collect();
    let bytes = parts.iter().map(|p| p.source.bytes()).sum();
    let Some((format, packing)) = parts.first().map(|p| (p.source.format(), p.source.packing())) else {
        return Err(none());
    };
    let several = SeveralFiles { files, contiguous, reader: Box::new(Parts(parts)) };
    Ok(Source::of_several(name, format, packing, bytes, several, (described, sensors)))
}

/// Finds the columns of the first file in another one: by name, or by the name without its unit.
fn match_columns(
    columns: &[Column],
    source: &Source,
    first: &Path,
) -> Result<Vec<(usize, Affine)>, IngestError> {
    let error = |key, column: &str| {
        let note = Note::new(key).with("column", column).with("first", first.display().to_string());
        IngestError::new(IngestErrorKind::Parts, source.path(), note).hint("ingest.joined.hint.same_columns")
    };
    let own = source.columns();
    let mut taken = vec![false; own.len()];
    let mut out = Vec::with_capacity(columns.len());
    for column in columns {
        let free = |i: &usize| taken.get(*i).is_some_and(|t| !t);
        let by = |same: &dyn Fn(&Column) -> bool| {
            (0..own.len()).filter(free).find(|i| own.get(*i).is_some_and(same))
        };
        let found = by(&|c| c.name == column.name).or_else(|| by(&|c| stem(&c.name) == stem(&column.name)));
        let Some((index, other)) = found.and_then(|i| Some((i, own.get(i)?))) else {
            return Err(error("ingest.joined.column_missing", &column.name));
        };
        if let Some(t) = taken.get_mut(index) {
            *t = true;
        }
        let conversion = conversion(column, other).ok_or_else(|| {
            let units = |c: &Column| c.unit.clone().unwrap_or_else(|| c.inferred().unit.text().into());
            let note = note!(
                "ingest.joined.units",
                column = other.name.as_str(),
                unit = units(other),
                wanted = units(column),
                first = first.display().to_string()
            );
            IngestError::new(IngestErrorKind::Parts, source.path(), note)
        })?;
        out.push((index, conversion));
    }
    match taken.iter().position(|t| !t).and_then(|i| own.get(i)) {
        Some(extra) => Err(error("ingest.joined.column_extra", &extra.name)),
        None => Ok(out),
    }
}

/// The conversion from the numbers of one column to those of another; `None` where their units do not convert.
fn conversion(to: &Column, from: &Column) -> Option<Affine> {
    let named = |c: &Column| {
        let g = c.inferred();
        g.unit_is_named.then_some(g.unit)
    };
    let declared = |c: &Column| c.unit.as_deref().and_then(|u| Unit::parse(u).ok());
    let unit = |c: &Column| declared(c).or_else(|| named(c));
    let conversion = match (unit(from), unit(to)) {
        (Some(a), Some(b)) if a.text() != b.text() => a.affine_to(&b).ok()?,
        _ => Affine::IDENTITY,
    };
    // Stamps with a date count from a day of their own in each file.
    let days = match (from.epoch_s, to.epoch_s) {
        (Some(a), Some(b)) => a - b,
        (None, None) => 0.0,
        _ => return None,
    };
    Some(Affine { offset: conversion.offset + days, ..conversion })
}

/// Refuses a file that is there twice, under one name or two.
fn refuse_duplicates(parts: &[Part]) -> Result<(), IngestError> {
    let mut seen: Vec<(u64, &Path, Option<String>)> = Vec::new();
    for part in parts {
        let (bytes, path) = (part.source.bytes(), part.source.path());
        let mut own = None;
        for (_, other, hash) in seen.iter_mut().filter(|s| s.0 == bytes) {
            if hash.is_none() {
                *hash = Some(digest(other)?.sha256);
            }
            if own.is_none() {
                own = Some(digest(path)?.sha256);
            }
            if *hash == own {
                let note = note!("ingest.joined.twice", other = other.display().to_string());
                return Err(
                    IngestError::new(IngestErrorKind::Parts, path, note).hint("ingest.joined.hint.name_once")
                );
            }
        }
        seen.push((bytes, path, own));
    }
    Ok(())
}

/// The files of a recording, read one after the other. Rows count on from file to file; lines are those of their file.
struct Parts(Vec<Part>);

impl ReadSeveral for Parts {
    fn read(
        &self,
        wanted: &[usize],
        no_numbers: NoNumbers,
        on_block: &mut OnBlock<'_>,
        on_part: &mut dyn FnMut(usize, PartFacts),
    ) -> Result<Option<FileFacts>, IngestError> {
        let (mut rows_before, mut bytes_before) = (0u64, 0u64);
        for (index, part) in self.0.iter().enumerate() {
            let places: Vec<(usize, Affine)> =
                wanted.iter().filter_map(|w| part.columns.get(*w).copied()).collect();
            let own: Vec<usize> = places.iter().map(|(place, _)| *place).collect();
            let facts = part.source.read_with(
                &own,
                no_numbers,
                &mut |block| {
                    block.part = index;
                    block.first_row += rows_before;
                    block.faults.iter_mut().for_each(|f| f.row += rows_before);
                    for (column, (_, conversion)) in block.columns.iter_mut().zip(&places) {
                        conversion.apply_all(column);
                    }
                    block.bytes_done += bytes_before;
                    on_block(block)
                },
                &mut |_, _| {},
            )?;
            let Some(facts) = facts else { return Ok(None) };
            if let Some(stated) =
                part.stated_sha256.as_ref().filter(|s| !s.eq_ignore_ascii_case(&facts.sha256))
            {
                let note =
                    note!("ingest.joined.hash", found = facts.sha256.as_str(), stated = stated.as_str());
                return Err(IngestError::new(IngestErrorKind::Changed, part.source.path(), note));
            }
            let rows = facts.rows;
            bytes_before += facts.bytes;
            on_part(index, PartFacts { facts, rows_before });
            rows_before += rows;
        }
        Ok(Some(FileFacts { sha256: String::new(), bytes: bytes_before, rows: rows_before }))
    }
}
