//! Noise of a gyro at rest: Allan family, spectra, autocorrelation, identification, simulation. Knows no procedure.

pub mod data;
pub mod model;
pub mod simulate;
