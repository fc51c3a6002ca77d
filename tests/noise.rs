//! Noise: its evidence, its identification, its description, the classical read-outs.

mod noise_studies;
