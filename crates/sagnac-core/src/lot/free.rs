//! Bounds that need no law of the population: order statistics, and the extrapolation of Hanson and Koopmans.

use super::tolerance::Promise;
use crate::estimate::normal_quantile;
use crate::numeric::optimize::bisect;
use statrs::function::beta::beta_reg;

/// Points of the quadrature over the ratio of two order statistics, and halvings of the search for a factor.
const FINE_SEARCH: (u32, usize) = (400, 60);
/// Points and halvings, as in [`FINE_SEARCH`], where factors are only compared.
const COARSE_SEARCH: (u32, usize) = (60, 20);
/// Ranks that are compared.
const COMPARED_RANKS: usize = 12;

/// The example of STAT-17 in CMH-17: 18 strengths.
#[cfg(test)]
pub(super) const STAT_17: [f64; 18] = [
    137.4438, 139.5395, 150.89, 141.4474, 141.8203, 151.8821, 143.9245, 132.9732, 136.6419, 138.1723,
    148.7668, 143.283, 143.5429, 141.7023, 137.4732, 152.338, 144.1589, 128.5218,
];

/// How many units it takes until the largest of them bounds the proportion with the confidence, whatever the law. `None`
/// outside of probabilities.
pub fn units_for_largest(promise: Promise) -> Option<usize> {
    let probability = |p: f64| p > 0.0 && p < 1.0;
    if !(probability(promise.proportion) && probability(promise.confidence)) {
        return None;
    }
    // A whole number that rounding lifted by a hair stays itself.
    let n = (1.0 - promise.confidence).ln() / promise.proportion.ln();
    Some((n - 1e-9).ceil().max(1.0) as usize)
}

/// Which of `n` values in descending order, counted from 1 for the largest, bounds the proportion from above with the
/// confidence, whatever the law: the lowest one that does. `None` where not even the largest does.
pub fn bounding_rank(n: usize, promise: Promise) -> Option<usize> {
    // The r-th largest is above the quantile where fewer than n − r + 1 values are below it: a binomial tail.
    let holds = |r: usize| {
        let (above, below) = (r as f64, (n + 1 - r) as f64);
        beta_reg(above, below, 1.0 - promise.proportion) >= promise.confidence
    };
    (1..=n).take_while(|r| holds(*r)).last()
}

/// The upper bound of Hanson and Koopmans from values in ascending order, on a scale on which the upper tail falls at least as
/// fast as an exponential one: low + factor·(largest − low), with the `low` whose bound a normal population would have (Vangel
/// 1994). `None` below two values.
pub fn hanson_koopmans_upper(ascending: &[f64], promise: Promise) -> Option<f64> {
    let n = ascending.len();
    let largest = *ascending.last()?;
    let rank = best_rank(n, promise)?;
    let factor = hanson_koopmans_factor(n, rank, promise)?;
    let low = *ascending.get(n.checked_sub(rank)?)?;
    Some(low + factor * (largest - low))
}

/// The factor of the bound of Hanson and Koopmans from the largest of `n` values and the one at `rank` below it, which is 1 for
/// the largest. `None` for a rank that does not stand below the largest.
pub fn hanson_koopmans_factor(n: usize, rank: usize, promise: Promise) -> Option<f64> {
    factor(n, rank, promise, FINE_SEARCH)
}

