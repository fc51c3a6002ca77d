//! Files and s3-compatible object stores by their address.

use crate::outcome::{Failure, FailureKind};
use datafusion::common::{DataFusionError, Result};
use datafusion::execution::object_store::ObjectStoreRegistry;
use object_store::RetryConfig;
use object_store::aws::AmazonS3Builder;
use object_store::local::LocalFileSystem;
use object_store::{ObjectStore, ObjectStoreExt};
use std::collections::HashMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;
use tempfile::TempDir;
use url::Url;

/// Stores by address: `file://` and `s3://`. A bucket is opened when it is first asked for, with what the environment says
/// (`AWS_ACCESS_KEY_ID`, `AWS_SECRET_ACCESS_KEY`, `AWS_REGION`, `AWS_ENDPOINT`, `AWS_ALLOW_HTTP`): a worker cannot know beforehand
/// which buckets a job names.
#[derive(Debug, Default)]
pub struct Stores {
    buckets: Mutex<HashMap<String, Arc<dyn ObjectStore>>>,
}

impl ObjectStoreRegistry for Stores {
    fn register_store(&self, url: &Url, store: Arc<dyn ObjectStore>) -> Option<Arc<dyn ObjectStore>> {
        self.buckets.lock().unwrap_or_else(PoisonError::into_inner).insert(place(url), store)
    }

    fn get_store(&self, url: &Url) -> Result<Arc<dyn ObjectStore>> {
        let mut buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(store) = buckets.get(&place(url)) {
            return Ok(store.clone());
        }
        let store: Arc<dyn ObjectStore> = match (url.scheme(), url.host_str()) {
            ("file", _) => Arc::new(LocalFileSystem::new()),
            ("s3", Some(bucket)) => {
                let builder = AmazonS3Builder::from_env().with_bucket_name(bucket);
                Arc::new(builder.with_retry(retries()).build()?)
            }
            _ => {
                let known = "give a path, file:// or s3://bucket/path";
                return Err(DataFusionError::Configuration(format!("{url}: unknown address; {known}")));
            }
        };
        buckets.insert(place(url), store.clone());
        Ok(store)
    }
}

/// A request is repeated for some seconds; an evaluation whose recording stays out of reach is repeated as a whole.
fn retries() -> RetryConfig {
    RetryConfig { max_retries: 5, retry_timeout: Duration::from_secs(30), ..RetryConfig::default() }
}

fn place(url: &Url) -> String {
    format!("{}://{}", url.scheme(), url.host_str().unwrap_or_default())
}

/// The stores of this process.
pub fn stores() -> &'static Arc<Stores> {
    static SHARED_STORES: OnceLock<Arc<Stores>> = OnceLock::new();
    SHARED_STORES.get_or_init(Arc::default)
}

/// The address of what a user names: a path, or a URL as it stands.
///
/// # Errors
/// A sentence when it is neither.
pub fn address(named: &str) -> std::result::Result<Url, String> {
    if named.contains("://") {
        return Url::parse(named).map_err(|e| format!("{named}: {e}; give a path or s3://bucket/path"));
    }
    let path = std::path::absolute(named).map_err(|e| format!("{named}: {e}"))?;
    let url = if named.ends_with('/') { Url::from_directory_path(path) } else { Url::from_file_path(path) };
    url.map_err(|()| format!("{named}: no address can be made of this path"))
}

/// The address of a folder: it ends with a slash.
///
/// # Errors
/// As [`address`].
pub fn folder(named: &str) -> std::result::Result<Url, String> {
    address(&format!("{}/", named.trim_end_matches('/')))
}

/// The store of an address, and the path of it there.
///
/// # Errors
/// When the address is of no known kind, or the environment lacks what the store needs.
pub fn open(url: &Url) -> Result<(Arc<dyn ObjectStore>, object_store::path::Path)> {
    let store = stores().get_store(url)?;
    let path = object_store::path::Path::from_url_path(url.path())
        .map_err(|e| DataFusionError::Configuration(format!("{url}: {e}")))?;
    Ok((store, path))
}

