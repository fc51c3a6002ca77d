//! Physics and searches that several effects use. None of it names an effect.

pub(super) mod chance;
pub(super) mod delay;
pub(super) mod first_order;
pub(super) mod heading;
pub(super) mod heterodyne;
pub(super) mod knots;
pub(super) mod law;
pub mod low_pass;
pub(super) mod markov;
pub(super) mod noise_level;
pub(super) mod phase;
pub(super) mod polynomial;
pub(super) mod power_law;
pub(super) mod pursuit;
pub(super) mod reach;
pub(super) mod response;
pub(super) mod search;
pub(super) mod sinusoid;
pub(super) mod stated_lines;
pub(super) mod step;
pub(super) mod table_angle;
pub(super) mod thermal;
pub(super) mod variance;
