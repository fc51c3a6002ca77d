//! The members of the Allan family, and the textbook form of the non-overlapping ones.
//!
//! Phase here is the running sum of the rate in units of the sample interval, so that a deviation comes out in the
//! unit of the rate and τ0 appears in labels only.
//!
//! Source: Riley, NIST SP 1065 (2008), sections 5.2.2 to 5.2.11; IEEE Std 952 annex C.

use super::data::DeviationPoint;

/// A deviation of the Allan family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Estimator {
    /// Overlapping Allan deviation.
    Allan,
    /// Modified Allan deviation: tells white angle noise from other noise of slope −1.
    Modified,
    /// Overlapping Hadamard deviation: blind to a linear drift of the rate.
    Hadamard,
    /// Total deviation: the phase continued by reflection at both ends. Not corrected for its bias.
    Total,
}

impl Estimator {
    /// Every estimator, in the order of `sigma_tau.csv`.
    pub const ALL: &'static [Estimator] =
        &[Estimator::Allan, Estimator::Modified, Estimator::Hadamard, Estimator::Total];

    /// The id used in `sigma_tau.csv`.
    pub fn id(self) -> &'static str {
        match self {
            Estimator::Allan => "oadev",
            Estimator::Modified => "mdev",
            Estimator::Hadamard => "hdev",
            Estimator::Total => "totdev",
        }
    }

    /// Number of averaging times that one term spans, beyond which a stretch of samples holds no term.
    pub fn span(self) -> u64 {
        match self {
            Estimator::Allan | Estimator::Total => 2,
            Estimator::Modified | Estimator::Hadamard => 3,
        }
    }

    /// Terms at averaging factor `m` and step `stride` in an unbroken stretch of `samples`.
    pub fn terms(self, samples: u64, m: u64, stride: u64) -> u64 {
        let Some(span) = self.span().checked_mul(m) else { return 0 };
        if m == 0 || span > samples {
            return 0;
        }
        match self {
            Estimator::Allan | Estimator::Hadamard => (samples - span) / stride.max(1) + 1,
            // One more: a window average of the phase uses m points where a difference spans m + 1.
            Estimator::Modified => (samples - span + 1) / stride.max(1) + 1,
            Estimator::Total => samples - 1,
        }
    }

    /// Deviation from the sum of squared terms (sums of phase for the modified one), `None` without a term.
    pub(crate) fn deviation(self, sum: f64, terms: u64, m: u64) -> Option<f64> {
        if terms == 0 || m == 0 {
            return None;
        }
        let m = m as f64;
        let scale = match self {
            Estimator::Allan | Estimator::Total => 2.0 * m * m,
            Estimator::Modified => 2.0 * (m * m) * (m * m),
            Estimator::Hadamard => 6.0 * m * m,
        };
        Some((sum / (scale * terms as f64)).sqrt())
    }
}

/// The classical Allan (`difference = 2`) or Hadamard (`difference = 3`) deviation of unbroken samples with terms that
/// do not overlap: differences of consecutive means of `m` samples. `None` when there is no term.
///
/// The estimate follows SP 1065 equations 10 and 18; deviation in the unit of the samples.
pub fn non_overlapping(samples: &[f64], m: usize, difference: u32) -> Option<DeviationPoint> {
    if m == 0 || !(2..=3).contains(&difference) {
        return None;
    }
    let mut means: Vec<f64> = samples.chunks_exact(m).map(|c| c.iter().sum::<f64>() / m as f64).collect();
    for _ in 1..difference {
        means = means.windows(2).map(|w| w[1] - w[0]).collect();
    }
    let scale = if difference == 2 { 2.0 } else { 6.0 };
    let terms = means.len() as u64;
    (terms > 0).then(|| DeviationPoint {
        m: m as u64,
        terms,
        stride: m as u64,
        deviation: (means.iter().map(|d| d * d).sum::<f64>() / (scale * terms as f64)).sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_counted_as_in_the_textbook() {
        assert_eq!(Estimator::Allan.terms(1000, 1, 1), 999);
        assert_eq!(Estimator::Allan.terms(1000, 500, 1), 1);
        assert_eq!(Estimator::Allan.terms(1000, 501, 1), 0);
        assert_eq!(Estimator::Modified.terms(1000, 8, 1), 978);
        assert_eq!(Estimator::Hadamard.terms(1000, 128, 1), 617);
        assert_eq!(Estimator::Total.terms(1000, 128, 1), 999);
        assert_eq!(Estimator::Allan.terms(u64::MAX, u64::MAX, 1), 0);
    }

    #[test]
    fn non_overlapping_needs_enough_means() {
        assert!(non_overlapping(&[1.0, 2.0, 3.0], 2, 2).is_none());
        assert!(non_overlapping(&[1.0, 2.0], 0, 2).is_none());
        let p = non_overlapping(&[0.0, 0.0, 2.0, 2.0], 2, 2).unwrap();
        assert!((p.deviation - 2.0 / 2f64.sqrt()).abs() < 1e-15 && p.terms == 1);
    }
}
