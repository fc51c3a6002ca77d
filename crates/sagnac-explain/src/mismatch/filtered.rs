//! A record behind a filter that its claim leaves out.
//!
//! Modes that a filter leaves next to nothing hold the few samples at the ends of the record instead, all of them the same.
//! A likelihood that takes modes as independent counts those samples many times, and prefers a wrong filter, or bursts and
//! jumps beside the right one. Each filter is therefore judged with the ends drawn as it would have them.

use super::candidates;
use super::fitted_hypothesis::{Candidate, FittedHypothesis};
use super::hypothesis::{Fit, Hypothesis, fit};
use super::options::Options;
use super::problem::Problem;
use super::select;
use super::spectral_data::SpectralData;
use super::terms::SpectralTerm;
use crate::effect::{EFFECTS, Effect, Model, SpectralContext, Spectrum, SpectrumAct};

/// Courses that are taken before a filter at most.
const MAX_COURSES: usize = 3;
/// Times that the ends are drawn for one filter, each for what was fitted before.
const END_DRAWS: usize = 2;
/// Observed over claimed power, times the samples, below which the ends of a record matter in a bin.
const MIN_OBSERVED_RATIO: f64 = 300.0;
/// Modes of a bin whose power counts as seen.
const MIN_SEEN_MODES: usize = 8;

fn filter(effect: &dyn Effect) -> Option<&'static dyn Spectrum> {
    match effect.model() {
        Model::Spectrum(s) if s.act() == SpectrumAct::Filters => Some(s),
        _ => None,
    }
}

/// True for a filter that is considered.
fn wanted(effect: &dyn Effect, options: &Options) -> bool {
    filter(effect).is_some() && options.allows(effect.kind())
}

/// One filter, fitted to what is seen behind it.
struct FittedFilter {
    tried: FittedHypothesis,
    modes: Vec<f64>,
    powers: Vec<f64>,
}

/// The filter that explains most beside a hypothesis, where the ends of the record matter and it passes the gates.
fn leading_filter(problem: &Problem, tried: &FittedHypothesis, options: &Options) -> Option<Candidate> {
    let spectral = &problem.spectra.full;
    let ratios = spectral.bins.iter().zip(tried.fit.observed.iter().zip(&tried.fit.densities));
    let faint = |share: f64| share * (spectral.length as f64) < MIN_OBSERVED_RATIO;
    if !ratios.filter(|(b, _)| b.modes >= MIN_SEEN_MODES).any(|(_, (seen, claimed))| faint(seen / claimed)) {
        return None;
    }
    let leader = candidates::among(tried, &problem.spectra, |e| wanted(e, options)).into_iter().next()?;
    select::passes(&leader, &spectral.drivers, options.alpha).then_some(leader)
}

/// The hypothesis with the course that explains more than a filter does, where there is one. Noise that was fitted too large in its
/// place looks as if a filter had taken the rest of it away.
fn with_better_course(
    problem: &Problem,
    tried: &FittedHypothesis,
    filter: &Candidate,
    options: &Options,
) -> Option<FittedHypothesis> {
    let wanted = |e: &dyn Effect| matches!(e.model(), Model::Mean(_)) && options.allows(e.kind());
    let leader = candidates::among(tried, &problem.spectra, wanted).into_iter().next()?;
    let drivers = &problem.spectra.full.drivers;
    let better = leader.tried.rank(problem.spectra.rows) < filter.tried.rank(problem.spectra.rows);
    (better && select::passes(&leader, drivers, options.alpha)).then_some(leader.tried)
}

/// The claim behind the filter that it leaves out, where there is one and the ends of the record matter; fitted to what is
/// seen behind it, with the courses that explain more than the filter.
pub fn behind(problem: &Problem, base: &FittedHypothesis, options: &Options) -> Option<FittedHypothesis> {
    let mut base = base.clone();
    let mut leader = leading_filter(problem, &base, options)?;
    for _ in 0..MAX_COURSES {
        let Some(with) = with_better_course(problem, &base, &leader, options) else { break };
        base = with;
        leader = leading_filter(problem, &base, options)?;
    }
    let base = &base;
    let spectral = &problem.spectra.full;
    let context = SpectralContext {
        bins: &spectral.bins,
        observed: &base.fit.observed,
        expected: &base.fit.densities,
        grid_step_arcsec: problem.spectra.grid_step_arcsec,
    };
    let judged: Vec<FittedFilter> = EFFECTS
        .iter()
        .filter(|e| wanted(**e, options))
        .filter_map(|e| Some((*e, filter(*e)?)))
        .flat_map(|(effect, spectrum)| {
            let fitted = spectrum.starts(&context).into_iter();
            fitted.map(move |fitted| SpectralTerm { effect, fitted, stated: false })
        })
        .map(|part| judged(problem, base, part))
        .collect();
    // All are compared on the modes that each of them leaves to be judged.
    let common: Vec<bool> =
        (0..spectral.length).map(|k| judged.iter().all(|j| j.powers[k].is_finite())).collect();
    let value = |j: &FittedFilter| {
        let modes = j.modes.iter().zip(&j.powers).zip(&common).filter(|(_, c)| **c);
        modes.map(|((x, p), _)| p.ln() + x * x / p).sum::<f64>()
    };
    judged.into_iter().min_by(|a, b| value(a).total_cmp(&value(b))).map(|j| j.tried)
}

fn judged(problem: &Problem, base: &FittedHypothesis, part: SpectralTerm) -> FittedFilter {
    let parameters = base.parameters + part.fitted.len();
    let mut hypothesis = base.hypothesis.clone();
    hypothesis.noise.spectra.push(part);
    let turn = |hypothesis: &mut Hypothesis| -> (SpectralData, Fit) {
        let spectral = problem.edges_imputed(base, &hypothesis.noise);
        let fit = fit(hypothesis, &spectral);
        (spectral, fit)
    };
    let (mut spectral, mut fit) = turn(&mut hypothesis);
    for _ in 1..END_DRAWS {
        (spectral, fit) = turn(&mut hypothesis);
    }
    let modes = super::hypothesis::residual(&spectral, &hypothesis, &fit.mean);
    let powers = spectral.powers(&fit.densities);
    FittedFilter {
        tried: FittedHypothesis { hypothesis, fit, parameters, odds: base.odds.clone() },
        modes,
        powers,
    }
}
