//! Samples that repeat the one before them. They have no kind of their own in the format of explanations.

use crate::effect::sizing::numbers;
use crate::effect::{
    Detection, Detector, Domain, Drivers, Param, Place, Reported, RowDetector, Rows, RowsFound, Samples,
    Value, Values, list, number,
};
use crate::numeric::order::SortNumbers;
use crate::numeric::range::{Bounds, ends};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

pub struct RepeatedSamples;

static PARAMS: [Param; 2] =
    [Param::reported("repeated_share", "", 1e-9, 1.0), Param::inner("repeated_rows_each", "", 1.0, 1e7)];

/// First row that repeats, and how many do, of each run.
const TIMES_LIST: &str = "repeats_time_s";
const ROWS_LIST: &str = "repeats_rows";

describe! {
    RepeatedSamples, "repeated_samples", Samples in Time, needs [],
    confusers [MarkovShort, Quantization, Saturation],
    lists [
        Param::inner(TIMES_LIST, "s", f64::MIN, f64::MAX),
        Param::inner(ROWS_LIST, "", 0.0, 1e7)
    ],
    properties [outside_format]
}

impl Samples for RepeatedSamples {
    /// Runs that begin at the listed instants, else a share of all rows in runs anywhere, each of about
    /// `repeated_rows_each`. The first row has none to repeat.
    fn apply(&self, values: &Values, drivers: &Drivers, seed: u64, rate: &mut [f64], _keep: &mut [bool]) {
        let n = rate.len();
        let mut repeat = |first: usize, rows: usize| {
            for i in first.max(1)..first.saturating_add(rows).min(n) {
                rate[i] = rate[i - 1];
            }
        };
        let times = list(values, TIMES_LIST);
        if !times.is_empty() {
            for (time, rows) in times.iter().zip(list(values, ROWS_LIST)) {
                let first = ((time - drivers.start_s) / drivers.dt_s).round().clamp(0.0, n as f64) as usize;
                repeat(first, rows.clamp(0.0, n as f64) as usize);
            }
            return;
        }
        let Some(share) = number(values, PARAMS[0].name).filter(|s| *s > 0.0) else { return };
        let each = number(values, PARAMS[1].name).filter(|r| *r >= 1.0).unwrap_or(1.0);
        // A row that repeats is followed by one that does with probability `go_on`, one that does not with `begin`.
        let go_on = 1.0 - 1.0 / each;
        let begin = (share / ((1.0 - share).max(1e-9) * each)).min(1.0);
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut repeats = false;
        for i in 1..n {
            repeats = rng.random::<f64>() < if repeats { go_on } else { begin };
            if repeats {
                repeat(i, 1);
            }
        }
    }

    fn detector(&self) -> Detector {
        Detector::Invalid { test: "repeats", rows: &RepeatedSamples }
    }
}

/// Fewest repeats that are more than chance.
const MIN_REPEATS: usize = 10;
/// Smallest differences that chance is judged by.
const NEAREST_DIFFERENCES: usize = 200;
/// Least share of the differences within one step of the values from which the step is too coarse to tell a repeat by.
const MAX_SHARE_WITHIN_STEP: f64 = 0.1;
/// Differences up to this share of the largest value are rounding of the digits that a number holds.
const DIGIT_ROUNDING: f64 = 1e-9;
/// Density of differences at zero over that of the nearest: a normal law is flatter by far at such shares.
const ZERO_DENSITY_RATIO: f64 = 1.2;

/// Repeats that were found.
#[derive(Debug, Clone, PartialEq)]
struct Repeats {
    /// Places on the grid that repeat the one before them, ascending.
    rows: Vec<usize>,
    /// Rows that had one before them to repeat.
    of: usize,
    /// Gain of log-likelihood over chance.
    gain: f64,
    /// Upper bound of the probability of as many by chance.
    chance: f64,
}

impl Repeats {
    /// Runs of repeats: first place, rows.
    fn runs(&self) -> Vec<(usize, usize)> {
        let mut out: Vec<(usize, usize)> = vec![];
        for row in &self.rows {
            match out.last_mut() {
                Some((first, rows)) if *first + *rows == *row => *rows += 1,
                _ => out.push((*row, 1)),
            }
        }
        out
    }

    /// The shortest stretch of the grid that holds 19 of 20 of them.
    fn stretch(&self) -> Option<(usize, usize)> {
        let held = (0.95 * self.rows.len() as f64).ceil().max(1.0) as usize;
        let stretch = |w: &[usize]| Some((*w.first()?, *w.last()?));
        self.rows.windows(held).filter_map(stretch).min_by_key(|(first, last)| last - first)
    }
}

