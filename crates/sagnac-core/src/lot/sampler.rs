//! Draws of the variances of a population, by slice sampling; values that are only bounded are drawn along.

use super::restricted::{Level, Lot, Variances, level, weights};
use crate::estimate::{normal_probability, normal_quantile};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Seed: the same lot always has the same bounds.
const SAMPLER_SEED: u64 = 0x006c_6f74;
/// Draws that are left out, until the start is forgotten.
const LEFT_OUT: usize = 300;
/// Draws that are kept.
const KEPT_DRAWS: usize = 1000;
/// Draws of which one is kept: those that follow each other are alike.
const DRAWS_PER_KEPT: usize = 3;
/// Width of a slice, in the logarithm of a variance.
const SLICE_WIDTH_LN: f64 = 1.5;
/// Steps in which a slice is widened, and in which it is narrowed.
const MAX_SLICE_STEPS: usize = 40;

/// One draw: the variances, and what the values tell with them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Draw {
    pub(super) variances: Variances,
    pub(super) level: Level,
}

/// A value that is only bounded: its place, and where its reading lies below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounded {
    pub(super) lot: usize,
    pub(super) at: usize,
    pub(super) most: f64,
}

/// Draws from the distribution of the variances that values in lots tell. `start` is a variance of their order.
pub(super) fn draws(lots: &[Lot], bounded: &[Bounded], start: f64, between_lots: bool) -> Vec<Draw> {
    let logs = [start.ln(), (0.3 * start).ln()];
    let mut state = State {
        lots: lots.to_vec(),
        logs,
        level: level(lots, of_logs(logs, between_lots)),
        between_lots,
        rng: Xoshiro256PlusPlus::seed_from_u64(SAMPLER_SEED),
    };
    let mut kept = Vec::with_capacity(KEPT_DRAWS);
    for i in 0..LEFT_OUT + KEPT_DRAWS * DRAWS_PER_KEPT {
        state.slice(0);
        if between_lots {
            state.slice(1);
        }
        let draw = Draw { variances: state.variances(), level: state.level };
        if i >= LEFT_OUT && i % DRAWS_PER_KEPT == 0 {
            kept.push(draw);
        }
        if !bounded.is_empty() {
            state.complete(bounded, draw);
            state.level = level(&state.lots, state.variances());
        }
    }
    kept
}

struct State {
    lots: Vec<Lot>,
    /// Logarithms of the variances between units and between lots.
    logs: [f64; 2],
    /// Likelihood of the values with these variances.
    level: Level,
    between_lots: bool,
    rng: Xoshiro256PlusPlus,
}

impl State {
    fn variances(&self) -> Variances {
        of_logs(self.logs, self.between_lots)
    }

    /// Moves one variance (Neal 2003).
    fn slice(&mut self, which: usize) {
        let (lots, between_lots, from) = (&self.lots, self.between_lots, self.logs);
        let with = |x: f64| {
            let mut logs = from;
            if let Some(log) = logs.get_mut(which) {
                *log = x;
            }
            logs
        };
        let told = |x: f64| level(lots, of_logs(with(x), between_lots));
        let density_of = |x: f64, told: Level| {
            let logs = with(x);
            let jacobian = logs[0] + if between_lots { logs[1] } else { 0.0 };
            told.log_density + jacobian
        };
        let density = |x: f64| density_of(x, told(x));
        let here = if which == 0 { from[0] } else { from[1] };
        let least = density_of(here, self.level) + self.rng.random::<f64>().max(f64::MIN_POSITIVE).ln();
        let mut low = here - SLICE_WIDTH_LN * self.rng.random::<f64>();
        let mut high = low + SLICE_WIDTH_LN;
        for _ in 0..MAX_SLICE_STEPS {
            if density(low) <= least {
                break;
            }
            low -= SLICE_WIDTH_LN;
        }
        for _ in 0..MAX_SLICE_STEPS {
            if density(high) <= least {
                break;
            }
            high += SLICE_WIDTH_LN;
        }
        for _ in 0..MAX_SLICE_STEPS {
            let x = low + (high - low) * self.rng.random::<f64>();
            let there = told(x);
            if density_of(x, there) > least {
                (self.logs, self.level) = (with(x), there);
                return;
            }
            if x < here { low = x } else { high = x }
        }
    }

    /// Draws the readings that are only bounded, given all else.
    fn complete(&mut self, bounded: &[Bounded], draw: Draw) {
        let Draw { variances, level } = draw;
        let mean = level.mean + level.variance.sqrt() * self.normal();
        let between = variances.lots.unwrap_or(0.0);
        let mut centres = Vec::with_capacity(self.lots.len());
        for i in 0..self.lots.len() {
            let (sum, first) = self.lots.get(i).map_or((0.0, 0.0), |l| weights(l, variances.units));
            let variance = between / (1.0 + between * sum);
            let offset = variance * (first - mean * sum);
            centres.push(mean + offset + variance.sqrt() * self.normal());
        }
        for b in bounded {
            let centre = centres.get(b.lot).copied().unwrap_or(mean);
            let uniform: f64 = self.rng.random();
            let Some(lot) = self.lots.get_mut(b.lot) else { continue };
            let (Some(value), Some(own)) = (lot.values.get_mut(b.at), lot.variances.get(b.at)) else {
                continue;
            };
            let deviation = (variances.units + own).sqrt();
            *value = centre + deviation * below((b.most - centre) / deviation, uniform);
        }
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.rng)
    }
}

fn of_logs(logs: [f64; 2], between_lots: bool) -> Variances {
    Variances { units: logs[0].exp(), lots: between_lots.then(|| logs[1].exp()) }
}

/// A standard normal number below `most`, from a uniform one.
fn below(most: f64, uniform: f64) -> f64 {
    if most < -6.0 {
        // There the tail is that of an exponential law.
        return most + (1.0 - uniform).max(f64::MIN_POSITIVE).ln() / -most;
    }
    normal_quantile(uniform * normal_probability(most)).min(most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_below_a_bound_have_its_mean() {
        for most in [-8.0, -2.0, 0.0, 1.5] {
            let n = 20_000;
            let mean =
                (0..n).map(|i| below(most, (f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n);
            // −φ/Φ; far below, the asymptotic series.
            let density = (-0.5_f64 * most * most).exp() / (2.0 * std::f64::consts::PI).sqrt();
            let expected = if most < -6.0 { most + 1.0 / most } else { -density / normal_probability(most) };
            assert!((mean - expected).abs() < 4e-3, "{most}: {mean} is not {expected}");
        }
    }
}
