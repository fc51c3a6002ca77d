//! A run: what is left to do, in portions, with retries.
//!
//! The work left is the job list without what the results hold already, by an anti-join on the key. It is evaluated in portions: a
//! portion is one query of DataFusion or one job of Ballista, and its results appear as whole files when it ends. A run that was
//! stopped anywhere is resumed by the same command; it loses the portions that were under way, and nothing is doubled.

use crate::cluster;
use crate::job_list::{self, compressed, parquet, parquet_table, put};
use crate::query::{PENDING_COLUMNS, RowQuery};
use crate::results::{self, Counts, Writer};
use crate::session;
use crate::stores;
use datafusion::arrow::array::RecordBatch;
use datafusion::arrow::compute::concat_batches;
use datafusion::common::{DataFusionError, JoinType, Result};
use datafusion::dataframe::DataFrame;
use datafusion::datasource::listing::ListingTableUrl;
use datafusion::execution::FunctionRegistry;
use datafusion::physical_plan::SendableRecordBatchStream;
use datafusion::prelude::{SessionConfig, SessionContext, col};
use futures::{StreamExt, TryStreamExt};
use indicatif::ProgressBar;
use object_store::path::Path;
use object_store::{ObjectStore, ObjectStoreExt};
use std::fs::{File, TryLockError};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use url::Url;

/// Portions under way at a time: while one ends on a single thread, the next keeps the others busy.
const UNDER_WAY: usize = 2;
/// Pauses before a portion is tried again on a cluster: a worker or a scheduler that was lost may be back.
const RETRY_PAUSES: [Duration; 2] = [Duration::from_secs(3), Duration::from_secs(10)];
/// Where the portions of a cluster lie while they are under way, below the folder of the results.
const PENDING_FOLDER: &str = ".pending";
/// Ending of their names: not that of results.
const PENDING_ENDING: &str = ".pending";

/// Where recordings are evaluated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// In this process.
    Here,
    /// By the workers of a scheduler of Ballista.
    Cluster {
        /// Address of the scheduler, such as `df://host:50050`.
        scheduler: String,
        /// Recordings that a worker gets at a time.
        rows_per_task: usize,
    },
}

/// What to run.
#[derive(Debug, Clone)]
pub struct Order {
    /// The job list.
    pub jobs: Url,
    /// The query over it.
    pub sql: String,
    /// Folder of the results.
    pub out: Url,
    /// Where recordings are evaluated.
    pub place: Place,
    /// Recordings of a portion.
    pub portion: usize,
    /// Time of evaluation that results state, RFC 3339.
    pub at: String,
}

/// What a run did.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Report {
    /// Jobs that were left to do.
    pub pending: u64,
    /// What they gave.
    pub counts: Counts,
    /// Why some could not be reached.
    pub unreached: Vec<String>,
}

/// Runs what is left of a job list.
///
/// # Errors
/// A sentence: when the query is of another kind, a folder cannot be read or written, or the cluster does not answer.
/// Results written by then stay, and the same command resumes.
pub async fn run(order: &Order, progress: &ProgressBar) -> std::result::Result<Report, String> {
    let _lock = lock(&order.out)?;
    let sentence = |e: DataFusionError| e.strip_backtrace();
    let here = SessionContext::new_with_state(session::state(SessionConfig::new()).map_err(sentence)?);
    let (query, pending) = pending(&here, order).await?;
    let count = pending.clone().count().await.map_err(sentence)? as u64;
    progress.set_length(count);
    progress.reset_elapsed();
    let runner = Runner::new(order, query).await.map_err(sentence)?;
    let rows = pending.execute_stream().await.map_err(sentence)?;
    let done = runner.run_all(rows, progress).await;
    runner.clean().await;
    let (counts, unreached) = done.map_err(|e| {
        format!("{}\nThe results so far are in {}; the same command resumes.", sentence(e), order.out)
    })?;
    Ok(Report { pending: count, counts, unreached })
}

