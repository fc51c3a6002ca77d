//! The result of an explanation, put together from its parts.

use super::alternatives;
use super::augmented::{augmented, nuisances};
use super::columns;
use super::contribution;
use super::departures::{self, Departure};
use super::draw::{self, FigureData};
use super::effective_tests;
use super::estimates;
use super::experiment;
use super::finding::{
    Candidate, Explanation, Finding, Fit, FitFigures, MismatchVerdict, ParameterValue, PlaceRecord,
    RecordingFacts, Rest, Test,
};
use super::fitted_hypothesis::{Candidate as FittedCandidate, FittedHypothesis};
use super::heldout::{Halves, HeldOut};
use super::improvement;
use super::named::{NamedEffect, SampleFindings};
use super::noticeable::{self, Noticeable};
use super::options::Options;
use super::outcome::Outcome;
use super::problem::Problem;
use super::samples;
use super::select::{Chosen, MOST_EQUIVALENTS, Selection, Slot};
use super::several::least_of;
use super::single_cause;
use super::unnamed;
use crate::claim::{Claim, Stated};
use crate::effect::{
    COLUMN_TEXT, Detection, Domain, Effect, Family, Model, Place, SpectralContext, UNKNOWN, find, stateable,
};
use crate::numeric::order::SortByNumber;
use crate::series::ReadFrom;
use std::collections::BTreeMap;

/// Everything that an explanation rests on.
pub(super) struct Evidence<'a> {
    /// Recording and claim, with what was taken out.
    pub problem: &'a Problem,
    /// The claim as given.
    pub claim: &'a Claim,
    /// The claim's own fit.
    pub base: &'a FittedHypothesis,
    /// Its held-out figures.
    pub held_base: HeldOut,
    /// The selected effects.
    pub selection: &'a Selection,
    /// Effects found in single samples.
    pub found: SampleFindings,
    /// Tests of the residual of the claim.
    pub before: &'a [Departure],
    /// Tests of what is left.
    pub after: &'a [Departure],
    /// The recording as read.
    pub recorded: Recorded,
    /// Decisions of the user.
    pub options: &'a Options,
}

/// Facts of a recording after its rows are on the grid.
#[derive(Debug, Clone)]
pub(super) struct Recorded {
    /// Rows.
    pub rows: usize,
    /// Time from the first to the last, s.
    pub length_s: f64,
    /// Column of the file that each quantity was read from.
    pub read_from: Vec<ReadFrom>,
}

/// Everything that was tried, by what it is worth. Of equal ones, what single samples show stands before what was tried in modes.
fn ranked(of_single_samples: &[NamedEffect], selection: &Selection) -> Vec<Candidate> {
    let of_modes = selection.first.iter().map(candidate);
    let mut all: Vec<Candidate> = of_single_samples.iter().map(of_samples).chain(of_modes).collect();
    all.sort_descending_by(|a| a.delta_bic);
    all
}

