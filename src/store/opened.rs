//! A store in use.

use super::error::{StoreError, io};
use super::folders;
use super::index::{Age, Attempt, Counted, Filter, Index, Journal};
use super::layout::{Layout, is_address, names};
use super::lock::{self, FORGOTTEN_AFTER, Lock, Sharing};
use super::maintenance;
use super::marker::{marker, on_shared_disk};
use super::statement::{self, Statement, What};
use crate::i18n::{Note, note};
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// A store that is open.
#[derive(Debug)]
pub struct Store {
    pub(super) layout: Layout,
    pub(super) index: Index,
    shared_disk: bool,
    read_only: bool,
    notes: Vec<Note>,
    lock: Option<Lock>,
}

impl Store {
    /// Opens a store to add to it. Results that the index lacks because a process was killed are taken up; an index that is missing, or
    /// of an earlier version, is made anew, since the folders are what there is.
    ///
    /// # Errors
    /// [`StoreError`]: no store, a damaged or later index, a disk that cannot be written.
    pub fn open(path: &Path) -> Result<Store, StoreError> {
        let layout = Layout::at(path);
        let marker = marker(&layout)?;
        let shared_disk = marker.shared_disk || lock::is_shared_disk(path);
        let mut notes = vec![];
        let mut lock = lock::take(&layout.lock(), Sharing::Together)?;
        let index = loop {
            match Index::open(&layout.index(), shared_disk) {
                Ok(index) if index.age()? == Age::Current => break index,
                Ok(_) | Err(StoreError::NoIndex(_)) => {
                    // Who makes it anew must have the store alone; the own lock would be in the way.
                    drop(lock);
                    let alone = lock::take(&layout.lock(), Sharing::Alone)?;
                    notes.extend(maintenance::make_current(&layout, shared_disk)?);
                    drop(alone);
                    lock = lock::take(&layout.lock(), Sharing::Together)?;
                }
                Err(e) => return Err(e),
            }
        };
        if index.journal == Journal::Rollback && !marker.shared_disk {
            notes.push(on_shared_disk(&layout));
        }
        let shared_disk = index.journal == Journal::Rollback;
        let mut store = Store { layout, index, shared_disk, read_only: false, notes, lock: Some(lock) };
        store.take_up_pending()?;
        Ok(store)
    }

    /// Opens a store to ask it. Where nothing can be written, it is asked as it is.
    ///
    /// # Errors
    /// As [`Store::open`], but for a disk that cannot be written.
    pub fn open_to_read(path: &Path) -> Result<Store, StoreError> {
        match Store::open(path) {
            Err(StoreError::ReadOnly(_)) => {}
            other => return other,
        }
        let layout = Layout::at(path);
        marker(&layout)?;
        let log = layout.index().with_extension("sqlite-wal");
        let is_settled = fs::metadata(&log).map_or(true, |m| m.len() == 0);
        let opened = if is_settled { Index::open_to_read(&layout.index()).map(Some) } else { Ok(None) };
        let index = match opened {
            Ok(Some(index)) => index,
            // What stands in the log cannot be had without writing, and no index can be made: the folders tell it.
            Ok(None) | Err(StoreError::NoIndex(_) | StoreError::EarlierIndex { .. }) => {
                folders::index_in_memory(&layout)?
            }
            Err(e) => return Err(e),
        };
        let notes = vec![note!("store.read_only", path = path.display().to_string())];
        Ok(Store { layout, index, shared_disk: false, read_only: true, notes, lock: None })
    }

    /// Opens a store to check it: an index that is missing is an error, not made anew in passing.
    ///
    /// # Errors
    /// [`StoreError::NoIndex`], and as [`Store::open_to_read`].
    pub fn open_to_verify(path: &Path) -> Result<Store, StoreError> {
        let layout = Layout::at(path);
        marker(&layout)?;
        if layout.index().symlink_metadata().is_err() {
            return Err(StoreError::NoIndex(layout.index()));
        }
        Store::open_to_read(path)
    }

    /// Where everything stands.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// What must be known of the store.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// The results that a filter lets through, the earliest first.
    ///
    /// # Errors
    /// What the index refuses.
    pub fn attempts(&self, filter: &Filter) -> Result<Vec<Attempt>, StoreError> {
        self.index.attempts(filter)
    }

    /// Addresses of the results that a filter lets through and that count, the earliest first.
    ///
    /// # Errors
    /// What the index refuses.
    pub fn addresses(&self, filter: &Filter) -> Result<Counted, StoreError> {
        self.index.counted(filter)
    }

    /// The one result whose address begins with a text.
    ///
    /// # Errors
    /// [`StoreError::Address`] where there is none or more than one.
    pub fn result(&self, beginning: &str) -> Result<Attempt, StoreError> {
        let mut found = self.index.by_address(beginning)?;
        match found.pop() {
            Some(one) if found.is_empty() && !beginning.is_empty() => Ok(one),
            last => {
                let count = found.len() + usize::from(last.is_some());
                Err(StoreError::Address { given: beginning.to_owned(), count })
            }
        }
    }

