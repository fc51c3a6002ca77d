//! Limits, reference values and typical values as data, in the units of their measurands.

use super::derived_rows::DerivedLimit;
use super::diagnostics::Span;
use crate::estimate::Limit;
use crate::i18n::LocalText;
use crate::measurand::Measurand;
use crate::record::ReferenceRecord;

/// Limits, references and typical values of one file, in the units of the measurands.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LimitSet {
    /// Limits.
    pub limits: Vec<LimitSpec>,
    /// Limits of quantities by a formula.
    pub derived: Vec<DerivedLimit>,
    /// Published values, in the order of the file.
    pub references: Vec<Reference>,
    /// Typical values of the family.
    pub expected: Vec<Expected>,
    /// Limits that are written per second or in radians.
    pub fast_units: Vec<FastUnit>,
}

impl LimitSet {
    /// Number of limits, of measurands and of formulas.
    pub fn count(&self) -> usize {
        self.limits.len() + self.derived.len()
    }
}

/// A limit and what it is for.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitSpec {
    /// Measurand judged.
    pub measurand: &'static Measurand,
    /// Channel judged; `None`: every one without a limit of its own.
    pub channel: Option<String>,
    /// The limit, in the unit of the measurand.
    pub limit: Limit,
    /// The unit of the limit where that of the measurand is as recorded.
    pub recorded_unit: Option<&'static str>,
    /// Where it is declared, in the file `limit.source`.
    pub span: Span,
}

/// A published value.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Measurand.
    pub measurand: &'static Measurand,
    /// Channel; `None`: every one.
    pub channel: Option<String>,
    /// Value, where it was published, and conventions a reader must know.
    pub record: ReferenceRecord,
    /// Where it is declared.
    pub span: Span,
}

/// A typical value of the family.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// Measurand.
    pub measurand: &'static Measurand,
    /// Value in its unit.
    pub value: f64,
    /// Where it is declared.
    pub span: Span,
}

/// A limits file.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitsFile {
    /// Id.
    pub id: String,
    /// Title.
    pub title: LocalText,
    /// Revision.
    pub revision: String,
    /// Family of devices.
    pub family: Option<LocalText>,
    /// Where the values come from.
    pub source: Option<LocalText>,
    /// What it states. Limits made by a factor are among them.
    pub set: LimitSet,
}

/// A limit that is written in a fast unit.
#[derive(Debug, Clone, PartialEq)]
pub struct FastUnit {
    /// Where the limit is declared.
    pub limit: Span,
    /// Where its value stands.
    pub value: Span,
    /// The unit as it is written.
    pub unit: String,
}

/// The gyro channel of a row: `rate` of `rate@-40`, `x` of `x<-y`.
pub fn gyro_of(channel: &str) -> &str {
    let end = channel.find('@').or_else(|| channel.find("<-")).unwrap_or(channel.len());
    channel.get(..end).unwrap_or(channel)
}
