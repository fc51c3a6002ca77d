//! Recordings that are uploaded: streamed to a file of a random name, within a size and a quota.

use crate::refusal::Refusal;
use crate::token::random_name;
use axum::extract::multipart::Field;
use axum::http::StatusCode;
use std::io::Result;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use tokio::io::AsyncWriteExt;
use tokio::sync::Semaphore;

/// Folder below the data.
pub const UPLOADS_FOLDER: &str = "uploads";
/// Most uploads at a time.
const MAX_UPLOADS: usize = 4;
/// Longest pause between two parts of an upload.
const MAX_PAUSE: Duration = Duration::from_secs(30);
/// Longest upload: 2 GiB at 5 Mbit/s.
pub const MAX_UPLOAD_TIME: Duration = Duration::from_secs(3600);
/// Random bytes of a name.
const NAME_BYTES: usize = 16;
/// Most characters of an ending.
const MAX_ENDING_CHARACTERS: usize = 8;

/// The uploads of a server.
#[derive(Debug, Clone)]
pub struct Uploads {
    folder: PathBuf,
    max_bytes: u64,
    quota: u64,
    used: Arc<AtomicU64>,
    slots: Arc<Semaphore>,
}

/// A file that was uploaded. It is removed again unless it is kept.
#[derive(Debug)]
pub struct Upload {
    /// Where it lies.
    pub path: PathBuf,
    /// The name that the client gave, only to be shown.
    pub label: String,
    folder: PathBuf,
    bytes: u64,
    used: Arc<AtomicU64>,
    is_kept: bool,
}

impl Upload {
    /// Keeps the file; gives where it lies and its label.
    pub fn keep(mut self) -> (PathBuf, String) {
        self.is_kept = true;
        (self.path.clone(), self.label.clone())
    }

    /// Counts bytes against the quota; false where it is used up.
    fn reserve(&mut self, bytes: u64, quota: u64) -> bool {
        let before = self.used.fetch_add(bytes, Ordering::SeqCst);
        self.bytes += bytes;
        before.saturating_add(bytes) <= quota
    }
}

impl Drop for Upload {
    fn drop(&mut self) {
        if !self.is_kept {
            // It lies in a folder of its own, which this server has made.
            let _ = std::fs::remove_dir_all(&self.folder);
            self.used.fetch_sub(self.bytes, Ordering::SeqCst);
        }
    }
}

impl Uploads {
    /// The uploads below a data folder. Those that no order names are removed by `is_ordered`: their order was never answered.
    ///
    /// # Errors
    /// A folder that cannot be made or read.
    pub fn open(
        data: &Path,
        max_bytes: u64,
        quota: u64,
        is_ordered: impl Fn(&Path) -> bool,
    ) -> Result<Uploads> {
        let folder = data.join(UPLOADS_FOLDER);
        std::fs::create_dir_all(&folder)?;
        let mut used = 0;
        for entry in folder.read_dir()?.flatten() {
            let own = entry.path();
            if !entry.file_type()?.is_dir() {
                continue;
            }
            if !is_ordered(&own) && is_name(&entry.file_name().to_string_lossy()) {
                std::fs::remove_dir_all(&own)?;
                continue;
            }
            for file in own.read_dir()?.flatten() {
                used += file.metadata()?.len();
            }
        }
        let slots = Arc::new(Semaphore::new(MAX_UPLOADS));
        Ok(Uploads { folder, max_bytes, quota, used: Arc::new(AtomicU64::new(used)), slots })
    }

    /// Largest upload, bytes.
    pub fn max_bytes(&self) -> u64 {
        self.max_bytes
    }

