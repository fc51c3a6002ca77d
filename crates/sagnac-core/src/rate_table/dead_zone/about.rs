//! The noise of the rates about a response with a zone.
//!
//! Where every rate may have a mean of its own, only what differs between visits tells the noise, and half of a test's
//! steps are spent on the means. About the zone that suits the test best there are twice as many. They still hardly tell
//! drift: one strength that fits best is often none where there is some. So every kind of noise beside the white one is
//! weighed over a range of strengths, and each that is likely enough goes into what is drawn to judge a zone.

use super::points::Points;
use super::shape::{Kind, Shape};
use super::widths;
use crate::numeric::reml::{self, Scaled};
use crate::rate_table::design::{Design, is_linearly_independent};
use nalgebra::{DMatrix, DVector};

/// Share of the confidence that white noise alone has before the test.
const WHITE_ALONE: f64 = 0.5;

/// Least share of a further kind of noise in the variance of the rows, over that of the white one; each tried is twice the
/// one before.
const MIN_NOISE_SHARE: f64 = 1e-3;

/// Strengths of a kind that share its confidence before the test.
const PRIOR_STRENGTHS: usize = 14;

/// Strengths of a kind that are tried at most, where drift is stronger.
const MAX_STRENGTHS: usize = 40;

/// Log-likelihood below the best of its kind from which no greater strength is tried.
const MAX_LOG_LIKELIHOOD_LOSS: f64 = 12.0;

/// Share of the confidence of all noises together below which one is left out.
const NEGLIGIBLE_CONFIDENCE: f64 = 1e-3;

/// Share of the confidence below which a noise does not count where a zone is tested.
pub const MIN_COUNTED_CONFIDENCE: f64 = 0.01;

/// Half widths tried, in parts of half the range of the rates.
const WIDTH_COUNT: usize = 40;

/// Noises inside the loop that are tried, in parts of the half width.
const NOISES_PER_HALF_WIDTH: [f64; 5] = [0.35, 0.7, 1.4, 2.8, 5.6];

/// Levels with the noise that is expected.
pub struct Means {
    /// Means about the slope of the design, deg/h.
    pub means: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// The noises that the steps may have.
    pub likely: Vec<NoiseHypothesis>,
    /// The steps as wholes.
    pub steps: StepMeans,
    /// Strength of the white noise where every rate has a mean of its own.
    pub white: f64,
}

/// A noise that the test may have.
pub struct NoiseHypothesis {
    /// Share of the confidence.
    pub share: f64,
    /// Logarithm of its confidence before the test.
    pub before: f64,
    /// Its covariance.
    pub covariance: DMatrix<f64>,
}

/// The steps as wholes, each the mean of its rows.
pub struct StepMeans {
    /// Slope that outputs are taken about.
    pub slope: f64,
    /// Outputs about it, deg/h.
    pub left: DVector<f64>,
    /// Rates, deg/h.
    pub rate: DVector<f64>,
    /// Rates of the levels, deg/h.
    pub levels: DVector<f64>,
    /// Columns of the levels and of the extras.
    pub free: DMatrix<f64>,
    /// Those of the extras alone.
    pub of_extras: Vec<DVector<f64>>,
}

/// Means of the levels; `points` makes means and covariance ready for the search of a zone.
pub fn means(
    design: &Design,
    points: impl Fn(&DVector<f64>, DMatrix<f64>) -> Option<Points>,
) -> Option<Means> {
    let free: Vec<DVector<f64>> = design.of_levels.iter().chain(&design.of_extras).cloned().collect();
    let free = DMatrix::from_columns(&free);
    let levels = design.levels.len();
    let of_levels = |m: &DMatrix<f64>| m.view((0, 0), (levels, levels)).into_owned();
    let white: Vec<DMatrix<f64>> = design.quick.iter().take(1).map(|k| k.1.clone()).collect();
    let mut fit = reml::fit(&design.left, &free, &design.fixed, &white)?;
    let strength = *fit.variance_components.first()?;
    // A zone that is sought with drift in the noise leaves of another what looks like drift: drift has to show about the
    // zone that is found without. Then its own is sought.
    loop {
        let first = fit.variance_components.len() == 1;
        let y = fit.coefficients.rows(0, levels).into_owned();
        let columns = with_zone(design, &points(&y, of_levels(&fit.covariance))?)?;
        let noises = noises(design, &DMatrix::from_columns(&columns), strength)?;
        let none = DMatrix::zeros(free.nrows(), free.nrows());
        let mean = noises.iter().fold(none, |sum, l| sum + &l.covariance * l.share);
        fit = reml::fit(&design.left, &free, &mean, &[])?;
        if !first || noises[0].share > 0.5 {
            let whole = whole(&design.step);
            let of_steps = |l: NoiseHypothesis| NoiseHypothesis {
                covariance: &whole * l.covariance * whole.transpose(),
                ..l
            };
            return Some(Means {
                means: fit.coefficients.rows(0, levels).into_owned(),
                covariance: of_levels(&fit.covariance),
                likely: noises.into_iter().map(of_steps).collect(),
                steps: wholes(design, &whole),
                white: strength,
            });
        }
    }
}

