//! What surrounds a unit: chamber, room, weather, supply, people, tram; and the sensors that record it.
//!
//! All courses are on the slow grid of a [`span::Span`]; [`span::Span::at`] brings them to the rows of a recording.

pub mod chamber;
pub mod magnetic;
pub mod people;
pub mod room;
pub mod sensor;
pub mod span;
pub mod supply;
pub mod weather;
