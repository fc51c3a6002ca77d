//! Values of the claim that it states with an uncertainty, before and after.

use super::finding::NuisanceValue;
use super::hypothesis::kept;
use super::problem::Problem;
use super::tried::Tried;
use crate::effect::Nuisance;

/// The value of a nuisance column in a fit; 0 where its prior was given up.
pub(super) fn nuisance_value(problem: &Problem, tried: &Tried, nuisance: Nuisance) -> f64 {
    let kept = kept(&problem.spectra.full, &tried.hypothesis.courses);
    let at = kept.iter().position(|n| n.nuisance == nuisance);
    at.and_then(|i| tried.fit.mean.coefficients.get(i)).copied().unwrap_or(0.0)
}

/// What the claim states with its uncertainty, and where both fits put it.
pub(super) fn nuisances(problem: &Problem, base: &Tried, best: &Tried) -> Vec<NuisanceValue> {
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