    /// Takes a file of a request.
    ///
    /// # Errors
    /// One that is too large or too slow, a quota that is used up, a disk that cannot be written.
    pub async fn take(&self, mut field: Field<'_>) -> std::result::Result<Upload, Refusal> {
        let busy = || Refusal::new(StatusCode::SERVICE_UNAVAILABLE, "too_many_uploads");
        let _slot = self.slots.clone().try_acquire_owned().map_err(|_| busy())?;
        let disk = |e: std::io::Error| {
            let status = match e.kind() {
                std::io::ErrorKind::StorageFull | std::io::ErrorKind::QuotaExceeded => {
                    StatusCode::INSUFFICIENT_STORAGE
                }
                _ => StatusCode::INTERNAL_SERVER_ERROR,
            };
            Refusal::new(status, "not_written")
        };
        let label = field.file_name().unwrap_or_default().to_owned();
        let name = random_name(NAME_BYTES).map_err(|e| disk(e.into()))?;
        let folder = self.folder.join(name);
        tokio::fs::create_dir(&folder).await.map_err(disk)?;
        let path = folder.join(format!("recording{}", ending(&label)));
        let mut upload = Upload {
            path: path.clone(),
            label: crate::refusal::shown(&label),
            folder,
            bytes: 0,
            used: Arc::clone(&self.used),
            is_kept: false,
        };
        let opened = tokio::fs::OpenOptions::new().write(true).create_new(true).open(&path).await;
        let mut file = opened.map_err(disk)?;
        loop {
            let next = tokio::time::timeout(MAX_PAUSE, field.chunk()).await;
            let next = next.map_err(|_| Refusal::new(StatusCode::REQUEST_TIMEOUT, "too_slow"))?;
            let Some(chunk) = next.map_err(|e| malformed(&e))? else { break };
            let is_free = upload.reserve(chunk.len() as u64, self.quota);
            if upload.bytes > self.max_bytes {
                let most = (self.max_bytes >> 20).to_string();
                return Err(Refusal::of(StatusCode::PAYLOAD_TOO_LARGE, "too_large", &most));
            }
            if !is_free {
                return Err(Refusal::new(StatusCode::INSUFFICIENT_STORAGE, "quota"));
            }
            file.write_all(&chunk).await.map_err(disk)?;
        }
        file.sync_all().await.map_err(disk)?;
        Ok(upload)
    }
}

/// A request with several parts that cannot be read.
pub fn malformed(error: &axum::extract::multipart::MultipartError) -> Refusal {
    match error.status() {
        StatusCode::PAYLOAD_TOO_LARGE => Refusal::of(StatusCode::PAYLOAD_TOO_LARGE, "too_large", ""),
        _ => Refusal::new(StatusCode::BAD_REQUEST, "malformed"),
    }
}

/// True for a name that uploads get here.
fn is_name(name: &str) -> bool {
    name.len() == 2 * NAME_BYTES && name.bytes().all(|b| b.is_ascii_hexdigit())
}

/// The ending of a name, from which formats are told: two parts at most, plain letters and digits, as `.csv.gz`.
fn ending(label: &str) -> String {
    let file = label.rsplit(['/', '\\']).next().unwrap_or_default();
    let is_plain = |part: &&str| {
        (1..=MAX_ENDING_CHARACTERS).contains(&part.len()) && part.bytes().all(|b| b.is_ascii_alphanumeric())
    };
    let parts: Vec<&str> = file.split('.').skip(1).collect();
    let mut last: Vec<&str> = parts.into_iter().rev().take_while(is_plain).take(2).collect();
    last.reverse();
    last.into_iter().map(|part| format!(".{}", part.to_ascii_lowercase())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_plain_ending_of_a_name_is_kept() {
        for (label, kept) in [
            ("unit.csv", ".csv"),
            ("unit.CSV.gz", ".csv.gz"),
            ("a.b.csv.gz", ".csv.gz"),
            ("../../etc/cron.d/x", ""),
            ("x.c/sv", ""),
            ("C:\\a\\unit.mcap", ".mcap"),
            ("x.\0", ""),
            ("x.csv\n", ""),
            ("x.waytoolongending", ""),
            ("x.", ""),
            ("", ""),
            ("*.csv", ".csv"),
        ] {
            assert_eq!(ending(label), kept, "{label:?}");
        }
    }

    #[test]
    fn uploads_without_an_order_are_removed_and_others_counted() {
        let data = tempfile::tempdir().unwrap();
        let folder = data.path().join(UPLOADS_FOLDER);
        let [kept, lost] = [1, 2].map(|i| folder.join(format!("{i:032x}")));
        for own in [&kept, &lost, &folder.join("notes")] {
            std::fs::create_dir_all(own).unwrap();
            std::fs::write(own.join("recording.csv"), "12345").unwrap();
        }
        let uploads = Uploads::open(data.path(), 10, 100, |own| own == kept).unwrap();
        // What is no upload is left alone, and counts.
        assert!(kept.is_dir() && !lost.exists() && folder.join("notes").is_dir());
        assert_eq!(uploads.used.load(Ordering::SeqCst), 10);
    }
}
