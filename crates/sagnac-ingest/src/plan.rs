//! Facts needed before a recording is read: its columns, the units of its channels, its clock.

use super::pauses::Pauses;
use super::{IngestError, IngestErrorKind, Source};
use crate::clock::{Batches, Cadence, Clock, ClockError, Loss, Unwrapper, moduli};
use sagnac_core::message::{Arg, Note, note};
use sagnac_core::recording::{Channel, Role};
use sagnac_core::units::Affine;
use sagnac_core::units::Unit;
use std::ops::ControlFlow;
use std::path::Path;

/// Rows from which the clock is found.
const PROBED: usize = 65_536;

/// How the times of the samples are found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeBaseSpec {
    /// The declared sample rate, Hz; needed where there are no stamps.
    pub declared_sample_rate_hz: Option<f64>,
    /// Use the time channel, where there is one. Without it every row is one interval after the one before.
    pub use_stamps: bool,
    /// Period after which the stamps start again, s; the file may tell it, and usual ones are found.
    pub rollover_s: Option<f64>,
    /// Count after which the counter starts again; usual ones are found.
    pub counter_modulus: Option<f64>,
}

impl Default for TimeBaseSpec {
    fn default() -> TimeBaseSpec {
        TimeBaseSpec {
            declared_sample_rate_hz: None,
            use_stamps: true,
            rollover_s: None,
            counter_modulus: None,
        }
    }
}

/// A recording that is ready to be streamed: columns found, units checked, clock known.
pub struct Plan<'a> {
    pub(super) source: &'a Source,
    pub(super) channels: &'a [Channel],
    pub(super) wanted: Vec<usize>,
    /// From the number in the file to the unit of the analysis, by channel.
    pub(super) conversions: Vec<Affine>,
    /// Which channel gives the stamps.
    pub(super) time: Option<usize>,
    /// Which channel counts the samples.
    pub(super) counter: Option<usize>,
    pub(super) clock: Clock,
    pub(super) rollover: Unwrapper,
    pub(super) counter_modulus: Option<f64>,
    /// Interval by which angles become rates, s.
    pub(super) increment_s: f64,
    /// Angle after which an accumulated one starts again, arcsec, by channel.
    pub(super) angle_periods: Vec<Option<f64>>,
    pub(super) pauses: Pauses,
    /// Where samples are missing, by the row of the recording, from 1, where the batches of the recording tell it.
    pub(super) losses: Vec<Loss>,
    start_s: f64,
}

