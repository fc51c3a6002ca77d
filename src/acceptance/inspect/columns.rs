//! The columns of a file: which hold numbers, and what each is taken for.

use crate::acceptance::column_choice::ColumnChoice;
use crate::i18n::{Note, note};
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
        self.content == Content::Numbers && self.guess.counts_of_a_gyro(&self.name)
    }
}

/// Puts what the user chose in the place of what was found.
///
/// # Errors
/// A column that is not there, a unit that is none.
pub(super) fn choose(
    listed: &mut [Listed],
    choice: &ColumnChoice,
    source: &Source,
) -> Result<(), IngestError> {
    let wrong = |note: Note| IngestError::new(IngestErrorKind::Column, source.path(), note);
    let unit = choice
        .unit
        .as_deref()
        .map(Unit::parse)
        .transpose()
        .map_err(|e| wrong(note!("cli.of_option", option = "--unit", what = e.note())))?;
    let place = |name: &str| {
        source.resolve(&name.parse().map_or_else(|_| ColumnRef::Name(name.to_owned()), ColumnRef::Position))
    };
    let gyros = [
        (&choice.rate, None),
        (&choice.angle, Some(Role::AccumulatedAngle)),
        (&choice.increment, Some(Role::AngleIncrement)),
    ];
    let named = gyros.iter().any(|(names, _)| !names.is_empty());
    if named {
        // What is not named is no gyro output.
        let others = listed.iter_mut().filter(|c| c.guess.role.is_gyro());
        others.for_each(|c| c.guess.role = Role::Auxiliary);
    }
    let mut chosen: Vec<(usize, Option<Role>)> = Vec::new();
    for (names, role) in gyros {
        for name in names {
            chosen.push((place(name)?, role));
        }
    }
    if !named && (unit.is_some() || choice.scale.is_some()) {
        let gyro = |c: &Listed| c.guess.role.is_gyro() || (choice.scale.is_some() && c.counts_of_a_gyro());
        chosen.extend(listed.iter().enumerate().filter(|(_, c)| gyro(c)).map(|(i, _)| (i, None)));
    }
    let angle = |unit: &Unit| Unit::parse("deg").is_ok_and(|a| a.same_dimension(unit));
    for (index, role) in chosen {
        let Some(column) = listed.get_mut(index) else { continue };
        if let Some(unit) = &unit {
            column.guess.unit = unit.clone();
            (column.guess.scale, column.guess.unit_is_named) = (1.0, true);
        }
        column.guess.scale = choice.scale.unwrap_or(column.guess.scale);
        let by_unit = if angle(&column.guess.unit) { Role::AngleIncrement } else { Role::Rate };
        column.guess.role = role.unwrap_or(by_unit);
    }
    let mut only = |name: &str, role: Role| -> Result<(), IngestError> {
        listed.iter_mut().filter(|c| c.guess.role == role).for_each(|c| c.guess.role = Role::Auxiliary);
        if name != "none"
            && let Some(column) = listed.get_mut(place(name)?)
        {
            column.guess.role = role;
            if role == Role::Time && !Unit::parse("s").is_ok_and(|s| s.same_dimension(&column.guess.unit)) {
                column.guess.unit = source
                    .time_unit()
                    .cloned()
                    .or_else(|| Unit::parse("s").ok())
                    .unwrap_or(column.guess.unit.clone());
            }
        }
        Ok(())
    };
    if let Some(name) = &choice.time {
        only(name, Role::Time)?;
    }
    if let Some(name) = &choice.counter {
        only(name, Role::Counter)?;
    }
    Ok(())
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
            scale: column.guess.scale,
        });
        places.push(index);
    }
    (channels, places)
}
