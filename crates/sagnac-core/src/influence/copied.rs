//! Whether a run of a series is another one saved again: with noise added or a digit less, backwards, or upside down.
//!
//! The noise of two runs is independent, so that the changes from block to block correlate by chance only.

use crate::rate_table::blocks::Blocks;
use sagnac_fft::{Complex, real_forward, real_inverse};

/// Changes that are compared at most.
const MAX_CHANGES: usize = 20_000;
/// Fewest changes that tell.
const MIN_CHANGES: usize = 64;
/// Correlation from which a run is a copy: noise as large as that of the run itself was added.
const MIN_CORRELATION: f64 = 0.5;
/// Squared correlation times changes from which chance is none, whatever the shift.
const MIN_EVIDENCE: f64 = 40.0;
/// Correlation of a run with itself some blocks later from which it repeats itself, and another run may look the same.
const REPEATS_ITSELF: f64 = 0.3;
/// Squared correlation times changes from which chance at those shifts is none; neighbouring changes share a value, which makes
/// correlations by chance half as large again in square.
const MIN_EVIDENCE_OF_ITSELF: f64 = 30.0;
/// Shifts at which that is looked for: neighbouring changes share a value, and filters reach some values further.
const SHIFTS_OF_ITSELF: std::ops::Range<usize> = 20..200;

/// Two runs that are one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Copied {
    /// The runs, counted from 0.
    pub runs: (usize, usize),
    /// Correlation of their changes; negative upside down.
    pub correlation: f64,
    /// True when one is the other backwards.
    pub backwards: bool,
}

/// The pair of runs that is most alike, where it is one run; `spans` are the blocks of each.
pub fn find(blocks: &Blocks, spans: &[(usize, usize)], gyro: usize) -> Option<Copied> {
    let changes = |(from, to): &(usize, usize)| -> Vec<f64> {
        let list = blocks.list.get(*from..*to).unwrap_or_default();
        let values: Vec<f64> = list.iter().filter_map(|b| b.gyro.get(gyro).copied()).collect();
        changes(&values)
    };
    find_in(&spans.iter().map(changes).collect::<Vec<_>>())
}

/// Changes from value to value about their mean.
fn changes(values: &[f64]) -> Vec<f64> {
    let steps = values.iter().zip(values.get(1..).unwrap_or_default()).map(|(a, b)| b - a);
    let steps: Vec<f64> = steps.filter(|d| d.is_finite()).take(MAX_CHANGES).collect();
    let mean = steps.iter().sum::<f64>() / steps.len().max(1) as f64;
    steps.into_iter().map(|d| d - mean).collect()
}

fn find_in(runs: &[Vec<f64>]) -> Option<Copied> {
    let mut best: Option<Copied> = None;
    for (i, first) in runs.iter().enumerate() {
        if first.len() < MIN_CHANGES || repeats_itself(first) {
            continue;
        }
        for (j, second) in runs.iter().enumerate().skip(i + 1) {
            // Changes of a run that goes backwards are those of the other with the opposite sign.
            let turned: Vec<f64> = second.iter().rev().map(|d| -d).collect();
            for (other, backwards) in [(second, false), (&turned, true)] {
                let correlation = copied_correlation(first, other);
                let larger = best.is_none_or(|b| correlation.abs() > b.correlation.abs());
                if correlation != 0.0 && larger {
                    best = Some(Copied { runs: (i, j), correlation, backwards });
                }
            }
        }
    }
    best
}

/// The correlation at the shift that fits best where it makes one run of two; 0 elsewhere.
fn copied_correlation(a: &[f64], b: &[f64]) -> f64 {
    let at_best = || {
        let (from_a, from_b) = best_shift(a, b)?;
        let (a, b) = (a.get(from_a..)?, b.get(from_b..)?);
        let common = a.len().min(b.len()) as f64;
        correlation(a, b).filter(|r| r.abs() >= MIN_CORRELATION && r * r * common >= MIN_EVIDENCE)
    };
    at_best().unwrap_or(0.0)
}

