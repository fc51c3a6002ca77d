//! What is done while a recording runs.

/// What was done while the recording ran.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scenario {
    /// Table at rest in the laboratory.
    Static,
    /// The same for days.
    Days,
    /// Chamber with ramps and soaks.
    Thermal,
    /// Chamber up and down again.
    Cycles,
    /// Steps of table rate.
    Rates,
    /// Steps of table rate while the chamber ramps.
    RatesThermal,
    /// Table rates of some arc seconds a second.
    Slow,
    /// Positions of the table, north found by the Earth's rate.
    Headings,
    /// One heading all the time, stated.
    Fixed,
    /// Whole revolutions of the table.
    Revolutions,
    /// Supply voltage varied.
    Supply,
    /// The table's other axis turned.
    Outer,
    /// Chamber and supply varied.
    Combined,
}

/// Scenarios a null is drawn from.
pub const ALL: [Scenario; 13] = [
    Scenario::Static,
    Scenario::Days,
    Scenario::Thermal,
    Scenario::Cycles,
    Scenario::Rates,
    Scenario::RatesThermal,
    Scenario::Slow,
    Scenario::Headings,
    Scenario::Fixed,
    Scenario::Revolutions,
    Scenario::Supply,
    Scenario::Outer,
    Scenario::Combined,
];
