//! Every effect of the catalogue, tried as an addition to a hypothesis.

use super::hypothesis::{
    CourseIn, Fit, Hypothesis, Normal, PartModes, columns, fit, kept, less_fixed, part_modes,
    part_modes_of_averages, residual, subtract,
};
use super::noise_fit::{self, Noise, SpectrumIn, base_index};
use super::options::Options;
use super::scene::Scene;
use super::shape::{first_steps, free_numbers, refine};
use crate::effect::{Course, EFFECTS, Effect, Look, Model, Pace, SpectralLook, Spectrum, SpectrumAct};
use crate::estimate::chi_square_tail;
use crate::numeric::cosine::inverse_dct2;
use rayon::prelude::*;
use std::borrow::Cow;

/// Samples above which a course at the sample rate is tried by itself.
const LONG: usize = 1 << 20;

/// Gain of a fit over that of its shapes, the noise held, from which the noise stood for the course.
const STOOD_FOR: f64 = 1.5;

/// The two resolutions a problem is looked at.
pub struct Scenes {
    /// At the sample rate.
    pub full: Scene,
    /// Averages, for courses that they hold; `None` where the record is short enough as it is.
    pub slow: Option<Scene>,
    /// Angle increment of a lattice that the values lie on, arcsec.
    pub lattice_arcsec: Option<f64>,
    /// Rows of the recording.
    pub rows: usize,
}

impl Scenes {
    /// The scene that a course of some pace is looked for on.
    pub fn of(&self, pace: Pace) -> &Scene {
        match (pace, &self.slow) {
            (Pace::Slow, Some(slow)) => slow,
            _ => &self.full,
        }
    }

    /// Modes of courses on the scene that one of some pace is looked for on.
    pub fn part_modes(&self, pace: Pace, courses: &[CourseIn]) -> Vec<PartModes> {
        match (pace, &self.slow) {
            (Pace::Slow, Some(slow)) => part_modes_of_averages(slow, &self.full, courses),
            _ => part_modes(&self.full, courses),
        }
    }
}

/// A hypothesis with its fit.
#[derive(Clone)]
pub struct Tried {
    /// The hypothesis, fitted.
    pub hypothesis: Hypothesis,
    /// Its fit on the full scene.
    pub fit: Fit,
    /// Parameters that it has beyond the claim.
    pub parameters: usize,
    /// Logarithm of the odds of its effects against kinds with the same course.
    pub odds: f64,
}

impl Tried {
    /// −2 ln L + parameters · ln rows.
    pub fn bic(&self, rows: usize) -> f64 {
        -2.0 * self.fit.log_likelihood + self.parameters as f64 * (rows as f64).ln()
    }

    /// Modes of what the hypothesis leaves of the full scene.
    pub fn residual(&self, scenes: &Scenes) -> Vec<f64> {
        residual(&scenes.full, &self.hypothesis, &self.fit.mean)
    }

    /// Variance of each mode of the full scene, (deg/h)².
    pub fn powers(&self, scenes: &Scenes) -> Vec<f64> {
        scenes.full.powers(&self.fit.densities)
    }

    /// What hypotheses are ordered by: BIC, and between equals what else speaks for their kinds.
    pub fn rank(&self, rows: usize) -> f64 {
        self.bic(rows) - 2.0 * self.odds
    }
}

/// An addition that was fitted.
#[derive(Clone)]
pub struct Candidate {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// The hypothesis with it.
    pub tried: Tried,
    /// Gain of log-likelihood over the hypothesis without it.
    pub gain: f64,
    /// Parameters that it adds.
    pub parameters: usize,
    /// BIC without it less BIC with it.
    pub delta_bic: f64,
    /// Probability of such a gain without it, its own search counted.
    pub p_value: f64,
}

fn rated(effect: &'static dyn Effect, tried: Tried, before: &Tried, looked: f64, rows: usize) -> Candidate {
    let gain = tried.fit.log_likelihood - before.fit.log_likelihood;
    let parameters = tried.parameters - before.parameters;
    let p_value = (looked.max(1.0) * chi_square_tail(2.0 * gain.max(0.0), parameters as f64)).min(1.0);
    let delta_bic = before.bic(rows) - tried.bic(rows);
    Candidate { effect, tried, gain, parameters, delta_bic, p_value }
}

/// Fits every effect that is thought of and not in the hypothesis yet as an addition to it; those that gain something,
/// the largest ΔBIC first.
pub fn all(before: &Tried, scenes: &Scenes, options: &Options) -> Vec<Candidate> {
    among(before, scenes, |e| options.allows(e.kind()))
}