/// Puts everything together.
pub(super) fn assemble(parts: Evidence<'_>) -> Outcome {
    let Evidence { problem, claim, base, held_base, selection, mut found, before, after, recorded, options } =
        parts;
    let (best, spectra) = (&selection.best, &problem.spectra);
    let local_gain = found.local_gain();
    let observed = with(Some(problem.residual.clone()), found.taken.as_deref()).unwrap_or_default();
    let ranked = ranked(&found.named, selection);
    let halves = Halves::new(problem);
    let nothing = selection.chosen.is_empty() && found.named.is_empty();
    let held_best = if nothing { held_base } else { halves.judge(best) };
    for chosen in &selection.chosen {
        let gained = improvement::of(chosen, selection, &spectra.full, &halves, held_best.log_likelihood);
        found.named.push(NamedEffect { improvement: Some(gained), ..named(chosen, best, problem, options) });
    }
    single_cause::returned(&mut found.named, problem, options);
    found.named.sort_descending_by(|a| a.delta_bic);
    let something = !found.named.is_empty();
    let principal = principal_places(&found.named, after);
    let gained = best.fit.log_likelihood - base.fit.log_likelihood + local_gain;
    let (mut findings, rest) = causes(&found.named, gained, problem, after, options);
    let rest = rest.or_else(|| bend_of_law(best, gained, problem, found.level.as_deref()));
    let family = smallest_p(&selection.first, before, problem);
    if findings.is_empty() && family < options.alpha {
        findings.extend(unnamed::of_all_together(before, family, problem, options));
    }
    let alternatives = alternatives::all(selection, &findings, problem);
    columns::as_recorded(&mut findings, &recorded.read_from);
    let columns = columns::records(problem, best, &found.named, &recorded.read_from);
    let Noticeable { sizes, not_computed } = match verdict(&findings) {
        MismatchVerdict::UnknownMismatch => Noticeable::default(),
        _ => noticeable::sizes(problem, selection, &kinds(&found.named), options),
    };
    let added = contribution::correction(best, spectra);
    // No claim can state a course of no kind.
    let stated = found
        .named
        .into_iter()
        .filter(|n| n.shape.is_none())
        .map(|n| Stated { effect: n.stated_as, values: stateable(n.stated_as, n.estimated.stated) });
    let levelled = found.level.is_some();
    let augmented = augmented(problem, claim, best, stated.collect(), levelled, added.as_deref());
    let correction = with(added, found.taken.as_deref());
    let baseline = figures(base, &held_base, spectra.rows, 0.0);
    let explanation = Explanation {
        format: "explain/1".to_owned(),
        case: problem.claim.case.clone(),
        verdict: verdict(&findings),
        effects: findings,
        rest,
        fit: Fit {
            heldout_tau_s: halves.bin_s(),
            augmented: match something {
                true => figures(best, &held_best, spectra.rows, local_gain),
                false => baseline.clone(),
            },
            baseline,
        },
        family_p_value: family,
        family_p_value_after: if something { departures::family(after, &problem.drivers) } else { family },
        alpha: options.alpha,
        candidates: ranked,
        tests: tests(before, after),
        nuisances: nuisances(problem, base, best),
        recording: facts(problem, &recorded, options),
        columns,
        noticeable: sizes,
        noticeable_not_computed: not_computed,
        experiments: experiment::deciding(&selection.chosen, best, spectra),
    };
    let drawn = FigureData {
        before: &observed,
        base,
        best,
        correction: correction.as_deref(),
        added: something,
        places: &principal,
    };
    let figures = draw::all(problem, &drawn);
    let correction = correction.map(|c| on_rows(&c, problem));
    let skewness = departures::skewness_shown(spectra, best);
    Outcome { explanation, correction, augmented, skewness, alternatives, figures }
}

fn kinds(named: &[NamedEffect]) -> Vec<&'static str> {
    named.iter().map(|n| n.effect.kind()).collect()
}

/// A series with another one added, where there is one; of none with another, that one.
fn with(series: Option<Vec<f64>>, other: Option<&[f64]>) -> Option<Vec<f64>> {
    let Some(other) = other else { return series };
    let mut sum = series.unwrap_or_else(|| vec![0.0; other.len()]);
    sum.iter_mut().zip(other).for_each(|(s, o)| *s += o);
    Some(sum)
}

/// A series on the grid at the rows of the recording, as (`time_s`, value).
fn on_rows(series: &[f64], problem: &Problem) -> Vec<(f64, f64)> {
    let rows = series.iter().zip(&problem.grid.present).enumerate().filter(|(_, (_, present))| **present);
    rows.map(|(i, (value, _))| (problem.drivers.time_s(i), *value)).collect()
}

/// Intervals of the leading finding, or else that of the clearest departure without a name.
fn principal_places(named: &[NamedEffect], after: &[Departure]) -> Vec<Place> {
    match named.first().map(|n| n.places.clone()) {
        Some(places) if !places.is_empty() => places,
        _ => after.iter().filter(|d| d.below(1e-3, after.len())).map(|d| d.place).take(1).collect(),
    }
}

