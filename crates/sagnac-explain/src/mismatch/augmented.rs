//! The claim that explains the recording, and what becomes of the values that it states with an uncertainty.

use super::finding::NuisanceValue;
use super::fitted_hypothesis::FittedHypothesis;
use super::hypothesis::kept;
use super::problem::{Problem, level, scaled};
use super::samples;
use crate::claim::{Claim, Stated};
use crate::effect::{Effect, Model, Nuisance, SpectrumAct};
use crate::noise::data::NoiseType;

/// The claim with its nuisances as fitted and the effects stated. A coefficient that an effect unconstrains stays as
/// claimed: the effect states it. A level of the noise that was found unconstrains N as well: what it comes to is the claim's.
/// `correction` is what the hypothesis adds to each sample.
pub(super) fn augmented(
    problem: &Problem,
    given: &Claim,
    best: &FittedHypothesis,
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
        let by_level = i == 0 && levelled && !stated.iter().any(|s| unconstrains_white_noise(s.effect));
        if !noise.unconstrained[i] || by_level {
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

fn unconstrains_white_noise(effect: &dyn Effect) -> bool {
    let act = SpectrumAct::Unconstrains(NoiseType::AngleRandomWalk);
    matches!(effect.model(), Model::Spectrum(s) if s.act() == act)
}

/// The value of a nuisance column in a fit; 0 where its prior was given up.
fn nuisance_value(problem: &Problem, tried: &FittedHypothesis, nuisance: Nuisance) -> f64 {
    let kept = kept(&problem.spectra.full, &tried.hypothesis.courses);
    let at = kept.iter().position(|n| n.nuisance == nuisance);
    at.and_then(|i| tried.fit.mean.coefficients.get(i)).copied().unwrap_or(0.0)
}

/// Claimed values with their uncertainties, and their estimates by both fits.
pub(super) fn nuisances(
    problem: &Problem,
    base: &FittedHypothesis,
    best: &FittedHypothesis,
) -> Vec<NuisanceValue> {
    let (claim, u) = (&problem.claim, &problem.claim.uncertainty);
    let mut out = vec![];
    let names = [("N_deg_rt_h", "deg/√h"), ("B_deg_h", "deg/h"), ("K_deg_h_rt_h", "deg/h/√h")];
    let claimed = base.hypothesis.noise.claimed;
    for (i, (name, unit)) in names.into_iter().enumerate() {
        let deviation = base.hypothesis.noise.deviation[i];
        if claimed[i] > 0.0 && deviation > 0.0 {
            out.push(NuisanceValue {
                name: name.to_owned(),
                unit: unit.to_owned(),
                claimed: claimed[i],
                uncertainty: deviation * claimed[i],
                baseline: base.hypothesis.noise.base[i],
                augmented: best.hypothesis.noise.base[i],
            });
        }
    }
    let bound = base.hypothesis.noise.bound;
    for (i, (name, unit)) in
        names.into_iter().enumerate().filter(|(i, _)| claimed[*i] <= 0.0 && bound[*i] > 0.0)
    {
        out.push(NuisanceValue {
            name: name.to_owned(),
            unit: unit.to_owned(),
            claimed: 0.0,
            uncertainty: bound[i],
            baseline: base.hypothesis.noise.base[i],
            augmented: best.hypothesis.noise.base[i],
        });
    }
    if let Some(t) = claim.mean.temperature
        && u.temperature_coefficient_deg_h_per_degc > 0.0
    {
        let value = |tried| {
            t.coefficient_deg_h_per_degc + nuisance_value(problem, tried, Nuisance::TemperatureCoefficient)
        };
        out.push(NuisanceValue {
            name: "coefficient_deg_h_per_degC".to_owned(),
            unit: "deg/h/°C".to_owned(),
            claimed: t.coefficient_deg_h_per_degc,
            uncertainty: u.temperature_coefficient_deg_h_per_degc,
            baseline: value(base),
            augmented: value(best),
        });
    }
    if let Some(ppm) = claim.mean.scale_factor_ppm
        && u.scale_factor_ppm > 0.0
    {
        let value = |tried| ppm + nuisance_value(problem, tried, Nuisance::ScaleFactor);
        out.push(NuisanceValue {
            name: "error_ppm".to_owned(),
            unit: "ppm".to_owned(),
            claimed: ppm,
            uncertainty: u.scale_factor_ppm,
            baseline: value(base),
            augmented: value(best),
        });
    }
    out
}
