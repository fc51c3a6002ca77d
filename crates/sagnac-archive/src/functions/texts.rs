//! Arguments that are texts, row by row.

use datafusion::arrow::array::{Array, ArrayRef, AsArray, StringArray};
use datafusion::arrow::compute::cast;
use datafusion::arrow::datatypes::DataType;
use datafusion::common::Result;
use datafusion::logical_expr::ColumnarValue;

/// Columns of texts of equal length.
pub struct Texts(Vec<StringArray>);

impl Texts {
    /// The arguments of a call for some rows.
    ///
    /// # Errors
    /// When one is no text.
    pub fn of(args: Vec<ColumnarValue>, rows: usize) -> Result<Texts> {
        let column = |value: ColumnarValue| -> Result<StringArray> {
            let array: ArrayRef = cast(&value.into_array(rows)?, &DataType::Utf8)?;
            Ok(array.as_string::<i32>().clone())
        };
        Ok(Texts(args.into_iter().map(column).collect::<Result<_>>()?))
    }

    /// The text in a row of an argument; `None` where it is null, empty or left out.
    pub fn get(&self, argument: usize, row: usize) -> Option<&str> {
        let column = self.0.get(argument).filter(|c| row < c.len() && c.is_valid(row))?;
        Some(column.value(row)).filter(|text| !text.is_empty())
    }
}
