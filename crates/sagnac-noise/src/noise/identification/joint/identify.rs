//! Identification with every kind of term.

use super::super::claims::{
    B, K, LIMIT_COVERAGE, LIMIT_RISE, MIN_RIVAL_RATIO, R, TERM_PRICE, WHITE_INDEX, WHITTLE_METHOD,
    contains_term, is_claimable, low_frequency_note, rival_of, suspects, with_rivals,
};
use super::super::linear_fit::RAMP_INDEX;
use super::super::misfit::Misfit;
use super::super::options::Options;
use super::super::profile::wider;
use super::super::result::{IDS, Identification, MarkovFound, QuasiPeriodicFound};
use super::super::standard::{identify_standard, slow_choice};
use super::ends::usable_evidence;
use super::fit::Joint;
use super::interval::{JointProfile, parameter_covariance};
use super::model::{BASE_TERMS, Extras, Free, JointPoint, ProcessKind, Shape, Variable};
use super::plateau::Plateau;
use super::revise::{
    Part, backward_elimination, quantization_price, unresolved, with_filter_instead, without,
};
use super::search::find_extras;
use super::slow::{Slow, long_markov};
use crate::estimate::{Estimate, Spread, UpperLimit};
use crate::noise::composite::{Bandwidth, Described, Sampling};
use crate::noise::data::NoiseType;
use crate::noise::evidence::Evidence;
use crate::noise::model::TERMS;
use crate::numeric::order::SortByNumber;
use std::f64::consts::PI;

/// Times that the parts of a model are looked over at most.
const MAX_REVISIONS: usize = 12;

/// Identifies N, B, K, Q and R, and Markov processes, quasi-periodic disturbances and a filter where the record calls for
/// them. `known`: where a search of the same evidence ended.
pub(in super::super) fn identify_joint(
    channel: &str,
    evidence: &Evidence,
    options: &Options,
    known: Option<&Extras>,
    intervals: bool,
) -> Identification {
    let plain = identify_standard(channel, evidence, &options.standard, false);
    let without_extras = |plain: Identification| {
        if intervals { identify_standard(channel, evidence, &options.standard, true) } else { plain }
    };
    let ramp = plain.claims(NoiseType::RateRamp);
    let search = || find_extras(evidence, options, ramp);
    let mut extras = known.cloned().unwrap_or_else(search);
    if extras.shape.is_plain() && options.sampling == Sampling::Averaging {
        // A long Markov process may stand where flicker or random walk is claimed.
        let choice = slow_choice(evidence, &options.standard).filter(|c| c.set & (B | K) != 0);
        let with = choice.and_then(|choice| {
            long_markov(
                &Joint::new(evidence, options.sampling)?,
                &extras.shape,
                choice,
                &options.standard.slow,
            )
        });
        match with {
            Some(with) if with.excess < 0.0 => extras.shape = with.shape,
            near => {
                let mut found = without_extras(plain);
                near.iter().for_each(|n| n.annotate(&mut found));
                found.searched = Some(extras);
                return found;
            }
        }
    }
    // A part that became superfluous after a later one is taken out again.
    let (mut turns, mut exchanged) = (MAX_REVISIONS, false);
    loop {
        turns = turns.saturating_sub(1);
        let resolved = usable_evidence(evidence, &extras);
        let Some(joint) = Joint::new(&resolved, options.sampling) else { return without_extras(plain) };
        let Some(found) = ShapeFits::of(&joint, &extras.shape, options) else { return without_extras(plain) };
        let near = long_markov(&joint, &extras.shape, found.slow.choice, &options.standard.slow);
        // Where no white noise is seen beneath a Markov process, the process may be white noise behind a filter.
        let filtered = if found.superfluous.is_none() && !found.claimed[0] && !exchanged {
            with_filter_instead(
                &joint,
                &extras.shape,
                &found.slow,
                &options.standard.slow,
                &options.process_thresholds,
            )
        } else {
            None
        };
        exchanged |= filtered.is_some();
        // A filter that took the place of a process is not given up for it again.
        let superfluous = found.superfluous.filter(|part| !exchanged || *part != Part::Filter);
        let superfluous = unresolved(&joint, &[&found.full, &found.supported]).or(superfluous);
        match (superfluous, near) {
            _ if turns > 0
                && let Some(shape) = filtered =>
            {
                extras.shape = shape
            }
            (Some(part), _) if turns > 0 => extras = without(&extras, part),
            (None, Some(with)) if turns > 0 && with.excess < 0.0 => extras.shape = with.shape,
            (_, near) => {
                let mut out = found.report(channel, &joint, plain, intervals);
                near.iter().for_each(|n| n.annotate(&mut out));
                out.searched = (turns > 0).then_some(extras);
                return out;
            }
        }
        if extras.shape.is_plain() && options.sampling == Sampling::Averaging {
            return without_extras(plain);
        }
    }
}

