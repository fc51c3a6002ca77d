//! Offset and rate between two clocks from a quantity that both record: the angle of a table against the integral of the
//! rate of a gyro, or one temperature twice.
//!
//! The slower record y at times s of its own clock is y = c₀ + c₁ s + g f(o + (1 + r)(s − s̄) + s̄) + e, where f is the faster
//! record on the other clock. The error e is white noise and a random walk together: noise of an encoder and of the
//! integrated rate, noise of thermometers and what one follows and the other does not. Differences of neighbours have a
//! covariance of three diagonals, so that the likelihood of thousands of samples costs as many steps.

use nalgebra::{DMatrix, DVector};

/// A quantity on one clock: values at increasing times.
#[derive(Debug, Clone, Copy)]
pub struct Timed<'a> {
    /// Times, s.
    pub times_s: &'a [f64],
    /// Values.
    pub values: &'a [f64],
}

/// Offset and rate of a clock against another, with their covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockTie {
    /// Time to add to stamps of the slower record at [`ClockTie::reference_s`], s.
    pub offset_s: f64,
    /// Relative excess of its seconds.
    pub rate: f64,
    /// Middle of its stamps, at which offset and rate are uncorrelated but for the shape of the record, s.
    pub reference_s: f64,
    /// Standard uncertainty of the offset, s.
    pub offset_sd_s: f64,
    /// Standard uncertainty of the rate.
    pub rate_sd: f64,
    /// Covariance of offset and rate, s.
    pub covariance_s: f64,
    /// Values of the slower record per unit of the faster one.
    pub gain: f64,
}

/// Why two clocks cannot be tied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoTie {
    /// Fewer than 16 samples overlap within the range of the search.
    TooFew,
    /// The quantity does not change in a way that both records show.
    Unrelated,
    /// Several offsets fit nearly as well, as in a motion that repeats itself.
    Ambiguous,
}

/// Fewest samples that tie two clocks.
const MIN_SAMPLES: usize = 16;

/// Smallest ratio of the gain to its standard uncertainty at which the records show one quantity.
const MIN_GAIN_RATIO: f64 = 8.0;

/// Log-likelihood by which the best offset must exceed every other peak.
const MIN_LEAD: f64 = 8.0;

/// Ratios of the variance of the random walk in 1 s to that of the white noise that are tried, as powers of 10.
const LOG_RATIOS: std::ops::RangeInclusive<i32> = -12..=12;

/// Offset and rate by which the stamps of `slow` become those of `fast`; offsets up to `range_s` in magnitude are searched.
///
/// # Errors
/// [`NoTie`].
pub fn tie(fast: Timed<'_>, slow: Timed<'_>, range_s: f64) -> Result<ClockTie, NoTie> {
    let model = Model::new(fast, slow, range_s)?;
    let (offset_s, ratio) = model.coarse(range_s)?;
    let mut at = Point { offset_s, rate: 0.0, ratio };
    let mut fit = model.fit(at).ok_or(NoTie::Unrelated)?;
    for _ in 0..30 {
        let next = Point {
            offset_s: at.offset_s + fit.step.0,
            rate: (at.rate + fit.step.1).clamp(-0.01, 0.01),
            ratio: at.ratio,
        };
        let Some(found) = model.fit(next) else { break };
        let small = fit.step.0.abs() < 1e-3 * fit.offset_sd_s && fit.step.1.abs() < 1e-3 * fit.rate_sd;
        (at, fit) = (next, found);
        at.ratio = model.likeliest_ratio(at);
        if small {
            break;
        }
    }
    let fit = model.fit(at).ok_or(NoTie::Unrelated)?;
    if !(fit.gain.abs() > MIN_GAIN_RATIO * fit.gain_sd && fit.offset_sd_s.is_finite()) {
        return Err(NoTie::Unrelated);
    }
    Ok(ClockTie {
        offset_s: at.offset_s,
        rate: at.rate,
        reference_s: model.reference_s,
        offset_sd_s: fit.offset_sd_s,
        rate_sd: fit.rate_sd,
        covariance_s: fit.covariance_s,
        gain: fit.gain,
    })
}

/// Offset, rate, and ratio of the variances of the two kinds of noise, 1/s.
#[derive(Debug, Clone, Copy)]
struct Point {
    offset_s: f64,
    rate: f64,
    ratio: f64,
}

/// A fit of all that is linear at a point, with the step to a better one.
struct Fit {
    log_likelihood: f64,
    gain: f64,
    gain_sd: f64,
    step: (f64, f64),
    offset_sd_s: f64,
    rate_sd: f64,
    covariance_s: f64,
}

/// The two records, restricted to samples of the slower one that the faster one covers at every offset of the search.
struct Model<'a> {
    fast: Timed<'a>,
    times_s: Vec<f64>,
    differences: Vec<f64>,
    steps_s: Vec<f64>,
    reference_s: f64,
    /// Mean interval of the faster record, s.
    interval_s: f64,
}

