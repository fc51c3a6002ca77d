//! The published tables of Russian and Allan figures, kept as they were printed.

use crate::i18n::Note;
use serde::{Deserialize, Serialize};

/// A number as it was printed, with the half unit of its last digit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Printed {
    pub value: f64,
    pub half: f64,
}

impl Printed {
    /// Reads the digits; `None` when they are no number.
    pub fn of(text: &str) -> Option<Printed> {
        let value = text.parse::<f64>().ok().filter(|v| v.is_finite())?;
        let decimals = text.split_once('.').map_or(0, |(_, d)| d.len());
        Some(Printed { value, half: 0.5 * 10f64.powi(-(decimals as i32)) })
    }

    /// Values that round to these digits.
    pub fn range(self) -> Range {
        Range { low: self.value - self.half, high: self.value + self.half }
    }
}

/// The least and the most that a number can be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    pub low: f64,
    pub high: f64,
}

impl Range {
    /// True where both have numbers in common, and not only an end.
    pub fn overlaps(self, other: Range) -> bool {
        let slack = 1e-9 * self.high.abs().max(other.high.abs());
        self.low < other.high - slack && other.low < self.high - slack
    }
}

/// Both tables, as read.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub(super) struct Tables {
    pub source: String,
    pub least_record_h: f64,
    pub slope_called_rate_ramp: f64,
    pub flicker_correlation_time_s: f64,
    pub table1: Vec<Row1>,
    pub table2: Vec<Row2>,
}

/// A row of Table 1, as printed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row1 {
    /// Device.
    pub device: String,
    /// Allan bias instability, deg/h.
    pub bias_instability: String,
    /// Allan angle random walk, deg/√h.
    pub n: String,
    /// Coil: length and diameter, where printed.
    pub coil: String,
}

/// A row of Table 2, as printed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row2 {
    /// Device.
    pub device: String,
    /// The same device in Table 1.
    pub in_table1: String,
    /// Russian drift over 100 s, deg/h.
    pub sigma100: String,
    /// Allan bias instability, deg/h.
    pub bias_instability: String,
    /// Allan over Russian.
    pub bias_inverse: String,
    /// Russian over Allan, in brackets there.
    pub bias_ratio: String,
    /// Russian angle random walk, deg/√h.
    pub arw_russian: String,
    /// Allan N, deg/√h.
    pub n: String,
    /// Allan over Russian.
    pub arw_inverse: String,
    /// Russian over Allan, in brackets there.
    pub arw_ratio: String,
}

/// A row of Table 2 with what follows from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CheckedRow {
    /// Device.
    pub device: String,
    /// The row as printed.
    pub printed: Row2,
    /// Russian drift over 100 s as printed, deg/h.
    pub sigma100: f64,
    /// Allan bias instability as printed, deg/h.
    pub bias_instability: f64,
    /// Their ratio as printed.
    pub ratio_printed: f64,
    /// Their ratio as it follows from the two.
    pub ratio: f64,
    /// Russian angle random walk as printed, deg/√h.
    pub arw_russian: f64,
    /// Allan N as printed in Table 2, deg/√h.
    pub n: f64,
    /// N of the same device in Table 1, deg/√h.
    pub n_table1: Option<f64>,
    /// Ratio of the random walks as printed.
    pub arw_ratio_printed: f64,
    /// The same as it follows from the two.
    pub arw_ratio: f64,
    /// What N alone gives over 100 s, deg/h.
    pub six_n: f64,
    /// Russian drift over that.
    pub over_six_n: f64,
    /// Averaging time at which floor and angle random walk are equal, h.
    pub crossover_h: f64,
    /// σ10 over σ100, σ10 from the Russian angle random walk.
    pub sigma10_over_sigma100: f64,
    /// Contradictions and remarks.
    #[serde(with = "crate::record::message::notes")]
    pub remarks: Vec<Note>,
    /// True when something does not follow.
    pub flagged: bool,
}

/// What angle random walk alone would give for the ratio of Table 2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NullRow {
    /// Record length over the largest averaging time.
    pub length_over_tau_max: f64,
    /// 5, 50 and 95 % quantiles of the ratio in a record of the least length.
    pub ratio: [f64; 3],
}

/// The tables with their checks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checked {
    /// Where the tables are printed.
    pub source: String,
    /// Record length assumed where none is printed, h.
    pub least_record_h: f64,
    /// Table 1 as printed.
    pub table1: Vec<Row1>,
    /// Table 2 with what follows from it.
    pub rows: Vec<CheckedRow>,
    /// What angle random walk alone gives.
    pub null: Vec<NullRow>,
    /// Remarks on the whole.
    #[serde(with = "crate::record::message::notes")]
    pub remarks: Vec<Note>,
}
