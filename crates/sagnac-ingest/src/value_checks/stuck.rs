//! Equal values for longer than chance allows.
//!
//! A sensor with coarse steps repeats values by chance. With p the probability that a value repeats the one before, a
//! run of r repeats begins at a given sample with probability p^r; a run is stuck when n·p^r < 0.001, and never below
//! five equal values. p is the share of runs that go on, measured on the runs themselves: a stuck stretch is one run
//! however long it is, so it does not hide itself. Where the values repeat more readily in some places than in others,
//! the largest share over the first run lengths is taken, and a run that is longer than this allows is judged once more by
//! the runs about it: the steps of a table ripple differently, and one at rest repeats what one that turns never does.

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
/// Samples of a stretch in which runs are counted, to begin with.
const STRETCH: u64 = 64;
/// Stretches at most; beyond, neighbours are put together.
const MAX_STRETCHES: usize = 4096;
/// Stretches to either side that the surroundings of a run reach.
const REACHES: [usize; 4] = [1, 4, 16, 64];
/// Runs of one length by which a share of those that go on is told.
const ENOUGH_ABOUT: u64 = 30;
/// Runs by their length in a stretch, all of them first; the last entry holds those of its length and longer.
type Runs = [u32; MIN_SAMPLES as usize];

#[derive(Debug, Clone)]
pub(super) struct StuckCheck {
    value: f64,
    length: u64,
    start: Place,
    samples: u64,
    counts: Vec<u64>,
    /// Samples in runs longer than are counted one by one.
    beyond: u64,
    longest: Vec<Longest>,
    /// Samples in closed runs.
    passed: u64,
    /// Length of a stretch, samples.
    stretch: u64,
    /// Runs of at least 1, 2, ... equal values by the stretch that they begin in.
    stretches: Vec<Runs>,
}