/// Every fit of one shape, and what they claim.
struct ShapeFits {
    full: JointPoint,
    slow: Slow,
    ratios: [f64; 5],
    claimed: [bool; 5],
    supported: JointPoint,
    free: Free,
    superfluous: Option<Part>,
}

impl ShapeFits {
    fn of(joint: &Joint<'_>, shape: &Shape, options: &Options) -> Option<ShapeFits> {
        let slow = Slow::of(joint, shape, &options.standard.slow)?;
        let ramp = contains_term(slow.choice.set, RAMP_INDEX);
        let full = if ramp { slow.sloped.clone() } else { slow.level.clone() };
        if !full.deviance.is_finite() {
            return None;
        }
        let drop_base = |i: usize| {
            let mut free = Free::all(shape, ramp, true);
            free.variance[i] = false;
            let mut start = full.clone();
            start.variance[i] = 0.0;
            (joint.maximise(&start, &free).deviance - full.deviance).max(0.0)
        };
        let all = slow.deviance[B | K];
        let ratios = [
            drop_base(0),
            drop_base(1),
            drop_base(2),
            drop_base(3),
            (all - slow.deviance[B | K | R]).max(0.0),
        ];
        let mut claimed = [
            ratios[0] > options.standard.white,
            contains_term(slow.choice.set, 1),
            contains_term(slow.choice.set, 2),
            // The price is looked up only where it decides.
            ratios[3] > options.standard.quantization
                && ratios[3] > quantization_price(joint, &full, ramp, &options.process_thresholds),
            ramp,
        ];
        let superfluous = backward_elimination(
            joint,
            shape,
            &full,
            &slow,
            &options.standard.slow,
            &options.process_thresholds,
        );
        let (point, free) = supported(joint, shape, &full, &claimed, ramp);
        let (variables, covariance) = parameter_covariance(joint, &point, &free);
        for (term, claimed) in claimed.iter_mut().enumerate().take(3).skip(1) {
            let at = variables.iter().position(|v| *v == Variable::Variance(term));
            let sigma = at.map_or(f64::INFINITY, |i| covariance[i][i].max(0.0).sqrt());
            let relative = sigma / point.reported(Variable::Variance(term));
            *claimed &= is_claimable(term, slow.preference[term], relative);
        }
        let (supported, free) = supported(joint, shape, &full, &claimed, ramp);
        Some(ShapeFits { full, slow, ratios, claimed, supported, free, superfluous })
    }

    fn report(
        &self,
        channel: &str,
        joint: &Joint<'_>,
        plain: Identification,
        intervals: bool,
    ) -> Identification {
        let mut out = plain;
        let point = &self.supported;
        out.likelihood_ratios = self.ratios;
        out.claimed = TERMS.into_iter().zip(self.claimed).filter(|(_, c)| *c).map(|(t, _)| t).collect();
        out.full = self.full.terms();
        out.allowed = self.full.composite(joint.sampling());
        out.supported = point.terms();
        let mut model = point.terms();
        for (term, claimed) in TERMS.into_iter().zip(self.claimed) {
            if !claimed {
                model = model.with(term, 0.0);
            }
        }
        out.model = model;
        out.ambiguous = (0..BASE_TERMS.len()).any(|i| self.free.variance[i] && !self.claimed[i]);
        let (variables, covariance) = parameter_covariance(joint, point, &self.free);
        out.covariance = base_covariance(&variables, &covariance);
        out.misfit = Misfit::of(joint.evidence(), &joint.whitened(point), variables.len());
        out.described = Described {
            model: point.composite(joint.sampling()),
            parameters: variables.iter().filter_map(|v| point.parameter(*v)).collect(),
            covariance,
        };
        if !intervals {
            return out;
        }
        for (term, estimate) in out.estimates_mut_by_term().into_iter().enumerate() {
            *estimate = self.base_estimate(channel, joint, term);
        }
        if let Some((plateau, estimate)) = self.plateau(channel, joint) {
            (out.plateau, out.white_plateau) = (Some(plateau), Some(estimate));
        }
        self.report_parts(channel, joint, &mut out);
        out
    }

