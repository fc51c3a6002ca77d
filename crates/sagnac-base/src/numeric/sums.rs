//! Sums: with compensated rounding, and running ones.

/// A sum with Neumaier's compensation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Compensated {
    sum: f64,
    lost: f64,
}

impl Compensated {
    /// Adds a value.
    pub fn add(&mut self, value: f64) {
        let sum = self.sum + value;
        self.lost +=
            if self.sum.abs() >= value.abs() { (self.sum - sum) + value } else { (value - sum) + self.sum };
        self.sum = sum;
    }

    /// Adds another sum with what it has lost.
    pub fn add_sum(&mut self, other: Compensated) {
        self.add(other.sum);
        self.lost += other.lost;
    }

    /// The sum.
    pub fn value(self) -> f64 {
        self.sum + self.lost
    }
}

/// A sum and what rounding took from it (Knuth): together they are exact.
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_in = sum - a;
    (sum, (a - (sum - b_in)) + (b - b_in))
}

/// Running sums of values, beginning with 0: one more than there are values, so that the sum of values `a..b` is the
/// difference of sums `b` and `a`.
pub fn cumulated(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sum = 0.0;
    std::iter::once(0.0)
        .chain(values.map(|v| {
            sum += v;
            sum
        }))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compensation_keeps_small_terms() {
        let mut sum = Compensated::default();
        for v in [1e16, 1.0, 1.0, -1e16] {
            sum.add(v);
        }
        assert_eq!(sum.value(), 2.0);
    }

    #[test]
    fn what_rounding_takes_is_given_beside_the_sum() {
        assert_eq!(two_sum(1e15, 0.03), (1e15, 0.03));
        assert_eq!(two_sum(0.03, 1e15), (1e15, 0.03));
        assert_eq!(two_sum(1.0, 2.0), (3.0, 0.0));
    }

    #[test]
    fn running_sums_begin_with_zero() {
        assert_eq!(cumulated([2.0, -1.0, 4.0].into_iter()), [0.0, 2.0, 1.0, 5.0]);
    }

    #[test]
    fn a_sum_added_to_another_keeps_what_both_lost() {
        let sum = |values: [f64; 2]| {
            let mut sum = Compensated::default();
            values.into_iter().for_each(|v| sum.add(v));
            sum
        };
        let mut total = sum([1e16, 1.0]);
        total.add_sum(sum([-1e16, 1.0]));
        assert_eq!(total.value(), 2.0);
    }
}
