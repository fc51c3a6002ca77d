//! Samples that repeat the one before them to the last digit, more often than chance has it.

use super::regular::Regular;
use crate::numeric::range::{Bounds, ends};

/// Fewest repeats that are more than chance.
const FEWEST: usize = 10;
/// Smallest differences that chance is judged by.
const NEAREST: usize = 200;
/// Least share of the differences within one step of the values from which the step is too coarse to tell a repeat by.
const COARSE: f64 = 0.1;
/// Differences up to this share of the largest value are rounding of the digits that a number holds.
const ROUNDING: f64 = 1e-9;
/// Density of differences at zero over that of the nearest: a normal law is flatter by far at such shares.
const PEAK: f64 = 1.2;

/// Repeats that were found.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeats {
    /// Places on the grid that repeat the one before them, ascending.
    pub rows: Vec<usize>,
    /// Rows that had one before them to repeat.
    pub of: usize,
    /// Gain of log-likelihood over chance.
    pub gain: f64,
    /// Upper bound of the probability of as many by chance.
    pub chance: f64,
}

impl Repeats {
    /// Runs of repeats: first place, rows.
    pub fn runs(&self) -> Vec<(usize, usize)> {
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
    pub fn stretch(&self) -> Option<(usize, usize)> {
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
pub fn of(regular: &Regular) -> Option<Repeats> {
    let (rate, present) = (&regular.rate, &regular.grid.present);
    let pairs = || (1..rate.len().min(present.len())).filter(|i| present[*i] && present[*i - 1]);
    let Bounds { low, high } = ends(rate);
    let held = |i: &usize| rate[*i] == rate[*i - 1];
    let own = |i: &usize| rate[*i] > low && rate[*i] < high && rate[*i] != 0.0;
    let rows: Vec<usize> = pairs().filter(held).filter(own).collect();
    if rows.len() < FEWEST {
        return None;
    }
    let rounding = ROUNDING * low.abs().max(high.abs());
    let mut apart: Vec<f64> =
        pairs().map(|i| (rate[i] - rate[i - 1]).abs()).filter(|d| *d > rounding).collect();
    let nearest = NEAREST.min(apart.len() / 10);
    if nearest < FEWEST {
        return None;
    }
    let step = spacing(rate, present, rounding)?;
    let within = *apart.select_nth_unstable_by(nearest - 1, f64::total_cmp).1;
    let near = apart.iter().filter(|d| **d <= within.max(1.5 * step)).count();
    if near as f64 > COARSE * apart.len() as f64 {
        return None;
    }
    // Differences up to `within` either way are so many steps; a repeat is one more.
    let steps = 2.0 * (within / step).max(1.0);
    let by_chance = PEAK / (PEAK + steps);
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
    values.sort_unstable_by(f64::total_cmp);
    values.windows(2).map(|w| w[1] - w[0]).filter(|d| *d > rounding).reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Drivers, Value, Values, find};
    use crate::mismatch::regular::Grid;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    fn regular(rate: Vec<f64>) -> Regular {
        let present = vec![true; rate.len()];
        let grid = Grid { dt_s: 1.0, start_s: 0.0, present, gaps: vec![], disordered: 0 };
        Regular { grid, rate, columns: std::collections::BTreeMap::new() }
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
                    let rounded = values.into_iter().map(|x| (x / step).round() * step).collect();
                    let found = of(&regular(rounded));
                    assert!(found.as_ref().is_none_or(|f| f.chance > 1e-6), "{step} {seed}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn a_percent_of_repeats_is_found_row_by_row() {
        let effect = find("repeated_samples").unwrap();
        let crate::effect::Model::Samples(samples) = effect.model() else { panic!("not of single samples") };
        for step in [1e-12, 1e-4, 0.01] {
            let n = 5000;
            let mut rate: Vec<f64> = white(n, 3).into_iter().map(|x| (x / step).round() * step).collect();
            let before = rate.clone();
            let drivers = Drivers { dt_s: 1.0, samples: n, ..Drivers::default() };
            let values = Values::from([
                ("repeated_share".to_owned(), Value::Number(0.02)),
                ("repeated_rows_each".to_owned(), Value::Number(2.0)),
            ]);
            samples.apply(&values, &drivers, 4, &mut rate, &mut []);
            let put: Vec<usize> = (1..n).filter(|i| rate[*i] != before[*i] && rate[*i] != 0.0).collect();
            let found = of(&regular(rate)).expect("repeats");
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
        let found = of(&regular(rate)).expect("repeats");
        assert!(found.chance < 1e-12 && found.rows.len() > 1500, "{}", found.rows.len());
    }

    #[test]
    fn a_stuck_stretch_is_located_and_a_limit_is_none() {
        let mut rate = white(4000, 9);
        rate[1000..1200].fill(0.123);
        let found = of(&regular(rate.clone())).expect("a stretch");
        let (first, last) = found.stretch().expect("a stretch");
        assert!((1001..=1011).contains(&first) && (1189..1200).contains(&last), "{first} {last}");
        let limited = rate.iter().map(|x| x.clamp(-1.5, 1.5)).enumerate();
        let limited = limited.map(|(i, x)| if (1000..1200).contains(&i) { 0.0 } else { x }).collect();
        assert_eq!(of(&regular(limited)), None);
    }
}
