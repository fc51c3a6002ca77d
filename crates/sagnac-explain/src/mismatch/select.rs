//! The fewest and plainest effects that make the recording an ordinary draw: a beam of hypotheses, each grown by what is improbable
//! without it and ordered by BIC, then pruned, then asked what else would have served as well.
//!
//! The ladder has two steps. Laws of recorded columns, of the table, of events and of the noise come first. A free form (something
//! that was not recorded, a comb, a curve, a power law) is taken only where what they leave is no ordinary noise, or where it explains or
//! predicts clearly more: see [`Search::plainest`].

use super::candidates;
use super::discrepancy;
use super::effective_tests;
use super::fitted_hypothesis::{Candidate, FittedHypothesis, SpectralDataSet};
use super::heldout::Halves;
use super::hypothesis::{Hypothesis, fit};
use super::noise_fit::{Noise, base_index};
use super::nonlinear_search::LocalSearch;
use super::options::Options;
use super::posterior::{Probable, ScoredName, name_of, probabilities, shared};
use super::prediction::{self, is_process};
use super::problem::Problem;
use super::several::least_of;
use super::terms::MeanTerm;
use super::terms::SpectralTerm;
use crate::effect::{Drivers, EFFECTS, Effect, Model, SpectrumAct};
use crate::numeric::order::SortByNumber;
use std::cell::RefCell;
use std::rc::Rc;

/// ΔBIC within which two hypotheses are equivalent.
pub const MIN_DELTA_BIC: f64 = 6.0;
/// Share of what is explained that a free form must explain beyond the plain laws.
const MIN_FREE_FORM_SHARE: f64 = 0.05;
/// The same of a form without a name.
const MIN_NAMELESS_FORM_SHARE: f64 = 0.2;
/// What a free form must predict of the blocks held out beyond the plain laws, nats.
const MIN_FREE_FORM_PREDICTION: f64 = 4.0;
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

/// True for a candidate that may be added: without it, as large a gain anywhere in the family has a probability below α. This is the
/// rule that decides; BIC only orders what passes.
pub fn passes(candidate: &Candidate, drivers: &Drivers, alpha: f64) -> bool {
    !is_chance(candidate.p_value, drivers, alpha)
}

/// True for a p-value that something in a record with such columns has by chance, more often than a significance.
fn is_chance(p_value: f64, drivers: &Drivers, alpha: f64) -> bool {
    least_of(p_value, effective_tests::of_record(drivers)) >= alpha
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
            // The error of a law goes with it.
            hypothesis.noise.discrepancy.take_if(|d| d.kind == course.effect.kind());
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

/// True for a hypothesis with a free form.
fn has_free_form(tried: &FittedHypothesis) -> bool {
    slots(&tried.hypothesis).iter().any(|(_, e)| e.is_free_form())
}

/// True for a hypothesis with a response of several terms, which is named by the law that explains most of it.
fn has_response(tried: &FittedHypothesis) -> bool {
    slots(&tried.hypothesis).iter().any(|(_, e)| is_response(*e))
}

/// True for a response of several terms.
fn is_response(effect: &dyn Effect) -> bool {
    !effect.named_by_law().is_empty()
}

/// True for a hypothesis with a law of which responses are made.
fn has_law_of_response(tried: &FittedHypothesis) -> bool {
    let laws = || EFFECTS.iter().flat_map(|e| e.named_by_law());
    slots(&tried.hypothesis).iter().any(|(_, e)| laws().any(|law| law.kind() == e.kind()))
}

/// True for a hypothesis with a free form that has no kind in the format of explanations.
fn has_nameless_form(tried: &FittedHypothesis) -> bool {
    slots(&tried.hypothesis).iter().any(|(_, e)| is_nameless(*e))
}

/// True for a hypothesis that has a free form, or one without a name, only where another has one.
fn bends_no_more(one: &FittedHypothesis, other: &FittedHypothesis) -> bool {
    (has_free_form(other) || !has_free_form(one)) && (has_nameless_form(other) || !has_nameless_form(one))
}

/// True for hypotheses that differ only in their processes: a raised coefficient is as free as a process of something that was not
/// recorded, and none of them is the plainer law.
fn differ_in_processes(one: &FittedHypothesis, other: &FittedHypothesis) -> bool {
    let kinds = |t: &FittedHypothesis| -> Vec<&'static dyn Effect> {
        slots(&t.hypothesis).into_iter().map(|(_, e)| e).collect()
    };
    let (one, other) = (kinds(one), kinds(other));
    let only = |a: &[&'static dyn Effect], b: &[&'static dyn Effect]| {
        a.iter().filter(|e| !b.iter().any(|o| o.kind() == e.kind())).all(|e| is_named_process(*e))
    };
    only(&one, &other) && only(&other, &one)
}

