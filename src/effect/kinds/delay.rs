//! The claimed mean at another time than the columns say.

use crate::effect::{Drivers, Parts};

/// The claimed mean moves with the table: only then a delay against its columns can be seen.
pub(super) fn moves(drivers: &Drivers) -> bool {
    let rate = super::reach::varies(drivers.table_rate.as_deref());
    let angle = drivers.claim.earth.is_some() && super::reach::varies(drivers.table_angle.as_deref());
    (rate || angle) && drivers.samples >= 32
}

/// Fourth differences over second ones, and so on, above which a series is not smooth on the scale of its samples: a corner
/// has twice, a step three times.
const SMOOTH: f64 = 1.5;
/// Even differences that are used at most: the eighth.
const LEVELS: usize = 4;

/// A series at a place between its samples; `None` outside. A straight line with Everett's corrections as far as the series
/// is smooth on the scale of its samples: the line alone is exact for means over the sample interval of a rate that
/// changes at the edges of samples.
fn between(series: &[f64], at: f64) -> Option<f64> {
    let last = series.len().checked_sub(1)?;
    if !(at >= 0.0 && at <= last as f64) {
        return None;
    }
    let i = (at as usize).min(last.saturating_sub(1));
    let (a, b) = (series[i], *series.get(i + 1)?);
    let (x, y) = (at - i as f64, (i + 1) as f64 - at);
    let line = y * a + x * b;
    let reach = (LEVELS + 1).min(i).min((last - i).saturating_sub(1));
    if reach < 2 {
        return Some(at_an_end(series, at).unwrap_or(line));
    }
    // Differences of even order; those at the two samples about the place stand in the middle.
    let mut row = [0.0; 2 * LEVELS + 4];
    let count = 2 * reach + 2;
    row[..count].copy_from_slice(&series[i - reach..i + reach + 2]);
    let differ = |row: &mut [f64], count: usize| {
        for k in 0..count - 2 {
            row[k] = row[k] - 2.0 * row[k + 1] + row[k + 2];
        }
    };
    let size = |row: &[f64], middle: usize| row[middle].abs().max(row[middle + 1].abs());
    differ(&mut row, count);
    let (mut value, mut near, mut far) = (line, y, x);
    for level in 1..reach {
        let middle = reach - level;
        let (before, after, largest) = (row[middle], row[middle + 1], size(&row, middle));
        differ(&mut row, 2 * middle + 2);
        if size(&row, middle - 1) >= SMOOTH * largest {
            break;
        }
        let (square, order) = ((level * level) as f64, (2 * level * (2 * level + 1)) as f64);
        (near, far) = (near * (y * y - square) / order, far * (x * x - square) / order);
        value += near * before + far * after;
    }
    Some(value)
}

/// As [`between`] within two samples of an end: the cubic through the four samples there, where it is smooth.
fn at_an_end(series: &[f64], at: f64) -> Option<f64> {
    let last = series.len().checked_sub(1)?;
    let from_end = at > 0.5 * last as f64;
    let sample = |k: usize| series.get(if from_end { last.checked_sub(k)? } else { k }).copied();
    let s = [sample(0)?, sample(1)?, sample(2)?, sample(3)?, sample(4)?];
    let x = if from_end { last as f64 - at } else { at };
    let second: [f64; 3] = std::array::from_fn(|k| s[k] - 2.0 * s[k + 1] + s[k + 2]);
    let fourth = (second[0] - 2.0 * second[1] + second[2]).abs();
    let smooth = fourth < SMOOTH * second[0].abs().max(second[1].abs());
    let newton = || {
        let cubic = x * (x - 1.0) * (x - 2.0) / 6.0 * (second[1] - second[0]);
        s[0] + x * (s[1] - s[0]) + x * (x - 1.0) / 2.0 * second[0] + cubic
    };
    smooth.then(newton)
}

/// `m(t − lag) − m(t)` for a lag in samples that may differ from sample to sample; zero at samples whose driver lies
/// outside the record, with their ranges.
pub(super) fn shifted(mean: &[f64], lag: impl Fn(usize) -> f64) -> (Vec<f64>, Vec<bool>) {
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
const MOST: usize = 8;

/// Columns that take the lost samples at the ends out of the fit: one for each sample where they are few, else
/// polynomials.
fn ends_out(lost: &[bool]) -> Vec<Vec<f64>> {
    let n = lost.len();
    let head = lost.iter().take_while(|l| **l).count().min(n);
    let tail = lost.iter().rev().take_while(|l| **l).count().min(n - head);
    let mut out = vec![];
    for (from, count) in [(0, head), (n - tail, tail)] {
        for k in 0..count.min(MOST) {
            let mut column = vec![0.0; n];
            for (j, x) in column[from..from + count].iter_mut().enumerate() {
                *x = if count <= MOST {
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
pub(super) fn parts(mean: &[f64], lag: impl Fn(usize) -> f64) -> Parts {
    let (fixed, lost) = shifted(mean, lag);
    Parts { fixed: Some(fixed), free: vec![], beside: ends_out(&lost) }
}

/// Improves a number that delays the claimed mean, by Gauss-Newton on white noise over the samples before `until`. Bias
/// and scale factor stay free. `lag` gives the lag of a sample per unit of the number, in samples.
pub(super) fn follow(
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
            let place = |x: f64| between(mean, i as f64 - x * lag(i));
            let (Some(here), Some(more), Some(less)) = (place(at), place(at + step), place(at - step)) else {
                continue;
            };
            sums.add(mean[i], (more - less) / (2.0 * step), residual[i] - (here - mean[i]));
        }
        match sums.coefficient() {
            Some(change) => at += change,
            None => break,
        }
    }
    at
}

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
        assert_eq!(parts(&wave, |_| 3.2).beside.len(), 4);
        assert_eq!(parts(&wave, |_| -20.0).beside.len(), MOST);
        assert!(parts(&wave, |_| 0.0).beside.is_empty());
    }
}