/// Part of the misfit below which what named effects leave is a rest and no cause of its own.
const MAX_REST_SHARE: f64 = 0.05;

/// Every cause: what was named, what departs and has no name, and rows that are missing; and a small rest beside them.
/// `gained` is the gain of log-likelihood of what was named.
fn causes(
    named: &[NamedEffect],
    gained: f64,
    problem: &Problem,
    after: &[Departure],
    options: &Options,
) -> (Vec<Finding>, Option<Rest>) {
    let mut out = findings(named, options.max_effects);
    let mut rest = None;
    let all_named = !out.is_empty() && out.iter().all(|f| f.kind != UNKNOWN);
    let departs = unnamed::cause(after, named.is_empty(), problem, options);
    // A departure of probability p corresponds to about −ln p of log-likelihood.
    let share = |u: &Finding| 0.5 * u.delta_bic / (0.5 * u.delta_bic + gained.max(0.0)).max(1e-300);
    if let Some(small) = departs.as_ref().filter(|u| all_named && share(u) < MAX_REST_SHARE) {
        rest = Some(Rest { p_value: small.p_value, share: share(small), places: small.places.clone() });
    } else if let Some(mut unknown) = departs {
        unnamed::absorb(&mut unknown, &mut out);
        // A cycle that is no sinusoid has lines for its parts: they are no causes beside it.
        if after.iter().any(|d| d.is_periodic() && d.below(unnamed::DEPARTURE_PROBABILITY, after.len())) {
            out.retain(|f| find(&f.kind).and_then(|e| e.family()) != Some(Family::Line));
        }
        out.push(unknown);
        out.sort_descending_by(|a| a.delta_bic);
    }
    out.extend(missing(problem, options));
    (out, rest)
}

/// What a law that bends leaves of the misfit beside its own formula: the hypothesis holds it as a discrepancy. `gained` is the gain of
/// log-likelihood of everything that was named.
fn bend_of_law(
    best: &FittedHypothesis,
    gained: f64,
    problem: &Problem,
    level: Option<&[f64]>,
) -> Option<Rest> {
    let mut straight = best.clone();
    straight.hypothesis.noise.discrepancy.take()?;
    let straight = problem.refitted(&straight);
    let departures = problem.departures(&straight, level.or(problem.level.as_deref()));
    let clearest = departures.iter().min_by(|a, b| a.ln_p.total_cmp(&b.ln_p))?;
    let share = (best.fit.log_likelihood - straight.fit.log_likelihood) / gained.max(1e-300);
    let places = vec![PlaceRecord::of(&clearest.place)];
    Some(Rest {
        p_value: departures::family(&departures, &problem.drivers),
        share: share.clamp(0.0, 1.0),
        places,
    })
}

fn verdict(causes: &[Finding]) -> MismatchVerdict {
    if causes.iter().any(|f| f.kind == UNKNOWN) {
        MismatchVerdict::UnknownMismatch
    } else if causes.is_empty() {
        MismatchVerdict::Consistent
    } else {
        MismatchVerdict::Mismatch
    }
}

/// One finding a cause: several named effects that are one cause of no kind are one.
fn findings(named: &[NamedEffect], allowed: usize) -> Vec<Finding> {
    let together = single_cause::together(named, allowed);
    let mut out = vec![];
    for (i, one) in named.iter().enumerate() {
        match together.iter().find(|t| t.members.contains(&i)) {
            None => out.push(finding(one)),
            Some(t) if t.members.first() == Some(&i) => {
                let members = || t.members.iter().map(|m| &named[*m]);
                out.push(Finding {
                    kind: UNKNOWN.to_owned(),
                    effect: None,
                    column: None,
                    column2: None,
                    law: None,
                    formula: None,
                    shape: None,
                    equivalents: vec![],
                    probabilities: BTreeMap::new(),
                    parameters: BTreeMap::new(),
                    places: t.places.iter().map(PlaceRecord::of).collect(),
                    delta_bic: members().map(|m| m.delta_bic).sum(),
                    p_value: members().map(|m| m.p_value).fold(1.0, f64::min),
                    heldout_gain: None,
                    removed_share: None,
                });
            }
            Some(_) => {}
        }
    }
    out
}

