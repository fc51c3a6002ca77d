//! A hidden Markov chain of two levels in white noise: Baum-Welch for its numbers, Viterbi for its path.

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

impl Chain {
    /// Standing probability of each level.
    fn standing(&self) -> [f64; 2] {
        let sum = (self.change[0] + self.change[1]).max(1e-300);
        [self.change[1] / sum, self.change[0] / sum]
    }

    fn weights(&self, y: f64) -> [f64; 2] {
        let d = self.levels.map(|l| -(y - l) * (y - l) / (2.0 * self.variance));
        let top = d[0].max(d[1]);
        // A floor keeps a value far from both levels from ending the recursion.
        d.map(|x| (x - top).exp().max(1e-300))
    }

    /// One turn of Baum-Welch. The variance stays at or above `floor`.
    pub fn improved(&self, values: &[f64], floor: f64) -> Chain {
        let n = values.len();
        let stay = [1.0 - self.change[0], 1.0 - self.change[1]];
        let mut forward: Vec<[f64; 2]> = Vec::with_capacity(n);
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

/// −ln of the probability of a path under its own rates of change, and its jumps.
pub fn path_cost(path: &[bool]) -> (f64, usize) {
    let mut stays = [[0.0f64; 2]; 2];
    for w in path.windows(2) {
        stays[usize::from(w[0])][usize::from(w[1])] += 1.0;
    }
    let mut cost = std::f64::consts::LN_2;
    for row in stays {
        let sum = row[0] + row[1];
        for count in row.into_iter().filter(|c| *c > 0.0) {
            cost -= count * (count / sum).ln();
        }
    }
    (cost, (stays[0][1] + stays[1][0]) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clear_path_is_found_exactly_and_costs_its_entropy() {
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
        let (cost, jumps) = path_cost(&path);
        assert_eq!(jumps, 9);
        // Binary entropies: 450 steps from below with 5 changes, 449 from above with 4.
        let h = |n: f64, k: f64| -(k * (k / n).ln() + (n - k) * ((n - k) / n).ln());
        assert!((cost - (h(450.0, 5.0) + h(449.0, 4.0) + 2f64.ln())).abs() < 1e-9);
    }
}
