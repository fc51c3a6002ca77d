//! A recording against a claim that is taken from a simulated recording: effects that the simulation shows itself are no
//! difference.

use super::engine::explain;
use super::finding::{Explanation, MismatchVerdict};
use super::identify::identify;
use super::options::{Options, Progress};
use super::outcome::Outcome;
use super::simulation_check::SimulationCheck;
use crate::claim::{Claim, Stated};
use crate::effect::{Effect, Model, SpectrumAct};
use crate::estimate::{chi_square_tail, normal_quantile};
use crate::message::Note;
use crate::noise::data::NoiseType;
use crate::series::Series;

/// Rounds in which effects that the simulation shows as well are taken into the claim.
const MAX_ROUNDS: usize = 4;
/// Effects that are counted as tried.
const TRIED_EFFECTS: f64 = 40.0;
/// Probability below which the normal number is that of the leading term of its logarithm.
const MIN_EXACT_PROBABILITY: f64 = 1e-14;
/// Relative deviation of a coefficient that both records together suggested.
const SUGGESTED_DEVIATION: f64 = 0.3;

/// Result of a comparison of a recording with a simulation.
pub struct SimulationClaim {
    /// The explanation.
    pub outcome: Outcome,
    /// The claim that the recording was held against.
    pub claim: Claim,
    /// True where both have the very same samples.
    pub same: bool,
    /// Effects that the simulation shows as well, beyond the claim that was identified from it.
    pub shared: Vec<&'static dyn Effect>,
}

/// Explains a recording against a simulated one.
///
/// # Errors
/// A simulation from which no claim can be taken, and as [`explain`].
pub fn explain_simulation(
    recording: &Series,
    mut simulation: Series,
    options: &Options,
    progress: &mut dyn FnMut(Progress),
) -> Result<SimulationClaim, Note> {
    // Another run has another zero of time: what is stated by its time is looked for as far from the beginning.
    let begin = |s: &Series| s.time_s.first().copied().unwrap_or(0.0);
    let later = begin(recording) - begin(&simulation);
    let same = same_samples(recording, &simulation);
    if later != 0.0 {
        simulation.time_s.iter_mut().for_each(|t| *t += later);
    }
    let mut claim = identify(&simulation, progress)?;
    let rows = |s: &Series| s.rate_deg_h.len().max(1) as f64;
    let share = rows(&simulation) / rows(recording);
    let check = SimulationCheck { simulation: &simulation, options, share };
    let mut shared: Vec<&'static dyn Effect> = vec![];
    let mut outcome = explain(recording.clone(), &claim, options, progress)?;
    if same {
        agree(&mut outcome, 1.0);
        return Ok(SimulationClaim { outcome, claim, same, shared });
    }
    let mut least = 1.0f64;
    let mut left: Vec<Stated> = vec![];
    for round in 0..=MAX_ROUNDS {
        left.clear();
        if outcome.explanation.verdict == MismatchVerdict::Consistent {
            break;
        }
        let mut own: Option<Explanation> = None;
        let mut context = |claim: &Claim| {
            if own.is_none() {
                own = explain(simulation.clone(), claim, options, &mut |_| {}).ok().map(|o| o.explanation);
            }
            own.clone()
        };
        let added = outcome.augmented.effects.iter().skip(claim.effects.len()).cloned();
        let mut both = vec![];
        for stated in added {
            let chance = check.chance(&stated, &claim, &outcome.explanation, &mut || context(&claim));
            if chance * TRIED_EFFECTS < options.alpha {
                left.push(stated);
            } else {
                least = least.min((TRIED_EFFECTS * chance).min(1.0));
                both.push(stated);
            }
        }
        // In the last round what was found is judged and no more.
        if both.is_empty() || round == MAX_ROUNDS {
            break;
        }
        for stated in &both {
            if !shared.iter().any(|e| e.kind() == stated.effect.kind()) {
                shared.push(stated.effect);
            }
        }
        take(&mut claim, both, &outcome.augmented);
        outcome = explain(recording.clone(), &claim, options, progress)?;
    }
    if outcome.explanation.verdict != MismatchVerdict::Consistent && left.is_empty() {
        unnamed(&mut outcome, &claim, &check, least);
    }
    Ok(SimulationClaim { outcome, claim, same, shared })
}

