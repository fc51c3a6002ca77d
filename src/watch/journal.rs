//! The journal of a folder of results: which tests were made, which recordings were the same as others, who was told.
//!
//! A line is appended and synced before the next test begins. What stands in it happened; the last line may be cut by a loss of
//! power, and is left out then: its test is found by its result.

use super::folder::Stamp;
use crate::i18n::{Note, io_reason, note};
use crate::record::{DayTest, HookState};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// First line of a journal.
const FIRST_LINE: &str = "{\"format\":\"watch-journal/1\"}";

/// A line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Line {
    /// A recording was tested.
    Tested(Box<Tested>),
    /// A recording has the contents of one that was tested.
    Same(Seen),
    /// The hook command was told of a test.
    Told {
        /// Id of the test.
        id: String,
    },
}

/// A test that was made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tested {
    /// Day by UTC.
    pub day: String,
    /// Pattern of the rule.
    pub rule: String,
    /// The recording as it was seen.
    pub seen: Seen,
    /// The test.
    pub test: DayTest,
}

/// A recording as it was seen, so that it need not be read again.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seen {
    /// Path below the watched folder.
    pub name: String,
    /// Size, bytes.
    pub bytes: u64,
    /// Time of change, ns since 1970.
    pub modified_ns: u64,
    /// Digest of what it is tested by.
    pub by: String,
    /// Id of its test.
    pub id: String,
}

impl Seen {
    /// A recording as it is seen now.
    pub fn new(name: &str, stamp: Stamp, by: &str, id: &str) -> Seen {
        Seen {
            name: name.to_owned(),
            bytes: stamp.bytes,
            modified_ns: stamp.modified_ns(),
            by: by.to_owned(),
            id: id.to_owned(),
        }
    }
}

/// The journal, of which the tests of one day are kept in memory.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    ids: BTreeSet<String>,
    seen: BTreeMap<String, Seen>,
    pending: BTreeMap<String, Tested>,
    day: String,
    tests: Vec<DayTest>,
}