/// Log-likelihood that a process of something that was not recorded must explain beyond one that is a noise of the gyro, nats. A parameter more is
/// charged already; one that has none more is no better a name before it explains what one would cost.
fn process_charge(parameters_of_free: usize, parameters_of_noise: usize) -> f64 {
    const PARAMETER_COST: f64 = 2.0;
    if parameters_of_free > parameters_of_noise { 0.0 } else { PARAMETER_COST }
}

/// True for a process that has a kind in the format of explanations.
fn is_named_process(effect: &dyn Effect) -> bool {
    is_process(effect) && effect.in_format()
}

/// True for a free form that has no kind in the format of explanations.
fn is_nameless(effect: &dyn Effect) -> bool {
    effect.is_free_form() && !effect.in_format()
}

/// Every addition to one hypothesis.
struct Tried {
    set: Vec<&'static str>,
    log_likelihood: f64,
    candidates: Rc<Vec<Candidate>>,
}

/// Data and options of a search, and what it tried.
struct Search<'a> {
    problem: &'a Problem,
    spectra: &'a SpectralDataSet,
    halves: Halves,
    options: &'a Options,
    tried: RefCell<Vec<Tried>>,
}

impl<'a> Search<'a> {
    fn new(problem: &'a Problem, options: &'a Options) -> Search<'a> {
        let (spectra, halves) = (&problem.spectra, Halves::new(problem));
        Search { problem, spectra, halves, options, tried: RefCell::new(vec![]) }
    }

    /// Every addition to a hypothesis, the best first.
    fn candidates(&self, before: &FittedHypothesis) -> Rc<Vec<Candidate>> {
        let (set, log_likelihood) = (set(before), before.fit.log_likelihood);
        let same = |t: &&Tried| t.set == set && t.log_likelihood.total_cmp(&log_likelihood).is_eq();
        if let Some(known) = self.tried.borrow().iter().find(same) {
            return known.candidates.clone();
        }
        let mut found = candidates::all(before, self.spectra, self.options);
        prediction::weigh(&mut found, &self.halves, self.spectra.rows, |c| self.passes(c));
        let candidates = Rc::new(found);
        self.tried.borrow_mut().push(Tried { set, log_likelihood, candidates: candidates.clone() });
        candidates
    }

    fn passes(&self, candidate: &Candidate) -> bool {
        passes(candidate, &self.spectra.full.drivers, self.options.alpha)
    }

    /// Grows a hypothesis by the wanted effects, and drops what became needless.
    fn grown(&self, base: &FittedHypothesis, wanted: impl Fn(&dyn Effect) -> bool) -> FittedHypothesis {
        let (rows, most) = (self.spectra.rows, self.options.max_effects);
        let mut best = base.clone();
        let mut beam = vec![base.clone()];
        for depth in 0..most {
            let mut next: Vec<FittedHypothesis> = vec![];
            if beam.first().is_some_and(|leader| depth > 0 && self.is_enough(leader, &wanted)) {
                break;
            }
            for before in &beam {
                let candidates = self.candidates(before);
                let passing: Vec<&Candidate> =
                    candidates.iter().filter(|c| self.passes(c) && wanted(c.effect)).collect();
                for candidate in beam_survivors(&passing) {
                    let set = set(&candidate.tried);
                    match next.iter_mut().find(|t| self::set(t) == set) {
                        // The same effects, found in another order.
                        Some(same) if candidate.tried.rank(rows) < same.rank(rows) => {
                            *same = candidate.tried.clone();
                        }
                        Some(_) => {}
                        None => next.push(candidate.tried.clone()),
                    }
                }
            }
            next.sort_ascending_by(|a| a.rank(rows));
            let only_jump =
                |t: &&FittedHypothesis| matches!(slots(&t.hypothesis)[..], [(_, e)] if is_jump(e));
            let jump = next.iter().skip(BEAM_WIDTH).find(only_jump).cloned();
            next.truncate(BEAM_WIDTH);
            next.extend(jump);
            next = next.into_iter().map(|t| discrepancy::learned(t, self.spectra)).collect();
            next.sort_ascending_by(|a| a.rank(rows));
            let Some(leader) = next.first() else { break };
            // The first is there where it is improbable that nothing is; each further one must also pay.
            if depth == 0 || leader.rank(rows) < best.rank(rows) - MIN_DELTA_BIC {
                best = leader.clone();
            } else {
                break;
            }
            beam = next;
        }
        let all = pruned(best, self.spectra, rows);
        let mut best = self.justified(all.clone());
        // Something else may explain what an effect stood for that went again.
        while slots(&best.hypothesis).len() < slots(&all.hypothesis).len() {
            let candidates = self.candidates(&best);
            let beside = candidates.iter().filter(|c| self.passes(c) && wanted(c.effect)).map(|c| &c.tried);
            let Some(next) = beside.min_by(|a, b| a.rank(rows).total_cmp(&b.rank(rows))) else { break };
            let next = self.justified(pruned(next.clone(), self.spectra, rows));
            if next.rank(rows) >= best.rank(rows) - MIN_DELTA_BIC {
                break;
            }
            best = next;
        }
        best
    }

    /// True for laws that bend to nothing, beside which nothing is improbable and which leave ordinary noise: what is plainer than they are was
    /// tried before, and what explains more explains noise.
    fn is_enough(&self, leader: &FittedHypothesis, wanted: impl Fn(&dyn Effect) -> bool) -> bool {
        let bends = |e: &dyn Effect| e.is_free_form() || is_process(e) || is_response(e);
        let is_plain = !slots(&leader.hypothesis).iter().any(|(_, e)| bends(*e));
        let adds = |c: &Candidate| self.passes(c) && wanted(c.effect);
        is_plain
            && !self.candidates(leader).iter().any(adds)
            && self.problem.departure_probability(leader) >= self.options.alpha
    }

    /// A hypothesis without the effects that the rule would not add to the others: what came first may have stood for what came after.
    fn justified(&self, mut best: FittedHypothesis) -> FittedHypothesis {
        while slots(&best.hypothesis).len() > 1 {
            let each = slots(&best.hypothesis).into_iter().map(|(slot, effect)| {
                let less = without(&best, slot, self.spectra);
                let own = self.candidates(&less).iter().find(|c| c.effect.kind() == effect.kind()).cloned();
                (own.map_or(1.0, |c| c.p_value), less)
            });
            let Some((p_value, less)) = each.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            if is_chance(p_value, &self.spectra.full.drivers, self.options.alpha) {
                best = less;
            } else {
                break;
            }
        }
        best
    }

    /// The plain hypothesis, unless a free one explains or predicts clearly more, or leaves ordinary noise where the plain one does not.
    fn plainest(
        &self,
        plain: FittedHypothesis,
        free: FittedHypothesis,
        base: &FittedHypothesis,
    ) -> FittedHypothesis {
        let rows = self.spectra.rows;
        let explained = |t: &FittedHypothesis| 0.5 * (base.rank(rows) - t.rank(rows));
        let more = explained(&free) - explained(&plain);
        if differ_in_processes(&plain, &free) && more >= process_charge(free.parameters, plain.parameters) {
            return free;
        }
        // What has no name must say more than a bend of a law that has one.
        let nameless = has_nameless_form(&free) && !has_nameless_form(&plain);
        let share = if nameless { MIN_NAMELESS_FORM_SHARE } else { MIN_FREE_FORM_SHARE };
        if slots(&plain.hypothesis).is_empty() || more >= share * explained(&free) {
            return free;
        }
        let predicted = |t: &FittedHypothesis| self.halves.judge(t).log_likelihood;
        if !nameless && more > 0.0 && predicted(&free) - predicted(&plain) >= MIN_FREE_FORM_PREDICTION {
            return free;
        }
        let ordinary = |t: &FittedHypothesis| self.problem.departure_probability(t) >= self.options.alpha;
        if more > 0.0 && !ordinary(&plain) && ordinary(&free) { free } else { plain }
    }

    /// A hypothesis of fewer effects that was fitted on the way and has at least the likelihood of this one; else this one.
    fn smallest(&self, best: FittedHypothesis) -> FittedHypothesis {
        let effects = slots(&best.hypothesis).len();
        let tried = self.tried.borrow();
        let passing = tried.iter().flat_map(|t| t.candidates.iter()).filter(|c| self.passes(c));
        let smaller = passing.map(|c| &c.tried).filter(|t| {
            slots(&t.hypothesis).len() < effects
                && bends_no_more(t, &best)
                && t.fit.log_likelihood >= best.fit.log_likelihood
        });
        let rows = self.spectra.rows;
        let least = smaller.min_by(|a, b| a.rank(rows).total_cmp(&b.rank(rows))).cloned();
        least.unwrap_or(best)
    }
}

