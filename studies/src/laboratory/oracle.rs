//! An oracle that knows the truth: how much likelier a recording is to it than to the claim.
//!
//! Cosine modes and the claimed density (Whittle). The claim may move its linear terms and its noise within their stated
//! uncertainties; so may the oracle. Likelihoods are penalised by how far they moved.

use super::claim::{Claim, Columns};
use super::modes::{Modes, series_of};
use super::noise::Levels;

/// How many standard deviations a level may move.
const FARTHEST: f64 = 2.5;

/// A band of modes of nearly one density.
#[derive(Debug, Clone, Copy)]
struct Band {
    from: usize,
    to: usize,
    frequency_hz: f64,
}

/// What the oracle knows of a recording before an effect: the claim, and the residual of the claim without the effect.
pub struct Oracle {
    rate_hz: f64,
    residual: Vec<f64>,
    /// Standard deviation of each mode under the claim.
    sigma: Vec<f64>,
    /// Uncertain linear terms, each of the size of its standard deviation, over `sigma`.
    linear: Vec<Vec<f64>>,
    bands: Vec<Band>,
    levels: Levels,
    levels_rel: [f64; 3],
}

/// What a law adds to the density at a frequency, and what it multiplies it by.
pub struct Density<'a> {
    /// Levels of the three terms.
    pub levels: Levels,
    /// Factor on them.
    pub factor: &'a dyn Fn(f64) -> f64,
    /// Added after the factor, (deg/h)²/Hz.
    pub added: &'a dyn Fn(f64) -> f64,
}

impl Oracle {
    /// Prepares the residual of a claim.
    pub fn new(claim: &Claim, columns: &Columns, residual: &[f64]) -> Oracle {
        let modes = Modes::of(residual, claim.rate_hz);
        let sigma: Vec<f64> =
            modes.frequency_hz.iter().map(|f| (claim.levels.density(*f) * claim.rate_hz).sqrt()).collect();
        let mut terms: Vec<Vec<f64>> = vec![];
        if let (Some([_, _, sd]), Some(deg_c)) = (claim.temperature, columns.get("temp_degC")) {
            terms.push(deg_c.iter().map(|t| sd * t).collect());
        }
        if let (Some([_, sd]), Some(rate)) = (claim.scale_ppm, columns.get("table_rate_deg_s")) {
            terms.push(rate.iter().map(|r| 3.6e-3 * sd * r).collect());
        }
        let linear = terms
            .iter()
            .map(|t| Modes::of(t, claim.rate_hz).value.iter().zip(&sigma).map(|(v, s)| v / s).collect());
        Oracle {
            rate_hz: claim.rate_hz,
            linear: linear.collect(),
            bands: bands(&modes.frequency_hz),
            residual: modes.value,
            sigma,
            levels: claim.levels,
            levels_rel: claim.levels_rel,
        }
    }

    /// Modes of a contribution.
    pub fn modes(&self, contribution: &[f64]) -> Vec<f64> {
        Modes::of(contribution, self.rate_hz).value
    }

    /// Gain of the oracle that knows the course of what was added, of which the modes are given.
    pub fn course_gain(&self, added: &[f64]) -> f64 {
        let with: Vec<f64> = self.residual.iter().zip(added).map(|(r, a)| r + a).collect();
        let told = self.likelihood(&self.residual, &self.claimed());
        told - self.likelihood(&with, &self.claimed())
    }

    /// Gain of the oracle that knows the density, where what was added is a random process of the given modes.
    pub fn law_gain(&self, added: &[f64], density: &Density) -> f64 {
        let with: Vec<f64> = self.residual.iter().zip(added).map(|(r, a)| r + a).collect();
        self.likelihood(&with, density) - self.likelihood(&with, &self.claimed())
    }

    /// Gain of the oracle that knows by how much the level of the noise differs from row to row.
    pub fn spread_gain(&self, added: &[f64], spread: &[f64]) -> f64 {
        let whitened: Vec<f64> =
            self.residual.iter().zip(added).zip(&self.sigma).map(|((r, a), s)| (r + a) / s).collect();
        let e = series_of(&whitened);
        let n = e.len() as f64;
        let mean_square = e.iter().map(|e| e * e).sum::<f64>() / n;
        let told: f64 = e.iter().zip(spread).map(|(e, g)| -g.ln() - 0.5 * e * e / (g * g)).sum();
        told + 0.5 * n * mean_square.ln() + 0.5 * n
    }

