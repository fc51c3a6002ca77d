//! The part of a query that is run for each recording.
//!
//! `SELECT sagnac_run(uri, procedure, limits) FROM jobs WHERE ...` says two things: which rows of the job list are meant, and what
//! is to be done with each. They are taken apart here, so that the rows can be compared with what is done already, cut
//! into portions, and sent to several machines.

use crate::functions::{Function, Key};
use datafusion::arrow::datatypes::DataType;
use datafusion::common::tree_node::{TreeNode, TreeNodeRecursion};
use datafusion::common::{Result, ScalarValue};
use datafusion::logical_expr::{Expr, LogicalPlan, ScalarUDF, cast, lit};
use datafusion::prelude::col;

/// Columns of what is left to do, in their order: what the call of a query gave for a row, and the key of the job.
pub const PENDING_COLUMNS: [&str; 7] = ["key", "uri", "procedure", "limits", "model", "unit", "at"];

/// A query that does one thing with each of some rows of the job list.
#[derive(Debug, Clone)]
pub struct RowQuery {
    /// The rows.
    pub rows: LogicalPlan,
    /// The function that evaluates a row.
    pub function: Function,
    arguments: Vec<Expr>,
}

impl RowQuery {
    /// Takes a query apart.
    ///
    /// # Errors
    /// A sentence when it is not of this kind.
    pub fn of(plan: &LogicalPlan) -> std::result::Result<RowQuery, String> {
        let LogicalPlan::Projection(projection) = plan else {
            return Err(not_by_row("its outermost part"));
        };
        let mut calls: Vec<(Function, Vec<Expr>)> = vec![];
        for expression in &projection.expr {
            collect(expression, &mut calls);
        }
        calls.dedup();
        let [(function, arguments)] = <[_; 1]>::try_from(calls).map_err(|calls| {
            let names = Function::ALL.map(Function::name).join(", ");
            format!(
                "the query calls {} functions that evaluate a recording; call one of {names} once",
                calls.len()
            )
        })?;
        let rows = projection.input.as_ref().clone();
        check(&rows)?;
        Ok(RowQuery { rows, function, arguments })
    }

    /// The columns [`PENDING_COLUMNS`] from the rows; `at` is the time of evaluation where the query states none.
    pub fn pending(&self, at: &str) -> Vec<Expr> {
        let null = || Expr::Literal(ScalarValue::Utf8(None), None);
        // A bare NULL has no type of its own.
        let text = |expression: &Expr| cast(expression.clone(), DataType::Utf8);
        let argument = |place: usize| self.arguments.get(place).map_or_else(null, text);
        let (procedure, limits, model, next) = match self.function {
            Function::Analyze => (null(), null(), null(), 1),
            Function::Run => (argument(1), argument(2), null(), 3),
            Function::Explain => (null(), null(), argument(1), 2),
        };
        let (uri, unit) = (argument(0), argument(next));
        let at = self.arguments.get(next + 1).map_or_else(|| lit(at), text);
        let identity = vec![
            lit(self.function.name()),
            uri.clone(),
            col("state"),
            procedure.clone(),
            limits.clone(),
            model.clone(),
            unit.clone(),
        ];
        let key = ScalarUDF::from(Key::new()).call(identity);
        [key, uri, procedure, limits, model, unit, at]
            .into_iter()
            .zip(PENDING_COLUMNS)
            .map(|(e, n)| e.alias(n))
            .collect()
    }

    /// The call for a row of [`PENDING_COLUMNS`].
    pub fn call(&self, function: &ScalarUDF) -> Expr {
        let names: &[&str] = match self.function {
            Function::Analyze => &["uri", "unit", "at"],
            Function::Run => &["uri", "procedure", "limits", "unit", "at"],
            Function::Explain => &["uri", "model", "unit", "at"],
        };
        function.call(names.iter().map(|n| col(*n)).collect())
    }
}

fn not_by_row(what: &str) -> String {
    format!(
        "{what} is more than `SELECT function(...) FROM jobs WHERE ...`: `run` does one thing with each recording; \
         use `query` for the rest, over the results"
    )
}

fn function_of(expression: &Expr) -> Option<(Function, Vec<Expr>)> {
    let Expr::ScalarFunction(call) = expression else { return None };
    let function = Function::ALL.into_iter().find(|f| f.name() == call.name())?;
    Some((function, call.args.clone()))
}

fn collect(expression: &Expr, calls: &mut Vec<(Function, Vec<Expr>)>) {
    let _: Result<TreeNodeRecursion> = expression.apply(|e| {
        calls.extend(function_of(e));
        Ok(TreeNodeRecursion::Continue)
    });
}

/// Only rows of one table, some of them left out, and no evaluation on the way.
fn check(rows: &LogicalPlan) -> std::result::Result<(), String> {
    let mut plan = rows;
    loop {
        for expression in plan.expressions() {
            let mut calls = vec![];
            collect(&expression, &mut calls);
            if !calls.is_empty() {
                let text = "a condition evaluates recordings; choose by columns of `jobs`, and of results by `query`";
                return Err(text.to_owned());
            }
        }
        plan = match plan {
            LogicalPlan::Filter(filter) => filter.input.as_ref(),
            LogicalPlan::SubqueryAlias(alias) => alias.input.as_ref(),
            LogicalPlan::TableScan(scan) if scan.table_name.table() == "jobs" => return Ok(()),
            other => return Err(not_by_row(&format!("`{}`", other.display()))),
        };
    }
}
