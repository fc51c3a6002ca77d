//! Stamps as their user says they are written.

use super::fields::{bare, words};
use super::separator::{Looks, looks};
use super::stamps::{self, Order, Shape};
use crate::options::{StampOptions, StampWriting};
use sagnac_core::recording::ColumnRef;

/// A field that is not written as stated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Contradiction {
    /// Name of the column.
    pub column: String,
    /// Which of the data lines looked at.
    pub row: usize,
    /// The field.
    pub text: String,
}

/// Columns that belong together: positions of the two fields, and the name of the column they make.
type Together = (usize, usize, String);

/// Stated kinds of stamps, by position.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Stated {
    /// Dates with clock times.
    pub dated: Vec<Together>,
    /// GPS weeks with seconds of week.
    pub weeks: Vec<Together>,
    /// Seconds of week alone.
    pub seconds: Option<usize>,
}

/// Puts what was stated in the place of what was found. A column that is not there is left to whoever asks for it.
///
/// # Errors
/// A column of which no field is written as stated.
pub(super) fn apply(
    names: &[String],
    cells: &[Vec<&[u8]>],
    options: &[StampOptions],
    shapes: &mut [Option<Shape>],
) -> Result<Stated, Contradiction> {
    let mut stated = Stated::default();
    for option in options {
        let Some(column) = position(names, &option.column) else { continue };
        let date = option.date_column.as_ref().and_then(|c| position(names, c));
        let week = option.week_column.as_ref().and_then(|c| position(names, c));
        let order = match option.writing {
            Some(StampWriting::DayFirst) => Some(Order::DayFirst),
            Some(StampWriting::MonthFirst) => Some(Order::MonthFirst),
            Some(StampWriting::Iso8601) => Some(Order::YearFirst),
            _ => None,
        };
        let shape = match (option.writing, order) {
            _ if date.is_some() => Some(Some(Shape::Clock)),
            (_, Some(order)) => Some(Some(Shape::DateTime(order))),
            (Some(StampWriting::Clock), _) => Some(Some(Shape::Clock)),
            (Some(StampWriting::Number | StampWriting::GpsWeekSeconds), _) => Some(None),
            _ => None,
        };
        if let Some(shape) = shape {
            set(names, cells, shapes, column, shape)?;
        }
        let name = option.joined_name().unwrap_or_default();
        if let Some(first) = date {
            if let Some(order) = order {
                set(names, cells, shapes, first, Some(Shape::Date(order)))?;
            } else if !matches!(shapes.get(first), Some(Some(Shape::Date(_)))) {
                set(names, cells, shapes, first, Some(Shape::Date(Order::YearFirst)))?;
            }
            stated.dated.push((first, column, name));
        } else if let Some(first) = week {
            stated.weeks.push((first, column, name));
        } else if option.writing == Some(StampWriting::GpsWeekSeconds) {
            stated.seconds = Some(column);
        }
    }
    Ok(stated)
}

/// States what a column holds, unless no field looked at is written so.
fn set(
    names: &[String],
    cells: &[Vec<&[u8]>],
    shapes: &mut [Option<Shape>],
    position: usize,
    shape: Option<Shape>,
) -> Result<(), Contradiction> {
    let fits = |cell: &&[u8]| match shape {
        Some(shape) => stamps::parse(bare(cell), shape).is_some(),
        None => [b'.', b','].into_iter().any(|sign| looks(cell, sign) == Looks::Number),
    };
    let column = cells.get(position).map(Vec::as_slice).unwrap_or_default();
    let first = column.iter().position(|c| !bare(c).is_empty());
    if let Some(row) = first.filter(|_| !column.iter().any(fits)) {
        return Err(Contradiction {
            column: names.get(position).cloned().unwrap_or_default(),
            row,
            text: words(column.get(row).copied().unwrap_or_default()),
        });
    }
    if let Some(place) = shapes.get_mut(position) {
        *place = shape;
    }
    Ok(())
}

/// Which column of the file a reference names.
fn position(names: &[String], column: &ColumnRef) -> Option<usize> {
    match column {
        ColumnRef::Position(p) => p.checked_sub(1).filter(|i| *i < names.len()),
        ColumnRef::Name(name) => names.iter().position(|n| n == name),
    }
}
