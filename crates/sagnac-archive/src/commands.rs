//! The commands of the program and their options.

use clap::{Args, Subcommand};
use datafusion::arrow::csv::WriterBuilder;
use datafusion::arrow::util::pretty::pretty_format_batches;
use datafusion::common::DataFusionError;
use datafusion::prelude::{SessionConfig, SessionContext};
use indicatif::{ProgressBar, ProgressStyle};
use sagnac_archive::cluster::{self, Worker};
use sagnac_archive::job::{Job, beside};
use sagnac_archive::job_list::{self, Listing};
use sagnac_archive::run::{self, Order, Place, Report};
use sagnac_archive::{results, session, stores};
use std::io::{IsTerminal, Write};
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Every recording has a result.
const ALL_DONE: u8 = 0;
/// Some recordings have an error instead.
const WITH_ERRORS: u8 = 1;
/// The command could not be carried out.
pub const COMMAND_FAILED: u8 = 2;
/// Recordings that could not be reached and are named one by one.
const MAX_NAMED_RECORDINGS: usize = 20;
/// Stack of a thread that plans queries, bytes: plans are trees that are walked by recursion.
const STACK_BYTES: usize = 16 << 20;

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Write the recordings below a folder as a job list
    List(ListArgs),
    /// Evaluate what is left of a job list
    Run(RunArgs),
    /// Query results, as table `results`, and a job list, as table `jobs`
    Query(QueryArgs),
    /// Serve as the scheduler of a cluster
    Scheduler(SchedulerArgs),
    /// Serve as a worker of a cluster
    Worker(WorkerArgs),
}

#[derive(Debug, Args)]
pub struct ListArgs {
    /// Folder of the recordings: a path, or s3://bucket/folder
    folder: String,
    /// Folder for the shards of the list
    #[arg(long, value_name = "DIR")]
    out: String,
    /// Procedure of every recording
    #[arg(long, value_name = "FILE")]
    procedure: Option<String>,
    /// Limits of every recording
    #[arg(long, value_name = "FILE")]
    limits: Option<String>,
    /// Model of every recording
    #[arg(long, value_name = "FILE")]
    model: Option<String>,
    /// Endings of recordings, separated by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = FILE_ENDINGS)]
    endings: Vec<String>,
    /// Recordings of a shard
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    rows: usize,
}

const FILE_ENDINGS: &str = "csv,csv.gz,csv.zst,tsv,txt,dat,parquet,mcap,bag,h5,hdf5,npy,npz,mat,tdms";

#[derive(Debug, Args)]
pub struct RunArgs {
    /// A query such as "SELECT sagnac_run(uri, procedure, limits, unit) FROM jobs WHERE ...", or a job file (TOML)
    #[arg(value_name = "SQL|JOB.TOML")]
    what: String,
    /// Folder of the job list, or one of its shards; of a job file, its own `jobs`
    #[arg(long, value_name = "DIR", default_value = "jobs")]
    jobs: String,
    /// Folder of the results [default: the one of the job file]
    #[arg(long, value_name = "DIR")]
    out: Option<String>,
    /// Scheduler of a cluster, such as df://host:50050; without it the recordings are evaluated in this process
    #[arg(long, value_name = "URL")]
    scheduler: Option<String>,
    /// Recordings that are written together; a stopped run loses those under way
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = positive)]
    portion: usize,
    /// Recordings that a worker of a cluster gets at a time
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = positive)]
    rows_per_task: usize,
    /// Recordings that this process evaluates at a time [default: cores of this machine]
    #[arg(long, value_name = "N", value_parser = positive)]
    cores: Option<usize>,
    /// Time of evaluation that results state, RFC 3339 [default: now]
    #[arg(long, value_name = "TIME")]
    at: Option<String>,
}

fn positive(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|n| *n > 0).ok_or_else(|| "expected a whole number above 0".to_owned())
}

#[derive(Debug, Args)]
pub struct QueryArgs {
    /// A query over `results` and `jobs`
    sql: String,
    /// Folder of the results
    #[arg(long, value_name = "DIR", default_value = "results")]
    results: String,
    /// Folder of a job list
    #[arg(long, value_name = "DIR")]
    jobs: Option<String>,
    /// Print CSV instead of a table
    #[arg(long)]
    csv: bool,
}

#[derive(Debug, Args)]
pub struct SchedulerArgs {
    /// Address and port to listen at
    #[arg(long, value_name = "IP:PORT", default_value_t = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 50050))]
    bind: SocketAddr,
    /// Name by which workers and clients reach this machine
    #[arg(long, value_name = "HOST", default_value = "localhost")]
    host: String,
}

