//! Sessions of DataFusion that know Sagnac's functions and every store.

use crate::stores::stores;
use crate::{aggregates, functions};
use ballista_core::extension::{
    ballista_aggregate_functions, ballista_scalar_functions, ballista_window_functions,
};
use ballista_core::registry::BallistaFunctionRegistry;
use datafusion::common::Result;
use datafusion::execution::memory_pool::FairSpillPool;
use datafusion::execution::runtime_env::{RuntimeEnv, RuntimeEnvBuilder};
use datafusion::execution::{FunctionRegistry, SessionState, SessionStateBuilder};
use datafusion::prelude::SessionConfig;
use std::sync::Arc;

/// Memory that sorts, joins and groups of a query may take before they go to disk, bytes. Evaluations take their own, which does not
/// grow with the number of recordings.
pub const QUERY_MEMORY_BYTES: usize = 2 << 30;

/// What queries run in: a limit for their memory, and stores by address.
///
/// # Errors
/// When there is no place for temporary files.
pub fn runtime() -> Result<Arc<RuntimeEnv>> {
    RuntimeEnvBuilder::new()
        .with_memory_pool(Arc::new(FairSpillPool::new(QUERY_MEMORY_BYTES)))
        .with_object_store_registry(stores().clone())
        .build_arc()
}

/// The state of a session with every function of DataFusion, Ballista and Sagnac.
///
/// # Errors
/// As [`runtime`].
pub fn state(mut config: SessionConfig) -> Result<SessionState> {
    // It would put a call, volatile or not, in the place of each use of its result: a recording would be evaluated for every member
    // that a query reads.
    config.options_mut().optimizer.enable_leaf_expression_pushdown = false;
    let mut state = SessionStateBuilder::new()
        .with_config(config)
        .with_runtime_env(runtime()?)
        .with_default_features()
        .with_scalar_functions(ballista_scalar_functions())
        .with_aggregate_functions(ballista_aggregate_functions())
        .with_window_functions(ballista_window_functions())
        .build();
    for function in functions::all() {
        state.register_udf(Arc::new(function))?;
    }
    for function in aggregates::all() {
        state.register_udaf(Arc::new(function))?;
    }
    Ok(state)
}

/// The functions that a worker finds by the names that a plan has.
pub fn registry() -> BallistaFunctionRegistry {
    let mut registry = BallistaFunctionRegistry::default();
    for function in functions::all() {
        registry.scalar_functions.insert(function.name().to_owned(), Arc::new(function));
    }
    for function in aggregates::all() {
        registry.aggregate_functions.insert(function.name().to_owned(), Arc::new(function));
    }
    registry
}
