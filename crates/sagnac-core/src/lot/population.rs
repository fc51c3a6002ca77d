//! The population that the units of a lot come from: its median, its spreads, and bounds that hold for a proportion of it.
//!
//! y = μ + lot + unit + error, the error of known deviation for each unit; a unit that is only bounded enters by the probability
//! of a reading below its bound. The distribution of μ and the variances given the values has a prior that gives the exact
//! tolerance factors and Student's intervals where errors are nothing (`restricted`). A bound is the quantile of the distribution of
//! μ + z·σ.

use super::free::{bounding_rank, hanson_koopmans_upper};
use super::normality::normality;
use super::restricted::Lot;
use super::sampler::{Bounded, Draw, draws};
use super::tolerance::{Promise, normal_factor};
use crate::estimate::{normal_probability, normal_quantile, student_quantile};
use crate::numeric::optimize::bisect;
use crate::numeric::order::SortNumbers;
use crate::numeric::order::upper_median;

/// Values (not bounds) below which nothing is promised.
pub const LEAST_VALUES: usize = 5;
/// Lots from which the spread between lots is stated.
pub const LOTS_FOR_SPREAD: usize = 5;
/// The probability of the test of Anderson and Darling below which the law is not taken for normal.
pub const NOT_NORMAL: f64 = 0.05;
/// The share of the variance up to which errors are nothing.
const NEGLIGIBLE_ERROR_SHARE: f64 = 1e-4;
/// Difference of bounds, in the deviation of the values, up to which they are one.
const ONE_BOUND: f64 = 1e-6;

/// A unit on the scale of the population.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Number of its lot, from 0.
    pub lot: usize,
    /// The value or its bound.
    pub reading: Reading,
}

/// The value of a unit, or its bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reading {
    /// A value with its standard uncertainty.
    Value {
        /// Value.
        value: f64,
        /// Standard uncertainty.
        standard: f64,
    },
    /// A reading that is only known to lie below a bound.
    AtMost {
        /// Bound.
        bound: f64,
        /// Standard uncertainty that a value of this unit would have.
        standard: f64,
    },
}

/// The side on which a bound lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Values lie at or below it.
    Upper,
    /// Values lie at or above it.
    Lower,
}

/// Target of a bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Of {
    /// The true value of a unit.
    True,
    /// The value that a test of a unit will give.
    Measured,
}

/// How a bound was obtained.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The exact factor of a normal sample.
    ExactNormal,
    /// The distribution of the quantile of a normal population, with errors, lots and bounded values.
    NormalWithErrors,
    /// An order statistic of the measured values.
    OrderStatistic,
    /// Extrapolation of Hanson and Koopmans from the measured values.
    HansonKoopmans,
}

/// A bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Where it lies.
    pub value: f64,
    /// How it was obtained.
    pub method: Method,
}

/// A value with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Central {
    /// Value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// What the units tell about their population.
#[derive(Debug, Clone, PartialEq)]
pub struct Population {
    values: Vec<f64>,
    bounded: usize,
    below_values: usize,
    common: f64,
    lots: usize,
    measurement: f64,
    draws: Vec<Draw>,
    simple: bool,
    normality: Option<f64>,
}

impl Population {
    /// The population of some units. `None` where no spread can be told: below [`LEAST_VALUES`] values, with a number that is not
    /// finite, or with values that are all the same.
    pub fn of(units: &[Unit]) -> Option<Population> {
        let values: Vec<f64> = units.iter().filter_map(|u| u.value()).collect();
        let (units, below_values) = below_values(units, &values);
        let arranged = Arranged::of(&units)?;
        let mut errors: Vec<f64> = units.iter().filter(|u| u.value().is_some()).map(Unit::standard).collect();
        let measurement = (errors.iter().map(|u| u * u).sum::<f64>() / errors.len() as f64).sqrt();
        errors.sort_ascending();
        let variance = variance(&values);
        if values.len() < LEAST_VALUES || !(variance > 0.0 && variance.is_finite()) {
            return None;
        }
        // Lots can be told apart where one has two units.
        let several = arranged.lots.len() > 1;
        let apart = several && arranged.lots.iter().any(|l| l.values.len() > 1);
        let largest = errors.last().copied().unwrap_or(0.0);
        let simple =
            arranged.bounded.is_empty() && !apart && largest * largest <= NEGLIGIBLE_ERROR_SHARE * variance;
        let draws = draws(&arranged.lots, &arranged.bounded, variance, apart);
        let normality = arranged.bounded.is_empty().then(|| normality(&values)).flatten();
        Some(Population {
            bounded: units.len() - values.len(),
            below_values,
            common: 0.0,
            lots: arranged.lots.len(),
            values,
            measurement,
            draws: draws.into_iter().map(|d| arranged.draw_shifted_back(d)).collect(),
            simple,
            normality,
        })
    }

