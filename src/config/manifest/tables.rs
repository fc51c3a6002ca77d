//! The tables of a manifest.

use crate::config::external::ExternalKeys;
use crate::config::recording_keys::RecordingKeys;
use crate::config::section::Section;
use crate::config::spec::TableSpec;
use crate::config::table::Table;
use chrono::NaiveDate;

/// A manifest as a whole.
pub static MANIFEST_FILE: TableSpec = *ManifestTables::SPEC;

/// A manifest: the files of one recording, in their order.
#[derive(Table)]
#[table("", format = "manifest/1")]
pub(super) struct ManifestTables {
    /// Serial number of the unit that was recorded.
    #[key(example = "SN-0042")]
    pub serial: Option<String>,
    /// Pattern of the files, relative to the manifest: `*`, `?`, `[...]`. Numbers in names sort by their value. In
    /// place of [[file]].
    #[key(example = "part*.csv")]
    pub files: Option<String>,
    /// True if each file continues the previous one without a gap, regardless of timestamps; needed for files
    /// without timestamps, which are otherwise separated by gaps of unknown length.
    #[key(default = false, example = true)]
    pub contiguous: bool,
    /// True when files of several phases belong to one test: positions or turns, which a procedure names by their
    /// phases.
    #[key(default = false, example = true)]
    pub several_phases: bool,
    /// What else is known of the unit.
    #[key(optional)]
    pub unit: UnitKeys,
    /// How the files are read, where not detected.
    #[key(optional)]
    pub recording: ReadingKeys,
    /// The files, one table each, in their order.
    #[key(name = "file")]
    pub listed: Vec<FileKeys>,
    /// Files recorded beside the recording with clocks of their own, one table each.
    #[key(name = "source")]
    pub sources: Vec<SourceKeys>,
    /// Results of other tests of the unit, one table each.
    #[key(name = "external")]
    pub externals: Vec<ExternalKeys>,
    #[key(section)]
    pub section: Section,
}

/// The unit that was recorded, for stores, histories and data sheets.
#[derive(Table)]
#[table("unit")]
pub(super) struct UnitKeys {
    /// Model.
    #[key(example = "OIUS-501")]
    pub model: Option<String>,
    /// Lot or batch.
    #[key(example = "2026-14")]
    pub lot: Option<String>,
    /// Date on which the unit was built.
    #[key(example = "2026-03-01")]
    pub build_date: Option<NaiveDate>,
    /// True for a reference unit, which is tested to watch the bench. It counts in no yield.
    #[key(default = false, example = true)]
    pub reference: bool,
    /// Free attributes of the unit, one table each.
    #[key(name = "attribute")]
    pub attributes: Vec<AttributeKeys>,
}

/// A free attribute of the unit.
#[derive(Table)]
#[table("unit.attribute")]
pub(super) struct AttributeKeys {
    /// Name.
    #[key(example = "coil")]
    pub name: String,
    /// Value.
    #[key(example = "K12")]
    pub value: String,
}

/// One file.
#[derive(Table)]
#[table("file")]
pub(super) struct FileKeys {
    /// Path relative to the manifest, with `/`. It cannot lead out of the manifest's folder.
    #[key(required, example = "part1.csv")]
    pub path: Option<String>,
    /// SHA-256 of the file, checked before anything is read.
    #[key(example = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855")]
    pub sha256: Option<String>,
    /// Phase of the test that the file belongs to.
    #[key(id, example = "soak")]
    pub phase: Option<String>,
    #[key(section)]
    pub section: Section,
}

/// A file recorded beside the recording, such as the log of a chamber. Its columns are interpolated at the timestamps of
/// the recording; outputs of gyros in it are not read.
#[derive(Table)]
#[table("source")]
pub(super) struct SourceKeys {
    /// Path relative to the manifest, with `/`. It cannot lead out of the manifest's folder.
    #[key(example = "chamber.csv")]
    pub path: Option<String>,
    /// Pattern of files that continue each other, relative to the manifest. In place of `path`.
    #[key(example = "chamber-*.csv")]
    pub files: Option<String>,
    /// SHA-256 of the file, checked before anything is read.
    #[key(example = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855")]
    pub sha256: Option<String>,
    /// Time that is added to its timestamps to give those of the recording. May be omitted if both files state dates.
    #[key(quantity = "s", example = "-3.2 s")]
    pub time_offset_s: Option<f64>,
    /// Standard uncertainty of that time, or of the dates. It becomes a component of every quantity that depends on it.
    #[key(quantity = "s", min = 0, default = "0 s", example = "0.2 s")]
    pub time_offset_uncertainty_s: f64,
    /// True to estimate the offset and rate of its clock from what both files record, the angle of a table and a rate or a
    /// temperature in both. Without dates, the two must have started within a minute of each other.
    #[key(default = false, example = true)]
    pub estimate_offset: bool,
    /// Relative excess of its seconds over those of the recording.
    #[key(quantity = "1", min = -0.1, max = 0.1, default = "0 ppm", example = "20 ppm")]
    pub time_rate: f64,
    #[key(section)]
    pub section: Section,
}

/// How the files are read. Omitted keys are detected from each file.
#[derive(Table)]
#[table("recording")]
pub(super) struct ReadingKeys {
    #[key(flatten)]
    pub reading: RecordingKeys,
    /// Layout of the records of raw binary files.
    #[key(example = "layout.toml")]
    pub layout: Option<String>,
    #[key(section)]
    pub section: Section,
}