impl<'a> Model<'a> {
    fn new(fast: Timed<'a>, slow: Timed<'a>, range_s: f64) -> Result<Model<'a>, NoTie> {
        let ends = fast.times_s.first().zip(fast.times_s.last());
        let (first_s, last_s) = ends.map(|(a, b)| (*a, *b)).ok_or(NoTie::TooFew)?;
        let covered = |t: f64| t - range_s > first_s && t + range_s < last_s;
        let kept: Vec<(f64, f64)> = slow
            .times_s
            .iter()
            .copied()
            .zip(slow.values.iter().copied())
            .filter(|(t, v)| covered(*t) && v.is_finite())
            .collect();
        if kept.len() < MIN_SAMPLES {
            return Err(NoTie::TooFew);
        }
        let pairs = || kept.iter().zip(kept.get(1..).unwrap_or_default());
        let differences = pairs().map(|(a, b)| b.1 - a.1).collect();
        let steps_s = pairs().map(|(a, b)| b.0 - a.0).collect();
        let times_s: Vec<f64> = kept.iter().map(|(t, _)| *t).collect();
        let reference_s = times_s.iter().sum::<f64>() / times_s.len() as f64;
        let interval_s = (last_s - first_s) / fast.times_s.len().max(2) as f64;
        Ok(Model { fast, times_s, differences, steps_s, reference_s, interval_s })
    }

    /// Value of the faster record at a time.
    fn value_at(&self, t: f64) -> f64 {
        let (times, values) = (self.fast.times_s, self.fast.values);
        let after = times.partition_point(|x| *x < t).clamp(1, times.len().saturating_sub(1).max(1));
        let pair = |of: &[f64]| Some((*of.get(after - 1)?, *of.get(after)?));
        let (Some((t0, t1)), Some((v0, v1))) = (pair(times), pair(values)) else { return f64::NAN };
        v0 + (v1 - v0) * (t - t0) / (t1 - t0)
    }

    /// Its slope over an interval on either side: a slope of one side alone would hold the noise of the difference that it
    /// explains, and shift the offset.
    fn slope_at(&self, t: f64) -> f64 {
        (self.value_at(t + self.interval_s) - self.value_at(t - self.interval_s)) / (2.0 * self.interval_s)
    }

    /// The offset of the highest likelihood in the range, with the ratio of the noises there.
    fn coarse(&self, range_s: f64) -> Result<(f64, f64), NoTie> {
        let middle_s = self.steps_s.iter().sum::<f64>() / self.steps_s.len().max(1) as f64;
        let count = ((range_s / (0.5 * middle_s)).ceil() as i64).clamp(1, 2000);
        let offset = |i: i64| range_s * i as f64 / count as f64;
        let at = |offset_s: f64, ratio: f64| self.value(Point { offset_s, rate: 0.0, ratio });
        let best_of = |ratio: f64| {
            let values: Vec<(f64, f64)> =
                (-count..=count).map(|i| (offset(i), at(offset(i), ratio))).collect();
            let best = values.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
            (best.unwrap_or((0.0, f64::NEG_INFINITY)), values)
        };
        // The kind of noise is found at the best offset for white noise, then the offset anew.
        let ((first, _), _) = best_of(0.0);
        let ratio = self.likeliest_ratio(Point { offset_s: first, rate: 0.0, ratio: 0.0 });
        let (best, values) = best_of(ratio);
        let peaks = values.windows(3).filter_map(|w| match w {
            [a, b, c] if b.1 >= a.1 && b.1 >= c.1 && b.0 != best.0 => Some(*b),
            _ => None,
        });
        let near = 2.0 * range_s / count as f64;
        let rivals = peaks.filter(|p| (p.0 - best.0).abs() > near && best.1 - p.1 < MIN_LEAD);
        if rivals.count() > 0 {
            return Err(NoTie::Ambiguous);
        }
        Ok((best.0, ratio))
    }

    /// Log-likelihood at a point, all that is linear at its best.
    fn value(&self, at: Point) -> f64 {
        self.fit(at).map_or(f64::NEG_INFINITY, |f| f.log_likelihood)
    }

    /// The ratio of the noises with the highest likelihood.
    fn likeliest_ratio(&self, at: Point) -> f64 {
        let value = |log: f64| self.value(Point { ratio: 10f64.powf(0.5 * log), ..at });
        let coarse = LOG_RATIOS.map(f64::from).max_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap_or(0.0);
        let fine = (-4..=4).map(|i| coarse + 0.2 * f64::from(i));
        10f64.powf(0.5 * fine.max_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap_or(coarse))
    }

    /// Least squares by the covariance of the differences.
    fn fit(&self, at: Point) -> Option<Fit> {
        let placed: Vec<(f64, f64, f64)> = self
            .times_s
            .iter()
            .map(|s| {
                let from_middle = s - self.reference_s;
                let placed = s + at.offset_s + at.rate * from_middle;
                let slope = self.slope_at(placed);
                (self.value_at(placed), slope, slope * from_middle)
            })
            .collect();
        let pairs = || placed.iter().zip(placed.get(1..).unwrap_or_default());
        let noise = Whitener::new(&self.steps_s, at.ratio);
        let column = |of: Vec<f64>| noise.whiten(of);
        let drift = column(self.steps_s.clone());
        let gained = column(pairs().map(|(a, b)| b.0 - a.0).collect());
        let shifted = column(pairs().map(|(a, b)| b.1 - a.1).collect());
        let stretched = column(pairs().map(|(a, b)| b.2 - a.2).collect());
        let data = column(self.differences.clone());
        let n = data.len();
        // Gain and drift first: the likelihood of the point. The other two columns then give the step.
        let two = solve(&[&drift, &gained], &data)?;
        let gain = *two.coefficients.get(1)?;
        let variance = two.squares / n as f64;
        let log_likelihood = -0.5 * n as f64 * variance.ln() - noise.log_scale;
        let by = |c: &[f64]| c.iter().map(|v| v * gain).collect::<Vec<f64>>();
        let (shifted, stretched) = (by(&shifted), by(&stretched));
        let all = solve(&[&drift, &gained, &shifted, &stretched], &data)?;
        let per_sample = all.squares / n.checked_sub(4).filter(|d| *d > 0)? as f64;
        let sd = |i: usize| (all.inverse.get((i, i)).copied().unwrap_or(f64::NAN) * per_sample).sqrt();
        Some(Fit {
            log_likelihood,
            gain,
            gain_sd: sd(1),
            step: (*all.coefficients.get(2)?, *all.coefficients.get(3)?),
            offset_sd_s: sd(2),
            rate_sd: sd(3),
            covariance_s: all.inverse.get((2, 3)).copied().unwrap_or(f64::NAN) * per_sample,
        })
    }
}

