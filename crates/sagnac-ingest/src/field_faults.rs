//! Fields that are no numbers: counted, and the first of each kind located.

use super::row_clock::RowClock;
use super::{Block, FieldFaultKind};
use sagnac_core::message::{Note, note};

impl RowClock<'_> {
    /// Counts and lists the fields of a block that are no numbers.
    pub(super) fn field_faults(&mut self, block: &Block) {
        self.integrity.non_finite += block.non_finite.iter().sum::<u64>();
        self.integrity.unparsable += block.unparsable.iter().sum::<u64>();
        for fault in &block.faults {
            let row = usize::try_from(fault.row.saturating_sub(block.first_row)).unwrap_or(usize::MAX);
            let stamp = match self.plan.time {
                Some(t) => block.columns.get(t).and_then(|c| c.get(row)).map(|s| self.tracker.on_scale(*s)),
                None => Some((fault.row - 1) as f64 * self.plan.clock.interval_s),
            };
            let (kind, word) = match fault.kind {
                FieldFaultKind::NonFinite if fault.text.trim().parse().is_ok_and(f64::is_finite) => {
                    ("non_finite", "fault_note.too_large")
                }
                FieldFaultKind::NonFinite => ("non_finite", "fault_note.no_finite_number"),
                FieldFaultKind::Unparsable if repeats(&fault.text, self.plan.column_name(fault.slot)) => {
                    ("unparsable", "ingest.delimited.second_header")
                }
                FieldFaultKind::Unparsable => ("unparsable", "fault_note.no_number"),
            };
            let channel = self.plan.channels.get(fault.slot).map(|c| c.id.as_str());
            self.log.push(kind, channel, stamp.filter(|s| s.is_finite()), fault.row, 1, || {
                let place = if fault.line > 0 {
                    note!("fault_note.place", line = fault.line, character = fault.character)
                } else {
                    note!("fault_note.no_place")
                };
                note!(
                    "fault_note.field",
                    what = Note::new(word),
                    column = self.plan.column_name(fault.slot),
                    place,
                    text = format!("`{}`", fault.text)
                )
            });
        }
    }
}

/// True when a field holds the name of its column: another header, as where files were put together.
fn repeats(text: &str, column: &str) -> bool {
    text.trim().trim_matches('"').trim() == super::error::shorten(column)
}
