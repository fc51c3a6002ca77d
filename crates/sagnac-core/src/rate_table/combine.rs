//! What scatters and what does not, in one confidence distribution.

use crate::estimate::{Component, Spread, normal_quantile};
use crate::numeric::reml::Combination;

/// The spread of a value that scatters as `random` says, times `factor`, with components known otherwise: Student's law with the
/// degrees of freedom of Welch and Satterthwaite.
pub fn spread(random: &Combination, factor: f64, others: &[Component]) -> Spread {
    beside(random, factor, others.iter().map(|c| c.contribution * c.contribution).sum())
}

/// The spread of a value that scatters, with another variance in the unit of the result.
fn beside(random: &Combination, factor: f64, others: f64) -> Spread {
    let scatter = (random.standard * factor).powi(2);
    let total = scatter + others;
    let dof = if scatter > 0.0 { random.dof * (total / scatter).powi(2) } else { f64::INFINITY };
    Spread::StudentT { standard_uncertainty: total.sqrt(), dof: dof.min(1e9) }
}

/// Share of the standard uncertainty below which an even contribution is as good as a normal one.
const HARDLY_EVEN: f64 = 0.5;

/// Points of the even contribution that are averaged over.
const AVERAGED_POINTS: usize = 400;
/// Points of the curve.
const CURVE_POINTS: usize = 160;

/// The spread of a value with one more contribution, of which all values up to `most` to either side are as likely. Twice the
/// standard uncertainty would be more than there can be of it.
pub fn evenly(rest: Spread, value: f64, most: f64) -> Spread {
    let Spread::StudentT { standard_uncertainty: u, dof } = rest else { return rest };
    if most <= HARDLY_EVEN * u {
        return beside(&Combination { value, standard: u, dof }, 1.0, most * most / 3.0);
    }
    let (fine, count) = (AVERAGED_POINTS, CURVE_POINTS);
    let shift = |i: usize| most * ((2 * i + 1) as f64 / fine as f64 - 1.0);
    let u = u.max(most / fine as f64);
    let rest = Spread::StudentT { standard_uncertainty: u, dof };
    let below = |at: f64| -> f64 {
        let each = (0..fine).map(|i| 1.0 - rest.probability_above(shift(i), at).unwrap_or(0.5));
        each.sum::<f64>() / fine as f64
    };
    let end = most + 6.0 * u;
    let half: Vec<(f64, f64)> = (1..=count)
        .map(|i| end * i as f64 / count as f64)
        .map(|at| (normal_quantile(below(at)), at))
        .filter(|(z, _)| z.is_finite())
        .collect();
    let lower = half.iter().rev().map(|(z, at)| (-z, value - at));
    let upper = half.iter().map(|(z, at)| (*z, value + at));
    Spread::Curve(lower.chain([(0.0, value)]).chain(upper).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bound(u: f64, dof: f64, most: f64, confidence: f64) -> f64 {
        let rest = Spread::StudentT { standard_uncertainty: u, dof };
        evenly(rest, 3.0, most).bound(3.0, confidence).unwrap() - 3.0
    }

    #[test]
    fn an_even_contribution_ends_where_it_ends() {
        // Alone: 95 % lie within 0.95 of the most.
        assert!((bound(1e-6, 1e9, 1.0, 0.975) - 0.95).abs() < 0.01);
        assert!((bound(1e-6, 1e9, 1.0, 0.025) + 0.95).abs() < 0.01);
        assert!((bound(0.0, 1e9, 1.0, 0.95) - 0.9).abs() < 0.01);
        // Even on 1 with normal 1: P(|e + z| < 2.2541) = 0.95, by ∫Φ = xΦ + φ.
        assert!((bound(1.0, 1e9, 1.0, 0.975) - 2.2541).abs() < 0.01, "{}", bound(1.0, 1e9, 1.0, 0.975));
        // Where there is little of it, it is the root of the sum of squares.
        assert!((bound(1.0, 1e9, 0.1, 0.975) - 1.95996 * (1.0f64 + 0.01 / 3.0).sqrt()).abs() < 1e-4);
    }

    #[test]
    fn the_curve_rises() {
        let Spread::Curve(points) =
            evenly(Spread::StudentT { standard_uncertainty: 0.2, dof: 4.0 }, 0.0, 1.0)
        else {
            panic!("a curve")
        };
        assert!(points.windows(2).all(|p| p[1].0 > p[0].0 && p[1].1 > p[0].1));
    }
}