/// Grows a hypothesis on `base`, which is the claim with what was found in single samples before.
pub fn select(base: &FittedHypothesis, problem: &Problem, options: &Options) -> Selection {
    let search = Search::new(problem, options);
    let rows = search.spectra.rows;
    let first = search.candidates(base);
    let mut best = search.grown(base, |_| true);
    if has_nameless_form(&best) {
        let named = search.grown(base, |e| !is_nameless(e));
        best = search.plainest(named, best, base);
    }
    if has_free_form(&best) {
        let plain = search.grown(base, |e| !e.is_free_form());
        best = search.plainest(plain, best, base);
    }
    if has_free_form(&best) || has_response(&best) {
        // A response bends as a free form does: laws of the column that say as much, each with a name, are plainer.
        let laws = search.grown(base, |e| !e.is_free_form() && !is_response(e));
        if has_law_of_response(&laws) {
            best = search.plainest(laws, best, base);
        }
    }
    best = search.smallest(best);
    let mut chosen = self::chosen(&best, base, &first, &search);
    for _ in 0..MAX_EXCHANGES {
        let better = chosen.iter().filter_map(|c| c.better.as_ref());
        let Some(better) = better.min_by(|a, b| a.rank(rows).total_cmp(&b.rank(rows))) else { break };
        let exchanged = search.smallest(search.justified(pruned(better.clone(), search.spectra, rows)));
        if exchanged.rank(rows) >= best.rank(rows) {
            break;
        }
        best = exchanged;
        chosen = self::chosen(&best, base, &first, &search);
    }
    let first = first.to_vec();
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

/// Drops effects that became needless, by what hypotheses are ordered by: of a pair of which each explains the record alone, the
/// one that came first stays.
fn pruned(mut best: FittedHypothesis, spectra: &SpectralDataSet, rows: usize) -> FittedHypothesis {
    loop {
        let weakest = slots(&best.hypothesis)
            .into_iter()
            .map(|(slot, _)| without(&best, slot, spectra))
            .min_by(|a, b| a.rank(rows).total_cmp(&b.rank(rows)));
        // One effect alone is there because it is improbable that nothing is.
        let several = slots(&best.hypothesis).len() > 1;
        match weakest {
            Some(less) if several && less.rank(rows) < best.rank(rows) + MIN_DELTA_BIC => best = less,
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
fn laws<'a>(effect: &dyn Effect, rivals: impl IntoIterator<Item = &'a Candidate>) -> Vec<&'a Candidate> {
    /// Share of the best law's gain from which another is no worse a name.
    const NEAR_GAIN_SHARE: f64 = 0.7;
    let score = |c: &&Candidate| law_score(c);
    let by_law = |c: &&Candidate| effect.named_by_law().iter().any(|law| law.kind() == c.effect.kind());
    let mut laws: Vec<&Candidate> = rivals.into_iter().filter(by_law).collect();
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

/// True for a name that is probable enough to be said beside the chosen one.
fn is_rival(kind: &str, names: &[Probable]) -> bool {
    /// Probability of a name below which the record tells it from the chosen one.
    const MIN_RIVAL_PROBABILITY: f64 = 0.05;
    names.iter().any(|n| n.kind == kind && n.probability >= MIN_RIVAL_PROBABILITY)
}

/// Probabilities of the names of a chosen effect: its own and those of its rivals in its place, or of the laws of a response.
fn names(
    effect: &'static dyn Effect,
    best: &FittedHypothesis,
    rivals: &[&Candidate],
    laws: &[&Candidate],
    rank_without: f64,
    spectra: &SpectralDataSet,
) -> Vec<Probable> {
    let rows = spectra.rows;
    let own = 0.5 * (rank_without - best.rank(rows));
    let is_law = |c: &Candidate| laws.iter().any(|law| law.effect.kind() == c.effect.kind());
    let others = rivals.iter().copied().filter(|c| c.effect.kind() != effect.kind() && !is_law(c));
    // A free form must explain more than a plain law by a share, to be the better name.
    let charge = |c: &Candidate, score: f64| match c.effect.is_free_form() && !effect.is_free_form() {
        false => 0.0,
        true if is_named_process(c.effect) && is_named_process(effect) => {
            process_charge(c.tried.parameters, best.parameters)
        }
        true => MIN_FREE_FORM_SHARE * score.abs(),
    };
    let others = others.map(|c| {
        let (kind, score) =
            name_of(c, self::laws(c.effect, rivals.iter().copied()).first().copied(), rows, rank_without);
        ScoredName { kind, score: score - charge(c, score), within: plainer_name(c, spectra) }
    });
    let kind = if laws.is_empty() { effect.reported_kind() } else { effect.kind() };
    let names = probabilities([(kind, own).into()].into_iter().chain(others));
    let of_laws = probabilities(laws.iter().map(|c| (c.effect.reported_kind(), law_score(c)).into()));
    shared(names, kind, of_laws)
}

/// The kind with the same course as a candidate that is the plainer name.
fn plainer_name(candidate: &Candidate, spectra: &SpectralDataSet) -> Option<&'static str> {
    let Model::Mean(course) = candidate.effect.model() else { return None };
    let fitted = candidate.tried.hypothesis.courses.last()?;
    course.plainer_name(&fitted.nonlinear_parameters, &spectra.of(course.resolution()).drivers)
}

fn chosen(
    best: &FittedHypothesis,
    base: &FittedHypothesis,
    first: &[Candidate],
    search: &Search<'_>,
) -> Vec<Chosen> {
    let spectra = search.spectra;
    let tests = effective_tests::of_record(&spectra.full.drivers);
    let rows = spectra.rows;
    let all_slots = slots(&best.hypothesis);
    let single = all_slots.len() == 1;
    let plainer = |t: &FittedHypothesis| bends_no_more(t, best) && (has_response(best) || !has_response(t));
    // What was found on the way to several effects that went again need not be the best single one.
    let margin = if single { 0.0 } else { MIN_DELTA_BIC };
    let mut out: Vec<Chosen> = all_slots
        .into_iter()
        .map(|(slot, effect)| {
            let without = if single { base.clone() } else { without(best, slot, spectra) };
            let rivals = if single { first.to_vec() } else { search.candidates(&without).to_vec() };
            let own = rivals.iter().find(|c| c.effect.kind() == effect.kind());
            let p_value = own.map_or(1.0, |c| least_of(c.p_value, tests));
            let modes = modes_of_process(slot, best, spectra);
            let near = |c: &Candidate| {
                bic_of_rival(c, spectra) - bic_excess(c, best, modes, rows) < best.bic(rows) + MIN_DELTA_BIC
            };
            let laws = laws(effect, &rivals);
            // The first law is the name.
            let mut kinds: Vec<&str> =
                std::iter::once(effect.kind()).chain(laws.first().map(|law| law.effect.kind())).collect();
            let new = |c: &&Candidate| {
                let new = !kinds.contains(&c.effect.kind());
                kinds.push(c.effect.kind());
                new
            };
            let of_laws = laws.iter().skip(1).copied();
            let others = rivals.iter().filter(|c| near(c)).filter_map(|c| named(c, &rivals));
            let mut equivalents: Vec<Candidate> = of_laws.chain(others).filter(new).cloned().collect();
            // What chance gives as often is no name, however well it fits.
            let improbable: Vec<&Candidate> = rivals.iter().filter(|c| search.passes(c)).collect();
            let names = names(effect, best, &improbable, &laws, without.rank(rows), spectra);
            equivalents.retain(|c| is_rival(c.effect.reported_kind(), &names));
            equivalents.truncate(MOST_EQUIVALENTS);
            let law = laws.first().map(|c| (*c).clone());
            let better = rivals
                .iter()
                .filter(|c| search.passes(c))
                .map(|c| &c.tried)
                .filter(|t| plainer(t))
                .filter(|t| t.rank(rows) < best.rank(rows) - margin)
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