/// As [`all`], of some effects only.
pub fn among(before: &Tried, scenes: &Scenes, wanted: impl Fn(&dyn Effect) -> bool + Sync) -> Vec<Candidate> {
    let grounds = Grounds::new(before, scenes);
    let tried = |effect: &&'static dyn Effect| match effect.model() {
        Model::Course(course) => try_course(*effect, course, before, scenes, &grounds),
        Model::Spectrum(spectrum) => try_spectrum(*effect, spectrum, before, scenes),
        Model::Samples(_) => None,
    };
    // Two long ones at once would not fit into the memory that a record is granted.
    let long = |effect: &&'static dyn Effect| {
        scenes.full.length > LONG
            && matches!(effect.model(), Model::Course(c) if grounds.of(c.pace()).scene.length > LONG)
    };
    let (alone, together): (Vec<_>, Vec<_>) = EFFECTS.iter().filter(|e| wanted(**e)).partition(|e| long(e));
    let mut found: Vec<Candidate> = together.into_par_iter().filter_map(tried).collect();
    found.extend(alone.into_iter().filter_map(tried));
    // Kinds with the same course are ordered by what else speaks for them.
    found.sort_by(|a, b| a.tried.rank(scenes.rows).total_cmp(&b.tried.rank(scenes.rows)));
    found
}

/// Logarithm of the odds of an effect without a kind in the format of explanations against one that has one: it is named
/// only where nothing with a name comes near.
fn own_odds(effect: &dyn Effect) -> f64 {
    if effect.reported_kind() == effect.kind() { 0.0 } else { -3.0 }
}

/// What is the same for every course tried on a hypothesis.
struct Grounds<'a> {
    full: Ground<'a>,
    slow: Option<Ground<'a>>,
}

impl<'a> Grounds<'a> {
    fn new(before: &'a Tried, scenes: &'a Scenes) -> Grounds<'a> {
        let courses = &before.hypothesis.courses;
        let ground = |scene, pace| Ground::new(before, scene, scenes.part_modes(pace, courses));
        let slow = scenes.slow.as_ref().map(|slow| ground(slow, Pace::Slow));
        Grounds { full: ground(&scenes.full, Pace::Fast), slow }
    }

    fn of(&self, pace: Pace) -> &Ground<'a> {
        match (pace, &self.slow) {
            (Pace::Slow, Some(slow)) => slow,
            _ => &self.full,
        }
    }
}

/// A hypothesis on a scene, ready for columns to be added to it.
struct Ground<'a> {
    scene: &'a Scene,
    before: &'a Tried,
    parts: Vec<PartModes>,
    powers: Vec<f64>,
    /// The modes that are to be explained: everything fixed taken out.
    data: Cow<'a, [f64]>,
    residual: Vec<f64>,
    score: Vec<f64>,
    left: f64,
}

impl<'a> Ground<'a> {
    fn new(before: &'a Tried, scene: &'a Scene, parts: Vec<PartModes>) -> Ground<'a> {
        let densities = before.hypothesis.noise.densities(scene);
        let powers = scene.powers(&densities);
        let data = less_fixed(scene, &parts);
        let mut out =
            Ground { scene, before, parts, powers, data, residual: vec![], score: vec![], left: 0.0 };
        let columns = out.columns(None);
        let normal = Normal::new(&columns, &out.data, &out.powers);
        let (coefficients, _, left) = normal.solve();
        let mut residual = out.data.to_vec();
        for ((column, _), c) in columns.iter().zip(&coefficients) {
            subtract(&mut residual, column, *c);
        }
        let weighted: Vec<f64> = residual.iter().zip(&out.powers).map(|(r, p)| r / p).collect();
        out.score = inverse_dct2(&weighted);
        out.residual = residual;
        out.left = left;
        out
    }

    /// The columns of the hypothesis with their priors, less the nuisance that a new course replaces.
    fn columns(&self, course: Option<&dyn Course>) -> Vec<(&[f64], f64)> {
        let replaced = course.and_then(|c| c.replaces());
        let mut nuisances = kept(self.scene, &self.before.hypothesis.courses);
        nuisances.retain(|n| Some(n.nuisance) != replaced);
        columns(&nuisances, &self.parts)
    }

    fn look(&self) -> Look<'_> {
        Look { score: &self.score, modes: &self.residual, powers: &self.powers }
    }
}

