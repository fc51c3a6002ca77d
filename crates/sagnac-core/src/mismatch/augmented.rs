//! The claim that explains the recording.

use super::nuisances::nuisance_value;
use super::problem::{Problem, level, scaled};
use super::samples;
use super::tried::Tried;
use crate::claim::{Claim, Stated};
use crate::effect::{Effect, Model, Nuisance, SpectrumAct};
use crate::noise::data::NoiseType;

/// The claim with its nuisances as fitted and the effects stated. A coefficient that an effect sets free stays as
/// claimed: the effect states it. A level of the noise that was found frees N as well: what it comes to is the claim's.
/// `correction` is what the hypothesis adds to each sample.
pub(super) fn augmented(
    problem: &Problem,
    given: &Claim,
    best: &Tried,
    mut stated: Vec<Stated>,
    levelled: bool,
    correction: Option<&[f64]>,
) -> Claim {
    let mut claim = Claim {
        sample_rate_hz: given.sample_rate_hz,
        quantization_lsb_arcsec: given.quantization_lsb_arcsec,
        ..problem.claim.clone()
    };
    claim.noise.q = given.noise.q;
    let noise = &best.hypothesis.noise;
    for (i, slot) in [&mut claim.noise.n, &mut claim.noise.b, &mut claim.noise.k].into_iter().enumerate() {
        let by_level = i == 0 && levelled && !stated.iter().any(|s| frees_white_noise(s.effect));
        if !noise.freed[i] || by_level {
            *slot = noise.base[i];
        }
    }
    let observed = &problem.residual;
    let coefficient = nuisance_value(problem, best, Nuisance::TemperatureCoefficient);
    if let Some(t) = &mut claim.mean.temperature {
        t.coefficient_deg_h_per_degc += coefficient;
    }
    if let Some(ppm) = &mut claim.mean.scale_factor_ppm {
        *ppm += nuisance_value(problem, best, Nuisance::ScaleFactor);
    }
    // The bias is what is left of the mean.
    let n = observed.len().max(1) as f64;
    let added = correction.map_or(0.0, |c| c.iter().sum::<f64>() / n);
    claim.mean.bias_deg_h = observed.iter().sum::<f64>() / n - added;
    claim.effects.append(&mut stated);
    // N, B and K are those that the stated level multiplies.
    if let Some((_, rms)) = level(&claim, &problem.drivers) {
        claim.noise = scaled(claim.noise, 1.0 / rms);
    }
    let missing = samples::missing(problem, &claim).into_iter();
    claim.effects.extend(missing.map(|(effect, found)| Stated { effect, values: found.stated }));
    claim
}

fn frees_white_noise(effect: &dyn Effect) -> bool {
    let frees = SpectrumAct::Frees(NoiseType::AngleRandomWalk);
    matches!(effect.model(), Model::Spectrum(s) if s.act() == frees)
}
