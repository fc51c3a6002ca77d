//! Columns of a second file beside those of a recording: the log of a chamber or of a table, written by another program
//! with another clock. The second file is interpolated at the stamps of the recording, never the other way round: no
//! output of a gyro is interpolated.

use crate::beside_columns::{Beside, MAX_STEPS_APART, TieUncertainty, Track};
use crate::byte_stream::digest_of_all;
use crate::estimated_tie::{EstimatedTie, estimate};
use crate::multi_file::{self, PartSpec};
use crate::stamp_column::Stamps;
use crate::turns::{TURN_ARCSEC, unwrap_turns};
use crate::{Column, IngestError, IngestErrorKind, ReadOptions, SecondSource, Source};
use sagnac_core::message::{Arg, Note, note};
use sagnac_core::recording::Role;
use sagnac_core::units::Unit;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

/// Most values that are kept of a second file.
const MAX_VALUES: usize = 64 << 20;

/// A recording with the columns of second files beside its own.
///
/// # Errors
/// A file that cannot be read, holds no time or no numbers beside it, or whose clock cannot be tied to that of the recording.
pub fn beside(source: Source, files: &[SecondSource]) -> Result<Source, IngestError> {
    if files.is_empty() {
        return Ok(source);
    }
    let without_time = |path: &Path| {
        let note = note!("ingest.beside.no_time");
        IngestError::new(IngestErrorKind::TimeBase, path, note).hint("ingest.beside.hint_time")
    };
    let stamps = stamps_of(&source).ok_or_else(|| without_time(source.path()))?;
    let begins_s = first_stamp(&source, &stamps)?;
    let mut added = Added { columns: Vec::new(), notes: Vec::new() };
    let mut tracks = Vec::new();
    for file in files {
        let second = open(file)?;
        let its = stamps_of(&second).ok_or_else(|| without_time(&file.path))?;
        let tied = tie(&source, &stamps, &second, &its, file)?;
        let wanted = added.take(&source, &second, its.column)?;
        let track = read(&second, &its, &wanted, &tied)?;
        let ends = track.at_s.first().zip(track.at_s.last());
        if ends.is_none_or(|(_, last)| begins_s.is_some_and(|begins| *last < begins)) {
            return Err(apart(&file.path, ends.map(|(a, b)| (*a, *b)), begins_s.unwrap_or(f64::NAN)));
        }
        added.say(&second, file, &wanted, tied.by)?;
        tracks.push(track);
    }
    let own = source.columns().len();
    Ok(source.with_beside(added.columns, added.notes, Beside { own, stamps, files: tracks }))
}

/// Opens a second file with those that continue it.
fn open(file: &SecondSource) -> Result<Source, IngestError> {
    if file.more.is_empty() {
        return crate::open(&file.path);
    }
    let parts: Vec<PartSpec> =
        file.files().map(|path| PartSpec { path: path.clone(), ..PartSpec::default() }).collect();
    multi_file::open(&file.path, &parts, false, &ReadOptions::default())
}

/// The stamps of a file; `None` without a time column.
fn stamps_of(source: &Source) -> Option<Stamps> {
    Stamps::of(source.columns(), source.time_column()?)
}

/// What second files add to the description of a recording.
struct Added {
    columns: Vec<Column>,
    notes: Vec<Note>,
}

