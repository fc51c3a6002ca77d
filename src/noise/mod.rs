//! Noise of a gyro at rest: Allan family, spectra, autocorrelation, identification, simulation. Knows no procedure.

pub mod data;
pub mod evidence;
pub mod fit;
pub mod identify;
pub mod misfit;
pub mod model;
pub mod profile;
pub mod simulate;
