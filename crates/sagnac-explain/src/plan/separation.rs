//! How far an explanation is from another in a record that is still to be made, and the probability that the record decides.
//!
//! The truth is put in without noise: its course, and its spectrum as it is expected. The rival is fitted to that as an
//! explanation would fit it: its coefficients, its nonlinear parameters, the nuisances and the noise of the claim under
//! their priors. Twice the loss of log-likelihood is δ². Of a record with noise, twice the difference of log-likelihoods is a
//! noncentral χ² of that noncentrality (Wald 1943).

use super::power::{needed, noncentral_tail, quantile};
use super::trial::Trial;
use crate::claim::{Claim, Stated};
use crate::effect::{EFFECTS, Effect, Later, Model, SearchContext, SpectralContext, SpectrumAct};
use crate::estimate::chi_square_tail;
use crate::mismatch::experiment::{Nearest, free_parameters, nearest, share_decided};
use crate::mismatch::hypothesis::{PartModes, columns, kept};
use crate::mismatch::noise_fit::{Noise, base_index, fit, whittle};
use crate::mismatch::select::MIN_DELTA_BIC;
use crate::mismatch::terms::{MeanTerm, SpectralTerm};
use crate::numeric::cosine::inverse_dct2;
use crate::numeric::least_squares::{Normal, subtract};

/// Significance of an explanation.
const ALPHA: f64 = 0.01;
/// Kinds that an explanation tries beside those of the catalogue, as `select` counts them.
const FAMILY_BESIDE: f64 = 8.0;
/// Probability of deciding between processes, without noise, below which it is not simulated.
const MIN_DECIDABLE_PROBABILITY: f64 = 0.05;
/// Points that the search of a rival goes on from.
const STARTS: usize = 2;

/// An explanation in a trial.
pub(super) struct Shown {
    /// The effect that the record shows; `None` where it shows nothing beyond the claim.
    pub effect: Option<&'static dyn Effect>,
    /// False where the record gives an explanation no hold to name it.
    applies: bool,
    modes: Vec<f64>,
    noise: Noise,
    /// Degrees of freedom that its fit has beyond the claim.
    dof: f64,
}

/// An alternative in a later record: the stated effect, another one, or nothing.
pub(super) fn later(alternative: &Stated, claim: &Claim) -> Option<Stated> {
    match alternative.effect.later(&alternative.values, &claim.mean) {
        Later::Same => Some(alternative.clone()),
        Later::Nothing => None,
        Later::As(effect, values) => Some(Stated { effect, values }),
    }
}

impl Shown {
    /// The claim alone.
    fn nothing(claim: &Claim, trial: &Trial) -> Shown {
        let modes = vec![0.0; trial.spectral.modes.len()];
        Shown { effect: None, applies: true, modes, noise: Noise::of(claim), dof: 0.0 }
    }

    /// An alternative as a trial shows it; `None` where its parameters do not determine it.
    pub fn new(stated: Option<&Stated>, claim: &Claim, trial: &Trial) -> Option<Shown> {
        let mut out = Shown::nothing(claim, trial);
        let Some(stated) = stated else { return Some(out) };
        out.effect = Some(stated.effect);
        let spectral = &trial.spectral;
        match stated.effect.model() {
            Model::Mean(course) => {
                out.applies = course.applies(&spectral.drivers);
                // Without the columns that it follows, a trial shows nothing of it.
                let series = course.course(&stated.values, &spectral.drivers);
                if let Some(series) = series {
                    out.modes = spectral.transform(&series);
                } else if stated.effect.needs().iter().all(|c| spectral.drivers.column(*c).is_some()) {
                    return None;
                }
                let at: Vec<f64> =
                    course.bounds(&spectral.drivers).iter().map(|b| 0.5 * (b.low + b.high)).collect();
                let columns = course.regressors(&at, &spectral.drivers).columns.len();
                out.dof = (columns + free_parameters(course, spectral)) as f64;
            }
            Model::Spectrum(spectrum) => {
                let process = || stated.effect.claimed_by_course()?.process(&stated.values);
                let fitted = spectrum.claimed_parameters(&stated.values).or_else(process)?;
                out.dof = fitted.len() as f64;
                if let SpectrumAct::Unconstrains(term) = spectrum.act()
                    && let (Some(i), Some(value)) = (base_index(term), fitted.first())
                {
                    (out.noise.base[i], out.noise.unconstrained[i]) = (*value, true);
                }
                out.noise.spectra.push(SpectralTerm { effect: stated.effect, fitted, stated: false });
            }
            Model::Samples(_) => return None,
        }
        out.dof = out.dof.max(1.0);
        Some(out)
    }

