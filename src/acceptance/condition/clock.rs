//! Whether the stamps can be what they are taken for: the unit of the time, even steps, a rate that is no round number.

use super::facts::{Condition, Facts, record};
use crate::i18n::note;
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct Clock;

/// Recordings are shorter.
const MAX_DURATION_S: f64 = 366.0 * 86_400.0;
/// Gyros are sampled more slowly.
const MAX_RATE_HZ: f64 = 1e6;
/// Rms scatter of the stamps, in intervals, from which they are not those of a uniform clock.
const MAX_STAMP_SCATTER: f64 = 0.15;
/// Relative difference from a round rate below which it is met.
const RATE_TOLERANCE: f64 = 1e-3;
/// Relative difference up to which a round rate is the one that was meant.
const RATE_SLIP_TOLERANCE: f64 = 0.06;

impl Condition for Clock {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        if !facts.has_stamps {
            facts.checks.not_made("clock", None, "check_list.no_stamps");
            return vec![];
        }
        facts.checks.made("clock", None, "clock");
        let rate_hz = 1.0 / facts.sample_interval_s;
        let note = if facts.duration_s > MAX_DURATION_S {
            note!("clock.too_long", years = facts.duration_s / (365.25 * 86_400.0), hz = rate_hz)
        } else if rate_hz > MAX_RATE_HZ {
            note!("clock.too_fast", hz = rate_hz)
        } else if let Some(jitter_s) =
            facts.integrity.timestamp_jitter_s.filter(|j| *j > MAX_STAMP_SCATTER * facts.sample_interval_s)
        {
            note!(
                "clock.uneven",
                jitter_s,
                interval_s = facts.sample_interval_s,
                percent = 100.0 * jitter_s / facts.sample_interval_s
            )
        } else if let Some(round_hz) =
            round_near(rate_hz).filter(|_| facts.procedure.sample_rate_hz.is_none())
        {
            note!("clock.not_round", hz = rate_hz, round_hz, percent = (rate_hz / round_hz - 1.0) * 100.0)
        } else {
            return vec![];
        };
        let required = note!("clock.required");
        vec![record("clock", ConditionStatus::Remark, &[("measured_hz", rate_hz)], Some(required), note)]
    }
}

/// First digits of rates and intervals that people set.
const USUAL_DIGITS: [f64; 6] = [1.0, 2.0, 4.0, 5.0, 8.0, 10.0];

/// The round rate that a rate is near and does not meet. Round are rates of two digits, intervals of two digits that are not
/// near a usual one, and powers of two times powers of ten: clocks of sensors make rates such as 95 Hz, and nobody sets 21 s.
fn round_near(rate_hz: f64) -> Option<f64> {
    let two_digits = |v: f64| {
        let scale = 10f64.powf(v.log10().floor() - 1.0);
        (v / scale).round() * scale
    };
    let interval_s = two_digits(1.0 / rate_hz);
    let powers = |v: f64| {
        (0..=14).map(move |k| {
            let two = 2f64.powi(k);
            two * 10f64.powf((v / two).log10().round())
        })
    };
    let met = |round: f64| (rate_hz / round - 1.0).abs() <= RATE_TOLERANCE;
    if met(two_digits(rate_hz)) || is_set(interval_s) && met(1.0 / interval_s) || powers(rate_hz).any(met) {
        return None;
    }
    // What people set: 1, 2, 4, 5, 8 and 10 times a power of ten, in Hz and where samples are slow in s.
    let usual = |v: f64| USUAL_DIGITS.map(|d| d * 10f64.powf(v.log10().floor()));
    let intervals = usual(1.0 / rate_hz).into_iter().filter(|s| *s >= 1.0).map(|s| 1.0 / s);
    let off = |r: &f64| (rate_hz / r - 1.0).abs();
    usual(rate_hz)
        .into_iter()
        .chain(intervals)
        .min_by(|a, b| off(a).total_cmp(&off(b)))
        .filter(|r| off(r) <= RATE_SLIP_TOLERANCE)
}

/// Whether an interval of two digits may have been set: it is a usual one or near none. 48 and 96 are parts of binary rates.
fn is_set(interval_s: f64) -> bool {
    let digits = interval_s / 10f64.powf(interval_s.log10().floor());
    let off = |usual: &f64| (digits / usual - 1.0).abs();
    let nearest = USUAL_DIGITS.iter().map(off).fold(f64::INFINITY, f64::min);
    let binary = [4.8, 9.6].iter().any(|b| off(b) < RATE_TOLERANCE);
    binary || !(RATE_TOLERANCE..=RATE_SLIP_TOLERANCE).contains(&nearest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_is_off_is_told_from_a_rate_that_was_set() {
        for set in
            [0.1, 1.0, 100.0, 64.0, 102.4, 1000.0, 250.0, 12.5, 1.0 / 15.0, 8000.0, 95.0, 0.05, 1.0 / 30.0]
        {
            assert_eq!(round_near(set), None, "{set}");
        }
        // 21 s and 19 s are 20 s by a clock that is 5 % off.
        let off = [
            (0.1 / 1.04, 0.1),
            (1.0 / 1.04, 1.0),
            (962.4, 1000.0),
            (103.9, 100.0),
            (1.0 / 21.0, 0.05),
            (1.0 / 19.0, 0.05),
            (1.0 / 4.2, 0.25),
        ];
        for (measured, meant) in off {
            assert!((round_near(measured).unwrap() / meant - 1.0).abs() < 1e-12, "{measured}");
        }
    }
}
