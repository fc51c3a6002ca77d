//! The clock from the first stamps of a recording.

use super::buffered::{self, Batches};
use super::bunched::{self, COARSE_SHARE};
use super::nominal::{Cadence, Clock, ClockError, tidy};
use super::refine::{mean, refined, whole_steps};
use super::steps::{departure, steps};
use sagnac_core::numeric::decimal::multiples;

/// Stamps that are compared at a distance to find the interval when they are rounded.
const LAG: usize = 16;

/// Share of intervals off the middle one beyond which the stamps are no plain clock.
const ODD_SHARE: f64 = 0.15;

/// Rows over which rounded stamps must follow a straight line.
const WINDOW: usize = 32;

/// Steps from which the base interval is found where samples are lost.
const SCORED: usize = 4096;

/// Rows between the stamps that are scored.
const LAGS: [usize; 5] = [1, 2, 3, 5, 8];

/// Least share of stamps in step with the base interval.
const MIN_SCORE: f64 = 0.12;

/// Share of samples that a clock of lost samples may miss before rows in batches are the likelier reading.
const DOUBTFUL: f64 = 0.1;

/// Departure from whole multiples of an interval, in intervals, that shows that interval.
const FINELY: f64 = 0.08;

/// Share of stamps earlier than the one before beyond which the column is no clock.
const FALLING_SHARE: f64 = 0.1;

impl Clock {
    /// Finds the clock from the first stamps, with nothing declared.
    ///
    /// # Errors
    /// [`ClockError`] when the stamps cannot serve.
    pub fn probe(stamps: &[f64]) -> Result<Clock, ClockError> {
        Clock::probe_with(stamps, None)
    }

    /// Finds the clock from the first stamps. A declared rate decides only between readings that the stamps allow alike.
    ///
    /// # Errors
    /// [`ClockError`] when the stamps cannot serve.
    pub fn probe_with(stamps: &[f64], declared_hz: Option<f64>) -> Result<Clock, ClockError> {
        let clock = probe(stamps, declared_hz)?;
        // Stamps can grow at nine rows in ten and yet fall or stay on the whole: no clock does.
        let runs = |v: f64| v.is_normal() && v > 0.0;
        if runs(clock.interval_s) && runs(clock.gap_limit_s) {
            Ok(clock)
        } else {
            Err(ClockError::NotGrowing)
        }
    }
}

/// Finds the clock.
///
/// Where the stamps are even but for a few, it is the median interval over 16 rows, which rounding and a few gaps do not
/// disturb, refined by the mean of the single intervals within half of it. Where many samples are lost or the stamps are
/// uneven, it is the longest interval of which all others are whole multiples, refined by following the stamps.
fn probe(stamps: &[f64], declared_hz: Option<f64>) -> Result<Clock, ClockError> {
    let t: Vec<f64> = stamps.iter().copied().filter(|t| t.is_finite()).collect();
    if t.len() < 2 {
        return Err(ClockError::TooFew);
    }
    let equal = steps(&t).filter(|&d| d == 0.0).count();
    let growing = steps(&t).filter(|&d| d > 0.0).count();
    if growing == 0 {
        return Err(ClockError::NotGrowing);
    }
    let share = |count: usize| count as f64 / (t.len() - 1) as f64;
    let falling = share(t.len() - 1 - equal - growing);
    if falling > FALLING_SHARE {
        return Err(ClockError::Falling { share: falling });
    }
    let course = buffered::course(&t);
    let (median, long) = middle(&t);
    let resolution_s = resolution(&t, median);
    let rounded = resolution_s > 0.3 * median && straight(&t, resolution_s) >= 0.5;
    let together = course.is_some_and(|c| !buffered::in_batches(&c) && buffered::occasional_batches(&t, &c));
    let batches = course.filter(|c| !rounded && advances(&t) && (together || buffered::in_batches(c)));
    let steps_of_its_own = batches.filter(|_| !together).and_then(|_| in_step(&t, median, resolution_s));
    if let Some(course) = batches.filter(|_| steps_of_its_own.is_none()) {
        let mut batches = Batches::new(course.mean_s);
        t.iter().for_each(|stamp| batches.push(*stamp));
        let enough = batches.enough();
        if let Some(found) = batches.clock() {
            return Ok(Clock::buffered(&found));
        }
        if enough && short_steps(&t, course.mean_s) {
            let share = share(equal);
            let batches = ClockError::Batches { rate_hz: 1.0 / course.mean_s };
            return Err(if share > COARSE_SHARE { ClockError::Coarse { share } } else { batches });
        }
    }
    if let Some(clock) = bunched::probe(&t) {
        return Ok(clock);
    }
    let share = share(equal);
    if share > COARSE_SHARE && equal > 2 {
        return Err(if advances(&t) { ClockError::Coarse { share } } else { ClockError::NotGrowing });
    }
    let coarse = resolution_s > 0.3 * median;
    let odd = steps(&t).filter(|d| (d / median - 1.0).abs() > 0.3).count() as f64 / (t.len() - 1) as f64;
    let declared_s = declared_hz.map(f64::recip);
    if let Some(n) = every_nth_is_double(&t, resolution_s).filter(|_| rounded) {
        let slower = resolution_s * (1.0 + 1.0 / n as f64);
        let off = |interval_s: f64| declared_s.map(|d| (d / interval_s - 1.0).abs());
        if off(slower).zip(off(resolution_s)).is_none_or(|(slower, whole)| slower >= whole) {
            let mut clock = Clock::even(resolution_s, resolution_s, 1.5 * resolution_s);
            clock.ambiguous_with_s = declared_s.is_none().then_some(slower);
            return Ok(clock);
        }
    }
    if !rounded && (coarse || odd > ODD_SHARE) {
        let clock =
            scored(&t, median, resolution_s).unwrap_or_else(|| plain(&t, median, &long, resolution_s));
        // Many samples lost, and yet as many rows in every stretch: rows in batches fit as well, and nothing decides.
        let lossy = |c: &buffered::Course| clock.interval_s < (1.0 - DOUBTFUL) * c.mean_s;
        return match course.filter(|c| c.bounded && lossy(c) && steps_of_its_own.is_none()) {
            Some(course) => Err(ClockError::Batches { rate_hz: 1.0 / course.mean_s }),
            None => Ok(clock),
        };
    }
    let mut clock = plain(&t, median, &long, resolution_s);
    let ratio = clock.interval_s / resolution_s;
    if rounded && (ratio - ratio.round()).abs() > 1e-3 && resolution_s > 0.3 * clock.interval_s {
        clock.cadence = Cadence::Uneven;
        let followed = refined(clock, &t);
        let ratio = followed.interval_s / resolution_s;
        clock = if (ratio - ratio.round()).abs() > 1e-3 {
            followed
        } else {
            Clock::even(followed.interval_s, resolution_s, 1.5 * followed.interval_s)
        };
    }
    Ok(clock)
}