#[derive(Debug, Args)]
pub struct WorkerArgs {
    /// Scheduler to work for
    #[arg(long, value_name = "HOST:PORT", default_value = "localhost:50050")]
    scheduler: String,
    /// Address to listen at
    #[arg(long, value_name = "IP", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    bind: IpAddr,
    /// Name by which clients and other workers reach this machine
    #[arg(long, value_name = "HOST", default_value = "localhost")]
    host: String,
    /// Port for results
    #[arg(long, value_name = "PORT", default_value_t = 50051)]
    port: u16,
    /// Port for the scheduler
    #[arg(long, value_name = "PORT", default_value_t = 50052)]
    grpc_port: u16,
    /// Recordings that are evaluated at a time [default: cores of this machine]
    #[arg(long, value_name = "N", value_parser = positive)]
    cores: Option<usize>,
    /// Memory for queries, MiB; evaluations take their own, see the page
    #[arg(long, value_name = "MIB", default_value_t = 1024)]
    memory: u64,
    /// Folder for results that are not fetched yet [default: a temporary one]
    #[arg(long, value_name = "DIR")]
    work: Option<PathBuf>,
}

/// Carries out a command and gives the exit code.
///
/// # Errors
/// The problem, and what to do.
pub fn execute(command: Command) -> Result<u8, String> {
    let mut runtime = tokio::runtime::Builder::new_multi_thread();
    let runtime = runtime.enable_all().thread_stack_size(STACK_BYTES).build().map_err(|e| e.to_string())?;
    runtime.block_on(async {
        match command {
            Command::List(args) => list(args).await,
            Command::Run(args) => run(args).await,
            Command::Query(args) => query(args).await,
            Command::Scheduler(args) => {
                let served = cluster::scheduler(args.bind, &args.host).await;
                served.map(|()| ALL_DONE).map_err(|e| format!("scheduler at {}: {e}", args.bind))
            }
            Command::Worker(args) => worker(args).await,
        }
    })
}

fn sentence(e: DataFusionError) -> String {
    e.strip_backtrace()
}

/// A file that every machine is to find: by its whole path, or by its address.
fn everywhere(named: Option<String>) -> Result<Option<String>, String> {
    let whole = |named: String| {
        if named.contains("://") {
            return Ok(named);
        }
        let path = std::path::absolute(&named).map_err(|e| format!("{named}: {e}"))?;
        if !path.is_file() {
            return Err(format!(
                "{named}: there is no such file; name a procedure, limits or model that exists"
            ));
        }
        Ok(path.display().to_string())
    };
    named.map(whole).transpose()
}

async fn list(args: ListArgs) -> Result<u8, String> {
    let folder = stores::folder(&args.folder)?;
    if let Ok(path) = folder.to_file_path()
        && !path.is_dir()
    {
        return Err(format!("{}: there is no such folder; name one of recordings", args.folder));
    }
    let listing = Listing {
        folder,
        endings: args.endings.iter().map(|e| e.trim_start_matches('.').to_lowercase()).collect(),
        procedure: everywhere(args.procedure)?,
        limits: everywhere(args.limits)?,
        model: everywhere(args.model)?,
        rows: args.rows,
    };
    let out = stores::folder(&args.out)?;
    let found = job_list::list(&listing, &out).await.map_err(sentence)?;
    if found == 0 {
        let endings = listing.endings.join(", ");
        return Err(format!("{}: no recording with an ending of {endings}; see --endings", args.folder));
    }
    say(format_args!("{found} recordings listed in {}\n", args.out))?;
    Ok(ALL_DONE)
}

/// The query, and what a job file says beside it.
struct What {
    sql: String,
    jobs: String,
    out: Option<String>,
    scheduler: Option<String>,
}

fn what(args: &RunArgs) -> Result<What, String> {
    if !args.what.ends_with(".toml") {
        return Ok(What { sql: args.what.clone(), jobs: args.jobs.clone(), out: None, scheduler: None });
    }
    let path = std::path::absolute(&args.what).map_err(|e| format!("{}: {e}", args.what))?;
    let text = std::fs::read_to_string(&path)
        .map_err(|e| format!("{}: {e}; name a job file, or a query", args.what))?;
    let job = Job::read(&text, &args.what)?;
    let base = path.parent().unwrap_or(Path::new(""));
    Ok(What {
        sql: job.sql(base),
        jobs: beside(base, &job.jobs),
        out: job.out.as_deref().map(|out| beside(base, out)),
        scheduler: job.scheduler,
    })
}

