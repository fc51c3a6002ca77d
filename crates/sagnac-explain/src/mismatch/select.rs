//! The fewest effects that make the recording an ordinary draw: a beam of hypotheses grown by ΔBIC behind gates, then
//! pruned, then asked what else would have served as well.

use super::candidates;
use super::fitted_hypothesis::{Candidate, FittedHypothesis, SpectralDataSet};
use super::heldout::Halves;
use super::hypothesis::{Hypothesis, fit};
use super::noise_fit::{Noise, base_index};
use super::nonlinear_search::LocalSearch;
use super::options::Options;
use super::posterior::{Probable, name_of, probabilities};
use super::prediction;
use super::problem::Problem;
use super::terms::MeanTerm;
use super::terms::SpectralTerm;
use crate::effect::{Effect, Model, SpectrumAct};
use crate::numeric::order::SortByNumber;

/// ΔBIC that an effect must bring, and within which two are equivalent.
pub const MIN_DELTA_BIC: f64 = 6.0;
/// Equivalents that are named at most.
pub const MOST_EQUIVALENTS: usize = 3;
/// Times that one effect of the chosen is exchanged for another at most: what was best alone need not be the best beside
/// what was found after it.
const MAX_EXCHANGES: usize = 3;
/// Hypotheses kept at each depth.
const BEAM_WIDTH: usize = 3;

/// Position of an effect in a hypothesis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    /// Among the courses.
    Mean(usize),
    /// Among the spectral effects.
    Spectrum(usize),
}

/// An effect that was chosen.
#[derive(Clone)]
pub struct Chosen {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Its position in the hypothesis.
    pub slot: Slot,
    /// BIC without it less BIC with it.
    pub delta_bic: f64,
    /// Probability of its gain without it, its search and the catalogue counted.
    pub p_value: f64,
    /// Effects that serve as well, the best first.
    pub equivalents: Vec<Candidate>,
    /// For a response that is described by terms: the kind whose law alone explains most, fitted in its place.
    pub law: Option<Candidate>,
    /// Probability of each name, the likeliest first.
    pub names: Vec<Probable>,
    /// Kind that serves as well by the evidence of single samples.
    pub beside: Option<&'static str>,
    /// The hypothesis without it, fitted.
    pub without: FittedHypothesis,
    /// The best hypothesis with another effect in its place, or with the same one from another starting point, where it is better.
    better: Option<FittedHypothesis>,
}

/// Result of the selection.
pub struct Selection {
    /// The hypothesis.
    pub best: FittedHypothesis,
    /// Its effects, the largest ΔBIC first.
    pub chosen: Vec<Chosen>,
    /// Candidates that were fitted to the claim alone.
    pub first: Vec<Candidate>,
}

/// True for a candidate that may be added.
pub fn passes(candidate: &Candidate, family: f64, alpha: f64) -> bool {
    candidate.delta_bic >= MIN_DELTA_BIC && candidate.p_value * family < alpha
}

/// The slots that a hypothesis has beyond its claim.
fn slots(hypothesis: &Hypothesis) -> Vec<(Slot, &'static dyn Effect)> {
    let courses = hypothesis.courses.iter().enumerate().map(|(i, c)| (Slot::Mean(i), c.effect));
    let spectra = hypothesis.noise.spectra.iter().enumerate().filter(|(_, s)| !s.stated);
    courses.chain(spectra.map(|(i, s)| (Slot::Spectrum(i), s.effect))).collect()
}

/// The hypothesis without one effect, fitted.
fn without(tried: &FittedHypothesis, slot: Slot, spectra: &SpectralDataSet) -> FittedHypothesis {
    let mut hypothesis = tried.hypothesis.clone();
    let effect = match slot {
        Slot::Mean(i) => hypothesis.courses[i].effect,
        Slot::Spectrum(i) => hypothesis.noise.spectra[i].effect,
    };
    let removed = match slot {
        Slot::Mean(i) => {
            let course = hypothesis.courses.remove(i);
            course_parameters(&course, spectra)
        }
        Slot::Spectrum(i) => {
            let part = hypothesis.noise.spectra.remove(i);
            restore(&mut hypothesis.noise, &part)
        }
    };
    let fit = fit(&mut hypothesis, &spectra.full);
    FittedHypothesis {
        hypothesis,
        fit,
        parameters: tried.parameters.saturating_sub(removed),
        odds: tried.odds_without(effect),
    }
}

