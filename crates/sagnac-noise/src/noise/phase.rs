//! From rate to phase: running sums that keep their digits.

pub(crate) use crate::numeric::sums::{Compensated, two_sum};

/// Samples in one step of the phase.
pub(crate) const PHASE_BLOCK_SAMPLES: usize = 4096;

/// Turns one unbroken stretch of rate into phase, a block of [`PHASE_BLOCK_SAMPLES`] samples at a time whatever the caller's blocks
/// are, so that results do not depend on how a record is cut into blocks.
///
/// The mean of the first block is taken off: differences of the phase along a stretch do not see a constant rate, and
/// without it the phase would lose digits where the offset is large against the noise.
#[derive(Debug, Clone, Default)]
pub(crate) struct PhaseBuilder {
    pending: Vec<f64>,
    base: Compensated,
    reference: Option<f64>,
    block: Vec<f64>,
    /// Whether the stretch began before the first sample: its first phase is the last one of the part before.
    continued: bool,
}

/// The phase at one sample, and the rate whose phase was taken off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PhaseEnd {
    pub phase: Compensated,
    pub reference: f64,
}

impl PhaseBuilder {
    /// A builder whose first sample continues a stretch. Phases count from the one before that sample, which is not given.
    pub(crate) fn continued() -> PhaseBuilder {
        PhaseBuilder { continued: true, ..PhaseBuilder::default() }
    }

    /// Gives the phases of all samples so far, and where the phase stands; `None` before the first sample of a stretch.
    pub(crate) fn flushed(&mut self, emit: &mut impl FnMut(&[f64])) -> Option<PhaseEnd> {
        if !self.pending.is_empty() {
            self.flush(emit);
        }
        Some(PhaseEnd { phase: self.base, reference: self.reference? })
    }

    /// Goes on from another phase.
    pub(crate) fn go_on(&mut self, end: PhaseEnd) {
        (self.base, self.reference) = (end.phase, Some(end.reference));
    }

    /// Takes samples; `emit` gets phases in order, the first of a stretch being 0.
    pub(crate) fn push(&mut self, mut samples: &[f64], emit: &mut impl FnMut(&[f64])) {
        while !samples.is_empty() {
            let take = (PHASE_BLOCK_SAMPLES - self.pending.len()).min(samples.len());
            let (now, rest) = samples.split_at(take);
            self.pending.extend_from_slice(now);
            samples = rest;
            if self.pending.len() == PHASE_BLOCK_SAMPLES {
                self.flush(emit);
            }
        }
    }

    /// Ends the stretch: the next sample starts a new one.
    pub(crate) fn end_stretch(&mut self, emit: &mut impl FnMut(&[f64])) {
        if !self.pending.is_empty() {
            self.flush(emit);
        }
        self.base = Compensated::default();
        self.reference = None;
        self.continued = false;
    }

    fn flush(&mut self, emit: &mut impl FnMut(&[f64])) {
        self.block.clear();
        let pending = &self.pending;
        let reference = *self.reference.get_or_insert_with(|| {
            if !self.continued {
                self.block.push(0.0);
            }
            let first = pending.first().copied().unwrap_or(0.0);
            first + pending.iter().map(|y| y - first).sum::<f64>() / pending.len().max(1) as f64
        });
        let base = self.base.value();
        let mut local = 0.0;
        self.block.extend(pending.iter().map(|y| {
            local += y - reference;
            base + local
        }));
        self.base.add(local);
        self.pending.clear();
        emit(&self.block);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_do_not_depend_on_the_blocks() {
        let samples: Vec<f64> = (0..10_000).map(|i| 1e9 + f64::from(i % 7)).collect();
        let run = |size: usize| {
            let (mut builder, mut out) = (PhaseBuilder::default(), vec![]);
            for block in samples.chunks(size) {
                builder.push(block, &mut |x| out.extend_from_slice(x));
            }
            builder.end_stretch(&mut |x| out.extend_from_slice(x));
            out
        };
        let whole = run(10_000);
        assert_eq!(whole.len(), 10_001);
        assert_eq!(whole[0], 0.0);
        assert_eq!(whole, run(333));
        // Seven samples make a period.
        assert!((whole[14] - 2.0 * whole[7]).abs() < 1e-6);
    }
}
