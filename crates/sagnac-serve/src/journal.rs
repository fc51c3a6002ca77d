//! The journal of the queue: what was ordered and what came of it.
//!
//! A line is appended and synced before an order is answered. What stands in it happened; the last line may be cut by a loss of
//! power, and is left out then.

use crate::order::{End, Order};
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Error, ErrorKind, Result, Seek, SeekFrom, Write};
use std::path::Path;

/// First line of a journal.
const FIRST_LINE: &str = "{\"format\":\"serve-queue/1\"}";

/// A line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Line {
    /// A test was ordered.
    Ordered(Order),
    /// A test has ended.
    Ended {
        /// Its id.
        id: String,
        /// When, RFC 3339.
        at: String,
        /// What came of it.
        end: End,
    },
}

/// The journal, open for further lines.
#[derive(Debug)]
pub struct Journal {
    file: File,
}

impl Journal {
    /// Opens a journal, or begins it; gives its lines.
    ///
    /// # Errors
    /// A file that cannot be read or written, or a line that is none of a journal: the message names it.
    pub fn open(path: &Path) -> Result<(Journal, Vec<Line>)> {
        if path.symlink_metadata().is_ok_and(|m| !m.is_file()) {
            return Err(Error::from(ErrorKind::AlreadyExists));
        }
        let mut file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?;
        let mut lines = vec![];
        let mut whole = 0;
        let mut reader = BufReader::new(&file);
        let mut line = vec![];
        for number in 1.. {
            line.clear();
            let bytes = reader.read_until(b'\n', &mut line)?;
            if line.pop() != Some(b'\n') {
                break;
            }
            if number == 1 {
                if line != FIRST_LINE.as_bytes() {
                    return Err(damaged(number));
                }
            } else {
                lines.push(serde_json::from_slice(&line).map_err(|_| damaged(number))?);
            }
            whole += bytes as u64;
        }
        file.set_len(whole)?;
        file.seek(SeekFrom::End(0))?;
        let mut journal = Journal { file };
        if whole == 0 {
            journal.write(FIRST_LINE.to_owned())?;
        }
        Ok((journal, lines))
    }

    /// Appends a line and waits until it is on the disk.
    ///
    /// # Errors
    /// A disk that is full or gone; the line is not there then.
    pub fn add(&mut self, line: &Line) -> Result<()> {
        self.write(serde_json::to_string(line)?)
    }

    fn write(&mut self, mut line: String) -> Result<()> {
        line.push('\n');
        let before = self.file.stream_position()?;
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
        if written.is_err() {
            // A part of a line would spoil the next one.
            self.file.set_len(before)?;
            self.file.seek(SeekFrom::Start(before))?;
        }
        written
    }
}

fn damaged(line: usize) -> Error {
    Error::new(ErrorKind::InvalidData, format!("line {line} is none of a queue"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(id: &str) -> Line {
        Line::Ended { id: id.to_owned(), at: "2027-03-01T00:00:00Z".to_owned(), end: End::Cancelled }
    }

    #[test]
    fn a_line_that_was_cut_is_left_out_and_a_wrong_one_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("queue.jsonl");
        let (mut journal, lines) = Journal::open(&path).unwrap();
        assert!(lines.is_empty());
        journal.add(&line("a")).unwrap();
        drop(journal);
        let whole = std::fs::read_to_string(&path).unwrap();
        for cut in [1, 20] {
            std::fs::write(&path, &format!("{whole}{whole}").as_bytes()[..whole.len() + cut]).unwrap();
            let (mut journal, lines) = Journal::open(&path).unwrap();
            assert_eq!(lines, [line("a")]);
            journal.add(&line("b")).unwrap();
            assert_eq!(Journal::open(&path).unwrap().1, [line("a"), line("b")]);
        }
        std::fs::write(&path, format!("{whole}no line\n")).unwrap();
        assert_eq!(Journal::open(&path).unwrap_err().to_string(), "line 3 is none of a queue");
        std::fs::write(&path, "a,b\n1,2\n").unwrap();
        assert!(Journal::open(&path).is_err());
    }
}
