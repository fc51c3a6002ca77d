//! Studies of the noise by the library alone.

mod described_noise;
mod evidence;
mod identification;
mod readouts;
