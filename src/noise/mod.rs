//! Noise of a gyro at rest: Allan family, spectra, autocorrelation, identification, simulation. Knows no procedure.

pub mod allan;
pub mod autocorrelation;
pub mod block_series;
pub mod data;
mod difference_sums;
pub mod digest;
pub mod edf;
pub mod envelope;
pub mod family;
pub mod histogram;
pub mod intervals;
pub mod lines;
mod phase;
pub mod stretches;
mod strided;
pub mod tau_grid;
pub mod welch;
pub mod windows;
