//! Scalar functions: one row, one recording.
//!
//! | function | gives |
//! |---|---|
//! | `sagnac_analyze(uri [, unit [, at]])` | what the recording shows |
//! | `sagnac_run(uri, procedure, limits [, unit [, at]])` | the result of a procedure; `limits` may be null |
//! | `sagnac_explain(uri, model [, unit [, at]])` | where the recording departs from a model |
//! | `sagnac_key(function, uri, state, procedure, limits, model, unit)` | the identity of a job with this engine |
//! | `sagnac_measurand(measurands, id)` | one measured quantity of a result |

mod evaluation;
mod key;
mod measurand;
mod texts;

pub use evaluation::{Evaluation, Function};
pub use key::Key;
pub use measurand::OneMeasurand;

use datafusion::logical_expr::ScalarUDF;

/// Every scalar function.
pub fn all() -> Vec<ScalarUDF> {
    let evaluations = Function::ALL.map(|f| ScalarUDF::from(Evaluation::new(f)));
    evaluations
        .into_iter()
        .chain([ScalarUDF::from(Key::new()), ScalarUDF::from(OneMeasurand::new())])
        .collect()
}
