//! Containers that hold more than one table: which part is the recording, and which of its columns belong together.

use super::byte_stream::Packing;
use super::error::{IngestError, IngestErrorKind, shorten};
use super::{Candidate, Column};
use crate::column_inference::infer;
use sagnac_core::message::{Arg, Note, note};
use std::collections::BTreeMap;
use std::path::Path;

/// At most this many parts, and columns of a part, are listed in a diagnostic.
const LISTED: usize = 12;

/// One part of a container.
#[derive(Debug, Clone, Default)]
pub(super) struct Part {
    /// Name as the file has it.
    pub name: String,
    /// Its columns with their lengths.
    pub columns: Vec<(Column, u64)>,
}

impl Part {
    /// The length that most columns of numbers have, of equally frequent ones the greatest.
    pub fn common_rows(&self) -> Option<u64> {
        let mut counts: BTreeMap<u64, usize> = BTreeMap::new();
        for (_, rows) in self.columns.iter().filter(|(c, rows)| c.numeric && *rows > 1) {
            *counts.entry(*rows).or_default() += 1;
        }
        counts.into_iter().max_by_key(|&(rows, count)| (count, rows)).map(|(rows, _)| rows)
    }

    fn has_gyro(&self) -> bool {
        let rows = self.common_rows();
        self.columns
            .iter()
            .any(|(c, r)| c.numeric && Some(*r) == rows && infer(&c.name, c.unit.as_deref()).role.is_gyro())
    }

    /// Name, columns and length in words.
    fn describe(&self) -> Note {
        let names = self.columns.iter().take(LISTED).map(|(c, _)| shorten(&c.name));
        let mut names = names.collect::<Vec<_>>().join(", ");
        if self.columns.len() > LISTED {
            names.push_str(", …");
        }
        note!(
            "ingest.parts.part",
            name = shorten(&self.name),
            columns = names,
            rows = self.common_rows().unwrap_or(0)
        )
    }
}

/// The parts as a list in one sentence.
fn list<'a>(parts: impl Iterator<Item = &'a Part>) -> Arg {
    let parts: Vec<&Part> = parts.collect();
    let mut note: Option<Note> = (parts.len() > LISTED)
        .then(|| note!("ingest.parts.more", count = parts.len().saturating_sub(LISTED)));
    for part in parts.iter().take(LISTED).rev() {
        note = Some(match note {
            Some(rest) => note!("ingest.parts.and", first = part.describe(), rest),
            None => part.describe(),
        });
    }
    note.map_or_else(|| Arg::Text("–".to_owned()), Arg::from)
}

/// Chooses the part that is the recording: the one wanted, the only one with columns of numbers, or the only one among
/// them with a gyro. The notes say what was chosen and why.
///
/// # Errors
/// No such part, none with numbers, or several that could be it.
pub(super) fn choose(
    path: &Path,
    parts: &[Part],
    wanted: Option<&str>,
) -> Result<(usize, Vec<Note>), IngestError> {
    let error = |message: Note| IngestError::new(IngestErrorKind::UnknownFormat, path, message);
    let with_numbers = || parts.iter().filter(|p| p.common_rows().is_some());
    if let Some(wanted) = wanted {
        let plain = |name: &str| name.trim_matches('/').to_lowercase();
        let exact = parts.iter().position(|p| p.name == wanted);
        let found = exact.or_else(|| parts.iter().position(|p| plain(&p.name) == plain(wanted)));
        let Some(index) = found else {
            return Err(error(note!("ingest.parts.no_such", name = shorten(wanted)))
                .hint(note!("ingest.parts.hint.the_file_has", parts = list(with_numbers()))));
        };
        if parts.get(index).is_some_and(|p| p.common_rows().is_none()) {
            return Err(error(note!("ingest.parts.no_numbers_in", name = shorten(wanted)))
                .hint(note!("ingest.parts.hint.the_file_has", parts = list(with_numbers()))));
        }
        return Ok((index, vec![note!("ingest.parts.wanted", name = shorten(wanted))]));
    }
    let candidates: Vec<usize> =
        parts.iter().enumerate().filter(|(_, p)| p.common_rows().is_some()).map(|(i, _)| i).collect();
    let gyros: Vec<usize> =
        candidates.iter().copied().filter(|&i| parts.get(i).is_some_and(Part::has_gyro)).collect();
    let name = |i: usize| parts.get(i).map(|p| shorten(&p.name)).unwrap_or_default();
    match (candidates.as_slice(), gyros.as_slice()) {
        ([], _) => Err(IngestError::new(IngestErrorKind::Empty, path, "ingest.parts.none")
            .hint("ingest.parts.hint.check")),
        ([one], _) => Ok((*one, vec![note!("ingest.parts.only", name = name(*one))])),
        (_, [one]) => {
            let others = parts.iter().enumerate().filter(|(i, _)| i != one && candidates.contains(i));
            let note = note!("ingest.parts.gyro", name = name(*one), others = list(others.map(|(_, p)| p)));
            Ok((*one, vec![note]))
        }
        (several, among) => {
            let among = if among.is_empty() { several } else { among };
            let count = among.len();
            let listed = list(among.iter().filter_map(|&i| parts.get(i)));
            Err(error(note!("ingest.parts.several", count, parts = listed))
                .hint("ingest.parts.hint.name_one"))
        }
    }
}

/// Says which columns of a part are left out because their length is not that of the others.
pub(super) fn odd_lengths(part: &Part, rows: u64) -> Option<Note> {
    let odd: Vec<String> = part
        .columns
        .iter()
        .filter(|(c, r)| c.numeric && *r != rows)
        .take(LISTED)
        .map(|(c, r)| format!("`{}` ({r})", shorten(&c.name)))
        .collect();
    (!odd.is_empty()).then(|| note!("ingest.parts.odd_lengths", rows, columns = odd.join(", ")))
}

/// Refuses a packed container: its parts are found by their place in the file.
pub(super) fn unpacked(file: &Candidate, what: &'static str) -> Result<(), IngestError> {
    if file.packing == Packing::Plain {
        return Ok(());
    }
    Err(IngestError::new(
        IngestErrorKind::UnknownFormat,
        &file.path,
        note!("ingest.parts.packed", what = Arg::Key(what.to_owned()), packing = file.packing.id()),
    )
    .hint("ingest.hint.unpack"))
}
