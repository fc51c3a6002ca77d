//! The keys by which procedures and manifests say how a file is to be read.

use super::read_words::{DECIMALS, DELIMITERS, ENCODINGS};
use crate::config::spec::{KeySpec, Kind, Range, optional};

pub(crate) const FORMAT: KeySpec =
    optional("format", Kind::Text, "\"csv\"", "Id of the file format; left out: found by the content.");

pub(crate) const ENCODING: KeySpec = optional(
    "encoding",
    Kind::Choice(ENCODINGS),
    "\"windows-1251\"",
    "Character encoding of a text file; left out: found from its bytes.",
);

pub(crate) const DELIMITER: KeySpec = optional(
    "delimiter",
    Kind::Choice(DELIMITERS),
    "\"semicolon\"",
    "Separator of the fields of a text file; left out: found from its lines.",
);

pub(crate) const DECIMAL: KeySpec = optional(
    "decimal",
    Kind::Choice(DECIMALS),
    "\"comma\"",
    "Decimal sign of a text file; left out: found from its numbers.",
);

pub(crate) const HEADER_LINE: KeySpec = optional(
    "header_line",
    Kind::Number(Range::between(0.0, 1e6)),
    "4",
    "Line that names the columns of a text file, counted from 1; 0: there is none; left out: found.",
);

pub(crate) const FIRST_LINE: KeySpec = optional(
    "first_line",
    Kind::Number(Range::between(1.0, 1e6)),
    "6",
    "First line of data of a text file, counted from 1; left out: found.",
);

pub(crate) const COMMENT: KeySpec = optional(
    "comment",
    Kind::Text,
    "\"#\"",
    "Beginning of comment lines of a text file; left out: `#`, `%`, `//`, and `;` where it does not separate.",
);

pub(crate) const PART: KeySpec = optional(
    "part",
    Kind::Text,
    "\"/imu/gyro\"",
    "Part of a container that holds the recording: a dataset, a variable, a topic.",
);