/// A chosen effect with its parameters and places.
fn named(chosen: &Chosen, best: &FittedHypothesis, problem: &Problem, options: &Options) -> NamedEffect {
    let mut estimated = estimates::of(chosen.effect, chosen.slot, best, &problem.spectra);
    if let (Some(by_course), Slot::Spectrum(i)) = (chosen.effect.claimed_by_course(), chosen.slot) {
        estimated.stated = by_course.values(&contribution::drawn_course(best, i, problem));
    }
    let mut places = places(chosen.effect, chosen.slot, best, chosen, problem);
    // An instant lies where its interval brackets it.
    let instant = chosen.effect.params().iter().find(|p| p.instant);
    if let Some(instant) = instant.and_then(|p| estimated.reported.get(p.name)) {
        let half = 0.5 * problem.drivers.dt_s;
        let [from, to] = [instant.ci95[0] - half, instant.ci95[1] + half];
        places.iter_mut().filter(|p| p.domain == Domain::Time).for_each(|p| (p.from, p.to) = (from, to));
    }
    // Two effects of the catalogue can be of one kind in reports.
    let own = chosen.effect.reported_kind();
    let fitted: Vec<&str> =
        chosen.equivalents.iter().map(|e| e.effect.reported_kind()).filter(|kind| *kind != own).collect();
    let law = chosen.law.as_ref().map(|law| law.effect.reported_kind());
    let driver =
        ambiguous_oscillation(chosen.effect, &estimated.reported, problem.drivers.length_s(), options);
    let mut equivalents = chosen
        .beside
        .into_iter()
        .chain(fitted.iter().copied())
        .chain(driver.filter(|driver| !fitted.contains(driver)))
        .filter(|kind| chosen.effect.in_format() || law.is_some_and(|law| law != *kind))
        .fold(vec![], |mut all: Vec<&str>, kind| {
            if !all.contains(&kind) {
                all.push(kind);
            }
            all
        });
    equivalents.truncate(MOST_EQUIVALENTS);
    let mut effect = chosen.effect;
    if let Some(law) = &chosen.law {
        effect = law.effect;
        let whole = best.fit.log_likelihood - chosen.without.fit.log_likelihood;
        let of_whole = estimated.reported.remove("rms_deg_h").filter(|_| law.gain >= DOMINANT_SHARE * whole);
        (estimated.reported, places) = by_law(law, chosen, problem);
        // The share of one of several laws is not told by the response, which is all of them.
        estimated.reported.remove("rms_deg_h");
        estimated.reported.extend(of_whole.map(|rms| ("rms_deg_h".to_owned(), rms)));
    }
    NamedEffect {
        effect,
        stated_as: chosen.effect,
        estimated,
        equivalents,
        names: chosen.names.clone(),
        places,
        delta_bic: chosen.delta_bic,
        p_value: chosen.p_value,
        improvement: None,
        local_gain: 0.0,
        shape: None,
    }
}

/// Share of the gain of a response that one law must reach alone for the response to be that law.
const DOMINANT_SHARE: f64 = 0.85;

/// Parameters and places of a response as its leading law has them. The rest of the response is no noise that the claim knows,
/// so flicker and random walk are free to stand for it while the intervals are found.
fn by_law(
    law: &FittedCandidate,
    chosen: &Chosen,
    problem: &Problem,
) -> (BTreeMap<String, ParameterValue>, Vec<Place>) {
    let mut free = law.tried.clone();
    free.hypothesis.noise.unconstrained = [free.hypothesis.noise.unconstrained[0], true, true];
    let free = problem.refitted(&free);
    let slot = Slot::Mean(free.hypothesis.courses.len().saturating_sub(1));
    let reported = estimates::of(law.effect, slot, &free, &problem.spectra).reported;
    (reported, places(law.effect, slot, &free, chosen, problem))
}

