//! A server from its start to its end.

use crate::catalogue::Catalogue;
use crate::guard::Hosts;
use crate::harness::Harness;
use crate::listener;
use crate::pages::templates;
use crate::queue::Queue;
use crate::recordings::Roots;
use crate::routes::{App, router};
use crate::setup::Setup;
use crate::token::Token;
use crate::uploads::{UPLOADS_FOLDER, Uploads};
use crate::worker::{self, Bench, RESULTS_FOLDER, RUNNING_FOLDER};
use std::fs::File;
use std::io::Error;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;
use thiserror::Error;
use tokio::runtime::Runtime;
use tokio::sync::Semaphore;

/// File that a server holds: one a data folder.
const SERVER_LOCK: &str = "server.lock";
/// File of the queue.
const QUEUE_FILE: &str = "queue.jsonl";
/// Folder of recordings below the data.
const RECORDINGS_FOLDER: &str = "recordings";
/// Folder of own procedures and limits below the data.
const PROCEDURES_FOLDER: &str = "procedures";
/// Threads that answer requests. Tests have their own.
const ANSWERING_THREADS: usize = 2;
/// Most streams of events at a time.
const MAX_STREAMS: usize = 32;
/// Time for answers under way at the end.
const END_PATIENCE: Duration = Duration::from_millis(500);

/// Why a server does not start.
#[derive(Debug, Error)]
pub enum StartError {
    /// It would run with all rights.
    #[error("the server would run with all rights")]
    Root,
    /// It would be reached from elsewhere without encryption.
    #[error("{0} is reached from elsewhere without encryption")]
    Exposed(SocketAddr),
    /// A file or folder cannot be used.
    #[error("{0}: {1}")]
    File(PathBuf, #[source] Error),
    /// Another server has the data folder.
    #[error("another server has {0}")]
    Taken(PathBuf),
    /// The address cannot be listened at.
    #[error("{0}: {1}")]
    Address(SocketAddr, #[source] Error),
    /// The system gives no threads or no random numbers.
    #[error("{0}")]
    System(#[source] Error),
}

/// A server that runs.
pub struct Server {
    bench: Arc<Bench>,
    runtime: Runtime,
    workers: Vec<JoinHandle<()>>,
    url: String,
    secret: String,
    waiting: usize,
    _lock: File,
}

impl Server {
    /// Starts a server: the rules on where it may listen first, then its data, then its connections.
    ///
    /// # Errors
    /// What does not allow it.
    pub fn start(setup: Setup, harness: Box<dyn Harness>) -> Result<Server, StartError> {
        if is_root() && !setup.allow_root {
            return Err(StartError::Root);
        }
        let address = setup.listen.address;
        if !address.ip().is_loopback() && setup.listen.behind_proxy.is_none() {
            return Err(StartError::Exposed(address));
        }
        let setup = data_folder(setup)?;
        let lock = lock(&setup.data)?;
        let recordings = folders(&setup.data, RECORDINGS_FOLDER, &setup.recordings)?;
        let own = folders(&setup.data, PROCEDURES_FOLDER, &setup.procedures)?;
        for name in [RESULTS_FOLDER, RUNNING_FOLDER] {
            make(&setup.data.join(name))?;
        }
        let path = setup.data.join(QUEUE_FILE);
        let queue = Queue::open(&path).map_err(|e| StartError::File(path, e))?;
        let is_ordered =
            |folder: &Path| queue.read(|mut jobs| jobs.any(|job| job.order.test.path.starts_with(folder)));
        let uploads = Uploads::open(&setup.data, setup.max_upload, setup.upload_quota, is_ordered)
            .map_err(|e| StartError::File(setup.data.join(UPLOADS_FOLDER), e))?;
        let token = Token::new().map_err(|e| StartError::System(e.into()))?;
        let (rules, shipped) = (setup.rules.clone(), setup.shipped.clone());
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(ANSWERING_THREADS)
            .enable_all()
            .build()
            .map_err(StartError::System)?;
        let listener = runtime.block_on(tokio::net::TcpListener::bind(address));
        let listener = listener.map_err(|e| StartError::Address(address, e))?;
        let bound = listener.local_addr().map_err(|e| StartError::Address(address, e))?;
        let url = match &setup.listen.behind_proxy {
            Some(public) => public.origin(),
            None => format!("http://{bound}"),
        };
        let hosts = Hosts::new(&setup.listen, bound);
        let bench = Arc::new(Bench { setup, queue, harness });
        let waiting = bench.queue.list(usize::MAX, |job| job.state.is_active()).len();
        let secret = token.reveal().to_owned();
        let app = Arc::new(App {
            bench: Arc::clone(&bench),
            token,
            hosts,
            recordings,
            catalogue: Catalogue { shipped, own, rules },
            uploads,
            templates: templates(),
            streams: Arc::new(Semaphore::new(MAX_STREAMS)),
            charts: Semaphore::new(1),
        });
        let workers = worker::start(&bench).map_err(StartError::System)?;
        runtime.spawn(listener::serve(listener, router(&app)));
        Ok(Server { bench, runtime, workers, url, secret, waiting, _lock: lock })
    }

    /// The address, without the secret.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// The address by which a browser signs in.
    pub fn sign_in_url(&self) -> String {
        format!("{}/#token={}", self.url, self.secret)
    }

    /// Tests that an earlier server left.
    pub fn waiting(&self) -> usize {
        self.waiting
    }

    /// Ends: tests that run are ended and made again at the next start.
    pub fn stop(self) {
        self.bench.queue.stop();
        self.runtime.shutdown_timeout(END_PATIENCE);
        for worker in self.workers {
            // One that panicked has nothing left to do.
            let _ = worker.join();
        }
    }
}

/// True where the server has all rights.
fn is_root() -> bool {
    #[cfg(unix)]
    return rustix::process::geteuid().is_root();
    #[cfg(not(unix))]
    return false;
}

/// The setup with its data folder as it really lies. A new one is the user's own.
fn data_folder(mut setup: Setup) -> Result<Setup, StartError> {
    if !setup.data.is_dir() {
        let mut builder = std::fs::DirBuilder::new();
        builder.recursive(true);
        #[cfg(unix)]
        std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
        builder.create(&setup.data).map_err(|e| StartError::File(setup.data.clone(), e))?;
    }
    setup.data = setup.data.canonicalize().map_err(|e| StartError::File(setup.data.clone(), e))?;
    Ok(setup)
}

fn make(folder: &Path) -> Result<(), StartError> {
    std::fs::create_dir_all(folder).map_err(|e| StartError::File(folder.to_owned(), e))
}

fn folders(data: &Path, own: &str, others: &[PathBuf]) -> Result<Roots, StartError> {
    let own = data.join(own);
    make(&own)?;
    let all: Vec<PathBuf> = std::iter::once(own).chain(others.iter().cloned()).collect();
    Roots::new(&all).map_err(|(path, e)| StartError::File(path, e))
}

fn lock(data: &Path) -> Result<File, StartError> {
    let path = data.join(SERVER_LOCK);
    match worker::take(&path) {
        Ok(Some(lock)) => Ok(lock),
        Ok(None) => Err(StartError::Taken(data.to_owned())),
        Err(e) => Err(StartError::File(path, e)),
    }
}
