//! Root finding and optimisation.
//!
//! | what | functions |
//! |---|---|
//! | one variable | [`bisect`], [`golden_section`], [`golden_section_maximum`], [`parabolic_peak`] |
//! | a few variables without derivatives | [`coordinate_ascent`] |
//! | the step of a Newton ascent within bounds | [`nonnegative_quadratic`], [`bounded_quadratic`] |
//! | how long that step may be | [`shortened_steps`], [`Damping`] |
//!
//! A likelihood brings its derivatives and the scale of its variables; the loop around them, a few lines with a stopping
//! rule that was calibrated for it, stays with it.

use super::range::Bounds;
use nalgebra::{DMatrix, DVector};
use std::ops::ControlFlow;

/// What a bisection leaves: two values with the root between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bracket {
    /// Where the condition holds.
    pub inside: f64,
    /// Where it does not.
    pub outside: f64,
}

impl Bracket {
    /// The value in the middle.
    pub fn middle(self) -> f64 {
        0.5 * (self.inside + self.outside)
    }
}

/// Bisection: halves the span between `inside`, where `holds` is true, and `outside`, where it is false, `times` times or
/// until no number lies between. Gives the span that is left.
pub fn bisect(mut inside: f64, mut outside: f64, times: usize, holds: impl Fn(f64) -> bool) -> Bracket {
    for _ in 0..times {
        let middle = 0.5 * (inside + outside);
        if middle == inside || middle == outside {
            break;
        }
        if holds(middle) { inside = middle } else { outside = middle }
    }
    Bracket { inside, outside }
}

/// The argument of the minimum of a function with a single minimum between `low` and `high`, by `times` golden sections
/// (Kiefer 1953): each leaves 0.618 of the span.
pub fn golden_section(mut low: f64, mut high: f64, times: usize, of: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN_SECTION_RATIO: f64 = 0.618_033_988_749_895;
    for _ in 0..times {
        let (a, b) = (high - GOLDEN_SECTION_RATIO * (high - low), low + GOLDEN_SECTION_RATIO * (high - low));
        if of(a) < of(b) { high = b } else { low = a }
    }
    0.5 * (low + high)
}

/// Position of the peak of the parabola through `values[at]` and its two neighbours, in grid steps from `at`, between −0.5
/// and 0.5. 0 where a neighbour is missing or the three points do not bend downwards.
pub fn parabolic_peak(values: &[f64], at: usize) -> f64 {
    let (Some(here), Some(after)) = (values.get(at), values.get(at + 1)) else { return 0.0 };
    let Some(before) = at.checked_sub(1).and_then(|i| values.get(i)) else { return 0.0 };
    let curve = before + after - 2.0 * here;
    if curve < 0.0 { (0.5 * (before - after) / curve).clamp(-0.5, 0.5) } else { 0.0 }
}

/// Tries steps of length 1 and then ever shorter ones, at most `times`: `shorter` gives the next length. Gives what the first
/// acceptable one gave, and the last length.
pub fn shortened_steps<T>(
    times: usize,
    shorter: impl Fn(f64) -> f64,
    mut acceptable: impl FnMut(f64) -> Option<T>,
) -> (Option<T>, f64) {
    let mut step = 1.0;
    for _ in 0..times {
        if let Some(accepted) = acceptable(step) {
            return (Some(accepted), step);
        }
        step = shorter(step);
    }
    (None, step)
}

/// Damping of Newton steps, raised until a step is accepted and eased after (Levenberg 1944, Marquardt 1963).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damping {
    /// Damping of the next step, as a share of the curvature.
    pub value: f64,
    /// Factor after an accepted step, below 1.
    pub eased_by: f64,
    /// Least damping after that.
    pub least: f64,
    /// Factor after a refused step, above 1.
    pub raised_by: f64,
    /// Least damping after that.
    pub least_raised: f64,
}

impl Damping {
    /// Tries steps with ever more damping, at most `times`. `trial` takes the damping and breaks with an accepted step, or
    /// with `None` to give up.
    pub fn search<T>(
        &mut self,
        times: usize,
        mut trial: impl FnMut(f64) -> ControlFlow<Option<T>>,
    ) -> Option<T> {
        for _ in 0..times {
            if let ControlFlow::Break(end) = trial(self.value) {
                if end.is_some() {
                    self.value = (self.value * self.eased_by).max(self.least);
                }
                return end;
            }
            self.value = (self.value * self.raised_by).max(self.least_raised);
        }
        None
    }
}

