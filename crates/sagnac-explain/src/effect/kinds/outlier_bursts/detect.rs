//! Bursts in a residual.
//!
//! Windows of 1 to 512 samples are compared with the level of the noise on both sides of them; a level that changes, a
//! wrong level of the claim and steps of the output make no burst.

use crate::effect::{Drivers, FlatResidual, Outliers};
use crate::numeric::optimize::bisect;
use crate::numeric::order::SortByNumber;
use crate::numeric::order::{NORMAL_MEDIAN, upper_median};
use crate::numeric::range::ends;
use crate::numeric::special::f_normal;
use crate::numeric::sums::cumulated;
use statrs::distribution::{Binomial, DiscreteCDF, Poisson};
use statrs::function::beta::checked_beta_reg;

/// Longest window, samples.
const MAX_WINDOW_SAMPLES: usize = 512;
/// Largest share of the record that outliers are bursts in.
const MAX_OUTLIER_SHARE: f64 = 0.1;
/// Share of false groups among those set aside (Benjamini and Hochberg 1995).
const FALSE_SHARE: f64 = 0.02;
/// Lengths from which a group differs from a smooth hump, and from a part of a stretch.
const MIN_ROUGH_SAMPLES: usize = 8;
const MIN_STRETCH_SAMPLES: usize = 64;
/// Most humps that belong to a course.
const MAX_HUMPS: usize = 2;
/// Number of rough groups beside which a hump as short is a group too.
const MIN_ROUGH_GROUPS: usize = 3;
/// Groups by size of the table rate.
const RATE_GROUPS: usize = 8;
/// Efficiency of the median of absolute values as an estimate of a deviation.
const MEDIAN_EFFICIENCY: f64 = 0.367_5;

/// Squares over the local level, ready for windows.
struct Scan {
    sums: Vec<f64>,
    others: f64,
    trials: f64,
}

impl Scan {
    fn ratio(&self, first: usize, length: usize) -> f64 {
        (self.sums[first + length] - self.sums[first]) / length as f64
    }

    /// Gain of log-likelihood by a level of its own.
    fn gain(&self, first: usize, length: usize) -> f64 {
        let ratio = self.ratio(first, length);
        if ratio <= 1.0 { 0.0 } else { 0.5 * length as f64 * (ratio - 1.0 - ratio.ln()) }
    }

    /// Probability of so large a ratio in one window.
    fn p_value(&self, length: usize, ratio: f64) -> f64 {
        let dof = length as f64;
        let share = self.others / (self.others + dof * ratio);
        checked_beta_reg(0.5 * self.others, 0.5 * dof, share).map_or(1.0, |p| p.clamp(1e-300, 1.0))
    }

    /// The ratio that a window of some length reaches with probability `p`.
    fn bound(&self, length: usize, p: f64) -> f64 {
        bisect(0.0, 12.0, 40, |x| self.p_value(length, x.exp()) > p).outside.exp()
    }
}

/// Bursts in a residual.
pub(super) fn bursts(flat: &FlatResidual<'_>) -> Option<Outliers> {
    let n = flat.flat.len();
    let longest = MAX_WINDOW_SAMPLES.min(n / 20);
    if longest < 2 {
        return None;
    }
    let (squares, others) = squares(flat);
    let lengths = lengths(longest);
    let trials = lengths.iter().map(|m| ((n - m) / (m / 4).max(1) + 1) as f64).sum();
    let scan = Scan { sums: cumulated(squares.iter().copied()), others, trials };
    let mut windows: Vec<(f64, usize, usize)> = vec![];
    for &m in &lengths {
        let bound = scan.bound(m, 0.5 / trials);
        let mut first = 0;
        while first + m <= n {
            if scan.ratio(first, m) > bound {
                windows.push((scan.gain(first, m), first, m));
            }
            first += (m / 4).max(1);
        }
    }
    windows.sort_descending_by(|a| a.0);
    let mut taken = vec![false; n];
    let mut groups: Vec<(usize, usize)> = vec![];
    for (_, first, m) in windows {
        if taken[first..first + m].iter().any(|t| *t) {
            continue;
        }
        let (first, m) = trimmed(&scan, first, m, &taken);
        taken[first..first + m].fill(true);
        groups.push((first, m));
    }
    let groups = isolated(merged(&scan, groups, n), &scan, flat, longest)?;
    let groups = unmoved(flat.drivers, groups);
    let (groups, p_value) = admitted(&scan, groups);
    if groups.is_empty() {
        return None;
    }
    let samples: Vec<usize> =
        groups.iter().flat_map(|(first, m)| *first..first + m).filter(|i| flat.counts(*i)).collect();
    let k = samples.len() as f64;
    let excess = samples.iter().map(|i| squares[*i]).sum::<f64>() / k;
    let gain = 0.5 * k * (excess - 1.0 - excess.ln());
    let deviation = (samples.iter().map(|i| flat.white[*i].powi(2)).sum::<f64>() / k).sqrt();
    let parameters = 2 * groups.len() + 1;
    let missed = missed(&scan, &groups);
    Some(Outliers { groups, samples, missed, deviation, gain, parameters, p_value })
}

