//! Whether the output follows the table late: the later part of a step against the whole of it.
//!
//! An output behind a filter, a slow loop or a delay still holds some of the rate before when the evaluated part of a step begins.
//! The mean of the step is then off by a share of the change of rate that led to it, which no noise knows.

use super::steps::{Part, Step, Steps};
use crate::estimate::Spread;
use crate::numeric::reml::Combination;
use nalgebra::{DMatrix, DVector};

/// Probability by chance below which the output is late.
const MAX_CHANCE: f64 = 1e-5;
/// Fewest steps beyond the unknowns.
const MIN_SPARE_STEPS: usize = 4;
/// A constant, the rate, and the change of rate: what the output of a step may differ by between its parts.
const UNKNOWNS: usize = 3;

/// What the means of the steps hold of the rate before, as a share of the change of rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Late {
    /// The share; below zero where the output goes too far at first.
    pub share: Combination,
}

impl Late {
    /// Of one gyro channel; `None` without enough steps of several parts, or where no share is seen.
    pub fn of(steps: &Steps, gyro: usize) -> Option<Late> {
        let rows: Vec<(f64, f64, f64)> = steps
            .list
            .windows(2)
            .filter_map(|pair| Some((pair[1].rate, pair[0].rate - pair[1].rate, of_step(&pair[1], gyro)?)))
            .collect();
        let dof = rows.len().checked_sub(UNKNOWNS).filter(|spare| *spare >= MIN_SPARE_STEPS)? as f64;
        let size = rows.iter().fold(0.0, |m: f64, r| m.max(r.0.abs()).max(r.1.abs()));
        let x = DMatrix::from_fn(rows.len(), UNKNOWNS, |i, j| [1.0, rows[i].0 / size, rows[i].1 / size][j]);
        let y = DVector::from_fn(rows.len(), |i, _| rows[i].2 / size);
        let normal = (x.transpose() * &x).cholesky()?;
        let fitted = normal.solve(&(x.transpose() * &y));
        let left = (&y - &x * &fitted).norm_squared() / dof;
        let at = UNKNOWNS - 1;
        let standard = (left * normal.inverse()[(at, at)]).sqrt();
        if standard <= 0.0 {
            return None;
        }
        let share = Combination { value: fitted[at], standard, dof };
        let spread = Spread::StudentT { standard_uncertainty: standard, dof };
        let chance = 2.0 * spread.probability_above(0.0, share.value.abs())?;
        (chance < MAX_CHANCE).then_some(Late { share })
    }
}

/// Output of a whole step less that of its later half, the motion of the table taken out, deg/h.
fn of_step(step: &Step, gyro: usize) -> Option<f64> {
    let off = |p: &Part| p.gyro.get(gyro).map(|g| g - p.rate).filter(|off| off.is_finite());
    let parts: Vec<(f64, f64)> =
        step.parts.iter().filter_map(|p| Some((p.length_s, off(p)?))).filter(|p| p.0 > 0.0).collect();
    let later = parts.get(parts.len().div_ceil(2)..).filter(|later| !later.is_empty())?;
    let mean =
        |of: &[(f64, f64)]| of.iter().map(|(l, v)| l * v).sum::<f64>() / of.iter().map(|p| p.0).sum::<f64>();
    Some(mean(&parts) - mean(later))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::test_evidence::{part, steps, within};
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// Rates up and down three times; the output has white noise and follows with a time constant, in parts of 5 s.
    fn table(time_constant_s: f64, noise: f64, seed: u64) -> Steps {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let up = [-1000.0, -400.0, -100.0, 0.0, 100.0, 400.0, 1000.0];
        let cycle = up.iter().chain(up.iter().rev().skip(1).take(5));
        let rates: Vec<f64> = cycle.clone().chain(cycle.clone()).chain(cycle).copied().collect();
        let mut found = steps(&rates, &rates, 12);
        let mut output = rates[0];
        for step in &mut found.list {
            let rate = step.rate;
            step.parts = (0..4)
                .map(|k| {
                    let kept = (-5.0 / time_constant_s).exp();
                    let mean = rate + (output - rate) * (1.0 - kept) * time_constant_s / 5.0;
                    output = rate + (output - rate) * kept;
                    let scatter: f64 = StandardNormal.sample(&mut rng);
                    part(k, rate, mean + noise * scatter)
                })
                .collect();
        }
        found
    }

    #[test]
    fn an_output_that_follows_late_is_seen_with_its_share() {
        // Behind 3 s the mean of 20 s holds 3/20 (1 − e^(−20/3)) of the change, and that of the later 10 s 3/10 of e^(−10/3).
        let late = Late::of(&table(3.0, 1.0, 1), 0).unwrap();
        let left = |from: f64| 3.0 / (20.0 - from) * ((-from / 3.0f64).exp() - (-20.0 / 3.0f64).exp());
        within(late.share.value, left(0.0) - left(10.0), 0.02);
    }

    #[test]
    fn noise_is_not_late() {
        let seen = (0..400).filter(|seed| Late::of(&table(1e-3, 1.0, *seed), 0).is_some()).count();
        assert_eq!(seen, 0);
        assert_eq!(Late::of(&steps(&[0.0, 100.0, 0.0], &[0.0, 100.0, 0.0], 3), 0), None);
    }
}
