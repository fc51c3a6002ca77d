//! The nominal clock: its interval, how the stamps stand to the samples, and why there may be none.

use super::buffered::{AnchorRow, PAUSE, Uniform};

/// Missing samples beyond which a step forward is taken for a clock that was set, not for missing samples: more than
/// any recording holds.
pub(super) const MAX_GAP_SAMPLES: f64 = 1e8;

/// Why time stamps cannot be used as a time base.
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
    /// The stamps are those of rows in batches or of a clock that loses most samples, and nothing decides.
    #[error("the time stamps come in batches, {rate_hz} rows a second on average, and tell no sample clock")]
    Batches {
        /// Rows over span, Hz.
        rate_hz: f64,
    },
    /// The stamps give a rate that no gyro is sampled at.
    #[error("the time stamps mean {rate_hz} rows a second, which no gyro is sampled at")]
    Absurd {
        /// Rows a second, Hz.
        rate_hz: f64,
    },
    /// The declared rate is no positive number.
    #[error("the declared sample rate {rate_hz} Hz is not a positive number")]
    Rate {
        /// The rate given.
        rate_hz: f64,
    },
}

/// How the time stamps relate to the times of the samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cadence {
    /// Each stamp tells the time of its row well enough to be compared with the one before.
    Even,
    /// Single stamps are off by a large part of the interval, by jitter or rounding: they are compared with the mean
    /// course of the clock.
    Uneven,
    /// Several rows share a stamp or arrive together: the first row of each bunch is compared with the mean course of the
    /// clock, and the others follow at the measured interval.
    Bunched {
        /// Time from one bunch to the next.
        period_s: f64,
        /// Mean number of rows in a bunch.
        rows: f64,
    },
    /// Rows are stamped when their batch is delivered: they are those of a uniform clock, and what is lost is found from
    /// the batches of the whole recording.
    Buffered {
        /// The row of a batch that follows the clock.
        anchor: AnchorRow,
        /// Mean number of rows in a batch.
        rows: f64,
        /// Largest less least departure of the stamps from the clock, s.
        spread_s: f64,
    },
}

/// The nominal clock of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// Nominal sample interval, s.
    pub interval_s: f64,
    /// Resolution of the stamps where they are rounded to a power of ten, s; otherwise 0.
    pub resolution_s: f64,
    /// Longest step between stamps that is not a gap, s.
    pub gap_limit_s: f64,
    /// How the time stamps relate to the times of the samples.
    pub cadence: Cadence,
    /// A second interval, s, that explains the stamps as well: every n-th sample may be lost, or a slower clock may have
    /// rounded stamps.
    pub ambiguous_with_s: Option<f64>,
    /// Departure of the first stamp from the mean course of the clock.
    pub(super) first_residual_s: f64,
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
        Ok(Clock::even(interval_s, 0.0, 1.5 * interval_s))
    }

    /// The uniform clock behind stamps in batches, as found in a whole recording.
    pub fn buffered(found: &Uniform) -> Clock {
        let mut clock = Clock::even(tidy(found.interval_s), 0.0, 1.5 * found.interval_s);
        clock.cadence =
            Cadence::Buffered { anchor: found.anchor, rows: found.rows, spread_s: found.spread_s };
        clock
    }

    /// Step between stamps from which a batch ends, s.
    pub(super) fn pause_s(&self) -> f64 {
        PAUSE * self.interval_s
    }

    /// A clock whose stamps tell the time of their rows.
    pub(super) fn even(interval_s: f64, resolution_s: f64, gap_limit_s: f64) -> Clock {
        Clock {
            interval_s,
            resolution_s,
            gap_limit_s,
            cadence: Cadence::Even,
            ambiguous_with_s: None,
            first_residual_s: 0.0,
        }
    }
}

/// Takes an interval for the round one, or for that of the round rate, that it equals within 1e-9: the rest is rounding.
pub(super) fn tidy(interval_s: f64) -> f64 {
    let six = |v: f64| format!("{v:.5e}").parse::<f64>().unwrap_or(v);
    let near = |v: &f64| (v / interval_s - 1.0).abs() < 1e-9;
    [six(interval_s), 1.0 / six(1.0 / interval_s)].into_iter().find(near).unwrap_or(interval_s)
}
