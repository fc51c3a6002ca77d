//! The record as at most 2^18 block means on its uniform grid: what slow noise is identified on.

use super::data::BlockSeries;
use super::phase::two_sum;

/// Blocks that remain at most.
pub const MAX_BLOCKS: usize = 1 << 18;

/// Streaming block means. Blocks are aligned to the grid index; where more than [`MAX_BLOCKS`] would remain,
/// neighbours are merged.
#[derive(Debug, Clone)]
pub struct BlockSeriesAccumulator {
    /// log2 of the samples in a block.
    shift: u32,
    /// Number of the first block, in blocks from grid index 0.
    first_block: u64,
    /// Sum of deviations from the reference, and count.
    blocks: Vec<(f64, u64)>,
    most: usize,
    reference: f64,
}

/// Indices beyond are taken for this one, so that they can be added to.
const LAST_INDEX: u64 = 1 << 62;

impl Default for BlockSeriesAccumulator {
    fn default() -> Self {
        Self::with_max_blocks(MAX_BLOCKS)
    }
}

impl BlockSeriesAccumulator {
    /// An empty accumulator that keeps at most `most` blocks (at least 2).
    pub fn with_max_blocks(most: usize) -> Self {
        BlockSeriesAccumulator { shift: 0, first_block: 0, blocks: vec![], most: most.max(2), reference: 0.0 }
    }

    /// Takes finite contiguous samples from grid index `first_index` on; indices never go back.
    pub fn push(&mut self, samples: &[f64], first_index: u64) {
        let Some(first) = samples.first() else { return };
        let first_index = first_index.min(LAST_INDEX);
        if self.blocks.is_empty() {
            self.reference = *first;
            self.first_block = first_index >> self.shift;
        }
        let first_index = first_index.max(self.first_block << self.shift);
        let last = first_index.saturating_add(samples.len() as u64 - 1);
        while (last >> self.shift) - self.first_block >= self.most as u64 {
            self.halve();
        }
        let needed = ((last >> self.shift) - self.first_block) as usize + 1;
        if self.blocks.len() < needed {
            self.blocks.resize(needed, (0.0, 0));
        }
        let mut rest = samples;
        let mut at = first_index;
        while !rest.is_empty() {
            let block = at >> self.shift;
            let room = ((block + 1) << self.shift) - at;
            let (now, later) = rest.split_at((room as usize).min(rest.len()));
            if let Some(slot) = self.blocks.get_mut((block - self.first_block) as usize) {
                slot.0 += now.iter().map(|y| y - self.reference).sum::<f64>();
                slot.1 += now.len() as u64;
            }
            at += now.len() as u64;
            rest = later;
        }
    }

    /// Adds what another part of the recording left, on the same grid. Counts are those of one pass, means agree to rounding.
    pub fn merge(&mut self, other: &BlockSeriesAccumulator) {
        if other.blocks.is_empty() {
            return;
        }
        if self.blocks.is_empty() {
            let most = self.most;
            *self = other.clone();
            self.most = most;
            while self.blocks.len() > most {
                self.halve();
            }
            return;
        }
        let mut other = other.clone();
        if self.first_block << self.shift > other.first_block << other.shift {
            std::mem::swap(self, &mut other);
            self.most = other.most;
        }
        while self.shift < other.shift {
            self.halve();
        }
        while other.shift < self.shift {
            other.halve();
        }
        let end = |blocks: &Self| blocks.first_block + blocks.blocks.len() as u64;
        while end(self).max(end(&other)) - self.first_block > self.most as u64 {
            self.halve();
            other.halve();
        }
        let needed = (end(self).max(end(&other)) - self.first_block) as usize;
        self.blocks.resize(needed, (0.0, 0));
        let from = (other.first_block - self.first_block) as usize;
        let apart = other.reference - self.reference;
        for (slot, (sum, n)) in self.blocks.iter_mut().skip(from).zip(other.blocks) {
            slot.0 += sum + n as f64 * apart;
            slot.1 += n;
        }
    }

    /// The block means so far.
    pub fn finish(&self) -> BlockSeries {
        let (mean, rounding) = self
            .blocks
            .iter()
            .map(|(sum, n)| if *n == 0 { (f64::NAN, 0.0) } else { two_sum(self.reference, sum / *n as f64) })
            .unzip();
        BlockSeries {
            block_len: 1 << self.shift,
            first_index: self.first_block << self.shift,
            mean,
            count: self.blocks.iter().map(|b| u32::try_from(b.1).unwrap_or(u32::MAX)).collect(),
            rounding,
        }
    }

    /// Joins neighbouring blocks.
    fn halve(&mut self) {
        let odd = self.first_block & 1;
        let merged = (self.blocks.len() + odd as usize).div_ceil(2);
        let mut out = vec![(0.0, 0); merged];
        for (k, (sum, n)) in self.blocks.iter().enumerate() {
            if let Some(slot) = out.get_mut((k + odd as usize) / 2) {
                slot.0 += sum;
                slot.1 += n;
            }
        }
        self.blocks = out;
        self.first_block >>= 1;
        self.shift += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_aligned_and_gaps_are_empty() {
        let mut acc = BlockSeriesAccumulator::with_max_blocks(4);
        acc.push(&[1.0, 2.0, 3.0], 5);
        acc.push(&[7.0], 11);
        acc.push(&[9.0, 11.0], 14);
        // Grid 4..16 in blocks of 4: (1 2 3), (7), (9 11).
        let series = acc.finish();
        assert_eq!((series.block_len, series.first_index), (4, 4));
        assert_eq!(series.mean, vec![2.0, 7.0, 10.0]);
        assert_eq!(series.count, vec![3, 1, 2]);
    }

    #[test]
    fn a_gap_leaves_a_block_without_a_mean() {
        let mut acc = BlockSeriesAccumulator::default();
        acc.push(&[1.0], 3);
        acc.push(&[2.0], 5);
        let series = acc.finish();
        assert!(series.mean[1].is_nan() && series.count == vec![1, 0, 1]);
        acc.push(&[5.0], 1 << 61);
        let far = acc.finish();
        assert!(far.mean.len() <= MAX_BLOCKS);
        assert_eq!(far.count.iter().map(|c| u64::from(*c)).sum::<u64>(), 3);
    }

    #[test]
    fn means_of_a_long_record_are_those_of_its_blocks() {
        let mut acc = BlockSeriesAccumulator::default();
        let y: Vec<f64> = (0..1_000_000u32).map(|i| 1e6 + f64::from(i % 1000)).collect();
        for (k, block) in y.chunks(12_345).enumerate() {
            acc.push(block, 12_345 * k as u64);
        }
        let series = acc.finish();
        assert_eq!(series.block_len, 4);
        for (block, mean) in y.chunks(4).zip(&series.mean) {
            assert!((block.iter().sum::<f64>() / 4.0 - mean).abs() < 1e-8);
        }
    }
}
