//! Whether a line would make a zone as likely by chance.
//!
//! The test statistic is the ratio of the likelihood of a zone to that of a line, each averaged over the noises that the test
//! may have. In every draw of a line the steps tell the noise anew: what looks like a zone where drift is believed to be
//! none does not where the draw shows its drift.

use super::about::{MIN_COUNTED_CONFIDENCE, Means};
use super::points::{Points, Ratios};
use crate::numeric::cholesky::inverse;
use crate::numeric::cholesky::log_determinant;
use nalgebra::{Cholesky, DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::cell::OnceCell;

/// Probability of such a ratio by chance above which a zone is not claimed: with a slope that is free, and with one that is
/// known. It is a mean over the noises that the test may have, and with drift that hardly shows more zones come about by
/// chance: up to four times as many where the slope is known, since drift along the rates is a slope, and a zone is all that a
/// known slope lets it be taken for.
const CLAIMED_BELOW: [f64; 2] = [0.01, 0.0025];

/// Gain of −2 ln L above which no draws are needed.
const CERTAIN_GAIN: f64 = 40.0;

/// Tests without a zone that have to reach the ratio for a zone not to be claimed.
const REFUTING_EXCEEDANCES: usize = 10;

/// One of the noises that the steps may have.
struct Noise<'a> {
    /// Share of the confidence, up to and with this one.
    below: f64,
    /// Makes draws that are white and one those of the noise of the steps.
    factor: DMatrix<f64>,
    /// Twice the logarithm of the confidence before the test, less the determinants.
    before: f64,
    /// The quadratic form of what a line leaves of the steps.
    left: DMatrix<f64>,
    /// Means of the levels from the steps.
    levels: DMatrix<f64>,
    points: Points,
    /// The line that fits the test best, over its standard uncertainties.
    line: DVector<f64>,
    widths: &'a [f64],
    /// Kept once they are asked for: most draws need few of them.
    ratios: OnceCell<Option<Ratios>>,
}

impl Noise<'_> {
    fn ratio(&self, data: &DVector<f64>) -> f64 {
        let ratios = self.ratios.get_or_init(|| self.points.ratios(self.widths));
        ratios.as_ref().map_or(0.0, |r| r.mean(data))
    }
}

/// Whether the test shows a zone that gains so much over a line. `slope_known` is the relative uncertainty of the slope,
/// where it is known to be one, and `points` makes means of levels and their covariance ready.
pub fn shows_a_zone(
    about: &Means,
    slope_known: Option<f64>,
    points: impl Fn(&DVector<f64>, DMatrix<f64>) -> Option<Points>,
    gain: f64,
    widths: &[f64],
) -> Option<bool> {
    if gain > CERTAIN_GAIN {
        return Some(true);
    }
    let noises = noises(about, slope_known, points, widths)?;
    let steps = &about.steps;
    let m = steps.left.len();
    // Outputs about the slope that is known, or about any.
    let about_known = slope_known.map_or(0.0, |_| steps.slope - 1.0);
    let observed = {
        let apart = DVector::from_fn(m, |i, _| steps.left[i] + about_known * steps.rate[i]);
        averaged(&noises, &apart, |k| {
            let known = slope_known.map_or(0.0, |u| 1.0 / u);
            k.points.whitened(&(&k.levels * &steps.left + &steps.levels * steps.slope), known)
        })
    };
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(0x7a6f_6e65);
    let below = CLAIMED_BELOW[usize::from(slope_known.is_some())];
    let mut as_large = 0;
    for _ in 0..(REFUTING_EXCEEDANCES as f64 / below) as usize {
        let at: f64 = rng.random();
        let noise = noises.iter().find(|k| at < k.below).or(noises.last())?;
        let even = DVector::from_fn(m, |_, _| StandardNormal.sample(&mut rng));
        let drawn = &noise.factor * even;
        let of_slope: f64 = if slope_known.is_some() { StandardNormal.sample(&mut rng) } else { 0.0 };
        let error = of_slope * slope_known.unwrap_or(0.0);
        let apart = DVector::from_fn(m, |i, _| drawn[i] - error * steps.rate[i]);
        let ratio =
            averaged(&noises, &apart, |k| &k.line + k.points.whitened(&(&k.levels * &drawn), of_slope));
        as_large += usize::from(ratio >= observed);
        if as_large >= REFUTING_EXCEEDANCES {
            return Some(false);
        }
    }
    Some(true)
}

/// The mean ratio over the noises, by what the steps apart from the line say of each.
fn averaged(noises: &[Noise], apart: &DVector<f64>, data: impl Fn(&Noise) -> DVector<f64>) -> f64 {
    let twice: Vec<f64> = noises.iter().map(|k| k.before - apart.dot(&(&k.left * apart))).collect();
    let most = twice.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let all: f64 = twice.iter().map(|t| (0.5 * (t - most)).exp()).sum();
    let shares = twice.iter().map(|t| (0.5 * (t - most)).exp() / all);
    noises
        .iter()
        .zip(shares)
        .filter(|(_, p)| *p > MIN_COUNTED_CONFIDENCE)
        .map(|(k, p)| p * k.ratio(&data(k)))
        .sum()
}

fn noises<'a>(
    about: &Means,
    slope_known: Option<f64>,
    points: impl Fn(&DVector<f64>, DMatrix<f64>) -> Option<Points>,
    widths: &'a [f64],
) -> Option<Vec<Noise<'a>>> {
    let steps = &about.steps;
    let m = steps.left.len();
    let mut of_line = vec![DVector::from_element(m, 1.0)];
    if slope_known.is_none() {
        of_line.push(steps.rate.clone());
    }
    of_line.extend(steps.of_extras.iter().cloned());
    let of_line = DMatrix::from_columns(&of_line);
    let mut below = 0.0;
    about
        .likely
        .iter()
        .map(|likely| {
            let noise = &likely.covariance;
            let factor = Cholesky::new(noise.clone())?;
            let weighted = factor.solve(&steps.free);
            let covariance = Cholesky::new(steps.free.transpose() * &weighted)?.inverse();
            let n = steps.levels.len();
            let levels = (&covariance * weighted.transpose()).rows(0, n).into_owned();
            let points = points(&(&levels * &steps.left), covariance.view((0, 0), (n, n)).into_owned())?;
            let slope = slope_known.unwrap_or(0.0);
            let with_slope = Cholesky::new(noise + &steps.rate * steps.rate.transpose() * (slope * slope))?;
            let weighted = with_slope.solve(&of_line);
            let normal = Cholesky::new(of_line.transpose() * &weighted)?;
            let left = inverse(&with_slope) - &weighted * normal.solve(&weighted.transpose());
            below += likely.share;
            Some(Noise {
                below,
                factor: factor.l(),
                before: 2.0 * likely.before - log_determinant(&with_slope) - log_determinant(&normal),
                left,
                levels,
                line: points.line()?,
                points,
                widths,
                ratios: OnceCell::new(),
            })
        })
        .collect()
}
