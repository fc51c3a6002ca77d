//! Courses of jumps, weighed against what else was chosen and against processes that have their spectrum.

use super::departures::White;
use super::finding::ShapeRecord;
use super::fitted_hypothesis::FittedHypothesis;
use super::hypothesis::{kept, part_modes};
use super::named::{NamedEffect, SampleFindings, significant_delta_bic};
use super::noise_fit::{self, Noise};
use super::options::Options;
use super::problem::Problem;
use super::samples::with_free_level;
use super::select::{self, Selection, Slot};
use super::terms::SpectralTerm;
use crate::effect::{
    Background, Detector, EFFECTS, Effect, JumpDetector, Jumps, Model, Pulses, SpectralContext, Spectrum,
    SpectrumAct,
};

/// Gain by exponentially correlated noise, which has the spectrum of independent jumps, below which there are no jumps
/// either.
const LEAST_GAIN: f64 = 8.0;

/// Jumps in the residual of a hypothesis.
pub fn jumps(detector: &dyn JumpDetector, problem: &Problem, tried: &FittedHypothesis) -> Option<Jumps> {
    let (gain, noise) = rival(problem, tried, |s| s.is_relaxation()).filter(|r| r.0 >= LEAST_GAIN)?;
    let rival_gain = || {
        gain.max(rival(problem, tried, |s| !s.is_relaxation()).map_or(0.0, |r| r.0))
            .max(unconstrained(problem, tried))
            .max(line(problem, tried))
    };
    detector.find(&background(problem, tried, &noise), &rival_gain)
}

/// A record before a hypothesis with another noise.
fn background<'a>(problem: &'a Problem, tried: &FittedHypothesis, noise: &Noise) -> Background<'a> {
    let spectral = &problem.spectra.full;
    let courses = &tried.hypothesis.courses;
    let mut columns: Vec<(Vec<f64>, f64)> =
        kept(spectral, courses).into_iter().map(|n| (n.modes.clone(), n.deviation)).collect();
    for part in part_modes(spectral, courses) {
        columns.extend(part.columns.into_iter().chain(part.nuisance).map(|c| (c, f64::INFINITY)));
    }
    let densities = noise.densities(spectral);
    let without = noise_fit::whittle(spectral, &tried.fit.observed, &densities) + noise.prior();
    Background {
        drivers: &problem.drivers,
        modes: tried.residual(&problem.spectra),
        powers: spectral.powers(&densities),
        columns,
        lost: tried.fit.noise.log_likelihood - without,
        grid_step_arcsec: problem.spectra.grid_step_arcsec,
    }
}

/// Gain of the best spectral effect that is `wanted`, and the noise beside it.
fn rival(
    problem: &Problem,
    tried: &FittedHypothesis,
    wanted: impl Fn(&dyn Spectrum) -> bool,
) -> Option<(f64, Noise)> {
    let spectral = &problem.spectra.full;
    let observed = &tried.fit.observed;
    let before = tried.fit.noise.log_likelihood;
    let context = SpectralContext {
        bins: &spectral.bins,
        observed,
        expected: &tried.fit.densities,
        grid_step_arcsec: problem.spectra.grid_step_arcsec,
    };
    let mut best: Option<(f64, Noise)> = None;
    for effect in EFFECTS {
        let Model::Spectrum(spectrum) = effect.model() else { continue };
        if spectrum.act() != SpectrumAct::Adds || !wanted(spectrum) {
            continue;
        }
        let bounds = spectrum.bounds(&context);
        for start in spectrum.starts(&context) {
            let mut noise = tried.hypothesis.noise.clone();
            let fitted = start.iter().zip(&bounds).map(|(x, b)| b.clamp(*x)).collect();
            noise.spectra.push(SpectralTerm { effect: *effect, fitted, stated: false });
            let gain = noise_fit::fit(&mut noise, spectral, observed).log_likelihood - before;
            if best.as_ref().is_none_or(|b| gain > b.0) {
                noise.spectra.pop();
                best = Some((gain, noise));
            }
        }
    }
    best
}

/// Gain of an unconstrained flicker or random walk.
fn unconstrained(problem: &Problem, tried: &FittedHypothesis) -> f64 {
    let spectral = &problem.spectra.full;
    let observed = &tried.fit.observed;
    let mut best = 0.0f64;
    for i in 1..3 {
        for level in [1.0, 6.0, 33.0, 200.0] {
            let mut noise = tried.hypothesis.noise.clone();
            let beside = (noise.base[0] * 0.01).max(1e-9);
            noise.base[i] = noise.base[i].max(beside) * level;
            noise.unconstrained[i] = true;
            let fitted = noise_fit::fit(&mut noise, spectral, observed).log_likelihood;
            best = best.max(fitted - tried.fit.noise.log_likelihood);
        }
    }
    best
}

/// Gain of the best line: half the power of the whitened residual in a pair of neighbouring modes, which hold nearly
/// all of a line.
fn line(problem: &Problem, tried: &FittedHypothesis) -> f64 {
    let white = White::of(tried, &problem.spectra);
    white.modes.windows(4).map(|w| 0.5 * w.iter().map(|u| u * u).sum::<f64>()).fold(0.0, f64::max)
}

