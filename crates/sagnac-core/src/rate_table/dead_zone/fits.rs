//! Whether a form of response fits: a test of the means of the rates by noise that no form can enlarge.
//!
//! The noise about a response that does not fit holds what the response leaves. So the noise is taken here from what the
//! rows leave of a mean of their own for every rate, of all strengths that the test allows, and each says how likely the
//! response would leave as much by chance.

use super::about::{MIN_COUNTED_CONFIDENCE, NoiseHypothesis, noises};
use super::points::Points;
use super::shape::Shape;
use crate::estimate::normal_probability;
use crate::rate_table::design::Design;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Probability of what a form leaves by chance below which it does not fit.
pub const FITS_FROM: f64 = 0.01;

/// One of the noises.
struct Noise {
    share: f64,
    points: Points,
}

/// The means of the rates in all noises.
pub struct Fits {
    noises: Vec<Noise>,
    /// Rows beyond those that the means of the rates take.
    dof: f64,
    /// Means, and what is known of the slope.
    told: f64,
}

impl Fits {
    /// `strength` is that of the white noise, and `points` makes means and covariance ready.
    pub fn new(
        design: &Design,
        strength: f64,
        slope_known: bool,
        points: impl Fn(&DVector<f64>, DMatrix<f64>) -> Option<Points>,
    ) -> Option<Fits> {
        let columns: Vec<DVector<f64>> = design.of_levels.iter().chain(&design.of_extras).cloned().collect();
        let free = DMatrix::from_columns(&columns);
        let levels = design.levels.len();
        let of = |likely: NoiseHypothesis| -> Option<Noise> {
            let weighted = Cholesky::new(likely.covariance)?.solve(&free);
            let covariance = Cholesky::new(free.transpose() * &weighted)?.inverse();
            let means = (&covariance * weighted.transpose() * &design.left).rows(0, levels).into_owned();
            let of_levels = covariance.view((0, 0), (levels, levels)).into_owned();
            Some(Noise { share: likely.share, points: points(&means, of_levels)? })
        };
        let likely = noises(design, &free, strength)?;
        Some(Fits {
            noises: likely
                .into_iter()
                .filter(|l| l.share > MIN_COUNTED_CONFIDENCE)
                .map(of)
                .collect::<Option<_>>()?,
            dof: (free.nrows() - free.ncols()) as f64,
            told: levels as f64 + if slope_known { 1.0 } else { 0.0 },
        })
    }

    /// Probability that chance leaves as much of a line.
    pub fn of_line(&self) -> f64 {
        self.chance(2.0, |p| p.cost(|x| x).0)
    }

    /// The same of a zone about the centre that suits it best, with so many unknowns beside slope and offset.
    pub fn of_zone(&self, shape: Shape, centre: f64, unknowns: f64) -> f64 {
        self.chance(2.0 + unknowns, |p| p.at_any_centre(shape).least.min(p.cost(|x| shape.of(x - centre)).0))
    }

    fn chance(&self, unknowns: f64, cost: impl Fn(&Points) -> f64) -> f64 {
        let free = self.told - unknowns;
        if free < 1.0 {
            return 1.0;
        }
        let all: f64 = self.noises.iter().map(|n| n.share).sum();
        let weighed =
            self.noises.iter().map(|n| n.share * ratio_tail(cost(&n.points) / free, free, self.dof));
        weighed.sum::<f64>() / all.max(f64::MIN_POSITIVE)
    }
}

/// Upper tail of Fisher's ratio of variances, by the cube root of each (Paulson 1942): within a few per cent of itself
/// from five degrees of freedom on.
fn ratio_tail(ratio: f64, above: f64, below: f64) -> f64 {
    if ratio.is_nan() {
        return 1.0;
    }
    let (a, b) = (2.0 / (9.0 * above), 2.0 / (9.0 * below.max(1.0)));
    let root = ratio.max(0.0).cbrt();
    normal_probability(-((1.0 - b) * root - (1.0 - a)) / (b * root * root + a).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tail_is_that_of_the_tables() {
        // F(0.95; 10, 20) = 2.348, F(0.99; 17, 100) = 2.14, F(0.99; 5, 10) = 5.64.
        assert!((ratio_tail(2.348, 10.0, 20.0) - 0.05).abs() < 2e-3);
        assert!((ratio_tail(2.14, 17.0, 100.0) - 0.01).abs() < 1e-3);
        assert!((ratio_tail(5.64, 5.0, 10.0) - 0.01).abs() < 1e-3);
    }
}