/// Keeps other runs away from a folder of this machine for as long as it is held; the system lets go of it when the program dies.
fn lock(out: &Url) -> std::result::Result<Option<File>, String> {
    let Ok(folder) = out.to_file_path() else { return Ok(None) };
    let failed = |e: std::io::Error| format!("{}: {e}; name a folder that can be written", folder.display());
    std::fs::create_dir_all(&folder).map_err(failed)?;
    let file = File::create(folder.join(".lock")).map_err(failed)?;
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(TryLockError::WouldBlock) => {
            Err(format!("{}: another run writes here; wait for it, or name another folder", folder.display()))
        }
        // A share without locks is used as an object store is: by one run at a time.
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

/// The query, and the jobs that the results do not hold yet.
async fn pending(here: &SessionContext, order: &Order) -> std::result::Result<(RowQuery, DataFrame), String> {
    let sentence = |e: DataFusionError| e.strip_backtrace();
    let list = job_list::table(order.jobs.clone()).map_err(sentence)?;
    here.register_table("jobs", list).map_err(sentence)?;
    let plan = here.state().create_logical_plan(&order.sql).await.map_err(sentence)?;
    let query = RowQuery::of(&plan)?;
    let left = || -> Result<DataFrame> {
        let rows = DataFrame::new(here.state(), query.rows.clone());
        let done = here.read_table(results::table(order.out.clone())?)?;
        let done = done.select(vec![col("key").alias("done")])?;
        // A list may name a recording twice.
        let asked = rows.select(query.pending(&order.at))?.distinct()?;
        asked.join(done, JoinType::LeftAnti, &["key"], &["done"], None)
    };
    let left = left().map_err(sentence)?;
    Ok((query, left))
}

/// Runs portions one after another, some at a time.
struct Runner {
    context: SessionContext,
    place: Place,
    query: RowQuery,
    writer: Writer,
    pending: Url,
    portion: usize,
    number: AtomicUsize,
}

impl Runner {
    async fn new(order: &Order, query: RowQuery) -> Result<Runner> {
        let context = match &order.place {
            // A portion is one batch, whose rows share the threads of the function.
            Place::Here => SessionContext::new_with_state(session::state(
                SessionConfig::new().with_target_partitions(1),
            )?),
            Place::Cluster { scheduler, rows_per_task } => {
                cluster::client(scheduler, order.portion.div_ceil((*rows_per_task).max(1))).await?
            }
        };
        let run = format!("{}-{}", sagnac::moment::now().format("%Y%m%dT%H%M%S%3f"), std::process::id());
        let (store, folder) = stores::open(&order.out)?;
        let pending = order
            .out
            .join(&format!("{PENDING_FOLDER}/{run}/"))
            .map_err(|e| DataFusionError::External(Box::new(e)))?;
        Ok(Runner {
            context,
            place: order.place.clone(),
            writer: Writer { store, folder, run, function: query.function },
            query,
            pending,
            portion: order.portion.max(1),
            number: AtomicUsize::new(0),
        })
    }

    async fn run_all(
        &self,
        rows: SendableRecordBatchStream,
        progress: &ProgressBar,
    ) -> Result<(Counts, Vec<String>)> {
        let portions = portions(rows, self.portion);
        let done = portions
            .map(|portion| async {
                let portion = portion?;
                let rows = portion.num_rows() as u64;
                let number = self.number.fetch_add(1, Ordering::Relaxed);
                let batches = self.patiently(number, &portion, progress).await?;
                let written = self.writer.write(number, &batches).await?;
                progress.inc(rows);
                Ok::<_, DataFusionError>(written)
            })
            .buffer_unordered(UNDER_WAY);
        let mut done = std::pin::pin!(done);
        let (mut counts, mut unreached) = (Counts::default(), vec![]);
        while let Some((own, texts)) = done.try_next().await? {
            counts += own;
            unreached.extend(texts);
        }
        Ok((counts, unreached))
    }

    /// Results of a portion; on a cluster it is tried again where it failed, as long as there is a scheduler with a worker.
    async fn patiently(
        &self,
        number: usize,
        portion: &RecordBatch,
        progress: &ProgressBar,
    ) -> Result<Vec<RecordBatch>> {
        let Place::Cluster { scheduler, .. } = &self.place else {
            return self.outcomes(self.context.read_batch(portion.clone())?)?.collect().await;
        };
        let attempts = async {
            for pause in &RETRY_PAUSES {
                match self.evaluated(number, portion).await {
                    Ok(batches) => return Ok(batches),
                    Err(e) => progress.suspend(|| {
                        let seconds = pause.as_secs();
                        eprintln!("warning: portion {number}: {}; again in {seconds} s", e.strip_backtrace());
                    }),
                }
                tokio::time::sleep(*pause).await;
            }
            self.evaluated(number, portion).await
        };
        tokio::select! {
            done = attempts => done,
            why = cluster::lost(scheduler) => Err(DataFusionError::Execution(why)),
        }
    }

    async fn evaluated(&self, number: usize, portion: &RecordBatch) -> Result<Vec<RecordBatch>> {
        let rows_per_task = match &self.place {
            Place::Cluster { rows_per_task, .. } => (*rows_per_task).max(1),
            Place::Here => portion.num_rows(),
        };
        let shards = self.shards(number, portion, rows_per_task).await?;
        let urls: Result<Vec<ListingTableUrl>> = shards
            .iter()
            .map(|name| {
                let url = self.pending.join(name).map_err(|e| DataFusionError::External(Box::new(e)))?;
                ListingTableUrl::try_new(url, None)
            })
            .collect();
        let table = parquet_table(urls?, job_list::texts(&PENDING_COLUMNS), PENDING_ENDING)?;
        let batches = self.outcomes(self.context.read_table(table)?)?.collect().await?;
        let rows: usize = batches.iter().map(RecordBatch::num_rows).sum();
        if rows != portion.num_rows() {
            let text = format!("the cluster gave {rows} rows for {}", portion.num_rows());
            return Err(DataFusionError::Execution(text));
        }
        for name in &shards {
            self.writer.store.delete(&self.shard(name)?).await?;
        }
        Ok(batches)
    }

    fn outcomes(&self, rows: DataFrame) -> Result<DataFrame> {
        let function = self.context.udf(self.query.function.name())?;
        let asked = ["key", "uri", "procedure", "limits", "model"].map(col);
        let outcome = self.query.call(&function).alias("outcome");
        rows.select(asked.into_iter().chain([outcome]).collect::<Vec<_>>())
    }

    /// Writes a portion as many small files: a cluster works on as many at a time as there are.
    async fn shards(&self, number: usize, portion: &RecordBatch, rows: usize) -> Result<Vec<String>> {
        let mut names = vec![];
        for (shard, start) in (0..portion.num_rows()).step_by(rows).enumerate() {
            let part = portion.slice(start, rows.min(portion.num_rows() - start));
            let name = format!("{number:06}-{shard:04}{PENDING_ENDING}");
            let path = self.shard(&name)?;
            match put(self.writer.store.as_ref(), &path, parquet(&part, compressed())?).await {
                // It is that of an attempt that failed, with the same rows.
                Err(DataFusionError::ObjectStore(e))
                    if matches!(*e, object_store::Error::AlreadyExists { .. }) => {}
                other => other?,
            }
            names.push(name);
        }
        Ok(names)
    }

    fn shard(&self, name: &str) -> Result<Path> {
        Ok(stores::open(&self.pending)?.1.join(name))
    }

    /// Removes what portions of this run, or of one that died, left. A file that stays does no harm.
    async fn clean(&self) {
        let folder = self.writer.folder.clone().join(PENDING_FOLDER);
        let left = self.writer.store.list(Some(&folder)).map_ok(|f| f.location).boxed();
        let gone = self.writer.store.delete_stream(left).try_collect::<Vec<_>>().await;
        if let (Ok(_), Ok(folder)) =
            (gone, self.pending.join("..").unwrap_or_else(|_| self.pending.clone()).to_file_path())
        {
            let _ = std::fs::remove_dir_all(folder);
        }
    }
}

/// Rows in portions of equal size, the last one smaller.
fn portions(
    rows: SendableRecordBatchStream,
    size: usize,
) -> impl futures::Stream<Item = Result<RecordBatch>> + Send {
    let schema = rows.schema();
    futures::stream::try_unfold((rows, Vec::<RecordBatch>::new()), move |(mut rows, mut held)| {
        let schema = Arc::clone(&schema);
        async move {
            let count = |held: &[RecordBatch]| held.iter().map(RecordBatch::num_rows).sum::<usize>();
            while count(&held) < size {
                match rows.try_next().await? {
                    Some(batch) => held.push(batch),
                    None => break,
                }
            }
            let all = concat_batches(&schema, &held)?;
            if all.num_rows() == 0 {
                return Ok(None);
            }
            let own = size.min(all.num_rows());
            let rest = all.slice(own, all.num_rows() - own);
            Ok(Some((all.slice(0, own), (rows, vec![rest]))))
        }
    })
}
