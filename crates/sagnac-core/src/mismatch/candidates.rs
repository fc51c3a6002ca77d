//! Every effect of the catalogue, tried as an addition to a hypothesis.

mod course;
mod spectrum;

use super::hypothesis::{CourseIn, Fit, Hypothesis, PartModes, part_modes, part_modes_of_averages, residual};
use super::options::Options;
use super::spectral_data::SpectralData;
use crate::effect::{EFFECTS, Effect, Model, Resolution};
use crate::estimate::chi_square_tail;
use course::{Grounds, try_course};
use rayon::prelude::*;
use spectrum::try_spectrum;

/// Samples above which a course at the sample rate is tried by itself.
const LONG: usize = 1 << 20;

/// The two resolutions a problem is looked at.
pub struct SpectralDataSet {
    /// At the sample rate.
    pub full: SpectralData,
    /// Averages, for courses that they hold; `None` where the record is short enough as it is.
    pub slow: Option<SpectralData>,
    /// Angle increment of a lattice that the values lie on, arcsec.
    pub grid_step_arcsec: Option<f64>,
    /// Rows of the recording.
    pub rows: usize,
}

impl SpectralDataSet {
    /// The scene that a course of some pace is looked for on.
    pub fn of(&self, resolution: Resolution) -> &SpectralData {
        match (resolution, &self.slow) {
            (Resolution::Averaged, Some(slow)) => slow,
            _ => &self.full,
        }
    }

    /// Modes of courses on the scene that one of some pace is looked for on.
    pub fn part_modes(&self, resolution: Resolution, courses: &[CourseIn]) -> Vec<PartModes> {
        match (resolution, &self.slow) {
            (Resolution::Averaged, Some(slow)) => part_modes_of_averages(slow, &self.full, courses),
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
    pub fn residual(&self, spectra: &SpectralDataSet) -> Vec<f64> {
        residual(&spectra.full, &self.hypothesis, &self.fit.mean)
    }

    /// Variance of each mode of the full scene, (deg/h)².
    pub fn powers(&self, spectra: &SpectralDataSet) -> Vec<f64> {
        spectra.full.powers(&self.fit.densities)
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

fn rated(effect: &'static dyn Effect, tried: Tried, before: &Tried, trials: f64, rows: usize) -> Candidate {
    let gain = tried.fit.log_likelihood - before.fit.log_likelihood;
    let parameters = tried.parameters - before.parameters;
    let p_value = (trials.max(1.0) * chi_square_tail(2.0 * gain.max(0.0), parameters as f64)).min(1.0);
    let delta_bic = before.bic(rows) - tried.bic(rows);
    Candidate { effect, tried, gain, parameters, delta_bic, p_value }
}

/// Fits every effect that is thought of and not in the hypothesis yet as an addition to it; those that gain something,
/// the largest ΔBIC first.
pub fn all(before: &Tried, spectra: &SpectralDataSet, options: &Options) -> Vec<Candidate> {
    among(before, spectra, |e| options.allows(e.kind()))
}

/// As [`all`], of some effects only.
pub fn among(
    before: &Tried,
    spectra: &SpectralDataSet,
    wanted: impl Fn(&dyn Effect) -> bool + Sync,
) -> Vec<Candidate> {
    let grounds = Grounds::new(before, spectra);
    let tried = |effect: &&'static dyn Effect| match effect.model() {
        Model::Mean(course) => try_course(*effect, course, before, spectra, &grounds),
        Model::Spectrum(spectrum) => try_spectrum(*effect, spectrum, before, spectra),
        Model::Samples(_) => None,
    };
    // Two long ones at once would not fit into the memory that a record is granted.
    let long = |effect: &&'static dyn Effect| {
        spectra.full.length > LONG
            && matches!(effect.model(), Model::Mean(c) if grounds.of(c.resolution()).spectral.length > LONG)
    };
    let (alone, together): (Vec<_>, Vec<_>) = EFFECTS.iter().filter(|e| wanted(**e)).partition(|e| long(e));
    let mut found: Vec<Candidate> = together.into_par_iter().filter_map(tried).collect();
    found.extend(alone.into_iter().filter_map(tried));
    // Kinds with the same course are ordered by what else speaks for them.
    found.sort_by(|a, b| a.tried.rank(spectra.rows).total_cmp(&b.tried.rank(spectra.rows)));
    found
}

/// Logarithm of the odds of an effect without a kind in the format of explanations against one that has one: it is named
/// only where nothing with a name comes near.
fn own_odds(effect: &dyn Effect) -> f64 {
    if effect.reported_kind() == effect.kind() { 0.0 } else { -3.0 }
}
