//! What a record says of the lag, and of what a lag can stand for.
//!
//! A straight line b·T behind a lag τ is, ramps over, b·T − b·τ·dT/dt: the same as a sensitivity to the rate of
//! temperature. With a sensitivity b·τ beside it the lag cancels exactly, so that on a straight line every lag fits as well.
//! A density over the lag would then decide by its own shape. So at a part of the states (noise and play drawn) the
//! likelihood is tabled over the lag with the coefficients at their best, and what is stated of the lag and of a coefficient
//! comes from the profile of the likelihood: an interval holds every value that some lag explains as well (signed roots of the
//! profile, Barndorff-Nielsen and Cox 1994, section 3.3), averaged over the states for what is not known of the noise.
//!
//! Where effects of changing temperature are zero, the lag has no meaning, and the largest likelihood of many lags is larger
//! by chance than that of one (Davies 1977). So roots are read as those of χ² with more degrees of freedom the more of all lags
//! come into question.

use super::read::{self, Reading};
use super::sampler::Draw;
use crate::estimate::{Spread, chi_square_tail, normal_probability, normal_quantile};

/// States at which the likelihood is tabled.
const TABULATED_STATES: usize = 30;
/// Lags of a table.
const TABLE_LAGS: usize = 37;
/// Lags that are tried to find where a table must reach.
const TRIAL_LAGS: usize = 28;
/// Shortest of them, as a share of the longest.
const MIN_LAG_SHARE: f64 = 0.001;
/// Loss of log-likelihood from which a lag is out of question at the best noise.
const MAX_LOG_LIKELIHOOD_LOSS: f64 = 14.0;
/// Loss of log-likelihood up to which a lag comes into question where degrees of freedom are counted.
const IN_QUESTION: f64 = 5.0;
/// Share of the longest lag in question from which on there are more degrees of freedom than one.
const ONE_DOF_LAG_SHARE: f64 = 0.1;
/// Share of the longest lag in question from which on there are [`MOST_DOF`].
const MOST_DOF_LAG_SHARE: f64 = 0.4;
/// Degrees of freedom where every lag comes into question: by simulation of units without any effect, whose largest
/// likelihoods exceed that of no effect as χ² with two to three does.
const MOST_DOF: f64 = 3.0;
/// Points between two lags of a table at which coefficients are read.
const POINTS_PER_LAG: usize = 4;

/// A coefficient at one lag: mean and standard deviation.
pub type Coefficient = (f64, f64);

/// Log-likelihood and coefficients of one posterior draw at one lag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtLag {
    /// Lag, s.
    pub lag_s: f64,
    /// Logarithm of the likelihood with the coefficients at their best.
    pub log_likelihood: f64,
    /// Sensitivity to the rate of temperature.
    pub rate: Option<Coefficient>,
    /// Half of the gap of the hysteresis.
    pub hysteresis: Option<Coefficient>,
}

/// The profile of one posterior draw: its likelihood and coefficients by ascending lag.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Weight of the model that the state belongs to.
    pub weight: f64,
    /// Longest lag that the record was searched for, s.
    pub longest_s: f64,
    /// Lags.
    pub lags: Vec<AtLag>,
}

