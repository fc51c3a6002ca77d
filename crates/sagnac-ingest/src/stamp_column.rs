//! The time column of a file as a clock: its numbers in s, roll-overs undone.

use crate::Column;
use crate::clock::Unwrapper;
use sagnac_core::units::Unit;

/// The stamps of a file: which column, and how its numbers become s.
#[derive(Debug, Clone)]
pub(crate) struct Stamps {
    pub column: usize,
    pub unit_s: f64,
    /// Zero of the stamps, s since 1970; `None` where they tell no date.
    pub epoch_s: Option<f64>,
    rollover_s: Option<f64>,
}

impl Stamps {
    /// The stamps in the time column of a file; `None` where its unit is none of a time.
    pub fn of(columns: &[Column], time: usize) -> Option<Stamps> {
        let column = columns.get(time)?;
        let inferred = column.inferred();
        let unit_s = inferred.unit.factor_to(&Unit::parse("s").ok()?).ok()? * inferred.scale;
        let (epoch_s, rollover_s) = (column.epoch_s, column.rollover_s);
        Some(Stamps { column: time, unit_s, epoch_s, rollover_s })
    }

    /// Undoes the roll-overs of stamps in s.
    pub fn unwrapper(&self) -> Unwrapper {
        Unwrapper::new(self.rollover_s, Vec::new(), 0.0)
    }

    /// Numbers of the column in s, roll-overs undone.
    pub fn seconds(&self, stamps: &mut [f64], unwrapper: &mut Unwrapper) {
        stamps.iter_mut().for_each(|s| *s *= self.unit_s);
        unwrapper.apply(stamps);
    }
}
