//! Faults of a recording.
//!
//! The sentence on a fault is a note where faults are found; in a result its words stand beside the note.

use crate::message::Note;
use serde::{Deserialize, Serialize};

/// Ids of the faults that can be examined wherever rows are read.
pub const OF_ROWS: &[&str] = &["non_finite", "unparsable", "implausible", "cut_off"];
/// Ids of the faults that time stamps or a counter show.
pub const OF_STAMPS: &[&str] = &["gaps", "missing_samples", "duplicate_timestamps", "backward_timestamps"];
/// Ids of the faults that the values of a gyro show.
pub const OF_VALUES: &[&str] = &["outliers", "saturated", "stuck", "repeated"];

/// Faults of the recording, counted; the first of each kind listed with row and time.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, bound(deserialize = "Text: Default + Deserialize<'de>"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Integrity", !default))]
pub struct Integrity<Text = Note> {
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
    pub faults: Vec<Fault<Text>>,
}

impl<Text> Integrity<Text> {
    /// The same faults, with the sentence of each in another form.
    pub fn with_texts<Other>(self, of: impl Fn(Text) -> Other) -> Integrity<Other> {
        let fault = |f: Fault<Text>| Fault {
            kind: f.kind,
            channel: f.channel,
            time_s: f.time_s,
            file: f.file,
            row: f.row,
            count: f.count,
            seen: of(f.seen),
        };
        Integrity {
            gaps: self.gaps,
            missing_samples: self.missing_samples,
            duplicate_timestamps: self.duplicate_timestamps,
            backward_timestamps: self.backward_timestamps,
            rollovers: self.rollovers,
            timestamp_disagreements: self.timestamp_disagreements,
            non_finite: self.non_finite,
            unparsable: self.unparsable,
            outliers: self.outliers,
            saturated: self.saturated,
            stuck: self.stuck,
            repeated: self.repeated,
            implausible: self.implausible,
            cut_off: self.cut_off,
            timestamp_jitter_s: self.timestamp_jitter_s,
            quantization_step_deg_h: self.quantization_step_deg_h,
            outlier_threshold: self.outlier_threshold,
            examined: self.examined,
            faults: self.faults.into_iter().map(fault).collect(),
        }
    }

    /// True where the recording was examined for this kind of fault.
    pub fn has_examined(&self, id: &str) -> bool {
        self.examined.iter().any(|e| e == id)
    }

    /// The ids of all kinds of faults.
    pub fn all_examined() -> Vec<String> {
        [OF_ROWS, OF_STAMPS, OF_VALUES].concat().into_iter().map(str::to_owned).collect()
    }
}

/// One fault.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, bound(deserialize = "Text: Default + Deserialize<'de>"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "FaultRecord", !default))]
pub struct Fault<Text = Note> {
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
    /// The sentence on it.
    #[serde(flatten)]
    pub seen: Text,
}