    /// Part of the variance of a contribution that the best linear estimate of its course predicts, where its density is
    /// known and its course is not.
    pub fn predictable(&self, added: &[f64]) -> f64 {
        let (mut missed, mut all) = (0.0, 0.0);
        for band in &self.bands {
            let width = (band.to - band.from) as f64;
            let power = added[band.from..band.to].iter().map(|a| a * a).sum::<f64>() / width;
            let modes = band.from..band.to;
            for ((a, r), sigma) in
                added[modes.clone()].iter().zip(&self.residual[modes.clone()]).zip(&self.sigma[modes])
            {
                let kept = power / (power + sigma * sigma);
                missed += (a - kept * (a + r)).powi(2);
                all += a * a;
            }
        }
        if all > 0.0 { (1.0 - missed / all).max(0.0) } else { 0.0 }
    }

    /// The residual over the claimed standard deviation, mode by mode.
    pub fn whitened(&self) -> Vec<f64> {
        self.residual.iter().zip(&self.sigma).map(|(r, s)| r / s).collect()
    }

    fn claimed(&self) -> Density<'static> {
        Density { levels: self.levels, factor: &|_| 1.0, added: &|_| 0.0 }
    }

    /// Penalised log-likelihood, its nuisances at their best.
    fn likelihood(&self, modes: &[f64], density: &Density) -> f64 {
        let (left, linear_cost) = self.without_linear(modes);
        let power: Vec<f64> =
            self.bands.iter().map(|b| left[b.from..b.to].iter().map(|x| x * x).sum::<f64>()).collect();
        self.fit_levels(&power, density) - linear_cost
    }

    /// Modes less the uncertain linear terms at their best under the claimed noise, and the cost of moving them.
    fn without_linear(&self, modes: &[f64]) -> (Vec<f64>, f64) {
        let mut left = modes.to_vec();
        let mut size = vec![0.0; self.linear.len()];
        // Turn by turn; at most two terms, nearly at right angles.
        for _ in 0..if self.linear.len() > 1 { 4 } else { 1 } {
            for (term, size) in self.linear.iter().zip(&mut size) {
                let (mut dot, mut norm) = (0.0, 1.0);
                for ((t, x), s) in term.iter().zip(&left).zip(&self.sigma) {
                    dot += t * x / s;
                    norm += t * t;
                }
                let step = (dot - *size) / norm;
                *size += step;
                left.iter_mut().zip(term).zip(&self.sigma).for_each(|((x, t), s)| *x -= step * t * s);
            }
        }
        (left, size.iter().map(|s| 0.5 * s * s).sum())
    }

    /// Likelihood of band powers with the levels moved within their uncertainties, by Fisher scoring with halved steps.
    ///
    /// A level moves by [`FARTHEST`] standard deviations at most: a claim that must move farther is wrong in its noise, and
    /// likelihood alone would let it.
    fn fit_levels(&self, power: &[f64], density: &Density) -> f64 {
        let parts: Vec<[f64; 4]> = self.bands.iter().map(|b| self.parts(b.frequency_hz, density)).collect();
        let most = self.levels_rel.map(|rel| FARTHEST * rel);
        let mut moved = [0.0f64; 3];
        let mut best = self.at(power, &parts, moved).0;
        for _ in 0..30 {
            let (_, mut gradient, mut fisher) = self.at(power, &parts, moved);
            for i in 0..3 {
                // At its limit and pushed outwards, a level stays.
                if moved[i].abs() >= most[i] && moved[i] * gradient[i] > 0.0 {
                    gradient[i] = 0.0;
                    fisher.iter_mut().for_each(|row| row[i] = 0.0);
                    fisher[i] = [0.0; 3];
                    fisher[i][i] = 1.0;
                }
            }
            let step = solve(fisher, gradient);
            let mut scale = 1.0;
            let mut improved = false;
            while scale > 1e-3 {
                let tried = [0, 1, 2].map(|i| (moved[i] + scale * step[i]).clamp(-most[i], most[i]));
                let value = self.at(power, &parts, tried).0;
                if value > best {
                    improved = value > best + 1e-4;
                    (best, moved) = (value, tried);
                    break;
                }
                scale *= 0.5;
            }
            if !improved {
                break;
            }
        }
        best
    }

    /// Variances of a mode due to N, B, K and the rest.
    fn parts(&self, frequency_hz: f64, density: &Density) -> [f64; 4] {
        let nothing = Levels { n: 0.0, b: 0.0, k: 0.0 };
        let of =
            |levels: Levels| (density.factor)(frequency_hz) * levels.density(frequency_hz) * self.rate_hz;
        let Levels { n, b, k } = density.levels;
        [
            of(Levels { n, ..nothing }),
            of(Levels { b, ..nothing }),
            of(Levels { k, ..nothing }),
            (density.added)(frequency_hz) * self.rate_hz,
        ]
    }

    /// Penalised likelihood, its gradient and its information over ln N, ln B, ln K.
    fn at(&self, power: &[f64], parts: &[[f64; 4]], moved: [f64; 3]) -> (f64, [f64; 3], [[f64; 3]; 3]) {
        let factor = moved.map(|m| (2.0 * m).exp());
        let (mut value, mut gradient, mut fisher) = (0.0, [0.0; 3], [[0.0; 3]; 3]);
        for ((band, part), power) in self.bands.iter().zip(parts).zip(power) {
            let count = (band.to - band.from) as f64;
            let share = [0, 1, 2].map(|i| part[i] * factor[i]);
            let variance = share.iter().sum::<f64>() + part[3];
            value -= 0.5 * (count * variance.ln() + power / variance);
            for i in 0..3 {
                gradient[i] += (power / variance - count) * share[i] / variance;
                for j in 0..3 {
                    fisher[i][j] += 2.0 * count * share[i] * share[j] / (variance * variance);
                }
            }
        }
        for i in 0..3 {
            // Levels are stated relative to their value: ln differs from that by little.
            let weight = self.levels_rel[i].max(1e-6).powi(-2);
            value -= 0.5 * moved[i] * moved[i] * weight;
            gradient[i] -= moved[i] * weight;
            fisher[i][i] += weight;
        }
        (value, gradient, fisher)
    }
}

