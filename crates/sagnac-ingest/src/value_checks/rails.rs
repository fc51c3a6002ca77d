//! Values at a rail: the extreme value occurs far more often than the next one inside it.
//!
//! Noise thins out towards its extremes, on a quantization grid too, so that the extreme value is rarer than the one next to it;
//! clipping piles values up there. The test asks for eight samples at the extreme, four times as many and four more than
//! at the next value, and for a next value within half a standard deviation: otherwise the extreme is a level of its
//! own, not the edge of the noise.

use super::place::Place;

/// Fewest samples at one value that can be a rail.
pub(super) const MIN_SAMPLES: u64 = 8;

#[derive(Debug, Clone, Copy)]
struct Edge {
    /// +1 for the upper edge, −1 for the lower one, where the values are mirrored.
    sign: f64,
    value: f64,
    count: u64,
    first: Place,
    next: f64,
    next_count: u64,
}

impl Edge {
    fn new(sign: f64) -> Edge {
        Edge {
            sign,
            value: f64::NEG_INFINITY,
            count: 0,
            first: Place { row: 0, time_s: f64::NAN },
            next: f64::NEG_INFINITY,
            next_count: 0,
        }
    }

    fn take(&mut self, v: f64, place: impl FnOnce() -> Place) {
        if v < self.next {
            return;
        }
        if v == self.value {
            self.count += 1;
        } else if v > self.value {
            (self.next, self.next_count) = (self.value, self.count);
            (self.value, self.count) = (v, 1);
            self.first = place();
        } else if v == self.next {
            self.next_count += 1;
        } else {
            (self.next, self.next_count) = (v, 1);
        }
    }
}

/// A rail that was found.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rail {
    pub(super) side: &'static str,
    pub(super) value: f64,
    pub(super) count: u64,
    pub(super) next: u64,
    pub(super) first: Place,
}

#[derive(Debug, Clone)]
pub(super) struct SaturationCheck {
    upper: Edge,
    lower: Edge,
}

impl Default for SaturationCheck {
    fn default() -> SaturationCheck {
        SaturationCheck { upper: Edge::new(1.0), lower: Edge::new(-1.0) }
    }
}

impl SaturationCheck {
    pub(super) fn take(&mut self, values: &[f64], min: f64, max: f64, place: Place, interval_s: f64) {
        let edges = [(&mut self.upper, max), (&mut self.lower, -min)];
        for (edge, extreme) in edges {
            if extreme < edge.next {
                continue;
            }
            for (i, &v) in values.iter().enumerate() {
                edge.take(v * edge.sign, || place.after(i as u64, interval_s));
            }
        }
    }

    pub(super) fn found(&self, deviation: f64) -> Vec<Rail> {
        let railed = |e: &&Edge| {
            e.count >= MIN_SAMPLES
                && e.count >= 4 * e.next_count + 4
                && e.next.is_finite()
                && e.value - e.next < 0.5 * deviation
        };
        [(&self.lower, "fault_note.smallest"), (&self.upper, "fault_note.largest")]
            .into_iter()
            .filter(|(e, _)| railed(e))
            .map(|(e, side)| Rail {
                side,
                value: e.value * e.sign,
                count: e.count,
                next: e.next_count,
                first: e.first,
            })
            .collect()
    }
}
