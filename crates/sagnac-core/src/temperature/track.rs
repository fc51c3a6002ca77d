//! Block means of several channels on the grid of a recording, in memory that does not grow with it.

/// Blocks kept at most; beyond, neighbours are put together.
const MAX_BLOCKS: usize = 1 << 16;

/// Collects block means while a recording goes by.
#[derive(Debug, Clone)]
pub struct Track {
    tau0_s: f64,
    samples: u64,
    base: u64,
    started: bool,
    channels: Vec<Vec<(f64, u32)>>,
}

/// Block means of one channel; NaN where a block holds nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Means {
    /// Length of a block, s.
    pub block_s: f64,
    /// Samples of a full block.
    pub samples: u64,
    /// Start of the first block, s from the start of the recording.
    pub first_s: f64,
    /// Means by channel.
    pub values: Vec<Vec<f64>>,
}

impl Track {
    /// Collects `channels` channels sampled every `tau0_s` seconds. Blocks are of one second or one sample, whichever is longer.
    pub fn new(channels: usize, tau0_s: f64) -> Track {
        let samples = ((1.0 / tau0_s).round() as u64).max(1);
        Track { tau0_s, samples, base: 0, started: false, channels: vec![vec![]; channels] }
    }

    /// Takes samples of a channel from a grid position on. All channels of a sample block have the same positions.
    pub fn push(&mut self, channel: usize, values: &[f64], first_index: u64) {
        if values.is_empty() || channel >= self.channels.len() {
            return;
        }
        if !self.started {
            self.started = true;
            self.base = first_index / self.samples;
        }
        let last = first_index + values.len() as u64 - 1;
        while (last / self.samples).saturating_sub(self.base) >= MAX_BLOCKS as u64 {
            self.halve();
        }
        let (samples, base) = (self.samples, self.base);
        let Some(blocks) = self.channels.get_mut(channel) else { return };
        let end = (last / samples).saturating_sub(base) as usize + 1;
        if blocks.len() < end {
            blocks.resize(end, (0.0, 0));
        }
        for (i, v) in values.iter().enumerate().filter(|(_, v)| v.is_finite()) {
            let at = ((first_index + i as u64) / samples).saturating_sub(base) as usize;
            if let Some(block) = blocks.get_mut(at) {
                block.0 += v;
                block.1 += 1;
            }
        }
    }

    fn halve(&mut self) {
        let odd = (self.base % 2) as usize;
        for blocks in &mut self.channels {
            let mut merged = Vec::with_capacity(blocks.len() / 2 + 1);
            let (head, rest) = blocks.split_at(odd.min(blocks.len()));
            merged.extend_from_slice(head);
            for pair in rest.chunks(2) {
                merged.push(pair.iter().fold((0.0, 0), |(s, n), (v, m)| (s + v, n + m)));
            }
            *blocks = merged;
        }
        self.base /= 2;
        self.samples *= 2;
    }

    /// The means. Blocks at the ends that hold less than half of their samples are left out.
    pub fn finish(self) -> Option<Means> {
        let n = self.channels.iter().map(Vec::len).max().filter(|n| *n > 0)?;
        let full = |at: usize| {
            let most = self.channels.iter().filter_map(|c| c.get(at)).map(|b| b.1).max().unwrap_or(0);
            2 * u64::from(most) >= self.samples
        };
        let from = (0..n).find(|i| full(*i))?;
        let to = (0..n).rev().find(|i| full(*i))? + 1;
        let mean = |b: Option<&(f64, u32)>| match b {
            Some((sum, n)) if *n > 0 => sum / f64::from(*n),
            _ => f64::NAN,
        };
        let values = self.channels.iter().map(|c| (from..to).map(|i| mean(c.get(i))).collect()).collect();
        let block_s = self.samples as f64 * self.tau0_s;
        Some(Means {
            block_s,
            samples: self.samples,
            first_s: (self.base + from as u64) as f64 * block_s,
            values,
        })
    }
}

impl Means {
    /// Means over `factor` blocks; a rest that does not fill one is left out.
    pub fn merged(&self, factor: usize) -> Means {
        let mean = |c: &[f64]| {
            let known = c.iter().filter(|v| v.is_finite());
            known.clone().sum::<f64>() / known.count() as f64
        };
        let factor = factor.max(1);
        Means {
            block_s: self.block_s * factor as f64,
            samples: self.samples * factor as u64,
            first_s: self.first_s,
            values: self.values.iter().map(|v| v.chunks_exact(factor).map(mean).collect()).collect(),
        }
    }

    /// The number of blocks.
    pub fn len(&self) -> usize {
        self.values.first().map_or(0, Vec::len)
    }

    /// True when there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Straight lines in place of missing values, the nearest value at the ends; the share that was missing. `None` when
/// nothing is there.
pub fn bridged(values: &[f64]) -> Option<(Vec<f64>, f64)> {
    let known: Vec<usize> = (0..values.len()).filter(|i| values[*i].is_finite()).collect();
    let (first, last) = (*known.first()?, *known.last()?);
    let mut out = values.to_vec();
    out[..first].fill(values[first]);
    out[last..].fill(values[last]);
    for pair in known.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let step = (values[b] - values[a]) / (b - a) as f64;
        out[a + 1..b].iter_mut().enumerate().for_each(|(i, v)| *v = values[a] + step * (i + 1) as f64);
    }
    Some((out, 1.0 - known.len() as f64 / values.len() as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_grow_and_keep_their_means() {
        let mut track = Track::new(1, 1.0);
        let n = 3 * MAX_BLOCKS as u64 + 17;
        let all: Vec<f64> = (0..n).map(|i| i as f64).collect();
        for (i, part) in all.chunks(999).enumerate() {
            track.push(0, part, 5 + 999 * i as u64);
        }
        let means = track.finish().unwrap();
        assert!(means.len() <= MAX_BLOCKS && means.block_s == 4.0);
        // The block that starts at grid position 8 holds the values 3, 4, 5, 6.
        let at = ((8.0 - means.first_s) / 4.0) as usize;
        assert_eq!(means.values[0][at], 4.5);
    }

    #[test]
    fn holes_are_bridged_and_counted() {
        let (v, share) = bridged(&[f64::NAN, 1.0, f64::NAN, f64::NAN, 4.0]).unwrap();
        assert_eq!((v, share), (vec![1.0, 1.0, 2.0, 3.0, 4.0], 0.6));
        assert!(bridged(&[f64::NAN]).is_none());
    }
}
