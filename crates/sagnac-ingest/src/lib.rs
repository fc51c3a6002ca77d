//! Recordings of gyroscopes as laboratories have them: file formats, columns and their roles, the clock, faults.
//!
//! [`open`] finds the format of a file by its first bytes and returns a [`Source`]: the columns of the recording, what the
//! file says of itself, and a way to read chosen columns block by block in bounded memory. [`prepare`] finds columns,
//! units and the clock of named channels, and [`Plan::stream`] reads them once: stamps become places on a uniform grid,
//! numbers become the units of the analysis, and every fault is counted and listed. Nothing is repaired.
//!
//! ```
//! # #[cfg(feature = "text")]
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use std::ops::ControlFlow;
//!
//! let directory = tempfile::tempdir()?;
//! let path = directory.path().join("rest.csv");
//! std::fs::write(&path, "time_s,rate_dps\n0.00,0.011\n0.01,0.013\n0.02,0.012\n")?;
//!
//! let source = sagnac_ingest::open(&path)?;
//! assert_eq!(source.columns()[1].name, "rate_dps");
//!
//! let mut rates = Vec::new();
//! source.read(&[1], &mut |block| {
//!     rates.extend_from_slice(&block.columns[0]);
//!     ControlFlow::Continue(())
//! })?;
//! assert_eq!(rates, [0.011, 0.013, 0.012]);
//! # Ok(())
//! # }
//! # #[cfg(not(feature = "text"))]
//! # fn main() {}
//! ```
//!
//! # Formats
//!
//! Each is a module behind a cargo feature, and [`FORMATS`] lists those that are compiled in. A file of a format that is
//! left out is refused with the name of its feature.
//!
//! | feature | formats |
//! |---|---|
//! | `text` | delimited text in any usual dialect, sample lists (SLIST), `RAWIMU` logs of NovAtel |
//! | `ulog` | flight logs of PX4 |
//! | `json` | JSON lines, a list of JSON objects |
//! | `xlsx` | sheets of spreadsheets (`.xlsx`, `.xls`, `.ods`) |
//! | `parquet` | Apache Parquet |
//! | `numpy` | NumPy `.npy` and `.npz` |
//! | `matlab` | MAT files of version 4, 5 and 7 |
//! | `hdf5` | HDF5, NetCDF-4, MAT files of version 7.3 |
//! | `tdms` | TDMS of LabVIEW |
//! | `mcap`, `rosbag2`, `bag` | recordings of ROS 2 (MCAP and SQLite) and ROS 1 |
//! | `raw` | binary records by a [`layout`] |
//!
//! # Map
//!
//! | from a file to the analysis | where |
//! |---|---|
//! | the bytes, unpacked and hashed | [`byte_stream`] |
//! | which format reads them | `format_detection` |
//! | numbers in blocks of rows | [`Format`], [`Table`], `formats` |
//! | several files as one recording | [`multi_file`] |
//! | what a column is, by its name and unit | [`column_inference`] |
//! | what a column is by its first values and the header | `first_values`, `column_judgement`, `time_scale` |
//! | which rows are read | `selected_rows`, `cycle` |
//! | columns of a second file with a clock of its own | `second_source`, `beside_columns`, `estimated_tie`, `turns` |
//! | the interval of the samples, gaps, roll-overs | [`clock`] |
//! | rows placed on the grid of the recording | [`Plan`], `row_clock` |
//! | outliers, stuck and repeated values | [`value_checks`] |
//! | faults with their place | [`faults`] |
//!
//! Decoders may panic on damaged content; the panic is caught and becomes an error of the file. No panic hook is set:
//! see [`decoder_is_running`].

// Formats share helpers; where only some formats are compiled in, some helpers have no user.
#![cfg_attr(not(feature = "all"), allow(dead_code))]

mod angle_differences;
mod beside_columns;
#[cfg(any(feature = "matlab", feature = "numpy", feature = "raw"))]
mod binary;
mod block;
pub mod byte_stream;
pub mod clock;
mod column;
pub mod column_inference;
mod column_judgement;
mod cycle;
#[cfg(any(
    feature = "bag",
    feature = "hdf5",
    feature = "mcap",
    feature = "parquet",
    feature = "rosbag2",
    feature = "tdms"
))]
mod decode_pipeline;
#[cfg(test)]
mod english;
mod error;
mod estimated_tie;
pub mod faults;
mod field_faults;
mod file_identity;
mod first_look;
mod first_values;
mod format;
mod format_detection;
mod formats;
mod guarded;
mod in_memory;
pub mod layout;
mod metadata;
pub mod multi_file;
mod named_file;
mod options;
#[cfg(any(
    feature = "bag",
    feature = "hdf5",
    feature = "mcap",
    feature = "rosbag2",
    feature = "tdms",
    feature = "ulog"
))]
mod part_selection;
pub mod pattern;
mod pauses;
mod plan;
mod requested_columns;
mod row_clock;
mod second_source;
mod selected_rows;
mod similar_column;
mod source;
mod stamp_column;
mod stated_scales;
mod stream;
mod system;
mod time_scale;
mod turns;
pub mod value_checks;

pub use beside_columns::ClockUncertainty;
pub use block::{Block, FieldFault, FieldFaultKind, FileFacts};
pub use byte_stream::Packing;
pub use column::Column;
pub use cycle::{Labels, Sensors};
pub use error::{IngestError, IngestErrorKind};
pub use first_look::FirstFields;
pub use format::{BadBlock, Candidate, Format, OnBlock, Opened, Table};
pub use formats::FORMATS;
pub use guarded::decoder_is_running;
pub use in_memory::{MemoryColumn, MemoryValues};
pub use named_file::{FileFault, open_file, read_file, read_text};
pub use options::{Encoding, ReadOptions, RowMatch, SecondSource, StampOptions, StampWriting, TextOptions};
pub use pauses::Pauses;
pub use plan::{Plan, TimeBaseSpec, prepare};
pub use second_source::beside;
pub use source::{PartFacts, Source, open, open_with};
pub use stream::{ChannelFacts, FileReport, StreamReport, locate, stream, stream_path};
pub use system::io_reason;

/// Longest piece of the start of a file that is looked at, bytes.
const HEAD: usize = 256 << 10;

#[cfg(all(test, feature = "all"))]
mod log_layout_tests;
#[cfg(all(test, feature = "all"))]
mod reading_tests;
#[cfg(all(test, feature = "text"))]
mod tests;
