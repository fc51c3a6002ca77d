//! Messages of one topic as rows.

use super::container::{Container, Event};
use super::message::{Encoding, Layout};
use crate::decode_pipeline::{Blocks, run_pipeline};
use crate::error::IngestError;
use crate::{Block, FieldFault, FieldFaultKind, FileFacts, OnBlock, Table};
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::path::PathBuf;

/// Rows in a block.
const ROWS: usize = 1 << 15;

/// Source of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// Stamp of the header, s after a full second.
    Stamp { epoch_s: i64 },
    /// When the message was logged, s after a full second.
    Logged { epoch_s: i64 },
    /// A number of the message.
    Number(usize),
}

/// The chosen topic of a file.
pub(super) struct TopicTable {
    pub path: PathBuf,
    pub bytes: u64,
    pub container: &'static dyn Container,
    pub ids: BTreeSet<u32>,
    pub layout: &'static Layout,
    pub encoding: Encoding,
    pub origins: Vec<Origin>,
    /// Places of chunks without messages of the topic.
    pub skip: BTreeSet<u64>,
}

/// Nanoseconds from 1970 as seconds after a full second.
fn logged_s(log_ns: u64, epoch_s: i64) -> f64 {
    let (seconds, rest) = (log_ns / 1_000_000_000, log_ns % 1_000_000_000);
    (i128::from(seconds) - i128::from(epoch_s)) as f64 + rest as f64 / 1e9
}

impl Table for TopicTable {
    fn read(&self, wanted: &[usize], on_block: &mut OnBlock<'_>) -> Result<Option<FileFacts>, IngestError> {
        run_pipeline(&self.path, wanted.len(), on_block, |blocks| self.decode(wanted, blocks))
    }
}

/// A block that is being filled.
struct Filling {
    block: Block,
    rows: usize,
    /// Rows whose message ended early.
    bad: BTreeSet<u64>,
}

impl TopicTable {
    fn decode(&self, wanted: &[usize], blocks: &mut Blocks) -> Result<(), IngestError> {
        let origins: Vec<Origin> = wanted.iter().filter_map(|&w| self.origins.get(w).copied()).collect();
        let mut filling = Filling { block: blocks.empty(), rows: 0, bad: BTreeSet::new() };
        self.container.scan(&self.path, self.bytes, &self.skip, &mut |event| {
            let Event::Message { id, log_ns, data, at } = event else { return ControlFlow::Continue(()) };
            if !self.ids.contains(&id) {
                return ControlFlow::Continue(());
            }
            self.row(&origins, log_ns, data, &mut filling);
            if filling.rows < ROWS {
                return ControlFlow::Continue(());
            }
            filling.block.bytes_done = at;
            let block = std::mem::take(&mut filling.block);
            let more = blocks.pass_without(block, &filling.bad);
            filling = Filling { block: blocks.empty(), rows: 0, bad: BTreeSet::new() };
            if more { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        })?;
        filling.block.bytes_done = self.bytes;
        // Nobody waits for more at the end of the file.
        let _ = blocks.pass_without(filling.block, &filling.bad);
        Ok(())
    }

    /// Adds a message as a row.
    fn row(&self, origins: &[Origin], log_ns: u64, data: &[u8], filling: &mut Filling) {
        let message = self.layout.read(data, self.encoding);
        let row = filling.block.first_row + filling.rows as u64;
        for (slot, origin) in origins.iter().enumerate() {
            let value = match (origin, &message) {
                (Origin::Logged { epoch_s }, _) => logged_s(log_ns, *epoch_s),
                (_, None) => {
                    filling.bad.insert(row);
                    let text = || format!("message of {} bytes", data.len());
                    let kind = FieldFaultKind::Unparsable;
                    let fault = || FieldFault { slot, row, line: 0, character: 0, kind, text: text() };
                    filling.block.fault(fault, slot, kind);
                    f64::NAN
                }
                (Origin::Stamp { epoch_s }, Some(m)) => m.stamp.map_or(f64::NAN, |(s, ns)| {
                    (i128::from(s) - i128::from(*epoch_s)) as f64 + f64::from(ns) / 1e9
                }),
                (Origin::Number(i), Some(m)) => m.numbers.get(*i).copied().unwrap_or(f64::NAN),
            };
            if let Some(column) = filling.block.columns.get_mut(slot) {
                column.push(value);
            }
        }
        filling.rows += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nanoseconds_are_kept_after_the_full_second() {
        assert_eq!(logged_s(1_767_225_600_000_000_007, 1_767_225_600), 7e-9);
        assert_eq!(logged_s(1_767_225_599_500_000_000, 1_767_225_600), -0.5);
    }
}
