//! The claimed mean at another time than the columns say.

use crate::effect::{Drivers, Regressors};

/// True where the claimed mean varies with the table: only then a delay against its columns can be seen.
pub(in crate::effect) fn claimed_mean_varies(drivers: &Drivers) -> bool {
    let rate = super::reach::varies(drivers.table_rate.as_deref());
    let angle = drivers.claim.earth.is_some() && super::reach::varies(drivers.table_angle.as_deref());
    (rate || angle) && drivers.samples >= 32
}

/// Fourth differences over second ones, and so on, above which a series is not smooth on the scale of its samples: a corner
/// has twice, a step three times.
const MAX_SMOOTH_RATIO: f64 = 1.5;
/// Even differences that are used at most: the eighth.
const MAX_DIFFERENCES: usize = 4;

/// A series between two of its samples. A straight line with Everett's corrections as far as the series is smooth on the
/// scale of its samples: the line alone is exact for means over the sample interval of a rate that changes at the edges
/// of samples.
struct Interpolator<'a> {
    series: &'a [f64],
    /// The sample before.
    at: usize,
    /// Even differences at the two samples, from the second up; those in use.
    differences: [(f64, f64); MAX_DIFFERENCES],
    used: usize,
    /// Within two samples of an end.
    near_end: bool,
}

