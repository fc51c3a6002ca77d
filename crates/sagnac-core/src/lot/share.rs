//! A share that was counted, such as a yield, with its interval.

use statrs::distribution::{Beta, ContinuousCDF};

/// Coverage of the interval.
pub const INTERVAL_COVERAGE: f64 = 0.95;

/// A share of a population, from how many of some there were.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// How many there were.
    pub count: usize,
    /// Of how many.
    pub of: usize,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Share {
    /// The share with its exact interval (Clopper and Pearson 1934). `None` of nothing, or of fewer than were counted.
    pub fn of(count: usize, of: usize) -> Option<Share> {
        if of == 0 || count > of {
            return None;
        }
        let (k, n) = (count as f64, of as f64);
        let tail = 0.5 * (1.0 - INTERVAL_COVERAGE);
        let low = if count == 0 { 0.0 } else { Beta::new(k, n - k + 1.0).ok()?.inverse_cdf(tail) };
        let high = if count == of { 1.0 } else { Beta::new(k + 1.0, n - k).ok()?.inverse_cdf(1.0 - tail) };
        Some(Share { count, of, low, high })
    }

    /// The share itself.
    pub fn value(&self) -> f64 {
        self.count as f64 / self.of as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_agree_with_published_ones() {
        // Brown, Cai and DasGupta 2001 and tables of Diem: 10 of 10, 0 of 10, 5 of 10, 1 of 20.
        for (count, of, low, high) in
            [(10, 10, 0.6915, 1.0), (0, 10, 0.0, 0.3085), (5, 10, 0.1871, 0.8129), (1, 20, 0.0013, 0.2487)]
        {
            let share = Share::of(count, of).unwrap();
            assert!((share.low - low).abs() < 6e-5 && (share.high - high).abs() < 6e-5, "{share:?}");
        }
        assert_eq!(Share::of(0, 0), None);
        assert_eq!(Share::of(2, 1), None);
    }
}