/// The repeats of a recording. How many chance gives follows from how near to each other successive values come that do not
/// repeat, and from the step of the values: the count of repeats is compared with that of the smallest differences (the
/// conditional test of two Poisson counts, with Chernoff's bound). `None` where there are no more than
/// chance gives, and where the values are rounded too coarsely to tell. The extreme values and zero are left out: a limit
/// and a dead zone repeat those.
fn repeats(recorded: &Rows<'_>) -> Option<Repeats> {
    let (rate, present) = (recorded.rate, recorded.present);
    let pairs = || (1..rate.len().min(present.len())).filter(|i| present[*i] && present[*i - 1]);
    let Bounds { low, high } = ends(rate);
    let held = |i: &usize| rate[*i] == rate[*i - 1];
    let own = |i: &usize| rate[*i] > low && rate[*i] < high && rate[*i] != 0.0;
    let rows: Vec<usize> = pairs().filter(held).filter(own).collect();
    if rows.len() < MIN_REPEATS {
        return None;
    }
    let rounding = DIGIT_ROUNDING * low.abs().max(high.abs());
    let mut apart: Vec<f64> =
        pairs().map(|i| (rate[i] - rate[i - 1]).abs()).filter(|d| *d > rounding).collect();
    let nearest = NEAREST_DIFFERENCES.min(apart.len() / 10);
    if nearest < MIN_REPEATS {
        return None;
    }
    let step = spacing(rate, present, rounding)?;
    let within = *apart.select_nth_unstable_by(nearest - 1, f64::total_cmp).1;
    let near = apart.iter().filter(|d| **d <= within.max(1.5 * step)).count();
    if near as f64 > MAX_SHARE_WITHIN_STEP * apart.len() as f64 {
        return None;
    }
    // Differences up to `within` either way are so many steps; a repeat is one more.
    let steps = 2.0 * (within / step).max(1.0);
    let by_chance = ZERO_DENSITY_RATIO / (ZERO_DENSITY_RATIO + steps);
    let (k, c) = (rows.len() as f64, near as f64);
    let share = k / (k + c);
    if share <= by_chance {
        return None;
    }
    let gain = k * (share / by_chance).ln() + c * ((1.0 - share) / (1.0 - by_chance)).ln();
    Some(Repeats { of: pairs().count(), rows, gain, chance: (-gain).exp() })
}

/// The smallest distance between two values that are not one: their step, or more.
fn spacing(rate: &[f64], present: &[bool], rounding: f64) -> Option<f64> {
    let mut values: Vec<f64> = rate.iter().zip(present).filter(|(_, p)| **p).map(|(v, _)| *v).collect();
    values.sort_ascending();
    values.windows(2).map(|w| w[1] - w[0]).filter(|d| *d > rounding).reduce(f64::min)
}

/// Runs that a claim lists one by one.
const MAX_LISTED_RUNS: usize = 256;

impl RowDetector for RepeatedSamples {
    fn find(&self, rows: &Rows<'_>) -> Option<RowsFound> {
        let found = repeats(rows)?;
        let runs = found.runs();
        let (k, n) = (found.rows.len() as f64, found.of.max(1) as f64);
        let share = k / n;
        let each = k / runs.len().max(1) as f64;
        // Rows of one run repeat together.
        let half = 1.96 * (share * (1.0 - share) * each / n).sqrt();
        let ci95 = [(share - half).max(0.0), (share + half).min(1.0)];
        let mut stated = numbers([(PARAMS[0].name, share), (PARAMS[1].name, each)]);
        if runs.len() <= MAX_LISTED_RUNS {
            let times = runs.iter().map(|r| rows.time_s(r.0)).collect();
            stated.insert(TIMES_LIST.to_owned(), Value::List(times));
            stated.insert(ROWS_LIST.to_owned(), Value::List(runs.iter().map(|r| r.1 as f64).collect()));
        }
        let (first, last) = found.stretch()?;
        let place = Place { domain: Domain::Time, from: rows.time_s(first - 1), to: rows.time_s(last) };
        let detection = Detection {
            reported: vec![Reported::new(PARAMS[0].name, PARAMS[0].unit, share, ci95)],
            stated,
            places: vec![place],
            gain: found.gain,
            parameters: 1,
            p_value: found.chance,
        };
        Some(RowsFound { rows: found.rows, detection })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};

    fn applied(values: &Values, n: usize) -> Vec<f64> {
        let drivers = Drivers { dt_s: 0.5, start_s: 10.0, samples: n, ..Drivers::default() };
        let mut rate: Vec<f64> = (0..n).map(|i| i as f64).collect();
        RepeatedSamples.apply(values, &drivers, 7, &mut rate, &mut []);
        rate
    }

    #[test]
    fn listed_runs_hold_the_value_before_them() {
        let values = Values::from([
            (TIMES_LIST.to_owned(), Value::List(vec![9.0, 11.0, 13.5])),
            (ROWS_LIST.to_owned(), Value::List(vec![1.0, 2.0, 9.0])),
        ]);
        assert_eq!(applied(&values, 9), [0.0, 1.0, 1.0, 1.0, 4.0, 5.0, 6.0, 6.0, 6.0]);
    }

