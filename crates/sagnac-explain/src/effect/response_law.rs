//! Laws by which the bias responds to a column.

/// The law that a response follows mainly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResponseLaw {
    /// Proportional to the column.
    Linear,
    /// A curve of the column.
    Curve,
    /// Proportional to its rate of change.
    Rate,
    /// The delayed column.
    Lag,
    /// The direction from which a value was reached.
    Hysteresis,
}

impl ResponseLaw {
    /// All of them.
    pub const ALL: [ResponseLaw; 5] = [
        ResponseLaw::Linear,
        ResponseLaw::Curve,
        ResponseLaw::Rate,
        ResponseLaw::Lag,
        ResponseLaw::Hysteresis,
    ];

    /// Its id in `explain.json`.
    pub fn id(self) -> &'static str {
        match self {
            ResponseLaw::Linear => "linear",
            ResponseLaw::Curve => "curve",
            ResponseLaw::Rate => "rate",
            ResponseLaw::Lag => "lag",
            ResponseLaw::Hysteresis => "hysteresis",
        }
    }
}