/// Climbs along one coordinate at a time: every coordinate is multiplied and divided by a factor, the last move that gains is made
/// while there is one (at most `moves` for each of `factors`), then the next factor is tried. `value` is `None` where a
/// point is not allowed. Coordinates stay between `low` and `high`.
pub fn coordinate_ascent(
    start: (f64, Vec<f64>),
    (low, high): (f64, f64),
    (factors, moves): (&[f64], usize),
    value: impl Fn(&[f64]) -> Option<f64>,
) -> (f64, Vec<f64>) {
    let mut best = start;
    for factor in factors {
        for _ in 0..moves {
            let steps = (0..best.1.len()).flat_map(|i| [(i, *factor), (i, 1.0 / factor)]);
            let tried = steps.filter_map(|(i, f)| {
                let mut next = best.1.clone();
                next[i] = (next[i] * f).clamp(low, high);
                Some((value(&next).filter(|v| *v > best.0)?, next))
            });
            let Some(better) = tried.last() else { break };
            best = better;
        }
    }
    best
}

/// As [`golden_section`] for a maximum, with one new value of the function a section: for functions that take long.
pub fn golden_section_maximum(low: f64, high: f64, times: usize, of: impl Fn(f64) -> f64) -> f64 {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (low, high);
    let (mut x, mut y) = (b - golden * (b - a), a + golden * (b - a));
    let (mut at_x, mut at_y) = (of(x), of(y));
    for _ in 0..times {
        if at_x > at_y {
            (b, y, at_y) = (y, x, at_x);
            x = b - golden * (b - a);
            at_x = of(x);
        } else {
            (a, x, at_x) = (x, y, at_y);
            y = a + golden * (b - a);
            at_y = of(y);
        }
    }
    0.5 * (a + b)
}

/// Pattern search for a maximum (Hooke and Jeeves 1961): steps up and down along each coordinate, the top of the parabola
/// through three points where neither gains, and ever smaller steps, until steps to either side lose less than `flat` or
/// the `evaluations` are used up. Gives the point reached and its value.
///
/// A coordinate with positive bounds that are more than a factor of 20 apart is searched on a logarithmic scale. `first` has
/// the first steps, on that scale; `None`, or none: by the bounds; 0: the coordinate stays.
pub fn pattern_search(
    start: &[f64],
    bounds: &[Bounds],
    first: &[Option<f64>],
    (evaluations, flat): (usize, f64),
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
        let (mut moved, mut is_flat) = (false, true);
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
                is_flat &= best - got < flat;
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
        if !moved && is_flat {
            break;
        }
        if !moved {
            steps.iter_mut().for_each(|s| *s *= 0.3);
        }
    }
    (at, best)
}

/// The x ≥ 0 that minimises ½xᵀHx − bᵀx, with x = 0 where not `free`: every active set is tried and the best feasible
/// one kept, so that the answer is exact. For a few unknowns only: 2^N sets.
pub fn nonnegative_quadratic<const N: usize>(h: &[[f64; N]; N], b: &[f64; N], free: &[bool; N]) -> [f64; N] {
    let mut best = ([0.0; N], 0.0);
    for set in 1u32..(1 << N) {
        let indices: Vec<usize> = (0..N).filter(|i| set >> i & 1 == 1).collect();
        if indices.iter().any(|&i| !free[i] || h[i][i] <= 0.0) {
            continue;
        }
        let scale: Vec<f64> = indices.iter().map(|&i| h[i][i].sqrt()).collect();
        let n = indices.len();
        let matrix = DMatrix::from_fn(n, n, |i, j| h[indices[i]][indices[j]] / (scale[i] * scale[j]));
        let right = DVector::from_fn(n, |i, _| b[indices[i]] / scale[i]);
        let Some(solution) = matrix.cholesky().map(|c| c.solve(&right)) else { continue };
        if solution.iter().any(|x| *x < 0.0 || !x.is_finite()) {
            continue;
        }
        let value = -0.5 * solution.dot(&right);
        if value < best.1 {
            let mut x = [0.0; N];
            for (i, &index) in indices.iter().enumerate() {
                x[index] = solution[i] / scale[i];
            }
            best = (x, value);
        }
    }
    best.0
}

