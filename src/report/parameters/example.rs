//! Rows and results for the tests of parameters.

use crate::measurand::Measurand;
use crate::record::{MeasurandRecord, RecordingFile, RunRecord};

/// A row of a channel, measured.
pub fn row(m: &Measurand, channel: &str, value: f64) -> MeasurandRecord {
    MeasurandRecord {
        id: m.id.to_owned(),
        channel: channel.to_owned(),
        value: Some(value),
        unit: m.unit.to_owned(),
        identifiable: true,
        ..MeasurandRecord::default()
    }
}

/// A result of 10 h at 10 Hz with some rows.
pub fn record(rows: Vec<MeasurandRecord>) -> RunRecord {
    let file = RecordingFile { sample_interval_s: 0.1, duration_s: 36_000.0, ..RecordingFile::default() };
    RunRecord { measurands: rows, recording: vec![file], ..RunRecord::default() }
}
