//! Follows the stamps of a recording row by row.

use super::buffered::AnchorRow;
use super::fit::{Fit, Measured};
use super::nominal::{Cadence, Clock, MAX_GAP_SAMPLES};

/// Rows that were set aside in a row, because their stamps are earlier than one seen before, after which the clock is
/// taken to have been set back.
pub const SET_BACK_AFTER: u64 = 1000;

/// Missing samples up to which they are counted surely enough for the fit to go on across a gap.
const COUNTED_GAP: f64 = 1000.0;

/// Stamps over which the mean course of an uneven clock is taken.
const MEMORY: f64 = 64.0;

/// What a time stamp means for its row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// The row follows the one before.
    Next,
    /// Samples are missing before the row.
    Gap {
        /// How many, at least 1.
        missing: u64,
        /// The step between the stamps.
        step_s: f64,
        /// True when the step is so long that the clock was set forward, and the missing samples are unknown.
        clock_set: bool,
    },
    /// The stamp equals the one before: the row is set aside.
    Duplicate,
    /// The stamp is earlier than the latest: the row is set aside.
    Backward {
        /// How far back, positive.
        back_s: f64,
    },
    /// The stamp is far ahead and the next one is back in line: the row is set aside.
    Stray {
        /// How far ahead.
        ahead_s: f64,
    },
    /// The clock was set back and stayed so: the row starts a new stretch after a gap of unknown length.
    SetBack {
        /// How far back, positive.
        back_s: f64,
    },
    /// No stamp: the row is set aside.
    Unusable,
}

/// The mean course of an uneven clock.
#[derive(Debug, Clone, Copy)]
struct Course {
    /// Time of the last row by the mean course.
    phase: f64,
    /// Interval, which follows a clock that drifts.
    interval: f64,
    /// Stamps that the course rests on.
    n: f64,
    /// Rows since the last stamp that was compared.
    rows: f64,
}

/// Follows the stamps of a recording.
#[derive(Debug, Clone)]
pub struct Tracker {
    clock: Clock,
    first: Option<f64>,
    latest: Option<f64>,
    set_aside_run: u64,
    /// Added to stamps after the clock was set back, so that time goes on.
    offset_s: f64,
    intervals: u64,
    /// Sums of the deviations of the intervals from the nominal one and of their squares.
    deviation: f64,
    squares: f64,
    /// Number of the last row among the samples.
    x: f64,
    fit: Fit,
    course: Course,
    compared: bool,
    largest_s: f64,
    /// Samples known to be missing before the next row.
    lost: u64,
}

impl Tracker {
    /// Starts with a clock.
    pub fn new(clock: Clock) -> Tracker {
        Tracker {
            clock,
            first: None,
            latest: None,
            set_aside_run: 0,
            offset_s: 0.0,
            intervals: 0,
            deviation: 0.0,
            squares: 0.0,
            x: 0.0,
            fit: Fit::new(clock.interval_s),
            course: Course { phase: 0.0, interval: clock.interval_s, n: 1.0, rows: 0.0 },
            compared: false,
            largest_s: 0.0,
            lost: 0,
        }
    }

    /// Takes a whole block when every stamp follows the one before; false (and nothing taken) otherwise.
    pub fn take_unbroken(&mut self, stamps: &[f64]) -> bool {
        let (Some(&first), Some(&last), Some(latest)) = (stamps.first(), stamps.last(), self.latest) else {
            return false;
        };
        if self.clock.cadence != Cadence::Even {
            return false;
        }
        let (nominal, limit) = (self.clock.interval_s, self.clock.gap_limit_s);
        let good = |d: f64| d > 0.0 && d <= limit;
        let mut all = good(first - latest) && self.set_aside_run == 0;
        let mut squares = (first - latest - nominal).powi(2);
        for (a, b) in stamps.iter().zip(stamps.get(1..).unwrap_or_default()) {
            let d = b - a;
            all &= good(d);
            squares += (d - nominal) * (d - nominal);
        }
        if !all {
            return false;
        }
        self.fit.add_block(stamps, self.x + 1.0);
        self.x += stamps.len() as f64;
        self.intervals += stamps.len() as u64;
        self.deviation += (last - latest) - stamps.len() as f64 * nominal;
        self.squares += squares;
        self.latest = Some(last);
        true
    }

    /// Says that samples are missing before the next row, as the batches of the recording tell.
    pub fn note_loss(&mut self, samples: u64) {
        self.lost += samples;
    }