fn course_parameters(course: &MeanTerm, spectra: &SpectralDataSet) -> usize {
    let Some(c) = course.course() else { return 0 };
    let spectral = spectra.of(c.resolution());
    let parts = c.regressors(&course.nonlinear_parameters, &spectral.drivers);
    let nonlinear_parameters = LocalSearch::of(c, &spectral.drivers).free();
    c.bic_parameters(parts.columns.len()) + parts.nuisance.len() + nonlinear_parameters
}

/// BIC of an addition in which a nuisance, such as the state of a delay before the record, is charged only its expected gain by
/// chance, half a nat: it is estimated less well, but makes the addition no less able to explain what its rivals do.
fn bic_of_rival(candidate: &Candidate, spectra: &SpectralDataSet) -> f64 {
    let rows = spectra.rows;
    let beside =
        candidate.tried.hypothesis.courses.last().filter(|c| c.effect.kind() == candidate.effect.kind());
    let beside = beside.and_then(|c| {
        Some(c.course()?.regressors(&c.nonlinear_parameters, &spectra.of(c.course()?.resolution()).drivers))
    });
    candidate.tried.bic(rows) - beside.map_or(0, |b| b.nuisance.len()) as f64 * ((rows as f64).ln() - 1.0)
}

/// Effective number of modes of a process: the sum of squares of its share of the power. A parameter of it costs the logarithm
/// of that many, not of all samples.
fn modes_of_process(slot: Slot, best: &FittedHypothesis, spectra: &SpectralDataSet) -> Option<f64> {
    let Slot::Spectrum(i) = slot else { return None };
    let spectral = &spectra.full;
    let added = best.hypothesis.noise.added_densities(i, spectral);
    let shares = added.iter().zip(&best.fit.densities).map(|(a, s)| (a / s).powi(2));
    Some(shares.zip(&spectral.bins).map(|(share, bin)| share * spectral.weight(bin)).sum::<f64>().max(2.0))
}

/// Excess of the charge of BIC for the parameters that a rival process has beyond those of the process that was chosen, nats.
fn bic_excess(candidate: &Candidate, best: &FittedHypothesis, modes: Option<f64>, rows: usize) -> f64 {
    let process = matches!(candidate.effect.model(), Model::Spectrum(_));
    let more = candidate.tried.parameters.saturating_sub(best.parameters) as f64;
    modes.filter(|_| process).map_or(0.0, |m| more * (rows as f64 / m).ln().max(0.0))
}

/// Puts an unconstrained coefficient back under its prior; the number of parameters that go.
fn restore(noise: &mut Noise, part: &SpectralTerm) -> usize {
    if let Model::Spectrum(s) = part.effect.model()
        && let SpectrumAct::Unconstrains(term) = s.act()
        && let Some(i) = base_index(term)
    {
        noise.unconstrained[i] = false;
        noise.base[i] = noise.begin(i);
        return 1;
    }
    part.fitted.len()
}

/// A name for a set of effects, to tell equal sets.
fn set(tried: &FittedHypothesis) -> Vec<&'static str> {
    let mut kinds: Vec<&'static str> = slots(&tried.hypothesis).iter().map(|(_, e)| e.kind()).collect();
    kinds.sort_unstable();
    kinds
}

/// Data and options of a search.
struct Search<'a> {
    spectra: &'a SpectralDataSet,
    halves: Halves,
    options: &'a Options,
}

impl Search<'_> {
    /// Every addition to a hypothesis, the best first.
    fn candidates(&self, before: &FittedHypothesis) -> Vec<Candidate> {
        let mut found = candidates::all(before, self.spectra, self.options);
        let (rows, family) = (self.spectra.rows, family(&found));
        prediction::weigh(&mut found, &self.halves, rows, |c| passes(c, family, self.options.alpha));
        found
    }
}

