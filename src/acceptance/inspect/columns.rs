//! The columns of a file: which hold numbers, and what each is taken for.

use crate::ingest::{FieldFaultKind, IngestError, IngestErrorKind, Source};
use crate::recording::column_inference::InferredColumn;
use crate::recording::{Channel, ColumnRef, Role};
use crate::units::Unit;
use std::ops::ControlFlow;

/// Rows that are looked at before a column is judged.
const PROBED_ROWS: u64 = 1000;

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
    let mut refusal = None;
    let mut listed = Vec::new();
    for (index, column) in source.columns().iter().enumerate() {
        let content = if column.numeric {
            match look(source, index) {
                Ok(content) => content,
                Err(e) if e.kind() == IngestErrorKind::NotNumeric => {
                    let text = e.text().unwrap_or_default().to_owned();
                    refusal.get_or_insert(e);
                    Content::Text(text)
                }
                Err(e) => return Err(e),
            }
        } else {
            Content::Text(column.storage.clone())
        };
        let guess = column.inferred();
        listed.push(Listed { name: column.name.clone(), content, guess });
    }
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
    Err(refusal.unwrap_or_else(|| {
        IngestError::new(IngestErrorKind::NotNumeric, source.path(), "ingest.no_numbers")
            .hint("ingest.hint.recording_itself")
    }))
}

/// Reads one column until it is clear what it holds.
fn look(source: &Source, index: usize) -> Result<Content, IngestError> {
    let (mut rows, mut numbers, mut texts, mut sample) = (0u64, 0u64, 0u64, None);
    source.read(&[index], &mut |block| {
        rows += block.rows() as u64;
        numbers += block.columns.iter().flatten().filter(|v| v.is_finite()).count() as u64;
        texts += block.unparsable.iter().sum::<u64>();
        if sample.is_none() {
            let first = block.faults.iter().find(|f| f.kind == FieldFaultKind::Unparsable);
            sample = first.map(|f| f.text.clone());
        }
        if rows >= PROBED_ROWS && numbers + texts > 0 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })?;
    Ok(match (numbers, texts) {
        (0, 0) => Content::Nothing,
        _ if texts > numbers => Content::Text(sample.unwrap_or_default()),
        _ => Content::Numbers,
    })
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