/// Groups that may have been too small to be found.
fn missed(scan: &Scan, groups: &[(usize, usize)]) -> usize {
    let found = groups.len() as f64;
    // The least gain beyond which chance gives no more than the admitted share of false groups.
    let smallest = (scan.trials / (FALSE_SHARE * found.max(1.0))).ln().max(1.0);
    // Gain goes with the square of the size.
    groups.iter().filter(|g| scan.gain(g.0, g.1) < 4.0 * smallest).count()
}

fn lengths(longest: usize) -> Vec<usize> {
    let mut out = vec![1, 2];
    let mut m = 4;
    while m <= 2 * longest {
        out.push(3 * m / 4);
        out.push(m);
        m *= 2;
    }
    out.retain(|m| *m <= longest);
    out
}

/// Squares of the flat residual over the local level, and the degrees of freedom that the level has.
fn squares(flat: &FlatResidual<'_>) -> (Vec<f64>, f64) {
    let n = flat.flat.len();
    let mut sizes: Vec<f64> = flat.flat.iter().map(|e| e.abs()).collect();
    let mut spent = 0.0;
    if let Some(rate) = flat.drivers.table_rate.as_deref().filter(|r| ends(r).is_wide()) {
        // Noise that grows with the rate of the table is no burst each time it turns.
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_ascending_by(|a| rate[*a].abs());
        for group in order.chunks(n.div_ceil(RATE_GROUPS)) {
            let level =
                upper_median(&mut group.iter().map(|i| sizes[*i]).collect::<Vec<f64>>()) / NORMAL_MEDIAN;
            group.iter().for_each(|i| sizes[*i] /= level.max(1e-12));
        }
        spent = RATE_GROUPS as f64 / (MEDIAN_EFFICIENCY * n as f64);
    }
    // Values on a grid differ by whole steps even where nothing happens.
    let least = 0.5 * flat.rounding_step;
    let guard = (MAX_WINDOW_SAMPLES / 2).min(n / 40);
    let width = (n / 6).clamp(24, 4096);
    let stride = (width / 16).max(1);
    let side = |from: usize, to: usize| {
        (to >= from + width / 2).then(|| upper_median(&mut sizes[from..to].to_vec()) / NORMAL_MEDIAN)
    };
    let levels: Vec<f64> = (0..n.div_ceil(stride))
        .map(|s| {
            let at = s * stride + stride / 2;
            let left = at.saturating_sub(guard);
            let right = (at + guard).min(n);
            let before = side(left.saturating_sub(width), left);
            let after = side(right, (right + width).min(n));
            before.unwrap_or(0.0).max(after.unwrap_or(0.0))
        })
        .collect();
    let squares = (0..n)
        .map(|i| {
            let level = levels[i / stride].max(1e-12);
            if flat.counts(i) { sizes[i] * sizes[i] / (level * level + least * least) } else { 1.0 }
        })
        .collect();
    let dof = 1.0 / (spent + 1.0 / (MEDIAN_EFFICIENCY * width as f64));
    (squares, dof)
}

