//! Noise of a gyro at rest: Allan family, spectra, autocorrelation, identification, simulation. Knows no procedure.

pub mod data;
pub mod evidence;
pub mod expected;
pub mod fit;
pub mod identify;
pub mod misfit;
pub mod model;
pub mod profile;
pub mod russian;
pub mod simulate;
pub mod static_bias;
