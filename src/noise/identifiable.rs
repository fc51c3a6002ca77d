//! From what length of record on a term can be identified at all.

use super::data::NoiseType;
use super::evidence::Evidence;
use super::fit::{Likelihood, Structure, position};
use super::model::{NoiseModel, TERMS};

/// Relative standard deviation at the Cramér-Rao bound up to which a term counts as identifiable.
pub const IDENTIFIABLE: f64 = 0.20;
/// Longest record considered, h.
pub const LONGEST_H: f64 = 20_000.0;
/// Means that stand for a record: slow terms need no more.
const MEANS: f64 = 16_384.0;

/// Relative standard deviation at the Cramér-Rao bound of a coefficient in a record of `hours`, the terms of `model`
/// being all there is; `None` when the model lacks the term or the record is too short.
pub fn relative_bound(term: NoiseType, model: &NoiseModel, hours: f64, tau0_s: f64) -> Option<f64> {
    let value = model.coefficient(term).abs();
    let tau_s = tau0_s.max(hours * 3600.0 / MEANS);
    let samples = (hours * 3600.0 / tau_s).floor();
    if value <= 0.0 || samples.is_nan() || samples < 64.0 {
        return None;
    }
    let likelihood = Likelihood::new(&Evidence::expected(model, samples as u64, tau_s))?;
    let structure: Structure = TERMS.map(|t| model.coefficient(t) != 0.0);
    let i = position(term);
    let sd = likelihood.covariance_bound(model, &structure).get(i)?.get(i)?.sqrt();
    (sd.is_finite() && sd > 0.0).then_some(sd / value)
}

/// Shortest record, h, in which a term of `model` is identifiable; `None` when [`LONGEST_H`] do not suffice.
pub fn hours_until_identifiable(term: NoiseType, model: &NoiseModel, tau0_s: f64) -> Option<f64> {
    let enough = |h: f64| relative_bound(term, model, h, tau0_s).is_some_and(|r| r <= IDENTIFIABLE);
    let (mut low, mut high) = (0.0, 1.0);
    while !enough(high) {
        low = high;
        high *= 2.0;
        if high > LONGEST_H {
            return None;
        }
    }
    while high - low > 0.04 * high && high > 0.01 {
        let middle = 0.5 * (low + high);
        if enough(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_noise_is_known_to_one_over_root_two_m() {
        let model = NoiseModel { n: 0.0023, ..Default::default() };
        let r = relative_bound(NoiseType::AngleRandomWalk, &model, 1.0, 1.0).unwrap();
        assert!((r * (2.0 * 3600.0f64).sqrt() - 1.0).abs() < 0.02, "{r}");
        assert_eq!(relative_bound(NoiseType::Flicker, &model, 1.0, 1.0), None);
        assert_eq!(hours_until_identifiable(NoiseType::Flicker, &model, 1.0), None);
    }

    #[test]
    fn a_smaller_floor_needs_a_longer_record() {
        let hours = |floor: f64| {
            let model = NoiseModel { n: 0.0023, b: floor / 0.664, ..Default::default() };
            hours_until_identifiable(NoiseType::Flicker, &model, 1.0).unwrap()
        };
        let (small, large) = (hours(0.0011), hours(0.006));
        // OIUS-501: ten hours do not show the floor, a hundred do (median 2 Δ ln L 0.3 and 28).
        assert!(small > 10.0 && small < 200.0, "{small}");
        assert!(large < small / 10.0, "{large} {small}");
        let at = relative_bound(
            NoiseType::Flicker,
            &NoiseModel { n: 0.0023, b: 0.0011 / 0.664, ..Default::default() },
            small,
            1.0,
        );
        assert!((at.unwrap() / IDENTIFIABLE - 1.0).abs() < 0.06, "{at:?}");
    }
}
