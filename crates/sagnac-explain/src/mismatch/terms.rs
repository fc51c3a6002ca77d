//! Effects as terms of a hypothesis: each with the values of its parameters.

use crate::effect::{Effect, MeanModel, Model, Spectrum};

/// An effect on the mean in a hypothesis.
#[derive(Clone)]
pub struct MeanTerm {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Its nonlinear parameters.
    pub nonlinear_parameters: Vec<f64>,
    /// Coefficients of its free columns, from the last fit.
    pub coefficients: Vec<f64>,
    /// Coefficients of its states before the record, from the last fit.
    pub states: Vec<f64>,
}

impl MeanTerm {
    /// The forward model.
    pub fn course(&self) -> Option<&'static dyn MeanModel> {
        match self.effect.model() {
            Model::Mean(c) => Some(c),
            _ => None,
        }
    }
}

/// Fixed part and columns times their coefficients, of so many samples.
pub(super) fn summed(
    columns: &[Vec<f64>],
    coefficients: &[f64],
    fixed: Option<&Vec<f64>>,
    samples: usize,
) -> Vec<f64> {
    let mut sum = fixed.cloned().unwrap_or_else(|| vec![0.0; samples]);
    for (column, c) in columns.iter().zip(coefficients) {
        sum.iter_mut().zip(column).for_each(|(s, z)| *s += c * z);
    }
    sum
}

/// A spectral effect with its fitted parameters.
#[derive(Clone)]
pub struct SpectralTerm {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Fitted parameters; the whole coefficient for an unconstrained one.
    pub fitted: Vec<f64>,
    /// True when the claim states it: its parameters stay.
    pub stated: bool,
}

impl SpectralTerm {
    /// The forward model.
    pub fn spectrum(&self) -> Option<&'static dyn Spectrum> {
        match self.effect.model() {
            Model::Spectrum(s) => Some(s),
            _ => None,
        }
    }
}