/// Gains of a course for its shapes, the noise held.
struct ShapeSearch<'a> {
    course: &'a dyn Course,
    ground: &'a Ground<'a>,
    columns: Vec<(&'a [f64], f64)>,
    normal: Normal,
}

impl ShapeSearch<'_> {
    fn gain(&self, shape: &[f64]) -> f64 {
        let ground = self.ground;
        let parts = PartModes::of(self.course.parts(shape, &ground.scene.drivers), ground.scene);
        if parts.fixed.is_none() && parts.free.is_empty() {
            return f64::NEG_INFINITY;
        }
        let mut data = Cow::Borrowed(&*ground.data);
        if let Some(fixed) = &parts.fixed {
            subtract(data.to_mut(), fixed, 1.0);
        }
        let new: Vec<&[f64]> = parts.free.iter().chain(&parts.beside).map(Vec::as_slice).collect();
        let normal = self.normal.with(&self.columns, &new, &data, parts.fixed.is_some(), &ground.powers);
        0.5 * (ground.left - normal.solve().2)
    }
}

fn try_course(
    effect: &'static dyn Effect,
    course: &'static dyn Course,
    before: &Tried,
    scenes: &Scenes,
    grounds: &Grounds<'_>,
) -> Option<Candidate> {
    let repeated = before.hypothesis.courses.iter().filter(|c| c.effect.kind() == effect.kind()).count();
    let ground = grounds.of(course.pace());
    let scene = ground.scene;
    if !course.applies(&scene.drivers) || effect.needs().iter().any(|c| scene.drivers.column(*c).is_none()) {
        return None;
    }
    let starts = course.starts(&scene.drivers, &ground.look());
    // A linear course twice is the same column twice.
    if repeated > 0 && starts.shapes.iter().all(Vec::is_empty) {
        return None;
    }
    let bounds = course.bounds(&scene.drivers);
    let steps = first_steps(course, &scene.drivers);
    let columns = ground.columns(Some(course));
    let normal = Normal::new(&columns, &ground.data, &ground.powers);
    let search = ShapeSearch { course, ground, columns, normal };
    let mut rough: Vec<(Vec<f64>, f64)> = starts.shapes.iter().map(|s| (s.clone(), search.gain(s))).collect();
    rough.sort_by(|a, b| b.1.total_cmp(&a.1));
    let leader = rough.first()?.1;
    let promising = rough.into_iter().filter(|(_, g)| *g > 0.7 * leader).take(2);
    let (shape, gain) = promising
        .map(|(s, g)| if s.is_empty() { (s, g) } else { refine(&s, &bounds, &steps, 60, |x| search.gain(x)) })
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    if gain.is_nan() || gain < 0.5 {
        return None;
    }
    let parts = course.parts(&shape, &scene.drivers);
    let free_shape = free_numbers(course, &bounds);
    let parameters = before.parameters + parts.free.len() + parts.beside.len() + free_shape;
    let odds = course.odds(&shape, &scene.drivers) + own_odds(effect);
    let with = |shape: &[f64], noise: &Noise| {
        let mut hypothesis = Hypothesis { noise: noise.clone(), ..before.hypothesis.clone() };
        hypothesis.courses.push(CourseIn { effect, shape: shape.to_vec(), coefficients: vec![] });
        hypothesis
    };
    let mut hypothesis = with(&shape, &before.hypothesis.noise);
    // The noise, fitted anew, can give at most about as much again.
    let worth = 4.0 * gain - (parameters - before.parameters) as f64 * (scenes.rows as f64).ln();
    let fit_of = |hypothesis: &mut Hypothesis| fit(hypothesis, &scenes.full);
    let mut fit = if worth > 0.0 { fit_of(&mut hypothesis) } else { before.fit.raised(gain) };
    // Noise that had to stand for the course weighed the samples wrongly while its shape was sought.
    if !shape.is_empty() && fit.log_likelihood - before.fit.log_likelihood > STOOD_FOR * gain {
        let quieter = Tried {
            hypothesis: Hypothesis { noise: hypothesis.noise.clone(), ..before.hypothesis.clone() },
            ..before.clone()
        };
        let ground = Ground::new(&quieter, scene, ground.parts.clone());
        let columns = ground.columns(Some(course));
        let normal = Normal::new(&columns, &ground.data, &ground.powers);
        let search = ShapeSearch { course, ground: &ground, columns, normal };
        let (shape, _) = refine(&shape, &bounds, &steps, 60, |x| search.gain(x));
        let mut again = with(&shape, &hypothesis.noise);
        let better = fit_of(&mut again);
        if better.log_likelihood > fit.log_likelihood {
            (hypothesis, fit) = (again, better);
        }
    }
    let tried = Tried { hypothesis, fit, parameters, odds: before.odds + odds };
    Some(rated(effect, tried, before, starts.looked, scenes.rows))
}