async fn run(args: RunArgs) -> Result<u8, String> {
    let what = what(&args)?;
    let out = args.out.or(what.out).ok_or("no folder for the results; name one with --out")?;
    if let Some(cores) = args.cores {
        threads(cores)?;
    }
    let jobs = if what.jobs.ends_with(".parquet") {
        stores::address(&what.jobs)?
    } else {
        stores::folder(&what.jobs)?
    };
    if let Ok(path) = jobs.to_file_path()
        && !path.exists()
    {
        return Err(format!("{}: there is no such job list; `sagnac-archive list` writes one", what.jobs));
    }
    let order = Order {
        jobs,
        sql: what.sql,
        out: stores::folder(&out)?,
        place: match args.scheduler.or(what.scheduler) {
            Some(scheduler) => Place::Cluster { scheduler, rows_per_task: args.rows_per_task },
            None => Place::Here,
        },
        portion: args.portion,
        at: time(args.at)?,
    };
    let progress = bar();
    let report = run::run(&order, &progress).await;
    progress.finish_and_clear();
    told(&report?, &out)
}

/// Writes to standard output. What does not reach a disk that is full was not said; a reader that went away is no error.
fn say(text: std::fmt::Arguments<'_>) -> Result<(), String> {
    let mut out = std::io::stdout().lock();
    match out.write_fmt(text).and_then(|()| out.flush()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(format!("standard output: {e}")),
        _ => Ok(()),
    }
}

fn time(given: Option<String>) -> Result<String, String> {
    let Some(given) = given else {
        return Ok(sagnac::moment::now().to_rfc3339_opts(chrono::SecondsFormat::Secs, true));
    };
    match chrono::DateTime::parse_from_rfc3339(&given) {
        Ok(_) => Ok(given),
        Err(e) => Err(format!("--at {given}: {e}; expected RFC 3339, such as 2026-05-04T10:00:00Z")),
    }
}

fn threads(cores: usize) -> Result<(), String> {
    rayon::ThreadPoolBuilder::new().num_threads(cores).build_global().map_err(|e| e.to_string())
}

fn bar() -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} recordings, {per_sec}, {eta} left")
    {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(500));
    bar
}

/// Says what a run did; gives the exit code.
fn told(report: &Report, out: &str) -> Result<u8, String> {
    let counts = report.counts;
    for text in report.unreached.iter().take(MAX_NAMED_RECORDINGS) {
        eprintln!("warning: {text}");
    }
    say(format_args!(
        "{} recordings: {} results, {} errors kept as data, {} out of reach; {out}\n",
        report.pending, counts.results, counts.errors, counts.unreached
    ))?;
    if counts.unreached > 0 {
        say(format_args!("The same command tries again what was out of reach.\n"))?;
    }
    Ok(if counts.errors + counts.unreached > 0 { WITH_ERRORS } else { ALL_DONE })
}

async fn query(args: QueryArgs) -> Result<u8, String> {
    let context = SessionContext::new_with_state(session::state(SessionConfig::new()).map_err(sentence)?);
    let table = results::table(stores::folder(&args.results)?).map_err(sentence)?;
    context.register_table("results", table).map_err(sentence)?;
    if let Some(jobs) = &args.jobs {
        let table = job_list::table(stores::folder(jobs)?).map_err(sentence)?;
        context.register_table("jobs", table).map_err(sentence)?;
    }
    let rows = context.sql(&args.sql).await.map_err(sentence)?;
    let batches = rows.collect().await.map_err(sentence)?;
    if args.csv {
        let mut table = vec![];
        let mut writer = WriterBuilder::new().build(&mut table);
        for batch in &batches {
            writer.write(batch).map_err(|e| format!("{e}; choose members of lists and structs by name"))?;
        }
        drop(writer);
        say(format_args!("{}", String::from_utf8_lossy(&table)))?;
    } else {
        say(format_args!("{}\n", pretty_format_batches(&batches).map_err(|e| e.to_string())?))?;
    }
    Ok(ALL_DONE)
}

async fn worker(args: WorkerArgs) -> Result<u8, String> {
    let expected = || format!("--scheduler {}: expected HOST:PORT, such as machine1:50050", args.scheduler);
    let (host, port) = args.scheduler.rsplit_once(':').ok_or_else(expected)?;
    let port = port.parse().map_err(|_| expected())?;
    let cores = args.cores.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    threads(cores)?;
    let served = cluster::worker(Worker {
        scheduler_host: host.to_owned(),
        scheduler_port: port,
        bind_host: args.bind.to_string(),
        external_host: args.host,
        port: args.port,
        grpc_port: args.grpc_port,
        cores,
        memory_bytes: args.memory << 20,
        work_dir: args.work.map(|w| w.display().to_string()),
    });
    served.await.map(|()| ALL_DONE).map_err(|e| format!("worker for {}: {e}", args.scheduler))
}
