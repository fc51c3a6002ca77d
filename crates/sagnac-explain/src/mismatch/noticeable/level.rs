//! The change of the level of the noise that would have been noticed.

use super::gate::Gate;
use super::solve;
use crate::effect::{Effect, LevelDetector};
use crate::mismatch::named::SAMPLE_EFFECTS;
use crate::mismatch::noticeable_record::{Basis, NoticeableSize, WhyNot};
use crate::mismatch::samples::COMPETING_LAWS;
use std::collections::BTreeMap;

/// Largest ratio that is considered.
const MAX_RATIO: f64 = 1e3;
/// Spread of the logarithm of a level by the differences of neighbouring samples, over that by the samples: their squares
/// are correlated by a quarter. A change must show in both.
const BY_DIFFERENCES: f64 = 1.224_745;

/// Of a level that changes once, halfway through the record.
pub(super) fn size(
    effect: &'static dyn Effect,
    detector: &dyn LevelDetector,
    samples: usize,
    gate: &Gate,
) -> Result<NoticeableSize, WhyNot> {
    let trials = detector.instants_of_change(samples).ok_or(WhyNot::NoSingleSize)?;
    let parameter = effect.params().first().ok_or(WhyNot::NoSingleSize)?;
    let searched = Gate { family: SAMPLE_EFFECTS, ..*gate };
    let threshold = searched.threshold(1, COMPETING_LAWS * trials);
    let needed = (threshold.sqrt() + searched.margin(BY_DIFFERENCES)).powi(2);
    let gain = |excess: f64| twice_gain(1.0 + excess, samples as f64);
    let excess = solve::size(0.1, MAX_RATIO, needed, gain).ok_or(WhyNot::NeverLargeEnough)?;
    Ok(NoticeableSize {
        kind: effect.kind().to_owned(),
        column: None,
        parameter: parameter.name.to_owned(),
        unit: parameter.unit.to_owned(),
        size: 1.0 + excess,
        claimed: None,
        below: false,
        rms_deg_h: None,
        at: BTreeMap::new(),
        worst: None,
        basis: Basis::Level,
    })
}

/// Twice the expected gain of two levels over one, where half of the samples have so many times the deviation of the others.
fn twice_gain(ratio: f64, samples: f64) -> f64 {
    samples * ((0.5 * (1.0 + ratio * ratio)).ln() - ratio.ln())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_levels_gain_what_their_likelihood_says() {
        // 100 samples of variance 1 and 100 of 9: one level has ½ · 200 ln 5, two have ½ · 100 ln 9.
        let gain = 0.5 * 200.0 * 5f64.ln() - 0.5 * 100.0 * 9f64.ln();
        assert!((twice_gain(3.0, 200.0) - 2.0 * gain).abs() < 1e-9);
        assert_eq!(twice_gain(1.0, 200.0), 0.0);
    }
}
