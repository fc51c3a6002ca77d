//! Which averaging times a σ(τ) curve is computed at.

use crate::message::{Arg, Note, note};
use std::fmt;

/// The choice of averaging times.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum TauGrid {
    /// m = 1, 2, 4, 8, ...
    #[default]
    Octave,
    /// About ten a decade, evenly spaced in log τ. From m = 128 on, m is a multiple of the power of two at or below
    /// m/64 (a change of less than 0.8 %), so that a strided sum falls on the same phases.
    Decade,
    /// Every m in a record of at most [`EVERY_FACTOR_UP_TO`] samples, else about 48 a decade as in [`TauGrid::Decade`].
    All,
    /// Exactly these averaging times, s.
    List(Vec<f64>),
}

/// Longest record, in samples, for which [`TauGrid::All`] means every averaging factor.
pub const EVERY_FACTOR_UP_TO: u64 = 50_000;

/// Averaging factors are below this: 2^48 samples are nine years at 1 MHz.
const LARGEST_FACTOR: u64 = 1 << 48;

/// Relative tolerance within which an averaging time must be a multiple of the sample interval.
const MULTIPLE_TOLERANCE: f64 = 1e-6;

/// Mistake in a choice of averaging times.
#[derive(Debug, Clone, PartialEq)]
pub enum TauGridError {
    /// The text is neither a known word nor a list of numbers.
    Unreadable {
        /// The part that was not understood.
        text: String,
    },
    /// A time that is no multiple of the sample interval.
    NotAMultiple {
        /// The time asked for, s.
        tau_s: f64,
        /// The sample interval, s.
        tau0_s: f64,
        /// The next multiple below (never 0), s.
        below_s: f64,
        /// The next multiple above, s.
        above_s: f64,
    },
}

impl TauGridError {
    /// The mistake as a note.
    pub fn note(&self) -> Note {
        match self {
            TauGridError::Unreadable { text } => note!("tau_grid.unreadable", text = text.as_str()),
            TauGridError::NotAMultiple { tau_s, tau0_s, below_s, above_s } => {
                note!(
                    "tau_grid.no_multiple",
                    tau = Arg::Stated(*tau_s),
                    interval = Arg::Stated(*tau0_s),
                    below = Arg::Stated(*below_s),
                    above = Arg::Stated(*above_s)
                )
            }
        }
    }
}

impl fmt::Display for TauGridError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.note().plain())
    }
}

impl std::error::Error for TauGridError {}

impl std::str::FromStr for TauGrid {
    type Err = TauGridError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.trim() {
            "octave" => Ok(TauGrid::Octave),
            "decade" => Ok(TauGrid::Decade),
            "all" => Ok(TauGrid::All),
            list => list
                .split(',')
                .map(|part| match part.trim().parse::<f64>() {
                    Ok(tau) if tau.is_finite() && tau > 0.0 => Ok(tau),
                    _ => Err(TauGridError::Unreadable { text: part.trim().to_owned() }),
                })
                .collect::<Result<Vec<f64>, _>>()
                .map(TauGrid::List),
        }
    }
}

impl TauGrid {
    /// Checks the grid against a sample interval in s.
    ///
    /// # Errors
    /// [`TauGridError::NotAMultiple`] for the first listed time that is no multiple of `tau0_s`.
    pub fn check(&self, tau0_s: f64) -> Result<(), TauGridError> {
        let TauGrid::List(taus) = self else { return Ok(()) };
        for &tau_s in taus {
            let ratio = tau_s / tau0_s;
            let m = ratio.round();
            if !(m >= 1.0 && m < LARGEST_FACTOR as f64 && (ratio / m - 1.0).abs() <= MULTIPLE_TOLERANCE) {
                let below = ratio.floor().max(1.0);
                return Err(TauGridError::NotAMultiple {
                    tau_s,
                    tau0_s,
                    below_s: below * tau0_s,
                    above_s: if ratio < 1.0 { 2.0 * tau0_s } else { (below + 1.0) * tau0_s },
                });
            }
        }
        Ok(())
    }