/// Probability of the least p-value of everything that was looked at.
fn smallest_p(first: &[FittedCandidate], before: &[Departure], problem: &Problem) -> f64 {
    let named = first.iter().map(|c| c.p_value).fold(1.0, f64::min);
    least_of(named.min(departures::smallest(before)), effective_tests::of_record(&problem.drivers))
}

/// Figures of a fit; `local_gain` is what effects on single samples gained beside it.
fn figures(tried: &FittedHypothesis, held: &HeldOut, rows: usize, local_gain: f64) -> FitFigures {
    FitFigures {
        log_likelihood: tried.fit.log_likelihood + local_gain,
        heldout_log_likelihood: held.log_likelihood + 0.5 * local_gain,
        heldout_rms_deg_h: held.rms_deg_h,
        bic: tried.bic(rows) - 2.0 * local_gain,
    }
}

fn of_samples(named: &NamedEffect) -> Candidate {
    Candidate {
        kind: if named.shape.is_some() { UNKNOWN } else { named.effect.kind() }.to_owned(),
        delta_bic: named.delta_bic,
        log_likelihood_gain: named.local_gain,
        p_value: named.p_value,
    }
}

fn candidate(fitted: &FittedCandidate) -> Candidate {
    Candidate {
        kind: fitted.effect.kind().to_owned(),
        delta_bic: fitted.delta_bic,
        log_likelihood_gain: fitted.gain,
        p_value: fitted.p_value,
    }
}

fn finding(named: &NamedEffect) -> Finding {
    let own = !named.effect.in_format() || named.shape.is_some();
    let kind = if own { UNKNOWN } else { named.effect.reported_kind() };
    let text = |name: &str| named.estimated.texts.get(name).cloned();
    Finding {
        kind: kind.to_owned(),
        effect: (kind != named.effect.kind() && named.shape.is_none())
            .then(|| named.effect.kind().to_owned()),
        column: text(COLUMN_TEXT),
        column2: text("column2"),
        law: text("law"),
        formula: named.estimated.formula.clone(),
        shape: named.shape.clone(),
        equivalents: named.equivalents.iter().map(|e| (*e).to_owned()).collect(),
        probabilities: named.names.iter().map(|n| (n.kind.to_owned(), n.probability)).collect(),
        // Of a course of no kind, what is known of its parts is no parameter of the format.
        parameters: if own { BTreeMap::new() } else { named.estimated.reported.clone() },
        places: named.places.iter().map(PlaceRecord::of).take(3).collect(),
        delta_bic: named.delta_bic,
        p_value: named.p_value,
        heldout_gain: named.improvement.map(|i| i.heldout_gain),
        removed_share: named.improvement.and_then(|i| i.removed_share),
    }
}

fn places(
    effect: &'static dyn Effect,
    slot: Slot,
    best: &FittedHypothesis,
    chosen: &Chosen,
    problem: &Problem,
) -> Vec<Place> {
    let mut out = match (effect.model(), slot) {
        (Model::Mean(course), Slot::Mean(i)) => {
            let spectral = problem.spectra.of(course.resolution());
            let inside = &best.hypothesis.courses[i];
            course.places(&inside.nonlinear_parameters, &inside.coefficients, &spectral.drivers)
        }
        (Model::Spectrum(spectrum), Slot::Spectrum(i)) => {
            let spectral = &problem.spectra.full;
            let context = SpectralContext {
                bins: &spectral.bins,
                observed: &best.fit.observed,
                expected: &chosen.without.fit.densities,
                grid_step_arcsec: problem.spectra.grid_step_arcsec,
            };
            spectrum.places(&best.hypothesis.noise.spectra[i].fitted, &context)
        }
        _ => return vec![],
    };
    // Whatever it follows, it acts at some times more than at others.
    if out.len() < 3 && !out.iter().any(|p| p.domain == Domain::Time) {
        out.extend(contribution::time_of(slot, best, &problem.spectra));
    }
    out
}

