//! The list of faults: everything is counted elsewhere, the first of each kind are listed here.

use sagnac_core::message::Note;
use sagnac_core::recording::integrity::Fault;
use std::collections::BTreeMap;

/// At most this many faults of a kind are listed.
pub const MAX_LISTED_OF_A_KIND: usize = 100;

/// Entries looked through, from the last, for one that a fault continues: as many as channels can fail together.
const LOOK_BACK: usize = 16;

/// Faults by kind, in the order in which they were found. Faults in consecutive rows become one entry.
#[derive(Debug, Clone, Default)]
pub struct FaultLog {
    kinds: BTreeMap<&'static str, Vec<Fault>>,
}

impl FaultLog {
    /// Adds a fault of `count` rows from `row` on.
    pub fn push(
        &mut self,
        kind: &'static str,
        channel: Option<&str>,
        time_s: Option<f64>,
        row: u64,
        count: u64,
        note: impl FnOnce() -> Note,
    ) {
        let list = self.kinds.entry(kind).or_default();
        let continued = list
            .iter_mut()
            .rev()
            .take(LOOK_BACK)
            .find(|f| f.channel.as_deref() == channel && f.row + f.count == row);
        if let Some(fault) = continued {
            fault.count += count;
            return;
        }
        if list.len() < MAX_LISTED_OF_A_KIND {
            list.push(Fault {
                kind: kind.to_owned(),
                channel: channel.map(str::to_owned),
                time_s,
                file: None,
                row,
                count,
                seen: note(),
            });
        }
    }

    /// All listed faults, by row.
    pub fn into_list(self) -> Vec<Fault> {
        let mut all: Vec<Fault> = self.kinds.into_values().flatten().collect();
        all.sort_by_key(|f| f.row);
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sagnac_core::message::note;

    #[test]
    fn faults_in_consecutive_rows_are_one_entry_for_each_channel() {
        let mut log = FaultLog::default();
        for row in 5..10 {
            for channel in ["x", "y"] {
                log.push("non_finite", Some(channel), None, row, 1, || note!("fault_note.duplicate"));
            }
        }
        log.push("non_finite", Some("x"), None, 20, 1, || note!("fault_note.duplicate"));
        let list = log.into_list();
        assert_eq!(list.iter().map(|f| (f.row, f.count)).collect::<Vec<_>>(), [(5, 5), (5, 5), (20, 1)]);
    }

    #[test]
    fn the_list_is_bounded() {
        let mut log = FaultLog::default();
        for i in 0..1000 {
            log.push("gap", None, None, 2 * i + 1, 1, || note!("fault_note.duplicate"));
        }
        assert_eq!(log.into_list().len(), MAX_LISTED_OF_A_KIND);
    }
}
