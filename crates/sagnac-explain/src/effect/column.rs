//! Columns of a recording beside time and rate.

use super::Domain;
use std::collections::BTreeSet;
use std::sync::{Mutex, OnceLock, PoisonError};

/// Name of the text by which a claim states the column that an effect follows.
pub const COLUMN_TEXT: &str = "column";

/// A column beside time and rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Column {
    /// `temp_degC`
    Temperature,
    /// `table_rate_deg_s`
    TableRate,
    /// `table_angle_deg`
    TableAngle,
    /// `outer_rate_deg_s`
    OuterRate,
    /// `supply_v`
    Supply,
    /// Any other numeric column of the laboratory.
    Other(OtherColumn),
}

/// The name of a column that has no role of its own. Equal names are one value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct OtherColumn(&'static str);

impl Column {
    /// Columns that have a role of their own.
    pub const KNOWN: [Column; 5] =
        [Column::Temperature, Column::TableRate, Column::TableAngle, Column::OuterRate, Column::Supply];

    /// The column of a name: a known one, else another column.
    ///
    /// The name of another column is kept for the life of the program, once for each different name, so that a column can
    /// be copied and compared like a number.
    pub fn of_name(name: &str) -> Column {
        static NAMES: OnceLock<Mutex<BTreeSet<&'static str>>> = OnceLock::new();
        if let Some(known) = Column::KNOWN.into_iter().find(|c| c.name() == name) {
            return known;
        }
        let mut names = NAMES.get_or_init(Mutex::default).lock().unwrap_or_else(PoisonError::into_inner);
        let kept = names.get(name).copied().unwrap_or_else(|| {
            let kept: &'static str = Box::leak(name.to_owned().into_boxed_str());
            names.insert(kept);
            kept
        });
        Column::Other(OtherColumn(kept))
    }

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Column::Temperature => "temp_degC",
            Column::TableRate => "table_rate_deg_s",
            Column::TableAngle => "table_angle_deg",
            Column::OuterRate => "outer_rate_deg_s",
            Column::Supply => "supply_v",
            Column::Other(other) => other.0,
        }
    }

    /// The domain along which an effect of its values is located.
    pub fn domain(self) -> Domain {
        match self {
            Column::Temperature => Domain::Temperature,
            Column::TableRate => Domain::InputRate,
            Column::TableAngle => Domain::Angle,
            Column::OuterRate => Domain::OuterRate,
            Column::Supply => Domain::Supply,
            Column::Other(_) => Domain::Driver,
        }
    }

    /// True for a column without a role of its own.
    pub fn is_other(self) -> bool {
        matches!(self, Column::Other(_))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_found_by_its_name_and_equal_names_are_one_column() {
        for known in Column::KNOWN {
            assert_eq!(Column::of_name(known.name()), known);
        }
        let (a, b) = (Column::of_name("pressure_hPa"), Column::of_name(&["pressure", "hPa"].join("_")));
        assert!(a == b && a.is_other() && a.name() == "pressure_hPa");
        assert_ne!(a, Column::of_name("pressure_Pa"));
    }
}
