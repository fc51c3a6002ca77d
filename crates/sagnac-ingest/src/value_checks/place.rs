//! Where the samples of a channel stand in the recording.

/// Where a sample stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub row: u64,
    pub time_s: f64,
}

impl Place {
    /// The place some samples further on in the same stretch.
    pub fn after(self, samples: u64, interval_s: f64) -> Place {
        Place { row: self.row + samples, time_s: self.time_s + samples as f64 * interval_s }
    }
}

/// Samples with a finite value, in order, and where they stand: rows and times are kept for stretches.
#[derive(Debug, Clone, Default)]
pub(super) struct Places {
    stretches: std::collections::VecDeque<(u64, Place)>,
    interval_s: f64,
}

impl Places {
    /// No stretch yet; `interval_s`: nominal sample interval.
    pub fn new(interval_s: f64) -> Places {
        Places { stretches: Default::default(), interval_s }
    }

    /// A stretch begins at a position.
    pub fn start(&mut self, position: u64, place: Place) {
        self.stretches.push_back((position, place));
    }

    /// Forgets stretches that end before a position.
    pub fn forget(&mut self, position: u64) {
        while self.stretches.get(1).is_some_and(|(start, _)| *start <= position) {
            self.stretches.pop_front();
        }
    }

    /// Where the sample at a position stands.
    pub fn of(&self, position: u64) -> Place {
        let after = self.stretches.partition_point(|(start, _)| *start <= position);
        match self.stretches.get(after.saturating_sub(1)) {
            Some((start, place)) => {
                let ahead = position.saturating_sub(*start);
                place.after(ahead, self.interval_s)
            }
            None => Place { row: 0, time_s: f64::NAN },
        }
    }
}
