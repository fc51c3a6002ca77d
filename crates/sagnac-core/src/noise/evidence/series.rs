//! Block means with counts, at one averaging time.

use crate::noise::data::BlockSeries;

/// Blocks with less than this share of their samples count as empty.
const MIN_FILLING: f64 = 0.125;
/// Shortest stretch of blocks that is transformed on its own.
pub(super) const MIN_STRETCH: usize = 16;

/// Block means with counts, at one averaging time.
pub(super) struct Series {
    pub(super) tau_s: f64,
    /// Means less the first one.
    pub(super) mean: Vec<f64>,
    pub(super) count: Vec<f64>,
    pub(super) full: f64,
}

impl Series {
    pub(super) fn new(blocks: &BlockSeries, tau0_s: f64) -> Series {
        let full = blocks.block_len.max(1) as f64;
        let usable = |m: f64, c: u32| m.is_finite() && c > 0 && f64::from(c) >= MIN_FILLING * full;
        let pairs: Vec<(f64, f64)> = blocks
            .about_first()
            .into_iter()
            .zip(&blocks.count)
            .map(|(m, &c)| if usable(m, c) { (m, f64::from(c)) } else { (0.0, 0.0) })
            .collect();
        Series {
            tau_s: full * tau0_s,
            mean: pairs.iter().map(|p| p.0).collect(),
            count: pairs.iter().map(|p| p.1).collect(),
            full,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.mean.len()
    }

    pub(super) fn samples(&self) -> f64 {
        self.count.iter().sum()
    }

    /// Without empty blocks at the two ends; `None` when too little is left.
    pub(super) fn trimmed(mut self) -> Option<Series> {
        let first = self.count.iter().position(|c| *c > 0.0)?;
        let last = self.count.iter().rposition(|c| *c > 0.0)?;
        self.mean = self.mean.get(first..=last)?.to_vec();
        self.count = self.count.get(first..=last)?.to_vec();
        (self.len() >= MIN_STRETCH).then_some(self)
    }

    pub(super) fn is_whole(&self) -> bool {
        self.count.iter().all(|c| *c > 0.0)
    }

    /// Means over `factor` blocks; a rest at the end is left out.
    pub(super) fn merged(&self, factor: usize) -> Series {
        let full = self.full * factor as f64;
        let pairs = self.mean.chunks_exact(factor).zip(self.count.chunks_exact(factor)).map(|(m, c)| {
            let count: f64 = c.iter().sum();
            let sum: f64 = m.iter().zip(c).map(|(m, c)| m * c).sum();
            if count >= MIN_FILLING * full { (sum / count, count) } else { (0.0, 0.0) }
        });
        let (mean, count) = pairs.unzip();
        Series { tau_s: self.tau_s * factor as f64, mean, count, full }
    }

    /// Ranges of blocks without an empty one, at least [`MIN_STRETCH`] long.
    pub(super) fn stretches(&self) -> Vec<std::ops::Range<usize>> {
        let mut out = vec![];
        let mut start = None;
        for i in 0..=self.len() {
            match (self.count.get(i).is_some_and(|c| *c > 0.0), start) {
                (true, None) => start = Some(i),
                (false, Some(s)) => {
                    if i - s >= MIN_STRETCH {
                        out.push(s..i);
                    }
                    start = None;
                }
                _ => {}
            }
        }
        out
    }
}
