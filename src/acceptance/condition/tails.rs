//! Whether the values are spread as noise is. Where they were clipped, thinned out or replaced, every figure of their noise is
//! too small.

use super::facts::{Condition, Facts, GyroFact, id_of, record};
use crate::i18n::note;
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct Tails;

impl Condition for Tails {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let one = |gyro: &GyroFact| {
            let Some(shape) = gyro.tails else {
                facts.checks.not_made("distribution", Some(&gyro.channel), "check_list.no_plain_noise");
                return None;
            };
            facts.checks.made("distribution", Some(&gyro.channel), "tails");
            if !shape.is_short() {
                return None;
            }
            let note = note!(
                "tails.short",
                channel = gyro.channel.clone(),
                kurtosis = shape.excess_kurtosis,
                error = shape.kurtosis_error(),
                beyond = shape.beyond,
                sigma = shape.sigma,
                expected = shape.expected_beyond
            );
            let observed = [
                ("excess_kurtosis", shape.excess_kurtosis),
                ("beyond", shape.beyond as f64),
                ("expected_beyond", shape.expected_beyond),
            ];
            let required = Some(note!("tails.required"));
            let id = id_of("tails", &gyro.channel, facts);
            Some(record(id, ConditionStatus::Invalid, &observed, required, note))
        };
        facts.gyros.iter().filter_map(one).collect()
    }
}
