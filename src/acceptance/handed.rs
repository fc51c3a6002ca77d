//! The evaluated channels of a recording as files for a program: Parquet, and each column as plain doubles.

use super::reading;
use super::test_kind::{Progress, Reading, Run};
use crate::output::Doubles;
use crate::recording::window::Windowed;
use crate::recording::{Channel, Role, SampleBlock, Sink};
use serde::Serialize;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Name of the Parquet file.
const PARQUET_FILE: &str = "channels.parquet";

/// Name of the column of times; a channel of that name moves it.
const TIME_COLUMN: &str = "time_s";

/// Rows that are collected before they become a group of the Parquet file.
const GROUP_ROWS: usize = 1 << 17;

/// Capacity of the buffer of a column, bytes.
const BUFFER_BYTES: usize = 1 << 18;

/// A column that was handed over.
#[derive(Debug, Clone, Serialize)]
pub(super) struct HandedColumn {
    /// Name in the Parquet file: the id of the channel.
    id: String,
    /// What it measures.
    role: Role,
    /// Unit of the values.
    unit: String,
    /// File with its values: doubles of 8 bytes, the lowest byte first.
    file: PathBuf,
}

/// What was handed over.
#[derive(Debug, Clone, Serialize)]
pub(super) struct HandedFiles {
    /// The Parquet file.
    parquet: PathBuf,
    /// Number of rows.
    rows: u64,
    /// Columns in the order of the file; the first is the time since the start of the recording.
    columns: Vec<HandedColumn>,
}

/// A folder that is being filled.
pub(super) struct Handing {
    slots: Vec<usize>,
    files: HandedFiles,
    start_s: f64,
    interval_s: f64,
    raw: Vec<BufWriter<File>>,
    parquet: Doubles<File>,
    waiting: Vec<Vec<f64>>,
    refused: Option<io::Error>,
}

impl Handing {
    /// Begins the files of channels in a folder; no ids stand for all channels that measure something.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn begin(folder: &Path, ids: &[String], reading: &Reading<'_>) -> io::Result<Handing> {
        let measures = |c: &Channel| !matches!(c.role, Role::Time | Role::Counter);
        let asked = |c: &Channel| if ids.is_empty() { measures(c) } else { ids.contains(&c.id) };
        let channels: Vec<(usize, &Channel)> =
            reading.channels.iter().enumerate().filter(|(_, c)| asked(c)).collect();
        let mut time = TIME_COLUMN.to_owned();
        while channels.iter().any(|(_, c)| c.id == time) {
            time.push('_');
        }
        let own = channels.iter().map(|(_, c)| (c.id.clone(), c.role, unit(c)));
        let columns: Vec<HandedColumn> = std::iter::once((time, Role::Time, "s".to_owned()))
            .chain(own)
            .enumerate()
            .map(|(place, (id, role, unit))| {
                let file = folder.join(format!("{place}.f64"));
                HandedColumn { id, role, unit, file }
            })
            .collect();
        let raw = |column: &HandedColumn| {
            File::create(&column.file).map(|file| BufWriter::with_capacity(BUFFER_BYTES, file))
        };
        let parquet = folder.join(PARQUET_FILE);
        let names: Vec<&str> = columns.iter().map(|c| c.id.as_str()).collect();
        Ok(Handing {
            slots: channels.iter().map(|(slot, _)| *slot).collect(),
            start_s: reading.start_s,
            interval_s: reading.tau0_s,
            raw: columns.iter().map(raw).collect::<io::Result<_>>()?,
            parquet: Doubles::begin(File::create(&parquet)?, &names),
            waiting: vec![vec![]; columns.len()],
            files: HandedFiles { parquet, rows: 0, columns },
            refused: None,
        })
    }

    /// Ends the files.
    ///
    /// # Errors
    /// A file that could not be written.
    pub fn end(mut self) -> io::Result<HandedFiles> {
        if let Some(refused) = self.refused.take() {
            return Err(refused);
        }
        self.write_group()?;
        self.raw.iter_mut().try_for_each(Write::flush)?;
        self.parquet.end()?;
        Ok(self.files)
    }

    fn write_group(&mut self) -> io::Result<()> {
        let columns: Vec<&[f64]> = self.waiting.iter().map(Vec::as_slice).collect();
        self.parquet.rows(&columns)?;
        for (column, out) in self.waiting.iter_mut().zip(&mut self.raw) {
            for value in column.iter() {
                out.write_all(&value.to_le_bytes())?;
            }
            column.clear();
        }
        Ok(())
    }
}

impl Sink for Handing {
    fn push(&mut self, block: &SampleBlock<'_>) {
        if self.refused.is_some() {
            return;
        }
        let (start_s, interval_s) = (block.time_s - self.start_s, self.interval_s);
        let values = self.slots.iter().map(|slot| block.values.get(*slot).map_or(&[][..], Vec::as_slice));
        if let Some((times, columns)) = self.waiting.split_first_mut() {
            times.extend((0..block.len()).map(|i| start_s + i as f64 * interval_s));
            for (column, values) in columns.iter_mut().zip(values) {
                column.extend_from_slice(values);
            }
        }
        self.files.rows += block.len() as u64;
        if self.waiting.first().is_some_and(|times| times.len() >= GROUP_ROWS) {
            self.refused = self.write_group().err();
        }
    }
}

/// Folders that are filled by one reading.
struct Several<'h>(&'h mut [Handing]);

impl Sink for Several<'_> {
    fn push(&mut self, block: &SampleBlock<'_>) {
        self.0.iter_mut().for_each(|handing| handing.push(block));
    }
}

/// Fills folders with the evaluated part of a recording.
///
/// # Errors
/// Those of reading.
pub(super) fn fill(reading: &Reading<'_>, folders: &mut [Handing], progress: Progress<'_>) -> Run<()> {
    let window = reading::window(reading.procedure());
    let mut windowed = Windowed::new(Several(folders), window, reading.start_s, reading.tau0_s);
    reading::read_again(reading, &mut windowed, progress)
}

/// The unit of the values of a channel inside the program.
fn unit(channel: &Channel) -> String {
    let rate = channel.role.is_gyro().then_some(Role::Rate);
    let inside = rate.unwrap_or(channel.role).internal_unit();
    inside.unwrap_or(channel.unit.text()).to_owned()
}
