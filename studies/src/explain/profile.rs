//! Functions of time made of straight pieces, with their integrals: what table, chamber and supply were set to do.

use super::draw::Draw;

/// A continuous function of straight pieces, constant before the first and after the last point.
#[derive(Clone, Debug)]
pub struct Profile {
    time_s: Vec<f64>,
    value: Vec<f64>,
    integral: Vec<f64>,
}

impl Profile {
    /// Through points of increasing time.
    pub fn new(points: &[(f64, f64)]) -> Profile {
        let (time_s, value): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        let mut integral = vec![0.0; value.len()];
        for i in 1..value.len() {
            integral[i] = integral[i - 1] + 0.5 * (value[i] + value[i - 1]) * (time_s[i] - time_s[i - 1]);
        }
        Profile { time_s, value, integral }
    }

    fn piece(&self, t: f64) -> Option<usize> {
        let after = self.time_s.partition_point(|&x| x <= t);
        (after > 0 && after < self.time_s.len()).then(|| after - 1)
    }

    /// Value at `t`.
    pub fn at(&self, t: f64) -> f64 {
        match self.piece(t) {
            Some(i) => {
                let w = (t - self.time_s[i]) / (self.time_s[i + 1] - self.time_s[i]);
                self.value[i] + w * (self.value[i + 1] - self.value[i])
            }
            None if t < self.time_s[0] => self.value[0],
            None => self.value[self.value.len() - 1],
        }
    }

    /// Integral from the first point to `t`.
    pub fn integral(&self, t: f64) -> f64 {
        let last = self.time_s.len() - 1;
        match self.piece(t) {
            Some(i) => self.integral[i] + 0.5 * (self.value[i] + self.at(t)) * (t - self.time_s[i]),
            None if t < self.time_s[0] => self.value[0] * (t - self.time_s[0]),
            None => self.integral[last] + self.value[last] * (t - self.time_s[last]),
        }
    }

    /// Mean over an interval of length `width` about `t`.
    pub fn mean(&self, t: f64, width: f64) -> f64 {
        (self.integral(t + 0.5 * width) - self.integral(t - 0.5 * width)) / width
    }

    /// Times of the points.
    pub fn corners(&self) -> &[f64] {
        &self.time_s
    }
}

/// Levels held in turn, with straight passages of at least `passage_s` between them; each held time varies by a third.
pub fn levels(draw: &mut Draw, duration_s: f64, values: &[f64], passage_s: f64) -> Profile {
    let share = duration_s / values.len() as f64;
    let mut points = vec![(-duration_s, values[0])];
    for (i, pair) in values.windows(2).enumerate() {
        let at = share * (i as f64 + 1.0 + draw.uniform(-0.3, 0.3));
        let width = passage_s.min(0.3 * share);
        points.push((at, pair[0]));
        points.push((at + width, pair[1]));
    }
    Profile::new(&points)
}
