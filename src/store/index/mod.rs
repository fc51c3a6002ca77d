//! The index of a store: a database that holds nothing which the folders do not.

mod order;
mod query;
mod schema;
mod write;

pub(super) use query::StatementRow;
pub use query::{Attempt, Correction, Counted, Filter};

use super::error::{StoreError, io};
use super::lock::LOCK_TIMEOUT;
use rusqlite::{Connection, OpenFlags};
use sagnac_ingest::open_file;
use schema::{APPLICATION_ID, SCHEMA_VERSION, TABLE_STATEMENTS};
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// How the database keeps its transactions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Journal {
    /// In a write-ahead log: readers and a writer do not wait for each other.
    Wal,
    /// In a rollback journal, where the users of the disk share no memory.
    Rollback,
}

/// An open index.
#[derive(Debug)]
pub(super) struct Index {
    path: PathBuf,
    db: Connection,
    /// How it keeps its transactions.
    pub journal: Journal,
}

/// Treatment of an index before it is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Age {
    /// Nothing.
    Current,
    /// It is of this earlier version.
    Earlier(i64),
}

impl Index {
    /// Opens an index for reading and writing.
    ///
    /// # Errors
    /// [`StoreError::NoIndex`], [`StoreError::DamagedIndex`], [`StoreError::LaterIndex`] and what the database refuses.
    pub fn open(path: &Path, shared_disk: bool) -> Result<Index, StoreError> {
        whole(path)?;
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let db = Connection::open_with_flags(path, flags).map_err(|e| StoreError::of_database(path, &e))?;
        let mut index = Index { path: path.to_owned(), db, journal: Journal::Rollback };
        index.age()?;
        index.journal = index.prepare(shared_disk)?;
        Ok(index)
    }

    /// Opens an index that cannot be written.
    ///
    /// # Errors
    /// As [`Index::open`], and [`StoreError::EarlierIndex`].
    pub fn open_to_read(path: &Path) -> Result<Index, StoreError> {
        whole(path)?;
        let refused = |e: rusqlite::Error| StoreError::of_database(path, &e);
        // Nobody can write, so the database needs neither locks nor a place for its log.
        let uri = format!("file:{}?immutable=1", escaped(path));
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI;
        let db = Connection::open_with_flags(uri, flags).map_err(refused)?;
        let index = Index { path: path.to_owned(), db, journal: Journal::Rollback };
        match index.age()? {
            Age::Current => Ok(index),
            Age::Earlier(found) => Err(StoreError::EarlierIndex { path: path.to_owned(), found }),
        }
    }

    /// A new index with nothing in it; a file of its name must not exist.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn create(path: &Path, shared_disk: bool) -> Result<Index, StoreError> {
        let refused = |e: rusqlite::Error| StoreError::of_database(path, &e);
        let db = Connection::open(path).map_err(refused)?;
        db.pragma_update(None, "application_id", APPLICATION_ID).map_err(refused)?;
        let mut index = Index { path: path.to_owned(), db, journal: Journal::Rollback };
        index.make_tables()?;
        index.journal = index.prepare(shared_disk)?;
        Ok(index)
    }

    /// An index in memory.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn in_memory(name: &Path) -> Result<Index, StoreError> {
        let db = Connection::open_in_memory().map_err(|e| StoreError::of_database(name, &e))?;
        let mut index = Index { path: name.to_owned(), db, journal: Journal::Rollback };
        index.make_tables()?;
        Ok(index)
    }

    /// Ends the use of the index; what its log holds goes into the file.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn close(self) -> Result<(), StoreError> {
        let path = self.path;
        self.db.close().map_err(|(_, e)| StoreError::of_database(&path, &e))
    }

    /// Whether the index is of this version.
    ///
    /// # Errors
    /// [`StoreError::LaterIndex`] for a later one, [`StoreError::ForeignIndex`] for what is no index.
    pub fn age(&self) -> Result<Age, StoreError> {
        let number = |name: &str| -> Result<i64, StoreError> {
            self.db.pragma_query_value(None, name, |row| row.get(0)).map_err(|e| self.refused(&e))
        };
        if number("application_id")? != APPLICATION_ID {
            return Err(StoreError::ForeignIndex(self.path.clone()));
        }
        match number("user_version")? {
            SCHEMA_VERSION => Ok(Age::Current),
            found if found > SCHEMA_VERSION => {
                Err(StoreError::LaterIndex { path: self.path.clone(), found, known: SCHEMA_VERSION })
            }
            found => Ok(Age::Earlier(found)),
        }
    }

    /// Makes the tables of an empty database.
    fn make_tables(&mut self) -> Result<(), StoreError> {
        let path = self.path.clone();
        let refused = |e: rusqlite::Error| StoreError::of_database(&path, &e);
        let change = self.db.transaction().map_err(refused)?;
        change.execute_batch(TABLE_STATEMENTS).map_err(refused)?;
        change.pragma_update(None, "user_version", SCHEMA_VERSION).map_err(refused)?;
        change.commit().map_err(refused)
    }

    /// Ends the use of an index that is to be replaced: its log goes into the file, so that it is not taken for that of another.
    ///
    /// # Errors
    /// What the database refuses.
    pub fn settle(self) -> Result<(), StoreError> {
        let kept =
            self.db.pragma_update_and_check(None, "journal_mode", "DELETE", |row| row.get::<_, String>(0));
        kept.map_err(|e| self.refused(&e))?;
        self.close()
    }

    /// Puts a copy of the index beside it, by the version that it has.
    ///
    /// # Errors
    /// What the database or the disk refuses.
    pub fn back_up(&self, version: i64) -> Result<(), StoreError> {
        let copy = self.path.with_extension(format!("sqlite.version-{version}"));
        if copy.exists() {
            fs::remove_file(&copy).map_err(io("output_error.write", &copy))?;
        }
        let copied = self.db.execute("VACUUM INTO ?1", [copy.display().to_string()]);
        copied.map(|_| ()).map_err(|e| self.refused(&e))
    }

    /// Sets how the database behaves on this connection.
    fn prepare(&self, shared_disk: bool) -> Result<Journal, StoreError> {
        let refused = |e: rusqlite::Error| self.refused(&e);
        self.db.busy_timeout(LOCK_TIMEOUT).map_err(refused)?;
        self.db.pragma_update(None, "foreign_keys", true).map_err(refused)?;
        let wanted = if shared_disk { "DELETE" } else { "WAL" };
        let mode: String = self
            .db
            .pragma_update_and_check(None, "journal_mode", wanted, |row| row.get(0))
            .map_err(refused)?;
        // A result is taken off the list of pending ones when its row is on the disk, not before.
        self.db.pragma_update(None, "synchronous", "FULL").map_err(refused)?;
        Ok(if mode.eq_ignore_ascii_case("wal") { Journal::Wal } else { Journal::Rollback })
    }

    fn refused(&self, error: &rusqlite::Error) -> StoreError {
        StoreError::of_database(&self.path, error)
    }

    /// Reads the whole database for damage.
    ///
    /// # Errors
    /// [`StoreError::DamagedIndex`].
    pub fn check(&self) -> Result<(), StoreError> {
        let said: String = self
            .db
            .pragma_query_value(None, "integrity_check", |row| row.get(0))
            .map_err(|e| self.refused(&e))?;
        match said.as_str() {
            "ok" => Ok(()),
            _ => Err(StoreError::DamagedIndex { path: self.path.clone(), reason: said }),
        }
    }
}