impl Journal {
    /// Opens a journal, or begins it; the tests of `day` are kept.
    ///
    /// # Errors
    /// A note on a file that cannot be read or written, or a line that is none of a journal.
    pub fn open(path: &Path, day: &str) -> Result<Journal, Note> {
        let failed = |e: std::io::Error| refused(path, &e);
        if path.symlink_metadata().is_ok_and(|m| !m.is_file()) {
            return Err(note!("watch.journal_no_file", path = path.display().to_string()));
        }
        let opened = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path);
        let file = opened.map_err(failed)?;
        let mut journal = Journal {
            path: path.to_owned(),
            file,
            ids: BTreeSet::new(),
            seen: BTreeMap::new(),
            pending: BTreeMap::new(),
            day: day.to_owned(),
            tests: vec![],
        };
        let whole = journal.read_back()?;
        journal.file.set_len(whole).map_err(failed)?;
        journal.file.seek(SeekFrom::End(0)).map_err(failed)?;
        if whole == 0 {
            journal.write(FIRST_LINE)?;
        }
        Ok(journal)
    }

    /// Reads every whole line; gives their bytes.
    fn read_back(&mut self) -> Result<u64, Note> {
        let path = self.path.clone();
        let failed = |e: std::io::Error| refused(&path, &e);
        let mut lines = BufReader::new(self.file.try_clone().map_err(failed)?);
        let (mut whole, mut number, mut text) = (0, 0_u64, vec![]);
        loop {
            text.clear();
            let n = lines.read_until(b'\n', &mut text).map_err(failed)?;
            if !text.ends_with(b"\n") {
                break;
            }
            number += 1;
            let line = text.strip_suffix(b"\n").unwrap_or_default();
            let parsed = if number == 1 { None } else { serde_json::from_slice::<Line>(line).ok() };
            match parsed {
                Some(line) => self.enter(line),
                None if number == 1 && line == FIRST_LINE.as_bytes() => {}
                None => {
                    let path = path.display().to_string();
                    return Err(note!("watch.journal_damaged", path, line = number));
                }
            }
            whole += n as u64;
        }
        Ok(whole)
    }

    fn enter(&mut self, line: Line) {
        match line {
            Line::Tested(tested) => {
                self.ids.insert(tested.test.id.clone());
                self.seen.insert(tested.seen.name.clone(), tested.seen.clone());
                if tested.test.hook == HookState::Pending {
                    self.pending.insert(tested.test.id.clone(), (*tested).clone());
                }
                if tested.day == self.day {
                    self.tests.push(tested.test);
                }
            }
            Line::Same(seen) => {
                self.seen.insert(seen.name.clone(), seen);
            }
            Line::Told { id } => {
                self.pending.remove(&id);
                for test in self.tests.iter_mut().filter(|t| t.id == id) {
                    test.hook = HookState::Told;
                }
            }
        }
    }

    fn write(&mut self, line: &str) -> Result<(), Note> {
        let written = self.file.write_all(format!("{line}\n").as_bytes()).and_then(|()| self.file.sync_all());
        written.map_err(|e| refused(&self.path, &e))
    }

    fn add(&mut self, line: Line) -> Result<(), Note> {
        let text = serde_json::to_string(&line).map_err(|e| refused(&self.path, &e.into()))?;
        self.write(&text)?;
        self.enter(line);
        Ok(())
    }

    /// Enters a test.
    ///
    /// # Errors
    /// A note where the line cannot be written.
    pub fn tested(&mut self, tested: Tested) -> Result<(), Note> {
        self.add(Line::Tested(Box::new(tested)))
    }

    /// Enters a recording whose contents were tested before.
    ///
    /// # Errors
    /// As [`Journal::tested`].
    pub fn same(&mut self, seen: Seen) -> Result<(), Note> {
        self.add(Line::Same(seen))
    }

    /// Enters that the hook command was told of a test.
    ///
    /// # Errors
    /// As [`Journal::tested`].
    pub fn told(&mut self, id: &str) -> Result<(), Note> {
        self.add(Line::Told { id: id.to_owned() })
    }

    /// True where a test was made.
    pub fn has(&self, id: &str) -> bool {
        self.ids.contains(id)
    }

    /// True where a recording is as it was when it was entered, and was tested by the same.
    pub fn knows(&self, name: &str, stamp: Stamp, by: &str) -> bool {
        self.seen
            .get(name)
            .is_some_and(|s| s.by == by && s.bytes == stamp.bytes && s.modified_ns == stamp.modified_ns())
    }

    /// The tests of which the hook command is still to be told.
    pub fn pending(&self) -> Vec<Tested> {
        self.pending.values().cloned().collect()
    }

    /// The tests of a day; those of another one are forgotten.
    pub fn tests_of(&mut self, day: &str) -> &[DayTest] {
        if self.day != day {
            day.clone_into(&mut self.day);
            self.tests.clear();
        }
        &self.tests
    }
}

fn refused(path: &Path, error: &std::io::Error) -> Note {
    note!("watch.journal", path = path.display().to_string(), reason = io_reason(error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::SystemTime;

    const STAMP: Stamp = Stamp { bytes: 3, modified: SystemTime::UNIX_EPOCH };

    #[test]
    fn a_line_that_was_cut_is_left_out_and_a_wrong_one_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("j");
        let mut journal = Journal::open(&path, "2027-03-01").unwrap();
        journal.same(Seen::new("a.csv", STAMP, "by", "id")).unwrap();
        drop(journal);
        let whole = std::fs::read_to_string(&path).unwrap();
        for cut in [1, 20] {
            std::fs::write(&path, &format!("{whole}{whole}").as_bytes()[..whole.len() + cut]).unwrap();
            let journal = Journal::open(&path, "2027-03-01").unwrap();
            assert!(journal.knows("a.csv", STAMP, "by") && !journal.knows("a.csv", STAMP, "other"));
            assert!(!journal.knows("a.csv", Stamp { bytes: 4, ..STAMP }, "by"));
            assert_eq!(std::fs::read_to_string(&path).unwrap(), whole);
        }
        std::fs::write(&path, format!("{whole}no line\n")).unwrap();
        let error = Journal::open(&path, "2027-03-01").unwrap_err();
        assert_eq!((error.id.as_ref(), &error.args["line"]), ("watch.journal_damaged", &3_u64.into()));
        std::fs::write(&path, "a,b\n1,2\n").unwrap();
        assert!(Journal::open(&path, "2027-03-01").is_err());
    }
}
