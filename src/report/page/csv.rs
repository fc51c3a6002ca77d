//! A table for programs: names for heads, ids for words, numbers to the last digit.

use super::table::Table;
use super::value::Value;
use crate::output::csv_line;

/// The table as CSV.
pub fn csv(table: &Table) -> String {
    let table = table.with(|c| !c.for_pages);
    let mut out = csv_line(table.columns.iter().map(|c| &c.name));
    for row in &table.rows {
        out.push_str(&csv_line(row.cells.iter().map(Value::for_programs)));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::page::{Column, Quantity};

    #[test]
    fn programs_get_ids_and_numbers_and_no_formulas() {
        let quantity =
            |number: f64| Quantity { number: Some(number), printed: "1.50".into(), unit: "°/h".into() };
        let table = Table::new("", 2)
            .column(Column::text("serial", "Serial number"), ["=1+1,x", "SN-2"])
            .column(Column::number("bias", "Bias"), [quantity(1.5), quantity(f64::NAN)])
            .column(Column::text("verdict", "Verdict"), [Value::state("pass", "годен"), Value::Empty]);
        assert_eq!(csv(&table), "serial,bias,verdict\n\"'=1+1,x\",1.5e0,pass\nSN-2,,\n");
    }
}
