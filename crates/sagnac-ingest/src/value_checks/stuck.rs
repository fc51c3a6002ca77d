//! Equal values for longer than chance allows.
//!
//! A sensor with coarse steps repeats values by chance. With p the probability that a value repeats the one before, a
//! run of r repeats begins at a given sample with probability p^r; a run is stuck when n·p^r < 0.001, and never below
//! five equal values. p is the share of runs that go on, measured on the runs themselves: a stuck stretch is one run
//! however long it is, so it does not hide itself. Where the values repeat more readily in some places than in others,
//! the largest share over the first run lengths is taken.

use super::place::Place;

/// Fewest equal values that can be called stuck.
pub(super) const MIN_SAMPLES: u64 = 5;
/// Runs allowed by chance in a record.
const BY_CHANCE: f64 = 1e-3;
/// Probability of a repeat beyond which the test cannot tell anything: a held or a very coarse output.
const MAX_SHARE: f64 = 0.9;
/// Run lengths that are counted one by one.
const LENGTHS: usize = 4096;
/// Longest runs whose place is kept.
const MAX_LISTED: usize = 100;

#[derive(Debug, Clone)]
pub(super) struct StuckCheck {
    value: f64,
    length: u64,
    start: Place,
    samples: u64,
    counts: Vec<u64>,
    /// Samples in runs longer than are counted one by one.
    beyond: u64,
    longest: Vec<(Place, u64)>,
}

impl Default for StuckCheck {
    fn default() -> StuckCheck {
        StuckCheck {
            value: f64::NAN,
            length: 0,
            start: Place { row: 0, time_s: f64::NAN },
            samples: 0,
            counts: vec![0; LENGTHS],
            beyond: 0,
            longest: Vec::new(),
        }
    }
}

/// Stuck stretches.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stuck {
    pub(super) count: u64,
    pub(super) listed: Vec<(Place, u64)>,
    pub(super) longest_by_chance: u64,
    /// Mean length of a run, where the values repeat so readily that stuck ones cannot be detected.
    pub(super) held: Option<f64>,
}

impl StuckCheck {
    pub(super) fn take(&mut self, values: &[f64], place: Place, interval_s: f64) {
        self.samples += values.len() as u64;
        let Some((&first, &last)) = values.first().zip(values.last()) else { return };
        let repeats = values.iter().zip(values.get(1..).unwrap_or_default()).filter(|(a, b)| a == b).count();
        if repeats == 0 {
            if first != self.value {
                self.close();
                self.value = first;
                self.start = place;
            }
            self.length += 1;
            if values.len() > 1 {
                self.close();
                if let Some(singles) = self.counts.get_mut(1) {
                    *singles += values.len() as u64 - 2;
                }
                let ahead = values.len() as u64 - 1;
                self.value = last;
                self.length = 1;
                self.start = place.after(ahead, interval_s);
            }
            return;
        }
        for (i, &v) in values.iter().enumerate() {
            if v != self.value {
                self.close();
                self.value = v;
                self.start = place.after(i as u64, interval_s);
            }
            self.length += 1;
        }
    }

    fn close(&mut self) {
        let length = std::mem::take(&mut self.length);
        match usize::try_from(length).ok().and_then(|l| self.counts.get_mut(l)) {
            Some(count) => *count += 1,
            None => self.beyond += length,
        }
        if length < MIN_SAMPLES {
            return;
        }
        if self.longest.len() < MAX_LISTED {
            self.longest.push((self.start, length));
            return;
        }
        if let Some(shortest) = self.longest.iter_mut().min_by_key(|(_, l)| *l).filter(|(_, l)| *l < length) {
            *shortest = (self.start, length);
        }
    }

    pub(super) fn finish(&mut self) -> Stuck {
        self.close();
        let limit = self.limit();
        let from = usize::try_from(limit).unwrap_or(usize::MAX);
        let counted: u64 =
            self.counts.iter().enumerate().skip(from).map(|(length, count)| length as u64 * count).sum();
        let beyond = if from < LENGTHS { self.beyond } else { 0 };
        let mut listed = std::mem::take(&mut self.longest);
        listed.retain(|(_, l)| *l >= limit && limit < u64::MAX);
        listed.sort_by_key(|(p, _)| p.row);
        let runs = self.runs();
        let held = (limit == u64::MAX && runs > 0).then(|| self.samples as f64 / runs as f64);
        Stuck { count: counted + beyond, listed, longest_by_chance: limit.saturating_sub(1), held }
    }

    fn runs(&self) -> u64 {
        self.counts.iter().skip(1).sum::<u64>() + u64::from(self.beyond > 0)
    }

    /// Shortest run that chance does not explain; `u64::MAX` when none can be detected.
    fn limit(&self) -> u64 {
        let runs = self.runs();
        if runs <= 1 {
            return MIN_SAMPLES;
        }
        let at_least =
            |length: usize| self.counts.iter().skip(length).sum::<u64>() + u64::from(self.beyond > 0);
        let enough = 30.max(runs / 100);
        let mut share = (at_least(2) as f64 + 0.5) / (runs as f64 + 1.0);
        for length in 2..=4 {
            let (of, on) = (at_least(length), at_least(length + 1));
            if on >= enough {
                share = share.max(on as f64 / of.max(1) as f64);
            }
        }
        if share > MAX_SHARE {
            return u64::MAX;
        }
        let repeats = (BY_CHANCE / self.samples.max(1) as f64).ln() / share.ln();
        MIN_SAMPLES.max(1 + repeats.ceil() as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stuck_stretch_stands_where_it_begins_in_row_and_time() {
        let mut runs = StuckCheck::default();
        let mut values: Vec<f64> =
            (0..1000).map(|i| f64::from(i * 37 % 101) + 0.5 * f64::from(i % 7)).collect();
        values[700..740].fill(-1.0);
        runs.take(&values, Place { row: 11, time_s: 100.0 }, 0.5);
        let stuck = runs.finish();
        assert_eq!(stuck.count, 40);
        assert_eq!(stuck.listed, [(Place { row: 711, time_s: 450.0 }, 40)]);
    }
}
