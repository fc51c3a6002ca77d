//! Stretches of samples that occur twice, bit for bit: a doubled block, a telemetry frame sent again, a file appended to
//! itself.
//!
//! A rolling hash covers the last 16, 32 or 64 samples. Some of its values are anchors, chosen by the hash itself, so
//! that a stretch that occurs again has the same anchors again. The first place of each anchor is kept; when the table
//! is full, fewer hashes are anchors, and the table shrinks by half. Anchors that match at one and the same distance,
//! with none between that does not, form a run; its evidence is the number of samples that its hashes cover.
//!
//! Chance: with n samples there are n²/2 pairs of places, and e samples agree by chance with probability p^e. p is
//! measured on the samples of the run itself, as the largest of the shares with which a pair of equal stretches of k
//! samples goes on: so a coarse, slow or regular output, of which every part looks like another, asks for long runs. A
//! run counts when n²/2·p^e < 0.001.

use super::place::{Place, Places};
use super::summary::CHUNK;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Samples from which the length of the hash is chosen.
const HASH_LENGTH_SAMPLES: usize = 4096;
/// Most anchors that are kept.
const MAX_ANCHORS: usize = 1 << 17;
/// Runs allowed by chance in a record.
const BY_CHANCE: f64 = 1e-3;
/// Least evidence, samples: two stuck stretches of one value must not look alike.
pub(super) const MIN_SAMPLES: u64 = 24;
/// Last samples that are kept to judge a run by.
const RECENT: usize = 512;
/// Samples of a run that its chance is measured on.
const MEASURED: usize = 256;
/// Times that a run is judged; beyond, the output repeats itself too readily to tell.
const TRIALS: u32 = 500;
/// Share beyond which the output repeats itself so regularly that no more of it is looked at.
const REGULAR: f64 = 0.98;
/// Runs whose place is kept.
const MAX_LISTED: usize = 100;

/// Spreads a hash that is one already.
#[derive(Default)]
struct Spread(u64);

impl Hasher for Spread {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        for b in bytes {
            self.write_u64(u64::from(*b));
        }
    }
    fn write_u64(&mut self, key: u64) {
        let z = (self.0 ^ key).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = z ^ (z >> 32);
    }
}

/// A stretch that occurs a second time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Repeat {
    /// Where it occurs again.
    pub(super) place: Place,
    /// Row in which it occurred first.
    pub(super) first_row: u64,
    /// Samples, as far as anchors show it.
    pub(super) length: u64,
    /// Longest stretch that chance allows, samples.
    pub(super) by_chance: u64,
}

#[derive(Debug, Clone, Copy)]
struct Run {
    distance: u64,
    /// Position of the last sample of the first and of the latest matching window.
    from: u64,
    to: u64,
    evidence: u64,
    /// Where the first window begins, and the row in which it occurred first.
    place: Place,
    first_row: u64,
    /// Evidence from which the run is judged again.
    judged_at: u64,
    by_chance: Option<u64>,
}

#[derive(Debug, Clone)]
pub(super) struct RepetitionCheck {
    first: Vec<f64>,
    /// Bits that the hash moves up with each sample; the window is 64 bits over this. 0: not chosen yet.
    shift: u32,
    hash: u64,
    /// Leading bits of the hash that are zero at an anchor.
    zeros: u32,
    anchors: HashMap<u64, (u64, u64), BuildHasherDefault<Spread>>,
    /// Finite samples so far.
    taken: u64,
    places: Places,
    recent: Vec<f64>,
    run: Option<Run>,
    trials: u32,
    count: u64,
    /// Position after the last sample counted.
    counted_to: u64,
    found: Vec<Repeat>,
}

impl RepetitionCheck {
    pub(super) fn new(interval_s: f64) -> RepetitionCheck {
        RepetitionCheck {
            first: Vec::new(),
            shift: 0,
            hash: 0,
            zeros: 0,
            anchors: HashMap::default(),
            taken: 0,
            places: Places::new(interval_s),
            recent: Vec::new(),
            run: None,
            trials: 0,
            count: 0,
            counted_to: 0,
            found: Vec::new(),
        }
    }

    /// Takes finite samples.
    pub(super) fn take(&mut self, values: &[f64], place: Place) {
        let position = self.taken + self.first.len() as u64;
        self.places.start(position, place);
        if self.shift == 0 {
            self.first.extend_from_slice(values);
            if self.first.len() >= HASH_LENGTH_SAMPLES {
                self.choose();
            }
            return;
        }
        self.scan(values);
        self.places.forget(self.taken.saturating_sub(RECENT as u64));
    }

    /// Samples in stretches that occurred before, and where those are; empty where the output repeats itself so readily
    /// that it cannot be detected.
    pub(super) fn finish(&mut self) -> (u64, Vec<Repeat>) {
        if self.shift == 0 {
            self.choose();
        }
        self.close();
        if self.trials >= TRIALS {
            return (0, Vec::new());
        }
        (self.count, std::mem::take(&mut self.found))
    }

    /// The shortest window that a million samples of this kind hardly repeat by chance.
    fn choose(&mut self) {
        let first = std::mem::take(&mut self.first);
        let head = first.get(..MEASURED.min(first.len())).unwrap_or_default();
        let needed = needed(share(head), 1e6);
        self.shift = if needed <= 16 {
            4
        } else if needed <= 32 {
            2
        } else {
            1
        };
        for part in first.chunks(CHUNK) {
            self.scan(part);
        }
    }

