//! Looks at a growing recording that a procedure fixes beforehand.

/// Looks at a growing recording, as times.
#[derive(Debug, Clone, PartialEq)]
pub struct InterimPlan {
    /// Evaluated time after the warm-up at each look, s, ascending; the last is the full duration.
    pub looks_s: Vec<f64>,
    /// Risk of every limit over all looks; `None`: that of each limit.
    pub risk: Option<f64>,
    /// How far a recording has come, once its length is known.
    pub reached: Option<Reached>,
}

/// How far a recording has come in its plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    /// Number of looks that lie in it.
    pub looks: usize,
    /// Its length after the warm-up, s.
    pub recorded_s: f64,
}

impl InterimPlan {
    /// The look that the recording is evaluated at, s; `None` before the first.
    pub fn evaluated_s(&self) -> Option<f64> {
        let looks = self.reached?.looks;
        self.looks_s.get(looks.checked_sub(1)?).copied()
    }
}