impl Added {
    /// The columns that are taken from a file, by their positions in it: numbers but for its time, its counter and outputs of a gyro.
    fn take(&mut self, source: &Source, second: &Source, time: usize) -> Result<Vec<usize>, IngestError> {
        let stem = second.path().file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        // The number of a part is none of the name of the whole.
        let stem = if second.files().len() > 1 {
            stem.trim_end_matches(|c: char| c.is_ascii_digit() || c == '-')
        } else {
            &stem
        };
        let (mut wanted, mut gyros) = (Vec::new(), Vec::new());
        for (index, column) in second.columns().iter().enumerate().filter(|(i, c)| c.numeric && *i != time) {
            let inferred = column.inferred();
            match inferred.role {
                Role::Time | Role::Counter => continue,
                role if role.is_gyro() && inferred.unit_is_named => gyros.push(column.name.clone()),
                _ => {
                    let taken =
                        |name: &str| source.columns().iter().chain(&self.columns).any(|c| c.name == name);
                    let name = if taken(&column.name) {
                        format!("{stem}.{}", column.name)
                    } else {
                        column.name.clone()
                    };
                    if taken(&name) {
                        let note = note!("ingest.beside.name_twice", name);
                        return Err(IngestError::new(IngestErrorKind::Column, second.path(), note));
                    }
                    self.columns.push(Column { name, judged: Some(inferred), ..column.clone() });
                    wanted.push(index);
                }
            }
        }
        if !gyros.is_empty() {
            let file = second.path().display().to_string();
            self.notes.push(note!("ingest.beside.gyro_left", file, columns = gyros.join(", ")));
        }
        if wanted.is_empty() {
            return Err(IngestError::new(IngestErrorKind::Empty, second.path(), "ingest.beside.no_columns"));
        }
        Ok(wanted)
    }

    /// Says what was taken from a file and by which tie of the clocks.
    fn say(
        &mut self,
        second: &Source,
        file: &SecondSource,
        wanted: &[usize],
        tie: Note,
    ) -> Result<(), IngestError> {
        let names: Vec<&str> =
            wanted.iter().filter_map(|i| second.columns().get(*i)).map(|c| c.name.as_str()).collect();
        self.notes.push(note!(
            "ingest.beside.read",
            file = second.path().display().to_string(),
            columns = names.join(", "),
            sha256 = digest_of_all(&file.files().collect::<Vec<_>>())?,
            tie
        ));
        Ok(())
    }
}

/// How the clock of a second file is tied to that of the recording.
struct Tied {
    /// Time that is added to its stamps, s.
    shift_s: f64,
    rate: f64,
    uncertainty: TieUncertainty,
    /// By what.
    by: Note,
}

/// Ties the clock of a second file to that of the recording.
fn tie(
    source: &Source,
    stamps: &Stamps,
    second: &Source,
    its: &Stamps,
    file: &SecondSource,
) -> Result<Tied, IngestError> {
    let dates = its.epoch_s.zip(stamps.epoch_s).map(|(its, own)| its - own);
    if file.estimate {
        let EstimatedTie { shift_s, about_s, tie, by } = estimate(source, stamps, second, its, dates)?;
        let by = note!(
            "ingest.beside.by_estimate",
            by,
            offset_s = Arg::decimals(shift_s - dates.unwrap_or(0.0), 4),
            offset_sd_s = Arg::figures(tie.offset_sd_s, 2),
            rate_ppm = Arg::figures(tie.rate * 1e6, 3),
            rate_sd_ppm = Arg::figures(tie.rate_sd * 1e6, 2)
        );
        let uncertainty = TieUncertainty { offset_s: tie.offset_sd_s, rate: tie.rate_sd, about_s };
        return Ok(Tied { shift_s, rate: tie.rate, uncertainty, by });
    }
    let uncertainty = TieUncertainty { offset_s: file.offset_uncertainty_s, ..TieUncertainty::default() };
    let stated = |shift_s: f64, by: Note| Tied { shift_s, rate: file.rate, uncertainty, by };
    let offset = |s: f64| note!("ingest.beside.by_offset", offset_s = Arg::Stated(s));
    match (dates, file.offset_s) {
        (Some(between), Some(s)) => Ok(stated(between + s, offset(s))),
        (Some(between), None) => Ok(stated(between, note!("ingest.beside.by_dates"))),
        (None, Some(s)) => Ok(stated(s, offset(s))),
        (None, None) => {
            let word = |of: &Stamps| {
                if of.epoch_s.is_some() {
                    note!("ingest.beside.dated")
                } else {
                    note!("ingest.beside.undated")
                }
            };
            let note = note!(
                "ingest.beside.no_tie",
                recording = source.path().display().to_string(),
                recording_clock = word(stamps),
                file_clock = word(its)
            );
            Err(IngestError::new(IngestErrorKind::TimeBase, second.path(), note)
                .hint("ingest.beside.hint_offset"))
        }
    }
}

