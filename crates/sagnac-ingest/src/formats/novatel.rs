//! Raw measurements of inertial units as NovAtel receivers write them in text: `%RAWIMUSA`, `#RAWIMUA`, `%RAWIMUSXA`.

use super::loaded::{self, About, LoadedColumn};
use crate::error::{IngestError, IngestErrorKind};
use crate::{Candidate, Format, Opened};
use sagnac_core::message::note;

/// Raw measurements in text.
pub(super) struct RawImu;

/// Start of GPS time, s since 1970.
const GPS_EPOCH_S: f64 = 315_964_800.0;

/// Seconds of a week.
const WEEK_S: f64 = 604_800.0;

/// Columns behind the time, in the order of the log: the y axis is written with the other sign.
const RAWIMU_COLUMNS: [(&str, f64); 6] = [
    ("accel_z_counts", 1.0),
    ("accel_y_counts", -1.0),
    ("accel_x_counts", 1.0),
    ("gyro_z_increment_counts", 1.0),
    ("gyro_y_increment_counts", -1.0),
    ("gyro_x_increment_counts", 1.0),
];

/// True for the first bytes of such a log.
pub(super) fn is_raw_imu(head: &[u8]) -> bool {
    let line = head.trim_ascii_start();
    [&b"%RAWIMU"[..], b"#RAWIMU"].iter().any(|mark| line.starts_with(mark))
}

impl Format for RawImu {
    fn id(&self) -> &'static str {
        "rawimu"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        is_raw_imu(&file.head)
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        let text = loaded::text(file)?;
        let mut first_week = None;
        let mut stamps = Vec::new();
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); RAWIMU_COLUMNS.len()];
        let logs = (1u64..).zip(text.lines()).filter(|(_, l)| is_raw_imu(l.as_bytes()));
        for (number, line) in logs {
            let damaged = || {
                IngestError::new(IngestErrorKind::Damaged, &file.path, "ingest.rawimu.damaged")
                    .at(number, None)
                    .found(line)
                    .hint("ingest.hint.damaged")
            };
            let (_, body) = line.split_once(';').ok_or_else(damaged)?;
            let body = body.split('*').next().unwrap_or_default();
            let fields: Vec<&str> = body.split(',').map(str::trim).collect();
            // The extended logs have two fields about the unit before.
            let week_at = fields.len().checked_sub(RAWIMU_COLUMNS.len() + 3).ok_or_else(damaged)?;
            let field = |i: usize| fields.get(i).and_then(|f| f.parse::<f64>().ok());
            let (week, seconds) = field(week_at).zip(field(week_at + 1)).ok_or_else(damaged)?;
            let zero = *first_week.get_or_insert(week);
            stamps.push((week - zero) * WEEK_S + seconds);
            for (i, (column, (_, sign))) in values.iter_mut().zip(RAWIMU_COLUMNS).enumerate() {
                column.push(field(week_at + 3 + i).map_or(f64::NAN, |v| sign * v));
            }
        }
        let epoch_s = GPS_EPOCH_S + first_week.unwrap_or(0.0) * WEEK_S;
        let mut columns = vec![LoadedColumn::new("time_gps", Some("s"), stamps).since(epoch_s)];
        let counts = RAWIMU_COLUMNS.iter().zip(values);
        columns.extend(counts.map(|((name, _), values)| LoadedColumn::new(*name, Some("count"), values)));
        let notes = vec![note!("ingest.rawimu.read")];
        loaded::opened(file, columns, About { notes, ..About::default() })
    }
}