/// Finds the columns of the channels, checks their units and finds the clock from the first rows.
///
/// # Errors
/// A missing column, a unit that does not fit the role, no usable time base, or an error of [`Source::read`].
pub fn prepare<'a>(
    source: &'a Source,
    channels: &'a [Channel],
    spec: TimeBaseSpec,
) -> Result<Plan<'a>, IngestError> {
    if let Some(sensors) = source.sensors() {
        let error = IngestError::new(IngestErrorKind::Column, source.path(), sensors.note());
        return Err(error.hint(sensors.hint()));
    }
    let wanted = channels.iter().map(|c| source.resolve(&c.column)).collect::<Result<Vec<_>, _>>()?;
    let conversions = channels.iter().map(|c| conversion(source.path(), c)).collect::<Result<Vec<_>, _>>()?;
    let no_clock = |e: ClockError, hint: &'static str| {
        IngestError::new(IngestErrorKind::TimeBase, source.path(), clock_note(&e)).hint(hint)
    };
    let time = channels.iter().position(|c| c.role == Role::Time).filter(|_| spec.use_stamps);
    let counter = channels.iter().position(|c| c.role == Role::Counter);
    let column_of = |i: usize| Some((*wanted.get(i)?, *conversions.get(i)?));
    let stamped = time.and_then(column_of);
    let rollover_s = spec.rollover_s.or_else(|| source.columns().get(stamped?.0)?.rollover_s);
    let unwrapper = |limit_s: f64| {
        let usual = stamped.map(|(_, conversion)| moduli(conversion.factor.abs())).unwrap_or_default();
        Unwrapper::new(rollover_s, usual, limit_s)
    };
    let (clock, start_s) = match stamped {
        Some(column) => {
            let counted = counter.and_then(column_of);
            let FirstRows { mut stamps, mut counts } = first_rows(source, column, counted)?;
            let start_s = stamps.iter().copied().find(|t| t.is_finite()).unwrap_or(0.0);
            unwrapper(step_limit(&stamps)).apply(&mut stamps);
            let counted = counted.and_then(|_| by_counter(&stamps, &mut counts, spec.counter_modulus));
            let clock = match counted {
                Some(interval_s) => Clock::declared(1.0 / interval_s),
                None => Clock::probe_with(&stamps, spec.declared_sample_rate_hz),
            };
            (clock.and_then(plausible).map_err(|e| no_clock(e, hint(&e)))?, start_s)
        }
        None => {
            let rate = source.rate_without_stamps_hz(spec.declared_sample_rate_hz).ok_or_else(|| {
                IngestError::new(IngestErrorKind::TimeBase, source.path(), "ingest.no_time")
                    .hint("ingest.hint.declare_rate")
            })?;
            (Clock::declared(rate).map_err(|e| no_clock(e, "ingest.hint.rate_in_hz"))?, 0.0)
        }
    };
    let (clock, losses) = match (clock.cadence, stamped) {
        (Cadence::Buffered { .. }, Some((column, conversion))) if counter.is_none() => {
            batches(source, column, conversion, clock).map_err(|e| match e {
                Unread::File(e) => e,
                Unread::Clock(e) => no_clock(e, "ingest.hint.declare_batches"),
            })?
        }
        _ => (clock, Vec::new()),
    };
    let rollover = unwrapper(clock.gap_limit_s);
    let counter_modulus = spec.counter_modulus;
    let (angle_periods, increment_s) = (vec![None; channels.len()], clock.interval_s);
    let mut plan = Plan {
        source,
        channels,
        wanted,
        conversions,
        time,
        counter,
        clock,
        rollover,
        counter_modulus,
        increment_s,
        angle_periods,
        pauses: Pauses::default(),
        losses,
        start_s,
    };
    plan.rates_from_angles(1.0, increment_s);
    Ok(plan)
}

/// Rates at which gyros are sampled and their outputs averaged, Hz: beyond them the unit of the stamps is another.
const SAMPLED_HZ: std::ops::RangeInclusive<f64> = 1e-4..=5e5;

/// A clock found from stamps, unless no gyro is sampled so.
fn plausible(clock: Clock) -> Result<Clock, ClockError> {
    let rate_hz = 1.0 / clock.interval_s;
    if SAMPLED_HZ.contains(&rate_hz) { Ok(clock) } else { Err(ClockError::Absurd { rate_hz }) }
}

/// Stamps and counts of the first rows of a recording.
struct FirstRows {
    stamps: Vec<f64>,
    counts: Vec<f64>,
}

