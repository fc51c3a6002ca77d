//! Sample lists of seismology (SLIST): a header line and then samples of one channel, several in a line.

use super::loaded::{self, About, LoadedColumn};
use crate::error::{IngestError, IngestErrorKind};
use crate::metadata::number_with_unit;
use crate::{Candidate, Format, Opened};
use sagnac_core::message::note;
use sagnac_core::units::Unit;

/// A sample list.
pub(super) struct SampleList;

/// True for the first bytes of a sample list.
pub(super) fn is_sample_list(head: &[u8]) -> bool {
    let line = head.split(|c| *c == b'\n').next().unwrap_or_default();
    line.starts_with(b"TIMESERIES ") && line.windows(5).any(|w| w == b"SLIST")
}

impl Format for SampleList {
    fn id(&self) -> &'static str {
        "slist"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        is_sample_list(&file.head)
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        let text = loaded::text(file)?;
        let mut lines = (1u64..).zip(text.lines());
        let header = lines.next().map_or("", |(_, l)| l);
        let entries: Vec<&str> = header.trim_start_matches("TIMESERIES ").split(',').map(str::trim).collect();
        let channel = entries.first().copied().unwrap_or_default();
        let rate_hz = entries.iter().find_map(|e| e.strip_suffix(" sps")?.trim().parse::<f64>().ok());
        let stated = entries.iter().find_map(|e| e.strip_suffix(" samples")?.trim().parse::<usize>().ok());
        let unit = entries.last().map(|u| u.to_lowercase()).filter(|u| Unit::parse(u).is_ok());
        let mut values = Vec::new();
        for (number, line) in lines {
            if line.starts_with("TIMESERIES ") {
                return Err(IngestError::new(
                    IngestErrorKind::UnknownFormat,
                    &file.path,
                    "ingest.slist.several",
                )
                .at(number, None)
                .hint("ingest.slist.hint_several"));
            }
            for word in line.split_whitespace() {
                let value = number_with_unit(word).filter(|(_, unit)| unit.is_none()).map(|(v, _)| v);
                values.push(value.unwrap_or(f64::NAN));
            }
        }
        let mut notes = vec![note!("ingest.slist.read", count = values.len())];
        if let Some(stated) = stated.filter(|s| *s != values.len()) {
            notes.push(note!("ingest.slist.other_count", stated, count = values.len()));
        }
        let metadata = entries
            .iter()
            .filter(|e| e.contains('T') && e.contains(':'))
            .map(|e| ("start".to_owned(), (*e).to_owned()))
            .collect();
        let column = LoadedColumn::new(channel, unit.as_deref(), values);
        loaded::opened(file, vec![column], About { notes, metadata, sample_rate_hz: rate_hz })
    }
}
