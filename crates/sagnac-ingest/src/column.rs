//! A column of a file, and what its name, its format and its first values tell of it.

use crate::column_inference::{InferredColumn, infer};
use sagnac_core::message::note;
use sagnac_core::recording::Role;

/// A column as the format describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name in the header, or `column_1`, `column_2` ... where there is none.
    pub name: String,
    /// True if the format can deliver numbers for the column. Always true for text files.
    pub numeric: bool,
    /// Storage type as the format names it, for example `DOUBLE`; `text` for text files.
    pub storage: String,
    /// Unit the format itself declares, for example `ms` for a Parquet time stamp.
    pub unit: Option<String>,
    /// Time that the values count from, in seconds since 1970-01-01T00:00:00Z, where stamps with a date were converted to
    /// seconds; the unit is then `s`.
    pub epoch_s: Option<f64>,
    /// Period after which time stamps start again from zero, s: 86400 for time of day, 604800 for seconds of the week.
    pub rollover_s: Option<f64>,
    /// Role, unit and scale where the first values or the header of the file decide and the name alone would not.
    pub judged: Option<InferredColumn>,
}

impl Column {
    /// The most likely role and unit: as the first values or the header decide, from the type of the column where that is
    /// decisive, otherwise from its name.
    pub fn inferred(&self) -> InferredColumn {
        self.judged.clone().unwrap_or_else(|| self.by_name())
    }

    /// Role and unit from type and name alone.
    pub(crate) fn by_name(&self) -> InferredColumn {
        let mut inferred = infer(&self.name, self.unit.as_deref());
        let dates = self.storage == DATES;
        if dates || ((self.epoch_s.is_some() || self.rollover_s.is_some()) && inferred.role != Role::Time) {
            inferred.role = if dates { Role::Auxiliary } else { Role::Time };
            inferred.unit_is_named = true;
            inferred.reason = note!("guess.stamps", name = self.name.as_str());
        }
        inferred
    }
}

/// Storage of a text column of dates without a time, which tells no sample from the next.
pub(crate) const DATES: &str = "dates";