/// Moves the ends of a window while it gains.
fn trimmed(scan: &Scan, mut first: usize, mut m: usize, taken: &[bool]) -> (usize, usize) {
    let n = taken.len();
    let mut best = scan.gain(first, m);
    for _ in 0..2 * MAX_WINDOW_SAMPLES {
        let mut options = vec![];
        for step in [1, 2, 4] {
            if m > step {
                options.extend([(first + step, m - step), (first, m - step)]);
            }
            if first >= step && !taken[first - step..first].iter().any(|t| *t) {
                options.push((first - step, m + step));
            }
            if first + m + step <= n && !taken[first + m..first + m + step].iter().any(|t| *t) {
                options.push((first, m + step));
            }
        }
        let Some(next) = options
            .into_iter()
            .map(|(f, l)| (scan.gain(f, l), f, l))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|o| o.0 > best)
        else {
            break;
        };
        (best, first, m) = next;
    }
    (first, m)
}

/// Neighbours that one group describes as well as two.
fn merged(scan: &Scan, mut groups: Vec<(usize, usize)>, n: usize) -> Vec<(usize, usize)> {
    groups.sort_unstable();
    let cost = (n as f64).ln();
    let mut out: Vec<(usize, usize)> = vec![];
    for next in groups {
        let mut here = next;
        while let Some(last) = out.last().copied() {
            let whole = (last.0, here.0 + here.1 - last.0);
            let apart = scan.gain(last.0, last.1) + scan.gain(here.0, here.1);
            if whole.1 > 4 * MAX_WINDOW_SAMPLES || scan.gain(whole.0, whole.1) < apart - cost {
                break;
            }
            out.pop();
            here = whole;
        }
        out.push(here);
    }
    out
}

/// The groups that stand alone: no part of a longer stretch or of a smooth course, and not everywhere.
fn isolated(
    groups: Vec<(usize, usize)>,
    scan: &Scan,
    flat: &FlatResidual<'_>,
    longest: usize,
) -> Option<Vec<(usize, usize)>> {
    let n = flat.flat.len();
    let covered: usize = groups.iter().map(|g| g.1).sum();
    if covered as f64 > MAX_OUTLIER_SHARE * n as f64 {
        return None;
    }
    let smooth: Vec<bool> = groups.iter().map(|g| is_smooth(g, scan, flat)).collect();
    // One or two humps are a course; many of one sign are outliers of one sign.
    let humps = smooth.iter().filter(|s| **s).count() <= MAX_HUMPS;
    let stretched = |g: &(usize, usize)| g.1 > longest || (g.1 >= MIN_STRETCH_SAMPLES && !rises(g, scan, n));
    // A few samples of a burst are of one sign by chance: among several bursts one as short is another.
    let rough = groups.iter().zip(&smooth).filter(|(g, s)| !**s && !stretched(g)).map(|(g, _)| g.1);
    let (several, widest) = (rough.clone().count() >= MIN_ROUGH_GROUPS, rough.max().unwrap_or(0));
    let hump = |g: &(usize, usize)| humps && !(several && g.1 <= 2 * widest);
    let others: Vec<(usize, usize)> = groups
        .iter()
        .zip(&smooth)
        .filter(|(g, s)| stretched(g) || (**s && hump(g)))
        .map(|(g, _)| *g)
        .collect();
    let near =
        |g: &(usize, usize)| others.iter().any(|s| g.0 < s.0 + 2 * s.1 + 16 && g.0 + g.1 + s.1 + 16 > s.0);
    Some(groups.into_iter().filter(|g| !near(g)).collect())
}

/// True where the content of a group shows in its sums and not in its differences.
fn is_smooth(group: &(usize, usize), scan: &Scan, flat: &FlatResidual<'_>) -> bool {
    let (first, m) = *group;
    if m < MIN_ROUGH_SAMPLES {
        return false;
    }
    let inside = &flat.flat[first..first + m];
    let square = inside.iter().map(|e| e * e).sum::<f64>() / m as f64;
    let rough = inside.windows(2).map(|w| 0.5 * (w[1] - w[0]).powi(2)).sum::<f64>() / (m - 1) as f64;
    let level = square / scan.ratio(first, m).max(1e-12);
    rough - level < 0.4 * (square - level)
}

