//! How a file is to be read, where its user says so and nothing is left to be found out.

use std::path::PathBuf;

/// Decisions about a file that were made for it; what is `None` is found from the file, and the finding is told.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Id of the format, one of [`super::FORMATS`].
    pub format: Option<String>,
    /// How a text file is written.
    pub text: TextOptions,
    /// Part of a container that holds the recording: the path of a dataset or group, the name of a variable, a topic.
    pub part: Option<String>,
    /// Layout of the records of a raw binary file (TOML).
    pub layout: Option<PathBuf>,
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
