//! Scheduler, worker and client of Ballista, each with Sagnac's functions.
//!
//! A plan names functions; every process brings them itself.

use crate::session;
use crate::stores::stores;
use crate::{aggregates, functions};
use ballista::prelude::SessionContextExt;
use ballista_core::config::TaskSchedulingPolicy;
use ballista_core::error::Result as BallistaResult;
use ballista_core::extension::SessionConfigExt;
use ballista_executor::executor_process::{ExecutorProcessConfig, start_executor_process};
use ballista_scheduler::cluster::BallistaCluster;
use ballista_scheduler::config::SchedulerConfig;
use ballista_scheduler::scheduler_process::start_server;
use datafusion::common::Result;
use datafusion::execution::runtime_env::RuntimeEnvBuilder;
use datafusion::prelude::{SessionConfig, SessionContext};
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// After this time without a word a worker counts as lost, s. Its tasks go to others.
pub const WORKER_SILENCE_S: u64 = 20;
/// After this time without any worker a job fails, s.
pub const NO_WORKER_S: u64 = 20;
/// A run ends when there has been no scheduler or no worker for this time, s; workers count as lost some time before it begins.
pub const LOST_S: u64 = 15;
/// Interval at which the client asks the scheduler, and for which it waits for the answer.
const POLL_INTERVAL: Duration = Duration::from_secs(2);
/// How often a worker tells that it lives, s.
const HEARTBEAT_S: u64 = 5;
/// How often the scheduler looks for lost workers, s.
const LOOK_S: u64 = 5;
/// How long a worker waits for the scheduler at its start, s.
const CONNECT_S: u16 = 60;
/// How long finished jobs lie on a worker, s: results are fetched at once.
const KEEP_S: u64 = 3600;

/// A session whose queries the workers of a scheduler run, with some partitions of a scan at most.
///
/// # Errors
/// When the address is none.
pub async fn client(scheduler: &str, partitions: usize) -> Result<SessionContext> {
    let config = SessionConfig::new_with_ballista().with_target_partitions(partitions.max(1));
    let context = SessionContext::remote_with_state(scheduler, session::state(config)?).await?;
    // Ballista puts its own list of functions in the place of that of the state.
    functions::all().into_iter().for_each(|f| context.register_udf(f));
    aggregates::all().into_iter().for_each(|f| context.register_udaf(f));
    Ok(context)
}

/// Waits until a scheduler has not answered, or has had no worker, for [`LOST_S`], and says which.
///
/// Ballista fails a job whose workers are all lost, but not one that began without a worker: that one waits for the first.
pub async fn lost(scheduler: &str) -> String {
    let asked = format!("{}/readyz", scheduler.trim_end_matches('/').replacen("df://", "http://", 1));
    let client = reqwest::Client::builder().timeout(POLL_INTERVAL).build().unwrap_or_default();
    let (mut ready, mut why) = (Instant::now(), String::new());
    while ready.elapsed() < Duration::from_secs(LOST_S) {
        tokio::time::sleep(POLL_INTERVAL).await;
        match client.get(&asked).send().await {
            Ok(answer) if answer.status().is_success() => ready = Instant::now(),
            Ok(_) => why = format!("{scheduler} has no worker; start one with `sagnac-archive worker`"),
            Err(_) => why = format!("{scheduler} does not answer; start `sagnac-archive scheduler`"),
        }
    }
    why
}

/// Serves as the scheduler until the process is ended. `host` is the name by which workers and clients reach it.
///
/// # Errors
/// When the port cannot be used.
pub async fn scheduler(bind: SocketAddr, host: &str) -> BallistaResult<()> {
    let config = SchedulerConfig {
        external_host: host.to_owned(),
        bind_host: bind.ip().to_string(),
        bind_port: bind.port(),
        scheduling_policy: TaskSchedulingPolicy::PullStaged,
        executor_timeout_seconds: WORKER_SILENCE_S,
        expire_dead_executor_interval_seconds: LOOK_S,
        no_executors_grace_period_seconds: NO_WORKER_S,
        override_config_producer: Some(Arc::new(SessionConfig::new_with_ballista)),
        override_session_builder: Some(Arc::new(session::state)),
        ..SchedulerConfig::default()
    };
    let cluster = BallistaCluster::new_from_config(&config).await?;
    start_server(cluster, bind, Arc::new(config)).await
}

/// A worker.
#[derive(Debug, Clone)]
pub struct Worker {
    /// Host of the scheduler.
    pub scheduler_host: String,
    /// Port of the scheduler.
    pub scheduler_port: u16,
    /// Address that it listens at.
    pub bind_host: String,
    /// Name by which clients and other workers reach it.
    pub external_host: String,
    /// Port for results.
    pub port: u16,
    /// Port for the scheduler.
    pub grpc_port: u16,
    /// Recordings that it evaluates at a time.
    pub cores: usize,
    /// Memory for queries, bytes; evaluations take their own.
    pub memory_bytes: u64,
    /// Folder for results that are not fetched yet; a temporary one where it is left out.
    pub work_dir: Option<String>,
}

/// Serves as a worker until the process is ended.
///
/// # Errors
/// When the scheduler does not answer, or a port cannot be used.
pub async fn worker(worker: Worker) -> BallistaResult<()> {
    let config = ExecutorProcessConfig {
        bind_host: worker.bind_host,
        external_host: Some(worker.external_host),
        port: worker.port,
        grpc_port: worker.grpc_port,
        scheduler_host: worker.scheduler_host,
        scheduler_port: worker.scheduler_port,
        scheduler_connect_timeout_seconds: CONNECT_S,
        vcores: worker.cores,
        task_scheduling_policy: TaskSchedulingPolicy::PullStaged,
        work_dir: worker.work_dir,
        executor_heartbeat_interval_seconds: HEARTBEAT_S,
        job_data_ttl_seconds: KEEP_S,
        job_data_clean_up_interval_seconds: KEEP_S,
        memory_pool_size: Some(worker.memory_bytes),
        override_function_registry: Some(Arc::new(session::registry())),
        override_config_producer: Some(Arc::new(SessionConfig::new_with_ballista)),
        override_runtime_producer: Some(Arc::new(|_: &SessionConfig| {
            RuntimeEnvBuilder::new().with_object_store_registry(stores().clone()).build_arc()
        })),
        ..ExecutorProcessConfig::default()
    };
    start_executor_process(Arc::new(config)).await
}
