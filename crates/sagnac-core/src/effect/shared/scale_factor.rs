//! Scale factors that follow a recorded column.

use crate::effect::Drivers;

/// True where the table moves.
pub(in crate::effect) fn is_moving(drivers: &Drivers) -> bool {
    drivers.table_rate.iter().flatten().any(|r| *r != 0.0)
}

/// Rate of the table times the departure of a column from a reference, deg/h for 1 ppm a unit of the column.
pub(in crate::effect) fn product(values: &[f64], reference: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    let rate = drivers.table_rate.as_ref()?;
    Some(rate.iter().zip(values).map(|(r, v)| 3600e-6 * r * (v - reference)).collect())
}
