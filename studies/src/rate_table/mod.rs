//! Tests on a rate table that is made of geometry and mechanics.

pub mod evaluation;
pub mod intervals;
pub mod positions;
pub mod power;
pub mod tilts;
pub mod triads;
pub mod truths;
pub mod zones;

use crate::study::Study;

/// Positions against the Earth's rotation, and turns of a triad.
pub static KNOWN_INPUTS: Study = Study {
    id: "positions-and-turns",
    title: "Positions against the Earth's rotation and turns of a triad",
    method: "Six positions, 10 min each, twice, whose headings and elevations are in error by 0.1° and 0.02°; turns of a triad by \
             360° in 36 s about each axis, in error by 0.02°. Widths are over those of a fit that knows the noise.",
    records: 1000,
    cases: || [positions::cases(), triads::cases()].into_iter().flatten().collect(),
};