/// Jumps on one of the hypotheses that they may stand beside.
struct Weighed {
    jumps: Jumps,
    delta_bic: f64,
    /// True when nothing else explains nearly as much.
    told: bool,
    /// Gain of the selection on the same hypothesis.
    rival: f64,
    /// The process that the selection has in their place.
    instead: Option<&'static str>,
}

/// The best of jumps on the claim alone, and beside what else was chosen in place of each of its processes: they have the
/// spectrum of a slow process, and with another effect in the record neither the one nor the other alone comes near a pair.
fn weighed(
    detector: &dyn JumpDetector,
    problem: &Problem,
    start: &FittedHypothesis,
    selection: &Selection,
    alpha: f64,
) -> Option<Weighed> {
    let rows = problem.spectra.rows;
    let several = selection.chosen.len() > 1;
    let processes = selection.chosen.iter().filter(|c| several && matches!(c.slot, Slot::Spectrum(_)));
    let single = selection.chosen.iter().find(|_| !several).map(|c| c.effect.kind());
    let baselines =
        std::iter::once((start, single)).chain(processes.map(|c| (&c.without, Some(c.effect.kind()))));
    let judged = baselines.filter_map(|(tried, instead)| {
        let jumps = jumps(detector, problem, tried).filter(|j| j.resolved)?;
        let (gain, parameters) = (jumps.detection.gain, jumps.detection.parameters);
        let delta_bic = significant_delta_bic(gain, parameters, jumps.chance, rows, alpha)?;
        let told = significant_delta_bic(gain, parameters, jumps.detection.p_value, rows, alpha).is_some();
        let rival = tried.bic(rows) - selection.best.bic(rows);
        Some(Weighed { jumps, delta_bic, told, rival, instead })
    });
    judged.max_by(|a, b| (a.delta_bic - a.rival).total_cmp(&(b.delta_bic - b.rival)))
}

/// The claim's own fit where it states jumps without saying when: they are taken out where they are found as they are
/// stated, and stand as the process that has their spectrum where they cannot be resolved one by one.
pub(super) fn with_stated_jumps(problem: &mut Problem, alpha: f64) -> FittedHypothesis {
    let base = problem.baseline();
    let Some((detector, stated)) = problem.stated_jumps() else { return base };
    let Some((effect, fitted)) = detector.process(stated) else { return base };
    let alone = Selection { best: base.clone(), chosen: vec![], first: vec![] };
    let found = weighed(detector, problem, &base, &alone, alpha).filter(|w| w.told);
    match found.filter(|w| detector.agrees(stated, &w.jumps.detection)) {
        Some(Weighed { jumps, .. }) => {
            problem.take(&jumps.course);
            problem.baseline()
        }
        None => problem.baseline_with(Some(SpectralTerm { effect, fitted, stated: true })),
    }
}

/// Takes out jumps where they explain more than anything else does; where they explain about as much, they are an
/// equivalent.
pub(super) fn take_jumps(
    problem: &mut Problem,
    start: &FittedHypothesis,
    selection: &mut Selection,
    found: &mut SampleFindings,
    options: &Options,
) {
    for effect in EFFECTS {
        let Some(Detector::Jumps(detector)) = effect.detector() else { continue };
        if problem.claim.states(*effect) || selection.chosen.is_empty() || !options.allows(effect.kind()) {
            continue;
        }
        if let Some(weighed) = weighed(detector, problem, start, selection, options.alpha) {
            take(*effect, weighed, problem, start, selection, found, options);
        }
    }
}

/// Shape of pulses, for a report.
fn pulses_shape(pulses: &Pulses, jumps: &Jumps) -> ShapeRecord {
    let square = jumps.course.iter().map(|c| c * c).sum::<f64>() / jumps.course.len().max(1) as f64;
    ShapeRecord {
        form: "pulses".to_owned(),
        count: Some(pulses.count),
        each_s: Some(pulses.each_s),
        rms_deg_h: Some(square.sqrt()),
    }
}

fn take(
    effect: &'static dyn Effect,
    weighed: Weighed,
    problem: &mut Problem,
    start: &FittedHypothesis,
    selection: &mut Selection,
    found: &mut SampleFindings,
    options: &Options,
) {
    let Weighed { jumps, delta_bic, told, rival, instead } = weighed;
    if !told || delta_bic < rival {
        if delta_bic > rival - select::MIN_DELTA_BIC && jumps.pulses.is_none() {
            let replaced = selection.chosen.iter_mut().find(|c| Some(c.effect.kind()) == instead);
            replaced.into_iter().for_each(|c| c.beside = Some(effect.kind()));
        }
        return;
    }
    problem.take(&jumps.course);
    let mut base = problem.baseline();
    if start.hypothesis.noise.unconstrained[0] {
        base = with_free_level(&base, problem);
    }
    let equivalents = instead.filter(|_| delta_bic < rival + select::MIN_DELTA_BIC).into_iter().collect();
    let shape = jumps.pulses.map(|pulses| pulses_shape(&pulses, &jumps));
    let named =
        NamedEffect { equivalents, shape, ..NamedEffect::detected(effect, &jumps.detection, delta_bic) };
    found.gained_in_fit += base.fit.log_likelihood - start.fit.log_likelihood;
    found.named.push(named);
    found.take(jumps.course);
    // The first trials, on the claim alone, are those that the jumps were set against.
    let first = std::mem::take(&mut selection.first);
    *selection = Selection { first, ..select::select(&base, problem, options) };
}
