//! From what length of record on a term can be identified at all.

use super::composite::{Composite, Parameter};
use super::data::NoiseType;
use super::evidence::Evidence;
use super::identification::claims::MAX_IDENTIFIABLE_SIGMA;
use super::identification::linear_fit::{Likelihood, Structure, position};
use super::model::{NoiseModel, TERMS};
use nalgebra::{DMatrix, DVector};

/// Longest record considered, h.
pub const MAX_HOURS: f64 = 20_000.0;
/// Means that stand for a record: slow terms need no more.
const MAX_MEANS: f64 = 16_384.0;

/// Relative standard deviation at the Cramér-Rao bound of a coefficient in a record of `hours`, the terms of `model`
/// being all there is; `None` when the model lacks the term or the record is too short.
pub fn relative_bound(term: NoiseType, model: &NoiseModel, hours: f64, tau0_s: f64) -> Option<f64> {
    let value = model.coefficient(term).abs();
    let tau_s = tau0_s.max(hours * 3600.0 / MAX_MEANS);
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

/// Shortest record, h, in which a term of `model` is identifiable; `None` when [`MAX_HOURS`] do not suffice.
pub fn hours_until_identifiable(term: NoiseType, model: &NoiseModel, tau0_s: f64) -> Option<f64> {
    shortest(|h| relative_bound(term, model, h, tau0_s))
}

fn shortest(bound: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    let enough = |h: f64| bound(h).is_some_and(|r| r <= MAX_IDENTIFIABLE_SIGMA);
    let (mut low, mut high) = (0.0, 1.0);
    while !enough(high) {
        low = high;
        high *= 2.0;
        if high > MAX_HOURS {
            return None;
        }
    }
    while high - low > 0.04 * high && high > 0.01 {
        let middle = 0.5 * (low + high);
        if enough(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

/// Frequencies at which a model is looked at for an octave.
const PER_OCTAVE: f64 = 24.0;

/// As [`relative_bound`], of a description with Markov processes and disturbances, everything in `parameters` unknown:
/// the Fisher information of Whittle's likelihood, summed over the modes of the record.
fn relative_bound_among(
    wanted: Parameter,
    model: &Composite,
    parameters: &[Parameter],
    hours: f64,
    tau0_s: f64,
) -> Option<f64> {
    let at = parameters.iter().position(|p| *p == wanted)?;
    let length_s = hours * 3600.0;
    let (lowest_hz, highest_hz) = (0.5 / length_s, 0.5 / tau0_s);
    let steps = ((highest_hz / lowest_hz).log2() * PER_OCTAVE).ceil();
    if !(steps >= 1.0 && steps.is_finite()) || length_s < 64.0 * tau0_s {
        return None;
    }
    let ratio = (highest_hz / lowest_hz).powf(1.0 / steps);
    let mut information = DMatrix::<f64>::zeros(parameters.len(), parameters.len());
    for i in 0..steps as usize {
        let from = lowest_hz * ratio.powi(i as i32);
        let (f, modes) = (from * ratio.sqrt(), 2.0 * length_s * from * (ratio - 1.0));
        let slope = |p: &Parameter| {
            let value = model.value(*p);
            let of = |x: f64| model.with(*p, x).density(f, tau0_s).max(f64::MIN_POSITIVE).ln();
            // By the logarithm of the parameter: the scales of the parameters differ by many orders.
            (of(1.001 * value) - of(0.999 * value)) / 0.002
        };
        let slopes = DVector::from_iterator(parameters.len(), parameters.iter().map(slope));
        information += 0.5 * modes * &slopes * slopes.transpose();
    }
    let bound = information.try_inverse()?[(at, at)].sqrt();
    bound.is_finite().then_some(bound)
}

/// As [`hours_until_identifiable`], of a description with Markov processes and disturbances.
pub fn hours_until_identifiable_among(
    wanted: Parameter,
    model: &Composite,
    parameters: &[Parameter],
    tau0_s: f64,
) -> Option<f64> {
    shortest(|h| relative_bound_among(wanted, model, parameters, h, tau0_s))
}

#[cfg(test)]
mod tests {
    use super::super::composite::Damped;
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
    fn a_markov_process_beside_it_makes_flicker_need_longer() {
        let terms = NoiseModel { n: 0.002, b: 0.006, ..Default::default() };
        let flicker = Parameter::Coefficient(NoiseType::Flicker);
        let of = |markov: Vec<Damped>| {
            let mut parameters = vec![Parameter::Coefficient(NoiseType::AngleRandomWalk), flicker];
            parameters
                .extend(markov.iter().flat_map(|_| [Parameter::MarkovSigma(0), Parameter::MarkovTime(0)]));
            let model = Composite { terms, markov, ..Default::default() };
            hours_until_identifiable_among(flicker, &model, &parameters, 1.0).unwrap()
        };
        let (alone, exact) = (of(vec![]), hours_until_identifiable(NoiseType::Flicker, &terms, 1.0).unwrap());
        assert!((alone / exact - 1.0).abs() < 0.2, "{alone} {exact}");
        let beside = of(vec![Damped { rms_deg_h: 0.01, frequency_hz: 0.0, decay_time_s: 300.0 }]);
        assert!(beside > 2.0 * alone, "{beside} {alone}");
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
        assert!((at.unwrap() / MAX_IDENTIFIABLE_SIGMA - 1.0).abs() < 0.06, "{at:?}");
    }
}