/// A file that can be read by path: one of this machine, or a copy that is removed with this value.
pub struct Fetched {
    path: PathBuf,
    copy: Option<TempDir>,
}

impl Fetched {
    /// Where it can be read.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// True for a copy.
    pub fn is_copy(&self) -> bool {
        self.copy.is_some()
    }
}

/// Makes a file readable by path. An object is downloaded under its own name, since the name tells the format.
///
/// # Errors
/// [`FailureKind::Missing`] when there is none, [`FailureKind::Access`] when it cannot be reached.
pub fn fetch(named: &str) -> std::result::Result<Fetched, Failure> {
    if !named.contains("://") {
        return local(PathBuf::from(named), named);
    }
    let url = address(named).map_err(|e| Failure::new(FailureKind::Argument, e))?;
    match url.scheme() {
        "file" => match url.to_file_path() {
            Ok(path) => local(path, named),
            Err(()) => Err(Failure::new(FailureKind::Argument, format!("{named}: no path of this machine"))),
        },
        _ => waited(download(url)),
    }
}

/// A path of this machine, once it can be read: what is not there is another matter than what is out of reach.
fn local(path: PathBuf, named: &str) -> std::result::Result<Fetched, Failure> {
    match std::fs::File::open(&path) {
        Ok(_) => Ok(Fetched { path, copy: None }),
        Err(e) => Err(unreachable(named, &e)),
    }
}

fn unreachable(named: &str, e: &std::io::Error) -> Failure {
    let missing = matches!(e.kind(), std::io::ErrorKind::NotFound | std::io::ErrorKind::NotADirectory);
    Failure::new(if missing { FailureKind::Missing } else { FailureKind::Access }, format!("{named}: {e}"))
}

/// A runtime of its own: evaluations wait for downloads on threads that are no part of DataFusion's runtime.
fn downloads() -> std::result::Result<&'static tokio::runtime::Runtime, Failure> {
    static DOWNLOAD_RUNTIME: OnceLock<std::io::Result<tokio::runtime::Runtime>> = OnceLock::new();
    let runtime = DOWNLOAD_RUNTIME
        .get_or_init(|| tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build());
    runtime.as_ref().map_err(|e| Failure::new(FailureKind::Access, format!("no thread for downloads: {e}")))
}

/// Waits for a download on any thread: one of DataFusion's may not wait for a future itself.
fn waited(
    download: impl Future<Output = std::result::Result<Fetched, Failure>> + Send + 'static,
) -> std::result::Result<Fetched, Failure> {
    let (done, answer) = std::sync::mpsc::sync_channel(1);
    downloads()?.spawn(async move {
        // Nobody waits any more only when the process ends.
        let _ = done.send(download.await);
    });
    answer
        .recv()
        .unwrap_or_else(|e| Err(Failure::new(FailureKind::Program, format!("a download broke off: {e}"))))
}

async fn download(url: Url) -> std::result::Result<Fetched, Failure> {
    use futures::StreamExt;
    let access = |e: &dyn std::fmt::Display| Failure::new(FailureKind::Access, format!("{url}: {e}"));
    let (store, path) = open(&url).map_err(|e| Failure::new(FailureKind::Argument, e.to_string()))?;
    let found = store.get(&path).await.map_err(|e| match e {
        object_store::Error::NotFound { .. } => {
            Failure::new(FailureKind::Missing, format!("{url}: there is no such object"))
        }
        other => access(&other),
    })?;
    let folder = TempDir::with_prefix("sagnac-archive-").map_err(|e| access(&e))?;
    let copy = folder.path().join(path.filename().unwrap_or("recording"));
    let mut file = std::fs::File::create_new(&copy).map_err(|e| access(&e))?;
    let mut bytes = found.into_stream();
    while let Some(part) = bytes.next().await {
        file.write_all(&part.map_err(|e| access(&e))?).map_err(|e| access(&e))?;
    }
    Ok(Fetched { path: copy, copy: Some(folder) })
}
