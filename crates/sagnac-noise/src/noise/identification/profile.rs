//! Profile likelihood of one coefficient: the confidence curve of a claimed term, the upper limit of one that is not.
//!
//! The signed root z of twice the drop in log-likelihood is read as a normal score, other coefficients refitted at
//! every value (Wilks; for an amplitude on its boundary at 0, Self and Liang, JASA 82, 1987).

use super::linear_fit::{Likelihood, Point, RAMP_INDEX, SPECTRAL_TERM_COUNT, Structure};
use crate::estimate::{Spread, normal_probability};
use crate::numeric::order::SortByNumber;

/// Outermost normal score of a curve.
const MAX_SCORE: f64 = 4.0;

/// How a confidence curve is traced.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trace {
    /// First step to each side, in the unit of the caller's steps.
    pub first_step: f64,
    /// Normal score between neighbouring points, about.
    pub spacing: f64,
    /// Points to each side at most.
    pub max_points: usize,
}

/// The confidence curve of a quantity from its profile likelihood: pairs (normal score, value), ascending, from −4 or the
/// boundary to 4.
///
/// `next` gives the value one signed step on, the same value at a boundary. `rise` gives the rise of the deviance there
/// over its minimum, infinite or NaN where there is none; it may keep a starting point for the next fit in a state, which
/// begins as `state` on each side.
pub(super) fn trace_curve<S: Clone>(
    value: f64,
    trace: Trace,
    state: S,
    next: impl Fn(f64, f64) -> f64,
    rise: impl Fn(f64, &mut S) -> f64,
) -> Spread {
    let mut points = vec![(0.0, value)];
    for direction in [-1.0, 1.0] {
        let (mut at, mut z, mut step, mut state) = (value, 0.0, trace.first_step, state.clone());
        for _ in 0..trace.max_points {
            let further = next(at, direction * step);
            if further == at {
                break;
            }
            let rise = rise(further, &mut state);
            if !rise.is_finite() {
                break;
            }
            let score: f64 = direction * rise.max(0.0).sqrt();
            let gained = (score - z).abs();
            (at, z) = (further, score);
            points.push((z, at));
            if z.abs() >= MAX_SCORE {
                break;
            }
            step *= (trace.spacing / gained.max(1e-3)).clamp(0.4, 2.5);
        }
    }
    points.sort_ascending_by(|a| a.1);
    let mut highest = f64::NEG_INFINITY;
    for p in &mut points {
        highest = highest.max(p.0);
        p.0 = highest;
    }
    Spread::Curve(points)
}

/// The profile of one coefficient within a structure.
pub struct Profile<'a> {
    likelihood: &'a Likelihood,
    structure: Structure,
    term: usize,
    best: Point,
    top: f64,
    sigma: f64,
}

