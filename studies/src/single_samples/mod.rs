//! What shows in single samples: bursts of outliers, a changing level of the noise, telegraph signals.

pub mod detection;
pub mod false_finds;
pub mod inject;
pub mod level;
pub mod records;

use crate::study::Study;

/// Detection of what was put in.
pub static DETECTION: Study = Study {
    id: "local-effects",
    title: "Bursts, noise levels and telegraph signals that are there",
    method: "Records at 10 Hz of white noise, flicker or a random walk, with groups of outliers, a level of the noise that changes \
             over time or with the rate of a table (±50 °/s, seven periods), or a telegraph signal.",
    records: 60,
    cases: || [detection::cases(), level::cases()].into_iter().flatten().collect(),
};