    #[test]
    fn a_share_of_the_rows_repeats_in_runs_of_the_length_asked_for() {
        for (share, each) in [(0.02, 1.0), (0.3, 2.5), (0.8, 10.0)] {
            let values = numbers([("repeated_share", share), ("repeated_rows_each", each)]);
            let rate = applied(&values, 200_000);
            let repeats: Vec<bool> = rate.windows(2).map(|w| w[0] == w[1]).collect();
            let rows = repeats.iter().filter(|r| **r).count() as f64;
            let runs = repeats.windows(2).filter(|w| w[1] && !w[0]).count() as f64;
            assert!((rows / 200_000.0 / share - 1.0).abs() < 0.05, "{share}: {rows}");
            assert!((rows / runs / each - 1.0).abs() < 0.05, "{each}: {}", rows / runs);
        }
    }

    /// Rows at 1 Hz without a gap.
    fn rows<'a>(rate: &'a [f64], present: &'a [bool]) -> Rows<'a> {
        Rows { rate, present, gaps: &[], start_s: 0.0, dt_s: 1.0 }
    }

    fn found(rate: &[f64]) -> Option<Repeats> {
        repeats(&rows(rate, &vec![true; rate.len()]))
    }

    fn white(n: usize, seed: u64) -> Vec<f64> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        (0..n).map(|_| StandardNormal.sample(&mut rng)).collect()
    }

    /// Noise of a slowly changing mean and level, as records have them.
    fn wandering(n: usize, seed: u64) -> Vec<f64> {
        let (mut sum, slow) = (0.0, white(n, seed ^ 0x5a5a));
        let level = |i: usize| 1.0 + 0.9 * (i as f64 / n as f64 * 9.0).sin();
        let walk = white(n, seed).into_iter().enumerate().zip(slow);
        walk.map(|((i, x), s)| {
            sum += 0.1 * s;
            sum + level(i) * x
        })
        .collect()
    }

    #[test]
    fn values_rounded_to_any_step_repeat_no_more_than_chance() {
        for step in [1e-9, 1e-4, 1e-3, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0] {
            for seed in 0..12 {
                for values in [white(6000, seed), wandering(6000, seed)] {
                    let rounded = values.into_iter().map(|x| (x / step).round() * step).collect::<Vec<f64>>();
                    let found = found(&rounded);
                    assert!(found.as_ref().is_none_or(|f| f.chance > 1e-6), "{step} {seed}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn a_percent_of_repeats_is_found_row_by_row() {
        for step in [1e-12, 1e-4, 0.01] {
            let n = 5000;
            let mut rate: Vec<f64> = white(n, 3).into_iter().map(|x| (x / step).round() * step).collect();
            let before = rate.clone();
            let drivers = Drivers { dt_s: 1.0, samples: n, ..Drivers::default() };
            let values = numbers([("repeated_share", 0.02), ("repeated_rows_each", 2.0)]);
            RepeatedSamples.apply(&values, &drivers, 4, &mut rate, &mut []);
            let put: Vec<usize> = (1..n).filter(|i| rate[*i] != before[*i] && rate[*i] != 0.0).collect();
            let found = found(&rate).expect("repeats");
            assert!(found.chance < 1e-12, "{found:?}");
            assert!(put.iter().all(|i| found.rows.contains(i)));
            assert!(found.rows.len() as f64 <= put.len() as f64 + 5.0 + 2.0 * step * n as f64);
            assert!(found.runs().iter().map(|r| r.1).sum::<usize>() == found.rows.len());
        }
    }

    #[test]
    fn an_output_that_keeps_its_value_within_a_band_is_no_coarse_one() {
        let mut rate = white(4000, 5);
        for i in 1..rate.len() {
            if (rate[i] - rate[i - 1]).abs() < 1.2 {
                rate[i] = rate[i - 1];
            }
        }
        let found = found(&rate).expect("repeats");
        assert!(found.chance < 1e-12 && found.rows.len() > 1500, "{}", found.rows.len());
    }

    #[test]
    fn a_stuck_stretch_is_located_and_a_limit_is_none() {
        let mut rate = white(4000, 9);
        rate[1000..1200].fill(0.123);
        let stuck = found(&rate).expect("a stretch");
        let (first, last) = stuck.stretch().expect("a stretch");
        assert!((1001..=1011).contains(&first) && (1189..1200).contains(&last), "{first} {last}");
        let limited = rate.iter().map(|x| x.clamp(-1.5, 1.5)).enumerate();
        let limited: Vec<f64> =
            limited.map(|(i, x)| if (1000..1200).contains(&i) { 0.0 } else { x }).collect();
        assert_eq!(found(&limited), None);
    }
}
