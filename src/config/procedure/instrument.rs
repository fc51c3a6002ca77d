//! Instruments and the validity of their calibration.

use super::diagnostics::Span;
use crate::config::spec::Word;
use crate::config::table::{Table, words};
use crate::estimate::InputQuantity;
use crate::i18n::LocalText;
use crate::record::{ConditionStatus, InstrumentRecord};
use chrono::NaiveDate;

/// Components of uncertainty that a certificate may state.
const CERTIFIED_COMPONENTS: &[Word] = &[
    ("table_rate", "Rate of the table"),
    ("table_angle", "Angle of the table"),
    ("axis_alignment", "Angle between the axis of the table and the input axis"),
    ("thermometer", "Reading of the thermometer"),
    ("influence_level", "Level of an influence such as field or supply"),
    ("earth_rate", "Earth rate along the input axis: latitude, heading and elevation of the site"),
];

words!(InputQuantity, CERTIFIED_COMPONENTS, |word: &str| InputQuantity::ALL
    .into_iter()
    .find(|input| input.id() == word));

/// An instrument and the validity of its calibration. A calibration that has expired on the day of the test is a
/// condition not met.
#[derive(Debug, Clone, PartialEq, Eq, Table)]
#[table("instrument")]
pub struct Instrument {
    /// What it is.
    #[key(example = "chamber thermometer")]
    pub name: LocalText,
    /// Serial number.
    #[key(example = "T-0412")]
    pub serial: Option<String>,
    /// Number of its calibration certificate; it is printed with the uncertainty that it states.
    #[key(example = "18/2026-0412")]
    pub certificate: Option<String>,
    /// Day of the calibration.
    #[key(example = toml("2026-03-02"))]
    pub calibrated: Option<NaiveDate>,
    /// Component of uncertainty that its certificate states.
    #[key(example = "table_rate")]
    pub component: Option<InputQuantity>,
    /// Last day on which the calibration is valid.
    #[key(example = toml("2030-12-31"))]
    pub calibration_due: Option<NaiveDate>,
    /// Whether an expired calibration makes the test invalid; otherwise it is a remark.
    #[key(default = true, example = true)]
    pub required: bool,
    /// Where it is declared.
    #[key(span)]
    pub span: Span,
}

impl Instrument {
    /// The record of the instrument with its state on the day of the test.
    ///
    /// A calibration that has run out makes the test invalid where the instrument is required, and is a remark
    /// otherwise; so is one that states no date. The last day of validity counts as valid. A valid date without a
    /// serial number is a remark too: it belongs to no certain instrument.
    pub fn record_on(&self, day: NaiveDate) -> InstrumentRecord {
        let identified = self.serial.as_deref().is_some_and(|s| !s.trim().is_empty());
        let status = match self.calibration_due {
            Some(due) if day > due && self.required => ConditionStatus::Invalid,
            Some(due) if day <= due && identified => ConditionStatus::Ok,
            _ => ConditionStatus::Remark,
        };
        InstrumentRecord {
            name: self.name.clone(),
            serial: self.serial.clone(),
            certificate: self.certificate.clone(),
            calibrated: self.calibrated.map(|d| d.to_string()),
            component: self.component,
            calibration_due: self.calibration_due.map(|d| d.to_string()),
            status,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_calibration_holds_through_its_last_day() {
        let day = |d| NaiveDate::from_ymd_opt(2027, 3, d).unwrap();
        let mut instrument = Instrument {
            name: "t".into(),
            serial: Some("7".into()),
            certificate: None,
            calibrated: None,
            component: None,
            calibration_due: Some(day(1)),
            required: true,
            span: 0..0,
        };
        assert_eq!(instrument.record_on(day(1)).status, ConditionStatus::Ok);
        assert_eq!(instrument.record_on(day(2)).status, ConditionStatus::Invalid);
        instrument.serial = Some(" ".into());
        assert_eq!(instrument.record_on(day(1)).status, ConditionStatus::Remark);
        assert_eq!(instrument.record_on(day(2)).status, ConditionStatus::Invalid);
        instrument.required = false;
        assert_eq!(instrument.record_on(day(2)).status, ConditionStatus::Remark);
        instrument.calibration_due = None;
        assert_eq!(instrument.record_on(day(1)).status, ConditionStatus::Remark);
    }
}