/// The δ ≥ `lower` that minimises ½δᵀHδ − gᵀδ for a positive semidefinite H: one bounded step of Newton's method. An active
/// set that bounds the entry furthest outside and lets go of one whose gradient points inside. Entries without curvature
/// stay at 0, and all of them where H has no Cholesky factor.
/// Source: Lawson and Hanson, Solving Least Squares Problems (1974), chapter 23.
pub fn bounded_quadratic(h: &DMatrix<f64>, g: &DVector<f64>, lower: &[f64]) -> DVector<f64> {
    let p = g.len();
    let scale: Vec<f64> = (0..p).map(|i| h[(i, i)].max(0.0).sqrt()).collect();
    let mut bound: Vec<bool> = scale.iter().map(|s| *s <= 0.0 || !s.is_finite()).collect();
    let dead = bound.clone();
    let mut delta = DVector::zeros(p);
    for _ in 0..4 * p + 4 {
        for i in 0..p {
            if bound[i] {
                delta[i] = if dead[i] { 0.0 } else { lower[i] };
            }
        }
        let free: Vec<usize> = (0..p).filter(|i| !bound[*i]).collect();
        if !free.is_empty() {
            let n = free.len();
            let matrix = DMatrix::from_fn(n, n, |a, b| {
                let ridge = if a == b { 1e-9 } else { 0.0 };
                h[(free[a], free[b])] / (scale[free[a]] * scale[free[b]]) + ridge
            });
            let right = DVector::from_fn(n, |a, _| {
                let held: f64 = (0..p).filter(|j| bound[*j]).map(|j| h[(free[a], j)] * delta[j]).sum();
                (g[free[a]] - held) / scale[free[a]]
            });
            let Some(solution) = matrix.cholesky().map(|c| c.solve(&right)) else { return DVector::zeros(p) };
            for (a, &i) in free.iter().enumerate() {
                delta[i] = solution[a] / scale[i];
            }
        }
        let worst = free.iter().copied().filter(|i| delta[*i] < lower[*i]).max_by(|a, b| {
            ((lower[*a] - delta[*a]) * scale[*a]).total_cmp(&((lower[*b] - delta[*b]) * scale[*b]))
        });
        if let Some(i) = worst {
            bound[i] = true;
            continue;
        }
        // A bound entry whose gradient points inside is let go.
        let pull = |i: usize| {
            let slope: f64 = (0..p).map(|j| h[(i, j)] * delta[j]).sum::<f64>() - g[i];
            slope / scale[i]
        };
        let released = (0..p)
            .filter(|i| bound[*i] && !dead[*i])
            .map(|i| (i, pull(i)))
            .filter(|(_, s)| *s < -1e-9)
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match released {
            Some((i, _)) => bound[i] = false,
            None => break,
        }
    }
    delta
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_top_of_a_hill_is_reached_within_its_bounds() {
        let bounds = [Bounds::new(0.1, 1000.0), Bounds::new(-1.0, 1.0)];
        let hill = |x: &[f64]| -50.0 * ((x[0] / 30.0).ln().powi(2) + (x[1] - 0.4).powi(2));
        let (at, gain) = pattern_search(&[5.0, -0.5], &bounds, &[], (400, 1e-4), hill);
        assert!(
            (at[0] / 30.0 - 1.0).abs() < 2e-3 && (at[1] - 0.4).abs() < 2e-3 && gain > -1e-3,
            "{at:?} {gain}"
        );
        // A top outside is left for the end that is nearest; a number whose first step is 0 stays.
        let (at, _) =
            pattern_search(&[0.0, 0.7], &[Bounds::new(-1.0, 1.0); 2], &[None, Some(0.0)], (400, 1e-4), |x| {
                x[0] - x[1]
            });
        assert!((at[0] - 1.0).abs() < 1e-6 && at[1] == 0.7, "{at:?}");
    }

    #[test]
    fn the_span_that_is_left_holds_the_root() {
        let Bracket { inside, outside } = bisect(1.0, 2.0, 50, |x| x * x < 2.0);
        assert!(inside * inside < 2.0 && outside * outside >= 2.0 && outside - inside < 1e-14);
        let Bracket { inside, outside } = bisect(2.0, 1.0, 200, |x| x * x > 2.0);
        assert!(inside > outside && inside * inside > 2.0, "{inside} {outside}");
    }

    #[test]
    fn the_minimum_of_a_parabola_is_found() {
        assert!((golden_section(-1.0, 4.0, 60, |x| (x - 0.7).powi(2)) - 0.7).abs() < 1e-7);
    }

    #[test]
    fn bounds_hold_and_the_rest_is_solved_without_the_bound_entry() {
        let h = DMatrix::from_row_slice(3, 3, &[2.0, 1.9, 0.0, 1.9, 2.0, 0.0, 0.0, 0.0, 0.0]);
        let g = DVector::from_vec(vec![2.0, 1.0, 5.0]);
        let delta = bounded_quadratic(&h, &g, &[-10.0, -0.5, -1.0]);
        // Unbounded: δ1 = −4.6; held at −0.5, δ0 = (2 + 0.95)/2.
        assert!(
            (delta[1] + 0.5).abs() < 1e-12 && (delta[0] - 1.475).abs() < 1e-6 && delta[2] == 0.0,
            "{delta}"
        );
        let open = bounded_quadratic(&h, &g, &[f64::NEG_INFINITY, f64::NEG_INFINITY, 0.0]);
        assert!((2.0 * open[0] + 1.9 * open[1] - 2.0).abs() < 1e-6);
    }

    #[test]
    fn both_golden_sections_find_one_extremum() {
        let f = |x: f64| (x - 0.7).powi(2) + 0.1 * (x - 0.7).powi(4);
        let minimum = golden_section(-1.0, 4.0, 40, f);
        let maximum = golden_section_maximum(-1.0, 4.0, 40, |x| -f(x));
        assert!((minimum - 0.7).abs() < 1e-6 && (maximum - 0.7).abs() < 1e-6, "{minimum} {maximum}");
    }

    #[test]
    fn the_exact_minimum_over_nonnegative_numbers() {
        // ½(2x² + 2xy + 2y²) − (3x + 0y): without bounds x = 2, y = −1; with them y = 0 and x = 3/2.
        let h = [[2.0, 1.0], [1.0, 2.0]];
        let x = nonnegative_quadratic(&h, &[3.0, 0.0], &[true, true]);
        assert!((x[0] - 1.5).abs() < 1e-15 && x[1] == 0.0, "{x:?}");
        let held = nonnegative_quadratic(&h, &[3.0, 3.0], &[false, true]);
        assert!(held[0] == 0.0 && (held[1] - 1.5).abs() < 1e-15, "{held:?}");
        assert_eq!(nonnegative_quadratic(&h, &[-1.0, -1.0], &[true, true]), [0.0, 0.0]);
    }

    #[test]
    fn steps_are_shortened_until_one_is_accepted() {
        let halved = |step: f64| 0.5 * step;
        assert_eq!(shortened_steps(9, halved, |step| (step < 0.2).then_some(step)), (Some(0.125), 0.125));
        assert_eq!(shortened_steps(2, halved, |_| None::<f64>), (None, 0.25));
    }

    #[test]
    fn damping_grows_while_steps_are_refused_and_falls_after() {
        let mut damping =
            Damping { value: 1.0, eased_by: 0.1, least: 1e-3, raised_by: 10.0, least_raised: 1e-2 };
        let accepted = damping
            .search(5, |d| if d > 50.0 { ControlFlow::Break(Some(d)) } else { ControlFlow::Continue(()) });
        assert_eq!((accepted, damping.value), (Some(100.0), 10.0));
        let given_up = damping.search(5, |_| ControlFlow::Break(None::<f64>));
        assert_eq!((given_up, damping.value), (None, 10.0));
        assert_eq!(damping.search(3, |_| ControlFlow::<Option<f64>>::Continue(())), None);
        assert_eq!(damping.value, 1e4);
    }

    #[test]
    fn coordinates_climb_to_the_peak_within_their_bounds() {
        let value = |x: &[f64]| Some(-(x[0].ln() - 1.0).powi(2) - (x[1].ln() - 5.0).powi(2));
        let start = (value(&[1.0, 1.0]).unwrap_or(f64::NAN), vec![1.0, 1.0]);
        let (_, at) = coordinate_ascent(start, (0.1, 20.0), (&[1.3, 1.1, 1.02, 1.005], 40), value);
        assert!((at[0] / 1f64.exp() - 1.0).abs() < 0.01 && at[1] == 20.0, "{at:?}");
    }

    #[test]
    fn the_peak_of_a_parabola_lies_between_its_points() {
        // −(x − 1.3)² at 0, 1, 2.
        let values = [-1.69, -0.09, -0.49];
        assert!((parabolic_peak(&values, 1) - 0.3).abs() < 1e-12);
        // No neighbour, no bend downwards, and a top beyond half a step.
        assert_eq!([0, 2, 3].map(|at| parabolic_peak(&values, at)), [0.0; 3]);
        assert_eq!(parabolic_peak(&[1.0, 0.0, 1.0], 1), 0.0);
        assert_eq!((parabolic_peak(&[0.0, 2.0, 3.5], 1), parabolic_peak(&[3.5, 2.0, 0.0], 1)), (0.5, -0.5));
    }

    #[test]
    fn where_both_ways_gain_the_division_is_made() {
        let value = |x: &[f64]| Some(x[0].ln().abs());
        let (gain, at) = coordinate_ascent((0.0, vec![1.0]), (0.25, 8.0), (&[2.0], 1), value);
        assert_eq!((gain, at[0]), (2f64.ln(), 0.5));
        // As many moves as there are, then no further than the bound.
        let (_, at) = coordinate_ascent((0.0, vec![1.0]), (0.25, 8.0), (&[2.0], 40), value);
        assert_eq!(at[0], 0.25);
    }

    /// Where a pattern search from `start` looks, in order.
    fn looks(start: f64, bounds: Bounds, first: &[Option<f64>], limits: (usize, f64)) -> Vec<f64> {
        let seen = std::cell::RefCell::new(vec![]);
        pattern_search(&[start], &[bounds], first, limits, |x| {
            seen.borrow_mut().push(x[0]);
            -(x[0] - start).powi(2)
        });
        seen.into_inner()
    }

    #[test]
    fn the_first_steps_follow_the_bounds() {
        let near = |seen: Vec<f64>, wanted: [f64; 3]| {
            assert!(seen.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{seen:?} {wanted:?}");
        };
        // A hundredth of the bounds; on a logarithmic scale 0.35 where they are more than a factor of 20 apart.
        near(looks(5.0, Bounds::new(1.0, 11.0), &[], (2, 0.0)), [5.0, 5.1, 4.9]);
        near(looks(0.0, Bounds::new(-5.0, 5.0), &[None], (2, 0.0)), [0.0, 0.1, -0.1]);
        let factor = 0.35f64.exp();
        near(looks(5.0, Bounds::new(1.0, 100.0), &[], (2, 0.0)), [5.0, 5.0 * factor, 5.0 / factor]);
        // A step that is given, and one larger than the bounds.
        near(looks(0.0, Bounds::new(-5.0, 5.0), &[Some(0.5)], (2, 0.0)), [0.0, 0.5, -0.5]);
        near(looks(0.0, Bounds::new(-1.0, 1.0), &[Some(9.0)], (2, 0.0)), [0.0, 1.0, -1.0]);
    }

    #[test]
    fn a_pattern_search_ends_with_its_evaluations_its_finest_step_or_a_flat_top() {
        // From the top three looks a pass: two sides and the middle of the parabola. A pass that has begun is finished.
        let bounds = Bounds::new(-5.0, 5.0);
        assert_eq!(looks(0.0, bounds, &[], (10, 0.0)).len(), 10);
        assert_eq!(looks(0.0, bounds, &[], (11, 0.0)).len(), 13);
        // Steps of 0.3 times the last down to a hundred-thousandth of the first: 0.3^10 < 1e-5 < 0.3^9.
        assert_eq!(looks(0.0, bounds, &[], (1000, 0.0)).len(), 31);
        // Both sides lose 0.01, then 0.0009.
        assert_eq!(looks(0.0, bounds, &[], (1000, 0.001)).len(), 7);
    }

    #[test]
    fn a_search_without_a_gain_goes_to_the_top_of_the_parabola() {
        // Neither 0.1 to the left nor to the right gains; the top is between.
        let (at, gain) =
            pattern_search(&[0.0], &[Bounds::new(-5.0, 5.0)], &[], (3, 0.0), |x| -(x[0] - 0.04).powi(2));
        assert!((at[0] - 0.04).abs() < 1e-12 && gain.abs() < 1e-20, "{at:?} {gain}");
    }
}
