//! The path of jumps between two levels beside coloured noise.
//!
//! The noise is integrated out: with C its covariance, a path c gains ½ (c·C⁻¹r)²/(c·C⁻¹c) less the cost of its jumps.
//! Beside a background that is held, a wrong stretch of a path stays: the background has taken its level.

use crate::numeric::cosine::{dct2, fast_length, inverse_dct2};
use std::collections::BTreeMap;

/// Changes of a path at most.
const MAX_PATH_CHANGES: usize = 200;
/// Lengths of stretches that are tried, per octave.
const PER_OCTAVE: f64 = 2.0;
/// Least cost of a jump in nats.
const LEAST_COST: f64 = 1.0;

/// A series, its noise and what paths are judged with.
pub struct Paths {
    /// 1/P of each mode; 0 of what is free.
    inverse: Vec<f64>,
    /// C⁻¹r.
    weighted: Vec<f64>,
    /// Variance of the white noise of a value.
    white: f64,
    /// Lengths tried, and what a stretch of each has of c·C⁻¹c.
    lengths: Vec<(usize, f64)>,
    /// The same of every length that was asked for.
    squares: BTreeMap<usize, f64>,
}

/// Sums of a path with the weighted series and with itself.
struct Sums {
    with_series: f64,
    with_itself: f64,
    jumps: usize,
}

impl Sums {
    /// ½ (c·C⁻¹r)²/(c·C⁻¹c) less the cost of the jumps: each has an instant, known to where a step of this size shows.
    fn worth(&self, n: usize, white: f64) -> f64 {
        if self.jumps == 0 || self.with_itself <= 0.0 {
            return 0.0;
        }
        let size = self.with_series / self.with_itself;
        let resolved = (white / (size * size)).max(1.0);
        let dwell = n as f64 / (self.jumps as f64 + 1.0);
        let cost = (dwell / resolved).ln().max(LEAST_COST);
        0.5 * self.with_series * self.with_series / self.with_itself - cost * self.jumps as f64
    }
}

/// Sums up to each place.
fn prefix(values: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    std::iter::once(0.0)
        .chain(values.iter().map(|v| {
            sum += v;
            sum
        }))
        .collect()
}

impl Paths {
    /// For a series in noise of these powers by cosine mode; mode 0 is free. `white` is the variance of what no neighbours
    /// share. A few values at the end are left out where that makes transforms faster.
    pub fn new(series: &[f64], powers: &[f64], white: f64) -> Paths {
        let series = series.get(..fast_length(series.len())).unwrap_or(series);
        let n = series.len();
        let inverse: Vec<f64> =
            (0..n).map(|k| if k == 0 { 0.0 } else { powers.get(k).map_or(0.0, |p| 1.0 / p) }).collect();
        let mut out = Paths { weighted: vec![], inverse, white, lengths: vec![], squares: BTreeMap::new() };
        out.weighted = out.weigh(series);
        let octaves = (n.max(2) as f64 / 2.0).log2().max(0.0);
        let mut lengths: Vec<usize> = (0..=(octaves * PER_OCTAVE) as usize)
            .map(|i| 2f64.powf(i as f64 / PER_OCTAVE) as usize)
            .collect();
        lengths.dedup();
        out.lengths = lengths.into_iter().map(|length| (length, out.square(length))).collect();
        out
    }

    fn weigh(&self, series: &[f64]) -> Vec<f64> {
        let modes: Vec<f64> = dct2(series).iter().zip(&self.inverse).map(|(x, i)| x * i).collect();
        inverse_dct2(&modes)
    }