/// Grows a hypothesis on `base`, which is the claim with what was found in single samples before.
pub fn select(base: &FittedHypothesis, problem: &Problem, options: &Options) -> Selection {
    let (alpha, most) = (options.alpha, options.max_effects);
    let spectra = &problem.spectra;
    let search = Search { spectra, halves: Halves::new(problem), options };
    let rows = spectra.rows;
    let first = search.candidates(base);
    let family = family(&first);
    let mut best = base.clone();
    let mut beam: Vec<(FittedHypothesis, Vec<Candidate>)> = vec![(base.clone(), first.clone())];
    for depth in 0..most {
        let mut next: Vec<FittedHypothesis> = vec![];
        for (_, candidates) in &beam {
            let passing: Vec<&Candidate> = candidates.iter().filter(|c| passes(c, family, alpha)).collect();
            for candidate in beam_survivors(&passing) {
                if !next.iter().any(|t| set(t) == set(&candidate.tried)) {
                    next.push(candidate.tried.clone());
                }
            }
        }
        next.sort_ascending_by(|a| a.rank(rows));
        let only_jump = |t: &&FittedHypothesis| matches!(slots(&t.hypothesis)[..], [(_, e)] if is_jump(e));
        let jump = next.iter().skip(BEAM_WIDTH).find(only_jump).cloned();
        next.truncate(BEAM_WIDTH);
        next.extend(jump);
        let Some(leader) = next.first() else { break };
        if leader.bic(rows) < best.bic(rows) - MIN_DELTA_BIC {
            best = leader.clone();
        } else if depth > 0 {
            // One more effect did not pay on any path.
            break;
        }
        if depth + 1 == most {
            break;
        }
        beam = next
            .into_iter()
            .map(|t| {
                let candidates = search.candidates(&t);
                (t, candidates)
            })
            .collect();
    }
    best = pruned(best, spectra, rows);
    let mut chosen = self::chosen(&best, base, &first, &search);
    for _ in 0..MAX_EXCHANGES {
        let better = chosen.iter().filter_map(|c| c.better.as_ref());
        let Some(better) = better.min_by(|a, b| a.rank(rows).total_cmp(&b.rank(rows))) else { break };
        best = pruned(better.clone(), spectra, rows);
        chosen = self::chosen(&best, base, &first, &search);
    }
    Selection { best, chosen, first }
}

/// The candidates that a second effect is looked for beside: the leader, and those near enough to it for a pair with
/// them to come out ahead. The best course goes along with a leading process, which can swallow courses.
fn beam_survivors<'a>(passing: &[&'a Candidate]) -> Vec<&'a Candidate> {
    let Some(leader) = passing.first() else { return vec![] };
    let mut out: Vec<&Candidate> =
        passing.iter().filter(|c| c.delta_bic > 0.6 * leader.delta_bic).take(BEAM_WIDTH).copied().collect();
    let is_course = |c: &Candidate| matches!(c.effect.model(), Model::Mean(_));
    if !out.iter().any(|c| is_course(c))
        && let Some(course) = passing.iter().find(|c| is_course(c))
    {
        out.truncate(BEAM_WIDTH - 1);
        out.push(course);
    }
    // A level that leaves and returns is two jumps, of which one alone explains little.
    if !out.iter().any(|c| is_jump(c.effect)) {
        out.extend(passing.iter().find(|c| is_jump(c.effect)));
    }
    out
}

/// True for a jump that a second one may take back.
fn is_jump(effect: &dyn Effect) -> bool {
    effect.reversed_pair().is_some()
}

/// Number of effects that were tried, those in single samples included.
pub fn family(first: &[Candidate]) -> f64 {
    first.len().max(1) as f64 + 8.0
}

/// Drops effects that became needless, by what hypotheses are ordered by: of a pair of which each explains the record alone, the
/// one that came first stays.
fn pruned(mut best: FittedHypothesis, spectra: &SpectralDataSet, rows: usize) -> FittedHypothesis {
    loop {
        let weakest = slots(&best.hypothesis)
            .into_iter()
            .map(|(slot, _)| without(&best, slot, spectra))
            .min_by(|a, b| a.rank(rows).total_cmp(&b.rank(rows)));
        match weakest {
            Some(less) if less.rank(rows) < best.rank(rows) + MIN_DELTA_BIC => best = less,
            _ => return best,
        }
    }
}

/// Score of a law alone that stands for a response, nats.
fn law_score(law: &Candidate) -> f64 {
    law.gain - 2.0 * law.parameters as f64
}