/// True where a long group is louder than its neighbours on both sides.
fn rises(group: &(usize, usize), scan: &Scan, n: usize) -> bool {
    let (first, m) = *group;
    let gap = m / 4;
    let before = first.checked_sub(m + gap).map_or(0.0, |f| scan.ratio(f, m));
    let after = if first + 2 * m + gap <= n { scan.ratio(first + m + gap, m) } else { 0.0 };
    let here = scan.ratio(first, m);
    f_normal(here / before.max(after).max(1e-9), m as f64, m as f64) > 3.0
}

/// The groups without those at changes of the table's motion, if that is where groups are.
fn unmoved(drivers: &Drivers, mut groups: Vec<(usize, usize)>) -> Vec<(usize, usize)> {
    for rate in [drivers.table_rate.as_deref(), drivers.outer_rate.as_deref()].into_iter().flatten() {
        let n = rate.len();
        if !ends(rate).is_wide() || n < 3 {
            continue;
        }
        let mut steps: Vec<f64> = rate.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
        let largest = steps.iter().copied().fold(0.0, f64::max);
        let moving: Vec<bool> = steps.iter().map(|s| *s > 0.1 * largest).collect();
        if upper_median(&mut steps) > 0.1 * largest {
            continue;
        }
        let sums = cumulated(moving.iter().map(|m| f64::from(u8::from(*m))));
        let met = |g: &(usize, usize)| {
            let (from, to) = (g.0.saturating_sub(3), (g.0 + g.1 + 3).min(n - 1));
            sums[to] > sums[from]
        };
        let hits = groups.iter().filter(|g| met(g)).count();
        let typical = groups.iter().map(|g| g.1 + 6).sum::<usize>() / groups.len().max(1);
        let places = (0..n - 1).step_by(typical.max(1));
        let total = places.clone().count() as f64;
        let share = places.filter(|i| met(&(*i, typical.saturating_sub(6)))).count() as f64 / total;
        let Ok(law) = Binomial::new(share.clamp(0.0, 1.0), groups.len() as u64) else { continue };
        if hits > 0 && law.sf(hits as u64 - 1) < 1e-3 {
            groups.retain(|g| !met(g));
        }
    }
    groups
}