    /// c·C⁻¹c of one stretch in the middle.
    fn square(&mut self, length: usize) -> f64 {
        if let Some(known) = self.squares.get(&length) {
            return *known;
        }
        let n = self.inverse.len();
        let from = (n - length) / 2;
        let stretch: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i >= from && i < from + length))).collect();
        let square = dct2(&stretch).iter().zip(&self.inverse).map(|(x, i)| x * x * i).sum();
        self.squares.insert(length, square);
        square
    }

    /// The path that is reached from another by turning stretches over, while that gains, and its gain. Values that
    /// were left out stay with their neighbour.
    pub fn improved(&mut self, path: Vec<bool>) -> (f64, Vec<bool>) {
        let length = path.len();
        let mut path = path;
        path.truncate(self.inverse.len());
        let mut worth = 0.0;
        for _ in 0..MAX_PATH_CHANGES {
            let (reached, turned) = self.best_move(&path);
            worth = reached;
            let Some((from, to)) = turned else { break };
            path[from..to].iter_mut().for_each(|p| *p = !*p);
        }
        path.resize(length, path.last().copied().unwrap_or(false));
        (worth, path)
    }

    /// The stretch that is best turned over, and the gain of the path then.
    fn best_move(&mut self, path: &[bool]) -> (f64, Option<(usize, usize)>) {
        let n = path.len();
        let course: Vec<f64> = path.iter().map(|p| f64::from(u8::from(*p))).collect();
        let own = self.weigh(&course);
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let edges: Vec<usize> = (1..n).filter(|i| path[*i] != path[i - 1]).collect();
        let ends: Vec<usize> =
            std::iter::once(0).chain(edges.iter().copied()).chain(std::iter::once(n)).collect();
        let whole: Vec<f64> = ends.windows(2).map(|s| self.square(s[1] - s[0])).collect();
        let now = Sums {
            with_series: product(&course, &self.weighted),
            with_itself: product(&course, &own),
            jumps: edges.len(),
        };
        let (weighted, own) = (prefix(&self.weighted), prefix(&own));
        let jump_at = |i: usize| i > 0 && i < n && path[i] != path[i - 1];
        let turned = |from: usize, to: usize, square: f64| {
            let sign = if path[from] { -1.0 } else { 1.0 };
            let jumps = [from, to]
                .into_iter()
                .filter(|i| *i > 0 && *i < n)
                .fold(now.jumps, |sum, i| if jump_at(i) { sum - 1 } else { sum + 1 });
            Sums {
                with_series: now.with_series + sign * (weighted[to] - weighted[from]),
                with_itself: now.with_itself + 2.0 * sign * (own[to] - own[from]) + square,
                jumps,
            }
            .worth(n, self.white)
        };
        let mut best = (now.worth(n, self.white) + 0.05, None);
        let mut judge = |from: usize, to: usize, square: f64| {
            let worth = turned(from, to, square);
            if worth > best.0 {
                best = (worth, Some((from, to)));
            }
        };
        for (stretch, square) in ends.windows(2).zip(whole) {
            let (from, to) = (stretch[0], stretch[1]);
            if to - from < n {
                judge(from, to, square);
            }
            for (length, square) in self.lengths.iter().take_while(|(l, _)| *l < to - from) {
                (from..=to - length).for_each(|i| judge(i, i + length, *square));
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// Noise of these powers by cosine mode.
    fn noise(powers: &[f64], seed: u64) -> Vec<f64> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let draw =
            |p: &f64| p.sqrt() * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng);
        inverse_dct2(&powers.iter().map(draw).collect::<Vec<f64>>())
    }

    #[test]
    fn a_path_with_stretches_missed_and_made_up_is_mended_beside_flicker() {
        let n = 2000;
        let powers: Vec<f64> = (0..n).map(|k| 1.0 + 60.0 / f64::from(k.max(1) as u32)).collect();
        for seed in 0..4 {
            let truth: Vec<bool> = (0..n).map(|i| (i / 170) % 3 == 1).collect();
            let series: Vec<f64> = noise(&powers, seed)
                .into_iter()
                .zip(&truth)
                .map(|(x, p)| x + 3.0 * f64::from(u8::from(*p)))
                .collect();
            let mut start = truth.clone();
            start[170..340].fill(false);
            start[900..960].iter_mut().for_each(|p| *p = !*p);
            for start in [start, vec![false; n]] {
                let found = Paths::new(&series, &powers, 1.0).improved(start).1;
                let wrong = found.iter().zip(&truth).filter(|(a, b)| a != b).count();
                // Which level is the upper one is the same for either.
                assert!(wrong.min(n - wrong) < n / 50, "seed {seed}: {wrong} of {n}");
            }
        }
    }

    #[test]
    fn flicker_alone_has_no_path() {
        let n = 2000;
        let powers: Vec<f64> = (0..n).map(|k| 1.0 + 60.0 / f64::from(k.max(1) as u32)).collect();
        let long = (0..20).filter(|seed| {
            let found = Paths::new(&noise(&powers, 100 + seed), &powers, 1.0).improved(vec![false; n]).1;
            found.windows(2).filter(|w| w[0] != w[1]).count() > 3
        });
        assert!(long.count() <= 1);
    }
}
