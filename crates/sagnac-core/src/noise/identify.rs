//! Which noise terms a record shows, and how large they are.

use super::composite::{Described, Parameter};
use super::data::NoiseType;
use super::evidence::Evidence;
use super::fit::{Likelihood, RAMP, Structure, toggled};
use super::identification::{IDS, Identification};
use super::misfit::Misfit;
use super::model::{NoiseModel, TERMS};
use super::profile::{Profile, wider};
use super::slow_terms::{NEARLY, SlowChoice, SlowPrices, holds, needed_preference};
use super::structure::Search;
use crate::estimate::{Estimate, UpperLimit};
use crate::message::Note;

/// A method that identifies noise terms from spectral evidence.
pub trait Identify {
    /// Identifies the terms of one channel.
    fn identify(&self, channel: &str, evidence: &Evidence) -> Identification;

    /// The same without intervals and limits, which take most of the time: what is claimed, the models, the misfit.
    fn describe(&self, channel: &str, evidence: &Evidence) -> Identification {
        self.identify(channel, evidence)
    }

    /// Intervals and limits for what [`Identify::describe`] found in the same evidence; equal to
    /// [`Identify::identify`], and may use that the search has been made.
    fn complete(&self, channel: &str, evidence: &Evidence, _described: &Identification) -> Identification {
        self.identify(channel, evidence)
    }
}

/// Maximum Whittle likelihood with a structure test calibrated by simulation.
///
/// N and Q are claimed when twice the log-likelihood is larger by their threshold than that of the best model without
/// them, all other terms refitted; flicker, random walk and ramp by comparison of their sets ([`SlowPrices`]). Set so that
/// fewer than 7 % of records claim anything absent (validated in the identification study).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Whittle {
    /// Threshold of 2 Δ ln L for N.
    pub white: f64,
    /// Threshold of 2 Δ ln L for Q.
    pub quantization: f64,
    /// Prices of the slow terms.
    pub slow: SlowPrices,
}

impl Default for Whittle {
    fn default() -> Self {
        Whittle { white: 4.0, quantization: 11.0, slow: SlowPrices::default() }
    }
}

impl Whittle {
    /// The slow terms that a record is given.
    pub(super) fn slow_choice(&self, evidence: &Evidence) -> Option<SlowChoice> {
        Some(Search::run(&Likelihood::new(evidence)?, &self.slow)?.slow)
    }

    /// 2 Δ ln L that a term of some relative uncertainty needs against the best model without it.
    pub fn threshold(&self, term: NoiseType, relative_sigma: f64) -> f64 {
        self.slow.against_rival(term, relative_sigma).unwrap_or(match term {
            NoiseType::Quantization => self.quantization,
            _ => self.white,
        })
    }
}

const WHITE: usize = 0;
const FLICKER: usize = 1;
const WALK: usize = 2;
const QUANTIZATION: usize = 3;
/// 2 Δ ln L from which a term that is not claimed widens the interval of N.
pub(super) const SUSPICION: f64 = 1.0;
/// 2 Δ ln L from which a rival that is not claimed widens the interval of a slow term.
pub(super) const RIVALRY: f64 = 0.5;
pub(super) const METHOD: &str = "whittle";
/// Price of a term when the best description is chosen: Akaike's 2 raised to the 5 % point of one amplitude.
pub(super) const PRICE: f64 = 2.71;
/// Coverage of upper limits.
pub(super) const LIMIT_COVERAGE: f64 = 0.95;
/// Rise of the deviance that makes an upper limit. A limit is only given when the term was not claimed, that is when
/// chance made it look small; 5 in place of 2.71 keeps the coverage in spite of that.
pub(super) const LIMIT_RISE: f64 = 5.0;

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

impl Identify for Whittle {
    fn identify(&self, channel: &str, evidence: &Evidence) -> Identification {
        self.run(channel, evidence, true)
    }

    fn describe(&self, channel: &str, evidence: &Evidence) -> Identification {
        self.run(channel, evidence, false)
    }
}

