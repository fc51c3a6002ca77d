//! Number of independent tests that a search for a mismatch amounts to.
//!
//! The p-values of a search are neither independent nor exact: two effects share a course, a bound of a scan is cautious, a process that
//! can only add power has half its p-values at one. As many independent and exact tests as have the same least p-value by chance are
//! fewer than were made. Their number is a sum over kinds of search, each with a rate: in records of a right claim, −ln(1 − p) of the
//! least p-value is exponential, and the rate of a kind is the number of records in which the least p-value was its own over the sum of
//! −ln(1 − p) over the records that had such a search (competing risks; D. R. Cox 1959). The rates are those of
//! `laboratory-searches` (docs/validation/explanation.md).

use crate::effect::{Column, Drivers};

/// Independent tests that each kind of search amounts to.
struct Rates {
    /// Changes of the spectrum of the noise.
    noise: f64,
    /// Courses of time: ramps, steps, lines, combs, what was not recorded.
    time: f64,
    /// Laws of a thermometer.
    temperature: f64,
    /// Laws of a table, its delays and its heading.
    table: f64,
    /// Laws of one column without such a role.
    column: f64,
    /// Tests of the residual that look at no column.
    residual: f64,
    /// One test of the residual against a column, or a product of two.
    residual_of_column: f64,
}

const RATES: Rates = Rates {
    noise: 2.0,
    time: 1.2,
    temperature: 3.3,
    table: 2.3,
    column: 1.6,
    residual: 6.6,
    residual_of_column: 0.57,
};

/// Number of tests that the search for effects amounts to in a record with such columns.
fn of_effects(drivers: &Drivers) -> f64 {
    let there = |column: Column| drivers.column(column).is_some();
    let table = [Column::TableRate, Column::TableAngle, Column::OuterRate].into_iter().any(there);
    let others = drivers.others.len() + usize::from(there(Column::Supply));
    let where_there = |is_there: bool, rate: f64| if is_there { rate } else { 0.0 };
    RATES.noise
        + RATES.time
        + where_there(there(Column::Temperature), RATES.temperature)
        + where_there(table, RATES.table)
        + others as f64 * RATES.column
}

/// Number of tests that those of a residual amount to in a record with such columns.
pub fn of_residual(drivers: &Drivers) -> f64 {
    // A thermometer is looked at by its rate of change as well.
    let series = drivers.columns().count() + usize::from(drivers.temperature.is_some());
    let of_columns = series * (series + 3) / 2;
    RATES.residual + of_columns as f64 * RATES.residual_of_column
}

/// Number of tests that everything amounts to that is looked at in a record with such columns.
pub fn of_record(drivers: &Drivers) -> f64 {
    of_effects(drivers) + of_residual(drivers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_search_counts_where_the_record_has_its_columns() {
        let bare = Drivers { dt_s: 1.0, samples: 100, averaged: 1, ..Drivers::default() };
        let of = |drivers: &Drivers| (of_effects(drivers), of_residual(drivers));
        let Rates { noise, time, temperature, table, column, residual, residual_of_column } = RATES;
        assert_eq!(of(&bare), (noise + time, residual));
        let series = Some(vec![0.0; 100]);
        // Three series: the temperature, its rate and the supply. Each has two tests, and three pairs have a product.
        let warm = Drivers { temperature: series.clone(), supply: series.clone(), ..bare.clone() };
        assert_eq!(of(&warm), (noise + time + temperature + column, residual + 9.0 * residual_of_column));
        let turning = Drivers { table_rate: series.clone(), table_angle: series, ..bare };
        let (effects, left) = of(&turning);
        assert_eq!((effects, left), (noise + time + table, residual + 5.0 * residual_of_column));
        assert_eq!(of_record(&turning), effects + left);
    }
}