fn factor(n: usize, rank: usize, promise: Promise, (points, halvings): (u32, usize)) -> Option<f64> {
    if rank < 2 || rank > n || units_for_largest(promise).is_none() {
        return None;
    }
    // In the exponential case the share beyond the j-th value is Beta(j, n + 1 − j), and that beyond the largest the share
    // beyond the j-th times a Beta(1, j − 1): its quantile at v is 1 − (1 − v)^(1/(j − 1)).
    let j = rank as f64;
    let share = 1.0 - promise.proportion;
    let confidence = |factor: f64| {
        let total: f64 = (0..points)
            .map(|i| (f64::from(i) + 0.5) / f64::from(points))
            .map(|v| {
                // Points are drawn to both ends, where the integrand is steep.
                let (at, weight) = (v * v * (3.0 - 2.0 * v), 6.0 * v * (1.0 - v));
                let ratio = -((-at).ln_1p() / (j - 1.0)).exp_m1();
                let most = (share * ratio.powf(-factor)).min(1.0);
                weight * beta_reg(j, (n + 1 - rank) as f64, most)
            })
            .sum();
        total / f64::from(points)
    };
    let below = |factor: f64| confidence(factor) < promise.confidence;
    let mut high = 2.0;
    while below(high) && high < 1e6 {
        high *= 2.0;
    }
    Some(if below(1.0) { bisect(1.0, high, halvings, below).middle() } else { 1.0 })
}

/// The rank whose bound comes closest to the quantile of a normal population.
fn best_rank(n: usize, promise: Promise) -> Option<usize> {
    let quantile = normal_quantile(promise.proportion);
    let score = |from_top: f64| normal_quantile((n as f64 + 1.0 - from_top - 0.375) / (n as f64 + 0.25));
    let miss = |rank: usize| {
        let factor = factor(n, rank, promise, COARSE_SEARCH)?;
        let low = score(rank as f64);
        Some((low + factor * (score(1.0) - low) - quantile).abs())
    };
    (2..=n)
        .step_by((n / COMPARED_RANKS).max(1))
        .filter_map(|rank| miss(rank).map(|miss| (rank, miss)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(rank, _)| rank)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::order::SortNumbers;

    const fn promise(proportion: f64, confidence: f64) -> Promise {
        Promise { proportion, confidence }
    }

    #[test]
    fn sizes_for_the_largest_are_the_published_ones() {
        for (proportion, confidence, n) in [
            (0.90, 0.90, 22),
            (0.90, 0.95, 29),
            (0.95, 0.95, 59),
            (0.99, 0.90, 230),
            (0.99, 0.95, 299),
            (0.9973, 0.95, 1109),
        ] {
            let promise = promise(proportion, confidence);
            assert_eq!(units_for_largest(promise), Some(n));
            assert_eq!(bounding_rank(n, promise), Some(1));
            assert_eq!(bounding_rank(n - 1, promise), None);
        }
        assert_eq!(units_for_largest(promise(1.0, 0.9)), None);
        // CMH-17, table 8.5.12: of 93 values the second does for 95/95.
        assert_eq!(bounding_rank(93, promise(0.95, 0.95)), Some(2));
        assert_eq!(bounding_rank(92, promise(0.95, 0.95)), Some(1));
    }

    #[test]
    fn hanson_koopmans_gives_the_bounds_of_the_published_example() {
        let mut values: Vec<f64> = STAT_17.iter().map(|v| -v.ln()).collect();
        values.sort_ascending();
        let (largest, n) = (values[17], values.len());
        // STAT-17 takes the ninth value for 90/95 and the last for 99/95.
        for (proportion, rank, bound) in [(0.90, 9, 124.156), (0.99, 18, 99.651)] {
            let factor = hanson_koopmans_factor(n, rank, promise(proportion, 0.95)).unwrap();
            let low = values[n - rank];
            let found = (-(low + factor * (largest - low))).exp();
            assert!((found - bound).abs() < 0.02, "{found} is not {bound}: factor {factor}");
        }
    }

    #[test]
    fn a_bound_without_values_is_none() {
        assert_eq!(hanson_koopmans_upper(&[], promise(0.9, 0.9)), None);
        assert_eq!(hanson_koopmans_upper(&[1.0], promise(0.9, 0.9)), None);
        let bound = hanson_koopmans_upper(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], promise(0.95, 0.95)).unwrap();
        assert!(bound > 6.0, "{bound}");
    }
}
