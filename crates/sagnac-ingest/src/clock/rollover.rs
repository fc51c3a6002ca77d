//! Stamps and counters that start again: clock time at midnight, seconds of a week, counters of limited width.

/// Widths of counters and timers at which a fall is taken for a roll-over: values of the file.
const WIDTHS: [f64; 5] = [256.0, 65_536.0, 16_777_216.0, 2_147_483_648.0, 4_294_967_296.0];

/// Periods of clock time, s.
const CLOCK_PERIODS_S: [f64; 3] = [86_400.0, 604_800.0, 43_200.0];

/// Periods after which stamps may start again, s; `scale_s` is the unit of the file. Eight bits are too few for a clock.
pub fn moduli(scale_s: f64) -> Vec<f64> {
    let widths = WIDTHS.iter().skip(1).map(|w| w * scale_s);
    CLOCK_PERIODS_S.iter().copied().chain(widths).filter(|m| m.is_finite() && *m > 0.0).collect()
}

/// A roll-over that was undone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rollover {
    /// Position in the block.
    pub at: usize,
    /// Period that was added.
    pub period: f64,
}

/// Undoes roll-overs as values go by.
#[derive(Debug, Clone)]
pub struct Unwrapper {
    /// The declared period: every fall by more than half of it is a roll-over.
    declared: Option<f64>,
    /// Other periods that are looked for.
    periods: Vec<f64>,
    /// Longest step across a roll-over that was not declared.
    step_limit: f64,
    last: Option<f64>,
    offset: f64,
}

impl Unwrapper {
    /// Looks for a declared period, or for any of the usual ones where none is declared. A period that was not declared
    /// counts only where the values run on across it within `step_limit`.
    pub fn new(declared: Option<f64>, usual: Vec<f64>, step_limit: f64) -> Unwrapper {
        Unwrapper {
            declared: declared.filter(|p| p.is_finite() && *p > 0.0),
            periods: if declared.is_some() { Vec::new() } else { usual },
            step_limit,
            last: None,
            offset: 0.0,
        }
    }

    /// For a counter: any of the usual widths, or the declared one.
    pub fn of_counter(declared: Option<f64>) -> Unwrapper {
        Unwrapper::new(declared, WIDTHS.to_vec(), 1.5)
    }

    /// Where a counter steps by more than 1 a row, the longest step that is taken across a roll-over.
    pub fn set_step_limit(&mut self, limit: f64) {
        self.step_limit = limit;
    }

    /// Undoes the roll-overs of a block in place and tells where they were.
    pub fn apply(&mut self, values: &mut [f64]) -> Vec<Rollover> {
        let mut found = Vec::new();
        if self.offset == 0.0 && self.unbroken(values) {
            self.last = values.last().copied().or(self.last);
            return found;
        }
        for (at, value) in values.iter_mut().enumerate() {
            let raw = *value;
            if !raw.is_finite() {
                continue;
            }
            if let Some(period) = self.last.and_then(|last| self.period(last, raw)) {
                self.offset += period;
                found.push(Rollover { at, period });
            }
            // A value from the end of the period soon after its fall is a straggler.
            let straggler = self.last.is_some_and(|last| {
                self.declared
                    .is_some_and(|p| last < 0.05 * p && raw > 0.95 * p && raw <= p && self.offset >= p)
            });
            if straggler {
                *value = raw + self.offset - self.declared.unwrap_or(0.0);
                continue;
            }
            self.last = Some(raw);
            *value = raw + self.offset;
        }
        found
    }

    /// True when nothing in a block falls.
    fn unbroken(&self, values: &[f64]) -> bool {
        let first = values.first().copied().unwrap_or(f64::INFINITY);
        let mut good = self.last.is_none_or(|last| first >= last);
        for (a, b) in values.iter().zip(values.get(1..).unwrap_or_default()) {
            good &= b >= a;
        }
        good
    }

    fn period(&self, last: f64, raw: f64) -> Option<f64> {
        let fall = last - raw;
        if fall <= 0.0 {
            return None;
        }
        if let Some(declared) = self.declared {
            return (fall > 0.5 * declared).then_some(declared);
        }
        let fits = |p: &&f64| {
            let across = **p - fall;
            // Both sides lie near the ends of the period, so that a clock that was set is not taken for one.
            across >= 0.0
                && across <= self.step_limit
                && raw >= -self.step_limit
                && raw <= self.step_limit
                && last <= **p
        };
        self.periods.iter().find(fits).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wrap(values: impl Iterator<Item = f64>, period: f64) -> Vec<f64> {
        values.map(|v| v.rem_euclid(period)).collect()
    }

    #[test]
    fn usual_periods_are_found_and_undone_exactly() {
        for (period, step, scale) in [
            (86_400.0, 1.0, 1.0),
            (604_800.0, 0.5, 1.0),
            (65.536, 0.001, 1e-3),
            (65_536e-6, 100e-6, 1e-6),
            (4_294.967_296, 0.01, 1e-6),
            (4_294_967.296, 10.0, 1e-3),
        ] {
            let truth: Vec<f64> = (0..5000).map(|i| period - 2000.3 * step + f64::from(i) * step).collect();
            let mut found = 0;
            let mut values = wrap(truth.iter().copied(), period);
            let mut unwrapper = Unwrapper::new(None, moduli(scale), 1.5 * step);
            for part in values.chunks_mut(777) {
                found += unwrapper.apply(part).len();
            }
            let periods = |v: f64| (v / period).floor();
            assert_eq!(found as f64, periods(truth[4999]) - periods(truth[0]), "{period}");
            for (a, b) in values.iter().zip(&truth) {
                let (a, b) = (a - values[0], b - truth[0]);
                assert!((a - b).abs() < 1e-9 * period, "{period} {a} {b}");
            }
        }
    }

    #[test]
    fn a_declared_period_is_undone_across_a_gap_and_a_clock_that_was_set_is_not() {
        let mut values = vec![80_000.0, 80_001.0, 10.0, 11.0];
        assert_eq!(Unwrapper::new(Some(86_400.0), vec![], 1.5).apply(&mut values).len(), 1);
        assert_eq!(values, [80_000.0, 80_001.0, 86_410.0, 86_411.0]);
        let mut values = vec![80_000.0, 80_001.0, 10.0, 11.0];
        assert!(Unwrapper::new(None, moduli(1.0), 1.5).apply(&mut values).is_empty());
        assert_eq!(values, [80_000.0, 80_001.0, 10.0, 11.0]);
    }

    #[test]
    fn counters_of_every_width_run_on() {
        for width in WIDTHS {
            let truth: Vec<f64> = (0..2000).map(|i| width - 100.0 + f64::from(i)).collect();
            let mut values = wrap(truth.iter().copied(), width);
            let found = Unwrapper::of_counter(None).apply(&mut values);
            assert!(!found.is_empty() && found.iter().all(|r| r.period == width));
            assert_eq!(values, truth);
        }
    }
}