/// Rows missing on the grid that the claim states. They are a fact: excluded from the search, the effect leaves a cause
/// without a name.
fn missing(problem: &Problem, options: &Options) -> Vec<Finding> {
    let one = |(effect, found): (&'static dyn Effect, Detection)| {
        let named = options.allows(effect.kind());
        let delta_bic = found.parameters as f64 * (problem.spectra.rows as f64).ln();
        let kind = if named { effect.reported_kind() } else { UNKNOWN };
        let mut finding = finding(&NamedEffect::detected(effect, &found, delta_bic));
        finding.parameters.retain(|_, _| named);
        Finding { kind: kind.to_owned(), ..finding }
    };
    samples::missing(problem, &problem.claim).into_iter().map(one).collect()
}

/// Fewest cycles of a record whose regularity distinguishes an oscillation from a driver.
const MIN_CYCLES: f64 = 20.0;

/// The other cause that the few cycles of an oscillation may have. A thermostat or a day that was not recorded swings as regularly
/// through them as what turns by itself, and no statistic of one record tells which it was.
fn ambiguous_oscillation(
    effect: &dyn Effect,
    reported: &BTreeMap<String, ParameterValue>,
    length_s: f64,
    options: &Options,
) -> Option<&'static str> {
    let other = effect.if_few_cycles()?.kind();
    let cycles = reported.get("frequency_hz")?.value * length_s;
    (cycles < MIN_CYCLES && options.allows(other)).then_some(other)
}

fn tests(before: &[Departure], after: &[Departure]) -> Vec<Test> {
    let (many, left) = (before.len().max(1) as f64, after.len().max(1) as f64);
    let one = |(i, b): (usize, &Departure)| {
        let same = |a: &&Departure| a.test == b.test && a.place.domain == b.place.domain;
        let a = after.get(i).filter(same).or_else(|| after.iter().find(same));
        Test {
            id: b.test.to_owned(),
            domain: b.place.domain,
            from: b.place.from,
            to: b.place.to,
            p_before: (b.p_value() * many).min(1.0),
            p_after: a.map_or(1.0, |a| (a.p_value() * left).min(1.0)),
        }
    };
    before.iter().enumerate().map(one).collect()
}

fn facts(problem: &Problem, recorded: &Recorded, options: &Options) -> RecordingFacts {
    RecordingFacts {
        rows: recorded.rows,
        missing: problem.grid.missing(),
        sample_interval_s: problem.grid.dt_s,
        length_s: recorded.length_s,
        columns: problem.drivers.columns().map(|c| c.name().to_owned()).collect(),
        hidden: options.hide.iter().map(|c| c.name().to_owned()).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_cycles_may_be_those_of_a_driver_and_many_may_not() {
        let at = |hz: f64| {
            let value = ParameterValue { value: hz, unit: "Hz".into(), ci95: [hz, hz] };
            BTreeMap::from([("frequency_hz".to_owned(), value)])
        };
        let options = Options::default();
        let beside = |kind: &str, reported: &BTreeMap<String, ParameterValue>, options: &Options| {
            ambiguous_oscillation(find(kind).unwrap(), reported, 1000.0, options)
        };
        const DRIVER: &str = "unobserved_driver";
        assert_eq!(beside("line", &at(0.019), &options), Some(DRIVER));
        assert_eq!(beside("quasi_periodic", &at(0.003), &options), Some(DRIVER));
        assert_eq!(beside("line", &at(0.021), &options), None);
        assert_eq!(beside("excess_rrw", &at(0.003), &options), None);
        assert_eq!(beside("line", &BTreeMap::new(), &options), None);
        let without = Options { without: vec![DRIVER], ..options };
        assert_eq!(beside("line", &at(0.003), &without), None);
    }
}