    fn profile(&self, joint: &Joint<'_>, variable: Variable, free: &Free) -> (JointPoint, Spread) {
        let best = joint.maximise(&self.supported, free);
        let spread = JointProfile::new(joint, &best, free, variable).spread();
        (best, spread)
    }

    /// White noise with every process that is white where it is read; `None` where there is no such process.
    fn plateau(&self, channel: &str, joint: &Joint<'_>) -> Option<(Plateau, Estimate)> {
        let evidence = joint.evidence();
        let model = self.supported.composite(joint.sampling());
        let plateau = Plateau::of(&model, evidence.tau0_s, evidence.span_s)?;
        let value = plateau.level(&model);
        let mut spread = plateau.spread(joint, &self.supported, &self.free);
        // A part too weak to be named may still hold a part of the level.
        for other in suspects(WHITE_INDEX, &self.free.variance, &self.ratios) {
            let mut wide = self.free.clone();
            wide.variance[other] = true;
            let point = joint.maximise(&self.supported, &wide);
            spread = wider(value, &spread, &plateau.spread(joint, &point, &wide));
        }
        let (id, unit) = IDS[0];
        let estimate =
            Estimate::measured(id, channel, value, unit, spread, WHITTLE_METHOD).note(plateau.note());
        Some((plateau, estimate))
    }

    /// The estimate of one of [`TERMS`].
    fn base_estimate(&self, channel: &str, joint: &Joint<'_>, term: usize) -> Estimate {
        let (id, unit) = IDS[term];
        let variable = if term == RAMP_INDEX { Variable::Ramp } else { Variable::Variance(term) };
        let free = self.free.clone();
        if self.claimed[term] {
            let (best, mut spread) = self.profile(joint, variable, &free);
            let value = best.reported(variable);
            // A part too weak to be named may still hold a part of the level of the white noise.
            for other in suspects(term, &free.variance, &self.ratios) {
                let mut wide = free.clone();
                wide.variance[other] = true;
                spread = wider(value, &spread, &self.profile(joint, variable, &wide).1);
            }
            let rival = rival_of(term).filter(|r| !free.variance[*r] && self.ratios[*r] > MIN_RIVAL_RATIO);
            if let Some(rival) = rival {
                let mut wide = free.clone();
                wide.variance[rival] = true;
                spread = wider(value, &spread, &self.profile(joint, variable, &wide).1);
            }
            let estimate = Estimate::measured(id, channel, value, unit, spread, WHITTLE_METHOD);
            return with_rivals(estimate, term, self.slow.preference[term]);
        }
        // A limit must hold whatever else is in the record: the largest over the rivals being free and being absent.
        let mut open = Free::all(&self.supported.shape, self.claimed[RAMP_INDEX], true);
        if term == RAMP_INDEX {
            open.ramp = true;
        }
        let mut limits = vec![];
        for rival in [None, rival_of(term).filter(|r| !self.claimed[*r])] {
            let mut free = open.clone();
            let mut start = self.full.clone();
            if let Some(r) = rival {
                free.variance[r] = false;
                start.variance[r] = 0.0;
            }
            let best = joint.maximise(&start, &free);
            limits.extend(JointProfile::new(joint, &best, &free, variable).upper_limit(LIMIT_RISE));
        }
        let limit = limits.into_iter().max_by(f64::total_cmp);
        let limit = limit.map(|value| UpperLimit { value, coverage: LIMIT_COVERAGE });
        let mut alone = self.free.clone();
        let mut start = self.full.clone();
        if let Some(r) = rival_of(term).filter(|r| !self.claimed[*r]) {
            alone.variance[r] = false;
            start.variance[r] = 0.0;
        }
        // White noise that is not claimed is there all the same: without it flicker would have to stand for it.
        alone.variance[0] = true;
        match variable {
            Variable::Ramp => alone.ramp = true,
            _ => alone.variance[term] = true,
        }
        let likely = joint.maximise(&start, &alone).reported(variable).abs();
        let estimate =
            Estimate::not_identifiable(id, channel, limit, unit, WHITTLE_METHOD).most_likely(Some(likely));
        let ambiguous = (0..BASE_TERMS.len()).any(|i| self.free.variance[i] && !self.claimed[i]);
        let needed = term != 0 && self.free.variance.get(term) == Some(&true) && term != RAMP_INDEX;
        if ambiguous && needed { estimate.note(low_frequency_note()) } else { estimate }
    }