    /// Takes one stamp; `next` is the one after it, where known.
    pub fn step(&mut self, stamp: f64, next: Option<f64>) -> Step {
        self.compared = false;
        let buffered = matches!(self.clock.cadence, Cadence::Buffered { .. });
        if !stamp.is_finite() {
            // Rows of a batch are counted, whatever their stamps say.
            self.lost += u64::from(buffered);
            return Step::Unusable;
        }
        let Some(latest) = self.latest else {
            self.first = Some(stamp);
            self.latest = Some(stamp);
            self.course.phase = stamp - self.clock.first_residual_s;
            if !matches!(self.clock.cadence, Cadence::Bunched { .. } | Cadence::Buffered { .. }) {
                self.fit.add(stamp, self.x);
            }
            return Step::Next;
        };
        let d = stamp - latest;
        let bunched = buffered || matches!(self.clock.cadence, Cadence::Bunched { .. });
        if d == 0.0 && self.set_aside_run == 0 && !bunched {
            return Step::Duplicate;
        }
        if d < 0.0 || d == 0.0 && !(bunched && self.set_aside_run == 0) {
            self.set_aside_run += 1;
            self.lost += u64::from(buffered);
            if self.set_aside_run <= SET_BACK_AFTER {
                return Step::Backward { back_s: -d };
            }
            return self.set_back(stamp);
        }
        match self.clock.cadence {
            Cadence::Even => self.even(stamp, latest, next),
            Cadence::Uneven => self.uneven(stamp, latest, next),
            Cadence::Bunched { period_s, .. } => self.bunched(stamp, latest, next, period_s),
            Cadence::Buffered { anchor, .. } => self.buffered(stamp, latest, anchor),
        }
    }

    /// The stamps of another file begin with `stamp`. One that is earlier than every stamp so far starts a stretch after
    /// a gap of unknown length, and so does any that is not later than the latest where the clock is known to have started
    /// again; how far back it is, then.
    pub fn join(&mut self, stamp: f64, restarted: bool) -> Option<f64> {
        let (first, latest) = (self.first?, self.latest?);
        let bound = if restarted { latest } else { first.min(latest) };
        if !(stamp.is_finite() && stamp <= bound) {
            return None;
        }
        self.set_back(stamp);
        Some(latest - stamp)
    }

    /// Goes on from here as one interval after the latest stamp, whatever the next stamp is.
    pub fn shift_to_follow(&mut self, stamp: f64) -> Option<f64> {
        let latest = self.latest?;
        let shift = latest + self.clock.interval_s - stamp;
        shift.is_finite().then_some(shift)
    }

    fn set_back(&mut self, stamp: f64) -> Step {
        let latest = self.latest.unwrap_or(stamp);
        let back_s = latest - stamp;
        self.set_aside_run = 0;
        self.offset_s += 2.0 * self.clock.interval_s + back_s;
        self.latest = Some(stamp);
        self.restart(stamp);
        Step::SetBack { back_s }
    }

    /// Begins a stretch with a stamp.
    fn restart(&mut self, stamp: f64) {
        self.fit.break_off();
        self.x += 1.0;
        self.course = Course { phase: stamp, interval: self.course.interval, n: 2.0, rows: 0.0 };
        self.fit.add(stamp, self.x);
        self.compared = true;
    }

    fn even(&mut self, stamp: f64, latest: f64, next: Option<f64>) -> Step {
        let d = stamp - latest;
        if d <= self.clock.gap_limit_s {
            self.set_aside_run = 0;
            self.intervals += 1;
            self.deviation += d - self.clock.interval_s;
            self.squares += (d - self.clock.interval_s).powi(2);
            self.x += 1.0;
            self.fit.add(stamp, self.x);
            self.compared = true;
            self.latest = Some(stamp);
            return Step::Next;
        }
        if next.is_some_and(|n| n > latest && n < stamp) {
            return Step::Stray { ahead_s: d };
        }
        let missing = ((d / self.clock.interval_s).round() - 1.0).max(1.0);
        self.gap(stamp, d, missing, d)
    }

    fn uneven(&mut self, stamp: f64, latest: f64, next: Option<f64>) -> Step {
        let samples = ((stamp - self.course.phase) / self.course.interval).round().max(1.0);
        self.one(stamp, latest, next, samples)
    }

    fn bunched(&mut self, stamp: f64, latest: f64, next: Option<f64>, period_s: f64) -> Step {
        let d = stamp - latest;
        if d <= 0.5 * period_s {
            self.set_aside_run = 0;
            self.course.rows += 1.0;
            self.x += 1.0;
            self.latest = Some(stamp);
            return Step::Next;
        }
        // The first row of a bunch.
        if self.course.n <= 1.0 {
            self.course = Course { phase: stamp, rows: 0.0, n: 2.0, ..self.course };
            self.set_aside_run = 0;
            self.latest = Some(stamp);
            self.x += 1.0;
            self.fit.add(stamp, self.x);
            self.compared = true;
            return Step::Next;
        }
        let expected = self.course.phase + (self.course.rows + 1.0) * self.course.interval;
        let ahead = stamp - expected;
        let slack = (1.2 * self.course.interval).max(0.45 * period_s);
        // The jitter of the delivery is less than the slack; what is beyond is missing rows, to within that jitter.
        let missing = if ahead > slack { (ahead / self.course.interval).round() } else { 0.0 };
        let samples = self.course.rows + 1.0 + missing;
        self.one(stamp, latest, next, samples)
    }

