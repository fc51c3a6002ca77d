//! The clock of a recording: nominal interval, gaps, duplicate and backward stamps, jitter.
//!
//! Only consecutive stamps are compared, so that a clock that drifts makes no gap. Times in s.

/// Rows that were set aside in a row, because their stamps are earlier than one seen before, after which the clock is
/// taken to have been set back.
pub const SET_BACK_AFTER: u64 = 1000;

/// Share of equal consecutive stamps beyond which the stamps are too coarse to serve.
const COARSE_SHARE: f64 = 0.05;

/// Share of stamps earlier than the one before beyond which the column is no clock.
const FALLING_SHARE: f64 = 0.1;

/// Stamps that are compared at a distance to find the interval when they are rounded.
const LAG: usize = 16;

/// Missing samples beyond which a step forward is taken for a clock that was set, not for missing samples: more than
/// any recording holds.
const LARGEST_GAP: f64 = 1e8;

/// Why the stamps cannot serve as a time base.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ClockError {
    /// Fewer than two usable stamps.
    #[error("fewer than two rows have a usable time stamp")]
    TooFew,
    /// The stamps do not grow.
    #[error("the time stamps do not grow")]
    NotGrowing,
    /// Many stamps are earlier than the one before.
    #[error("{:.0} % of the time stamps are earlier than the one before: this is no clock", share * 100.0)]
    Falling {
        /// Share of stamps earlier than the one before.
        share: f64,
    },
    /// Many consecutive stamps are equal.
    #[error("{:.0} % of the time stamps equal the one before: they are coarser than the sample interval", share * 100.0)]
    Coarse {
        /// Share of equal consecutive stamps.
        share: f64,
    },
    /// The declared rate is no positive number.
    #[error("the declared sample rate {rate_hz} Hz is not a positive number")]
    Rate {
        /// The rate given.
        rate_hz: f64,
    },
}

/// The nominal clock of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// Nominal sample interval.
    pub interval_s: f64,
    /// Step of the stamps when they are rounded to a power of ten, else 0.
    pub resolution_s: f64,
    /// Longest step between stamps that is no gap.
    pub gap_limit_s: f64,
}

impl Clock {
    /// The clock of a declared rate, in Hz.
    ///
    /// # Errors
    /// [`ClockError::Rate`].
    pub fn declared(rate_hz: f64) -> Result<Clock, ClockError> {
        let interval_s = 1.0 / rate_hz;
        if !(rate_hz > 0.0 && interval_s.is_normal()) {
            return Err(ClockError::Rate { rate_hz });
        }
        Ok(Clock { interval_s, resolution_s: 0.0, gap_limit_s: 1.5 * interval_s })
    }

    /// Finds the clock from the first stamps: the median interval over 16 rows, which rounding of the stamps and a few
    /// gaps do not disturb, refined by the mean of the single intervals within half of it.
    ///
    /// # Errors
    /// [`ClockError`] when the stamps cannot serve.
    pub fn probe(stamps: &[f64]) -> Result<Clock, ClockError> {
        let t: Vec<f64> = stamps.iter().copied().filter(|t| t.is_finite()).collect();
        if t.len() < 2 {
            return Err(ClockError::TooFew);
        }
        let steps = || t.iter().zip(t.iter().skip(1)).map(|(a, b)| b - a);
        let equal = steps().filter(|&d| d == 0.0).count();
        let growing = steps().filter(|&d| d > 0.0).count();
        if growing == 0 {
            return Err(ClockError::NotGrowing);
        }
        let share = |count: usize| count as f64 / (t.len() - 1) as f64;
        let falling = share(t.len() - 1 - equal - growing);
        if falling > FALLING_SHARE {
            return Err(ClockError::Falling { share: falling });
        }
        let share = share(equal);
        if share > COARSE_SHARE && equal > 2 {
            return Err(ClockError::Coarse { share });
        }
        let lag = LAG.min((t.len() / 4).max(1));
        let mut long: Vec<f64> = t
            .iter()
            .zip(t.iter().skip(lag))
            .map(|(a, b)| (b - a) / lag as f64)
            .filter(|&d| d > 0.0)
            .collect();
        if long.is_empty() {
            long = steps().filter(|&d| d > 0.0).collect();
        }
        let middle = long.len() / 2;
        let (_, median, _) = long.select_nth_unstable_by(middle, f64::total_cmp);
        let median = *median;
        // Rounded stamps whose step is near the interval: single intervals spread too far to tell gaps from rounding,
        // so the mean is taken over the long ones.
        let resolution_s = resolution(&t, median);
        let reach = 1.5 * resolution_s / lag as f64;
        let interval_s = if resolution_s > 0.3 * median {
            mean(long.iter().copied().filter(|d| (d - median).abs() <= reach))
        } else {
            mean(steps().filter(|&d| d > 0.0 && (d - median).abs() <= 0.5 * median))
        };
        let interval_s = whole_steps(interval_s.unwrap_or(median), resolution_s);
        let interval_s = if lost(&t, interval_s, resolution_s) { resolution_s } else { interval_s };
        let interval_s = tidy(interval_s);
        let ratio = interval_s / resolution_s;
        let rounded = resolution_s > 0.0 && (ratio - ratio.round()).abs() > 1e-3;
        let slack = if rounded { 1.01 * resolution_s } else { 0.0 };
        Ok(Clock { interval_s, resolution_s, gap_limit_s: (1.5 * interval_s).max(interval_s + slack) })
    }
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0u64), |(s, n), v| (s + v, n + 1));
    (count > 0).then(|| sum / count as f64)
}