fn same_samples(a: &Series, b: &Series) -> bool {
    let alike = |x: &[f64], y: &[f64]| {
        x.len() == y.len() && x.iter().zip(y).all(|(x, y)| x == y || (x.is_nan() && y.is_nan()))
    };
    alike(&a.rate_deg_h, &b.rate_deg_h)
        && alike(&a.time_s, &b.time_s)
        && a.columns.len() == b.columns.len()
        && a.columns.iter().all(|(c, x)| b.columns.get(c).is_some_and(|y| alike(x, y)))
}

/// Takes effects into a claim. Coefficients of the noise and the step of the output are values of the claim itself.
fn take(claim: &mut Claim, effects: Vec<Stated>, augmented: &Claim) {
    for stated in effects {
        if stated.effect.sets_level() {
            (claim.noise.n, claim.noise.b, claim.noise.k) =
                (augmented.noise.n, augmented.noise.b, augmented.noise.k);
        }
        if let Model::Spectrum(spectrum) = stated.effect.model()
            && let SpectrumAct::Unconstrains(term) = spectrum.act()
            && let Some(value) = spectrum.claimed_parameters(&stated.values).and_then(|v| v.first().copied())
        {
            let (noise, u) = (&mut claim.noise, &mut claim.uncertainty);
            let (slot, known) = match term {
                NoiseType::AngleRandomWalk => (&mut noise.n, &mut u.n_rel),
                NoiseType::Flicker => (&mut noise.b, &mut u.b_rel),
                _ => (&mut noise.k, &mut u.k_rel),
            };
            (*slot, *known) = (value, if *known > 0.0 { *known } else { SUGGESTED_DEVIATION });
            continue;
        }
        let near = |lsb: f64| (lsb / claim.quantization_lsb_arcsec - 1.0).abs() < 0.3;
        if let Some(lsb) = stated.effect.rounding().and_then(|r| r.step_arcsec(&stated.values))
            && (claim.quantization_lsb_arcsec == 0.0 || near(lsb))
        {
            claim.quantization_lsb_arcsec = lsb;
            claim.noise.q = lsb / 12f64.sqrt();
            continue;
        }
        claim.effects.push(stated);
    }
}

/// If only effects that the simulation shows and departures that no effect explains are left: those of these that the simulation shows as strongly are no
/// difference. The equivalent normal numbers of both, scaled to one length, are compared.
fn unnamed(outcome: &mut Outcome, claim: &Claim, check: &SimulationCheck<'_>, least: f64) {
    let Ok(own) = explain(check.simulation.clone(), claim, check.options, &mut |_| {}) else { return };
    let z = |p: f64| match p {
        p if p >= 0.5 => 0.0,
        p if p > MIN_EXACT_PROBABILITY => -normal_quantile(p),
        p => (-2.0 * p.max(f64::MIN_POSITIVE).ln()).sqrt(),
    };
    let root = check.share.min(1.0 / check.share).sqrt();
    let many = outcome.explanation.tests.len().max(1) as f64;
    let mut smallest = 1.0f64;
    for test in &mut outcome.explanation.tests {
        let same = |t: &&super::finding::Test| t.id == test.id && t.domain == test.domain;
        let there = own.explanation.tests.iter().filter(same).map(|t| t.p_before).fold(1.0, f64::min);
        // The longer record has the larger number where both depart alike.
        let (here, there) = if check.share < 1.0 {
            (z(test.p_after) * root, z(there))
        } else {
            (z(test.p_after), z(there) * root)
        };
        let apart = (here - there).max(0.0) / (1.0 + root * root).sqrt();
        let chance = chi_square_tail(apart * apart, 1.0).min(1.0);
        test.p_before = test.p_before.max(chance);
        test.p_after = test.p_after.max(chance);
        smallest = smallest.min(test.p_after);
    }
    let chance = (many * smallest).min(1.0);
    if chance < check.options.alpha {
        return;
    }
    agree(outcome, chance.min(least));
}

/// Makes of an explanation one that finds nothing.
fn agree(outcome: &mut Outcome, chance: f64) {
    let all = &mut outcome.explanation;
    all.verdict = MismatchVerdict::Consistent;
    all.effects.clear();
    all.experiments.clear();
    all.fit.augmented = all.fit.baseline.clone();
    (all.family_p_value, all.family_p_value_after) = (chance, chance);
    for test in &mut all.tests {
        test.p_before = test.p_before.max(chance);
        test.p_after = test.p_before;
    }
    outcome.correction = None;
}
