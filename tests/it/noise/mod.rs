//! Noise: its evidence, its identification, its description, the classical read-outs.

mod described_noise;
mod evidence;
mod identification;
mod no_false_part;
mod output_noise;
mod readouts;
mod unit_samples;