    fn scan(&mut self, values: &[f64]) {
        if self.trials >= TRIALS {
            return;
        }
        let window = u64::from(64 / self.shift);
        let start = self.taken;
        let mut hash = self.hash;
        for (i, v) in values.iter().enumerate() {
            // Zero has two signs that are one value.
            let mixed = (v + 0.0).to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15);
            hash = (hash << self.shift).wrapping_add(mixed ^ (mixed >> 32));
            if hash.leading_zeros() >= self.zeros && start + i as u64 + 1 >= window {
                self.anchor(hash, start + i as u64, window, values.get(..=i).unwrap_or_default());
            }
        }
        self.hash = hash;
        self.taken += values.len() as u64;
        let tail = values.get(values.len().saturating_sub(RECENT)..).unwrap_or_default();
        let surplus = (self.recent.len() + tail.len()).saturating_sub(RECENT);
        self.recent.drain(..surplus.min(self.recent.len()));
        self.recent.extend_from_slice(tail);
    }

    /// An anchor whose window ends at `position`; `values`: the samples of this call up to it.
    fn anchor(&mut self, hash: u64, position: u64, window: u64, values: &[f64]) {
        let Some(&(earlier, earlier_row)) = self.anchors.get(&hash) else {
            self.close();
            if self.anchors.len() >= MAX_ANCHORS {
                while self.anchors.len() >= MAX_ANCHORS / 2 && self.zeros < 40 {
                    self.zeros += 1;
                    let zeros = self.zeros;
                    self.anchors.retain(|h, _| h.leading_zeros() >= zeros);
                }
                if hash.leading_zeros() < self.zeros {
                    return;
                }
            }
            let row = self.places.of((position + 1).saturating_sub(window)).row;
            self.anchors.insert(hash, (position, row));
            return;
        };
        let distance = position - earlier;
        match self.run.as_mut().filter(|r| r.distance == distance) {
            Some(run) => {
                run.evidence += (position - run.to).min(window);
                run.to = position;
            }
            None => {
                self.close();
                self.run = Some(Run {
                    place: self.places.of((position + 1).saturating_sub(window)),
                    distance,
                    from: position,
                    to: position,
                    evidence: window,
                    first_row: earlier_row,
                    // A single window may be one of many alike; a second anchor at the same distance is asked for.
                    judged_at: MIN_SAMPLES.max(window + 8),
                    by_chance: None,
                });
            }
        }
        self.judge(values);
    }

    /// Judges the run that stands when there is new evidence enough.
    fn judge(&mut self, values: &[f64]) {
        let Some(run) = self.run.filter(|r| r.by_chance.is_none() && r.evidence >= r.judged_at) else {
            return;
        };
        self.trials += 1;
        // The window of a short distance holds both occurrences; only the second may be measured.
        let wanted = usize::try_from(run.evidence.min(run.distance)).unwrap_or(MEASURED).min(MEASURED);
        let mut samples = Vec::with_capacity(wanted);
        let older = wanted.saturating_sub(values.len());
        samples.extend_from_slice(
            self.recent.get(self.recent.len().saturating_sub(older)..).unwrap_or_default(),
        );
        samples.extend_from_slice(values.get(values.len().saturating_sub(wanted)..).unwrap_or_default());
        let needed = needed(share(&samples), run.to as f64);
        if let Some(run) = &mut self.run {
            run.by_chance =
                (run.evidence >= needed.max(MIN_SAMPLES)).then(|| needed.saturating_sub(1).max(1));
            run.judged_at = run.evidence.saturating_mul(2).max(needed.min(run.evidence.saturating_mul(64)));
        }
    }

    fn close(&mut self) {
        let Some(run) = self.run.take() else { return };
        let Some(by_chance) = run.by_chance else { return };
        let window = u64::from(64 / self.shift);
        let length = run.to - run.from + window;
        // Runs that follow each other share the samples of a window.
        let end = run.to + 1;
        self.count += end - (end - length).max(self.counted_to);
        self.counted_to = end;
        if self.found.len() < MAX_LISTED {
            self.found.push(Repeat { place: run.place, first_row: run.first_row, length, by_chance });
        }
    }
}

/// Samples that must agree so that chance explains it with [`BY_CHANCE`] only, among `taken` samples.
fn needed(share: f64, taken: f64) -> u64 {
    if share >= 1.0 {
        return u64::MAX;
    }
    let pairs = (0.5 * taken * taken).max(1.0);
    ((BY_CHANCE / pairs).ln() / share.max(1e-9).ln()).ceil() as u64
}

/// The probability that a pair of equal stretches goes on with equal samples: the largest over their lengths, as far as
/// there are pairs enough to tell.
fn share(samples: &[f64]) -> f64 {
    const ENOUGH: u64 = 10;
    let n = samples.len();
    let mut alive: Vec<(usize, usize)> = Vec::new();
    for (i, a) in samples.iter().enumerate() {
        alive.extend((i + 1..n).filter(|&j| samples.get(j) == Some(a)).map(|j| (i, j)));
    }
    let pairs = (n * n.saturating_sub(1) / 2) as u64;
    let mut largest = (alive.len() as f64 + 1.0) / (pairs as f64 + 1.0);
    // Pairs of stretches of k samples that are equal, and those of them that could go on.
    for k in 1..n {
        alive.retain(|(_, j)| j + k < n);
        let could = alive.len() as u64;
        if could < ENOUGH {
            break;
        }
        alive.retain(|(i, j)| samples.get(i + k) == samples.get(j + k));
        largest = largest.max(alive.len() as f64 / could as f64);
        if largest > REGULAR {
            break;
        }
    }
    largest.min(1.0)
}

#[cfg(test)]
#[path = "repeats_tests.rs"]
mod tests;
