//! The layout of the records of a raw binary file, as its user states it: what the format `raw` reads by.
//!
//! The types are there whether or not the format is compiled in, so that a layout can be read and checked without it.

mod checksum;
mod number_type;

pub use checksum::{Checksum, Sum};
pub use number_type::{ByteOrder, Field, NumberType, Ticks};

use sagnac_core::units::Unit;
use std::path::PathBuf;
use std::sync::Arc;

/// Longest record, bytes: several records must fit into what is read at a time.
pub const MAX_RECORD_BYTES: usize = 1 << 18;

/// Most columns of a recording. Arrays that seem to have more are no recordings.
pub const MAX_COLUMNS: usize = 4096;

/// A layout file. It must have been read before a recording is opened by it.
#[derive(Debug, Clone, PartialEq)]
pub struct LayoutFile {
    /// The file.
    pub path: PathBuf,
    /// Its contents; `None` until it is read.
    pub layout: Option<Arc<Layout>>,
}

impl LayoutFile {
    /// A layout that is not yet read.
    pub fn at(path: PathBuf) -> LayoutFile {
        LayoutFile { path, layout: None }
    }
}

/// The layout of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Bytes before the first record.
    pub header_bytes: u64,
    /// Length of a record, bytes.
    pub record_bytes: usize,
    /// Bytes at the start of every record; empty: none.
    pub sync: Vec<u8>,
    /// Sample rate, Hz.
    pub sample_rate_hz: Option<f64>,
    /// Checksum of every record.
    pub checksum: Option<Checksum>,
    /// Columns, in the order of the file.
    pub columns: Vec<LayoutColumn>,
}

/// A column of a layout.
#[derive(Debug, Clone, PartialEq)]
pub struct LayoutColumn {
    /// Name.
    pub name: String,
    /// How the number is stored, as the layout names it.
    pub storage: &'static str,
    /// Unit.
    pub unit: Option<Unit>,
    /// Value at which stamps start again, s.
    pub rollover_s: Option<f64>,
    /// Where the number is and how it is decoded.
    pub field: Field,
}

impl Layout {
    /// Names of the columns.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|c| c.name.as_str())
    }
}
