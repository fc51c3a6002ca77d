//! Selects the columns of a recording that are read: by the names of the contract first, else as names and units tell.

use super::options::{SeriesError, SeriesOptions};
use crate::config::role_words;
use crate::effect::Column;
use crate::i18n::{Note, note};
use crate::ingest::{IngestErrorKind, Source};
use crate::recording::{Channel, ColumnRef, Role};
use crate::units::{Affine, Unit};
use sagnac_core::series::ReadFrom;
use std::ops::ControlFlow;

/// The channels that are read, and what each is.
pub(super) struct SeriesChannels {
    pub channels: Vec<Channel>,
    /// Where the time is among them.
    pub time: Option<usize>,
    /// Where the rate is among them.
    pub rate: usize,
    /// The further columns.
    pub further: Vec<FurtherColumn>,
    pub read_from: Vec<ReadFrom>,
}

/// A column besides time and rate.
pub(super) struct FurtherColumn {
    pub column: Column,
    /// Its place among the channels.
    pub slot: usize,
    /// To the unit of the contract.
    pub conversion: Affine,
}

fn role(column: Column) -> Role {
    match column {
        Column::Other(_) => Role::Auxiliary,
        Column::Temperature => Role::Temperature,
        Column::TableRate => Role::TableRate,
        Column::TableAngle => Role::TableAngle,
        Column::OuterRate => Role::OuterRate,
        Column::Supply => Role::Supply,
    }
}

fn unit(column: Column) -> &'static str {
    match column {
        // As in its file: nothing is expected of it.
        Column::Other(_) => "",
        Column::Temperature => "degC",
        Column::TableRate | Column::OuterRate => "deg/s",
        Column::TableAngle => "deg",
        Column::Supply => "V",
    }
}

/// Selects the columns that are read.
pub(super) fn select_channels(
    source: &Source,
    options: &SeriesOptions,
) -> Result<SeriesChannels, SeriesError> {
    let mut chosen =
        SeriesChannels { channels: vec![], time: None, rate: 0, further: vec![], read_from: vec![] };
    if !options.channels.is_empty() {
        declared(source, &options.channels, &mut chosen)?;
        return Ok(chosen);
    }
    let named = |name: &str| source.columns().iter().position(|c| c.numeric && c.name == name);
    if let Some(i) = named("time_s").or_else(|| source.time_column()) {
        let guess = source.columns()[i].inferred();
        let unit = if guess.role == Role::Time { guess.unit } else { parse("s")? };
        chosen.time = Some(chosen.take("time_s", i, source, Role::Time, unit));
    }
    rate(source, options, &mut chosen)?;
    for column in Column::KNOWN {
        let fits = |i: &usize| {
            source.columns().get(*i).is_some_and(|c| {
                let guess = c.inferred();
                c.numeric && guess.role == role(column) && guess.unit_is_named
            })
        };
        let found = named(column.name())
            .or_else(|| (0..source.columns().len()).filter(fits).find(|i| !chosen.has(*i)));
        let Some(i) = found else { continue };
        let own = source.columns()[i].inferred().unit;
        // What the unit says of the column is no such quantity: it is left alone.
        let Ok(conversion) = own.affine_to(&parse(unit(column))?) else { continue };
        let slot = chosen.take(column.name(), i, source, Role::Auxiliary, own);
        chosen.further.push(FurtherColumn { column, slot, conversion });
    }
    others(source, &mut chosen);
    Ok(chosen)
}

/// Every further numeric column, as it stands in the file. Outputs of other gyros drive nothing: they feel what this one
/// feels. A second time says nothing.
fn others(source: &Source, chosen: &mut SeriesChannels) {
    for (i, column) in source.columns().iter().enumerate() {
        let guess = column.inferred();
        let is_driver = !matches!(guess.role, Role::Time | Role::Counter) && !guess.role.is_gyro();
        if !column.numeric || !is_driver || chosen.has(i) || !holds_numbers(source, i) {
            continue;
        }
        let column = Column::of_name(&column.name);
        if chosen.further.iter().any(|f| f.column == column) {
            continue;
        }
        let slot = chosen.take(column.name(), i, source, Role::Auxiliary, guess.unit);
        chosen.further.push(FurtherColumn { column, slot, conversion: Affine::IDENTITY });
    }
}

/// False for a column of words, such as a status: a text file does not say which of its columns are numbers, so its first
/// rows are read. Other errors are those of the reading that follows.
fn holds_numbers(source: &Source, index: usize) -> bool {
    let first_block = source.read(&[index], &mut |_| ControlFlow::Break(()));
    !first_block.is_err_and(|e| e.kind() == IngestErrorKind::NotNumeric)
}

