//! What must be known before a recording is read: its columns, the units of its channels, its clock.

use super::{IngestError, IngestErrorKind, Source};
use crate::recording::timebase::{Clock, ClockError};
use crate::recording::{Channel, Role};
use crate::text::{Arg, Note};
use crate::units::Unit;
use std::ops::ControlFlow;
use std::path::Path;

/// Rows from which the clock is found.
const PROBED: usize = 65_536;

/// Where the time base comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeBaseSpec {
    /// The declared sample rate, Hz; needed where there are no stamps.
    pub declared_sample_rate_hz: Option<f64>,
    /// Use the time channel, where there is one. Without it every row is one interval after the one before.
    pub use_stamps: bool,
}

impl Default for TimeBaseSpec {
    fn default() -> TimeBaseSpec {
        TimeBaseSpec { declared_sample_rate_hz: None, use_stamps: true }
    }
}

/// A recording that is ready to be read: columns found, units checked, clock known.
pub struct Plan<'a> {
    pub(super) source: &'a Source,
    pub(super) channels: &'a [Channel],
    pub(super) wanted: Vec<usize>,
    /// Factor and offset from the number in the file to the unit inside.
    pub(super) maps: Vec<(f64, f64)>,
    /// Which channel gives the stamps.
    pub(super) time: Option<usize>,
    pub(super) clock: Clock,
    start_s: f64,
}

/// Finds the columns of the channels, checks their units and finds the clock from the first rows.
///
/// # Errors
/// A column that is not there, a unit that does not fit the role, no time base, or what [`Source::read`] says.
pub fn prepare<'a>(
    source: &'a Source,
    channels: &'a [Channel],
    spec: TimeBaseSpec,
) -> Result<Plan<'a>, IngestError> {
    let wanted = channels.iter().map(|c| source.resolve(&c.column)).collect::<Result<Vec<_>, _>>()?;
    let maps = channels.iter().map(|c| map(source.path(), c)).collect::<Result<Vec<_>, _>>()?;
    let no_clock = |e: ClockError, hint: &'static str| {
        IngestError::new(IngestErrorKind::TimeBase, source.path(), clock_note(&e)).hint(hint)
    };
    let time = channels.iter().position(|c| c.role == Role::Time).filter(|_| spec.use_stamps);
    let (clock, start_s) = match time.and_then(|i| wanted.get(i).zip(maps.get(i))) {
        Some((&column, map)) => {
            let mut stamps = Vec::new();
            source.read(&[column], &mut |block| {
                let room = PROBED.saturating_sub(stamps.len());
                stamps.extend(block.columns.iter().flatten().take(room).map(|v| v * map.0 + map.1));
                if stamps.len() < PROBED { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            })?;
            let clock = Clock::probe(&stamps).map_err(|e| no_clock(e, "ingest.hint.check_time"))?;
            (clock, stamps.iter().copied().find(|t| t.is_finite()).unwrap_or(0.0))
        }
        None => {
            let rate = spec.declared_sample_rate_hz.ok_or_else(|| {
                IngestError::new(IngestErrorKind::TimeBase, source.path(), "ingest.no_time")
                    .hint("ingest.hint.declare_rate")
            })?;
            (Clock::declared(rate).map_err(|e| no_clock(e, "ingest.hint.rate_in_hz"))?, 0.0)
        }
    };
    let mut maps = maps;
    for (channel, map) in channels.iter().zip(&mut maps) {
        if channel.role == Role::AngleIncrement {
            // 1 arcsec in 1 s is 1 deg/h.
            *map = (map.0 / clock.interval_s, map.1 / clock.interval_s);
        }
    }
    Ok(Plan { source, channels, wanted, maps, time, clock, start_s })
}

fn clock_note(error: &ClockError) -> Note {
    let percent = |share: f64| Arg::Text(format!("{:.0}", share * 100.0));
    match error {
        ClockError::TooFew => Note::new("ingest.clock_too_few"),
        ClockError::NotGrowing => Note::new("ingest.clock_not_growing"),
        ClockError::Falling { share } => Note::new("ingest.clock_falling").with("percent", percent(*share)),
        ClockError::Coarse { share } => Note::new("ingest.clock_coarse").with("percent", percent(*share)),
        ClockError::Rate { rate_hz } => Note::new("ingest.clock_rate").with("rate", rate_hz.to_string()),
    }
}

/// Factor and offset from the number in the file to the unit inside.
fn map(path: &Path, channel: &Channel) -> Result<(f64, f64), IngestError> {
    let error = |message: Note| IngestError::new(IngestErrorKind::Unit, path, message);
    if !channel.scale.is_finite() || channel.scale == 0.0 {
        return Err(error(
            Note::new("ingest.bad_scale")
                .with("channel", channel.id.as_str())
                .with("scale", channel.scale.to_string()),
        )
        .hint("ingest.hint.scale"));
    }
    let Some(inside) = channel.role.internal_unit() else { return Ok((channel.scale, 0.0)) };
    let affine = Unit::parse(inside).and_then(|inside| channel.unit.affine_to(&inside));
    affine.map(|(factor, offset)| (factor * channel.scale, offset)).map_err(|e| {
        error(
            Note::new("ingest.unit")
                .with("channel", channel.id.as_str())
                .with("role", Arg::key("role", channel.role.id()))
                .with("reason", e.note()),
        )
        .hint("ingest.hint.unit")
    })
}

impl Plan<'_> {
    /// The nominal clock.
    pub fn clock(&self) -> Clock {
        self.clock
    }

    /// First usable stamp, s; 0 without stamps.
    pub fn start_s(&self) -> f64 {
        self.start_s
    }

    /// The start as a date, where the reader, the name of the time column or the file format says what stamps count from.
    pub(super) fn absolute_start(&self, first_s: f64) -> Option<String> {
        let slot = self.time?;
        let column = self.source.columns().get(*self.wanted.get(slot)?)?;
        let name = column.name.to_lowercase();
        let said = ["unix", "epoch", "utc", "posix"].iter().any(|w| name.contains(w));
        let known = said || column.storage.contains("Timestamp") || column.epoch_s.is_some();
        let epoch_s = column.epoch_s.unwrap_or(0.0);
        if !known || !(0.0..1e11).contains(&(first_s + epoch_s)) {
            return None;
        }
        // Whole seconds and fraction apart, so that a date does not cost the fraction its digits.
        let whole_s = first_s.floor();
        let nano = ((first_s - whole_s) * 1e9) as u32;
        let date = chrono::DateTime::from_timestamp((whole_s + epoch_s) as i64, nano)?;
        Some(date.to_rfc3339_opts(chrono::SecondsFormat::Millis, true))
    }

    pub(super) fn column_name(&self, slot: usize) -> &str {
        let index = self.wanted.get(slot).copied().unwrap_or(0);
        self.source.columns().get(index).map_or("", |c| c.name.as_str())
    }
}