/// A long run.
#[derive(Debug, Clone, Copy)]
struct Longest {
    start: Place,
    length: u64,
    /// Samples before it.
    position: u64,
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
            passed: 0,
            stretch: STRETCH,
            stretches: Vec::new(),
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
                let singles = values.len() as u64 - 2;
                if let Some(counted) = self.counts.get_mut(1) {
                    *counted += singles;
                }
                self.count_singles(singles);
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
        let run = Longest { start: self.start, length, position: self.passed };
        if length > 0 {
            let reached = usize::try_from(length).unwrap_or(usize::MAX);
            self.stretch_at(self.passed).iter_mut().take(reached).for_each(|n| *n += 1);
            self.passed += length;
        }
        if length < MIN_SAMPLES {
            return;
        }
        if self.longest.len() < MAX_LISTED {
            self.longest.push(run);
            return;
        }
        if let Some(shortest) = self.longest.iter_mut().min_by_key(|r| r.length).filter(|r| r.length < length)
        {
            *shortest = run;
        }
    }

    /// Counts so many values that are each a run of their own.
    fn count_singles(&mut self, mut singles: u64) {
        while singles > 0 {
            let here = singles.min(self.stretch - self.passed % self.stretch);
            let counted = u32::try_from(here).unwrap_or(u32::MAX);
            self.stretch_at(self.passed)[0] += counted;
            self.passed += here;
            singles -= here;
        }
    }

    /// The stretch of a position, with stretches up to it.
    fn stretch_at(&mut self, position: u64) -> &mut Runs {
        while position / self.stretch >= MAX_STRETCHES as u64 {
            let joined = |pair: &[Runs]| {
                std::array::from_fn(|k| pair.iter().fold(0, |sum: u32, runs| sum.saturating_add(runs[k])))
            };
            self.stretches = self.stretches.chunks(2).map(joined).collect();
            self.stretch *= 2;
        }
        let at = usize::try_from(position / self.stretch).unwrap_or(0);
        if self.stretches.len() <= at {
            self.stretches.resize(at + 1, [0; MIN_SAMPLES as usize]);
        }
        &mut self.stretches[at]
    }

    pub(super) fn finish(&mut self) -> Stuck {
        self.close();
        let limit = self.limit();
        let from = usize::try_from(limit).unwrap_or(usize::MAX);
        let counted: u64 =
            self.counts.iter().enumerate().skip(from).map(|(length, count)| length as u64 * count).sum();
        let beyond = if from < LENGTHS { self.beyond } else { 0 };
        let mut long = std::mem::take(&mut self.longest);
        long.retain(|r| r.length >= limit && limit < u64::MAX);
        let (excused, kept): (Vec<Longest>, Vec<Longest>) =
            long.into_iter().partition(|r| self.is_ordinary(r));
        let mut count = counted + beyond - excused.iter().map(|r| r.length).sum::<u64>();
        // Shorter runs than those listed are ordinary where every one of these is.
        if kept.is_empty() {
            count = 0;
        }
        let by_chance = excused.iter().map(|r| r.length).max().unwrap_or(0).max(limit.saturating_sub(1));
        let mut listed: Vec<(Place, u64)> = kept.into_iter().map(|r| (r.start, r.length)).collect();
        listed.sort_by_key(|(p, _)| p.row);
        let runs = self.runs();
        let held = (limit == u64::MAX && runs > 0).then(|| self.samples as f64 / runs as f64);
        Stuck { count, listed, longest_by_chance: by_chance, held }
    }

    /// True for a run that the runs about it explain by chance.
    fn is_ordinary(&self, run: &Longest) -> bool {
        let at = usize::try_from(run.position / self.stretch).unwrap_or(usize::MAX);
        let last = usize::try_from((run.position + run.length - 1) / self.stretch).unwrap_or(usize::MAX);
        let share_about = |reach: usize| -> f64 {
            let end = last.saturating_add(reach + 1).min(self.stretches.len());
            let about = self.stretches.get(at.saturating_sub(reach)..end).unwrap_or_default();
            // Without the run itself.
            let reached = |k: usize| about.iter().map(|r| u64::from(r[k])).sum::<u64>().saturating_sub(1);
            let shares = (1..MIN_SAMPLES as usize).map(|k| (reached(k - 1), reached(k)));
            let told = shares.filter(|(of, _)| *of >= ENOUGH_ABOUT);
            told.map(|(of, on)| (on as f64 + 0.5) / (of as f64 + 1.0)).fold(0.0, f64::max)
        };
        let share = REACHES.into_iter().map(share_about).fold(0.0, f64::max);
        share > MAX_SHARE || run.length < by_chance(self.samples, share)
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
        by_chance(self.samples, share)
    }
}

/// Shortest run that chance does not explain among so many samples of which a share repeats the one before.
fn by_chance(samples: u64, share: f64) -> u64 {
    if share <= 0.0 {
        return MIN_SAMPLES;
    }
    let repeats = (BY_CHANCE / samples.max(1) as f64).ln() / share.ln();
    MIN_SAMPLES.max(1 + repeats.ceil() as u64)
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

    /// Counts of a table: nearly all samples turn and hardly repeat, one in a hundred at rest takes three values.
    fn table(samples: u64) -> Vec<f64> {
        let mut state = 7u64;
        let mut draw = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state >> 33
        };
        let at_rest = |i: u64| i % 20_000 >= 19_800;
        (0..samples)
            .map(|i| if at_rest(i) { (draw() % 3) as f64 } else { (draw() % 4000) as f64 + 10.0 })
            .collect()
    }

    fn of(values: &[f64]) -> Stuck {
        let mut runs = StuckCheck::default();
        for (i, part) in values.chunks(500).enumerate() {
            runs.take(part, Place { row: 1 + 500 * i as u64, time_s: 50.0 * i as f64 }, 0.1);
        }
        runs.finish()
    }

    #[test]
    fn a_step_at_rest_repeats_more_readily_than_one_that_turns() {
        let mut values = table(200_000);
        let found = of(&values);
        assert_eq!((found.count, found.listed.len()), (0, 0), "{found:?}");
        // A stretch that is stuck while the table turns, and one at rest that its length shows.
        values[50_100..50_125].fill(55.0);
        let found = of(&values);
        assert_eq!((found.count, found.listed.len()), (25, 1), "{found:?}");
        values[59_850..59_910].fill(1.0);
        assert!(of(&values).listed.iter().any(|l| l.1 >= 60));
    }
}