    fn buffered(&mut self, stamp: f64, latest: f64, anchor: AnchorRow) -> Step {
        let missing = std::mem::take(&mut self.lost);
        let paused = stamp - latest > self.clock.pause_s();
        if paused {
            match anchor {
                AnchorRow::First => {}
                AnchorRow::Last => self.fit.add(latest, self.x),
                AnchorRow::Delivery => self.fit.add(self.course.phase, self.x),
            }
            self.course.phase = stamp;
        }
        self.set_aside_run = 0;
        self.latest = Some(stamp);
        self.x += 1.0 + missing as f64;
        if missing as f64 > COUNTED_GAP {
            self.fit.break_off();
        }
        if paused && anchor == AnchorRow::First {
            self.fit.add(stamp, self.x);
        }
        if missing == 0 {
            return Step::Next;
        }
        Step::Gap { missing, step_s: (missing as f64 + 1.0) * self.clock.interval_s, clock_set: false }
    }

    /// A stamp that is compared with the mean course: `samples` after the last one compared.
    fn one(&mut self, stamp: f64, latest: f64, next: Option<f64>, samples: f64) -> Step {
        let rows = self.course.rows;
        let missing = samples - rows - 1.0;
        if missing >= 1.0 {
            if next.is_some_and(|n| n > latest && n < stamp) {
                return Step::Stray { ahead_s: stamp - latest };
            }
            if missing > COUNTED_GAP {
                return self.gap(stamp, stamp - latest, missing, stamp - latest);
            }
        }
        let course = &mut self.course;
        let expected = course.phase + samples * course.interval;
        let residual = stamp - expected;
        course.n = (course.n + 1.0).min(MEMORY);
        let gain = 1.0 / course.n;
        course.phase = expected + gain * residual;
        course.rows = 0.0;
        // The interval was measured over many stamps before; it only follows what the clock does later.
        if course.n >= MEMORY {
            course.interval += 0.25 * gain * gain * residual / samples;
            self.largest_s = self.largest_s.max(residual.abs());
        }
        self.set_aside_run = 0;
        self.latest = Some(stamp);
        self.x += 1.0 + missing;
        self.fit.add(stamp, self.x);
        self.compared = true;
        if missing >= 1.0 {
            Step::Gap { missing: missing as u64, step_s: stamp - latest, clock_set: false }
        } else {
            Step::Next
        }
    }

    fn gap(&mut self, stamp: f64, step_s: f64, missing: f64, d: f64) -> Step {
        self.set_aside_run = 0;
        self.latest = Some(stamp);
        let clock_set = missing > MAX_GAP_SAMPLES;
        if clock_set {
            self.offset_s -= d - 2.0 * self.clock.interval_s;
        }
        if missing > COUNTED_GAP {
            self.restart(stamp);
        } else {
            self.x += 1.0 + missing;
            self.fit.add(stamp, self.x);
            self.compared = true;
        }
        Step::Gap { missing: if clock_set { 1 } else { missing as u64 }, step_s, clock_set }
    }

    /// True when the last stamp was compared with the clock: in bunches only the first one is.
    pub(super) fn compared(&self) -> bool {
        self.compared
    }

    /// A stamp on a scale that goes on when the clock was set.
    pub fn on_scale(&self, stamp: f64) -> f64 {
        stamp + self.offset_s
    }

    /// First stamp used.
    pub fn first_s(&self) -> Option<f64> {
        self.first
    }

    /// Latest stamp used, on the scale of [`Tracker::on_scale`].
    pub fn latest_s(&self) -> Option<f64> {
        if let (Cadence::Buffered { .. }, Some(first)) = (self.clock.cadence, self.first) {
            return Some(self.on_scale(first + self.x * self.clock.interval_s));
        }
        // The last row of a bunch is later than its stamp.
        let bunched = matches!(self.clock.cadence, Cadence::Bunched { .. }) && self.course.n > 1.0;
        let latest =
            if bunched { self.course.phase + self.course.rows * self.course.interval } else { self.latest? };
        Some(self.on_scale(latest))
    }

    /// The clock by regression of the stamps on the number of the sample; `None` with too few.
    pub fn measured(&self) -> Option<Measured> {
        self.fit.measured()
    }

    /// Interval by regression over the unbroken stretches; the nominal one when there is none.
    pub fn mean_interval_s(&self) -> f64 {
        let measured = self.measured().map_or(self.clock.interval_s, |m| m.interval_s);
        if measured.is_normal() && measured > 0.0 { measured } else { self.clock.interval_s }
    }

    /// Largest departure of a stamp from the mean course of the clock, s, where it is followed.
    pub fn largest_residual_s(&self) -> Option<f64> {
        (self.clock.cadence != Cadence::Even).then_some(self.largest_s)
    }

    /// Rms deviation of the stamps from a locally uniform clock: rms of the intervals about their mean, divided by √2.
    /// That is the standard deviation of white jitter; slow drift of the clock hardly enters. Rounding of the stamps
    /// does. Of an uneven clock it is the rms departure from the clock that was fitted.
    pub fn jitter_s(&self) -> Option<f64> {
        if self.clock.cadence != Cadence::Even {
            return self.measured().map(|m| m.residual_s);
        }
        if self.intervals < 2 {
            return None;
        }
        let n = self.intervals as f64;
        let mean = self.deviation / n;
        Some(((self.squares / n - mean * mean).max(0.0) / 2.0).sqrt())
    }
}
