//! Options that say how a recording is to be read.

use super::place::for_shell;
use super::source::SourceArgs;
use crate::config::recording_keys::{
    DECIMAL_WORDS, DELIMITER_WORDS, ENCODING_WORDS, decimal, delimiter, encoding, rows,
};
use crate::ingest::layout::LayoutFile;
use crate::ingest::{ReadOptions, RowMatch, TextOptions};
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::path::{Path, PathBuf};

/// Decisions of the user about the file; the rest is detected, and the report says as what.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "How the recording is read")]
pub struct ReadArgs {
    /// File format [default: detected from the content]
    #[arg(long = "input-format", value_name = "ID")]
    input_format: Option<String>,
    /// Character encoding of a text file [default: detected]
    #[arg(long, value_parser = PossibleValuesParser::new(words(ENCODING_WORDS)))]
    encoding: Option<String>,
    /// Field delimiter of a text file [default: detected]
    #[arg(long, value_parser = PossibleValuesParser::new(words(DELIMITER_WORDS)))]
    delimiter: Option<String>,
    /// Decimal mark of a text file [default: detected]
    #[arg(long, value_parser = PossibleValuesParser::new(words(DECIMAL_WORDS)))]
    decimal: Option<String>,
    /// Line with the column names of a text file, counted from 1; 0: none
    #[arg(long, value_name = "LINE")]
    header_line: Option<u64>,
    /// First data line of a text file, counted from 1
    #[arg(long, value_name = "LINE")]
    first_line: Option<u64>,
    /// Part of a container that holds the recording: a dataset, a variable, a topic
    #[arg(long, value_name = "NAME")]
    part: Option<String>,
    /// Record layout of a raw binary file (TOML)
    #[arg(long, value_name = "FILE")]
    layout: Option<PathBuf>,
    /// Unit of the timestamps [default: from the name, or from size and step]
    #[arg(long, value_name = "UNIT")]
    time_unit: Option<String>,
    /// Only the rows in which a column has this value, where several sensors share a table
    #[arg(id = "where", long = "where", value_name = "COLUMN=VALUE", value_parser = row_match)]
    only: Option<String>,
    /// First and last row to read, counted from 1 [default: all]
    #[arg(long, value_name = "FIRST-LAST", value_parser = row_range)]
    rows: Option<String>,
    #[command(flatten)]
    sources: SourceArgs,
}

/// A text that names a column and a value.
fn row_match(text: &str) -> Result<String, String> {
    RowMatch::parse(text).map(|_| text.to_owned()).ok_or_else(|| "COLUMN=VALUE".to_owned())
}

/// A text that names two rows.
fn row_range(text: &str) -> Result<String, String> {
    rows(text).map(|_| text.to_owned()).ok_or_else(|| "FIRST-LAST".to_owned())
}

fn words(list: &'static [(&'static str, &'static str)]) -> impl Iterator<Item = &'static str> {
    list.iter().map(|(word, _)| *word)
}

impl ReadArgs {
    /// The options as they are typed, each behind a space.
    pub fn as_typed(&self) -> String {
        let mut typed = String::new();
        let mut add = |option: &str, value: &str| typed.push_str(&format!(" {option} {}", for_shell(value)));
        let texts = [
            ("--input-format", &self.input_format),
            ("--encoding", &self.encoding),
            ("--delimiter", &self.delimiter),
            ("--decimal", &self.decimal),
            ("--part", &self.part),
            ("--time-unit", &self.time_unit),
            ("--where", &self.only),
            ("--rows", &self.rows),
        ];
        for (option, value) in texts {
            if let Some(value) = value {
                add(option, value);
            }
        }
        for (option, value) in [("--header-line", self.header_line), ("--first-line", self.first_line)] {
            if let Some(line) = value {
                add(option, &line.to_string());
            }
        }
        if let Some(path) = &self.layout {
            add("--layout", &path.display().to_string());
        }
        typed + &self.sources.as_typed()
    }

    /// The decisions as keys of the table `recording` of a procedure, without the layout: names and TOML values.
    pub fn keys(&self) -> Vec<(&'static str, toml::Value)> {
        let texts = [
            ("format", &self.input_format),
            ("encoding", &self.encoding),
            ("delimiter", &self.delimiter),
            ("decimal", &self.decimal),
            ("part", &self.part),
            ("where", &self.only),
            ("rows", &self.rows),
        ];
        let texts = texts.into_iter().filter_map(|(key, v)| Some((key, toml::Value::String(v.clone()?))));
        let lines = [("header_line", self.header_line), ("first_line", self.first_line)];
        let lines = lines
            .into_iter()
            .filter_map(|(key, v)| Some((key, toml::Value::Integer(i64::try_from(v?).unwrap_or(i64::MAX)))));
        texts.chain(lines).collect()
    }

    /// The layout of a raw binary file.
    pub fn layout(&self) -> Option<&Path> {
        self.layout.as_deref()
    }

    /// The decisions.
    pub fn options(&self) -> ReadOptions {
        ReadOptions {
            format: self.input_format.clone(),
            text: TextOptions {
                encoding: self.encoding.as_deref().and_then(encoding),
                delimiter: self.delimiter.as_deref().and_then(delimiter),
                decimal: self.decimal.as_deref().and_then(decimal),
                header_line: self.header_line,
                first_line: self.first_line,
                ..TextOptions::default()
            },
            part: self.part.clone(),
            layout: self.layout.clone().map(LayoutFile::at),
            time_unit: self.time_unit.clone(),
            only: self.only.as_deref().and_then(RowMatch::parse),
            rows: self.rows.as_deref().and_then(rows),
            sources: self.sources.sources(),
        }
    }
}
