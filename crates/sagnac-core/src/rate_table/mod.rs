//! Tests on a rate table: steps of known rate found in the recording, the response of the gyro to them, and what follows
//! from it: scale factor, nonlinearity, asymmetry, repeatability, hysteresis, sensitivity to temperature, errors over a
//! turn, alignment, dead zone; and the same from turns by a known angle and from positions against the Earth's rotation.
//!
//! Sources: IEEE Std 952-2020, 12.9 (scale factor), 12.10 (input rate), 12.12 (alignment); GUM (JCGM 100).

pub mod acceleration;
pub mod alignment;
pub mod blocks;
pub mod combine;
pub mod compensation;
pub mod cross_spectrum;
pub mod dead_zone;
pub mod design;
pub mod inner_axis;
pub mod known;
pub mod largest;
pub mod late;
pub mod model;
pub mod noise;
pub mod overload;
pub mod scale_factor;
pub mod scale_over_temperature;
pub mod settling;
pub mod setup;
pub mod sine;
pub mod soaks;
pub mod stamps;
pub mod steps;
pub mod transfer;
pub mod transfer_model;
pub mod turns;

pub use setup::Setup;
pub use steps::TableRun;