    /// Where a recording is: its copy in the store, where it was evaluated, then where it was found later.
    ///
    /// # Errors
    /// What the index refuses, or a folder that cannot be read.
    pub fn places(&self, sha256: &str) -> Result<Vec<String>, StoreError> {
        let folder = self.layout.recordings().join(sha256);
        let copies = self.layout.copies(sha256)?.into_iter().map(|n| folder.join(n).display().to_string());
        Ok(copies.chain(self.index.places(sha256)?).collect())
    }

    /// States that a result supersedes another, and why. Both stay.
    ///
    /// # Errors
    /// [`StoreError::Circle`] where the other one counts in its place already, and what the disk refuses.
    pub fn supersede(
        &mut self,
        superseded: &str,
        by: &str,
        reason: &str,
        operator: &str,
        stated_at: String,
    ) -> Result<(), StoreError> {
        // Two corrections that are stated at the same time could close a circle that neither sees.
        let _turn = self.take_turn()?;
        let (superseded, by) = (self.result(superseded)?.address, self.result(by)?.address);
        let corrections = self.index.corrections()?;
        if leads_to(&corrections, &by, &superseded) {
            return Err(StoreError::Circle { address: superseded });
        }
        let (reason, operator) = (reason.to_owned(), operator.to_owned());
        self.state(What::Correction { superseded, by, reason, operator }, stated_at)
    }

    /// Waits for the turn to decide something that another process must not decide meanwhile.
    pub(super) fn take_turn(&self) -> Result<Lock, StoreError> {
        self.writable()?;
        lock::take(&self.layout.turn(), Sharing::Alone)
    }

    /// Writes a statement and its row.
    pub(super) fn state(&mut self, what: What, stated_at: String) -> Result<(), StoreError> {
        self.writable()?;
        let statement = Statement::new(what, stated_at);
        let (hash, bytes) = statement.bytes(&self.layout)?;
        let pending = self.begin_pending(&hash)?;
        statement::write(&self.layout, &hash, &bytes)?;
        self.with_index(|index| index.add_statement(&hash, &statement))?;
        pending.end();
        Ok(())
    }

    /// Refuses a store that cannot be written.
    pub(super) fn writable(&self) -> Result<(), StoreError> {
        if self.read_only { Err(StoreError::ReadOnly(self.layout.root().to_owned())) } else { Ok(()) }
    }

    /// Changes the index. Where its users share no memory, it is changed by one of them at a time.
    pub(super) fn with_index<T>(
        &mut self,
        change: impl FnOnce(&mut Index) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        if !self.shared_disk {
            return change(&mut self.index);
        }
        // The own lock is held together with others: it must go before the store is had alone.
        self.lock = None;
        let alone = lock::take(&self.layout.lock(), Sharing::Alone)?;
        // Another may have put a new index in its place meanwhile.
        self.index = Index::open(&self.layout.index(), self.shared_disk)?;
        let done = change(&mut self.index);
        drop(alone);
        self.lock = Some(lock::take(&self.layout.lock(), Sharing::Together)?);
        done
    }

    /// Lists something as pending: it is about to appear in the store, and its rows after that.
    pub(super) fn begin_pending(&self, hash: &str) -> Result<Pending, StoreError> {
        let path = self.layout.pending().join(hash);
        let made = File::create(&path).and_then(|f| f.sync_all());
        made.map_err(io("output_error.create", &path))?;
        Ok(Pending(path))
    }

    /// Adds the rows of what appeared and whose process was killed before it could. What cannot be read is left for
    /// `verify` to name.
    fn take_up_pending(&mut self) -> Result<(), StoreError> {
        for hash in names(&self.layout.pending())?.into_iter().filter(|n| is_address(n)) {
            let pending = Pending(self.layout.pending().join(&hash));
            if self.layout.result(&hash).is_dir() {
                let Ok(entry) = folders::entry_at(&self.layout, &hash) else { continue };
                self.with_index(|index| index.add(&hash, &entry))?;
                pending.end();
            } else if let Some(statement) = statement::at(&self.layout, &hash) {
                self.with_index(|index| index.add_statement(&hash, &statement))?;
                pending.end();
            } else if pending.is_old() {
                pending.end();
            }
        }
        Ok(())
    }
}

/// True where corrections lead from a result to another one, or where both are the same.
pub(super) fn leads_to(corrections: &[(String, String)], from: &str, to: &str) -> bool {
    let mut seen = BTreeSet::from([from]);
    let mut open = vec![from];
    while let Some(next) = open.pop() {
        if next == to {
            return true;
        }
        let by = corrections.iter().filter(|(superseded, _)| superseded == next).map(|(_, by)| by.as_str());
        open.extend(by.filter(|by| seen.insert(by)));
    }
    false
}

/// Something that is about to appear in the store.
#[derive(Debug)]
pub(super) struct Pending(PathBuf);

impl Pending {
    /// Its rows are in the index. Another process may have taken it off the list already.
    pub fn end(self) {
        let _ = fs::remove_file(self.0);
    }

    fn is_old(&self) -> bool {
        let modified = self.0.metadata().and_then(|m| m.modified()).ok();
        let age = modified.and_then(|m| SystemTime::now().duration_since(m).ok());
        age.is_some_and(|age| age > FORGOTTEN_AFTER)
    }
}
