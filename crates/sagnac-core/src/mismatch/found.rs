//! What was found before and beside the selection.

use super::samples::Named;

/// What was found in single samples.
#[derive(Default)]
pub struct Found {
    /// What was named.
    pub named: Vec<Named>,
    /// Deviation of the noise of each sample over that of the record.
    pub level: Option<Vec<f64>>,
    /// What was taken out of the residual, deg/h.
    pub taken: Option<Vec<f64>>,
    /// What the fits without it gained, which counts it as known.
    pub gained_in_fit: f64,
}

impl Found {
    /// Takes a course out of what is left to explain.
    pub fn take(&mut self, course: Vec<f64>) {
        match &mut self.taken {
            Some(sum) => sum.iter_mut().zip(course).for_each(|(s, c)| *s += c),
            None => self.taken = Some(course),
        }
    }

    /// Gain that the fits in cosine modes do not hold.
    pub fn local_gain(&self) -> f64 {
        self.named.iter().map(|n| n.local_gain).sum::<f64>() - self.gained_in_fit
    }
}
