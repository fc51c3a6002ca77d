//! `sagnac_measurand`: one measured quantity of a result.

use crate::outcome::measurand_fields;
use datafusion::arrow::array::{Array, AsArray, UInt32Array};
use datafusion::arrow::compute::{cast, take};
use datafusion::arrow::datatypes::{DataType, Field};
use datafusion::common::{DataFusionError, Result, ScalarValue};
use datafusion::logical_expr::{ColumnarValue, ScalarFunctionArgs, ScalarUDFImpl, Signature, Volatility};
use std::sync::Arc;

/// `sagnac_measurand(measurands, id)`: the first quantity of that id, as a struct; null where a result has none. It goes through the
/// lists once, where `unnest` would make a row of every quantity.
#[derive(Debug, PartialEq, Eq, Hash)]
pub struct OneMeasurand {
    signature: Signature,
}

impl OneMeasurand {
    /// The function.
    pub fn new() -> OneMeasurand {
        let item = Field::new("item", DataType::Struct(measurand_fields()), true);
        let arguments = vec![DataType::List(Arc::new(item)), DataType::Utf8];
        OneMeasurand { signature: Signature::exact(arguments, Volatility::Immutable) }
    }
}

impl Default for OneMeasurand {
    fn default() -> OneMeasurand {
        OneMeasurand::new()
    }
}

impl ScalarUDFImpl for OneMeasurand {
    fn name(&self) -> &str {
        "sagnac_measurand"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _arguments: &[DataType]) -> Result<DataType> {
        Ok(DataType::Struct(measurand_fields()))
    }

    fn invoke_with_args(&self, args: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let [lists, id] = <[ColumnarValue; 2]>::try_from(args.args)
            .map_err(|_| DataFusionError::Plan("sagnac_measurand takes measurands and an id".to_owned()))?;
        let id = match id {
            ColumnarValue::Scalar(ScalarValue::Utf8(Some(id)) | ScalarValue::Utf8View(Some(id))) => id,
            _ => {
                let text = "sagnac_measurand: the id is one text for all rows, such as 'static_bias'";
                return Err(DataFusionError::Plan(text.to_owned()));
            }
        };
        let lists = lists.into_array(args.number_rows)?;
        let lists = lists.as_list::<i32>();
        let items = lists.values().as_struct();
        let ids = cast(items.column(0), &DataType::Utf8)?;
        let ids = ids.as_string::<i32>();
        let places: UInt32Array = (0..lists.len())
            .map(|row| {
                let offsets = lists.value_offsets();
                let (start, end) = (*offsets.get(row)?, *offsets.get(row + 1)?);
                let mut own = (start..end).filter(|_| lists.is_valid(row));
                own.find(|i| ids.value(*i as usize) == id).map(|i| i as u32)
            })
            .collect();
        Ok(ColumnarValue::Array(take(items, &places, None)?))
    }
}