/// True where the stamps go forward on the whole, not to and fro.
fn advances(t: &[f64]) -> bool {
    let way: f64 = steps(t).map(f64::abs).sum();
    t.last().zip(t.first()).is_some_and(|(last, first)| last - first > 0.5 * way)
}

/// True where most steps are far shorter than the mean and most of the time passes between few rows, as in batches.
fn short_steps(t: &[f64], mean_s: f64) -> bool {
    let long = steps(t).filter(|d| *d > 1.5 * mean_s);
    let (count, time_s) = long.fold((0.0, 0.0), |(n, sum), d| (n + 1.0, sum + d));
    let short = steps(t).filter(|d| *d < 0.4 * mean_s).count() as f64;
    let rows = t.len() as f64;
    short > 0.4 * rows && count > 0.01 * rows && time_s > 0.5 * rows * mean_s
}

/// The interval of which nearly every step is a whole multiple, finely: a clock that loses samples, whatever the pattern.
/// Stamps rounded to steps near that interval show nothing.
fn in_step(t: &[f64], median: f64, resolution_s: f64) -> Option<f64> {
    let tau = scored(t, median, resolution_s)?.interval_s;
    let off = |d: f64| (d / tau - (d / tau).round()).abs();
    let all = t.len().saturating_sub(1).min(SCORED) as f64;
    let near = steps(t).take(SCORED).filter(|d| *d > 0.5 * tau && off(*d) <= FINELY).count() as f64;
    (near >= 0.9 * all && resolution_s <= 0.2 * tau).then_some(tau)
}

/// The median interval over 16 rows, and all of them.
fn middle(t: &[f64]) -> (f64, Vec<f64>) {
    let lag = LAG.min((t.len() / 4).max(1));
    let mut long: Vec<f64> =
        t.iter().zip(t.iter().skip(lag)).map(|(a, b)| (b - a) / lag as f64).filter(|&d| d > 0.0).collect();
    if long.is_empty() {
        long = steps(t).filter(|&d| d > 0.0).collect();
    }
    let middle = long.len() / 2;
    let (_, median, _) = long.select_nth_unstable_by(middle, f64::total_cmp);
    (*median, long)
}

/// The clock of stamps that are even but for a few.
fn plain(t: &[f64], median: f64, long: &[f64], resolution_s: f64) -> Clock {
    let lag = LAG.min((t.len() / 4).max(1));
    // Rounded stamps whose step is near the interval: single intervals spread too far to tell gaps from rounding,
    // so the mean is taken over the long ones.
    let reach = 1.5 * resolution_s / lag as f64;
    let interval_s = if resolution_s > 0.3 * median {
        mean(long.iter().copied().filter(|d| (d - median).abs() <= reach))
    } else {
        mean(steps(t).filter(|&d| d > 0.0 && (d - median).abs() <= 0.5 * median))
    };
    let interval_s = tidy(whole_steps(interval_s.unwrap_or(median), resolution_s));
    let ratio = interval_s / resolution_s;
    let rounded = resolution_s > 0.0 && (ratio - ratio.round()).abs() > 1e-3;
    let slack = if rounded { 1.01 * resolution_s } else { 0.0 };
    Clock::even(interval_s, resolution_s, (1.5 * interval_s).max(interval_s + slack))
}

