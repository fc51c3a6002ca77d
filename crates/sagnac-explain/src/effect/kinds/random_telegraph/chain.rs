//! A hidden Markov chain of two levels in white noise: Baum-Welch for its numbers, Viterbi for its path.

use nalgebra::DMatrix;

/// The numbers of a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chain {
    /// The two levels.
    pub levels: [f64; 2],
    /// Variance of the noise about them.
    pub variance: f64,
    /// Probability of a change from each level, a step.
    pub change: [f64; 2],
}

/// Standard deviations of the estimated properties of a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviations {
    /// Of the distance of the levels.
    pub apart: f64,
    /// Of the logarithm of the mean dwell.
    pub log_dwell: f64,
}

impl Chain {
    /// Standing probability of each level.
    fn standing(&self) -> [f64; 2] {
        let sum = (self.change[0] + self.change[1]).max(1e-300);
        [self.change[1] / sum, self.change[0] / sum]
    }

    /// Distance of the levels.
    pub fn apart(&self) -> f64 {
        (self.levels[1] - self.levels[0]).abs()
    }

    /// The chain of a known path whose second level is `size` above the first, about a mean.
    pub fn of_path(&self, path: &[bool], size: f64, mean: f64) -> Chain {
        let of = |level: bool| {
            let stays = path.iter().filter(|p| **p == level).count() as f64;
            let leaves = path.windows(2).filter(|w| w[0] == level && w[1] != level).count() as f64;
            ((leaves + 0.5) / (stays + 1.0)).clamp(0.25 / path.len().max(1) as f64, 0.5)
        };
        let share = path.iter().filter(|p| **p).count() as f64 / path.len().max(1) as f64;
        let levels = [mean - share * size, mean + (1.0 - share) * size];
        Chain { levels, change: [of(false), of(true)], ..*self }
    }

    fn weights(&self, y: f64) -> [f64; 2] {
        let d = self.levels.map(|l| -(y - l) * (y - l) / (2.0 * self.variance));
        let top = d[0].max(d[1]);
        // A floor keeps a value far from both levels from ending the recursion.
        d.map(|x| (x - top).exp().max(1e-300))
    }

    /// Probability of each level at each value, given the values up to it.
    fn forward(&self, values: &[f64]) -> Vec<[f64; 2]> {
        let stay = [1.0 - self.change[0], 1.0 - self.change[1]];
        let mut forward: Vec<[f64; 2]> = Vec::with_capacity(values.len());
        let mut last = self.standing();
        for (i, y) in values.iter().enumerate() {
            let w = self.weights(*y);
            let prior = if i == 0 {
                last
            } else {
                [last[0] * stay[0] + last[1] * self.change[1], last[0] * self.change[0] + last[1] * stay[1]]
            };
            let a = [prior[0] * w[0], prior[1] * w[1]];
            let sum = (a[0] + a[1]).max(1e-300);
            last = [a[0] / sum, a[1] / sum];
            forward.push(last);
        }
        forward
    }

    /// Probability of the upper level at each value, given all.
    pub fn posterior(&self, values: &[f64]) -> Vec<f64> {
        let forward = self.forward(values);
        let mut out = vec![0.0; values.len()];
        let mut back = [1.0, 1.0];
        for i in (0..values.len()).rev() {
            let p = [forward[i][0] * back[0], forward[i][1] * back[1]];
            out[i] = p[1] / (p[0] + p[1]).max(1e-300);
            let w = self.weights(values[i]);
            let next = [
                (1.0 - self.change[0]) * w[0] * back[0] + self.change[0] * w[1] * back[1],
                self.change[1] * w[0] * back[0] + (1.0 - self.change[1]) * w[1] * back[1],
            ];
            let scale = next[0].max(next[1]).max(1e-300);
            back = [next[0] / scale, next[1] / scale];
        }
        out
    }