/// Lags to be tabled, by the log-likelihood at the best noise and by the lags drawn: everything that comes into question.
pub fn grid(draws: &[Draw], longest_s: f64, log_likelihood: impl Fn(f64) -> Option<f64>) -> Vec<f64> {
    let ratio = (1.0 / MIN_LAG_SHARE).powf(1.0 / (TRIAL_LAGS - 2) as f64);
    let tried: Vec<f64> = (0..TRIAL_LAGS)
        .map(|i| if i == 0 { 0.0 } else { longest_s * MIN_LAG_SHARE * ratio.powi(i as i32 - 1) })
        .map(|lag| lag.min(longest_s))
        .collect();
    let logs: Vec<f64> = tried.iter().map(|lag| log_likelihood(*lag).unwrap_or(f64::NEG_INFINITY)).collect();
    let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let drawn = || draws.iter().filter_map(|d| d.shape.first().copied());
    let mut low = drawn().fold(longest_s, f64::min);
    let mut high = drawn().fold(0.0, f64::max);
    for (i, l) in logs.iter().enumerate().filter(|(_, l)| **l > top - MAX_LOG_LIKELIHOOD_LOSS) {
        let _ = l;
        low = low.min(tried[i.saturating_sub(1)]);
        high = high.max(tried[(i + 1).min(TRIAL_LAGS - 1)]);
    }
    let reach = 0.25 * (high - low).max(0.01 * longest_s);
    let (low, high) = ((low - reach).max(0.0), (high + reach).min(longest_s));
    // Denser at short lags where the table begins at none.
    let power = if low < 0.05 * high { 2.0 } else { 1.0 };
    (0..TABLE_LAGS).map(|i| low + (high - low) * (i as f64 / (TABLE_LAGS - 1) as f64).powf(power)).collect()
}

/// The tables at a part of the states; `at_lag` is what a state says at a position of the grid.
pub fn profiles(
    draws: &[Draw],
    (grid, longest_s): (&[f64], f64),
    at_lag: impl Fn(usize, &Draw) -> Option<AtLag>,
) -> Vec<Profile> {
    let step = draws.len().div_ceil(TABULATED_STATES).max(1);
    let table = |draw: &Draw| -> Vec<AtLag> { (0..grid.len()).filter_map(|at| at_lag(at, draw)).collect() };
    let states = draws.iter().skip(step / 2).step_by(step);
    states
        .map(|draw| Profile { weight: 1.0, longest_s, lags: table(draw) })
        .filter(|p| !p.lags.is_empty())
        .collect()
}