/// Refuses a database that is missing, or shorter than its header says: the pages that a query reads may all be there.
fn whole(path: &Path) -> Result<(), StoreError> {
    let log = path.with_extension("sqlite-wal");
    // While a log is put into the database, its header may be ahead of its length. A log that is gone was put in meanwhile.
    let mut size = Size::of(path)?;
    if size.is_short() && fs::metadata(&log).is_ok_and(|m| m.len() > 0) {
        return Ok(());
    }
    if size.is_short() {
        size = Size::of(path)?;
    }
    match size {
        Size { length, stated: Some(stated) } if length >= stated => Ok(()),
        Size { length, stated } => {
            let reason = match stated {
                Some(stated) => format!("{length} bytes of {stated}"),
                None => format!("{length} bytes"),
            };
            Err(StoreError::DamagedIndex { path: path.to_owned(), reason })
        }
    }
}

/// How large a database is, in bytes.
struct Size {
    length: u64,
    /// By its header; `None` where it has none.
    stated: Option<u64>,
}

impl Size {
    fn of(path: &Path) -> Result<Size, StoreError> {
        let mut file = match open_file(path) {
            Ok(file) => file,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
                return Err(StoreError::NoIndex(path.to_owned()));
            }
            Err(e) => return Err(io("store_error.unreadable", path)(e)),
        };
        let length = file.metadata().map_err(io("store_error.unreadable", path))?.len();
        let mut head = [0_u8; 100];
        let stated = file.read_exact(&mut head).ok().map(|()| {
            // Section 1.3 of the description of the file format of SQLite.
            let pages = u64::from(u32::from_be_bytes([head[28], head[29], head[30], head[31]]));
            let size = match u16::from_be_bytes([head[16], head[17]]) {
                1 => 65536,
                size => u64::from(size),
            };
            pages * size
        });
        Ok(Size { length, stated })
    }

    fn is_short(&self) -> bool {
        self.stated.is_none_or(|stated| self.length < stated)
    }
}

/// A path as part of a URI.
fn escaped(path: &Path) -> String {
    let text = path.display().to_string();
    text.bytes()
        .map(|b| {
            if b.is_ascii_alphanumeric() || b"/._-~".contains(&b) {
                char::from(b).to_string()
            } else {
                format!("%{b:02X}")
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_earlier_index_is_copied_before_it_is_changed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("index.sqlite");
        Index::create(&path, false).unwrap().close().unwrap();
        let index = Index::open(&path, false).unwrap();
        assert_eq!((index.age().unwrap(), index.journal), (Age::Current, Journal::Wal));
        index.back_up(1).unwrap();
        let copy = folder.path().join("index.sqlite.version-1");
        assert_eq!(Index::open(&copy, true).unwrap().journal, Journal::Rollback);
        // A copy of an attempt that did not succeed gives way.
        index.back_up(1).unwrap();
    }

    #[test]
    fn what_is_no_index_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("index.sqlite");
        assert!(matches!(Index::open(&path, false), Err(StoreError::NoIndex(_))));
        fs::write(&path, [b'x'; 5000]).unwrap();
        assert!(matches!(Index::open(&path, false), Err(StoreError::DamagedIndex { .. })));
        fs::remove_file(&path).unwrap();
        Connection::open(&path).unwrap().execute_batch("CREATE TABLE a (b)").unwrap();
        let refused = Index::open(&path, false).unwrap_err();
        assert!(matches!(refused, StoreError::ForeignIndex(_)), "{refused:?}");
    }
}
