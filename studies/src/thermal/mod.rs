//! Temperature and warm-up tests of a simulated unit in a chamber.

pub mod ambiguity;
pub mod evaluation;
pub mod intervals;
pub mod warm_up;

use crate::study::Study;

/// Bias over temperature.
pub static INTERVALS: Study = Study {
    id: "temperature-intervals",
    title: "Intervals over temperature",
    method: "A unit at random in a chamber between −40 and +60 °C: static curve of third order, sensitivity to the rate of \
             temperature, lag of the coil, play, white noise, flicker and random walk. Cycles at one and two rates, with and \
             without dwells. Widths are over those of a fit that knows noise, lag, play and order. N is measured in five zones \
             of temperature.",
    records: 200,
    cases: intervals::cases,
};

/// Units without some of the effects.
pub static AMBIGUITY: Study = Study {
    id: "temperature-single-effects",
    title: "Units over temperature with few effects, and a narrow range",
    method: "Units without sensitivity to the rate of temperature, lag or play, with one of these alone, and all of them between \
             10 and 30 °C: what lag and rate of temperature leave open. One-sided bounds at 5 % may lie beyond the truth in 10 % \
             of the tests, both sides together.",
    records: 200,
    cases: ambiguity::cases,
};
