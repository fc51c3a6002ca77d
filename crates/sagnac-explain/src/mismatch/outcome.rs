//! Everything that an explanation leaves behind.

use super::alternatives::Alternative;
use super::finding::Explanation;
use crate::claim::Claim;
use crate::figure::Figure;

/// Result of an explanation.
pub struct Outcome {
    /// `explain.json`.
    pub explanation: Explanation,
    /// The contribution that the claim left out, as (`time_s`, deg/h). `None` where it cannot be predicted sample by
    /// sample.
    pub correction: Option<Vec<(f64, f64)>>,
    /// The claim with re-estimated nuisances and the effects found.
    pub augmented: Claim,
    /// Third standardised moment, of either sign, that single samples of the noise may have by this recording: what it shows and
    /// twice its deviation; 0 where the recording shows none.
    pub skewness: f64,
    /// For each cause that has equivalents, what would explain the recording as well: the chosen explanation and the others,
    /// each with its parameters.
    pub alternatives: Vec<Alternative>,
    /// Figures, the located view first.
    pub figures: Vec<Figure>,
}
