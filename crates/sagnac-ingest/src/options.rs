//! How a file is to be read, where its user says so and nothing is left to be found out.

use crate::layout::LayoutFile;
use sagnac_core::recording::ColumnRef;
use std::path::PathBuf;

/// How a file is to be read. Whatever is `None` is detected, and a note of the recording says what was detected.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Id of the format, one of [`super::FORMATS`].
    pub format: Option<String>,
    /// How a text file is written.
    pub text: TextOptions,
    /// Part of a container that holds the recording: the path of a dataset or group, the name of a variable, a topic.
    pub part: Option<String>,
    /// Layout of the records of a raw binary file (TOML).
    pub layout: Option<LayoutFile>,
    /// Unit of time stamps, in place of what the file says or what is found from their size.
    pub time_unit: Option<String>,
    /// Which rows are read, where the rows of several sensors take turns.
    pub only: Option<RowMatch>,
    /// First and last row that are read, counted from 1 among those that match.
    pub rows: Option<(u64, u64)>,
    /// Files that were recorded beside it, each with a clock of its own; [`crate::beside`] reads them.
    pub sources: Vec<SecondSource>,
}

/// A file that was recorded beside a recording, with a clock of its own.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SecondSource {
    /// The file.
    pub path: PathBuf,
    /// Files that continue it, in order.
    pub more: Vec<PathBuf>,
    /// Time that is added to its stamps to give those of the recording, s; `None`: both clocks tell the date.
    pub offset_s: Option<f64>,
    /// Relative length of its seconds beyond those of the recording.
    pub rate: f64,
    /// Standard uncertainty of that offset, or of the dates, s.
    pub offset_uncertainty_s: f64,
    /// Offset and rate are estimated from what both files record, in place of the three before.
    pub estimate: bool,
}

impl SecondSource {
    /// Its files, in order.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        std::iter::once(&self.path).chain(&self.more)
    }
}

/// The rows in which a column has a value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RowMatch {
    /// The column.
    pub column: ColumnRef,
    /// The value as it is written.
    pub value: String,
}

impl RowMatch {
    /// Reads `COLUMN=VALUE`.
    pub fn parse(text: &str) -> Option<RowMatch> {
        let (column, value) = text.rsplit_once('=')?;
        let (column, value) = (column.trim(), value.trim());
        let column = column.parse().map_or_else(|_| ColumnRef::Name(column.to_owned()), ColumnRef::Position);
        (column != ColumnRef::Name(String::new()) && !value.is_empty())
            .then(|| RowMatch { column, value: value.to_owned() })
    }
}

/// How a text file is written.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TextOptions {
    /// Character encoding.
    pub encoding: Option<Encoding>,
    /// Separator of fields; a space stands for any run of spaces and tabs.
    pub delimiter: Option<u8>,
    /// Decimal sign, `.` or `,`.
    pub decimal: Option<u8>,
    /// Line that holds the names of the columns, counted from 1; 0: there is none.
    pub header_line: Option<u64>,
    /// First line of data, counted from 1.
    pub first_line: Option<u64>,
    /// Beginning of lines that are comments wherever they stand.
    pub comment: Option<String>,
    /// How the stamps of columns are written.
    pub stamps: Vec<StampOptions>,
}

/// How the stamps of a column are written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StampOptions {
    /// The column.
    pub column: ColumnRef,
    /// How they are written; found from the file where it is left out.
    pub writing: Option<StampWriting>,
    /// Column of the date that belongs to the clock time.
    pub date_column: Option<ColumnRef>,
    /// Column of the GPS week that belongs to the seconds of week.
    pub week_column: Option<ColumnRef>,
}

impl StampOptions {
    /// Name of the column that two columns make together; `None` where the stamps stand in one.
    pub fn joined_name(&self) -> Option<String> {
        let text = |column: &ColumnRef| match column {
            ColumnRef::Name(name) => name.clone(),
            ColumnRef::Position(position) => position.to_string(),
        };
        let first = self.week_column.as_ref().or(self.date_column.as_ref())?;
        Some(format!("{}+{}", text(first), text(&self.column)))
    }
}

/// How stamps are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StampWriting {
    /// Date and time with the year first, ISO 8601 or RFC 3339.
    Iso8601,
    /// Date and time with the day first.
    DayFirst,
    /// Date and time with the month first.
    MonthFirst,
    /// Clock time.
    Clock,
    /// Numbers of seconds of the GPS week.
    GpsWeekSeconds,
    /// Numbers.
    Number,
}

/// A character encoding of text files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// UTF-8, with or without byte-order mark.
    Utf8,
    /// UTF-16, little endian.
    Utf16Le,
    /// UTF-16, big endian.
    Utf16Be,
    /// Windows-1251, Cyrillic.
    Windows1251,
}
