//! A channel over time for a plot: least, greatest and mean value of at most 2048 spans.

/// Spans that remain at most.
pub const MAX_SPANS: usize = 2048;

/// Indices beyond are taken for this one, so that they can be added to.
const LAST_INDEX: u64 = 1 << 62;

/// One span of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvelopeBin {
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Mean value.
    pub mean: f64,
    /// Samples; 0 in a gap, where the values are NaN.
    pub count: u64,
}

/// A channel as spans of equal length, aligned to the grid index.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Envelope {
    /// Samples in a full span: a power of two.
    pub bin_len: u64,
    /// Grid index of the first sample of the first span.
    pub first_index: u64,
    /// Spans in order of time.
    pub bins: Vec<EnvelopeBin>,
}

/// Streaming envelope of any channel; samples that are not finite are left out.
#[derive(Debug, Clone, Default)]
pub struct EnvelopeAccumulator {
    shift: u32,
    first_bin: u64,
    bins: Vec<Span>,
}

#[derive(Debug, Clone, Copy)]
struct Span {
    min: f64,
    max: f64,
    mean: f64,
    count: u64,
}

const EMPTY_SPAN: Span = Span { min: f64::INFINITY, max: f64::NEG_INFINITY, mean: 0.0, count: 0 };

impl Span {
    fn of(values: &[f64]) -> Span {
        let (mut span, mut sum) = (EMPTY_SPAN, 0.0);
        let reference = values.iter().copied().find(|v| v.is_finite()).unwrap_or(0.0);
        for v in values.iter().filter(|v| v.is_finite()) {
            span.min = if *v < span.min { *v } else { span.min };
            span.max = if *v > span.max { *v } else { span.max };
            sum += v - reference;
            span.count += 1;
        }
        span.mean = if span.count > 0 { reference + sum / span.count as f64 } else { 0.0 };
        span
    }

    fn join(self, other: Span) -> Span {
        if other.count == 0 {
            return self;
        }
        if self.count == 0 {
            return other;
        }
        let count = self.count + other.count;
        let share = other.count as f64 / count as f64;
        Span {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            mean: self.mean + share * (other.mean - self.mean),
            count,
        }
    }
}

impl EnvelopeAccumulator {
    /// An empty accumulator.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes contiguous samples from grid index `first_index` on; indices never go back.
    pub fn push(&mut self, samples: &[f64], first_index: u64) {
        if samples.is_empty() {
            return;
        }
        let first_index = first_index.min(LAST_INDEX);
        if self.bins.is_empty() {
            self.first_bin = first_index >> self.shift;
        }
        let first_index = first_index.max(self.first_bin << self.shift);
        let last = first_index.saturating_add(samples.len() as u64 - 1);
        while (last >> self.shift) - self.first_bin >= MAX_SPANS as u64 {
            self.halve();
        }
        let needed = ((last >> self.shift) - self.first_bin) as usize + 1;
        if self.bins.len() < needed {
            self.bins.resize(needed, EMPTY_SPAN);
        }
        let (mut rest, mut at) = (samples, first_index);
        while !rest.is_empty() {
            let bin = at >> self.shift;
            let room = ((bin + 1) << self.shift) - at;
            let (now, later) = rest.split_at((room as usize).min(rest.len()));
            if let Some(slot) = self.bins.get_mut((bin - self.first_bin) as usize) {
                *slot = slot.join(Span::of(now));
            }
            at += now.len() as u64;
            rest = later;
        }
    }

    /// Adds what another part of the recording left, on the same grid. Extremes and counts are those of one pass, means agree
    /// to rounding.
    pub fn merge(&mut self, other: &EnvelopeAccumulator) {
        if other.bins.is_empty() {
            return;
        }
        if self.bins.is_empty() {
            *self = other.clone();
            return;
        }
        let mut other = other.clone();
        if self.first_bin << self.shift > other.first_bin << other.shift {
            std::mem::swap(self, &mut other);
        }
        while self.shift < other.shift {
            self.halve();
        }
        while other.shift < self.shift {
            other.halve();
        }
        let end = |spans: &Self| spans.first_bin + spans.bins.len() as u64;
        while end(self).max(end(&other)) - self.first_bin > MAX_SPANS as u64 {
            self.halve();
            other.halve();
        }
        let needed = (end(self).max(end(&other)) - self.first_bin) as usize;
        self.bins.resize(needed, EMPTY_SPAN);
        let from = (other.first_bin - self.first_bin) as usize;
        for (slot, span) in self.bins.iter_mut().skip(from).zip(other.bins) {
            *slot = slot.join(span);
        }
    }

    /// The envelope so far.
    pub fn finish(&self) -> Envelope {
        Envelope {
            bin_len: 1 << self.shift,
            first_index: self.first_bin << self.shift,
            bins: self
                .bins
                .iter()
                .map(|s| match s.count {
                    0 => EnvelopeBin { min: f64::NAN, max: f64::NAN, mean: f64::NAN, count: 0 },
                    count => EnvelopeBin { min: s.min, max: s.max, mean: s.mean, count },
                })
                .collect(),
        }
    }

    /// Joins neighbouring spans.
    fn halve(&mut self) {
        let odd = (self.first_bin & 1) as usize;
        let mut out = vec![EMPTY_SPAN; (self.bins.len() + odd).div_ceil(2)];
        for (k, span) in self.bins.iter().enumerate() {
            if let Some(slot) = out.get_mut((k + odd) / 2) {
                *slot = slot.join(*span);
            }
        }
        self.bins = out;
        self.first_bin >>= 1;
        self.shift += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_hold_extremes_and_mean_of_their_samples() {
        let y: Vec<f64> = (0..10_000u32).map(|i| f64::from(i.wrapping_mul(2_654_435_761) >> 16)).collect();
        let mut envelope = EnvelopeAccumulator::new();
        y.chunks(313).enumerate().for_each(|(k, b)| envelope.push(b, 5 + 313 * k as u64));
        let e = envelope.finish();
        assert_eq!((e.bin_len, e.first_index), (8, 0));
        for (k, bin) in e.bins.iter().enumerate() {
            let from = (8 * k).saturating_sub(5);
            let part = &y[from..(8 * k + 3).min(y.len())];
            assert_eq!(bin.count, part.len() as u64);
            assert_eq!(bin.min, part.iter().copied().fold(f64::INFINITY, f64::min));
            assert_eq!(bin.max, part.iter().copied().fold(f64::NEG_INFINITY, f64::max));
            assert!((bin.mean - part.iter().sum::<f64>() / part.len() as f64).abs() < 1e-9);
        }
    }

    #[test]
    fn gaps_and_unusable_samples_leave_no_value() {
        let mut envelope = EnvelopeAccumulator::new();
        envelope.push(&[1.0, f64::NAN, 3.0], 0);
        envelope.push(&[5.0], 4);
        let e = envelope.finish();
        assert_eq!(e.bins.iter().map(|b| b.count).collect::<Vec<_>>(), vec![1, 0, 1, 0, 1]);
        assert!(e.bins[1].mean.is_nan() && e.bins[3].min.is_nan());
    }
}