    /// The population where every value has an error in common besides its own, such as that of the table that all units were
    /// tested on: it moves all of them together, and no number of units averages it out.
    #[must_use]
    pub fn with_common_error(mut self, standard: f64) -> Population {
        self.common = standard.max(0.0);
        self.simple &= self.common == 0.0;
        self
    }

    /// How many units with one bound in common were taken to lie below the values.
    pub fn below_values(&self) -> usize {
        self.below_values
    }

    /// The median of the true values with its interval of some coverage.
    pub fn typical(&self, coverage: f64) -> Central {
        if self.simple {
            let n = self.values.len() as f64;
            let standard = (variance(&self.values) / n).sqrt();
            let reach = student_quantile(0.5 + 0.5 * coverage, n - 1.0) * standard;
            let mean = self.values.iter().sum::<f64>() / n;
            return Central { value: mean, low: mean - reach, high: mean + reach };
        }
        let at = |probability: f64| self.quantile(0.0, 0.0, probability);
        Central { value: at(0.5), low: at(0.5 - 0.5 * coverage), high: at(0.5 + 0.5 * coverage) }
    }

    /// Deviation of the true values of units of a lot, errors of the measurement taken out: the median of its distribution.
    pub fn between_units(&self) -> f64 {
        if self.simple {
            return variance(&self.values).sqrt();
        }
        upper_median(&mut self.draws.iter().map(|d| d.variances.units.sqrt()).collect::<Vec<_>>())
    }

    /// Deviation of the means of lots; `None` below [`LOTS_FOR_SPREAD`] lots.
    pub fn between_lots(&self) -> Option<f64> {
        let mut each: Vec<f64> = self.draws.iter().filter_map(|d| d.variances.lots).map(f64::sqrt).collect();
        (self.lots >= LOTS_FOR_SPREAD && !each.is_empty()).then(|| upper_median(&mut each))
    }

    /// Root mean square of the standard uncertainties of the values.
    pub fn measurement(&self) -> f64 {
        self.measurement
    }

    /// The probability that a normal sample fits worse; `None` where it is not judged: with few values, or bounded ones.
    pub fn normality(&self) -> Option<f64> {
        self.normality
    }

    /// Number of lots.
    pub fn lots(&self) -> usize {
        self.lots
    }

    /// The bound that a promise gives. Where the law is not normal, it is not below what the largest values tell without one.
    pub fn bound(&self, of: Of, side: Side, promise: Promise) -> Option<Bound> {
        let normal = self.normal_bound(of, side, promise)?;
        if self.normality.is_none_or(|p| p >= NOT_NORMAL) {
            return Some(normal);
        }
        let sign = if side == Side::Upper { 1.0 } else { -1.0 };
        let mut ascending: Vec<f64> = self.values.iter().map(|v| sign * v).collect();
        ascending.sort_ascending();
        let free = match bounding_rank(ascending.len(), promise) {
            Some(rank) => {
                let at = ascending.len().checked_sub(rank).and_then(|i| ascending.get(i).copied());
                at.map(|v| (v, Method::OrderStatistic))
            }
            None => hanson_koopmans_upper(&ascending, promise).map(|v| (v, Method::HansonKoopmans)),
        };
        match free {
            Some((value, method)) if value > sign * normal.value => {
                Some(Bound { value: sign * value, method })
            }
            _ => Some(normal),
        }
    }

    fn normal_bound(&self, of: Of, side: Side, promise: Promise) -> Option<Bound> {
        let n = self.values.len() as f64;
        let sign = if side == Side::Upper { 1.0 } else { -1.0 };
        let factor = normal_factor(n, n - 1.0, promise)?;
        if self.simple {
            let mean = self.values.iter().sum::<f64>() / n;
            let value = mean + sign * factor * variance(&self.values).sqrt();
            return Some(Bound { value, method: Method::ExactNormal });
        }
        let error = if of == Of::Measured { self.measurement } else { 0.0 };
        let z = normal_quantile(promise.proportion);
        let probability = if side == Side::Upper { promise.confidence } else { 1.0 - promise.confidence };
        let value = self.quantile(sign * z, error, probability);
        Some(Bound { value, method: Method::NormalWithErrors })
    }

    /// The share of units whose true value lies above a limit: median and interval of some coverage.
    pub fn share_above(&self, limit: f64, coverage: f64) -> Central {
        // The share above is smaller than s where the quantile of 1 − s lies below the limit.
        let at = |probability: f64| {
            let below = |z: f64| distribution(&self.parts(z, 0.0), limit).0 > probability;
            normal_probability(-bisect(-8.0, 8.0, 30, below).middle())
        };
        Central { value: at(0.5), low: at(0.5 - 0.5 * coverage), high: at(0.5 + 0.5 * coverage) }
    }

    /// How many units are only bounded.
    pub fn bounded(&self) -> usize {
        self.bounded
    }