/// Reads the first stamps, s, and counts. The clock is found from the first file alone: where the next one begins is not
/// known.
fn first_rows(
    source: &Source,
    stamped: (usize, Affine),
    counted: Option<(usize, Affine)>,
) -> Result<FirstRows, IngestError> {
    let mut first = FirstRows { stamps: Vec::new(), counts: Vec::new() };
    let columns: Vec<usize> = std::iter::once(stamped.0).chain(counted.map(|c| c.0)).collect();
    source.read(&columns, &mut |block| {
        let room = PROBED.saturating_sub(first.stamps.len());
        let take = |slot: usize, conversion: Affine, into: &mut Vec<f64>| {
            let values = block.columns.get(slot).into_iter().flatten();
            into.extend(values.take(room).map(|v| conversion.apply(*v)));
        };
        take(0, stamped.1, &mut first.stamps);
        if let Some((_, conversion)) = counted {
            take(1, conversion, &mut first.counts);
        }
        if first.stamps.len() < PROBED && block.part == 0 {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    })?;
    Ok(first)
}

/// Why batches tell no clock.
enum Unread {
    File(IngestError),
    Clock(ClockError),
}

/// The clock of stamps in batches and where samples are missing, from the stamps of all rows. A file that follows another
/// is one of its own.
fn batches(
    source: &Source,
    column: usize,
    conversion: Affine,
    found: Clock,
) -> Result<(Clock, Vec<Loss>), Unread> {
    let (mut parts, mut rows) = (Vec::new(), 0u64);
    source
        .read(&[column], &mut |block| {
            if parts.len() <= block.part {
                parts.resize_with(block.part + 1, || (rows, Batches::new(found.interval_s)));
            }
            let values = block.columns.first().map(Vec::as_slice).unwrap_or_default();
            rows += values.len() as u64;
            if let Some((_, batches)) = parts.last_mut() {
                values.iter().for_each(|v| batches.push(conversion.apply(*v)));
            }
            ControlFlow::Continue(())
        })
        .map_err(Unread::File)?;
    let mut clock = None;
    let mut losses = Vec::new();
    for (before, batches) in parts {
        let unclear = Unread::Clock(ClockError::Batches { rate_hz: 1.0 / found.interval_s });
        let part = batches.clock().ok_or(unclear)?;
        losses.extend(part.losses.iter().map(|l| Loss { row: before + l.row + 1, samples: l.samples }));
        clock.get_or_insert_with(|| Clock::buffered(&part));
    }
    Ok((clock.unwrap_or(found), losses))
}

/// What to do about stamps that cannot serve.
fn hint(error: &ClockError) -> &'static str {
    match error {
        ClockError::Batches { .. } | ClockError::Coarse { .. } => "ingest.hint.declare_batches",
        ClockError::Absurd { .. } => "ingest.hint.time_unit",
        _ => "ingest.hint.check_time",
    }
}

