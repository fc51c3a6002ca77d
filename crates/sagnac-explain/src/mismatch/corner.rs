//! The corner of a law, which in physics is round.
//!
//! A formula bends at one value of its driver, a unit over a small range about it. There the discrepancy of the law is large and stands in
//! the law's own driver: samples nearest to the corner are set aside as far as the residual is larger than its noise, and so neither tests
//! nor other effects see them.

use crate::numeric::order::SortByNumber;

/// Samples of the group nearest to the corner; each further one has twice as many.
const FIRST_GROUP: usize = 16;
/// Mean square over that of the noise from which the nearest group is no noise. By chance it is as large in one of ten million.
const MIN_CORNER_RATIO: f64 = 4.0;
/// The same from which a further group still belongs to the corner.
const MIN_GROUP_RATIO: f64 = 1.5;
/// Largest share of a record that its corners may be.
const MAX_CORNER_SHARE: f64 = 0.1;

/// Samples that may still be set aside about corners, of a record of so many of which some are.
pub(super) fn most_about_corners(samples: usize, aside: usize) -> usize {
    ((MAX_CORNER_SHARE * samples as f64) as usize).saturating_sub(aside)
}

/// Median of χ² with one degree of freedom.
const MEDIAN_SQUARE: f64 = 0.454_936;

/// Samples about a corner in which a residual is larger than its noise, at most so many; `distance` is that of each sample from the
/// corner, in the law's own driver.
pub(super) fn round_corner(distance: &[f64], residual: &[f64], usable: &[bool], most: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..residual.len().min(distance.len()))
        .filter(|i| usable.get(*i) == Some(&true) && distance[*i].is_finite())
        .collect();
    let middle = median(order.iter().map(|i| residual[*i]).collect());
    let square = |i: &usize| (residual[*i] - middle).powi(2);
    // The median square, which what bends about a corner hardly moves.
    let noise = median(order.iter().map(square).collect()) / MEDIAN_SQUARE;
    order.sort_ascending_by(|i| distance[*i].abs());
    let most = most.min(order.len());
    let (mut inside, mut group, mut least) = (0, FIRST_GROUP, MIN_CORNER_RATIO);
    while inside < most {
        let near = &order[inside..(inside + group).min(most)];
        let mean = near.iter().map(square).sum::<f64>() / near.len() as f64;
        if mean.is_nan() || mean <= least * noise {
            break;
        }
        inside += near.len();
        (group, least) = (2 * group, MIN_GROUP_RATIO);
    }
    order.truncate(inside);
    order
}

/// The middle value; 0 of none.
fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng as _;
    use rand_distr::{Distribution as _, StandardNormal};

    #[test]
    fn a_round_corner_is_set_aside_as_far_as_it_shows_and_a_sharp_one_is_not() {
        let n = 4000;
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(5);
        let distance: Vec<f64> = (0..n).map(|i| f64::from(i * 1597 % n) / f64::from(n) - 0.2).collect();
        let noise: Vec<f64> = distance.iter().map(|_| StandardNormal.sample(&mut rng)).collect();
        let usable = vec![true; n as usize];
        assert!(round_corner(&distance, &noise, &usable, 400).is_empty());
        // 300 deviations at the corner, e-folding in 0.004: below one deviation from 0.023.
        let bent: Vec<f64> =
            distance.iter().zip(&noise).map(|(d, e)| e + 300.0 * (-d.abs() / 0.004).exp()).collect();
        let aside = round_corner(&distance, &bent, &usable, 400);
        let reach = aside.iter().map(|i| distance[*i].abs()).fold(0.0, f64::max);
        assert!((0.015..0.05).contains(&reach), "{reach}");
        // Samples that do not count are not looked at.
        assert!(round_corner(&distance, &bent, &vec![false; n as usize], 400).is_empty());
        // A residual that is large everywhere has no corner, and one that is large in a third is cut.
        let large: Vec<f64> = distance.iter().map(|d| if *d < 0.1 { 9.0 } else { 0.1 }).collect();
        assert_eq!(round_corner(&distance, &large, &usable, 400).len(), 400);
        assert_eq!(
            (most_about_corners(4000, 0), most_about_corners(4000, 300), most_about_corners(4000, 500)),
            (400, 100, 0)
        );
        assert!(round_corner(&distance, &vec![9.0; n as usize], &usable, 400).is_empty());
    }
}
