//! Figures as data, one a file.

pub mod allan_family;
pub mod autocorrelation;
pub mod bias_of_runs;
pub mod bode;
pub mod dead_zone;
mod draw;
pub mod gravity;
pub mod histogram;
pub mod influence;
mod parts;
pub mod polar;
pub mod positions;
pub mod residual;
pub mod scale_factor;
pub mod scale_over_temperature;
pub mod sigma_tau;
mod sigma_tau_limits;
pub mod spectrum;
pub mod thermal;
pub mod time_series;