/// Longest step across a roll-over before the clock is known: three middle steps.
fn step_limit(stamps: &[f64]) -> f64 {
    let steps = stamps.iter().zip(stamps.get(1..).unwrap_or_default()).map(|(a, b)| b - a);
    let mut growing: Vec<f64> = steps.filter(|d| *d > 0.0).take(4096).collect();
    if growing.is_empty() {
        return 0.0;
    }
    let middle = growing.len() / 2;
    3.0 * *growing.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The interval by the first stamps and counts: the middle one over 64 rows.
fn by_counter(stamps: &[f64], counts: &mut [f64], modulus: Option<f64>) -> Option<f64> {
    Unwrapper::of_counter(modulus).apply(counts);
    let lag = (counts.len() / 4).clamp(1, 64);
    let pairs = || stamps.iter().zip(counts.iter());
    let mut found: Vec<f64> = pairs()
        .zip(pairs().skip(lag))
        .filter(|((_, a), (_, b))| b > a)
        .map(|((t0, a), (t1, b))| (t1 - t0) / (b - a))
        .filter(|d| d.is_finite() && *d > 0.0)
        .collect();
    if found.len() < 2 {
        return None;
    }
    let middle = found.len() / 2;
    Some(*found.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// A date, s after a whole second from 1970.
fn date(epoch_s: f64, s: f64) -> Option<String> {
    let whole = s.floor();
    let seconds = epoch_s + whole;
    if !(-6e10..2.5e11).contains(&seconds) {
        return None;
    }
    // Rounded to the microsecond: stamps in s hold no more.
    let nanoseconds = (((s - whole) * 1e6).round() * 1e3).clamp(0.0, 999_999_000.0);
    let date = chrono::DateTime::from_timestamp(seconds as i64, nanoseconds as u32)?;
    Some(date.to_rfc3339_opts(chrono::SecondsFormat::Millis, true))
}

fn clock_note(error: &ClockError) -> Note {
    let percent = |share: f64| Arg::Text(format!("{:.0}", share * 100.0));
    match error {
        ClockError::TooFew => note!("ingest.clock_too_few"),
        ClockError::NotGrowing => note!("ingest.clock_not_growing"),
        ClockError::Falling { share } => note!("ingest.clock_falling", percent = percent(*share)),
        ClockError::Coarse { share } => note!("ingest.clock_coarse", percent = percent(*share)),
        ClockError::Batches { rate_hz } => {
            note!("ingest.clock_batches", hz = (rate_hz * 1e4).round() / 1e4)
        }
        ClockError::Absurd { rate_hz } => note!(
            "ingest.clock_absurd",
            hz = Arg::figures(*rate_hz, 3),
            interval_s = Arg::figures(1.0 / rate_hz, 3)
        ),
        ClockError::Rate { rate_hz } => note!("ingest.clock_rate", rate = rate_hz.to_string()),
    }
}

/// From the number in the file to the unit of the analysis.
fn conversion(path: &Path, channel: &Channel) -> Result<Affine, IngestError> {
    let error = |message: Note| IngestError::new(IngestErrorKind::Unit, path, message);
    if !channel.scale.is_finite() || channel.scale == 0.0 {
        return Err(error(note!(
            "ingest.bad_scale",
            channel = channel.id.as_str(),
            scale = channel.scale.to_string()
        ))
        .hint("ingest.hint.scale"));
    }
    let Some(inside) = channel.role.internal_unit() else {
        return Ok(Affine { factor: channel.scale, offset: 0.0 });
    };
    let affine = Unit::parse(inside).and_then(|inside| channel.unit.affine_to(&inside));
    affine.map(|a| Affine { factor: a.factor * channel.scale, offset: a.offset }).map_err(|e| {
        error(note!(
            "ingest.unit",
            channel = channel.id.as_str(),
            role = Arg::key("role", channel.role.id()),
            reason = e.note()
        ))
        .hint("ingest.hint.unit")
    })
}

impl Plan<'_> {
    /// Turns angle increments into rates by another interval, s: 1 arcsec in 1 s is 1 deg/h.
    fn rates_from_angles(&mut self, before_s: f64, interval_s: f64) {
        for (channel, conversion) in self.channels.iter().zip(&mut self.conversions) {
            if channel.role == Role::AngleIncrement {
                conversion.factor = conversion.factor * before_s / interval_s;
                conversion.offset = conversion.offset * before_s / interval_s;
            }
        }
        self.increment_s = interval_s;
    }

    /// Divides angles by the interval that was measured over the whole recording.
    pub fn set_increment_interval(&mut self, interval_s: f64) {
        if interval_s.is_normal() && interval_s > 0.0 {
            self.rates_from_angles(self.increment_s, interval_s);
        }
    }

    /// True when a channel of angles is read, whose rates depend on the interval.
    pub fn reads_angles(&self) -> bool {
        self.channels.iter().any(|c| matches!(c.role, Role::AngleIncrement | Role::AccumulatedAngle))
    }

    /// Sets the angle after which an accumulated angle starts again, in the unit of the channel.
    pub fn set_angle_period(&mut self, channel: &str, period: f64) {
        let slot = self.channels.iter().position(|c| c.id == channel && c.role == Role::AccumulatedAngle);
        if let Some(place) = slot.and_then(|s| self.angle_periods.get_mut(s)) {
            *place = Some(period);
        }
    }

    /// Sets where the recording may pause without that being a gap.
    pub fn set_pauses(&mut self, pauses: Pauses) {
        self.pauses = pauses;
    }

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
        if let Some(epoch_s) = column.epoch_s {
            return date(epoch_s, first_s);
        }
        let name = column.name.to_lowercase();
        let said = ["unix", "epoch", "utc", "posix"].iter().any(|w| name.contains(w));
        let known = said || column.storage.contains("Timestamp") || column.epoch_s.is_some();
        let epoch_s = column.epoch_s.unwrap_or(0.0);
        if !known || !(0.0..1e11).contains(&(first_s + epoch_s)) {
            return None;
        }
        date(0.0, first_s)
    }

    pub(super) fn column_name(&self, slot: usize) -> &str {
        let index = self.wanted.get(slot).copied().unwrap_or(0);
        self.source.columns().get(index).map_or("", |c| c.name.as_str())
    }
}
