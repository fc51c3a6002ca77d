//! A recording as a program holds it: files on disk, or columns in memory.

use super::Error;
use crate::acceptance::inspect::inspect_source;
use crate::config::manifest::Manifest;
use crate::i18n::{Lang, note};
use crate::ingest::lot::stated_serial;
use crate::ingest::{Column, MemoryColumn, ReadOptions, Source, are_several, open_recording};
use crate::record::UnitUnderTest;
use crate::series::{Series, SeriesOptions, load_series_of};
use std::path::{Path, PathBuf};

/// Rows that are handed on at a time from memory.
const BLOCK_ROWS: usize = 8192;

/// A recording of a gyro, opened and not yet read.
///
/// ```
/// # fn main() -> Result<(), sagnac::Error> {
/// let time_s: Vec<f64> = (0..600).map(f64::from).collect();
/// let rate: Vec<f64> = time_s.iter().map(|t| 12.5 + 0.01 * (t * 0.7).sin()).collect();
/// let recording = sagnac::Recording::from_columns([("time_s", time_s), ("rate_deg_h", rate)])?;
/// assert_eq!(recording.columns().collect::<Vec<_>>(), ["time_s", "rate_deg_h"]);
/// # Ok(())
/// # }
/// ```
pub struct Recording {
    source: Source,
    manifest: Option<Manifest>,
    named: Vec<PathBuf>,
    options: ReadOptions,
    sample_rate_hz: Option<f64>,
}

impl Recording {
    /// Opens a file of any format that is read (see `docs/guide/recordings.md`), or a manifest.
    ///
    /// # Errors
    /// [`Error::is_recording`] when it cannot be opened or its format is not known, [`Error::is_argument`] for a pattern
    /// such as `unit7/*.csv`: [`Recording::open_with`] joins its files.
    pub fn open(path: impl AsRef<Path>) -> Result<Recording, Error> {
        let named = [path.as_ref().to_owned()];
        if are_several(&named) {
            let path = path.as_ref().display().to_string();
            return Err(Error::argument(note!("library.pattern", path)));
        }
        Recording::open_with(&named, &ReadOptions::default())
    }

    /// Opens several files, or those of patterns, as one recording, in sequence, with options for reading them.
    ///
    /// # Errors
    /// As [`Recording::open`].
    pub fn open_with(paths: &[PathBuf], options: &ReadOptions) -> Result<Recording, Error> {
        let opened = open_recording(paths, options)?;
        Ok(Recording {
            source: opened.source,
            manifest: opened.manifest,
            named: paths.to_vec(),
            options: options.clone(),
            sample_rate_hz: None,
        })
    }

    /// A recording in memory: columns of equal length, each under a name that tells quantity and unit as in a file
    /// (`time_s`, `rate_deg_h`, `temp_degC`).
    ///
    /// # Errors
    /// [`Error::is_recording`] without rows, or when the lengths differ.
    pub fn from_columns<N: Into<String>>(
        columns: impl IntoIterator<Item = (N, Vec<f64>)>,
    ) -> Result<Recording, Error> {
        Recording::from_memory(columns.into_iter().map(|(n, values)| MemoryColumn::new(n, values)).collect())
    }

    /// A recording in memory that another library holds, which is read in blocks and not copied.
    ///
    /// # Errors
    /// As [`Recording::from_columns`].
    pub fn from_memory(columns: Vec<MemoryColumn>) -> Result<Recording, Error> {
        Ok(Recording {
            source: Source::from_columns("memory", columns, BLOCK_ROWS)?,
            manifest: None,
            named: vec![],
            options: ReadOptions::default(),
            sample_rate_hz: None,
        })
    }

    /// States the sample rate, Hz, where no time column tells it.
    #[must_use]
    pub fn with_sample_rate(mut self, hz: f64) -> Recording {
        self.sample_rate_hz = Some(hz);
        self
    }

