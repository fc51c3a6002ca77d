//! Parts of a recording that are accumulated apart, and merged in their order.
//!
//! A recording may be cut anywhere: each part has accumulators of its own, and `merge` makes of two neighbours what one
//! pass over both would have left. Counts, extremes and lengths are equal to those of one pass; sums agree to rounding
//! (relative differences below 1e-12 for ordinary records).
//!
//! | what | merged how |
//! |---|---|
//! | count, mean, least and greatest value | sums about different references |
//! | block means, envelope | by grid index; blocks of both are joined until they are of one length |
//! | histogram, window means, quietest window | windows start with the stretch: the head is replayed |
//! | averaged periodogram | the same; the head also holds what segments reach across the seam |
//! | sums of the Allan family | the head of every lane is replayed, moved to the phase that the earlier part ends at |
//!
//! A window, a segment and a phase are counted from the beginning of an unbroken stretch. A part that continues one must
//! therefore be given how many samples of it precede ([`PartStart`]). It holds back its *head*, the samples or phases that
//! windows begun before it need; merging replays the head into the earlier part.
//!
//! Not to be merged, because one pass decides it from data that a part has not seen: a periodogram that chooses its
//! segment length itself, once it has chosen; histograms of different bins; sums of the Allan family with different
//! strides. Give parts the same segment length, scale and reach; else `merge` returns [`MergeError::Settings`]. The total
//! deviation needs every phase and is merged only where all are kept.

/// Where a part begins in an unbroken stretch of samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PartStart {
    /// Grid index of the first sample of the part.
    pub first_index: u64,
    /// Samples of the same stretch before it; 0: the part starts a stretch.
    pub samples_before: u64,
}

/// Why two parts cannot be merged. Nothing was changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// The later part continues a stretch at another sample than the earlier one ends at.
    #[error(
        "the later part continues a stretch after {expected} samples; the earlier part ends after {found}"
    )]
    Position {
        /// Samples of the stretch that precede the later part, as it was stated.
        expected: u64,
        /// Samples of the stretch at the end of the earlier part.
        found: u64,
    },
    /// The parts were accumulated with settings that differ or that each chose for itself.
    #[error("the parts were accumulated with different settings")]
    Settings,
}

/// Where a part stands in its stretches, and the first samples of a stretch that it continues.
#[derive(Debug, Clone, Default)]
pub(crate) struct Head {
    /// Samples of the first stretch before the part; `None`: the part starts it.
    begun: Option<u64>,
    /// Samples to hold back.
    wanted: usize,
    held: Vec<f64>,
    /// Samples of the current stretch, those before the part included.
    in_stretch: u64,
    /// Whether the first stretch has ended.
    ended: bool,
    /// Samples taken in all.
    taken: u64,
}

impl Head {
    /// The head of a part with `before` samples of its stretch before it, that holds back up to `wanted` samples.
    pub fn new(before: u64, wanted: usize) -> Head {
        Head {
            begun: (before > 0).then_some(before),
            wanted: if before > 0 { wanted } else { 0 },
            in_stretch: before,
            ..Head::default()
        }
    }

    /// Takes samples: holds back those that belong to the head and gives the rest.
    pub fn take<'a>(&mut self, samples: &'a [f64], continues: bool) -> &'a [f64] {
        self.count(samples.len(), continues);
        if self.wanted == self.held.len() || !self.is_leading() {
            return samples;
        }
        let (now, rest) = samples.split_at((self.wanted - self.held.len()).min(samples.len()));
        self.held.extend_from_slice(now);
        rest
    }

    /// Counts samples without holding any back.
    fn count(&mut self, samples: usize, continues: bool) {
        if !continues {
            self.end_stretch();
        }
        self.taken += samples as u64;
        self.in_stretch += samples as u64;
    }

    /// Ends the stretch. A part that ends it before its first sample continues nothing.
    pub fn end_stretch(&mut self) {
        if self.taken == 0 {
            self.begun = None;
        }
        self.ended = true;
        self.in_stretch = 0;
    }

    /// True while the part is in the stretch that it continues.
    pub fn is_leading(&self) -> bool {
        self.begun.is_some() && !self.ended
    }

    /// True for a part without a sample.
    pub fn is_empty(&self) -> bool {
        self.taken == 0
    }

    /// Samples of the first stretch before the part; `None` where it starts a stretch.
    pub fn begun(&self) -> Option<u64> {
        self.begun
    }

    /// True where samples lie beyond the head: its first stretch goes further, or has ended.
    pub fn is_passed(&self) -> bool {
        self.held.len() == self.wanted || self.ended
    }

    /// True where the first stretch ended before the head was full.
    pub fn ended_inside(&self) -> bool {
        self.ended && self.held.len() < self.wanted
    }

    /// True where the stretch that the part continues has ended.
    pub fn has_ended(&self) -> bool {
        self.ended
    }

    /// The samples held back.
    pub fn held(&self) -> &[f64] {
        &self.held
    }

    /// Whether a later part with this head may follow a part with `self`.
    pub fn accepts(&self, later: &Head) -> Result<(), MergeError> {
        match later.begun {
            Some(expected) if expected != self.in_stretch => {
                Err(MergeError::Position { expected, found: self.in_stretch })
            }
            _ => Ok(()),
        }
    }

    /// Updates the counts when a part with `later`, whose held samples have been replayed into this one, is
    /// joined to it.
    pub fn follow(&mut self, later: &Head) {
        self.taken += later.taken - later.held.len() as u64;
        if later.ended || later.begun.is_none() {
            self.ended = true;
        }
        self.in_stretch = later.in_stretch;
    }
}

#[cfg(test)]
#[path = "part_tests.rs"]
mod tests;
