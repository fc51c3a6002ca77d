//! Delimited text as labs have it: any usual encoding, separator, decimal sign and header, with stamps of many kinds.
//!
//! [`dialect`] finds out how the file is written and says why; [`reader`] reads it so to the end.

mod column_kinds;
mod dialect;
mod encoding;
mod fields;
mod header;
mod metadata;
mod names;
mod number;
mod reader;
mod rows;
mod separator;
mod stamps;
mod truncation;
mod user_options;
mod void_rows;

use crate::byte_stream::Packing;
use crate::error::IngestError;
use crate::{Candidate, Format, Opened};

/// Delimited text, plain or packed.
pub(super) struct DelimitedText;

impl Format for DelimitedText {
    fn id(&self) -> &'static str {
        "csv"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        // A stated encoding is judged when the file is opened, with a diagnostic of its own.
        file.options.text.encoding.is_some() || encoding::find(&file.head, file.head_is_all).is_some()
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        let mut dialect = dialect::sniff(file)?;
        let cut_off = truncation::look(file)?;
        let void = if dialect.all_differ { void_rows::look(file, dialect.data_line)? } else { None };
        let bad_blocks = void.iter().map(void_rows::VoidRows::block).collect();
        dialect.lines.void = void.map(|v| v.line);
        let rows_estimate = (file.packing == Packing::Plain && dialect.mean_line > 0.0).then(|| {
            ((file.bytes as f64 - dialect.data_offset as f64).max(0.0) / dialect.mean_line).round() as u64
        });
        let table = reader::Text {
            path: file.path.clone(),
            packing: file.packing,
            encoding: dialect.encoding,
            lines: dialect.lines,
            data_offset: dialect.data_offset,
            data_line: dialect.data_line,
        };
        Ok(Opened {
            labels: dialect.labels,
            bad_blocks,
            columns: dialect.columns,
            rows_estimate,
            cut_off,
            notes: dialect.notes,
            metadata: dialect.metadata,
            stated_sample_rate_hz: None,
            table: Box::new(table),
        })
    }
}

#[cfg(test)]
mod cases_tests;