/// A whole number of the steps that the stamps are rounded to, where the interval is one within 1e-4: a row too many or
/// too few among coarse stamps shifts their mean by less.
fn whole_steps(interval_s: f64, resolution_s: f64) -> f64 {
    let steps = interval_s / resolution_s;
    if resolution_s > 0.0 && (steps / steps.round() - 1.0).abs() < 1e-4 {
        steps.round() * resolution_s
    } else {
        interval_s
    }
}

/// Takes an interval for the round one, or for that of the round rate, that it equals within 1e-9: the rest is rounding.
fn tidy(interval_s: f64) -> f64 {
    let six = |v: f64| format!("{v:.5e}").parse::<f64>().unwrap_or(v);
    let near = |v: &f64| (v / interval_s - 1.0).abs() < 1e-9;
    [six(interval_s), 1.0 / six(1.0 / interval_s)].into_iter().find(near).unwrap_or(interval_s)
}

/// The largest power of ten of which all stamps are multiples, 0 when there is none near the interval.
fn resolution(t: &[f64], interval_s: f64) -> f64 {
    let largest = t.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    (-9..=2)
        .rev()
        .map(|e| 10f64.powi(e))
        .filter(|q| *q <= 1.01 * interval_s && *q > 0.01 * interval_s && largest / q < 1e14)
        .find(|q| {
            let allowed = 1e-6 + 4.0 * f64::EPSILON * largest / q;
            allowed < 0.1 && t.iter().all(|v| (v / q - (v / q).round()).abs() <= allowed)
        })
        .unwrap_or(0.0)
}

/// What a stamp means for its row.
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

/// True where most steps are one step of the rounding and the stamps do not keep to a straight line of `interval_s`:
/// stamps of a uniform clock that are rounded stay within a step of one, and lost samples lead ever farther away.
fn lost(stamps: &[f64], interval_s: f64, resolution_s: f64) -> bool {
    if resolution_s <= 0.0 || (interval_s / resolution_s - 1.0).abs() > 0.5 {
        return false;
    }
    let steps = stamps.iter().zip(stamps.iter().skip(1)).map(|(a, b)| b - a);
    let single = steps.filter(|d| (d / resolution_s - 1.0).abs() < 1e-6).count();
    let origin = stamps.first().copied().unwrap_or(0.0);
    let count = stamps.len().saturating_sub(1).max(1) as f64;
    let slope = (stamps.last().copied().unwrap_or(0.0) - origin) / count;
    let off = stamps.iter().enumerate().map(|(i, t)| t - origin - slope * i as f64);
    let (low, high) = off.fold((0.0f64, 0.0f64), |(low, high), d| (low.min(d), high.max(d)));
    2 * single > stamps.len() && high - low > 2.0 * resolution_s
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
        }
    }

    /// Takes a whole block when every stamp follows the one before; false (and nothing taken) otherwise.
    pub fn take_unbroken(&mut self, stamps: &[f64]) -> bool {
        let (Some(&first), Some(&last), Some(latest)) = (stamps.first(), stamps.last(), self.latest) else {
            return false;
        };
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
        self.intervals += stamps.len() as u64;
        self.deviation += (last - latest) - stamps.len() as f64 * nominal;
        self.squares += squares;
        self.latest = Some(last);
        true
    }

    /// Takes one stamp; `next` is the one after it, where known.
    pub fn step(&mut self, stamp: f64, next: Option<f64>) -> Step {
        if !stamp.is_finite() {
            return Step::Unusable;
        }
        let Some(latest) = self.latest else {
            self.first = Some(stamp);
            self.latest = Some(stamp);
            return Step::Next;
        };
        let d = stamp - latest;
        if d == 0.0 && self.set_aside_run == 0 {
            return Step::Duplicate;
        }
        if d <= 0.0 {
            self.set_aside_run += 1;
            if self.set_aside_run <= SET_BACK_AFTER {
                return Step::Backward { back_s: -d };
            }
            self.set_aside_run = 0;
            self.offset_s += 2.0 * self.clock.interval_s - d;
            self.latest = Some(stamp);
            return Step::SetBack { back_s: -d };
        }
        if d <= self.clock.gap_limit_s {
            self.set_aside_run = 0;
            self.intervals += 1;
            self.deviation += d - self.clock.interval_s;
            self.squares += (d - self.clock.interval_s).powi(2);
            self.latest = Some(stamp);
            return Step::Next;
        }
        if next.is_some_and(|n| n > latest && n < stamp) {
            return Step::Stray { ahead_s: d };
        }
        self.set_aside_run = 0;
        self.latest = Some(stamp);
        let missing = (d / self.clock.interval_s).round() - 1.0;
        let clock_set = missing > LARGEST_GAP;
        if clock_set {
            self.offset_s -= d - 2.0 * self.clock.interval_s;
        }
        Step::Gap { missing: if clock_set { 1 } else { (missing as u64).max(1) }, step_s: d, clock_set }
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
        self.latest.map(|t| self.on_scale(t))
    }

    /// Mean interval over the unbroken stretches; the nominal one when there is none.
    pub fn mean_interval_s(&self) -> f64 {
        if self.intervals == 0 {
            return self.clock.interval_s;
        }
        self.clock.interval_s + self.deviation / self.intervals as f64
    }

    /// Rms deviation of the stamps from a locally uniform clock: rms of the intervals about their mean, divided by √2.
    /// That is the standard deviation of white jitter; slow drift of the clock hardly enters. Rounding of the stamps
    /// does.
    pub fn jitter_s(&self) -> Option<f64> {
        if self.intervals < 2 {
            return None;
        }
        let n = self.intervals as f64;
        let mean = self.deviation / n;
        Some(((self.squares / n - mean * mean).max(0.0) / 2.0).sqrt())
    }
}

#[cfg(test)]
#[path = "timebase_tests.rs"]
mod tests;
