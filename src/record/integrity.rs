//! What was wrong with a recording.

use super::Message;
use crate::i18n::{Lang, Localize};
use sagnac_core::recording::integrity as found;
use serde::{Deserialize, Serialize};

pub use found::{OF_ROWS, OF_STAMPS, OF_VALUES};

/// Faults of the recording, counted; the first of each kind listed with row and time.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Integrity {
    /// Places where samples are missing.
    pub gaps: u64,
    /// Samples missing in them.
    pub missing_samples: u64,
    /// Rows whose stamp equals the one before.
    pub duplicate_timestamps: u64,
    /// Rows whose stamp is earlier than one before.
    pub backward_timestamps: u64,
    /// Places where stamps or a counter of limited width started again; no fault.
    pub rollovers: u64,
    /// Rows where stamps and counter disagree; the counter is followed.
    pub timestamp_disagreements: u64,
    /// Fields that hold NaN, infinity or a number beyond 1e60, or are empty.
    pub non_finite: u64,
    /// Fields that are no number.
    pub unparsable: u64,
    /// Samples far outside the noise about them.
    pub outliers: u64,
    /// Samples at a rail.
    pub saturated: u64,
    /// Samples that repeat the one before for longer than chance allows.
    pub stuck: u64,
    /// Samples in stretches that occurred before, bit for bit.
    pub repeated: u64,
    /// Samples whose value, or step, no sensor of the kind can show.
    pub implausible: u64,
    /// Files of which the end is known to be missing.
    pub cut_off: u64,
    /// Rms deviation of the stamps from a uniform clock, s.
    pub timestamp_jitter_s: Option<f64>,
    /// Size of a step of the rate output, deg/h, when the values lie on a lattice.
    pub quantization_step_deg_h: Option<f64>,
    /// Threshold of the outlier test, in robust standard deviations.
    pub outlier_threshold: Option<f64>,
    /// Counts above that were examined, by their names; a count that is not among them says nothing.
    pub examined: Vec<String>,
    /// The faults one by one, at most 100 of a kind.
    pub faults: Vec<FaultRecord>,
}

impl Integrity {
    /// True where it was looked for a fault.
    pub fn has_examined(&self, id: &str) -> bool {
        self.examined.iter().any(|e| e == id)
    }

    /// Every count as examined.
    pub fn all_examined() -> Vec<String> {
        [OF_ROWS, OF_STAMPS, OF_VALUES].concat().into_iter().map(str::to_owned).collect()
    }
}

/// One fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FaultRecord {
    /// `gap`, `duplicate_timestamp`, `backward_timestamp`, `rollover`, `timestamp_disagreement`, `non_finite`,
    /// `unparsable`, `outlier`, `saturated`, `stuck`, `repeated`, `interpolated`, `implausible`, `cut_off`.
    pub kind: String,
    /// Channel, when the fault is of one channel.
    pub channel: Option<String>,
    /// Time of the first sample concerned, s on the recording's own scale.
    pub time_s: Option<f64>,
    /// File, where the recording is of several.
    pub file: Option<String>,
    /// Row of the first sample concerned, counted from 1 without header lines; in its own file.
    pub row: u64,
    /// Samples concerned.
    pub count: u64,
    /// What was seen, English.
    pub note: String,
    /// The same sentence by name, for other languages.
    #[cfg_attr(feature = "schema", schemars(with = "serde_json::Value"))]
    pub message: Option<Message>,
}

impl From<found::Integrity> for Integrity {
    fn from(i: found::Integrity) -> Integrity {
        Integrity {
            gaps: i.gaps,
            missing_samples: i.missing_samples,
            duplicate_timestamps: i.duplicate_timestamps,
            backward_timestamps: i.backward_timestamps,
            rollovers: i.rollovers,
            timestamp_disagreements: i.timestamp_disagreements,
            non_finite: i.non_finite,
            unparsable: i.unparsable,
            outliers: i.outliers,
            saturated: i.saturated,
            stuck: i.stuck,
            repeated: i.repeated,
            implausible: i.implausible,
            cut_off: i.cut_off,
            timestamp_jitter_s: i.timestamp_jitter_s,
            quantization_step_deg_h: i.quantization_step_deg_h,
            outlier_threshold: i.outlier_threshold,
            examined: i.examined,
            faults: i.faults.into_iter().map(FaultRecord::from).collect(),
        }
    }
}

impl From<found::Fault> for FaultRecord {
    fn from(f: found::Fault) -> FaultRecord {
        FaultRecord {
            kind: f.kind,
            channel: f.channel,
            time_s: f.time_s,
            file: f.file,
            row: f.row,
            count: f.count,
            note: f.message.say(Lang::En),
            message: Some(f.message.into()),
        }
    }
}