    fn is_process(&self) -> bool {
        self.effect.is_some_and(|e| matches!(e.model(), Model::Spectrum(_)))
    }

    /// Positions that a search for it looks at.
    fn trials(&self, trial: &Trial) -> f64 {
        let densities = self.noise.densities(&trial.spectral);
        match self.effect.map(|e| e.model()) {
            Some(Model::Mean(course)) => {
                let powers = trial.spectral.powers(&densities);
                let score = score(&self.modes, &powers);
                let context = SearchContext { score: &score, modes: &self.modes, powers: &powers };
                course.starts(&trial.spectral.drivers, &context).trials.max(1.0)
            }
            Some(Model::Spectrum(spectrum)) => {
                let bins = &trial.spectral.bins;
                let context = SpectralContext {
                    bins,
                    observed: &densities,
                    expected: &densities,
                    grid_step_arcsec: None,
                };
                spectrum.trials(&context).max(1.0)
            }
            _ => 1.0,
        }
    }
}

fn score(modes: &[f64], powers: &[f64]) -> Vec<f64> {
    inverse_dct2(&modes.iter().zip(powers).map(|(m, p)| m / p).collect::<Vec<f64>>())
}

/// What a rival leaves of the modes of the truth: the modes, and the price of the nuisances that it moved.
fn left_by(rival: &Shown, modes: &[f64], powers: &[f64], trial: &Trial) -> (Vec<f64>, f64) {
    let spectral = &trial.spectral;
    let mut courses = vec![];
    let mut parts = vec![];
    if let Some(effect) = rival.effect
        && let Model::Mean(course) = effect.model()
    {
        let score = score(modes, powers);
        let context = SearchContext { score: &score, modes, powers };
        let starts = course.starts(&spectral.drivers, &context).points;
        let from = |start: &Vec<f64>| {
            let rival = MeanTerm {
                effect,
                nonlinear_parameters: start.clone(),
                coefficients: vec![],
                states: vec![],
            };
            (nearest(modes, &rival, course, spectral, powers), rival)
        };
        let best = starts.iter().take(STARTS).map(from).min_by(|a, b| a.0.squared.total_cmp(&b.0.squared));
        if let Some((Nearest { nonlinear_parameters, .. }, rival)) = best {
            parts.push(PartModes::of_shape(course, &nonlinear_parameters, spectral));
            courses.push(MeanTerm { nonlinear_parameters, ..rival });
        }
    }
    let mut left = modes.to_vec();
    for offset in parts.iter().filter_map(|p| p.offset.as_ref()) {
        subtract(&mut left, offset, 1.0);
    }
    let nuisances = kept(spectral, &courses);
    let columns = columns(&nuisances, &parts);
    let (coefficients, _, _) = Normal::new(&columns, &left, powers).solve();
    for ((column, _), c) in columns.iter().zip(&coefficients) {
        subtract(&mut left, column, *c);
    }
    let moved = nuisances.iter().zip(&coefficients).map(|(n, c)| (c / n.deviation).powi(2)).sum();
    (left, moved)
}

