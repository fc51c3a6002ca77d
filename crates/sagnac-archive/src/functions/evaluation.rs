//! `sagnac_analyze`, `sagnac_run`, `sagnac_explain`: each row one recording, evaluated in parallel.

use super::texts::Texts;
use crate::evaluate::{Order, Task, evaluate};
use crate::outcome::{self, Failure, FailureKind, Outcome};
use datafusion::arrow::datatypes::DataType;
use datafusion::common::Result;
use datafusion::logical_expr::{
    ColumnarValue, ScalarFunctionArgs, ScalarUDFImpl, Signature, TypeSignature, Volatility,
};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Recordings that this process has evaluated.
static EVALUATED_COUNT: AtomicU64 = AtomicU64::new(0);

/// The functions that evaluate a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Function {
    /// `sagnac_analyze(uri [, unit [, at]])`.
    Analyze,
    /// `sagnac_run(uri, procedure, limits [, unit [, at]])`.
    Run,
    /// `sagnac_explain(uri, model [, unit [, at]])`.
    Explain,
}

impl Function {
    /// All of them.
    pub const ALL: [Function; 3] = [Function::Analyze, Function::Run, Function::Explain];

    /// Its name in SQL.
    pub fn name(self) -> &'static str {
        match self {
            Function::Analyze => "sagnac_analyze",
            Function::Run => "sagnac_run",
            Function::Explain => "sagnac_explain",
        }
    }

    /// Arguments that cannot be left out; unit data and time of evaluation follow them.
    fn required(self) -> usize {
        match self {
            Function::Analyze => 1,
            Function::Run => 3,
            Function::Explain => 2,
        }
    }

    /// Recordings that this process has evaluated so far.
    pub fn evaluated() -> u64 {
        EVALUATED_COUNT.load(Ordering::Relaxed)
    }
}

/// One of them, as DataFusion calls it.
#[derive(Debug, PartialEq, Eq, Hash)]
pub struct Evaluation {
    function: Function,
    signature: Signature,
}

impl Evaluation {
    /// The implementation of a function.
    ///
    /// It is volatile: an optimiser may move or repeat what is not, and a repeated call reads a whole recording again.
    pub fn new(function: Function) -> Evaluation {
        let texts = |n: usize| TypeSignature::Exact(vec![DataType::Utf8; n]);
        let required = function.required();
        let forms = (required..=required + 2).map(texts).collect();
        Evaluation { function, signature: Signature::one_of(forms, Volatility::Volatile) }
    }

    fn outcome(&self, texts: &Texts, row: usize) -> Outcome {
        let missing = |what: &str| -> Outcome {
            Failure::new(FailureKind::Argument, format!("the {what} is null or empty; name one")).into()
        };
        let Some(uri) = texts.get(0, row) else { return missing("uri") };
        let task = match self.function {
            Function::Analyze => Task::Analyze,
            Function::Run => match texts.get(1, row) {
                Some(procedure) => Task::Run { procedure, limits: texts.get(2, row) },
                None => return missing("procedure"),
            },
            Function::Explain => match texts.get(1, row) {
                Some(model) => Task::Explain { model },
                None => return missing("model"),
            },
        };
        let required = self.function.required();
        let outcome =
            evaluate(&Order { uri, task, unit: texts.get(required, row), at: texts.get(required + 1, row) });
        EVALUATED_COUNT.fetch_add(1, Ordering::Relaxed);
        outcome
    }
}

impl ScalarUDFImpl for Evaluation {
    fn name(&self) -> &str {
        self.function.name()
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _arguments: &[DataType]) -> Result<DataType> {
        Ok(outcome::data_type())
    }

    fn invoke_with_args(&self, args: ScalarFunctionArgs) -> Result<ColumnarValue> {
        let rows = args.number_rows;
        let texts = Texts::of(args.args, rows)?;
        // One by one to the threads: recordings differ in length, and a fixed share each would leave a core idle.
        let outcomes: Vec<Outcome> =
            (0..rows).into_par_iter().with_max_len(1).map(|row| self.outcome(&texts, row)).collect();
        Ok(ColumnarValue::Array(Arc::new(outcome::array(&outcomes))))
    }
}
