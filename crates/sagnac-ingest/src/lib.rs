//! Recordings of gyroscopes as laboratories have them: file formats, columns and their roles, the clock, faults.
//!
//! A [`Format`] recognises a file by its first bytes and opens it as a [`Table`]; [`FORMATS`] lists every format that is
//! compiled in, each behind a cargo feature of its name. [`open`] returns a [`Source`]: the columns of a recording and a
//! way to read chosen columns block by block, in bounded memory. [`stream`] computes the time of every sample and passes
//! the samples on in the units of the analysis.
//!
//! ```
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
//! ```

// Formats share helpers; where only some formats are compiled in, some helpers have no user.
#![cfg_attr(
    not(all(
        feature = "bag",
        feature = "hdf5",
        feature = "matlab",
        feature = "mcap",
        feature = "numpy",
        feature = "parquet",
        feature = "raw",
        feature = "tdms",
        feature = "text"
    )),
    allow(dead_code)
)]

mod affine;
mod angle_differences;
#[cfg(any(feature = "matlab", feature = "numpy", feature = "raw"))]
mod binary;
mod block;
pub mod byte_stream;
pub mod clock;
mod column;
pub mod column_inference;
#[cfg(any(feature = "bag", feature = "hdf5", feature = "mcap", feature = "parquet", feature = "tdms"))]
mod decode_pipeline;
#[cfg(test)]
mod english;
mod error;
pub mod faults;
mod field_faults;
mod file_identity;
mod format;
mod format_detection;
mod formats;
mod guarded;
mod in_memory;
pub mod layout;
mod metadata;
pub mod multi_file;
mod options;
#[cfg(any(feature = "bag", feature = "hdf5", feature = "mcap", feature = "tdms"))]
mod part_selection;
pub mod pattern;
mod pauses;
mod plan;
mod requested_columns;
mod row_clock;
mod source;
mod stream;
mod system;
pub mod value_checks;

pub use block::{Block, FieldFault, FieldFaultKind, FileFacts};
pub use byte_stream::Packing;
pub use column::Column;
pub use error::{IngestError, IngestErrorKind};
pub use format::{Candidate, Format, OnBlock, Opened, Table};
pub use formats::FORMATS;
pub use guarded::decoder_is_running;
pub use options::{Encoding, ReadOptions, StampOptions, StampWriting, TextOptions};
pub use pauses::Pauses;
pub use plan::{Plan, TimeBaseSpec, prepare};
pub use source::{PartFacts, Source, open, open_with};
pub use stream::{ChannelFacts, FileReport, StreamReport, locate, stream, stream_path};
pub use system::io_reason;

/// Longest piece of the start of a file that is looked at, bytes.
const HEAD: usize = 256 << 10;

#[cfg(all(test, feature = "text"))]
mod tests;
