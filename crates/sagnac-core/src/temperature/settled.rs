//! Whether a bias had settled when its record ended.
//!
//! The warm-up time is counted against the mean over the final part of a record, which is no final value where the bias
//! drifts on. The decays are therefore drawn again with a time constant as long as the record among them, and what they
//! have still to go at the end, to where they lead, is held against the band.

use super::gls::{Fitted, Modes};
use super::read::{self, Reading};
use super::sampler::{self, Draw, Range};
use nalgebra::DVector;

/// Longest time constants in lengths of the record: of every decay but the slowest, and of the slowest. Two that are both
/// long could cancel over the record and leave its end open; one far longer than the record is a straight line, and where
/// a line leads is a guess.
const MAX_TIME_SHARE: (f64, f64) = (0.35, 1.0);
/// Sweeps over what is not known.
const SWEEPS: usize = 500;
/// Probability of both statements.
pub const STATEMENT_PROBABILITY: f64 = 0.95;
/// Times at which a transient is looked at.
const STEPS: usize = 400;

/// What the end of a record says of the transient.
#[derive(Debug, Clone, PartialEq)]
pub struct Settled {
    /// Distance from where the decays lead, at the end of the record, deg/h.
    pub remaining: Reading,
    /// What it is at most with 95 %, deg/h.
    pub at_most_deg_h: f64,
    /// The bias comes into the band for good not before this time with 95 %, s; never beyond the record.
    pub at_least_s: f64,
}

/// Draws decays from the best ones found, whose time constants lie between a shortest one and the length of the record.
pub fn settled(
    (modes, data): (&Modes, &[f64]),
    of: sampler::Columns<'_>,
    (constants, fitted): (&[f64], &Fitted),
    (low_s, length_s): (f64, f64),
    band_deg_h: f64,
) -> Option<Settled> {
    let last = constants.len().saturating_sub(1);
    let high = |i: usize| length_s * if i == last { MAX_TIME_SHARE.1 } else { MAX_TIME_SHARE.0 };
    let ranges: Vec<Range> =
        (0..=last).map(|i| Range { low: low_s, high: high(i), log: true, step: 0.3 }).collect();
    let start: Vec<f64> = constants.iter().enumerate().map(|(i, c)| c.clamp(low_s, high(i))).collect();
    let fitted = modes.fit(data, &of(&start), Some(fitted.noise))?;
    let model = (of, sampler::Coefficients::Scaled);
    let draws: Vec<Draw> = sampler::sample(modes, data, model, &ranges, (&start, &fitted), SWEEPS);
    if draws.is_empty() {
        return None;
    }
    let off = |draw: &Draw, c: &DVector<f64>, t: f64| -> f64 {
        draw.shape.iter().zip(c.iter()).map(|(k, a)| a * (-t / k).exp()).sum::<f64>().abs()
    };
    let remaining = read::drawn(&draws, |d, c| off(d, c, length_s));
    let time = |i: usize| length_s * i as f64 / STEPS as f64;
    let inside_from = read::drawn(&draws, |d, c| {
        (0..=STEPS).rev().find(|i| off(d, c, time(*i)) > band_deg_h).map_or(0.0, time)
    });
    Some(Settled {
        at_most_deg_h: remaining.spread.bound(remaining.value, STATEMENT_PROBABILITY)?,
        at_least_s: inside_from.spread.bound(inside_from.value, 1.0 - STATEMENT_PROBABILITY)?,
        remaining,
    })
}
