//! The columns of a file: which hold numbers, and what each is taken for.

use crate::ingest::{FirstFields, IngestError, IngestErrorKind, Source};
use crate::recording::column_inference::InferredColumn;
use crate::recording::{Channel, ColumnRef, Role};
use crate::units::Unit;
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// What a column holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Content {
    /// Numbers.
    Numbers,
    /// Text, with the first piece of it.
    Text(String),
    /// No field has a value.
    Nothing,
}

/// A column with what it is taken for.
#[derive(Debug, Clone)]
pub(super) struct Listed {
    pub name: String,
    pub content: Content,
    pub guess: InferredColumn,
}

impl Listed {
    /// True when the name speaks of a gyro but the numbers are counts, whose size is not known.
    pub fn counts_of_a_gyro(&self) -> bool {
        let counts = Unit::parse("count").is_ok_and(|c| c.same_dimension(&self.guess.unit));
        let name = self.name.to_lowercase();
        let words = ["gyro", "fog", "rlg", "rate", "omega"];
        self.content == Content::Numbers && counts && words.iter().any(|w| name.contains(w))
    }
}

/// Looks at every column of a file.
///
/// # Errors
/// What [`Source::read`] says, and the fault of the first column when none holds numbers.
pub(super) fn list(source: &Source) -> Result<Vec<Listed>, IngestError> {
    let columns = source.columns();
    let numeric: Vec<usize> =
        (0..columns.len()).filter(|&i| columns.get(i).is_some_and(|c| c.numeric)).collect();
    let looked: BTreeMap<usize, FirstFields> =
        numeric.iter().copied().zip(source.first_fields(&numeric)?).collect();
    let listed = columns.iter().enumerate().map(|(index, column)| Listed {
        name: column.name.clone(),
        content: looked.get(&index).map_or_else(|| Content::Text(column.storage.clone()), content),
        guess: column.inferred(),
    });
    let mut listed: Vec<Listed> = listed.collect();
    let time = source.time_column().filter(|&t| listed.get(t).is_some_and(|c| c.content == Content::Numbers));
    if let Some(time) = time {
        // One column keeps time; the others that could are kept beside.
        let others = listed.iter_mut().enumerate().filter(|(i, c)| *i != time && c.guess.role == Role::Time);
        others
            .filter(|(_, c)| c.content == Content::Numbers)
            .for_each(|(_, c)| c.guess.role = Role::Auxiliary);
    }
    if listed.iter().any(|c| c.content == Content::Numbers) {
        return Ok(listed);
    }
    // Its reading says where it is refused.
    let refused = looked.iter().find(|(_, fields)| fields.is_refused).map(|(index, _)| *index);
    let refusal = refused.and_then(|index| source.read(&[index], &mut |_| ControlFlow::Continue(())).err());
    Err(refusal.unwrap_or_else(|| {
        IngestError::new(IngestErrorKind::NotNumeric, source.path(), "ingest.no_numbers")
            .hint("ingest.hint.recording_itself")
    }))
}

/// What the first fields of a column say that it holds.
fn content(fields: &FirstFields) -> Content {
    match fields {
        FirstFields { numbers: 0, texts: 0, .. } => Content::Nothing,
        _ if fields.is_refused || fields.texts > fields.numbers => {
            Content::Text(fields.first_text.clone().unwrap_or_default())
        }
        _ => Content::Numbers,
    }
}

/// The channels that are read: every column of numbers, by position, so that names may stand twice. With each, its
/// place in the list of columns. Only the first time column keeps time; without a time base, angle increments are
/// no rates and stay as recorded.
pub(super) fn channels(listed: &[Listed], timed: bool) -> (Vec<Channel>, Vec<usize>) {
    let mut time_seen = false;
    let (mut channels, mut places) = (Vec::new(), Vec::new());
    for (index, column) in listed.iter().enumerate().filter(|(_, c)| c.content == Content::Numbers) {
        let role = match column.guess.role {
            Role::Time if time_seen => Role::Auxiliary,
            Role::AngleIncrement if !timed => Role::Auxiliary,
            role => role,
        };
        time_seen |= role == Role::Time;
        channels.push(Channel {
            id: column.name.clone(),
            column: ColumnRef::Position(index + 1),
            role,
            unit: column.guess.unit.clone(),
            scale: 1.0,
        });
        places.push(index);
    }
    (channels, places)
}
