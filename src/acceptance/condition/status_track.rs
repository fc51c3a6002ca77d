//! One pass over a status word: samples whose bits are not as they must be.

use crate::config::procedure::model::StatusCondition;

/// Bits of a status word.
const STATUS_BITS: u32 = 53;

/// One pass over a status word.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StatusTrack {
    failure_mask: u64,
    valid_mask: u64,
    /// Samples with a number.
    pub samples: u64,
    /// Samples with a failure bit, without a valid-data bit, or with no status word at all.
    pub bad: u64,
    /// Bits that were wrong at any time.
    pub wrong_bits: u64,
    /// Time of the first bad sample from the start of the recording, s.
    pub first_s: Option<f64>,
}

impl StatusTrack {
    /// A track for the bits that a condition names.
    pub fn new(condition: &StatusCondition) -> StatusTrack {
        // Whole numbers up to 2⁵³ by the range of the keys.
        let mask = |value: f64| value as u64;
        StatusTrack {
            failure_mask: mask(condition.failure_mask),
            valid_mask: mask(condition.valid_mask),
            ..StatusTrack::default()
        }
    }

    /// Takes samples at an interval; `time_s` is the time of the first one from the start of the recording.
    pub fn push(&mut self, values: &[f64], time_s: f64, interval_s: f64) {
        for (i, value) in values.iter().enumerate() {
            self.samples += 1;
            let wrong = self.wrong(*value);
            if wrong != Some(0) {
                self.bad += 1;
                self.wrong_bits |= wrong.unwrap_or(0);
                self.first_s.get_or_insert(time_s + i as f64 * interval_s);
            }
        }
    }

    /// The bits of a word that are not as they must be; `None` for what is no word.
    fn wrong(&self, value: f64) -> Option<u64> {
        let is_word = value.fract() == 0.0 && value.abs() < 2f64.powi(STATUS_BITS as i32);
        // A word with a sign stands for its two's complement.
        let word = if value < 0.0 { value as i64 as u64 } else { value as u64 };
        is_word.then_some((word & self.failure_mask) | (!word & self.valid_mask))
    }
}

/// Bits of a word, counted from 0: `0, 3`; a dash where there are none.
pub fn bits(word: u64) -> String {
    let set: Vec<String> = (0..u64::BITS).filter(|b| word >> b & 1 == 1).map(|b| b.to_string()).collect();
    if set.is_empty() { "–".to_owned() } else { set.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(failure_mask: f64, valid_mask: f64, values: &[f64]) -> StatusTrack {
        let condition = StatusCondition { channel: "status".into(), failure_mask, valid_mask, allowed: None };
        let mut track = StatusTrack::new(&condition);
        track.push(values, 10.0, 0.5);
        track
    }

    #[test]
    fn failure_bits_and_valid_bits_are_read_from_the_word() {
        let found = track(240.0, 1.0, &[1.0, 1.0, 33.0, 0.0, 3.0]);
        assert_eq!((found.samples, found.bad, found.first_s), (5, 2, Some(11.0)));
        assert_eq!(bits(found.wrong_bits), "0, 5");
        assert_eq!(track(240.0, 1.0, &[1.0, 15.0]).bad, 0);
    }

    #[test]
    fn what_is_no_word_is_bad_and_a_sign_is_a_bit() {
        assert_eq!(track(1.0, 0.0, &[0.5, f64::NAN, 1e300]).bad, 3);
        assert_eq!(track(1.0, 0.0, &[-2.0, -1.0]).bad, 1);
    }
}