impl<'a> Interpolator<'a> {
    /// The interpolator of a place; `None` outside the series.
    fn of(series: &'a [f64], place: f64) -> Option<Interpolator<'a>> {
        let last = series.len().checked_sub(1).filter(|last| *last > 0)?;
        if !(place >= 0.0 && place <= last as f64) {
            return None;
        }
        let at = (place as usize).min(last - 1);
        let reach = (MAX_DIFFERENCES + 1).min(at).min(last - at - 1);
        let mut out = Interpolator {
            series,
            at,
            differences: [(0.0, 0.0); MAX_DIFFERENCES],
            used: 0,
            near_end: reach < 2,
        };
        if out.near_end {
            return Some(out);
        }
        // Differences of even order; those at the two samples stand in the middle.
        let mut row = [0.0; 2 * MAX_DIFFERENCES + 4];
        let count = 2 * reach + 2;
        row[..count].copy_from_slice(&series[at - reach..at + reach + 2]);
        let differ = |row: &mut [f64], count: usize| {
            for k in 0..count - 2 {
                row[k] = row[k] - 2.0 * row[k + 1] + row[k + 2];
            }
        };
        let size = |row: &[f64], middle: usize| row[middle].abs().max(row[middle + 1].abs());
        // Most series are not smooth at all, which six samples tell.
        let mut few = [0.0; 6];
        few.copy_from_slice(&row[reach - 2..reach + 4]);
        differ(&mut few, 6);
        let second = size(&few, 1);
        differ(&mut few, 4);
        if size(&few, 0) >= MAX_SMOOTH_RATIO * second {
            return Some(out);
        }
        differ(&mut row, count);
        for level in 1..reach {
            let middle = reach - level;
            let (pair, largest) = ((row[middle], row[middle + 1]), size(&row, middle));
            differ(&mut row, 2 * middle + 2);
            if size(&row, middle - 1) >= MAX_SMOOTH_RATIO * largest {
                break;
            }
            out.differences[out.used] = pair;
            out.used += 1;
        }
        Some(out)
    }

    /// True for a place between the same two samples.
    fn holds(&self, place: f64) -> bool {
        place >= self.at as f64 && place < (self.at + 1) as f64
    }

    /// The series at a place in the interpolator.
    fn value(&self, place: f64) -> f64 {
        let (x, y) = (place - self.at as f64, (self.at + 1) as f64 - place);
        let line = y * self.series[self.at] + x * self.series[self.at + 1];
        if self.near_end {
            return at_an_end(self.series, place).unwrap_or(line);
        }
        let (mut value, mut near, mut far) = (line, y, x);
        for (level, (before, after)) in (1..).zip(&self.differences[..self.used]) {
            let (square, order) = ((level * level) as f64, (2 * level * (2 * level + 1)) as f64);
            (near, far) = (near * (y * y - square) / order, far * (x * x - square) / order);
            value += near * before + far * after;
        }
        value
    }
}

/// A series at a place between its samples; `None` outside.
fn between(series: &[f64], at: f64) -> Option<f64> {
    Interpolator::of(series, at).map(|interpolator| interpolator.value(at))
}

/// The same within two samples of an end: the cubic through the four samples there, where it is smooth.
fn at_an_end(series: &[f64], at: f64) -> Option<f64> {
    let last = series.len().checked_sub(1)?;
    let from_end = at > 0.5 * last as f64;
    let sample = |k: usize| series.get(if from_end { last.checked_sub(k)? } else { k }).copied();
    let s = [sample(0)?, sample(1)?, sample(2)?, sample(3)?, sample(4)?];
    let x = if from_end { last as f64 - at } else { at };
    let second: [f64; 3] = std::array::from_fn(|k| s[k] - 2.0 * s[k + 1] + s[k + 2]);
    let fourth = (second[0] - 2.0 * second[1] + second[2]).abs();
    let smooth = fourth < MAX_SMOOTH_RATIO * second[0].abs().max(second[1].abs());
    let newton = || {
        let cubic = x * (x - 1.0) * (x - 2.0) / 6.0 * (second[1] - second[0]);
        s[0] + x * (s[1] - s[0]) + x * (x - 1.0) / 2.0 * second[0] + cubic
    };
    smooth.then(newton)
}

/// `m(t − lag) − m(t)` for a lag in samples that may differ from sample to sample; zero at samples whose driver lies
/// outside the record, with their ranges.
pub(in crate::effect) fn shifted(mean: &[f64], lag: impl Fn(usize) -> f64) -> (Vec<f64>, Vec<bool>) {
    let mut lost = vec![false; mean.len()];
    let course = mean
        .iter()
        .enumerate()
        .map(|(i, m)| match between(mean, i as f64 - lag(i)) {
            Some(x) => x - m,
            None => {
                lost[i] = true;
                0.0
            }
        })
        .collect();
    (course, lost)
}

/// Columns in one stretch at an end; more would cost more than a record of any length can pay.
const MAX_COLUMNS: usize = 8;

/// Columns that take the lost samples at the ends out of the fit: one for each sample where they are few, else
/// polynomials.
fn ends_out(lost: &[bool]) -> Vec<Vec<f64>> {
    let n = lost.len();
    let head = lost.iter().take_while(|l| **l).count().min(n);
    let tail = lost.iter().rev().take_while(|l| **l).count().min(n - head);
    let mut out = vec![];
    for (from, count) in [(0, head), (n - tail, tail)] {
        for k in 0..count.min(MAX_COLUMNS) {
            let mut column = vec![0.0; n];
            for (j, x) in column[from..from + count].iter_mut().enumerate() {
                *x = if count <= MAX_COLUMNS {
                    if j == k { 1.0 } else { 0.0 }
                } else {
                    // Chebyshev polynomials.
                    let u = (2.0 * j as f64 + 1.0) / count as f64 - 1.0;
                    (k as f64 * u.clamp(-1.0, 1.0).acos()).cos()
                };
            }
            out.push(column);
        }
    }
    out
}

/// Parts of a delayed claimed mean.
pub(in crate::effect) fn regressors(mean: &[f64], lag: impl Fn(usize) -> f64) -> Regressors {
    let (fixed, lost) = shifted(mean, lag);
    Regressors { offset: Some(fixed), nuisance: ends_out(&lost), ..Regressors::default() }
}

/// Improves a number that delays the claimed mean, by Gauss-Newton on white noise over the samples before `until`. Bias
/// and scale factor stay free. `lag` gives the lag of a sample per unit of the number, in samples.
pub(in crate::effect) fn follow(
    residual: &[f64],
    mean: &[f64],
    until: usize,
    start: f64,
    lag: impl Fn(usize) -> f64,
    step: f64,
) -> f64 {
    let until = until.min(residual.len()).min(mean.len());
    let stride = (until / 20_000).max(1);
    let mut at = start;
    for _ in 0..8 {
        let mut sums = Sums::default();
        for i in (0..until).step_by(stride) {
            let place = |x: f64| i as f64 - x * lag(i);
            let Some(interpolator) = Interpolator::of(mean, place(at)) else { continue };
            let of = |place: f64| {
                if interpolator.holds(place) { Some(interpolator.value(place)) } else { between(mean, place) }
            };
            let (Some(more), Some(less)) = (of(place(at + step)), of(place(at - step))) else { continue };
            let here = interpolator.value(place(at));
            sums.add(mean[i], (more - less) / (2.0 * step), residual[i] - (here - mean[i]));
        }
        match sums.coefficient() {
            Some(change) => {
                at += change;
                if change.abs() < STEP_TOLERANCE * step {
                    break;
                }
            }
            None => break,
        }
    }
    at
}

/// Change of the number, in steps of its derivative, at which it has settled.
const STEP_TOLERANCE: f64 = 1e-5;

/// Sums of a regression on a column beside a constant and a mean.
#[derive(Default)]
struct Sums {
    n: f64,
    m: f64,
    c: f64,
    r: f64,
    mm: f64,
    mc: f64,
    mr: f64,
    cc: f64,
    cr: f64,
}

impl Sums {
    fn add(&mut self, m: f64, c: f64, r: f64) {
        self.n += 1.0;
        self.m += m;
        self.c += c;
        self.r += r;
        self.mm += m * m;
        self.mc += m * c;
        self.mr += m * r;
        self.cc += c * c;
        self.cr += c * r;
    }

