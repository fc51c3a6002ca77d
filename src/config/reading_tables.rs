//! The keys by which procedures and manifests say how a file is to be read.

use super::read_words::{DECIMALS, DELIMITERS, ENCODINGS};
use crate::config::spec::{KeySpec, Kind, Range, optional};

pub(crate) const FORMAT: KeySpec =
    optional("format", Kind::Text, "\"csv\"", "Id of the file format; detected if omitted.");

pub(crate) const ENCODING: KeySpec = optional(
    "encoding",
    Kind::Choice(ENCODINGS),
    "\"windows-1251\"",
    "Character encoding of a text file; detected if omitted.",
);

pub(crate) const DELIMITER: KeySpec = optional(
    "delimiter",
    Kind::Choice(DELIMITERS),
    "\"semicolon\"",
    "Field delimiter of a text file; detected if omitted.",
);

pub(crate) const DECIMAL: KeySpec = optional(
    "decimal",
    Kind::Choice(DECIMALS),
    "\"comma\"",
    "Decimal mark of a text file; detected if omitted.",
);

pub(crate) const HEADER_LINE: KeySpec = optional(
    "header_line",
    Kind::Number(Range::between(0.0, 1e6)),
    "4",
    "Line with the column names of a text file, counted from 1; 0: none; detected if omitted.",
);

pub(crate) const FIRST_LINE: KeySpec = optional(
    "first_line",
    Kind::Number(Range::between(1.0, 1e6)),
    "6",
    "First data line of a text file, counted from 1; detected if omitted.",
);

pub(crate) const COMMENT: KeySpec = optional(
    "comment",
    Kind::Text,
    "\"#\"",
    "Start of comment lines of a text file. Default: `#`, `%`, `//`, and `;` where it is not the delimiter.",
);

pub(crate) const PART: KeySpec = optional(
    "part",
    Kind::Text,
    "\"/imu/gyro\"",
    "Part of a container that holds the recording: a dataset, a variable, a topic.",
);
