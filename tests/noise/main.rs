//! Noise: its evidence, its identification, its description, the classical read-outs.

mod described_noise;
mod evidence;
mod identification;
mod no_false_part;
mod readouts;
#[path = "../support/mod.rs"]
mod support;
mod unit_samples;