    /// Names of the columns, in the order of the file.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.source.columns().iter().map(|c| c.name.as_str())
    }

    /// The rate in a column, given by name or by position counted from 1. Its unit is read from the name of the column; it
    /// is converted to deg/h. Angle increments are divided by the sample interval.
    ///
    /// # Errors
    /// [`Error::is_recording`] when the column does not exist or cannot be read, [`Error::is_argument`] when its name does
    /// not tell a unit.
    pub fn rate(&self, column: &str) -> Result<Rate, Error> {
        self.rate_of(column, None)
    }

    /// The rate in a column whose name does not tell its unit (`"deg/s"`, `"rad/s"`, `"arcsec"` for increments).
    ///
    /// # Errors
    /// As [`Recording::rate`]; [`Error::is_argument`] for a unit that is not known.
    pub fn rate_in(&self, column: &str, unit: &str) -> Result<Rate, Error> {
        self.rate_of(column, Some(unit.to_owned()))
    }

    fn rate_of(&self, column: &str, unit: Option<String>) -> Result<Rate, Error> {
        let options = SeriesOptions { rate: Some(column.to_owned()), unit, ..self.series_options() };
        let series = load_series_of(&self.source, &options, &mut |_, _| {})?;
        let rounding_deg_h = series.faults.integrity.quantization_step_deg_h;
        Ok(Rate {
            name: column.to_owned(),
            sample_interval_s: series.sample_interval_s,
            deg_h: series.rate_deg_h,
            index: series.index,
            rounding_deg_h,
        })
    }

    /// The recording read into memory, by options whose files are those of this recording.
    pub(super) fn series(&self, options: &SeriesOptions) -> Result<Series, Error> {
        Ok(load_series_of(&self.source, options, &mut |_, _| {})?)
    }

    /// The decisions about reading so far.
    pub(super) fn series_options(&self) -> SeriesOptions {
        SeriesOptions {
            read: self.options.clone(),
            sample_rate_hz: self.sample_rate_hz,
            ..SeriesOptions::default()
        }
    }

    /// The recording as a procedure wants its files read: opened anew where that differs.
    pub(super) fn read_by(&self, options: &ReadOptions) -> Result<Option<Recording>, Error> {
        if self.named.is_empty() || *options == self.options {
            return Ok(None);
        }
        Recording::open_with(&self.named, options).map(Some)
    }

    /// Sample rate that was stated, Hz.
    pub(super) fn sample_rate_hz(&self) -> Option<f64> {
        self.sample_rate_hz
    }

    /// Serial number that the manifest states.
    pub(super) fn serial_of_manifest(&self) -> Option<&str> {
        self.manifest.as_ref()?.serial.as_deref()
    }

    /// Reads the recording and says in plain text what it holds: columns with quantity and unit, time base, faults, and which
    /// tests it can support.
    ///
    /// # Errors
    /// [`Error::is_recording`] when it cannot be read, or holds no column of numbers.
    pub fn inspect(&self, lang: Lang, progress: &mut dyn FnMut(u64, u64)) -> Result<String, Error> {
        Ok(inspect_source(&self.source, self.sample_rate_hz, lang, progress)?)
    }

    /// Columns with what their names and the format tell of them, in the order of the file.
    pub fn described_columns(&self) -> &[Column] {
        self.source.columns()
    }

    pub(super) fn source(&self) -> &Source {
        &self.source
    }

    /// The name of the recording in reports: its first path, `memory` without one.
    pub(super) fn shown(&self) -> String {
        self.source.path().display().to_string()
    }

    /// The unit with the serial number of the manifest, or else of the recording, where it has none; and whether it is that
    /// of the recording.
    pub(super) fn complete(&self, unit: &UnitUnderTest) -> Result<(UnitUnderTest, bool), Error> {
        let unit = self.with_manifest(unit)?;
        if unit.serial.as_deref().is_some_and(|s| !s.trim().is_empty()) {
            return Ok((unit, false));
        }
        let stated = stated_serial(&self.source);
        Ok((UnitUnderTest { serial: stated.clone().or(unit.serial), ..unit }, stated.is_some()))
    }

    fn with_manifest(&self, unit: &UnitUnderTest) -> Result<UnitUnderTest, Error> {
        let Some(manifest) = &self.manifest else { return Ok(unit.clone()) };
        match (unit.serial.as_deref(), manifest.serial.as_deref()) {
            (Some(given), Some(stated)) if given.trim() != stated.trim() => Err(Error::argument(note!(
                "manifest.serial",
                path = manifest.path.display().to_string(),
                stated,
                given
            ))),
            (given, stated) => {
                Ok(UnitUnderTest { serial: given.or(stated).map(str::to_owned), ..unit.clone() })
            }
        }
    }
}

/// The output of one gyro axis: samples in deg/h on a uniform grid, which may have gaps.
#[derive(Debug, Clone, PartialEq)]
pub struct Rate {
    pub(super) name: String,
    pub(super) sample_interval_s: f64,
    pub(super) deg_h: Vec<f64>,
    pub(super) index: Vec<u64>,
    pub(super) rounding_deg_h: Option<f64>,
}

impl Rate {
    /// Samples without a gap, deg/h, one every `sample_interval_s` seconds.
    ///
    /// # Errors
    /// [`Error::is_argument`] when the interval is not a positive number.
    pub fn from_samples(deg_h: Vec<f64>, sample_interval_s: f64) -> Result<Rate, Error> {
        let sample_interval_s = checked_interval(sample_interval_s)?;
        let index = (0..deg_h.len() as u64).collect();
        Ok(Rate { name: "rate".to_owned(), sample_interval_s, deg_h, index, rounding_deg_h: None })
    }

    /// The same under another name, as results show it.
    #[must_use]
    pub fn named(self, name: impl Into<String>) -> Rate {
        Rate { name: name.into(), ..self }
    }

    /// The samples, deg/h.
    pub fn deg_h(&self) -> &[f64] {
        &self.deg_h
    }

    /// Position of each sample on the uniform grid, 0 for the first; a gap skips positions.
    pub fn index(&self) -> &[u64] {
        &self.index
    }

    /// Mean sample interval over the stretches without a gap, s.
    pub fn sample_interval_s(&self) -> f64 {
        self.sample_interval_s
    }
}

/// A sample interval that can be used, s.
pub(super) fn checked_interval(sample_interval_s: f64) -> Result<f64, Error> {
    if sample_interval_s > 0.0 && sample_interval_s.is_finite() {
        return Ok(sample_interval_s);
    }
    let given = sample_interval_s.to_string();
    Err(Error::argument(note!("library.interval", given)))
}