fn try_spectrum(
    effect: &'static dyn Effect,
    spectrum: &'static dyn Spectrum,
    before: &Tried,
    scenes: &Scenes,
) -> Option<Candidate> {
    let scene = &scenes.full;
    let act = spectrum.act();
    let observed = &before.fit.observed;
    let look = SpectralLook {
        bins: &scene.bins,
        observed,
        expected: &before.fit.densities,
        lattice_arcsec: scenes.lattice_arcsec,
    };
    if let SpectrumAct::Frees(term) = act {
        let i = base_index(term)?;
        if before.hypothesis.noise.freed[i] {
            return None;
        }
        return free_base(effect, i, before, scenes, observed);
    }
    let repeated =
        before.hypothesis.noise.spectra.iter().any(|s| !s.stated && s.effect.kind() == effect.kind());
    if repeated && effect.kind() != "quasi_periodic" {
        return None;
    }
    let starts = spectrum.starts(&look);
    let bounds = spectrum.bounds(&look);
    let begun = starts.iter().map(|start| {
        let mut noise = before.hypothesis.noise.clone();
        let fitted = start.iter().zip(&bounds).map(|(x, (low, high))| x.clamp(*low, *high)).collect();
        noise.spectra.push(SpectrumIn { effect, fitted, stated: false });
        noise
    });
    let noise = best_of(begun.collect(), scene, observed)?;
    if noise.spectra.last().is_some_and(|s| !spectrum.plausible(&s.fitted)) {
        return None;
    }
    let parameters = before.parameters + noise.spectra.last().map_or(0, |s| s.fitted.len());
    finish_spectrum(effect, noise, parameters, spectrum.looked(&look), before, scenes)
}

/// The best fit of several beginnings: all for a few steps, then the leading two to the end.
fn best_of(begun: Vec<Noise>, scene: &Scene, observed: &[f64]) -> Option<Noise> {
    const FEW: usize = 5;
    let mut fits: Vec<(Noise, f64)> = begun
        .into_iter()
        .map(|mut noise| {
            let value = noise_fit::fit_in(&mut noise, scene, observed, FEW).log_likelihood;
            (noise, value)
        })
        .collect();
    fits.sort_by(|a, b| b.1.total_cmp(&a.1));
    fits.truncate(2);
    for (noise, value) in &mut fits {
        *value = noise_fit::fit(noise, scene, observed).log_likelihood;
    }
    fits.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(noise, _)| noise)
}

/// N, B or K set free, begun at the claim and well above it: a strong prior traps a fit that begins beside it.
fn free_base(
    effect: &'static dyn Effect,
    i: usize,
    before: &Tried,
    scenes: &Scenes,
    observed: &[f64],
) -> Option<Candidate> {
    let scene = &scenes.full;
    let noise = &before.hypothesis.noise;
    // A coefficient claimed to be zero begins where it would be a tenth of the spectrum somewhere.
    let smallest = scene
        .units
        .iter()
        .zip(&before.fit.densities)
        .map(|(u, s)| (0.1 * s / u[i]).sqrt())
        .fold(f64::INFINITY, f64::min);
    let begin = if noise.base[i] > 0.0 { noise.base[i] } else { smallest };
    let fits = [1.0, 5.75, 33.0, 0.2].map(|factor| {
        let mut noise = noise.clone();
        noise.freed[i] = true;
        noise.base[i] = begin * factor;
        noise.spectra.push(SpectrumIn { effect, fitted: vec![begin * factor], stated: false });
        noise
    });
    let noise = best_of(fits.to_vec(), scene, observed)?;
    finish_spectrum(effect, noise, before.parameters + 1, 1.0, before, scenes)
}

fn finish_spectrum(
    effect: &'static dyn Effect,
    noise: Noise,
    parameters: usize,
    looked: f64,
    before: &Tried,
    scenes: &Scenes,
) -> Option<Candidate> {
    let mut hypothesis = before.hypothesis.clone();
    hypothesis.noise = noise;
    let fit = fit(&mut hypothesis, &scenes.full);
    let odds = before.odds + own_odds(effect);
    let candidate = rated(effect, Tried { hypothesis, fit, parameters, odds }, before, looked, scenes.rows);
    (candidate.gain > 0.5).then_some(candidate)
}
