//! The largest jump of the level that the noise of the model does not make.
//!
//! A single jump has the spectrum of a random walk, so that a fit takes it for one and no view of the power shows it. Its
//! size at a given time is a generalised least-squares estimate under the noise of the model, and the largest of them
//! over the record is judged by the mean number of times that such an estimate crosses its level (S. O. Rice, Bell System
//! Technical Journal 24, 1945).

use super::view::{Departure, Judged, View};
use crate::estimate::normal_probability;
use crate::numeric::cosine::inverse_dct2;
use sagnac_fft::real_forward;
use std::f64::consts::PI;

/// Means at either end of the record where no jump is looked for: there it is one of few values, which other views judge.
const EXCLUDED_END_MEANS: usize = 4;

/// The largest jump of a series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// Means before it.
    pub before: usize,
    /// Size, deg/h.
    pub size_deg_h: f64,
    /// Size over its standard deviation.
    pub score: f64,
    /// Probability of a larger one anywhere if the model is right.
    pub p_value: f64,
    /// Natural logarithm of that probability, where it is small. Its negative is what the jump adds to the log-likelihood, less
    /// what the search over all places adds by chance.
    pub ln_p: f64,
}

impl Jump {
    /// When it happens, s, in means over `step_s` of which the first begins at `from_s`.
    pub fn time_s(&self, step_s: f64, from_s: f64) -> f64 {
        from_s + self.before as f64 * step_s
    }
}

/// The largest jump in cosine modes of a series (orthonormal) with expected powers; modes without power are left out.
pub(super) fn largest(modes: &[f64], powers: &[f64]) -> Option<Jump> {
    let n = modes.len();
    if n < 4 * EXCLUDED_END_MEANS || powers.len() != n {
        return None;
    }
    let used = |k: usize| k > 0 && powers[k] > 0.0;
    let weighted: Vec<f64> = (0..n).map(|k| if used(k) { modes[k] / powers[k] } else { 0.0 }).collect();
    let score = inverse_dct2(&weighted);
    // Mode k of a step before value i is −√(2/n) sin(πki/n) / (2 sin(πk/2n)); its square holds a cosine, so that the
    // information at all places is one transform.
    let share: Vec<f64> = (0..n)
        .map(|k| {
            let sine = (0.5 * PI * k as f64 / n as f64).sin();
            if used(k) { 0.25 / (n as f64 * sine * sine * powers[k]) } else { 0.0 }
        })
        .collect();
    let whole: f64 = share.iter().sum();
    let plan = real_forward(n);
    let (mut input, mut turned) = (share, plan.make_output_vec());
    plan.process(&mut input, &mut turned).ok()?;
    let information = |i: usize| whole - turned.get(i.min(n - i)).map_or(0.0, |c| c.re);
    let moved = (0..n).filter(|k| used(*k)).map(|k| 1.0 / powers[k]).sum::<f64>() / n as f64;
    let mut sum: f64 = score.iter().take(EXCLUDED_END_MEANS).sum();
    let (mut best, mut crossings) = (None::<(usize, f64, f64)>, 0.0);
    for i in EXCLUDED_END_MEANS..n - EXCLUDED_END_MEANS {
        let (here, next) = (information(i), information(i + 1));
        if here > 0.0 && next > 0.0 {
            // All scores together are 0, so that those behind are the negative of those before.
            let z = -sum / here.sqrt();
            let alike = ((here + next - moved) / (2.0 * (here * next).sqrt())).clamp(0.0, 1.0);
            crossings += (2.0 * (1.0 - alike)).sqrt() / (2.0 * PI);
            if best.is_none_or(|b| z.abs() > b.1.abs()) {
                best = Some((i, z, here));
            }
        }
        sum += score.get(i).copied().unwrap_or(0.0);
    }
    let (before, z, information) = best?;
    let p = 2.0 * (normal_probability(-z.abs()) + crossings * (-0.5 * z * z).exp());
    let ln_p = (2.0 * crossings).max(1.0).ln() - 0.5 * z * z;
    let size_deg_h = z / information.sqrt();
    size_deg_h.is_finite().then_some(Jump { before, size_deg_h, score: z, p_value: p.min(1.0), ln_p })
}

/// The view of jumps.
pub(super) fn judge(jump: &Jump, step_s: f64, from_s: f64) -> Judged {
    let at = jump.time_s(step_s, from_s);
    Judged {
        view: View::Jump,
        statistic: jump.score,
        p_value: jump.p_value,
        departure: Departure { from: at - 0.5 * step_s, to: at + 0.5 * step_s, excess: jump.size_deg_h },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::cosine::dct2;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// White noise of variance 1 on a random walk of steps of 0.03, and its powers.
    fn record(seed: u64, n: usize) -> (Vec<f64>, Vec<f64>) {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut level = 0.0;
        let series = (0..n).map(|_| {
            level += 0.03 * normal();
            level + normal()
        });
        let powers = (0..n).map(|k| {
            let sine = (0.5 * PI * k as f64 / n as f64).sin();
            if k == 0 { 0.0 } else { 1.0 + 0.0009 / (4.0 * sine * sine) }
        });
        (series.collect(), powers.collect())
    }

    #[test]
    fn walks_have_no_jump_as_often_as_stated_and_jumps_are_found_with_their_size() {
        let n = 2000;
        let (mut small, runs) = (0, 60);
        for seed in 0..runs {
            let (series, powers) = record(seed, n);
            small += usize::from(largest(&dct2(&series), &powers).unwrap().p_value < 0.05);
        }
        // 5 % of 60 and less: an upper bound; 99.9 % of Binomial(60, 0.05) lie below 10.
        assert!(small < 10, "{small}");
        let (mut series, powers) = record(1000, n);
        series[1200..].iter_mut().for_each(|x| *x += 3.0);
        let found = largest(&dct2(&series), &powers).unwrap();
        assert!(found.before.abs_diff(1200) < 12 && found.p_value < 1e-6, "{found:?}");
        // √(2·1·0.03) is the deviation of a jump between two well-known levels of a walk.
        assert!((found.size_deg_h - 3.0).abs() < 4.0 * 0.25, "{found:?}");
        assert!((found.size_deg_h / found.score / 0.245 - 1.0).abs() < 0.1, "{found:?}");
        assert_eq!(largest(&[0.0; 8], &[1.0; 8]), None);
    }
}
