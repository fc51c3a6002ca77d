//! Parts of a recording: files that appear whole or not at all, each with rows of at most the length of a part.
//!
//! Rows wait in memory. A part is written under another name, synced and renamed; whatever ends the program, the parts that are
//! there are complete, and at most one part is lost.

use std::collections::VecDeque;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{Result, Write};
use std::path::{Path, PathBuf};

/// Writes a file that appears whole or not at all, and replaces one that is there.
///
/// # Errors
/// A disk that is full or gone.
pub(crate) fn write_whole(folder: &Path, name: &str, contents: &[u8]) -> Result<()> {
    let partial = folder.join(format!(".{name}.partial"));
    let mut file = File::create(&partial)?;
    file.write_all(contents)?;
    file.sync_all()?;
    fs::rename(&partial, folder.join(name))?;
    // A folder cannot be synced everywhere; the rename is complete all the same.
    #[cfg(unix)]
    File::open(folder)?.sync_all()?;
    Ok(())
}

/// A row: when it was, and its fields.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    /// By the clock of the recording, ns.
    pub at_ns: i64,
    /// By the clock of the device, s.
    pub device_s: Option<f64>,
    /// Values of the columns.
    pub values: Vec<Option<f64>>,
}

/// The parts of a device.
#[derive(Debug)]
pub(crate) struct Parts {
    folder: PathBuf,
    id: String,
    header: String,
    has_clock: bool,
    length_ns: i64,
    rows: VecDeque<Row>,
    /// Parts that were written.
    pub written: usize,
    /// Rows that were written.
    pub rows_written: u64,
    /// The latest row that was taken.
    pub latest: Option<Row>,
}

impl Parts {
    /// Parts of a device in a folder, with the names of its columns; `has_clock`: the device tells its own time.
    pub fn new(folder: &Path, id: &str, columns: &[String], has_clock: bool, length_ns: i64) -> Parts {
        let mut header = if has_clock { "time_s,device_time_s" } else { "time_s" }.to_owned();
        for column in columns {
            header.push(',');
            header.push_str(column);
        }
        Parts {
            folder: folder.to_owned(),
            id: id.to_owned(),
            header,
            has_clock,
            length_ns,
            rows: VecDeque::new(),
            written: 0,
            rows_written: 0,
            latest: None,
        }
    }

    /// Pattern of the names of the files.
    pub fn pattern(&self) -> String {
        format!("{}-*.csv", self.id)
    }

    /// Takes a row. One that is not later than the one before is told by `false` and left out.
    pub fn push(&mut self, row: Row) -> bool {
        if self.latest.as_ref().is_some_and(|latest| row.at_ns <= latest.at_ns) {
            return false;
        }
        self.latest = Some(row.clone());
        self.rows.push_back(row);
        true
    }

    /// Forgets rows before a time but for the last of them.
    pub fn begin(&mut self, at_ns: i64) {
        while self.rows.get(1).is_some_and(|next| next.at_ns <= at_ns) {
            self.rows.pop_front();
        }
    }

    /// Forgets rows before a time.
    pub fn begin_at(&mut self, at_ns: i64) {
        self.rows.retain(|row| row.at_ns >= at_ns);
    }

    /// Writes the rows up to a time; those behind it wait. Times in the files are seconds after `zero_ns`.
    ///
    /// # Errors
    /// A disk that is full or gone, with the file.
    pub fn write(&mut self, to_ns: i64, zero_ns: i64) -> std::result::Result<(), (PathBuf, std::io::Error)> {
        while let Some(first) = self.rows.front().map(|row| row.at_ns).filter(|first| *first <= to_ns) {
            let belongs = |row: &&Row| row.at_ns <= to_ns && row.at_ns - first <= self.length_ns;
            let count = self.rows.iter().take_while(belongs).count();
            let mut text = format!("{}\n", self.header);
            for row in self.rows.iter().take(count) {
                line(&mut text, row, self.has_clock, zero_ns);
            }
            let name = format!("{}-{:06}.csv", self.id, self.written + 1);
            write_whole(&self.folder, &name, text.as_bytes()).map_err(|e| (self.folder.join(&name), e))?;
            self.rows.drain(..count);
            self.written += 1;
            self.rows_written += count as u64;
        }
        Ok(())
    }
}

/// A row as a line.
fn line(text: &mut String, row: &Row, has_clock: bool, zero_ns: i64) {
    // Whole nanoseconds: a difference of floating-point numbers would not show them. Writing to a text cannot fail.
    let since = row.at_ns - zero_ns;
    let sign = if since < 0 { "-" } else { "" };
    let (whole, rest) = (since.unsigned_abs() / 1_000_000_000, since.unsigned_abs() % 1_000_000_000);
    let _ = write!(text, "{sign}{whole}.{rest:09}");
    for value in Some(&row.device_s).filter(|_| has_clock).into_iter().chain(&row.values) {
        text.push(',');
        if let Some(value) = value {
            let _ = write!(text, "{value}");
        }
    }
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(at_s: f64, value: f64) -> Row {
        Row { at_ns: (at_s * 1e9) as i64, device_s: None, values: vec![Some(value), None] }
    }

    #[test]
    fn rows_up_to_a_time_become_parts_of_the_length_and_the_others_wait() {
        let folder = tempfile::tempdir().unwrap();
        let columns = ["a".to_owned(), "b [V]".to_owned()];
        let mut parts = Parts::new(folder.path(), "gyro", &columns, true, 2_000_000_000);
        for i in 0..6 {
            assert!(parts.push(row(f64::from(i), 0.5)));
        }
        assert!(!parts.push(row(5.0, 1.0)) && !parts.push(row(4.5, 1.0)));
        parts.write(4_000_000_000, 1_000_000_000).unwrap();
        let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
        let head = "time_s,device_time_s,a,b [V]\n";
        assert_eq!(
            read("gyro-000001.csv"),
            format!("{head}-1.000000000,,0.5,\n0.000000000,,0.5,\n1.000000000,,0.5,\n")
        );
        assert_eq!(read("gyro-000002.csv"), format!("{head}2.000000000,,0.5,\n3.000000000,,0.5,\n"));
        assert_eq!((parts.written, parts.rows_written), (2, 5));
        parts.write(i64::MAX, 0).unwrap();
        assert_eq!(read("gyro-000003.csv"), format!("{head}5.000000000,,0.5,\n"));
        let names: Vec<String> = fs::read_dir(folder.path())
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .filter(|name| name.starts_with('.'))
            .collect();
        assert_eq!(names, Vec::<String>::new());
    }

    #[test]
    fn a_recording_begins_with_the_last_row_before_it_of_what_is_interpolated() {
        let folder = tempfile::tempdir().unwrap();
        let mut parts = Parts::new(folder.path(), "table", &[], false, 1);
        (0..5).for_each(|i| assert!(parts.push(row(f64::from(i), 0.0))));
        parts.begin(2_500_000_000);
        assert_eq!(parts.rows.front().map(|r| r.at_ns), Some(2_000_000_000));
        parts.begin_at(3_500_000_000);
        assert_eq!(parts.rows.front().map(|r| r.at_ns), Some(4_000_000_000));
    }

    #[test]
    fn a_disk_that_is_gone_is_told_with_the_file() {
        let mut parts = Parts::new(Path::new("/nonexistent/folder"), "gyro", &[], false, 1);
        parts.push(row(0.0, 0.0));
        let (path, _) = parts.write(1, 0).unwrap_err();
        assert!(path.ends_with("gyro-000001.csv"));
    }
}