/// The clock of stamps of which many are lost or uneven: the longest interval with which they are in step.
fn scored(t: &[f64], median: f64, resolution_s: f64) -> Option<Clock> {
    let mut positive: Vec<f64> = steps(t).filter(|d| *d > 0.0 && *d < 12.0 * median).take(SCORED).collect();
    if positive.len() < 8 {
        return None;
    }
    // Steps over several rows have no more jitter than single ones and tell neighbouring intervals apart.
    let apart: Vec<f64> = LAGS
        .iter()
        .flat_map(|lag| {
            let over = t.iter().zip(t.iter().skip(*lag)).map(|(a, b)| b - a);
            over.filter(|d| *d > 0.0 && *d < 40.0 * median).take(SCORED / LAGS.len())
        })
        .collect();
    let in_step = |tau: f64| {
        let sum: f64 = apart.iter().map(|d| (std::f64::consts::TAU * d / tau).cos()).sum();
        sum / apart.len().max(1) as f64
    };
    let mut sorted = positive.clone();
    let low = sorted.len() / 20;
    let (_, least, _) = sorted.select_nth_unstable_by(low, f64::total_cmp);
    let least = *least;
    // Rounded stamps are all in step with their rounding: the shortest interval is at least the shortest step.
    let (from, to) = if resolution_s > 0.05 * median {
        (0.999 * least, (least + 1.001 * resolution_s).min(1.3 * median))
    } else {
        ((0.9 * least).max(median / 8.0), 1.3 * median)
    };
    let count = (((to / from).ln() / 0.004).ceil() as usize).clamp(1, 2000);
    let tried: Vec<(f64, f64)> = (0..=count)
        .map(|i| from * (to / from).powf(i as f64 / count as f64))
        .map(|tau| (tau, in_step(tau)))
        .collect();
    let best = tried.iter().map(|(_, score)| *score).fold(f64::MIN, f64::max);
    if best < MIN_SCORE {
        return None;
    }
    let (mut tau, mut score) = tried.iter().rev().find(|(_, score)| *score >= 0.8 * best).copied()?;
    // To the top of that peak, ever more finely.
    let mut step = 0.004;
    while step > 1e-7 {
        let better = [tau * (1.0 - step), tau * (1.0 + step)]
            .into_iter()
            .map(|t| (t, in_step(t)))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, s)| *s > score);
        match better {
            Some(found) => (tau, score) = found,
            None => step *= 0.5,
        }
    }
    // The phase of each step about whole multiples tells whether single stamps can be compared.
    positive.iter_mut().for_each(|d| *d = (*d / tau - (*d / tau).round()).abs());
    let outside = positive.iter().filter(|d| **d > 0.25).count();
    let whole = (tau / resolution_s - (tau / resolution_s).round()).abs() < 1e-3;
    let even = outside * 50 <= positive.len() && (resolution_s <= 0.3 * tau || whole);
    let mut clock = Clock::even(tau, resolution_s, 1.5 * tau);
    if !even {
        clock.cadence = Cadence::Uneven;
    }
    Some(refined(clock, t))
}

/// The largest power of ten of which all stamps are multiples, 0 when there is none near the interval.
fn resolution(t: &[f64], interval_s: f64) -> f64 {
    let largest = t.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    (-9..=2)
        .rev()
        .map(|e| 10f64.powi(e))
        .filter(|q| *q <= 1.01 * interval_s && *q > 0.01 * interval_s && largest / q < 1e14)
        .find(|q| multiples(t.iter(), *q))
        .unwrap_or(0.0)
}

/// Share of short windows in which the stamps differ from a straight line by no more than their rounding.
fn straight(t: &[f64], resolution_s: f64) -> f64 {
    let window = WINDOW.min(t.len());
    let windows = t.chunks_exact(window);
    let count = windows.len().max(1);
    windows.filter(|w| departure(w) <= 1.2 * resolution_s).count() as f64 / count as f64
}

/// The distance of the double steps, when every interval is one step of the rounding or two, and those of two stand at one distance throughout. A
/// clock that loses every n-th sample writes such stamps, and so does a slower one whose stamps are rounded.
fn every_nth_is_double(t: &[f64], resolution_s: f64) -> Option<usize> {
    let mut doubles: Vec<usize> = Vec::new();
    for (i, d) in steps(t).enumerate() {
        match (d / resolution_s).round() {
            1.0 => {}
            2.0 => doubles.push(i),
            _ => return None,
        }
    }
    let distances: Vec<usize> =
        doubles.iter().zip(doubles.get(1..).unwrap_or_default()).map(|(a, b)| b - a).collect();
    let first = distances.first().copied()?;
    (distances.len() >= 8 && distances.iter().all(|d| *d > 1 && *d == first)).then_some(first)
}