/// The steps as wholes. Extras that differ within steps only are none of theirs.
fn wholes(design: &Design, whole: &DMatrix<f64>) -> StepMeans {
    let mut free: Vec<DVector<f64>> = design.of_levels.iter().map(|c| whole * c).collect();
    for extra in design.of_extras.iter().map(|c| whole * c) {
        if free.len() < whole.nrows() && is_linearly_independent(&extra, &free) {
            free.push(extra);
        }
    }
    StepMeans {
        slope: design.slope,
        left: whole * &design.left,
        rate: whole * DVector::from_column_slice(&design.rate),
        levels: DVector::from_column_slice(&design.levels),
        of_extras: free[design.levels.len()..].to_vec(),
        free: DMatrix::from_columns(&free),
    }
}

/// What makes steps of rows: their means.
fn whole(step: &[usize]) -> DMatrix<f64> {
    let mut present = step.to_vec();
    present.dedup();
    let rows = |s: usize| step.iter().filter(|t| **t == s).count() as f64;
    DMatrix::from_fn(present.len(), step.len(), |i, j| {
        if step[j] == present[i] { 1.0 / rows(present[i]) } else { 0.0 }
    })
}

/// The noises that the rows may have, white noise alone first. The noise about the columns has one further kind at most; the
/// strength of all together is that of the restricted likelihood.
pub fn noises(design: &Design, x: &DMatrix<f64>, white: f64) -> Option<Vec<NoiseHypothesis>> {
    let of_white = &design.quick.first()?.1;
    let white = white.max(1e-3 * design.fixed.trace() / of_white.trace()).max(f64::MIN_POSITIVE);
    let alone = of_white + &design.fixed / white;
    let try_it = |before: f64, further: Option<(&DMatrix<f64>, f64)>| -> Option<Tried> {
        let shape = further.map_or(alone.clone(), |(kind, ratio)| &alone + kind * ratio);
        let Scaled { scale, log_likelihood } = reml::scaled(&design.left, x, &shape)?;
        Some(Tried { before, log: before + log_likelihood, covariance: shape * scale })
    };
    let mut tried = vec![try_it(WHITE_ALONE.ln(), None)?];
    let kinds: Vec<&DMatrix<f64>> =
        design.quick.iter().skip(1).chain(&design.slow).chain(&design.further).map(|k| &k.1).collect();
    let before = ((1.0 - WHITE_ALONE) / (kinds.len() * PRIOR_STRENGTHS) as f64).ln();
    for kind in kinds {
        let unit = MIN_NOISE_SHARE * of_white.trace() / kind.trace().max(f64::MIN_POSITIVE);
        let mut most = f64::NEG_INFINITY;
        for i in 0..MAX_STRENGTHS {
            let Some(found) = try_it(before, Some((kind, unit * 2f64.powi(i as i32)))) else { break };
            let log = found.log;
            tried.push(found);
            most = most.max(log);
            if log < most - MAX_LOG_LIKELIHOOD_LOSS {
                break;
            }
        }
    }
    let most = tried.iter().map(|t| t.log).fold(f64::NEG_INFINITY, f64::max);
    let weight = |t: &Tried| (t.log - most).exp();
    let all: f64 = tried.iter().map(weight).sum();
    let mut first = true;
    tried.retain(|t| std::mem::take(&mut first) || weight(t) > NEGLIGIBLE_CONFIDENCE * all);
    let kept: f64 = tried.iter().map(weight).sum();
    let likely =
        |t: Tried| NoiseHypothesis { share: weight(&t) / kept, before: t.before, covariance: t.covariance };
    Some(tried.into_iter().map(likely).collect())
}

