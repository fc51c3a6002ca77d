//! The tables of a manifest.

use crate::config::recording_keys;
use crate::config::spec::{Kind, TableSpec, optional, required, with_default};

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
            "True if each file continues the previous one without a gap, regardless of timestamps; needed \
             for files without timestamps, which are otherwise separated by gaps of unknown length.",
        ),
        with_default(
            "several_phases",
            Kind::Flag,
            "false",
            "true",
            "True when files of several phases belong to one test: positions or turns, which a procedure names by their phases.",
        ),
        optional("unit", Kind::Table(&UNIT), "", "What else is known of the unit."),
        optional("recording", Kind::Table(&READING), "", "How the files are read, where not detected."),
        optional("file", Kind::Tables(&FILE), "", "The files, one table each, in their order."),
    ],
};

static UNIT: TableSpec = TableSpec {
    name: "unit",
    doc: "The unit that was recorded, for stores, histories and data sheets.",
    keys: &[
        optional("model", Kind::Text, "\"OIUS-501\"", "Model."),
        optional("lot", Kind::Text, "\"2026-14\"", "Lot or batch."),
        optional("build_date", Kind::Date, "\"2026-03-01\"", "Date on which the unit was built."),
        with_default(
            "reference",
            Kind::Flag,
            "false",
            "true",
            "True for a reference unit, which is tested to watch the bench. It counts in no yield.",
        ),
        optional("attribute", Kind::Tables(&ATTRIBUTE), "", "Free attributes of the unit, one table each."),
    ],
};

static ATTRIBUTE: TableSpec = TableSpec {
    name: "unit.attribute",
    doc: "A free attribute of the unit.",
    keys: &[
        required("name", Kind::Text, "\"coil\"", "Name."),
        required("value", Kind::Text, "\"K12\"", "Value."),
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
            "SHA-256 of the file, checked before anything is read.",
        ),
        optional("phase", Kind::Id, "\"soak\"", "Phase of the test that the file belongs to."),
    ],
};

static READING: TableSpec = TableSpec {
    name: "recording",
    doc: "How the files are read. Omitted keys are detected from each file.",
    keys: &[
        recording_keys::FORMAT,
        recording_keys::ENCODING,
        recording_keys::DELIMITER,
        recording_keys::DECIMAL,
        recording_keys::HEADER_LINE,
        recording_keys::FIRST_LINE,
        recording_keys::COMMENT,
        recording_keys::PART,
        optional("layout", Kind::Text, "\"layout.toml\"", "Layout of the records of raw binary files."),
    ],
};
