//! The tables of a manifest.

use super::read_words::{DECIMALS, DELIMITERS, ENCODINGS};
use crate::keyed::spec::{Kind, Range, TableSpec, optional, required, with_default};

/// A manifest as a whole.
pub static MANIFEST_FILE: TableSpec = TableSpec {
    name: "",
    doc: "A manifest: the files of one recording, in their order.",
    keys: &[
        required("format", Kind::Format("manifest/1"), "\"manifest/1\"", "Version of the format."),
        optional("serial", Kind::Text, "\"SN-0042\"", "Serial number of the unit that was recorded."),
        optional(
            "files",
            Kind::Text,
            "\"part*.csv\"",
            "Pattern of the files, relative to the manifest: `*`, `?`, `[...]`. Numbers in names sort by their value. In place of [[file]].",
        ),
        with_default(
            "contiguous",
            Kind::Flag,
            "false",
            "true",
            "True when each file follows the one before without a gap, whatever its stamps are; needed for files without stamps, whose joints are gaps of unknown length otherwise.",
        ),
        optional(
            "recording",
            Kind::Table(&READING),
            "",
            "How the files are read, where it is not to be found out.",
        ),
        optional("file", Kind::Tables(&FILE), "", "The files, one table each, in their order."),
    ],
};

static FILE: TableSpec = TableSpec {
    name: "file",
    doc: "One file.",
    keys: &[
        required(
            "path",
            Kind::Text,
            "\"part1.csv\"",
            "Path relative to the manifest, with `/`. It cannot lead out of the manifest's folder.",
        ),
        optional(
            "sha256",
            Kind::Text,
            "\"e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855\"",
            "SHA-256 of the file; checked before anything is read.",
        ),
        optional("phase", Kind::Id, "\"soak\"", "Phase of the test that the file belongs to."),
    ],
};

static READING: TableSpec = TableSpec {
    name: "recording",
    doc: "How the files are read. What is left out is found from each file.",
    keys: &[
        optional("format", Kind::Text, "\"csv\"", "Id of the file format."),
        optional(
            "encoding",
            Kind::Choice(ENCODINGS),
            "\"windows-1251\"",
            "Character encoding of text files.",
        ),
        optional("delimiter", Kind::Choice(DELIMITERS), "\"semicolon\"", "Separator of fields."),
        optional("decimal", Kind::Choice(DECIMALS), "\"comma\"", "Decimal sign."),
        optional(
            "header_line",
            Kind::Number(Range::between(0.0, 1e6)),
            "1",
            "Line that holds the names of the columns, counted from 1; 0: there is none.",
        ),
        optional(
            "first_line",
            Kind::Number(Range::between(1.0, 1e6)),
            "2",
            "First line of data, counted from 1.",
        ),
        optional("comment", Kind::Text, "\"#\"", "Beginning of lines that are comments."),
        optional(
            "part",
            Kind::Text,
            "\"/imu/rate\"",
            "Part of a container that holds the recording: a dataset, a variable, a topic.",
        ),
        optional("layout", Kind::Text, "\"layout.toml\"", "Layout of the records of raw binary files."),
    ],
};
