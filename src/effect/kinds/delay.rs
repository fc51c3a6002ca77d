//! The claimed mean at another time than the columns say.

use crate::effect::{Drivers, Parts};

/// The claimed mean moves with the table: only then a delay against its columns can be seen.
pub(super) fn moves(drivers: &Drivers) -> bool {
    let rate = super::reach::varies(drivers.table_rate.as_deref());
    let angle = drivers.claim.earth.is_some() && super::reach::varies(drivers.table_angle.as_deref());
    (rate || angle) && drivers.samples >= 32
}

/// A series at a place between its samples; `None` outside. A cubic where the series is smooth on the scale of its
/// samples, else a straight line: that is exact for means over the sample interval of a rate that changes at the edges
/// of samples.
fn between(series: &[f64], at: f64) -> Option<f64> {
    let last = series.len().checked_sub(1)?;
    if !(at >= 0.0 && at <= last as f64) {
        return None;
    }
    let i = (at as usize).min(last.saturating_sub(1));
    let (a, b) = (series[i], *series.get(i + 1)?);
    let x = at - i as f64;
    let line = a + (b - a) * x;
    if i < 2 || i + 3 > last {
        return Some(line);
    }
    let s = &series[i - 2..=i + 3];
    let second: [f64; 4] = std::array::from_fn(|k| s[k] - 2.0 * s[k + 1] + s[k + 2]);
    let largest = second.iter().map(|d| d.abs()).fold(0.0, f64::max);
    let fourth = (0..2).map(|k| (second[k] - 2.0 * second[k + 1] + second[k + 2]).abs()).fold(0.0, f64::max);
    if fourth >= 0.5 * largest {
        return Some(line);
    }
    // Lagrange through four points, written as a correction of the line.
    let (left, right) = (second[1], second[2]);
    Some(line - x * (1.0 - x) / 6.0 * (left * (2.0 - x) + right * (1.0 + x)))
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
        let worst = (3..397)
            .map(|i| (course[i] + wave[i] - 36_000.0 * (0.063 * (i as f64 - 0.5)).sin()).abs())
            .fold(0.0, f64::max);
        assert!(worst < 0.02, "{worst}");
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