fn apart(path: &Path, ends: Option<(f64, f64)>, begins_s: f64) -> IngestError {
    let (first, last) = ends.unwrap_or((f64::NAN, f64::NAN));
    let note = note!(
        "ingest.beside.apart",
        first_s = Arg::decimals(first, 3),
        last_s = Arg::decimals(last, 3),
        begins_s = Arg::decimals(begins_s, 3)
    );
    IngestError::new(IngestErrorKind::TimeBase, path, note).hint("ingest.beside.hint_offset")
}

/// The first stamp of a recording, s.
fn first_stamp(source: &Source, stamps: &Stamps) -> Result<Option<f64>, IngestError> {
    let mut first = None;
    source.read(&[stamps.column], &mut |block| {
        first = block.columns.first().and_then(|c| c.iter().copied().find(|s| s.is_finite()));
        if first.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    Ok(first.map(|s| s * stamps.unit_s))
}

/// Reads the columns of a second file, on the clock of the recording; rows whose stamps do not increase are left out.
fn read(second: &Source, its: &Stamps, wanted: &[usize], tied: &Tied) -> Result<Track, IngestError> {
    let mut columns = vec![its.column];
    columns.extend_from_slice(wanted);
    let mut unwrapper = its.unwrapper();
    let (mut at_s, mut kept) = (Vec::<f64>::new(), vec![Vec::<f64>::new(); wanted.len()]);
    let (mut begins, mut too_large) = (None, false);
    second.read(&columns, &mut |block| {
        let Some((stamps, values)) = block.columns.split_first_mut() else { return ControlFlow::Break(()) };
        its.seconds(stamps, &mut unwrapper);
        for (row, stamp) in stamps.iter().copied().enumerate().filter(|(_, s)| s.is_finite()) {
            let begins = *begins.get_or_insert(stamp);
            let at = begins + (stamp - begins) * (1.0 + tied.rate) + tied.shift_s;
            if at_s.last().is_none_or(|last| at > *last) {
                at_s.push(at);
                let of = |column: &Vec<f64>| column.get(row).copied().unwrap_or(f64::NAN);
                kept.iter_mut().zip(values.iter()).for_each(|(to, column)| to.push(of(column)));
            }
        }
        too_large = at_s.len().saturating_mul(columns.len()) > MAX_VALUES;
        if too_large { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    if too_large {
        let note = note!("ingest.beside.too_large", values = MAX_VALUES);
        return Err(IngestError::new(IngestErrorKind::Bomb, second.path(), note));
    }
    let mut steps: Vec<f64> =
        at_s.iter().zip(at_s.get(1..).unwrap_or_default()).map(|(a, b)| b - a).collect();
    let mut longest_s = f64::INFINITY;
    if !steps.is_empty() {
        let middle = steps.len() / 2;
        longest_s = MAX_STEPS_APART * *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    }
    // Between 359 and 1 deg lies 0, not 180.
    for (index, angles) in wanted.iter().zip(&mut kept) {
        if let Some(turn) = second.columns().get(*index).and_then(turn_of) {
            unwrap_turns(angles, turn);
        }
    }
    let (file, uncertainty) = (second.path().to_owned(), tied.uncertainty);
    Ok(Track { file, uncertainty, at_s, longest_s, values: Arc::new(kept) })
}

/// A turn in the unit of a column that holds the angle of a table; `None` for other columns.
fn turn_of(column: &Column) -> Option<f64> {
    let inferred = column.inferred();
    let arcsec = inferred.unit.factor_to(&Unit::parse("arcsec").ok()?).ok()? * inferred.scale;
    (inferred.role == Role::TableAngle && arcsec > 0.0).then_some(TURN_ARCSEC / arcsec)
}

#[cfg(test)]
#[path = "second_source_tests.rs"]
mod tests;