    /// One turn of Baum-Welch. The variance stays at or above `floor`.
    pub fn improved(&self, values: &[f64], floor: f64) -> Chain {
        let n = values.len();
        let stay = [1.0 - self.change[0], 1.0 - self.change[1]];
        let forward = self.forward(values);
        let mut back = [1.0, 1.0];
        let (mut mass, mut sum, mut square) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        let (mut changes, mut left) = ([0.0; 2], [0.0; 2]);
        for i in (0..n).rev() {
            let p = [forward[i][0] * back[0], forward[i][1] * back[1]];
            let total = (p[0] + p[1]).max(1e-300);
            for s in 0..2 {
                let q = p[s] / total;
                mass[s] += q;
                sum[s] += q * values[i];
                square[s] += q * values[i] * values[i];
            }
            if i == 0 {
                break;
            }
            let w = self.weights(values[i]);
            let f = forward[i - 1];
            let kept = [f[0] * stay[0] * w[0] * back[0], f[1] * stay[1] * w[1] * back[1]];
            let moved = [f[0] * self.change[0] * w[1] * back[1], f[1] * self.change[1] * w[0] * back[0]];
            let total = (kept[0] + kept[1] + moved[0] + moved[1]).max(1e-300);
            for s in 0..2 {
                changes[s] += moved[s] / total;
                left[s] += (kept[s] + moved[s]) / total;
            }
            let next = [
                stay[0] * w[0] * back[0] + self.change[0] * w[1] * back[1],
                self.change[1] * w[0] * back[0] + stay[1] * w[1] * back[1],
            ];
            let scale = next[0].max(next[1]).max(1e-300);
            back = [next[0] / scale, next[1] / scale];
        }
        let mut out = *self;
        let mut spread = 0.0;
        for s in 0..2 {
            if mass[s] > 1e-9 {
                out.levels[s] = sum[s] / mass[s];
                spread += square[s] - sum[s] * out.levels[s];
            }
            // Half a change is added so that no level becomes a trap.
            out.change[s] = ((changes[s] + 0.5) / (left[s] + 1.0)).clamp(0.25 / n as f64, 0.5);
        }
        out.variance = (spread / n as f64).max(floor);
        out
    }

    /// The same chain in steps `times` shorter.
    pub fn finer(&self, times: usize) -> Chain {
        let f = times.max(1) as f64;
        Chain { variance: self.variance * f, change: self.change.map(|c| c / f), ..*self }
    }

    /// Mean time at a level, in steps. Changes within a step go unseen: rates follow from the relaxation of the chain.
    pub fn dwell(&self) -> f64 {
        let [a, b] = self.change;
        let sum = (a + b).clamp(1e-12, 0.999);
        let rate = -(-sum).ln_1p() / sum;
        0.5 * (1.0 / (rate * a) + 1.0 / (rate * b))
    }

    /// Standard deviations of the difference of the levels and of the logarithm of the mean dwell, from the curvature
    /// of the likelihood; `None` where it has no top there.
    pub fn deviations(&self, values: &[f64]) -> Option<Deviations> {
        const P: usize = 5;
        let n = values.len() as f64;
        let changes = (n / self.dwell()).max(1.0);
        let steps = [
            (2.0 * self.variance / n).sqrt(),
            (2.0 * self.variance / n).sqrt(),
            0.5 / changes.sqrt(),
            0.5 / changes.sqrt(),
            1.0 / n.sqrt(),
        ];
        let moved = |x: [f64; P]| Chain {
            levels: [self.levels[0] + x[0], self.levels[1] + x[1]],
            change: [(self.change[0] * x[2].exp()).min(0.999), (self.change[1] * x[3].exp()).min(0.999)],
            variance: self.variance * x[4].exp(),
        };
        let value = |i: usize, a: f64, j: usize, b: f64| {
            let mut x = [0.0; P];
            x[i] += a * steps[i];
            x[j] += b * steps[j];
            moved(x).log_likelihood(values)
        };
        let top = self.log_likelihood(values);
        let curvature = DMatrix::from_fn(P, P, |i, j| {
            let second = if i == j {
                value(i, 1.0, i, 0.0) + value(i, -1.0, i, 0.0) - 2.0 * top
            } else {
                let same = value(i, 1.0, j, 1.0) + value(i, -1.0, j, -1.0);
                0.25 * (same - value(i, 1.0, j, -1.0) - value(i, -1.0, j, 1.0))
            };
            -second / (steps[i] * steps[j])
        });
        let covariance = curvature.cholesky()?.inverse();
        let size = covariance[(0, 0)] + covariance[(1, 1)] - 2.0 * covariance[(0, 1)];
        let slope = |i: usize| {
            let mut x = [0.0; P];
            x[i] = 1e-4;
            (moved(x).dwell() / self.dwell()).ln() / 1e-4
        };
        let (a, b) = (slope(2), slope(3));
        let dwell =
            a * a * covariance[(2, 2)] + b * b * covariance[(3, 3)] + 2.0 * a * b * covariance[(2, 3)];
        Some(Deviations { apart: size.max(0.0).sqrt(), log_dwell: dwell.max(0.0).sqrt() })
    }

