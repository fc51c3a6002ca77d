//! Noise of a gyro at rest: Allan family, spectra, autocorrelation, identification, simulation. Knows no procedure.
//!
//! Rates are in deg/h, times in s, densities in (deg/h)²/Hz. A *stretch* is an unbroken run of samples; a *segment* is that of
//! the averaged periodogram; a *block* is a mean on the sample grid.
//!
//! From samples to terms:
//!
//! | step | modules |
//! |---|---|
//! | one pass over the samples | [`digest`], made of [`allan`], [`welch`], [`block_series`], [`windows`], [`histogram`], [`envelope`]; [`part`]: passes that are merged |
//! | lines found and taken out | [`lines`], [`sinusoids`] |
//! | powers by frequency with what each term is expected to give | [`evidence`] |
//! | terms with intervals or limits | [`identification`]; [`spectral_record`] does lines, evidence and terms together |
//! | what the curve of the same record says | [`slope`], [`whole`] |
//! | whether the model describes the record | [`residual`] |
//!
//! Models and their closed forms: [`model`] (N, B, K, R, Q), [`composite`] (every term), [`data`] (kinds of noise, points
//! and series). Uncertainty of deviations: [`edf`], [`intervals`], [`ruling`], [`stretches`]. What a record can show before it is made:
//! [`expected`], [`identifiable`], [`null_ratio`]. Other quantities: [`russian`], [`prediction`], [`static_bias`], [`in_band`],
//! [`autocorrelation`]. Fitness of the record: [`motion`], [`coarse`], [`tails`]. Records with known noise: [`simulate`].

pub mod allan;
pub mod autocorrelation;
pub mod block_series;
pub mod coarse;
pub mod composite;
pub mod data;
mod difference_sums;
pub mod digest;
pub mod edf;
pub mod envelope;
pub mod evidence;
pub mod expected;
pub mod family;
pub mod histogram;
pub mod identifiable;
pub mod identification;
pub mod in_band;
pub mod intervals;
pub mod lines;
pub mod model;
pub mod motion;
pub mod null_ratio;
pub mod part;
mod phase;
pub mod prediction;
pub mod residual;
pub mod ruling;
pub mod russian;
pub mod simulate;
pub mod sinusoids;
pub mod slope;
pub mod spectral_record;
pub mod static_bias;
pub mod stretches;
mod strided;
pub mod tails;
pub mod tau_grid;
pub mod welch;
pub mod whole;
pub mod windows;
