//! What a laboratory can do.

use crate::effect::Column;

/// Limits of chamber and table, and the time at hand.
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// Longest test, s.
    pub budget_s: f64,
    /// Lowest and highest temperature of the chamber, °C; `None` without a chamber.
    pub temperature_degc: Option<[f64; 2]>,
    /// Slowest and fastest ramp of the chamber, °C/h.
    pub ramp_degc_per_h: [f64; 2],
    /// Sizes of the rates of the table, deg/s, ascending; empty without a table.
    pub table_rates_deg_s: Vec<f64>,
    /// Whether the table can be set to angles.
    pub headings: bool,
}

impl Limits {
    /// Temperatures where none are given, °C.
    pub const TEMPERATURE_DEGC: [f64; 2] = [10.0, 50.0];
    /// Ramps where none are given, °C/h.
    pub const RAMP_DEGC_PER_H: [f64; 2] = [4.0, 60.0];
    /// Rates of the table where none are given, deg/s.
    pub const TABLE_RATES_DEG_S: [f64; 3] = [3.0, 10.0, 30.0];

    /// Usual ones for a time at hand, s.
    pub fn usual(budget_s: f64) -> Limits {
        Limits {
            budget_s,
            temperature_degc: Some(Limits::TEMPERATURE_DEGC),
            ramp_degc_per_h: Limits::RAMP_DEGC_PER_H,
            table_rates_deg_s: Limits::TABLE_RATES_DEG_S.to_vec(),
            headings: true,
        }
    }

    /// Whether a column can be moved.
    pub(super) fn moves(&self, column: Column) -> bool {
        match column {
            Column::Temperature => self.temperature_degc.is_some(),
            Column::TableRate => !self.table_rates_deg_s.is_empty(),
            Column::TableAngle => self.headings,
            _ => false,
        }
    }
}