/// A noise of the rows.
struct Tried {
    /// Logarithm of its confidence before the test.
    before: f64,
    /// The same with what the test says of it, but for a constant.
    log: f64,
    /// Its covariance.
    covariance: DMatrix<f64>,
}

/// Columns of a line and of what the zone that suits the rates best takes from it.
fn with_zone(design: &Design, points: &Points) -> Option<Vec<DVector<f64>>> {
    let (_, largest) = points.range();
    let zone = widths::tried(largest, WIDTH_COUNT)
        .skip(1)
        .flat_map(|w| {
            // A change that noise inside the loop rounds off is no drift either.
            let rounded =
                NOISES_PER_HALF_WIDTH.map(|n| Shape { kind: Kind::Rounded, half_width: w, noise: n * w });
            Kind::NOISE_FREE.map(|kind| Shape::clean(kind, w)).into_iter().chain(rounded)
        })
        .map(|shape| points.at_any_centre(shape))
        .min_by(|a, b| a.least.total_cmp(&b.least))?;
    let n = design.rate.len();
    let lost = |r: &f64| zone.shape.of(r - zone.centre) - (r - zone.centre);
    let mut columns = vec![
        DVector::from_element(n, 1.0),
        DVector::from_column_slice(&design.rate),
        DVector::from_iterator(n, design.rate.iter().map(lost)),
    ];
    if !is_linearly_independent(&columns[2], &columns[..2]) {
        columns.pop();
    }
    columns.extend(design.of_extras.iter().cloned());
    Some(columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rate_table::noise::Rows;
    use nalgebra::Cholesky;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// A test that visits eleven rates there and back, five rows each, with noise of N² = 1 and drift of K² = `walk`.
    fn design(walk: f64, seed: u64) -> Design {
        let (rates, rows) = (11, 110);
        let level = |i: usize| {
            let visit = i / 5;
            if visit < rates { visit } else { 2 * rates - 1 - visit }
        };
        let grid = Rows {
            mid_s: (0..rows).map(|i| 30.0 * i as f64 + 15.0).collect(),
            length_s: vec![30.0; rows],
            step: (0..rows).map(|i| i / 5).collect(),
        };
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let even = DVector::from_fn(rows, |_, _| StandardNormal.sample(&mut rng));
        let covariance = grid.white() + grid.random_walk() * walk + DMatrix::identity(rows, rows) * 1e-9;
        let noise = Cholesky::new(covariance).unwrap().l() * even;
        let rate: Vec<f64> = (0..rows).map(|i| 40.0 * (level(i) as f64 - 5.0)).collect();
        Design {
            of_levels: (0..rates)
                .map(|l| DVector::from_fn(rows, |i, _| f64::from(u8::from(level(i) == l))))
                .collect(),
            of_extras: vec![],
            levels: (0..rates).map(|l| 40.0 * (l as f64 - 5.0)).collect(),
            step: grid.step.clone(),
            slope: 1.0,
            left: noise,
            extras: vec![],
            hidden: vec![],
            temperature: 20.0,
            temperature_range: 0.0,
            fixed: DMatrix::identity(rows, rows) * 1e-9,
            quick: vec![("white", grid.white())],
            slow: vec![("flicker", grid.flicker()), ("random_walk", grid.random_walk())],
            further: vec![],
            rate,
        }
    }

    fn shares(walk: f64, seed: u64) -> Vec<f64> {
        let design = design(walk, seed);
        let points = |y: &DVector<f64>, v| {
            let output = DVector::from_fn(y.len(), |i, _| y[i] + design.levels[i]);
            Points::new(design.levels.clone(), output, v, None)
        };
        let found = means(&design, points).unwrap();
        assert_eq!(found.steps.left.len(), 22);
        found.likely.into_iter().map(|l| l.share).collect()
    }

    #[test]
    fn white_noise_alone_is_believed_unless_drift_shows() {
        let without: Vec<Vec<f64>> = (0..20).map(|seed| shares(0.0, seed)).collect();
        assert!(without.iter().all(|s| (s.iter().sum::<f64>() - 1.0).abs() < 1e-9));
        assert!(without.iter().filter(|s| s[0] > 0.5).count() >= 17);
        // Over the hour of the test the walk moves the rate by ten times the noise of a step.
        let with: Vec<Vec<f64>> = (0..20).map(|seed| shares(2e4, seed)).collect();
        assert!(with.iter().all(|s| s[0] < 0.01));
    }
}