    /// Ascending averaging factors up to `largest`. `samples` is the length of the record where it is known: it decides
    /// whether [`TauGrid::All`] is every factor.
    pub fn factors(&self, tau0_s: f64, samples: Option<u64>, largest: u64) -> Vec<u64> {
        let largest = largest.min(LARGEST_FACTOR);
        match self {
            TauGrid::Octave => (0..48).map(|k| 1u64 << k).take_while(|&m| m <= largest).collect(),
            TauGrid::Decade => log_spaced(10.0, largest),
            TauGrid::All if samples.is_some_and(|n| n <= EVERY_FACTOR_UP_TO) => (1..=largest).collect(),
            TauGrid::All => log_spaced(48.0, largest),
            TauGrid::List(taus) => {
                let mut factors: Vec<u64> = taus
                    .iter()
                    .map(|tau| (tau / tau0_s).round())
                    .filter(|m| *m >= 1.0 && *m <= largest as f64)
                    .map(|m| m as u64)
                    .collect();
                factors.sort_unstable();
                factors.dedup();
                factors
            }
        }
    }
}

fn log_spaced(per_decade: f64, largest: u64) -> Vec<u64> {
    let mut factors: Vec<u64> = (0..)
        .map(|k| 10f64.powf(f64::from(k) / per_decade))
        .take_while(|m| *m <= 1.02 * largest as f64)
        .map(|m| {
            let step = power_of_two_stride(m as u64) as f64;
            ((m / step).round() * step) as u64
        })
        .filter(|m| *m <= largest)
        .collect();
    factors.dedup();
    factors
}

fn power_of_two_stride(m: u64) -> u64 {
    if m < 128 { 1 } else { 1 << (m / 64).ilog2() }
}

/// The widest step between summed terms that is a divisor of `m` and at most m/64 (1 below m = 128).
pub(crate) fn widest_stride(m: u64) -> u64 {
    if m < 128 {
        return 1;
    }
    if m.is_power_of_two() {
        return m / 64;
    }
    let root = m.isqrt();
    if let Some(q) = (64..=root).find(|q| m.is_multiple_of(*q)) {
        return m / q;
    }
    (1..=root.min(m / 64)).rev().find(|s| m.is_multiple_of(*s)).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_lists_are_read() {
        assert_eq!("decade".parse(), Ok(TauGrid::Decade));
        assert_eq!("1, 10,0.5".parse(), Ok(TauGrid::List(vec![1.0, 10.0, 0.5])));
        assert_eq!("1,x".parse(), Err::<TauGrid, _>(TauGridError::Unreadable { text: "x".into() }));
        assert!("-1".parse::<TauGrid>().is_err() && "".parse::<TauGrid>().is_err());
    }

    #[test]
    fn a_listed_time_must_be_a_multiple() {
        let grid = TauGrid::List(vec![1.0, 0.0125]);
        let error = grid.check(0.01).unwrap_err();
        let TauGridError::NotAMultiple { tau_s, tau0_s, below_s, above_s } = error else {
            panic!("{error:?}")
        };
        assert_eq!((tau_s, tau0_s, below_s, above_s), (0.0125, 0.01, 0.01, 0.02));
        assert!(TauGrid::List(vec![1.0, 0.03]).check(0.01).is_ok());
        assert!(TauGrid::List(vec![0.001]).check(0.01).is_err());
        assert_eq!(TauGrid::List(vec![1.0, 0.03, 1.0]).factors(0.01, None, 1000), vec![3, 100]);
    }

    #[test]
    fn grids_ascend_and_reach_the_end() {
        assert_eq!(TauGrid::Octave.factors(1.0, None, 100), vec![1, 2, 4, 8, 16, 32, 64]);
        assert_eq!(TauGrid::All.factors(1.0, Some(10), 5), vec![1, 2, 3, 4, 5]);
        let decade = TauGrid::Decade.factors(1.0, None, 1_000_000);
        assert!(decade.windows(2).all(|w| w[0] < w[1]), "{decade:?}");
        assert_eq!(&decade[..9], &[1, 2, 3, 4, 5, 6, 8, 10, 13]);
        assert!(decade.contains(&100) && decade.last() >= Some(&990_000));
        assert!(decade.iter().filter(|m| **m >= 128).all(|m| widest_stride(*m) * 128 >= *m));
        assert!(TauGrid::All.factors(1.0, None, u64::MAX).len() < 800);
    }

    #[test]
    fn strides_divide_and_stay_below_a_sixty_fourth() {
        for m in (1..5000).chain([1_000_003, 100_000, 99_991 * 64, 1 << 30]) {
            let s = widest_stride(m);
            assert!(m % s == 0 && (s == 1 || s * 64 <= m), "{m} {s}");
        }
        assert_eq!(widest_stride(100_000), 1250);
        assert_eq!(widest_stride(1009 * 1013), 1013);
    }
}