/// Squared distance δ² of a truth from the nearest that a rival makes of it.
fn squared_distance(truth: &Shown, rival: &Shown, trial: &Trial) -> f64 {
    let spectral = &trial.spectral;
    let expected = truth.noise.densities(spectral);
    let (left, moved) = left_by(rival, &truth.modes, &spectral.powers(&expected), trial);
    let excess = spectral.observed(&left);
    let observed: Vec<f64> = expected.iter().zip(&excess).map(|(s, e)| s + e).collect();
    let mut noise = rival.noise.clone();
    let fitted = fit(&mut noise, spectral, &observed).log_likelihood - 0.5 * moved;
    // Each mode is the square of its mean beside its variance: the observed density of one has both.
    let best = whittle(spectral, &expected, &expected) + truth.noise.prior();
    let squared = 2.0 * (best - fitted);
    if squared.is_finite() { squared.max(0.0) } else { 0.0 }
}

/// What a decision between a truth and something else comes to in a trial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Decision {
    /// Squared distance δ².
    pub squared: f64,
    /// Probability that the record decides for the truth.
    pub probability: f64,
    /// Part of the squared distance that is needed for a probability asked for, 0 to 1.
    pub reached: f64,
}

impl Decision {
    /// By a gain that must be above a threshold.
    fn by_gain(squared: f64, threshold: f64, dof: f64, asked: f64) -> Decision {
        let probability = noncentral_tail(threshold, dof, squared);
        let reached =
            if probability >= asked { 1.0 } else { squared / needed(threshold, dof, asked).max(1e-9) };
        Decision { squared, probability, reached: reached.clamp(0.0, 1.0) }
    }

    fn certain(probability: f64) -> Decision {
        Decision { squared: 0.0, probability, reached: if probability > 0.5 { 1.0 } else { 0.0 } }
    }
}

/// Whether a truth is found at all: its gain over the claim passes the gate of an explanation. A truth without an
/// effect is found if nothing is named.
pub(super) fn found(truth: &Shown, claim: &Claim, trial: &Trial, asked: f64) -> Decision {
    if truth.effect.is_none() {
        return Decision::certain(1.0 - ALPHA);
    }
    if !truth.applies {
        return Decision::certain(0.0);
    }
    let squared = squared_distance(truth, &Shown::nothing(claim, trial), trial);
    let chance = 0.5 * ALPHA / (EFFECTS.len() as f64 + FAMILY_BESIDE) / truth.trials(trial);
    let threshold = quantile(chance, truth.dof);
    Decision::by_gain(squared, threshold, truth.dof, asked)
}

/// Whether a record of the truth tells it from a rival.
pub(super) fn told_apart(truth: &Shown, rival: &Shown, trial: &Trial, asked: f64) -> Decision {
    let price = (rival.dof - truth.dof) * trial.rows.ln();
    let same = truth.effect.map(|e| e.kind()) == rival.effect.map(|e| e.kind());
    if truth.effect.is_none() {
        // The rival must lose what BIC charges it: chance alone gains χ² of its degrees of freedom.
        let probability = 1.0 - chi_square_tail(price - MIN_DELTA_BIC, rival.dof);
        return if same { Decision::certain(0.0) } else { Decision::certain(probability) };
    }
    if !truth.applies || same && truth.modes == rival.modes {
        return Decision::certain(0.0);
    }
    let squared = squared_distance(truth, rival, trial);
    // The gain of the rival by chance is its degrees of freedom in the mean.
    let by_chance = if rival.effect.is_some() { rival.dof } else { 0.0 };
    let decided = Decision::by_gain(squared, MIN_DELTA_BIC - price + by_chance, truth.dof, asked);
    if truth.is_process() && rival.is_process() && decided.probability >= MIN_DECIDABLE_PROBABILITY {
        let probability = share_decided(&truth.noise, &rival.noise, &trial.full, price);
        let reached = if probability >= asked { 1.0 } else { decided.reached.min(0.99) };
        return Decision { probability, reached, squared };
    }
    decided
}