impl<'a> Profile<'a> {
    /// Finds the maximum; `None` when the structure cannot be fitted.
    pub fn new(likelihood: &'a Likelihood, structure: &Structure, term: usize) -> Option<Profile<'a>> {
        let mut structure = *structure;
        *structure.get_mut(term)? = true;
        let best = likelihood.maximise(&structure, None, None)?;
        let mut profile = Profile { likelihood, structure, term, best, top: best.deviance, sigma: 0.0 };
        if term == RAMP_INDEX {
            // At a fixed ramp the likelihood is the plain one: its own maximum is the reference.
            profile.top = profile.deviance(best.ramp)?;
        }
        profile.sigma = profile.first_sigma();
        Some(profile)
    }

    /// The coefficient at the maximum.
    pub fn value(&self) -> f64 {
        self.best.coefficient(self.term)
    }

    fn first_sigma(&self) -> f64 {
        let model = self.best.model();
        let bound = self.likelihood.covariance_bound(&model, &self.structure);
        let sigma = bound[self.term][self.term].max(0.0).sqrt();
        if self.term < SPECTRAL_TERM_COUNT {
            // Near zero the information of the coefficient vanishes; that of its square does not.
            let variance = self.likelihood.variance_sigma(&self.best, self.term);
            let near_zero = variance.sqrt();
            if sigma <= 0.0 || sigma > near_zero { near_zero } else { sigma }
        } else {
            sigma
        }
    }

    fn deviance(&self, coefficient: f64) -> Option<f64> {
        let fixed = Some((self.term, coefficient));
        let point = self.likelihood.maximise(&self.structure, fixed, Some(&self.best))?;
        Some(point.deviance)
    }

    /// Rise of the deviance at a coefficient over its minimum.
    fn rise(&self, coefficient: f64) -> f64 {
        self.deviance(coefficient).map_or(f64::INFINITY, |d| (d - self.top).max(0.0))
    }

    fn lowest(&self) -> f64 {
        if self.term == RAMP_INDEX { f64::NEG_INFINITY } else { 0.0 }
    }

    /// Pairs (normal score, coefficient), ascending, from −4 or the boundary to 4.
    pub fn spread(&self) -> Spread {
        if !(self.sigma > 0.0 && self.sigma.is_finite()) {
            return Spread::Unknown;
        }
        let next = |at: f64, step: f64| (at + step).max(self.lowest());
        let rise = |coefficient: f64, _: &mut ()| self.rise(coefficient);
        trace_curve(
            self.value(),
            Trace { first_step: 0.4 * self.sigma, spacing: 0.4, max_points: 60 },
            (),
            next,
            rise,
        )
    }

    /// The largest size of the coefficient whose deviance is not more than `rise` above the minimum.
    pub fn upper_limit(&self, rise: f64) -> Option<f64> {
        let side = |direction: f64| {
            let start = self.value();
            let (mut low, mut step) = (start, self.sigma);
            let mut high = start + direction * step;
            for _ in 0..60 {
                if self.rise(high) >= rise {
                    break;
                }
                low = high;
                step *= 2.0;
                high += direction * step;
            }
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if self.rise(middle) < rise {
                    low = middle
                } else {
                    high = middle
                }
                if (high - low).abs() < 1e-4 * high.abs() {
                    break;
                }
            }
            high
        };
        if !(self.sigma > 0.0 && self.sigma.is_finite()) {
            return None;
        }
        let up = side(1.0).abs();
        let limit = if self.term == RAMP_INDEX { up.max(side(-1.0).abs()) } else { up };
        limit.is_finite().then_some(limit)
    }
}

/// The wider of two curves on each side, for a coefficient whose structure is in doubt: at every normal score the
/// value farther from `value`.
pub fn wider(value: f64, a: &Spread, b: &Spread) -> Spread {
    let bound = |z: f64| {
        let at = |spread: &Spread| spread.bound(value, normal_probability(z)).unwrap_or(value);
        if z < 0.0 { at(a).min(at(b)).min(value) } else { at(a).max(at(b)).max(value) }
    };
    let mut points: Vec<(f64, f64)> =
        (-16..=16).map(|i| 0.25 * f64::from(i)).map(|z| (z, bound(z))).collect();
    if let Some(middle) = points.get_mut(16) {
        middle.1 = value;
    }
    Spread::Curve(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_of_a_parabola_is_a_straight_line() {
        let (value, sigma) = (5.0, 0.3);
        let trace = Trace { first_step: 0.4 * sigma, spacing: 0.4, max_points: 60 };
        let rise = |x: f64, _: &mut ()| ((x - value) / sigma).powi(2);
        let Spread::Curve(points) = trace_curve(value, trace, (), |at, step| at + step, rise) else {
            panic!("a curve");
        };
        assert!(points.first().is_some_and(|p| p.0 <= -4.0) && points.last().is_some_and(|p| p.0 >= 4.0));
        for (z, x) in points {
            assert!((z - (x - value) / sigma).abs() < 1e-12, "{z} {x}");
        }
    }

    #[test]
    fn the_curve_ends_at_a_boundary() {
        let trace = Trace { first_step: 0.5, spacing: 0.5, max_points: 60 };
        let next = |at: f64, step: f64| (at + step).max(0.0);
        let spread = trace_curve(1.0, trace, (), next, |x, _| (x - 1.0).powi(2));
        let Spread::Curve(points) = spread else { panic!("a curve") };
        assert_eq!(points.first(), Some(&(-1.0, 0.0)));
    }

    #[test]
    fn the_wider_of_two_curves_on_each_side() {
        let line = |below: f64, above: f64| {
            Spread::Curve(
                (-4..=4).map(f64::from).map(|z| (z, z * if z < 0.0 { below } else { above })).collect(),
            )
        };
        let Spread::Curve(points) = wider(0.0, &line(1.0, 2.0), &line(3.0, 0.5)) else { panic!("a curve") };
        let at = |z: f64| points.iter().find(|p| p.0 == z).map_or(f64::NAN, |p| p.1);
        assert!((at(-2.0) + 6.0).abs() < 1e-6 && (at(2.0) - 4.0).abs() < 1e-6 && at(0.0) == 0.0);
    }
}