    /// ln of the probability of the values, whatever the path.
    pub fn log_likelihood(&self, values: &[f64]) -> f64 {
        let stay = [1.0 - self.change[0], 1.0 - self.change[1]];
        let mut state = self.standing();
        let mut sum = -0.5 * values.len() as f64 * (std::f64::consts::TAU * self.variance).ln();
        for (i, y) in values.iter().enumerate() {
            if i > 0 {
                state = [
                    state[0] * stay[0] + state[1] * self.change[1],
                    state[0] * self.change[0] + state[1] * stay[1],
                ];
            }
            let d = self.levels.map(|l| -(y - l) * (y - l) / (2.0 * self.variance));
            let top = d[0].max(d[1]);
            let w = d.map(|x| (x - top).exp());
            let total = (state[0] * w[0] + state[1] * w[1]).max(1e-300);
            state = [state[0] * w[0] / total, state[1] * w[1] / total];
            sum += top + total.ln();
        }
        sum
    }

    /// The most probable path.
    pub fn path(&self, values: &[f64]) -> Vec<bool> {
        let log = |p: f64| p.max(1e-300).ln();
        let stay = [log(1.0 - self.change[0]), log(1.0 - self.change[1])];
        let change = [log(self.change[0]), log(self.change[1])];
        let emit = |y: f64| self.levels.map(|l| -(y - l) * (y - l) / (2.0 * self.variance));
        let mut score = self.standing().map(log);
        let mut came: Vec<[bool; 2]> = Vec::with_capacity(values.len());
        for (i, y) in values.iter().enumerate() {
            let e = emit(*y);
            if i == 0 {
                score = [score[0] + e[0], score[1] + e[1]];
                came.push([false, true]);
                continue;
            }
            let (a, b) = (score[0] + stay[0], score[1] + change[1]);
            let (c, d) = (score[0] + change[0], score[1] + stay[1]);
            came.push([b > a, d >= c]);
            score = [a.max(b) + e[0], c.max(d) + e[1]];
        }
        let mut up = score[1] > score[0];
        let mut out = vec![false; values.len()];
        for i in (0..values.len()).rev() {
            out[i] = up;
            up = came[i][usize::from(up)];
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clear_path_is_found_exactly_and_holds_the_likelihood() {
        let path: Vec<bool> = (0..900).map(|i| i / 90 % 2 == 1).collect();
        // Steps of 1 with a deterministic ripple of ±0.2.
        let ripple = |i: usize| if i.is_multiple_of(2) { 0.2 } else { -0.2 };
        let values: Vec<f64> =
            path.iter().enumerate().map(|(i, p)| f64::from(u8::from(*p)) + ripple(i)).collect();
        let mut chain = Chain { levels: [0.3, 0.7], variance: 0.1, change: [0.05, 0.05] };
        for _ in 0..40 {
            chain = chain.improved(&values, 1e-4);
        }
        assert_eq!(chain.path(&values), path);
        assert!((chain.levels[1] - chain.levels[0] - 1.0).abs() < 1e-3, "{chain:?}");
        assert!((chain.variance - 0.04).abs() < 1e-3, "{chain:?}");
        // Nearly all of the likelihood is that path's: begun at a level that stands two thirds of the time, five changes up
        // in 450 steps, four down in 449, and every value 0.2 beside its level.
        let fair = Chain { levels: [0.0, 1.0], variance: 0.04, change: [0.01, 0.02] };
        let jumps = (2.0f64 / 3.0).ln() + 5.0 * 0.01f64.ln() + 4.0 * 0.02f64.ln();
        let stays = 445.0 * 0.99f64.ln() + 445.0 * 0.98f64.ln();
        let noise = -450.0 * (1.0 + (std::f64::consts::TAU * 0.04).ln());
        let all = fair.log_likelihood(&values);
        assert!((0.0..0.1).contains(&(all - jumps - stays - noise)), "{all}");
    }

    #[test]
    fn levels_are_known_as_two_means_and_the_dwell_as_its_count_of_changes() {
        let ripple = |i: usize| if i.is_multiple_of(2) { 0.2 } else { -0.2 };
        let values: Vec<f64> = (0..900).map(|i| f64::from(u8::from(i / 90 % 2 == 1)) + ripple(i)).collect();
        let start = Chain { levels: [0.1, 0.9], variance: 0.04, change: [0.01, 0.01] };
        let chain = (0..60).fold(start, |c, _| c.improved(&values, 1e-4));
        let Deviations { apart, log_dwell } = chain.deviations(&values).unwrap();
        // Two means of 450 values of variance 0.04; half of the mean of five changes up and four down.
        assert!((apart / (2.0 * 0.04f64 / 450.0).sqrt() - 1.0).abs() < 0.02, "{apart}");
        assert!((log_dwell / (0.25f64 * (1.0 / 5.0 + 1.0 / 4.0)).sqrt() - 1.0).abs() < 0.2, "{log_dwell}");
    }
}
