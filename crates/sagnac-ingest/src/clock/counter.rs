//! A sample counter as the time base: what it says of lost and repeated samples is exact.

use super::fit::{Fit, Measured};
use super::nominal::MAX_GAP_SAMPLES;
use super::tracker::SET_BACK_AFTER;

/// Times that stamps and counter may differ about one step before it is reported, in intervals.
const DISAGREEMENT: f64 = 1.5;

/// What the value of a sample counter means for its row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CounterStep {
    /// The row follows the one before.
    Next,
    /// Samples are missing before the row.
    Gap {
        /// How many, at least 1.
        missing: u64,
    },
    /// The counter stood still: the row is set aside.
    Duplicate,
    /// The counter fell: the row is set aside.
    Backward {
        /// By how much.
        back: f64,
    },
    /// The counter started anew: the row begins a stretch after a gap of unknown length.
    Restart,
    /// No whole number: the row is set aside.
    Unusable,
}

/// Follows a counter and, where there are any, the stamps beside it. Counts are unwrapped before.
#[derive(Debug, Clone)]
pub struct CounterTracker {
    interval_s: f64,
    latest: Option<f64>,
    set_aside_run: u64,
    /// Stamp and count that were last compared.
    stamped: Option<(f64, f64)>,
    first_stamp: Option<f64>,
    fit: Fit,
    disagreement: Option<f64>,
}

impl CounterTracker {
    /// Starts with the nominal interval, s.
    pub fn new(interval_s: f64) -> CounterTracker {
        CounterTracker {
            interval_s,
            latest: None,
            set_aside_run: 0,
            stamped: None,
            first_stamp: None,
            fit: Fit::new(interval_s),
            disagreement: None,
        }
    }

    /// Takes one count and its stamp, NaN where there is none.
    pub fn step(&mut self, count: f64, stamp: f64) -> CounterStep {
        self.disagreement = None;
        if !(count.is_finite() && count.fract() == 0.0) {
            return CounterStep::Unusable;
        }
        let Some(latest) = self.latest else {
            self.accept(count, stamp);
            return CounterStep::Next;
        };
        let d = count - latest;
        if d == 0.0 && self.set_aside_run == 0 {
            return CounterStep::Duplicate;
        }
        if d <= 0.0 {
            self.set_aside_run += 1;
            if self.set_aside_run <= SET_BACK_AFTER {
                return CounterStep::Backward { back: -d };
            }
            return self.restart(count, stamp);
        }
        if d - 1.0 > MAX_GAP_SAMPLES {
            return self.restart(count, stamp);
        }
        self.accept(count, stamp);
        if d > 1.0 { CounterStep::Gap { missing: (d - 1.0) as u64 } } else { CounterStep::Next }
    }

    /// The counts of another file begin with `count`; true when it is no later than the last one, so that it starts a
    /// stretch after a gap of unknown length. The row itself is taken by the next step.
    pub fn join(&mut self, count: f64) -> bool {
        let restarts = self.latest.is_some_and(|latest| count <= latest);
        if restarts {
            self.fit.break_off();
            (self.latest, self.stamped, self.set_aside_run) = (None, None, 0);
        }
        restarts
    }

    fn restart(&mut self, count: f64, stamp: f64) -> CounterStep {
        self.fit.break_off();
        self.stamped = None;
        self.accept(count, stamp);
        CounterStep::Restart
    }

    fn accept(&mut self, count: f64, stamp: f64) {
        self.set_aside_run = 0;
        self.latest = Some(count);
        if !stamp.is_finite() {
            return;
        }
        self.first_stamp.get_or_insert(stamp);
        if let Some((before, at)) = self.stamped {
            let more = (stamp - before) - (count - at) * self.interval_s;
            if more.abs() > DISAGREEMENT * self.interval_s {
                self.disagreement = Some(more);
                // The clock was set while the counter ran on: a stretch of its own for the interval.
                self.fit.break_off();
            }
        }
        self.stamped = Some((stamp, count));
        self.fit.add(stamp, count);
    }

    /// By how much the stamps stepped more than the counter says at the last row, s, where that is beyond jitter.
    pub fn disagreement_s(&self) -> Option<f64> {
        self.disagreement
    }

    /// The clock by regression of the stamps on the counter.
    pub fn measured(&self) -> Option<Measured> {
        self.fit.measured()
    }

    /// First stamp used.
    pub fn first_s(&self) -> Option<f64> {
        self.first_stamp
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lost_repeated_and_fallen_counts_are_told_exactly() {
        let mut tracker = CounterTracker::new(1.0);
        let counts = [5.0, 6.0, 6.0, 9.0, 8.0, 10.0, f64::NAN, 11.5, 12.0];
        let steps: Vec<CounterStep> = counts.iter().map(|c| tracker.step(*c, f64::NAN)).collect();
        assert_eq!(
            steps,
            [
                CounterStep::Next,
                CounterStep::Next,
                CounterStep::Duplicate,
                CounterStep::Gap { missing: 2 },
                CounterStep::Backward { back: 1.0 },
                CounterStep::Next,
                CounterStep::Unusable,
                CounterStep::Unusable,
                CounterStep::Gap { missing: 1 },
            ]
        );
        assert_eq!(tracker.measured(), None);
    }

    #[test]
    fn the_clock_is_fitted_to_the_counter_and_a_clock_that_was_set_is_named() {
        let mut tracker = CounterTracker::new(0.01);
        let mut told = Vec::new();
        for i in 0..50_000u32 {
            if i % 7 == 3 {
                continue;
            }
            let count = f64::from(i);
            // 3 s were added to the clock at 20 000; the counter runs on.
            let stamp = 0.0104 * count + if i >= 20_000 { 3.0 } else { 0.0 };
            tracker.step(count, stamp);
            told.extend(tracker.disagreement_s().map(|d| (i, d)));
        }
        assert_eq!(told.len(), 1);
        assert!(told[0].0 == 20_000 && (told[0].1 - 3.0).abs() < 1e-2, "{told:?}");
        let m = tracker.measured().unwrap();
        assert!((m.interval_s / 0.0104 - 1.0).abs() < 1e-9 && m.residual_s < 1e-6, "{m:?}");
    }
}
