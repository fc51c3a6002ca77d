//! The unit: heat that flows through a network, a coil of many layers, a static curve, hysteresis, laws of other influences.

pub mod body;
pub mod curve;
pub mod hysteresis;
pub mod network;
pub mod response;
