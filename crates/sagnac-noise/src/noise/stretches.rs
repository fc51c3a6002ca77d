//! How long the unbroken parts of a record are: what degrees of freedom follow from.

use std::collections::BTreeMap;

/// Kinds of length that are told apart; beyond, lengths are rounded down to 1/64.
const MAX_LENGTHS: usize = 4096;

/// Lengths of unbroken stretches of samples with their numbers, in bounded memory.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct StretchLengths {
    lengths: BTreeMap<u64, u64>,
    samples: u64,
    longest: u64,
    rounded: bool,
}

impl StretchLengths {
    /// One stretch.
    pub fn of(samples: u64) -> Self {
        let mut stretches = StretchLengths::default();
        stretches.add(samples);
        stretches
    }

    /// Adds a stretch; an empty one is no stretch.
    pub fn add(&mut self, samples: u64) {
        if samples == 0 {
            return;
        }
        self.samples += samples;
        self.longest = self.longest.max(samples);
        let length = if self.rounded { rounded(samples) } else { samples };
        *self.lengths.entry(length).or_default() += 1;
        if self.lengths.len() > MAX_LENGTHS && !self.rounded {
            self.round();
        }
    }

    /// Adds the stretches of another part, none of which goes on in this one.
    pub fn merge(&mut self, other: &StretchLengths) {
        self.samples += other.samples;
        self.longest = self.longest.max(other.longest);
        for (length, count) in &other.lengths {
            *self.lengths.entry(*length).or_default() += count;
        }
        if other.rounded || self.rounded || self.lengths.len() > MAX_LENGTHS {
            self.round();
        }
    }

    fn round(&mut self) {
        self.rounded = true;
        let mut coarse = BTreeMap::new();
        for (length, count) in std::mem::take(&mut self.lengths) {
            *coarse.entry(rounded(length)).or_default() += count;
        }
        self.lengths = coarse;
    }

    /// Samples in all stretches.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Length of the longest stretch, samples.
    pub fn longest(&self) -> u64 {
        self.longest
    }

    /// Number of stretches.
    pub fn count(&self) -> u64 {
        self.lengths.values().sum()
    }

    /// (length in samples, number of stretches of it), ascending. Exact up to 4096 different lengths, else within 1/64
    /// below.
    pub fn iter(&self) -> impl Iterator<Item = (u64, u64)> + '_ {
        self.lengths.iter().map(|(n, count)| (*n, *count))
    }
}

fn rounded(samples: u64) -> u64 {
    let step = 1 << samples.max(64).ilog2().saturating_sub(6);
    samples / step * step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_bounded_and_totals_stay_exact() {
        let mut s = StretchLengths::default();
        (0..20_000).for_each(|n| s.add(n));
        assert_eq!((s.samples(), s.longest(), s.count()), (19_999 * 10_000, 19_999, 19_999));
        assert!(s.iter().count() < MAX_LENGTHS);
        let kept: u64 = s.iter().map(|(n, c)| n * c).sum();
        assert!(kept <= s.samples() && kept as f64 > 0.984 * s.samples() as f64);
    }
}