impl Profile {
    fn top(&self) -> f64 {
        self.lags.iter().map(|l| l.log_likelihood).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Degrees of freedom that a root is read with.
    fn dof(&self) -> f64 {
        let top = self.top();
        let asked = || self.lags.iter().filter(|l| l.log_likelihood > top - IN_QUESTION).map(|l| l.lag_s);
        let width = asked().fold(0.0, f64::max) - asked().fold(f64::INFINITY, f64::min);
        let share = width / self.longest_s.max(f64::MIN_POSITIVE);
        1.0 + (MOST_DOF - 1.0)
            * ((share - ONE_DOF_LAG_SHARE) / (MOST_DOF_LAG_SHARE - ONE_DOF_LAG_SHARE)).clamp(0.0, 1.0)
    }

    /// Probability of a shorter lag, by the signed root of the profile; it never falls.
    fn share_below(&self, lag_s: f64) -> f64 {
        let best_beyond = |keep: &dyn Fn(f64) -> bool| {
            let whole = self.lags.iter().filter(|l| keep(l.lag_s)).map(|l| l.log_likelihood);
            // The likelihood at the lag itself, between two of the table. Beyond its ends a lag is out of question.
            let at = self.lags.partition_point(|l| l.lag_s < lag_s);
            let here = match (at.checked_sub(1).and_then(|i| self.lags.get(i)), self.lags.get(at)) {
                (Some(a), Some(b)) => {
                    let share = (lag_s - a.lag_s) / (b.lag_s - a.lag_s).max(f64::MIN_POSITIVE);
                    a.log_likelihood + share * (b.log_likelihood - a.log_likelihood)
                }
                (None, Some(l)) if l.lag_s <= lag_s => l.log_likelihood,
                _ => f64::NEG_INFINITY,
            };
            whole.fold(here, f64::max)
        };
        root((self.top(), self.dof()), best_beyond(&|l| l <= lag_s), best_beyond(&|l| l >= lag_s))
    }

    /// Coefficients of all lags, those between two of the table by straight lines.
    fn coefficients(&self, of: impl Fn(&AtLag) -> Option<Coefficient>) -> Vec<(f64, f64, f64)> {
        let one = |l: &AtLag| of(l).map(|(mean, deviation)| (l.log_likelihood, mean, deviation));
        let known: Vec<(f64, f64, f64)> = self.lags.iter().filter_map(one).collect();
        let mut all: Vec<(f64, f64, f64)> = known.last().copied().into_iter().collect();
        for (a, b) in known.iter().zip(known.iter().skip(1)) {
            for k in 0..POINTS_PER_LAG {
                let share = k as f64 / POINTS_PER_LAG as f64;
                let between = |a: f64, b: f64| a + share * (b - a);
                all.push((between(a.0, b.0), between(a.1, b.1), between(a.2, b.2)));
            }
        }
        all
    }
}

/// Probability of less, by the signed root: `lower` and `higher` are the best log-likelihoods of a value at most and at least
/// as large as the one in question. Where both are the largest there is, nothing tells on which side the truth lies.
fn root((top, dof): (f64, f64), lower: f64, higher: f64) -> f64 {
    let of = |best: f64| {
        let twice = (2.0 * (top - best)).max(0.0);
        if twice.is_infinite() {
            return f64::INFINITY;
        }
        if dof <= 1.0 { twice.sqrt() } else { normal_quantile(1.0 - 0.5 * chi_square_tail(twice, dof)) }
    };
    normal_probability(of(higher) - of(lower))
}

/// The lag with its spread.
pub fn reading(parts: &[Profile]) -> Reading {
    let ends = || parts.iter().flat_map(|p| [p.lags.first(), p.lags.last()]).flatten().map(|l| l.lag_s);
    let range = (ends().fold(f64::INFINITY, f64::min), ends().fold(0.0, f64::max));
    mixed(parts, range, |i, lag| parts[i].share_below(lag))
}

/// A coefficient with its spread, every lag that explains the record as well included.
pub fn coefficient(parts: &[Profile], of: impl Fn(&AtLag) -> Option<Coefficient>) -> Reading {
    let tables: Vec<Vec<(f64, f64, f64)>> = parts.iter().map(|p| p.coefficients(&of)).collect();
    let near = || {
        parts
            .iter()
            .zip(&tables)
            .flat_map(|(p, t)| {
                let top = p.top();
                t.iter().filter(move |c| c.0 > top - MAX_LOG_LIKELIHOOD_LOSS)
            })
            .map(|c| (c.1, 6.0 * c.2))
    };
    let low = near().map(|(m, r)| m - r).fold(f64::INFINITY, f64::min);
    let high = near().map(|(m, r)| m + r).fold(f64::NEG_INFINITY, f64::max);
    let tops: Vec<(f64, f64)> = parts.iter().map(|p| (p.top(), p.dof())).collect();
    mixed(parts, (low, high), |i, x| {
        let table = &tables[i];
        let best = |sign: f64| {
            let loss = |mean: f64, deviation: f64| {
                let off = (sign * (x - mean)).max(0.0) / deviation.max(f64::MIN_POSITIVE);
                0.5 * off * off
            };
            table.iter().map(|(l, m, d)| l - loss(*m, *d)).fold(f64::NEG_INFINITY, f64::max)
        };
        root(tops[i], best(-1.0), best(1.0))
    })
}

/// Mean and standard deviation of a coefficient at the shortest lag of the tables.
pub fn at_shortest(parts: &[Profile], of: impl Fn(&AtLag) -> Option<Coefficient>) -> Option<Coefficient> {
    let (mut weights, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for p in parts {
        let (mean, deviation) = p.lags.first().and_then(&of)?;
        weights += p.weight;
        sum += p.weight * mean;
        squares += p.weight * (mean * mean + deviation * deviation);
    }
    let mean = sum / weights;
    (weights > 0.0).then(|| (mean, (squares / weights - mean * mean).max(0.0).sqrt()))
}

fn mixed(parts: &[Profile], range: (f64, f64), below: impl Fn(usize, f64) -> f64) -> Reading {
    let total: f64 = parts.iter().map(|p| p.weight).sum();
    if parts.is_empty() || !range.0.is_finite() || !range.1.is_finite() {
        return Reading { value: f64::NAN, spread: Spread::Unknown };
    }
    read::of_distribution(
        |x| parts.iter().enumerate().map(|(i, p)| p.weight * below(i, x)).sum::<f64>() / total,
        range,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(lags: impl Iterator<Item = (f64, f64, Coefficient)>) -> Profile {
        let one = |(lag_s, log_likelihood, rate)| AtLag {
            lag_s,
            log_likelihood,
            rate: Some(rate),
            hysteresis: None,
        };
        Profile { weight: 1.0, longest_s: 1e9, lags: lags.map(one).collect() }
    }

    #[test]
    fn a_normal_likelihood_gives_the_interval_of_a_normal() {
        let lag = |i: i32| 300.0 + 10.0 * f64::from(i);
        let log = |lag: f64| -0.5 * ((lag - 600.0) / 50.0).powi(2);
        let found = reading(&[table((0..61).map(|i| (lag(i), log(lag(i)), (0.0, 1.0))))]);
        let interval = found.spread.interval(found.value, 0.95).unwrap();
        assert!((found.value - 600.0).abs() < 2.0, "{found:?}");
        assert!((interval.low - 502.0).abs() < 3.0 && (interval.high - 698.0).abs() < 3.0, "{interval:?}");
    }

    #[test]
    fn a_coefficient_that_follows_a_lag_nothing_tells_spans_all_of_it() {
        // Every lag as likely, the coefficient in step with it from 0 to 4.
        let parts = [table((0..=40).map(|i| (f64::from(i), 0.0, (0.1 * f64::from(i), 0.01))))];
        let found = coefficient(&parts, |l| l.rate);
        let i = found.spread.interval(found.value, 0.95).unwrap();
        assert!((i.low + 0.0196).abs() < 0.003 && (i.high - 4.0196).abs() < 0.003, "{i:?}");
        // Neither side of a limit within is shown.
        for limit in [0.1, 1.0, 3.9] {
            let above = found.spread.probability_above(found.value, limit).unwrap();
            assert!((above - 0.5).abs() < 0.05, "{limit}: {above}");
        }
        assert_eq!(at_shortest(&parts, |l| l.rate).map(|c| c.0), Some(0.0));
    }

    #[test]
    fn where_all_lags_come_into_question_more_is_needed_to_exclude_a_value() {
        let all = |longest_s: f64| Profile {
            longest_s,
            ..table((0..=40).map(|i| (f64::from(i), 0.0, (0.0, 1.0))))
        };
        let bound = |longest_s: f64| {
            let found = coefficient(&[all(longest_s)], |l| l.rate);
            found.spread.interval(found.value, 0.95).unwrap().high
        };
        assert!((bound(1e9) - 1.96).abs() < 0.01 && (bound(40.0) - 7.815f64.sqrt()).abs() < 0.02);
    }

    #[test]
    fn a_lag_that_is_told_leaves_the_coefficient_its_own_interval() {
        let log = |i: i32| -0.5 * (f64::from(i - 20) / 0.05).powi(2);
        let parts = [table((0..=40).map(|i| (f64::from(i), log(i), (0.1 * f64::from(i), 0.01))))];
        let found = coefficient(&parts, |l| l.rate);
        let i = found.spread.interval(found.value, 0.95).unwrap();
        assert!((i.low - 1.98).abs() < 0.005 && (i.high - 2.02).abs() < 0.005, "{i:?}");
    }

    #[test]
    fn models_count_by_their_weights() {
        let at = |lag: f64, weight: f64| Profile {
            weight,
            ..table([(lag, 0.0, (0.0, 1.0)), (lag + 1.0, 0.0, (0.0, 1.0))].into_iter())
        };
        let found = reading(&[at(100.0, 3.0), at(900.0, 1.0)]);
        let bound = |p: f64| found.spread.bound(found.value, p).unwrap();
        assert!(bound(0.70) < 102.0 && bound(0.80) > 899.0, "{} {}", bound(0.70), bound(0.80));
    }
}
