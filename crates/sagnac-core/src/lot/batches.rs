//! The bound of a few batches by analysis of variance, as handbooks of materials have it: a check of [`super::population`]
//! by another way.

use super::tolerance::{Promise, normal_factor};

/// The analysis of variance of batches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Batches {
    /// Number of batches.
    pub batches: usize,
    /// Number of values.
    pub values: usize,
    /// Effective size of a batch.
    pub effective_size: f64,
    /// Mean square between batches.
    pub between: f64,
    /// Mean square within batches.
    pub within: f64,
}

impl Batches {
    /// The analysis of values by batch; `None` below two batches or without a value to spare.
    pub fn of(batches: &[Vec<f64>]) -> Option<Batches> {
        let filled: Vec<&Vec<f64>> = batches.iter().filter(|b| !b.is_empty()).collect();
        let (k, n) = (filled.len(), filled.iter().map(|b| b.len()).sum::<usize>());
        if k < 2 || n <= k {
            return None;
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let all = filled.iter().flat_map(|b| b.iter()).sum::<f64>() / n as f64;
        let between: f64 = filled.iter().map(|b| b.len() as f64 * (mean(b) - all).powi(2)).sum();
        let within: f64 = filled.iter().map(|b| b.iter().map(|v| (v - mean(b)).powi(2)).sum::<f64>()).sum();
        let squares: f64 = filled.iter().map(|b| (b.len() as f64).powi(2)).sum();
        Some(Batches {
            batches: k,
            values: n,
            effective_size: (n as f64 - squares / n as f64) / (k as f64 - 1.0),
            between: between / (k as f64 - 1.0),
            within: within / (n - k) as f64,
        })
    }

    /// How far below the mean the one-sided bound lies (CMH-17-1G, 8.3.11.2.2). `None` where no promise can be made.
    pub fn distance(&self, promise: Promise) -> Option<f64> {
        let (size, batches, values) = (self.effective_size, self.batches as f64, self.values as f64);
        let ratio = self.between / self.within;
        let share = (ratio / (ratio + size - 1.0)).sqrt();
        let deviation = (self.between / size + (size - 1.0) / size * self.within).sqrt();
        let pooled = normal_factor(values, values - 1.0, promise)?;
        let apart = normal_factor(batches, batches - 1.0, promise)?;
        let root = size.sqrt();
        let factor = (pooled - apart / root + (apart - pooled) * share) / (1.0 - 1.0 / root);
        Some(factor * deviation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bounds_of_the_published_example_are_as_far_apart() {
        // Three batches of 7, 7 and 6; the published lower bounds are 63.2028 (90/95) and 34.5776 (99/95).
        let example =
            Batches { batches: 3, values: 20, effective_size: 6.65, between: 304.4270, within: 37.69238 };
        let at = |proportion| example.distance(Promise { proportion, confidence: 0.95 }).unwrap();
        let apart = at(0.99) - at(0.90);
        assert!((apart - (63.2028 - 34.5776)).abs() < 2e-3, "{apart}");
    }

    #[test]
    fn the_analysis_of_variance_by_hand() {
        let found = Batches::of(&[vec![1.0, 3.0], vec![5.0, 7.0], vec![]]).unwrap();
        let expected = Batches { batches: 2, values: 4, effective_size: 2.0, between: 16.0, within: 2.0 };
        assert_eq!(found, expected);
        let sizes = Batches::of(&[vec![0.0; 7], vec![1.0; 7], vec![2.0; 6]]).unwrap();
        assert!((sizes.effective_size - 6.65).abs() < 1e-12);
        assert_eq!(Batches::of(&[vec![1.0], vec![2.0]]), None);
        assert_eq!(Batches::of(&[vec![1.0, 2.0]]), None);
    }
}