    /// Coefficient of the column; `None` where the others leave nothing of it.
    fn coefficient(&self) -> Option<f64> {
        let n = self.n.max(1.0);
        let mm = self.mm - self.m * self.m / n;
        let mc = self.mc - self.m * self.c / n;
        let mr = self.mr - self.m * self.r / n;
        let (mut cc, mut cr) = (self.cc - self.c * self.c / n, self.cr - self.c * self.r / n);
        if mm > 1e-12 * self.mm {
            cc -= mc * mc / mm;
            cr -= mc * mr / mm;
        }
        (cc > 1e-12 * self.cc).then(|| cr / cc)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_series_are_shifted_to_high_order_and_steps_stay_within_their_levels() {
        let wave: Vec<f64> = (0..400).map(|i| 36_000.0 * (0.063 * f64::from(i)).sin()).collect();
        let (course, lost) = shifted(&wave, |_| 0.5);
        assert_eq!(lost.iter().filter(|l| **l).count(), 1);
        let off = |i: usize| (course[i] + wave[i] - 36_000.0 * (0.063 * (i as f64 - 0.5)).sin()).abs();
        let worst = |range: std::ops::Range<usize>| range.map(off).fold(0.0, f64::max);
        assert!(worst(6..394) < 1e-6, "{}", worst(6..394));
        // A cubic at the ends, where a line would be off by 18.
        assert!(worst(1..400) < 0.5, "{}", worst(1..400));
        // Seven samples a period.
        let wave: Vec<f64> = (0..400).map(|i| 36_000.0 * (0.9 * f64::from(i)).sin()).collect();
        let (course, _) = shifted(&wave, |_| 0.03);
        let off = |i: usize| (course[i] + wave[i] - 36_000.0 * (0.9 * (i as f64 - 0.03)).sin()).abs();
        assert!((6..394).map(off).fold(0.0, f64::max) < 2.0);
        let step: Vec<f64> = (0..60).map(|i| if i < 30 { 0.0 } else { 100.0 }).collect();
        let (course, _) = shifted(&step, |_| 0.25);
        // A quarter of the sample after the edge still shows the old level.
        assert!((course[30] + 25.0).abs() < 1e-12);
        assert!(course.iter().enumerate().all(|(i, c)| i == 30 || c.abs() < 1e-12));
    }

    #[test]
    fn a_delay_is_followed_to_its_value_past_an_error_of_the_scale_factor() {
        let wave: Vec<f64> =
            (0..2000).map(|i| if i % 300 < 150 { 9.0 } else { (0.05 * i as f64).sin() }).collect();
        let (course, _) = shifted(&wave, |_| 0.37);
        let residual: Vec<f64> = course.iter().zip(&wave).map(|(c, m)| c + 0.01 * m - 4.0).collect();
        let lag = follow(&residual, &wave, 2000, 0.0, |_| 1.0, 0.05);
        assert!((lag - 0.37).abs() < 0.004, "{lag}");
    }

    #[test]
    fn samples_before_the_record_are_taken_out() {
        let wave: Vec<f64> = (0..100).map(|i| (0.1 * f64::from(i)).sin()).collect();
        assert_eq!(regressors(&wave, |_| 3.2).nuisance.len(), 4);
        assert_eq!(regressors(&wave, |_| -20.0).nuisance.len(), MAX_COLUMNS);
        assert!(regressors(&wave, |_| 0.0).nuisance.is_empty());
    }

    #[test]
    fn a_few_lost_samples_get_a_column_each_and_many_get_polynomials() {
        let few = ends_out(&[true, true, false, false, true]);
        assert_eq!(few, [[1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 1.0]]);
        // Chebyshev's 1, u, 2u² − 1, ... at the middles of 16 equal parts of −1 to 1.
        let lost: Vec<bool> = (0..20).map(|i| i >= 4).collect();
        let many = ends_out(&lost);
        assert_eq!(many.len(), MAX_COLUMNS);
        for j in 0..16 {
            let u = (2 * j + 1) as f64 / 16.0 - 1.0;
            for (column, expected) in many.iter().zip([1.0, u, 2.0 * u * u - 1.0, 4.0 * u * u * u - 3.0 * u])
            {
                assert!((column[4 + j] - expected).abs() < 1e-12, "{j}: {column:?}");
            }
        }
        assert!(many.iter().all(|c| c[..4] == [0.0; 4]));
    }

    #[test]
    fn the_coefficient_beside_a_constant_and_a_mean_is_exact_for_what_they_make_up() {
        let mut sums = Sums::default();
        for (m, c) in [(0.0, 1.0), (1.0, 0.5), (3.0, 2.0), (4.0, -1.0), (2.0, 4.0)] {
            sums.add(m, c, 5.0 + 2.0 * m - 3.0 * c);
        }
        assert!((sums.coefficient().unwrap() + 3.0).abs() < 1e-12);
        // A mean that stays leaves the column alone; a column that is the mean has nothing of its own.
        let (mut still, mut same) = (Sums::default(), Sums::default());
        for c in [1.0, 2.0, 4.0] {
            still.add(7.0, c, 1.0 + 0.5 * c);
            same.add(c, 2.0 * c, c);
        }
        assert!((still.coefficient().unwrap() - 0.5).abs() < 1e-12);
        assert_eq!((same.coefficient(), Sums::default().coefficient()), (None, None));
    }

    #[test]
    fn a_mean_moves_with_the_rate_or_with_the_angle_to_the_north() {
        let of = |rate: Option<Vec<f64>>, angle: Option<Vec<f64>>, samples: usize| {
            claimed_mean_varies(&Drivers {
                samples,
                table_rate: rate,
                table_angle: angle,
                ..Drivers::default()
            })
        };
        let turning = || Some((0..32).map(f64::from).collect::<Vec<_>>());
        assert!(of(turning(), None, 32) && !of(turning(), None, 31));
        assert!(!of(Some(vec![3.0; 32]), None, 32));
        // The angle tells nothing as long as the claim has no Earth rate.
        assert!(!of(None, turning(), 32));
    }
}
