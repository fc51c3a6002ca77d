//! Whether the values are spread as noise is. Noise of many causes is normal or has longer tails; values that were clipped,
//! thinned out or replaced have shorter ones, and then every figure of their noise is too small.

use super::facts::{Condition, Facts, GyroFact, TailShape, id_of, record};
use crate::estimate::chi_square_tail;
use crate::i18n::Note;
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct Tails;

/// Excess kurtosis of Gaussian noise clipped beyond three standard deviations is −0.16, and its N 1.5 % too small.
const MIN_EXCESS_KURTOSIS: f64 = -0.1;
/// Standard errors that it must lie below zero by.
const MIN_STANDARD_ERRORS: f64 = 8.0;
/// Share of the values expected far out below which they were taken out.
const MIN_SHARE_BEYOND: f64 = 0.25;
/// Probability of as few below which chance is no explanation.
const CHANCE: f64 = 1e-9;

/// True where values far out are missing: of values that were taken out by hand the moments tell only in long records.
fn is_cut(shape: &TailShape) -> bool {
    let expected = shape.expected_beyond * (1.0 - shape.explained.min(1.0));
    let beyond = shape.beyond as f64;
    // The probability of as few of a Poisson law is that of a χ².
    beyond < MIN_SHARE_BEYOND * expected && chi_square_tail(2.0 * expected, 2.0 * (beyond + 1.0)) < CHANCE
}

impl Condition for Tails {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let one = |gyro: &GyroFact| {
            let Some(shape) = gyro.tails.filter(|s| s.samples > 0) else {
                facts.checks.not_made("distribution", Some(&gyro.channel), "check_list.no_plain_noise");
                return None;
            };
            facts.checks.made("distribution", Some(&gyro.channel), "tails");
            let error = (24.0 / shape.samples as f64).sqrt();
            let least = MIN_EXCESS_KURTOSIS.min(-MIN_STANDARD_ERRORS * error) - shape.explained;
            if shape.excess_kurtosis > least && !is_cut(&shape) {
                return None;
            }
            let note = Note::new("tails.short")
                .with("channel", gyro.channel.clone())
                .with("kurtosis", shape.excess_kurtosis)
                .with("error", error)
                .with("beyond", shape.beyond)
                .with("sigma", shape.sigma)
                .with("expected", shape.expected_beyond);
            let observed = [
                ("excess_kurtosis", shape.excess_kurtosis),
                ("beyond", shape.beyond as f64),
                ("expected_beyond", shape.expected_beyond),
            ];
            let required = Some(Note::new("tails.required"));
            let id = id_of("tails", &gyro.channel, facts);
            Some(record(id, ConditionStatus::Invalid, &observed, required, note))
        };
        facts.gyros.iter().filter_map(one).collect()
    }
}
