//! Identification of N, B, K, Q and R alone.

use super::claims::{
    FLICKER_INDEX, LIMIT_COVERAGE, LIMIT_RISE, MIN_RIVAL_RATIO, MIN_SUSPICION_RATIO, QUANTIZATION_INDEX,
    SlowChoice, WALK_INDEX, WHITE_INDEX, WHITTLE_METHOD, contains_term, is_claimable, low_frequency_note,
    rival_of, suspects, with_rivals,
};
use super::linear_fit::{Likelihood, RAMP_INDEX, Structure, toggled};
use super::misfit::Misfit;
use super::options::StandardThresholds;
use super::profile::{Profile, wider};
use super::result::{IDS, Identification};
use super::structures::Structures;
use crate::estimate::{Estimate, UpperLimit};
use crate::noise::composite::{Described, Parameter};
use crate::noise::evidence::Evidence;
use crate::noise::model::{NoiseModel, TERMS};

/// The description that N, B, K, R and Q alone give.
fn described(model: NoiseModel, covariance: &[[f64; 5]; 5]) -> Described {
    let present: Vec<usize> = (0..5).filter(|i| model.coefficient(TERMS[*i]) != 0.0).collect();
    // Adding zero leaves every number as it is but −0, which no file should hold.
    let between = |i: usize, j: usize| covariance[i][j] + 0.0;
    Described {
        model: model.into(),
        parameters: present.iter().map(|i| Parameter::Coefficient(TERMS[*i])).collect(),
        covariance: present.iter().map(|i| present.iter().map(|j| between(*i, *j)).collect()).collect(),
    }
}

/// The slow terms that a record is given.
pub(super) fn slow_choice(evidence: &Evidence, thresholds: &StandardThresholds) -> Option<SlowChoice> {
    Some(Structures::fit(&Likelihood::new(evidence)?, &thresholds.slow)?.slow)
}

/// Identifies N, B, K, Q and R by the maximum of Whittle's likelihood; without `intervals` the estimates stay empty.
pub(super) fn identify_standard(
    channel: &str,
    evidence: &Evidence,
    thresholds: &StandardThresholds,
    intervals: bool,
) -> Identification {
    let mut out = Identification::empty(channel);
    let Some(likelihood) = Likelihood::new(evidence) else { return out };
    let Some(search) = Structures::fit(&likelihood, &thresholds.slow) else { return out };
    out.likelihood_ratios = search.ratios;
    let fit = |structure: &Structure| likelihood.maximise(structure, None, None);
    let mut claimed: Structure = [
        search.ratios[WHITE_INDEX] > thresholds.white,
        contains_term(search.slow.set, FLICKER_INDEX),
        contains_term(search.slow.set, WALK_INDEX),
        search.ratios[QUANTIZATION_INDEX] > thresholds.quantization,
        contains_term(search.slow.set, RAMP_INDEX),
    ];
    if let Some(best) = fit(&search.supported(&claimed)) {
        let model = best.model();
        let bound = likelihood.covariance_bound(&model, &search.supported(&claimed));
        for term in [FLICKER_INDEX, WALK_INDEX] {
            let relative = bound[term][term].sqrt() / model.coefficient(TERMS[term]);
            claimed[term] &= is_claimable(term, search.preference[term], relative);
        }
    }
    let supported = search.supported(&claimed);
    let needed = (0..5).any(|i| supported[i] && !claimed[i]);
    out.claimed = TERMS.into_iter().zip(claimed).filter(|(_, c)| *c).map(|(t, _)| t).collect();
    out.ambiguous = needed;
    out.full = search.full.model();
    out.allowed = out.full.into();
    out.model = fit(&claimed).map_or_else(NoiseModel::default, |p| p.model());
    let Some(best) = fit(&supported) else { return out };
    out.supported = best.model();
    out.covariance = likelihood.covariance_bound(&out.supported, &supported);
    out.described = described(out.supported, &out.covariance);
    // Quantisation too weak to be claimed lies in the level of the white noise, which a prediction must allow for.
    if !claimed[QUANTIZATION_INDEX]
        && search.ratios[QUANTIZATION_INDEX] > MIN_SUSPICION_RATIO
        && let structure = toggled(&supported, QUANTIZATION_INDEX, true)
        && let Some(with) = fit(&structure)
    {
        let model = with.model();
        out.described = described(model, &likelihood.covariance_bound(&model, &structure));
    }
    out.misfit = Misfit::of(evidence, &likelihood.whitened(&best), supported.iter().filter(|s| **s).count());
    if !intervals {
        return out;
    }
    let mut estimates: [Option<Estimate>; 5] = [const { None }; 5];
    for (term, slot) in estimates.iter_mut().enumerate() {
        *slot = Some(estimate(&likelihood, channel, term, &claimed, &supported, needed, &search));
    }
    let [n, b, k, q, r] = estimates;
    for (target, estimate) in [
        (&mut out.angle_random_walk, n),
        (&mut out.bias_instability, b),
        (&mut out.rate_random_walk, k),
        (&mut out.quantization, q),
        (&mut out.rate_ramp, r),
    ] {
        if let Some(estimate) = estimate {
            *target = estimate;
        }
    }
    out
}

fn estimate(
    likelihood: &Likelihood,
    channel: &str,
    term: usize,
    claimed: &Structure,
    supported: &Structure,
    ambiguous: bool,
    search: &Structures,
) -> Estimate {
    let (id, unit) = IDS[term];
    let ratios = &search.ratios;
    let structure = *supported;
    if claimed[term]
        && let Some(profile) = Profile::new(likelihood, &structure, term)
    {
        let mut spread = profile.spread();
        // A part too weak to be named may still hold a part of the level of the white noise.
        for other in suspects(term, &structure, ratios) {
            if let Some(wide) = Profile::new(likelihood, &toggled(&structure, other, true), term) {
                spread = wider(profile.value(), &spread, &wide.spread());
            }
        }
        // Flicker and random walk share the lowest frequencies: a rival too weak to be claimed may hold a part of
        // what this term was given.
        if let Some(rival) = rival_of(term)
            && !structure[rival]
            && ratios[rival] > MIN_RIVAL_RATIO
            && let Some(other) = Profile::new(likelihood, &toggled(&structure, rival, true), term)
        {
            spread = wider(profile.value(), &spread, &other.spread());
        }
        let estimate = Estimate::measured(id, channel, profile.value(), unit, spread, WHITTLE_METHOD);
        return with_rivals(estimate, term, search.preference[term]);
    }
    // A limit must hold whatever else is in the record: the largest over the rivals being free and being absent.
    let mut nuisance = [true; 5];
    nuisance[RAMP_INDEX] = claimed[RAMP_INDEX];
    let limit = std::iter::once(nuisance)
        .chain(rival_of(term).filter(|r| !claimed[*r]).map(|r| toggled(&nuisance, r, false)))
        .filter_map(|structure| Profile::new(likelihood, &structure, term)?.upper_limit(LIMIT_RISE))
        .max_by(f64::total_cmp);
    let limit = limit.map(|value| UpperLimit { value, coverage: LIMIT_COVERAGE });
    let alone = rival_of(term).filter(|r| !claimed[*r]).map_or(structure, |r| toggled(&structure, r, false));
    let likely = Profile::new(likelihood, &alone, term).map(|p| p.value().abs());
    let estimate = Estimate::not_identifiable(id, channel, limit, unit, WHITTLE_METHOD).most_likely(likely);
    if ambiguous && term != 0 && supported[term] {
        return estimate.note(low_frequency_note());
    }
    estimate
}