/// Changes to leave out at the start of each so that the two fit best, either way up.
fn best_shift(a: &[f64], b: &[f64]) -> Option<(usize, usize)> {
    let length = (a.len() + b.len()).next_power_of_two();
    let forward = real_forward(length);
    let spectrum = |values: &[f64]| {
        let mut padded = values.to_vec();
        padded.resize(length, 0.0);
        let mut out = forward.make_output_vec();
        forward.process(&mut padded, &mut out).ok()?;
        Some(out)
    };
    let mut product: Vec<Complex<f64>> =
        spectrum(a)?.iter().zip(&spectrum(b)?).map(|(a, b)| a.conj() * b).collect();
    let inverse = real_inverse(length);
    let mut sums = inverse.make_output_vec();
    inverse.process(&mut product, &mut sums).ok()?;
    let (at, _) = sums.iter().enumerate().max_by(|x, y| x.1.abs().total_cmp(&y.1.abs()))?;
    Some(if at < b.len() { (0, at) } else { (length - at, 0) })
}

fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let n = a.len().min(b.len());
    let (a, b) = (a.get(..n)?, b.get(..n)?);
    let product = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let r = product(a, b) / (product(a, a) * product(b, b)).sqrt();
    (n >= MIN_CHANGES && r.is_finite()).then_some(r)
}

/// True for a run with a line or a pattern of rounding.
fn repeats_itself(run: &[f64]) -> bool {
    let repeats = |shift: usize| {
        let Some(r) = run.get(shift..).and_then(|later| correlation(run, later)) else { return false };
        r.abs() >= REPEATS_ITSELF && r * r * (run.len() - shift) as f64 >= MIN_EVIDENCE_OF_ITSELF
    };
    SHIFTS_OF_ITSELF.into_iter().any(repeats)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    fn noise(seed: u64) -> Vec<f64> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        (0..1000).map(|_| StandardNormal.sample(&mut rng)).collect()
    }

    fn found(series: &[Vec<f64>]) -> Option<Copied> {
        find_in(&series.iter().map(|s| changes(s)).collect::<Vec<_>>())
    }

    #[test]
    fn one_run_saved_again_is_found_and_independent_runs_are_not() {
        let (first, second) = (noise(1), noise(2));
        assert_eq!(found(&[first.clone(), second.clone(), noise(3)]), None);
        let jitter: Vec<f64> = first.iter().zip(noise(4)).map(|(v, j)| 3.0 + v + 0.3 * j).collect();
        let digits: Vec<f64> = first.iter().map(|v| v.round()).collect();
        let reversed: Vec<f64> = first.iter().rev().skip(200).copied().collect();
        let inverted: Vec<f64> = first.iter().map(|v| -v).collect();
        for (copy, backwards, negative) in
            [(jitter, false, false), (digits, false, false), (reversed, true, false), (inverted, false, true)]
        {
            let copied = found(&[second.clone(), first.clone(), copy]).unwrap();
            assert_eq!((copied.runs, copied.backwards), ((1, 2), backwards));
            assert_eq!(copied.correlation < 0.0, negative, "{copied:?}");
        }
    }

    #[test]
    fn short_runs_do_not_repeat_themselves_by_chance() {
        for seed in 0..40 {
            let run: Vec<f64> = noise(seed)[..300].to_vec();
            assert!(found(&[run.clone(), run]).is_some(), "{seed}");
        }
    }

    #[test]
    fn a_line_is_common_to_independent_runs() {
        let with_line = |seed| -> Vec<f64> {
            noise(seed)
                .iter()
                .enumerate()
                .map(|(i, v)| v + 5.0 * (0.9 * i as f64 + seed as f64).sin())
                .collect()
        };
        assert_eq!(found(&[with_line(5), with_line(6)]), None);
    }
}