    /// The quantile of the distribution of μ + z·√(σ² + error²).
    fn quantile(&self, z: f64, error: f64, probability: f64) -> f64 {
        let parts = self.parts(z, error);
        let mut low = parts.iter().map(|(m, s)| m - 8.0 * s).fold(f64::INFINITY, f64::min);
        let mut high = parts.iter().map(|(m, s)| m + 8.0 * s).fold(f64::NEG_INFINITY, f64::max);
        // Newton's steps, halved where they lead out of the bracket.
        let close = 1e-13 * (high - low);
        let mut x = 0.5 * (low + high);
        for _ in 0..STEPS_TO_QUANTILE {
            let (below, density) = distribution(&parts, x);
            if below < probability {
                low = x
            } else {
                high = x
            }
            let next = x - (below - probability) / density;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            let step = (next - x).abs();
            x = next;
            if step <= close {
                break;
            }
        }
        x
    }

    /// Mean and deviation of μ + z·√(σ² + error²) in each draw.
    fn parts(&self, z: f64, error: f64) -> Vec<(f64, f64)> {
        let of = |d: &Draw| {
            let deviation = (d.level.variance + self.common * self.common).sqrt();
            (d.level.mean + z * (d.variances.total() + error * error).sqrt(), deviation)
        };
        self.draws.iter().map(of).collect()
    }
}

/// Most steps to a quantile; halving alone needs 44.
const STEPS_TO_QUANTILE: usize = 60;

/// Distribution and density of a mixture of normal laws, each by its mean and deviation.
fn distribution(parts: &[(f64, f64)], x: f64) -> (f64, f64) {
    let (mut below, mut density) = (0.0, 0.0);
    for (mean, deviation) in parts {
        let t = (x - mean) / deviation;
        below += normal_probability(t);
        density += (-0.5 * t * t).exp() / deviation;
    }
    let n = parts.len() as f64;
    (below / n, density / (n * (2.0 * std::f64::consts::PI).sqrt()))
}

impl Unit {
    fn value(&self) -> Option<f64> {
        match self.reading {
            Reading::Value { value, .. } => Some(value),
            Reading::AtMost { .. } => None,
        }
    }

    fn standard(&self) -> f64 {
        match self.reading {
            Reading::Value { standard, .. } | Reading::AtMost { standard, .. } => standard,
        }
    }

    /// Where the reading lies, or what it lies below.
    fn place(&self) -> f64 {
        match self.reading {
            Reading::Value { value, .. } => value,
            Reading::AtMost { bound, .. } => bound,
        }
    }
}

/// Units by lot, about their middle.
struct Arranged {
    lots: Vec<Lot>,
    bounded: Vec<Bounded>,
    middle: f64,
}

impl Arranged {
    fn of(units: &[Unit]) -> Option<Arranged> {
        let right = |u: &Unit| u.place().is_finite() && u.standard().is_finite() && u.standard() >= 0.0;
        if units.is_empty() || !units.iter().all(right) {
            return None;
        }
        let middle = units.iter().map(Unit::place).sum::<f64>() / units.len() as f64;
        let mut names: Vec<usize> = vec![];
        let mut arranged = Arranged { lots: vec![], bounded: vec![], middle };
        for unit in units {
            let lot = names.iter().position(|n| *n == unit.lot).unwrap_or_else(|| {
                names.push(unit.lot);
                arranged.lots.push(Lot::default());
                names.len() - 1
            });
            let into = arranged.lots.get_mut(lot)?;
            let place = unit.place() - middle;
            if unit.value().is_none() {
                arranged.bounded.push(Bounded { lot, at: into.values.len(), most: place });
            }
            into.values.push(place);
            into.variances.push(unit.standard().powi(2));
        }
        Some(arranged)
    }

    fn draw_shifted_back(&self, mut draw: Draw) -> Draw {
        draw.level.mean += self.middle;
        draw
    }
}

/// The units, a bound that several of them have in common moved down to the smallest value, and how many these are.
///
/// Where a unit with a lower reading has a value, such a bound is no place below which readings were not told. It is the
/// confidence limit of a reading that was not told from nothing, and what is known of that reading is that it lies below the
/// values.
fn below_values(units: &[Unit], values: &[f64]) -> (Vec<Unit>, usize) {
    let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let bounds: Vec<f64> = units.iter().filter(|u| u.value().is_none()).map(Unit::place).collect();
    let low = bounds.iter().copied().fold(f64::INFINITY, f64::min);
    let high = bounds.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let is_one = bounds.len() > 1 && high - low <= ONE_BOUND * variance(values).sqrt();
    if !is_one || smallest >= low {
        return (units.to_vec(), 0);
    }
    let moved = |u: &Unit| match u.reading {
        Reading::AtMost { standard, .. } => {
            Unit { reading: Reading::AtMost { bound: smallest, standard }, ..*u }
        }
        Reading::Value { .. } => *u,
    };
    (units.iter().map(moved).collect(), bounds.len())
}

/// Variance with n − 1.
fn variance(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)
}

#[cfg(test)]
mod tests;
