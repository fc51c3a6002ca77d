//! What the laboratory can conceal: scenes, and effects that are set into them.

pub mod driver;
pub mod event;
pub mod noise;
pub mod table;
pub mod temperature;
pub mod unknown;
pub mod unrecorded;
