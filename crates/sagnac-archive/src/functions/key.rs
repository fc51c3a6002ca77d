//! `sagnac_key`: the identity of a job with this engine.

use super::texts::Texts;
use crate::ENGINE_VERSION;
use crate::evaluate::{hash_of_file, hexadecimal};
use crate::stores::fetch;
use datafusion::arrow::array::StringArray;
use datafusion::arrow::datatypes::DataType;
use datafusion::common::Result;
use datafusion::logical_expr::{ColumnarValue, ScalarFunctionArgs, ScalarUDFImpl, Signature, Volatility};
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::sync::Arc;

/// `sagnac_key(function, uri, state, procedure, limits, model, unit)`: SHA-256, hexadecimal, over the function, the recording
/// and its state in the job list, the contents of procedure, limits and model, the unit data, and the version of the engine.
/// What could change a result changes the key. A file that cannot be read counts as its name: the evaluation tells why.
#[derive(Debug, PartialEq, Eq, Hash)]
pub struct Key {
    signature: Signature,
}

/// Arguments that name a file whose contents count.
const FILE_ARGUMENTS: std::ops::RangeInclusive<usize> = 3..=5;
/// Arguments in all.
const ARGUMENT_COUNT: usize = 7;

impl Key {
    /// The function.
    pub fn new() -> Key {
        Key { signature: Signature::exact(vec![DataType::Utf8; ARGUMENT_COUNT], Volatility::Stable) }
    }
}

impl Default for Key {
    fn default() -> Key {
        Key::new()
    }
}

fn contents(named: &str) -> String {
    fetch(named).and_then(|f| hash_of_file(f.path(), named)).unwrap_or_else(|_| format!("unread {named}"))
}

impl ScalarUDFImpl for Key {
    fn name(&self) -> &str {
        "sagnac_key"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _arguments: &[DataType]) -> Result<DataType> {
        Ok(DataType::Utf8)
    }

    fn invoke_with_args(&self, args: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let rows = args.number_rows;
        let texts = Texts::of(args.args, rows)?;
        // A batch names a few procedures thousands of times.
        let mut read: HashMap<&str, String> = HashMap::new();
        let mut keys = Vec::with_capacity(rows);
        for row in 0..rows {
            let mut hash = Sha256::new().chain_update(ENGINE_VERSION);
            for argument in 0..ARGUMENT_COUNT {
                let text = texts.get(argument, row);
                let part = match text {
                    Some(name) if FILE_ARGUMENTS.contains(&argument) => {
                        read.entry(name).or_insert_with(|| contents(name)).as_str()
                    }
                    other => other.unwrap_or_default(),
                };
                // The length keeps neighbours apart.
                hash = hash.chain_update((part.len() as u64).to_le_bytes()).chain_update(part);
            }
            keys.push(hexadecimal(hash));
        }
        Ok(ColumnarValue::Array(Arc::new(StringArray::from(keys))))
    }
}