/// The groups of which few are false, by time, and the probability of as many as good.
fn admitted(scan: &Scan, groups: Vec<(usize, usize)>) -> (Vec<(usize, usize)>, f64) {
    let p_of = |g: &(usize, usize)| (scan.p_value(g.1, scan.ratio(g.0, g.1)) * scan.trials, *g);
    let mut rated: Vec<(f64, (usize, usize))> = groups.iter().map(p_of).collect();
    rated.sort_ascending_by(|a| a.0);
    let count = (1..=rated.len()).rev().find(|j| rated[j - 1].0 <= FALSE_SHARE * *j as f64).unwrap_or(0);
    let mut p_value: f64 = 1.0;
    for (j, (expected, _)) in rated.iter().take(count).enumerate() {
        // Weights 1/(j(j + 1)) over the number of groups sum to 1.
        let weight = (j + 1) as f64 * (j + 2) as f64;
        let as_many = Poisson::new(expected.max(1e-290)).map_or(1.0, |law| law.sf(j as u64));
        p_value = p_value.min(weight * as_many.max(1e-300));
    }
    let mut out: Vec<(usize, usize)> = rated.into_iter().take(count).map(|r| r.1).collect();
    out.sort_unstable();
    (out, p_value.min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_double_and_have_their_three_quarters_between() {
        assert_eq!(lengths(16), [1, 2, 3, 4, 6, 8, 12, 16]);
        assert_eq!(lengths(2), [1, 2]);
    }

    #[test]
    fn the_gain_of_a_level_of_its_own_is_half_the_deviance() {
        let squares = [1.0, 1.0, 9.0, 7.0, 1.0];
        let scan = Scan { sums: cumulated(squares.iter().copied()), others: 1e9, trials: 1.0 };
        assert_eq!(scan.ratio(2, 2), 8.0);
        assert!((scan.gain(2, 2) - (7.0 - 8f64.ln())).abs() < 1e-12);
        assert_eq!(scan.gain(0, 2), 0.0);
        // Against a known level the sum of two squares is χ² with 2 degrees of freedom: exp(−x/2).
        assert!((scan.p_value(2, 8.0) / (-8f64).exp() - 1.0).abs() < 1e-5);
        assert!((scan.bound(2, 1e-4) / 1e-4f64.ln().abs() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn neighbours_are_one_group_where_one_describes_them_as_well() {
        let mut squares = vec![1.0; 60];
        squares[20..30].fill(16.0);
        let scan = Scan { sums: cumulated(squares.iter().copied()), others: 1e9, trials: 1.0 };
        assert_eq!(merged(&scan, vec![(25, 5), (20, 5)], 60), [(20, 10)]);
        assert_eq!(trimmed(&scan, 18, 16, &[false; 60]), (20, 10));
        squares[30..50].fill(1.0);
        squares[50..55].fill(16.0);
        let scan = Scan { sums: cumulated(squares.iter().copied()), others: 1e9, trials: 1.0 };
        assert_eq!(merged(&scan, vec![(20, 10), (50, 5)], 60), [(20, 10), (50, 5)]);
    }

    #[test]
    fn a_window_of_one_sample_grows_to_its_group() {
        let mut squares = vec![1.0; 60];
        squares[20..30].fill(16.0);
        let scan = Scan { sums: cumulated(squares.iter().copied()), others: 1e9, trials: 1.0 };
        for m in [1, 2, 4] {
            assert_eq!(trimmed(&scan, 24, m, &[false; 60]), (20, 10), "{m}");
        }
        // Samples that another group has are not taken, and the ends of the record are not passed.
        let mut taken = [false; 60];
        taken[..22].fill(true);
        assert_eq!(trimmed(&scan, 24, 2, &taken), (22, 8));
        let all = Scan { sums: cumulated([16.0; 5].into_iter()), others: 1e9, trials: 1.0 };
        assert_eq!(trimmed(&all, 2, 1, &[false; 5]), (0, 5));
    }

    /// Sizes of normal deviates in any order: quantiles of equal steps, in every stretch from all over the range.
    fn deviates(n: usize) -> Vec<f64> {
        let at = |i: usize| ((i * 2473) % n) as f64 + 0.5;
        (0..n).map(|i| crate::estimate::normal_quantile(at(i) / n as f64)).collect()
    }

    fn residual<'a>(flat: Vec<f64>, usable: &'a [bool], drivers: &'a Drivers) -> FlatResidual<'a> {
        FlatResidual {
            white: flat.clone(),
            flat,
            per_deg_h: 1.0,
            ends: 0,
            usable,
            drivers,
            rounding_step: 0.0,
        }
    }

    #[test]
    fn a_burst_is_found_with_its_samples_and_noise_has_none() {
        let (usable, drivers) = (vec![true; 4000], Drivers::default());
        assert!(bursts(&residual(deviates(4000), &usable, &drivers)).is_none());
        let mut flat = deviates(4000);
        for (k, x) in flat[1503..1515].iter_mut().enumerate() {
            *x = if k % 2 == 0 { 6.0 } else { -6.0 };
        }
        let found = bursts(&residual(flat, &usable, &drivers)).unwrap();
        assert_eq!(
            (&found.groups[..], &found.samples[..]),
            (&[(1503, 12)][..], &(1503..1515).collect::<Vec<_>>()[..])
        );
        assert!((found.deviation - 6.0).abs() < 1e-12 && found.parameters == 3 && found.p_value < 1e-20);
        // ½ k (q − 1 − ln q), with q of 36 over the square of the level beside the burst.
        assert!((found.gain / (6.0 * (35.0 - 36f64.ln())) - 1.0).abs() < 0.15, "{}", found.gain);
        assert!(bursts(&residual(deviates(39), &usable, &drivers)).is_none());
    }

    #[test]
    fn squares_are_over_the_louder_of_both_sides() {
        let (n, usable, drivers) = (6000, vec![true; 6000], Drivers::default());
        let flat: Vec<f64> = (0..n).map(|i| if i < 3000 { 1.0 } else { -3.0 }).collect();
        let (found, dof) = squares(&residual(flat, &usable, &drivers));
        // The median over a half of 1000 samples is the size itself; 150 samples beside the place are left out.
        let own = NORMAL_MEDIAN * NORMAL_MEDIAN;
        for i in [10, 1000, 1500, 3100, 4500, 5990] {
            assert!((found[i] / own - 1.0).abs() < 1e-12, "{i}: {}", found[i]);
        }
        assert!((found[2900] * 9.0 / own - 1.0).abs() < 1e-12, "the louder side: {}", found[2900]);
        assert!((dof - MEDIAN_EFFICIENCY * 1000.0).abs() < 1e-9);
        let counted: Vec<bool> = (0..n).map(|i| i != 77).collect();
        assert_eq!(squares(&residual(vec![5.0; n], &counted, &drivers)).0[77], 1.0);
    }

    #[test]
    fn noise_that_grows_with_the_rate_of_the_table_is_levelled_first() {
        let n = 6000;
        let rate: Vec<f64> = (0..n).map(|i| if i % 750 < 375 { 0.0 } else { 10.0 }).collect();
        let flat: Vec<f64> = rate.iter().map(|r| 1.0 + r).collect();
        let (usable, drivers) = (vec![true; n], Drivers { table_rate: Some(rate), ..Drivers::default() });
        let (found, dof) = squares(&residual(flat, &usable, &drivers));
        // Sizes over their own median over the normal one are 0.674 everywhere, and those over theirs again.
        let own = NORMAL_MEDIAN * NORMAL_MEDIAN;
        assert!(found.iter().all(|s| (s / own - 1.0).abs() < 1e-12));
        // 1/dof = 8/(0.3675·6000) + 1/(0.3675·1000).
        assert!((dof - MEDIAN_EFFICIENCY * 6000.0 / 14.0).abs() < 1e-9, "{dof}");
    }

    #[test]
    fn a_hump_is_smooth_and_a_burst_of_both_signs_is_not() {
        let drivers = Drivers::default();
        let of = |inside: &dyn Fn(usize) -> f64, m: usize| {
            let flat: Vec<f64> =
                (0..60).map(|i| if i < 20 || i >= 20 + m { 1.0 } else { inside(i) }).collect();
            let scan = Scan { sums: cumulated(flat.iter().map(|e| e * e)), others: 1e9, trials: 1.0 };
            is_smooth(&(20, m), &scan, &residual(flat, &[], &drivers))
        };
        assert!(of(&|_| 5.0, 20) && of(&|i| 0.5 * (i as f64 - 19.0), 20));
        assert!(!of(&|i| if i % 2 == 0 { 5.0 } else { -5.0 }, 20));
        // Fewer than eight samples do not tell.
        assert!(of(&|_| 5.0, 8) && !of(&|_| 5.0, 7));
    }

    #[test]
    fn groups_at_the_turns_of_the_table_are_left_out_where_all_are_there() {
        let rate: Vec<f64> = (0..2000).map(|i| if i / 250 % 2 == 0 { 0.0 } else { 10.0 }).collect();
        let table = Drivers { table_rate: Some(rate.clone()), ..Drivers::default() };
        let outer = Drivers { outer_rate: Some(rate), ..Drivers::default() };
        let at = |offset: usize| (1..8).map(|k| (250 * k + offset, 4)).collect::<Vec<_>>();
        for drivers in [table, outer] {
            // The change lies before sample 250; three samples beside a group are counted to it.
            assert!(unmoved(&drivers, at(0)).is_empty());
            assert!(unmoved(&drivers, at(2)).is_empty());
            assert_eq!(unmoved(&drivers, at(100)), at(100));
            // A single one among many is chance: 10 of 2000 places for each of seven changes.
            let mut mixed = at(100);
            mixed.push((250, 4));
            assert_eq!(unmoved(&drivers, mixed.clone()), mixed);
        }
        assert_eq!(unmoved(&Drivers::default(), at(0)), at(0));
    }
}