/// The columns that a procedure declares: its stamps, its first gyro channel, and the first of each further quantity.
fn declared(source: &Source, channels: &[Channel], chosen: &mut SeriesChannels) -> Result<(), SeriesError> {
    let mut take = |name: &'static str, channel: &Channel, role: Role| {
        let column = match &channel.column {
            ColumnRef::Name(name) => name.clone(),
            ColumnRef::Position(i) => {
                source.columns().get(i - 1).map(|c| c.name.clone()).unwrap_or_else(|| i.to_string())
            }
        };
        chosen.read_from.push(read_from(name, column, channel.unit.text()));
        chosen.channels.push(Channel { id: name.to_owned(), role, ..channel.clone() });
        chosen.channels.len() - 1
    };
    let first = |wanted: &dyn Fn(Role) -> bool| channels.iter().find(|c| wanted(c.role));
    if let Some(time) = first(&|r| r == Role::Time) {
        chosen.time = Some(take("time_s", time, Role::Time));
    }
    let Some(rate) = first(&Role::is_gyro) else {
        let path = source.path().display().to_string();
        let names = channels.iter().map(|c| c.id.as_str()).collect::<Vec<_>>().join(", ");
        return Err(SeriesError::Unclear(note!("series.no_rate", path, columns = names)));
    };
    chosen.rate = take("rate_deg_h", rate, rate.role);
    for column in Column::KNOWN {
        let Some(channel) = first(&|r| r == role(column)) else { continue };
        let Ok(conversion) = channel.unit.affine_to(&parse(unit(column))?) else { continue };
        let slot = take(column.name(), channel, Role::Auxiliary);
        chosen.further.push(FurtherColumn { column, slot, conversion });
    }
    for channel in channels.iter().filter(|c| c.role == Role::Auxiliary) {
        let column = Column::of_name(&channel.id);
        if column.is_other() {
            let slot = take(column.name(), channel, Role::Auxiliary);
            chosen.further.push(FurtherColumn { column, slot, conversion: Affine::IDENTITY });
        }
    }
    Ok(())
}

fn parse(unit: &str) -> Result<Unit, SeriesError> {
    Unit::parse(unit).map_err(|e| SeriesError::Unclear(e.note()))
}

/// The column of the rate.
fn rate(source: &Source, options: &SeriesOptions, chosen: &mut SeriesChannels) -> Result<(), SeriesError> {
    let unclear = |key: &'static str, names: Vec<&str>| {
        let note = Note::new(key).with("path", source.path().display().to_string());
        SeriesError::Unclear(note.with("columns", names.join(", ")))
    };
    let columns = source.columns();
    let index = match &options.rate {
        Some(name) => {
            let column = name.parse().map_or_else(|_| ColumnRef::Name(name.clone()), ColumnRef::Position);
            source.resolve(&column)?
        }
        None => {
            let gyros: Vec<usize> = (0..columns.len())
                .filter(|i| columns.get(*i).is_some_and(|c| c.numeric && c.inferred().role.is_gyro()))
                .collect();
            let plain = columns.iter().position(|c| c.numeric && c.name == "rate_deg_h");
            match (plain, gyros.as_slice()) {
                (Some(i), _) => i,
                (None, [one]) => *one,
                (None, [first, ..]) if options.any_rate => *first,
                (None, []) => {
                    return Err(unclear("series.no_rate", columns.iter().map(|c| c.name.as_str()).collect()));
                }
                (None, several) => {
                    let names = several.iter().map(|i| columns[*i].name.as_str()).collect();
                    return Err(unclear("series.several_rates", names));
                }
            }
        }
    };
    let guess = columns[index].inferred();
    let unit = match &options.unit {
        Some(unit) => parse(unit)?,
        None if guess.role.is_gyro() && guess.unit_is_named => guess.unit,
        None if options.any_rate => parse("deg/h")?,
        None => return Err(unclear("series.no_unit", vec![columns[index].name.as_str()])),
    };
    let is_angle = parse("deg")?.same_dimension(&unit);
    let role = if is_angle { Role::AngleIncrement } else { Role::Rate };
    chosen.rate = chosen.take("rate_deg_h", index, source, role, unit);
    Ok(())
}

/// A column of the file for a quantity. Only of a thermometer it matters where it is: other columns drive the unit from anywhere.
fn read_from(name: &'static str, column: String, unit: &str) -> ReadFrom {
    let elsewhere = name == Column::Temperature.name() && role_words::is_elsewhere(&column);
    ReadFrom { name, column, unit: unit.to_owned(), elsewhere }
}

impl SeriesChannels {
    fn has(&self, index: usize) -> bool {
        self.channels.iter().any(|c| c.column == ColumnRef::Position(index + 1))
    }

    /// Adds a channel; gives its place.
    fn take(&mut self, name: &'static str, index: usize, source: &Source, role: Role, unit: Unit) -> usize {
        let column = source.columns().get(index).map(|c| c.name.clone()).unwrap_or_default();
        // What the header states of the size of a count holds in the unit it is stated in.
        let stated =
            source.columns().get(index).map(|c| c.inferred()).filter(|g| g.unit.text() == unit.text());
        let scale = stated.map_or(1.0, |g| g.scale);
        self.read_from.push(read_from(name, column, unit.text()));
        let column = ColumnRef::Position(index + 1);
        self.channels.push(Channel { id: name.to_owned(), column, role, unit, scale });
        self.channels.len() - 1
    }
}