/// Turns differences of neighbours into independent numbers of equal variance: the Cholesky factor of a covariance with
/// three diagonals.
struct Whitener {
    diagonal: Vec<f64>,
    below: Vec<f64>,
    /// Logarithm of the determinant of the factor.
    log_scale: f64,
}

impl Whitener {
    fn new(steps_s: &[f64], ratio: f64) -> Whitener {
        // Scaled so that neither a vanishing nor a huge ratio loses digits.
        let scale = 1.0 / (1.0 + ratio);
        let (mut diagonal, mut below): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        for step in steps_s {
            let side = diagonal.last().map_or(0.0, |before: &f64| -scale / before);
            below.push(side);
            diagonal.push((scale * (2.0 + ratio * step) - side * side).max(f64::MIN_POSITIVE).sqrt());
        }
        let log_scale = diagonal.iter().map(|d| d.ln()).sum();
        Whitener { diagonal, below, log_scale }
    }

    fn whiten(&self, mut values: Vec<f64>) -> Vec<f64> {
        let mut before = 0.0;
        for ((value, diagonal), below) in values.iter_mut().zip(&self.diagonal).zip(&self.below) {
            *value = (*value - below * before) / diagonal;
            before = *value;
        }
        values
    }
}

/// Least squares of a few columns.
struct Solved {
    coefficients: Vec<f64>,
    inverse: DMatrix<f64>,
    /// Sum of the squares of what remains.
    squares: f64,
}

fn solve(columns: &[&[f64]], data: &[f64]) -> Option<Solved> {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let sizes: Vec<f64> = columns.iter().map(|c| product(c, c).sqrt().max(f64::MIN_POSITIVE)).collect();
    let k = columns.len();
    let size = |i: usize| sizes.get(i).copied().unwrap_or(1.0);
    let of = |i: usize| columns.get(i).copied().unwrap_or_default();
    let normal = DMatrix::from_fn(k, k, |i, j| product(of(i), of(j)) / (size(i) * size(j)));
    let right = DVector::from_fn(k, |i, _| product(of(i), data) / size(i));
    let inverse = normal.cholesky()?.inverse();
    let scaled = &inverse * right;
    let coefficients: Vec<f64> =
        (0..k).map(|i| scaled.get(i).copied().unwrap_or(f64::NAN) / size(i)).collect();
    let squares = (0..data.len())
        .map(|row| {
            let fitted: f64 =
                columns.iter().zip(&coefficients).map(|(c, x)| c.get(row).copied().unwrap_or(0.0) * x).sum();
            (data.get(row).copied().unwrap_or(0.0) - fitted).powi(2)
        })
        .sum();
    let inverse =
        DMatrix::from_fn(k, k, |i, j| inverse.get((i, j)).copied().unwrap_or(f64::NAN) / (size(i) * size(j)));
    Some(Solved { coefficients, inverse, squares })
}

#[cfg(test)]
#[path = "clock_tie_tests.rs"]
mod tests;
