//! The output under what is changed on purpose: switching off and on, a magnetic field, the supply voltage, vibration, or any
//! influence that a procedure declares.
//!
//! Everything rests on means of stretches of the recording with noise that is identified from the recording itself and
//! goes on between the stretches. Sources: IEEE Std 952-2020, 12.11 (bias repeatability, sensitivities).

pub mod comparison;
pub mod contrasts;
pub mod copied;
pub mod cut;
pub mod excitation;
mod flicker_marginal;
mod gls;
pub mod intervals;
pub mod nuisance;
pub mod over_frequency;
pub mod range;
pub mod rectification;
pub mod repeatability;
pub mod resonance;
pub mod response;
pub mod runs;
pub mod scale_factor;
pub mod setup;
pub mod shaken;

pub use setup::{
    ByFrequency, ComparisonTest, Influence, Law, LevelUnit, RepeatabilityTest, Setting, Stated, StatedLevel,
    ToldBy,
};
