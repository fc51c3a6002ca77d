//! What a run rests on: program, procedure, unit, session and the files read.

use crate::i18n::LocalText;
use crate::recording::Role;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The program that wrote a result.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Program {
    /// `sagnac`.
    pub name: String,
    /// Version of the program.
    pub version: String,
}

impl Program {
    /// This program.
    pub fn this() -> Program {
        Program { name: "sagnac".to_owned(), version: env!("CARGO_PKG_VERSION").to_owned() }
    }
}

/// Identity of the procedure.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(!default))]
pub struct ProcedureRecord {
    /// Id, for example `static-bias`.
    pub id: String,
    /// Title shown on the report.
    #[serde(flatten, with = "super::local::title")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::title::Members<String>"))]
    pub title: LocalText,
    /// Revision.
    pub revision: String,
    /// Standard followed.
    #[serde(flatten, with = "super::local::standard")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::standard::Members<Option<String>>"))]
    pub standard: Option<LocalText>,
    /// Clause of the standard.
    #[serde(flatten, with = "super::local::clause")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::clause::Members<Option<String>>"))]
    pub clause: Option<LocalText>,
    /// Who wrote it.
    #[serde(flatten, with = "super::local::author")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::author::Members<Option<String>>"))]
    pub author: Option<LocalText>,
    /// File it was read from, as given.
    pub path: String,
    /// SHA-256 of the file.
    pub sha256: String,
    /// The roles whose signatures it asks for: `tested`, `reviewed`, `approved`; absent in earlier results.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub signatures: Option<Vec<String>>,
    /// Organisation that answers for the protocol.
    #[serde(flatten, with = "super::local::organisation")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::organisation::Members<Option<String>>"))]
    pub organisation: Option<LocalText>,
    /// Where the test is made.
    #[serde(flatten, with = "super::local::place")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::place::Members<Option<String>>"))]
    pub place: Option<LocalText>,
    /// Who signs the printed protocol beside those who tested, reviewed and decided.
    pub signatories: Vec<Signatory>,
    /// The limits file, when one was given.
    pub limits: Option<LimitsFile>,
}

/// Who signs a printed protocol on behalf of others than the laboratory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Signatory {
    /// Quality control of the maker (ОТК).
    QualityControl,
    /// Representative of the customer, such as a military representative (ВП).
    CustomerRepresentative,
}

impl Signatory {
    /// Everyone.
    pub const ALL: [Signatory; 2] = [Signatory::QualityControl, Signatory::CustomerRepresentative];

    /// Word of it in files.
    pub const fn id(self) -> &'static str {
        match self {
            Signatory::QualityControl => "quality_control",
            Signatory::CustomerRepresentative => "customer_representative",
        }
    }
}

/// Identity of a limits file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(!default))]
pub struct LimitsFile {
    /// Id of the limits.
    pub id: String,
    /// Title.
    #[serde(flatten, with = "super::local::title")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::title::Members<String>"))]
    pub title: LocalText,
    /// Revision.
    pub revision: String,
    /// Where the values come from.
    #[serde(flatten, with = "super::local::source")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::source::Members<Option<String>>"))]
    pub source: Option<LocalText>,
    /// File it was read from, as given.
    pub path: String,
    /// SHA-256 of the file.
    pub sha256: String,
}

/// Identity of the unit that was tested.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct UnitUnderTest {
    /// Serial number.
    pub serial: Option<String>,
    /// Family, for example `OIUS-501`.
    #[serde(flatten, with = "super::local::family")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::family::Members<Option<String>>"))]
    pub family: Option<LocalText>,
    /// Part number.
    pub part: Option<String>,
    /// Revision of the part.
    pub revision: Option<String>,
    /// Lot or batch.
    pub lot: Option<String>,
    /// Model, where it is stated apart from the family.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// Date on which it was built, ISO 8601.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub build_date: Option<String>,
    /// True for a reference unit, which is tested to watch the bench and is no product.
    #[serde(default, skip_serializing_if = "is_false")]
    pub reference: bool,
    /// What else is stated of it, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub attributes: BTreeMap<String, String>,
    /// Results of other tests of it, which no recording shows.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub external: Vec<ExternalResult>,
}

/// A result of another test of the unit, as its certificate states it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ExternalResult {
    /// Id of the quantity.
    pub id: String,
    /// Value.
    pub value: f64,
    /// Unit of value and interval.
    pub unit: String,
    /// Interval with 95 %.
    pub interval: Option<[f64; 2]>,
    /// Number of the certificate or protocol.
    pub certificate: Option<String>,
    /// Who tested.
    pub laboratory: Option<String>,
    /// SHA-256 of the certificate, hexadecimal.
    pub sha256: Option<String>,
}

impl UnitUnderTest {
    /// Takes over what is known of the unit elsewhere and not stated here: all but the serial number and what the procedure
    /// says of the family.
    pub fn fill(&mut self, known: &UnitUnderTest) {
        let fill = |own: &mut Option<String>, other: &Option<String>| {
            if own.is_none() {
                own.clone_from(other);
            }
        };
        fill(&mut self.lot, &known.lot);
        fill(&mut self.model, &known.model);
        fill(&mut self.build_date, &known.build_date);
        self.reference |= known.reference;
        for (name, value) in &known.attributes {
            self.attributes.entry(name.clone()).or_insert_with(|| value.clone());
        }
        for other in &known.external {
            if self.external.iter().all(|own| own.id != other.id) {
                self.external.push(other.clone());
            }
        }
    }
}

/// True for what is left out where it is not so.
fn is_false(flag: &bool) -> bool {
    !flag
}

/// Who tested, where, when.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(!default))]
pub struct Session {
    /// Operator.
    pub operator: Option<String>,
    /// Station.
    pub station: Option<String>,
    /// Number of the protocol.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub protocol: Option<String>,
    /// When the evaluation ran, RFC 3339, UTC.
    pub evaluated_at: String,
}

/// One file of the recording.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(!default))]
pub struct RecordingFile {
    /// Path as given.
    pub path: String,
    /// SHA-256 of the bytes of the file.
    pub sha256: String,
    /// Size of the file, bytes.
    pub bytes: u64,
    /// Rows read.
    pub samples: u64,
    /// Measured mean sample interval, s.
    pub sample_interval_s: f64,
    /// Standard uncertainty of the interval from the scatter of the stamps, s; absent without stamps. What the clock is
    /// off by against true time is not in it.
    pub sample_interval_uncertainty_s: Option<f64>,
    /// Change of the clock's rate from the beginning to the end, ppm, where the stamps tell it.
    pub clock_drift_ppm: Option<f64>,
    /// Phase of the test that the file belongs to, where a manifest says it.
    pub phase: Option<String>,
    /// Start of the recording, RFC 3339, when the stamps are absolute.
    pub start: Option<String>,
    /// Last stamp minus first stamp plus one interval, s.
    pub duration_s: f64,
    /// Columns that were used: name, role, unit.
    pub columns: Vec<ColumnRecord>,
}

/// One column and what it was taken for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ColumnRecord {
    /// Name in the file.
    pub name: String,
    /// Channel id used in this result, for example `rate`.
    pub channel: String,
    /// What it was taken for.
    pub role: Role,
    /// Unit in the file.
    pub unit: String,
}
