//! A claimed simulation: the noise, mean, sensitivities and effects that an engineer believes a recording to hold, each
//! with the uncertainty that he gives it.

mod coefficient;
mod profile;

use coefficient::prior_of_zero;

pub use coefficient::Coefficient;
pub use profile::{Profile, SimulationPlan};

use crate::effect::{ClaimedMean, Column, Effect, Model, StatedLine, Values};
use crate::local_text::LocalText;
use crate::noise::model::NoiseModel;

/// A claim (`model.toml`).
#[derive(Clone)]
pub struct Claim {
    /// Name of the case; empty where none is stated.
    pub case: String,
    /// Free text.
    pub description: LocalText,
    /// Nominal sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Columns that the recording is stated to have, beside time and rate. `None` where the claim does not say.
    pub columns: Option<Vec<Column>>,
    /// N, B, K; Q from the angle increment, lsb/√12.
    pub noise: NoiseModel,
    /// Angle increment of the output, arcsec; 0 for none.
    pub quantization_lsb_arcsec: f64,
    /// The mean.
    pub mean: ClaimedMean,
    /// How well it is known.
    pub uncertainty: Uncertainty,
    /// Effects that it states.
    pub effects: Vec<Stated>,
}

impl Claim {
    /// Whether it states an effect of that kind.
    pub fn states(&self, effect: &dyn Effect) -> bool {
        self.effects.iter().any(|e| e.effect.kind() == effect.kind())
    }

    /// The lines that it states.
    pub fn lines(&self) -> Vec<StatedLine> {
        let of = |stated: &Stated| match stated.effect.model() {
            Model::Mean(course) => course.claimed_line(&stated.values),
            _ => None,
        };
        self.effects.iter().filter_map(of).collect()
    }
}

/// One standard deviation of the author's knowledge; 0 is exact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Uncertainty {
    /// Relative, of N.
    pub n_rel: f64,
    /// Relative, of B.
    pub b_rel: f64,
    /// Relative, of K.
    pub k_rel: f64,
    /// Of N where the claim states 0, deg/√h: N is no larger than what this allows, and may be less.
    pub n_deg_rt_h: f64,
    /// The same of B, deg/h.
    pub b_deg_h: f64,
    /// The same of K, deg/h/√h.
    pub k_deg_h_rt_h: f64,
    /// Upper limit of N where the claim states 0 and a record did not resolve it, deg/√h.
    pub n_at_most_deg_rt_h: f64,
    /// The same of B, deg/h.
    pub b_at_most_deg_h: f64,
    /// The same of K, deg/h/√h.
    pub k_at_most_deg_h_rt_h: f64,
    /// deg/h. The engine leaves the bias free whatever it is.
    pub bias_deg_h: f64,
    /// deg/h/°C.
    pub temperature_coefficient_deg_h_per_degc: f64,
    /// ppm.
    pub scale_factor_ppm: f64,
    /// Largest third standardised moment, of either sign, that the noise of single samples may have; 0 for noise of an even law.
    pub skewness: f64,
}

impl Uncertainty {
    /// Deviations of N, B and K where the claim states 0; 0 for exactly nothing.
    pub fn of_zero(&self) -> [f64; 3] {
        [
            prior_of_zero(self.n_deg_rt_h, self.n_at_most_deg_rt_h),
            prior_of_zero(self.b_deg_h, self.b_at_most_deg_h),
            prior_of_zero(self.k_deg_h_rt_h, self.k_at_most_deg_h_rt_h),
        ]
    }
}

/// An effect with its parameters.
#[derive(Clone)]
pub struct Stated {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Its parameters by name.
    pub values: Values,
}

/// A model file: a claim, and what `simulate` needs beside it.
#[derive(Clone)]
pub struct ModelFile {
    /// The claim.
    pub claim: Claim,
    /// The simulation where the command line does not say.
    pub simulation: SimulationPlan,
    /// Courses of columns.
    pub drivers: Vec<Profile>,
}
