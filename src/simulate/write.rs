//! A simulated recording as a file: text with commas, or Parquet.

use super::{Rows, SimulateError, Simulation};
use crate::effect::Column;
use crate::i18n::{Note, note};
use crate::output::{Doubles, OutputError, StagedFile};
use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Format of a recording that is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Text, a header and fields with commas between. Every number reads back as the same number.
    Csv,
    /// Parquet, columns of doubles.
    Parquet,
}

impl Format {
    /// By the ending of a file name.
    ///
    /// # Errors
    /// Another ending.
    pub fn of(path: &Path) -> Result<Format, SimulateError> {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("csv") => Ok(Format::Csv),
            Some("parquet") => Ok(Format::Parquet),
            _ => Err(note!("simulate.ending", path = path.display().to_string()).into()),
        }
    }
}

/// The recording that was written.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    /// Rows.
    pub rows: u64,
    /// Columns, in the order of the file.
    pub columns: Vec<&'static str>,
    /// Length of the grid, s.
    pub length_s: f64,
}

/// Why nothing was written.
#[derive(Debug)]
pub enum WriteError {
    /// The simulation.
    Simulate(SimulateError),
    /// The file.
    Output(OutputError),
}

impl WriteError {
    /// The reason.
    pub fn note(&self) -> Note {
        match self {
            WriteError::Simulate(e) => e.note().clone(),
            WriteError::Output(e) => e.note(),
        }
    }
}

impl From<SimulateError> for WriteError {
    fn from(e: SimulateError) -> Self {
        WriteError::Simulate(e)
    }
}

impl From<OutputError> for WriteError {
    fn from(e: OutputError) -> Self {
        WriteError::Output(e)
    }
}

/// Runs a simulation to its end and writes it; the file appears whole or not at all. `progress` gets samples done
/// and samples in all.
///
/// # Errors
/// [`WriteError`].
pub fn write(
    mut simulation: Simulation<'_>,
    staged: StagedFile,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Written, WriteError> {
    let format = Format::of(staged.target())?;
    let beside = simulation.columns();
    let columns: Vec<&'static str> =
        ["time_s", "rate_deg_h"].into_iter().chain(beside.iter().map(|c| c.name())).collect();
    let refused = |e: std::io::Error| WriteError::Output(staged.refused(e));
    let mut sink = Sink::begin(format, staged.file()?, &columns).map_err(refused)?;
    let (mut rows, samples) = (0, simulation.samples());
    let mut made = simulation.next_rows()?;
    while let Some(block) = made {
        // The next rows are made while these are written.
        let (next, written) = rayon::join(|| simulation.next_rows(), || sink.rows(&block, &beside));
        written.map_err(refused)?;
        rows += block.time_s.len() as u64;
        made = next?;
        progress(simulation.done(), samples);
    }
    sink.end().map_err(refused)?;
    let length_s = simulation.length_s();
    staged.publish()?;
    Ok(Written { rows, columns, length_s })
}

/// A file being written.
enum Sink {
    Csv(BufWriter<File>),
    Parquet(Box<Doubles<File>>),
}

impl Sink {
    fn begin(format: Format, mut file: File, columns: &[&str]) -> std::io::Result<Sink> {
        match format {
            Format::Csv => {
                writeln!(file, "{}", columns.join(","))?;
                Ok(Sink::Csv(BufWriter::with_capacity(1 << 20, file)))
            }
            Format::Parquet => Ok(Sink::Parquet(Box::new(Doubles::begin(file, columns)))),
        }
    }

    fn rows(&mut self, rows: &Rows, beside: &[Column]) -> std::io::Result<()> {
        let mut columns: Vec<&[f64]> = vec![&rows.time_s, &rows.rate_deg_h];
        columns.extend(beside.iter().map(|c| rows.columns.get(c).map_or(&[][..], Vec::as_slice)));
        match self {
            Sink::Csv(out) => {
                let mut line = String::new();
                for i in 0..rows.time_s.len() {
                    line.clear();
                    for (place, column) in columns.iter().enumerate() {
                        if place > 0 {
                            line.push(',');
                        }
                        if let Some(value) = column.get(i) {
                            number(*value, &mut line);
                        }
                    }
                    line.push('\n');
                    out.write_all(line.as_bytes())?;
                }
                Ok(())
            }
            Sink::Parquet(writer) => writer.rows(&columns),
        }
    }

    fn end(self) -> std::io::Result<()> {
        match self {
            Sink::Csv(mut out) => out.flush(),
            Sink::Parquet(writer) => writer.end(),
        }
    }
}

/// The shortest text that reads as the same number, with an exponent where that is shorter.
fn number(value: f64, out: &mut String) {
    let size = value.abs();
    let _ = if size != 0.0 && !(1e-4..1e15).contains(&size) {
        write!(out, "{value:e}")
    } else {
        write!(out, "{value}")
    };
}
