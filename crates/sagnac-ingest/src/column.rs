//! A column of a file, and what its name and the format tell of it.

use crate::column_inference::{InferredColumn, infer};
use sagnac_core::message::Note;
use sagnac_core::recording::Role;

/// A column of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name in the header, or `column_1`, `column_2` ... where there is none.
    pub name: String,
    /// True when the format can give numbers for it. A text file says so of every column.
    pub numeric: bool,
    /// Type in the file, in the format's words, for example `DOUBLE`; `text` for text files.
    pub storage: String,
    /// Unit the format itself declares, for example `ms` for a Parquet time stamp.
    pub unit: Option<String>,
    /// Seconds from 1970 to the zero of the values, when the reader turned stamps with a date into seconds; the unit is
    /// `s` then.
    pub epoch_s: Option<f64>,
    /// Period after which the stamps start again, s: 86400 for clock time, 604800 for seconds of a week.
    pub rollover_s: Option<f64>,
}

impl Column {
    /// What the column may be: from what the reader knows of it, else from its name.
    pub fn inferred(&self) -> InferredColumn {
        let mut inferred = infer(&self.name, self.unit.as_deref());
        let dates = self.storage == DATES;
        if dates || ((self.epoch_s.is_some() || self.rollover_s.is_some()) && inferred.role != Role::Time) {
            inferred.role = if dates { Role::Auxiliary } else { Role::Time };
            inferred.unit_is_named = true;
            inferred.reason = Note::new("guess.stamps").with("name", self.name.as_str());
        }
        inferred
    }
}

/// Storage of a text column of dates without a time, which tells no sample from the next.
pub(crate) const DATES: &str = "dates";