impl Whittle {
    fn run(&self, channel: &str, evidence: &Evidence, intervals: bool) -> Identification {
        let mut out = Identification::empty(channel);
        let Some(likelihood) = Likelihood::new(evidence) else { return out };
        let Some(search) = Search::run(&likelihood, &self.slow) else { return out };
        out.likelihood_ratios = search.ratios;
        let fit = |structure: &Structure| likelihood.maximise(structure, None, None);
        let mut claimed: Structure = [
            search.ratios[WHITE] > self.white,
            holds(search.slow.set, FLICKER),
            holds(search.slow.set, WALK),
            search.ratios[QUANTIZATION] > self.quantization,
            holds(search.slow.set, RAMP),
        ];
        if let Some(best) = fit(&search.supported(&claimed)) {
            let model = best.model();
            let bound = likelihood.covariance_bound(&model, &search.supported(&claimed));
            for term in [FLICKER, WALK] {
                let relative = bound[term][term].sqrt() / model.coefficient(TERMS[term]);
                claimed[term] &= is_told(term, search.preference[term], relative);
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
        if !claimed[QUANTIZATION]
            && search.ratios[QUANTIZATION] > SUSPICION
            && let structure = toggled(&supported, QUANTIZATION, true)
            && let Some(with) = fit(&structure)
        {
            let model = with.model();
            out.described = described(model, &likelihood.covariance_bound(&model, &structure));
        }
        out.misfit =
            Misfit::of(evidence, &likelihood.whitened(&best), supported.iter().filter(|s| **s).count());
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
}

fn estimate(
    likelihood: &Likelihood,
    channel: &str,
    term: usize,
    claimed: &Structure,
    supported: &Structure,
    ambiguous: bool,
    search: &Search,
) -> Estimate {
    let (id, unit) = IDS[term];
    let ratios = &search.ratios;
    let structure = *supported;
    if claimed[term]
        && let Some(profile) = Profile::new(likelihood, &structure, term)
    {
        let mut spread = profile.spread();
        // What is too weak to be named may still hold a part of the level of the white noise.
        for other in suspects(term) {
            if !structure[*other]
                && ratios[*other] > SUSPICION
                && let Some(wide) = Profile::new(likelihood, &toggled(&structure, *other, true), term)
            {
                spread = wider(profile.value(), &spread, &wide.spread());
            }
        }
        // Flicker and random walk share the lowest frequencies: a rival too weak to be claimed may hold a part of
        // what this term was given.
        if let Some(rival) = rival_of(term)
            && !structure[rival]
            && ratios[rival] > RIVALRY
            && let Some(other) = Profile::new(likelihood, &toggled(&structure, rival, true), term)
        {
            spread = wider(profile.value(), &spread, &other.spread());
        }
        let estimate = Estimate::measured(id, channel, profile.value(), unit, spread, METHOD);
        return with_rivals(estimate, term, search.preference[term]);
    }
    // A limit must hold whatever else is in the record: the largest over the rivals being free and being absent.
    let mut nuisance = [true; 5];
    nuisance[RAMP] = claimed[RAMP];
    let limit = std::iter::once(nuisance)
        .chain(rival_of(term).filter(|r| !claimed[*r]).map(|r| toggled(&nuisance, r, false)))
        .filter_map(|structure| Profile::new(likelihood, &structure, term)?.upper_limit(LIMIT_RISE))
        .max_by(f64::total_cmp);
    let limit = limit.map(|value| UpperLimit { value, coverage: LIMIT_COVERAGE });
    let alone = rival_of(term).filter(|r| !claimed[*r]).map_or(structure, |r| toggled(&structure, r, false));
    let likely = Profile::new(likelihood, &alone, term).map(|p| p.value().abs());
    let estimate = Estimate::not_identifiable(id, channel, limit, unit, METHOD).most_likely(likely);
    if ambiguous && term != 0 && supported[term] {
        return estimate.note(low_frequency_note());
    }
    estimate
}

/// True when a slow term that was chosen may be claimed. A rival nearly as good matters little while the term is known
/// well; one that is hardly identifiable is claimed only where it is clearly preferred. Flicker needs some preference all the
/// same: chance makes a random walk look like it in one record of twelve.
pub(super) fn is_told(term: usize, preference: f64, relative_sigma: f64) -> bool {
    preference >= needed_preference(TERMS[term], relative_sigma)
}

/// Says so where another slow term in place of this one describes the record nearly as well.
pub(super) fn with_rivals(estimate: Estimate, term: usize, preference: f64) -> Estimate {
    let slow = matches!(term, FLICKER | WALK | RAMP);
    if slow && preference < NEARLY {
        estimate.note(Note::new("slow_alike.term").with("fall", preference))
    } else {
        estimate
    }
}

/// Low-frequency noise is there, and which of the terms it is stays open.
pub(super) fn low_frequency_note() -> Note {
    Note::new("note.low_frequency_ambiguous")
}

/// Terms that may hold a part of this one while too weak to be claimed.
pub(super) fn suspects(term: usize) -> &'static [usize] {
    match term {
        WHITE => &[FLICKER, WALK, QUANTIZATION],
        QUANTIZATION => &[FLICKER, WALK],
        _ => &[],
    }
}

/// The term that can stand for this one at the lowest frequencies.
pub(super) fn rival_of(term: usize) -> Option<usize> {
    match term {
        FLICKER => Some(WALK),
        WALK => Some(FLICKER),
        _ => None,
    }
}