/// The first 60 modes each by itself, then bands that widen by a fiftieth.
fn bands(frequency_hz: &[f64]) -> Vec<Band> {
    let (mut all, mut from) = (vec![], 0);
    while from < frequency_hz.len() {
        let to = (from + 1 + from / 50).min(frequency_hz.len());
        let middle = 0.5 * (frequency_hz[from] + frequency_hz[to - 1]);
        all.push(Band { from, to, frequency_hz: middle });
        from = to;
    }
    all
}

/// Solves three equations with a positive definite matrix, by elimination.
fn solve(mut m: [[f64; 3]; 3], mut y: [f64; 3]) -> [f64; 3] {
    for i in 0..3 {
        let pivot = m[i];
        for j in i + 1..3 {
            let f = m[j][i] / pivot[i];
            m[j].iter_mut().zip(pivot).for_each(|(a, p)| *a -= f * p);
            y[j] -= f * y[i];
        }
    }
    for i in (0..3).rev() {
        let known: f64 = (i + 1..3).map(|c| m[i][c] * y[c]).sum();
        y[i] = (y[i] - known) / m[i][i];
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::bench::Bench;
    use crate::laboratory::dice::Dice;

    #[test]
    fn the_gain_of_a_fast_course_is_that_of_the_matched_filter() {
        let bench = Bench::new(Dice::new(11));
        let oracle = Oracle::new(&bench.claim, &bench.columns, &bench.residual());
        // Far above the corner of flicker: half the energy over the variance, give or take its root.
        let sigma = 60.0 * bench.right.levels.n * bench.rate_hz.sqrt();
        let course: Vec<f64> = (0..bench.rows).map(|i| 0.1 * sigma * (2.0 * i as f64).sin()).collect();
        let expected = 0.25 * 0.01 * bench.rows as f64;
        let gain = oracle.course_gain(&oracle.modes(&course));
        assert!((gain - expected).abs() < 4.0 * (2.0 * expected).sqrt(), "{gain} {expected}");
    }

    #[test]
    fn nothing_is_gained_from_nothing() {
        let bench = Bench::new(Dice::new(12));
        let oracle = Oracle::new(&bench.claim, &bench.columns, &bench.residual());
        assert_eq!(oracle.course_gain(&vec![0.0; bench.rows - 1]), 0.0);
    }

    #[test]
    fn what_the_claim_may_move_gains_nothing() {
        let mut bench = Bench::new(Dice::new(13));
        bench.turn(crate::laboratory::motion::Programme::Steps);
        let oracle = Oracle::new(&bench.claim, &bench.columns, &bench.residual());
        // A scale factor off by half of its uncertainty, against one off by fifty.
        let sd = bench.claim.scale_ppm.map_or(0.0, |[_, sd]| sd);
        let off = |sds: f64| -> f64 {
            let course: Vec<f64> =
                bench.columns["table_rate_deg_s"].iter().map(|r| 3.6e-3 * sds * sd * r).collect();
            oracle.course_gain(&oracle.modes(&course))
        };
        assert!(off(0.5).abs() < 2.0, "{}", off(0.5));
        // The likelihood is flat under a wide uncertainty, so that only moving it costs.
        assert!(off(50.0) > 500.0, "{}", off(50.0));
    }
}
