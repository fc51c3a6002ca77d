//! Groups of values set against each other, such as those of the stations of a line.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Coverage of all intervals together.
pub const FAMILY_COVERAGE: f64 = 0.95;

/// Mean of a group less that of all other values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Difference of the means.
    pub value: f64,
    /// Half width of its interval.
    pub half_width: f64,
}

impl Difference {
    /// True where the interval does not hold zero.
    pub fn is_shown(&self) -> bool {
        self.value.abs() > self.half_width
    }
}

/// Each group against all others together (Welch 1947). The intervals of all groups hold together with [`FAMILY_COVERAGE`]
/// (Bonferroni). `None` for a group of fewer than two values, or whose others are.
pub fn against_others(groups: &[Vec<f64>]) -> Vec<Option<Difference>> {
    let each = |i: usize| -> Option<Difference> {
        let own = groups.get(i)?;
        let others: Vec<f64> =
            groups.iter().enumerate().filter(|(k, _)| *k != i).flat_map(|(_, g)| g.iter().copied()).collect();
        let (own, others) = (Moments::of(own)?, Moments::of(&others)?);
        let variance = own.of_mean + others.of_mean;
        let dof = variance * variance
            / (own.of_mean.powi(2) / (own.n - 1.0) + others.of_mean.powi(2) / (others.n - 1.0));
        let tail = (1.0 - FAMILY_COVERAGE) / (2.0 * groups.len() as f64);
        let reach = StudentsT::new(0.0, 1.0, dof).ok()?.inverse_cdf(1.0 - tail);
        Some(Difference { value: own.mean - others.mean, half_width: reach * variance.sqrt() })
    };
    (0..groups.len()).map(each).collect()
}

struct Moments {
    n: f64,
    mean: f64,
    of_mean: f64,
}

impl Moments {
    fn of(values: &[f64]) -> Option<Moments> {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
        (values.len() > 1 && variance > 0.0).then_some(Moments { n, mean, of_mean: variance / n })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_difference_of_two_groups_by_hand() {
        // Means 2 and 6, variances 1 and 4, sizes 3 and 3: u² = 5/3, 2.94 degrees of freedom; t at 1 − 0.05/4 is 4.2.
        let found = against_others(&[vec![1.0, 2.0, 3.0], vec![4.0, 6.0, 8.0]]);
        let first = found[0].unwrap();
        assert!((first.value + 4.0).abs() < 1e-12);
        let reach = first.half_width / (5.0_f64 / 3.0).sqrt();
        assert!((4.1..4.4).contains(&reach), "{reach}");
        assert_eq!(found[1].unwrap().value, 4.0);
        assert!(!first.is_shown());
    }

    #[test]
    fn a_group_that_stands_apart_is_shown_and_small_ones_are_not_compared() {
        let near = |center: f64| (0..20).map(|i| center + 0.1 * f64::from(i % 5)).collect::<Vec<f64>>();
        let found = against_others(&[near(0.0), near(0.0), near(1.0), vec![0.5]]);
        assert!(found[2].unwrap().is_shown());
        let alike = against_others(&[near(0.0), near(0.0), near(0.0)]);
        assert!(alike.iter().all(|d| d.is_some_and(|d| !d.is_shown())), "{alike:?}");
        assert_eq!(found[3], None);
    }
}