    fn report_parts(&self, channel: &str, joint: &Joint<'_>, out: &mut Identification) {
        let measured = |id: &'static str, unit: &'static str, variable: Variable| {
            let (best, spread) = self.profile(joint, variable, &self.free);
            Estimate::measured(id, channel, best.reported(variable), unit, spread, WHITTLE_METHOD)
        };
        for (i, (kind, _)) in self.supported.shape.damped.iter().enumerate() {
            let sigma = Variable::Variance(BASE_TERMS.len() + i);
            match kind {
                ProcessKind::Markov => out.markov.push(MarkovFound {
                    sigma: measured("markov_sigma", "deg/h", sigma),
                    correlation_time: measured("markov_correlation_time", "s", Variable::DecayTime(i)),
                }),
                ProcessKind::QuasiPeriodic => out.quasi_periodic.push(QuasiPeriodicFound {
                    amplitude: measured("quasi_periodic_amplitude", "deg/h", sigma),
                    frequency: measured("quasi_periodic_frequency", "Hz", Variable::Frequency(i)),
                    coherence_time: measured("quasi_periodic_coherence_time", "s", Variable::DecayTime(i)),
                }),
            }
        }
        out.quasi_periodic.sort_descending_by(|a| a.amplitude.value.unwrap_or(0.0));
        let id = "measurement_bandwidth";
        out.cutoff = match self.supported.shape.filter {
            None => None,
            Some(filter @ Bandwidth::MovingAverage { .. }) => {
                let value = filter.cutoff_hz(joint.evidence().tau0_s);
                Some(Estimate::measured(id, channel, value, "Hz", Spread::Unknown, WHITTLE_METHOD))
            }
            Some(Bandwidth::FirstOrder { .. }) => {
                let (best, spread) = self.profile(joint, Variable::FilterTime, &self.free);
                let cutoff = |time_s: f64| 1.0 / (2.0 * PI * time_s);
                let spread = match spread {
                    Spread::Curve(points) => {
                        Spread::Curve(points.iter().rev().map(|(z, t)| (-z, cutoff(*t))).collect())
                    }
                    other => other,
                };
                let value = cutoff(best.reported(Variable::FilterTime));
                Some(Estimate::measured(id, channel, value, "Hz", spread, WHITTLE_METHOD))
            }
        };
    }
}

/// The best description: claimed terms, and as few others as pay their price.
fn supported(
    joint: &Joint<'_>,
    shape: &Shape,
    full: &JointPoint,
    claimed: &[bool; 5],
    ramp: bool,
) -> (JointPoint, Free) {
    let open: Vec<usize> = (0..BASE_TERMS.len()).filter(|i| !claimed[*i] && *i != 3).collect();
    let mut best: Option<(f64, JointPoint, Free)> = None;
    for set in 0..1usize << open.len() {
        let mut free = Free::all(shape, ramp, true);
        let mut start = full.clone();
        for (i, claimed) in claimed.iter().enumerate().take(BASE_TERMS.len()) {
            let in_set = open.iter().position(|o| *o == i).is_some_and(|p| set >> p & 1 == 1);
            if !claimed && !in_set {
                free.variance[i] = false;
                start.variance[i] = 0.0;
            }
        }
        let point = joint.maximise(&start, &free);
        let cost = point.deviance + TERM_PRICE * f64::from(set.count_ones());
        if point.deviance.is_finite() && best.as_ref().is_none_or(|b| cost < b.0) {
            best = Some((cost, point, free));
        }
    }
    best.map_or_else(|| (full.clone(), Free::all(shape, ramp, true)), |(_, point, free)| (point, free))
}

fn base_covariance(variables: &[Variable], covariance: &[Vec<f64>]) -> [[f64; 5]; 5] {
    let place = |v: &Variable| match v {
        Variable::Variance(i) if *i < BASE_TERMS.len() => Some(*i),
        Variable::Ramp => Some(RAMP_INDEX),
        _ => None,
    };
    let mut out = [[0.0; 5]; 5];
    for (a, row) in variables.iter().zip(covariance) {
        for (b, value) in variables.iter().zip(row) {
            if let (Some(i), Some(j)) = (place(a), place(b)) {
                out[i][j] = *value;
            }
        }
    }
    out
}