/// For a response that is described by terms: the kinds whose law alone explains a good part of what it explains, the best
/// first. The others are its equivalents: the response has something of each.
fn laws<'a>(effect: &dyn Effect, rivals: &'a [Candidate]) -> Vec<&'a Candidate> {
    /// Share of the best law's gain from which another is no worse a name.
    const NEAR_GAIN_SHARE: f64 = 0.7;
    let score = |c: &&Candidate| law_score(c);
    let by_law = |c: &&Candidate| effect.named_by_law().iter().any(|law| law.kind() == c.effect.kind());
    let mut laws: Vec<&Candidate> = rivals.iter().filter(by_law).collect();
    laws.sort_descending_by(|a| score(a));
    let best = laws.first().map_or(0.0, score);
    laws.retain(|c| score(c) >= NEAR_GAIN_SHARE * best);
    laws
}

/// The candidate that gives another one its name: itself, or the best law of a response; `None` for one without a name.
fn named<'a>(candidate: &'a Candidate, rivals: &'a [Candidate]) -> Option<&'a Candidate> {
    let law = self::laws(candidate.effect, rivals).into_iter().next();
    law.or_else(|| candidate.effect.in_format().then_some(candidate))
}

/// Probabilities of the names of a chosen effect: its own and those of its rivals in its place, or of the laws of a response.
fn names(
    effect: &'static dyn Effect,
    best: &FittedHypothesis,
    rivals: &[Candidate],
    laws: &[&Candidate],
    rank_without: f64,
    rows: usize,
) -> Vec<Probable> {
    if !laws.is_empty() {
        return probabilities(laws.iter().map(|c| (c.effect.reported_kind(), law_score(c))));
    }
    let own = 0.5 * (rank_without - best.rank(rows));
    let others = rivals.iter().filter(|c| c.effect.kind() != effect.kind());
    let others =
        others.map(|c| name_of(c, self::laws(c.effect, rivals).first().copied(), rows, rank_without));
    probabilities([(effect.reported_kind(), own)].into_iter().chain(others))
}

fn chosen(
    best: &FittedHypothesis,
    base: &FittedHypothesis,
    first: &[Candidate],
    search: &Search<'_>,
) -> Vec<Chosen> {
    let (spectra, options) = (search.spectra, search.options);
    let family = family(first);
    let rows = spectra.rows;
    let all_slots = slots(&best.hypothesis);
    let single = all_slots.len() == 1;
    let mut out: Vec<Chosen> = all_slots
        .into_iter()
        .map(|(slot, effect)| {
            let without = if single { base.clone() } else { without(best, slot, spectra) };
            let rivals = if single { first.to_vec() } else { search.candidates(&without) };
            let own = rivals.iter().find(|c| c.effect.kind() == effect.kind());
            let p_value = own.map_or(1.0, |c| (c.p_value * family).min(1.0));
            let modes = modes_of_process(slot, best, spectra);
            let near = |c: &Candidate| {
                bic_of_rival(c, spectra) - bic_excess(c, best, modes, rows) < best.bic(rows) + MIN_DELTA_BIC
            };
            let laws = laws(effect, &rivals);
            let equivalents = if laws.is_empty() {
                let others = rivals.iter().filter(|c| near(c)).filter_map(|c| named(c, &rivals));
                let mut kinds = vec![effect.kind()];
                let new = |c: &&Candidate| {
                    let new = !kinds.contains(&c.effect.kind());
                    kinds.push(c.effect.kind());
                    new
                };
                others.filter(new).take(MOST_EQUIVALENTS).cloned().collect()
            } else {
                laws.iter().skip(1).take(MOST_EQUIVALENTS).map(|c| (*c).clone()).collect()
            };
            let names = names(effect, best, &rivals, &laws, without.rank(rows), rows);
            let law = laws.first().map(|c| (*c).clone());
            let better = rivals
                .iter()
                .filter(|c| !single && passes(c, family, options.alpha))
                .map(|c| &c.tried)
                .filter(|t| t.rank(rows) < best.rank(rows) - MIN_DELTA_BIC)
                .min_by(|a, b| a.rank(rows).total_cmp(&b.rank(rows)))
                .cloned();
            let delta_bic = without.bic(rows) - best.bic(rows);
            Chosen {
                effect,
                slot,
                delta_bic,
                p_value,
                equivalents,
                law,
                names,
                beside: None,
                without,
                better,
            }
        })
        .collect();
    out.sort_descending_by(|a| a.delta_bic);
    out
}
