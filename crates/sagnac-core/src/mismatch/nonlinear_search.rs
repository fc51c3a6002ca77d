//! The local search of the numbers that a course is not linear in.

use crate::effect::{Drivers, MeanModel};
use crate::numeric::range::Bounds;

/// Gain that steps to either side must lose for smaller ones to be worth taking: what is left lies within a hundredth of
/// a standard deviation then.
const FLAT: f64 = 1e-4;

/// Numbers of a shape that are searched over. One that is whole has few values: it counts in the p-value alone.
pub fn free_numbers(course: &dyn MeanModel, bounds: &[Bounds]) -> usize {
    let free = |(i, b): (usize, &Bounds)| b.width() > 0.0 && !course.whole().contains(&i);
    bounds.iter().enumerate().filter(|b| free(*b)).count()
}

/// First steps of a local search: none where a number is whole.
pub fn first_steps(course: &dyn MeanModel, drivers: &Drivers) -> Vec<Option<f64>> {
    let steps = course.steps(drivers);
    let numbers = course.bounds(drivers).len();
    (0..numbers)
        .map(|i| if course.whole().contains(&i) { Some(0.0) } else { steps.get(i).copied() })
        .collect()
}

/// Improves a shape by steps along each of its numbers, on a logarithmic scale where its bounds are positive and far
/// apart, with ever smaller steps until they tell nothing more.
///
/// `first` are the first steps, on that scale; empty: by the bounds.
pub fn refine(
    start: &[f64],
    bounds: &[Bounds],
    first: &[Option<f64>],
    evaluations: usize,
    gain: impl Fn(&[f64]) -> f64,
) -> (Vec<f64>, f64) {
    let logarithmic: Vec<bool> = bounds.iter().map(|b| b.low > 0.0 && b.high / b.low > 20.0).collect();
    let to = |i: usize, x: f64| if logarithmic[i] { x.max(1e-300).ln() } else { x };
    let from = |i: usize, u: f64| if logarithmic[i] { u.exp() } else { u };
    let mut at = start.to_vec();
    for (x, bounds) in at.iter_mut().zip(bounds) {
        *x = bounds.clamp(*x);
    }
    let mut best = gain(&at);
    let mut used = 1;
    let mut steps: Vec<f64> = (0..at.len())
        .map(|i| {
            let width = to(i, bounds[i].high) - to(i, bounds[i].low);
            if let Some(Some(step)) = first.get(i) {
                return step.min(width);
            }
            if logarithmic[i] { 0.35f64.min(width) } else { (0.01 * width).max(0.0) }
        })
        .collect();
    let finest: Vec<f64> = steps.iter().map(|s| s * 1e-5).collect();
    while used < evaluations && steps.iter().zip(&finest).any(|(s, f)| *s > *f) {
        let (mut moved, mut flat) = (false, true);
        for i in 0..at.len() {
            if steps[i] <= 0.0 {
                continue;
            }
            let here = to(i, at[i]);
            let mut sides = [f64::NEG_INFINITY; 2];
            for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
                let mut next = at.clone();
                next[i] = bounds[i].clamp(from(i, here + sign * steps[i]));
                if next[i] == at[i] {
                    continue;
                }
                let got = gain(&next);
                used += 1;
                sides[side] = got;
                flat &= best - got < FLAT;
                if got > best {
                    (best, at) = (got, next);
                    moved = true;
                    break;
                }
            }
            if !moved && sides.iter().all(|s| s.is_finite()) {
                // Three points around the best: the top of their parabola.
                let curve = sides[0] + sides[1] - 2.0 * best;
                if curve < 0.0 {
                    let mut next = at.clone();
                    let shift = 0.5 * steps[i] * (sides[1] - sides[0]) / curve;
                    next[i] = bounds[i].clamp(from(i, here + shift));
                    let got = gain(&next);
                    used += 1;
                    if got > best {
                        (best, at) = (got, next);
                    }
                }
            }
        }
        if !moved && flat {
            break;
        }
        if !moved {
            steps.iter_mut().for_each(|s| *s *= 0.3);
        }
    }
    (at, best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_top_of_a_hill_is_reached_within_its_bounds() {
        let bounds = [Bounds::new(0.1, 1000.0), Bounds::new(-1.0, 1.0)];
        let hill = |x: &[f64]| -50.0 * ((x[0] / 30.0).ln().powi(2) + (x[1] - 0.4).powi(2));
        let (at, gain) = refine(&[5.0, -0.5], &bounds, &[], 400, hill);
        assert!(
            (at[0] / 30.0 - 1.0).abs() < 2e-3 && (at[1] - 0.4).abs() < 2e-3 && gain > -1e-3,
            "{at:?} {gain}"
        );
        // A top outside is left for the end that is nearest; a number whose first step is 0 stays.
        let (at, _) =
            refine(&[0.0, 0.7], &[Bounds::new(-1.0, 1.0); 2], &[None, Some(0.0)], 400, |x| x[0] - x[1]);
        assert!((at[0] - 1.0).abs() < 1e-6 && at[1] == 0.7, "{at:?}");
    }
}
