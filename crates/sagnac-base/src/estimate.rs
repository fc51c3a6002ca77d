//! Estimates with their uncertainty, limits, decision rules, verdicts.
//!
//! A value never travels without its uncertainty: [`Estimate`] carries a [`Spread`], the confidence distribution
//! of the quantity, from which every interval, every one-sided bound and every risk is read.
//!
//! Sources: JCGM 100:2008 (GUM), JCGM 106:2012 (specific risk, guard bands), ISO 14253-1:2017 (guard band of
//! one-sided 5 %), ILAC-G8:09/2019 (simple acceptance).

use crate::message::Note;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF};

mod component;
mod decision;
mod distribution;
mod objection;
mod sequential;
mod tail;

pub use component::{CommonTo, Component, ComponentLaw, InputQuantity, UncertaintySource, spread_of};
pub use decision::{Judgement, Limit, Limits, Rule, Verdict, judge};
pub use distribution::student_quantile;
pub use distribution::{chi_square_quantile, normal_probability, normal_quantile};
pub use objection::{Finding, Holds, Objection};
pub use sequential::{Dependence, deciding_scores, spent};
pub use tail::{
    chi_square_tail, chi_square_two_sided, ln_chi_square_tail, ln_chi_square_two_sided, ln_normal_two_sided,
    normal_two_sided,
};

/// Normal score of the ends of a two-sided interval with 95 %.
pub const SCORE_TWO_SIDED_95: f64 = 1.959_963_984_540_054;

/// Normal score of a one-sided bound with 95 %.
pub const SCORE_ONE_SIDED_95: f64 = 1.644_853_626_951_472_2;

/// A two-sided interval with its coverage probability.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Probability with which such intervals contain the true value.
    pub coverage: f64,
}

/// A one-sided bound for a quantity that the record cannot show.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct UpperLimit {
    /// The quantity is at most this much.
    pub value: f64,
    /// Probability with which such bounds lie above the true value.
    pub coverage: f64,
}

/// A one-sided bound from below for a quantity that the record cannot show.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LowerLimit {
    /// The quantity is at least this much.
    pub value: f64,
    /// Probability with which such bounds lie below the true value.
    pub coverage: f64,
}

/// The confidence distribution of an estimate.
#[derive(Debug, Clone, PartialEq)]
pub enum Spread {
    /// Gaussian with a standard uncertainty.
    Normal {
        /// Standard uncertainty, unit of the estimate.
        standard_uncertainty: f64,
    },
    /// Student's t with a standard uncertainty and degrees of freedom.
    StudentT {
        /// Standard uncertainty, unit of the estimate.
        standard_uncertainty: f64,
        /// Effective degrees of freedom.
        dof: f64,
    },
    /// A standard deviation whose square is a scaled χ² with `dof` equivalent degrees of freedom.
    ChiSquare {
        /// Equivalent degrees of freedom.
        dof: f64,
    },
    /// Pairs of (normal score, value), ascending: read off a profile likelihood.
    Curve(Vec<(f64, f64)>),
    /// No uncertainty known: limits cannot be decided with it.
    Unknown,
}

impl Spread {
    /// The spread of a quantity whose value at a normal score is known, tabulated from −3 to 3 in quarters.
    pub fn by_score(value_at: impl Fn(f64) -> f64) -> Spread {
        Spread::Curve((-12..=12).map(|i| 0.25 * f64::from(i)).map(|score| (score, value_at(score))).collect())
    }

    /// The spread whose two-sided interval with 95 % is the given one: normal on either side of the value.
    pub fn of_interval(low: f64, value: f64, high: f64) -> Spread {
        Spread::by_score(|score| {
            let side = if score < 0.0 { value - low } else { high - value };
            value + score / SCORE_TWO_SIDED_95 * side.max(0.0)
        })
    }

    /// The even spread of a time over one resolution on either side of it, and not before zero.
    pub fn of_resolution(time: f64, resolution: f64) -> Spread {
        Spread::by_score(|score| (time + resolution * (2.0 * normal_probability(score) - 1.0)).max(0.0))
    }

    /// The value that the quantity stays below with the given confidence; Student's law is normal beyond 1e6 degrees.
    pub fn bound(&self, value: f64, confidence: f64) -> Option<f64> {
        match self {
            Spread::Normal { standard_uncertainty } => {
                Some(value + normal_quantile(confidence) * standard_uncertainty)
            }
            Spread::StudentT { standard_uncertainty: u, dof } if *dof > 1e6 || *u == 0.0 => {
                Some(value + normal_quantile(confidence) * u)
            }
            Spread::StudentT { standard_uncertainty, dof } => {
                Some(value + distribution::student_quantile(confidence, *dof) * standard_uncertainty)
            }
            Spread::ChiSquare { dof } => {
                let q = chi_square_quantile(1.0 - confidence, *dof);
                (q > 0.0 && value.is_finite()).then(|| value * (dof / q).sqrt())
            }
            Spread::Curve(points) => interpolate(points, normal_quantile(confidence)),
            Spread::Unknown => None,
        }
    }

    /// Probability, in the sense of the confidence distribution, that the quantity lies above `threshold`.
    pub fn probability_above(&self, value: f64, threshold: f64) -> Option<f64> {
        match self {
            Spread::Normal { standard_uncertainty: u } => {
                if *u > 0.0 {
                    Some(1.0 - normal_probability((threshold - value) / u))
                } else {
                    Some(if value > threshold { 1.0 } else { 0.0 })
                }
            }
            Spread::StudentT { standard_uncertainty: u, dof } => {
                (*u > 0.0).then(|| distribution::student_upper_tail((threshold - value) / u, *dof))
            }
            Spread::ChiSquare { dof } => {
                let d = ChiSquared::new(dof.max(1e-3)).ok()?;
                (threshold > 0.0).then(|| d.cdf(dof * (value / threshold).powi(2)))
            }
            Spread::Curve(points) => score_at(points, threshold).map(|z| normal_probability(-z)),
            Spread::Unknown => None,
        }
    }

    /// The spread with an independent normal component of a standard uncertainty added.
    #[must_use]
    pub fn with_component(&self, value: f64, standard: f64) -> Spread {
        if standard == 0.0 {
            return self.clone();
        }
        match self {
            Spread::Normal { standard_uncertainty: u } => {
                Spread::Normal { standard_uncertainty: u.hypot(standard) }
            }
            Spread::StudentT { standard_uncertainty: u, dof } if *u > 0.0 => {
                // JCGM 100:2008, G.4.1: the component has infinitely many degrees of freedom.
                let total = u.hypot(standard);
                Spread::StudentT { standard_uncertainty: total, dof: dof * (total / u).powi(4) }
            }
            Spread::StudentT { .. } => Spread::Normal { standard_uncertainty: standard },
            Spread::ChiSquare { .. } | Spread::Curve(_) => {
                // Each side is widened by itself, so that the law keeps its skewness.
                let middle = self.bound(value, 0.5).unwrap_or(value);
                let scores =
                    (-CURVE_STEPS..=CURVE_STEPS).map(|i| CURVE_SCORE * f64::from(i) / f64::from(CURVE_STEPS));
                let widened = |z: f64| {
                    let from_middle = self.bound(value, normal_probability(z))? - middle;
                    let total = from_middle.hypot(z * standard);
                    Some((z, middle + if z < 0.0 { -total } else { total }))
                };
                Spread::Curve(scores.filter_map(widened).collect())
            }
            Spread::Unknown => Spread::Unknown,
        }
    }

    /// The two-sided interval with the given coverage, equal tails.
    pub fn interval(&self, value: f64, coverage: f64) -> Option<Interval> {
        let tail = 0.5 * (1.0 - coverage);
        let (low, high) = (self.bound(value, tail)?, self.bound(value, 1.0 - tail)?);
        (low.is_finite() && high.is_finite()).then_some(Interval { low, high, coverage })
    }
}

/// Largest normal score of a curve that a component was added to.
const CURVE_SCORE: f64 = 6.0;

/// Points of such a curve on either side.
const CURVE_STEPS: i32 = 48;

/// Normal scores over which the slope of a tail is read.
const TAIL_SCORES: f64 = 1.0;

/// Normal score of a value on a curve. Beyond its ends a normal tail goes on as steep as the last score of the curve: the table
/// ends where draws do, and the probability goes on to fall.
fn score_at(points: &[(f64, f64)], value: f64) -> Option<f64> {
    let (first, last) = (points.first()?, points.last()?);
    let tail = |end: &(f64, f64), inner: Option<&(f64, f64)>| {
        let (z, v) = inner?;
        let slope = (end.1 - v) / (end.0 - z);
        let beyond = (value - end.1) / slope;
        Some(if beyond.is_finite() { end.0 + beyond } else { end.0 })
    };
    if value > last.1 {
        return tail(last, points.iter().rev().find(|p| last.0 - p.0 >= TAIL_SCORES)).or(Some(last.0));
    }
    if value < first.1 {
        return tail(first, points.iter().find(|p| p.0 - first.0 >= TAIL_SCORES)).or(Some(first.0));
    }
    let flipped: Vec<(f64, f64)> = points.iter().map(|(z, v)| (*v, *z)).collect();
    interpolate(&flipped, value)
}

/// Linear interpolation in ascending pairs; the end segments are held, not extended.
fn interpolate(points: &[(f64, f64)], x: f64) -> Option<f64> {
    let (first, last) = (points.first()?, points.last()?);
    if x <= first.0 {
        return Some(first.1);
    }
    if x >= last.0 {
        return Some(last.1);
    }
    let i = points.partition_point(|p| p.0 <= x);
    let (a, b) = (points[i - 1], points[i]);
    Some(if b.0 > a.0 { a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0) } else { a.1 })
}

/// One quantity of one channel: its value with a confidence distribution, or limits where the record cannot show it.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Id of the measurand, for example `angle_random_walk`.
    pub id: &'static str,
    /// Channel it belongs to.
    pub channel: String,
    /// Best value, in the unit below; `None` when the record cannot show it.
    pub value: Option<f64>,
    /// Unit of the value: the one the result contract fixes for this id.
    pub unit: &'static str,
    /// Confidence distribution.
    pub spread: Spread,
    /// Components of its standard uncertainty that equipment and site bring; what the spread holds beside them comes from the
    /// readings.
    pub components: Vec<Component>,
    /// Bound, where the value is `None`.
    pub upper_limit: Option<UpperLimit>,
    /// Where the likelihood is largest, where the value is `None`: no claim, and what errors are counted by.
    pub most_likely: Option<f64>,
    /// Bound from below, where the value is `None`.
    pub lower_limit: Option<LowerLimit>,
    /// Contradictions that checks found: with one of them the estimate decides no more than what still holds.
    pub objections: Vec<Objection>,
    /// How it was obtained, short and stable: `whittle`, `overlapping_allan`, ...
    pub method: &'static str,
    /// What a reader must know with it: conventions, averaging times, numbers of clusters.
    pub notes: Vec<Note>,
}

impl Estimate {
    /// A measured value with its spread.
    pub fn measured(
        id: &'static str,
        channel: &str,
        value: f64,
        unit: &'static str,
        spread: Spread,
        method: &'static str,
    ) -> Self {
        let value = value.is_finite().then_some(value);
        Estimate {
            id,
            channel: channel.to_owned(),
            value,
            unit,
            spread,
            components: vec![],
            upper_limit: None,
            most_likely: None,
            lower_limit: None,
            objections: vec![],
            method,
            notes: vec![],
        }
    }

    /// A quantity the record cannot show, with what it is at most (`None`: nothing can be said).
    pub fn not_identifiable(
        id: &'static str,
        channel: &str,
        upper_limit: Option<UpperLimit>,
        unit: &'static str,
        method: &'static str,
    ) -> Self {
        Estimate {
            id,
            channel: channel.to_owned(),
            value: None,
            unit,
            spread: Spread::Unknown,
            components: vec![],
            upper_limit,
            most_likely: None,
            lower_limit: None,
            objections: vec![],
            method,
            notes: vec![],
        }
    }

    /// The estimate with a note added.
    #[must_use]
    pub fn note(mut self, note: Note) -> Self {
        self.notes.push(note);
        self
    }

    /// The estimate with the value of greatest likelihood added, for a quantity that the record cannot show.
    #[must_use]
    pub fn most_likely(mut self, value: Option<f64>) -> Self {
        self.most_likely = value.filter(|v| v.is_finite());
        self
    }

    /// The estimate with the components that its spread holds beside the scatter of the readings, such as that of the table.
    #[must_use]
    pub fn components(mut self, components: &[Component]) -> Self {
        self.components = components.to_vec();
        self
    }

    /// The estimate with a lower limit added, for a quantity that the record cannot show.
    #[must_use]
    pub fn at_least(mut self, limit: Option<LowerLimit>) -> Self {
        self.lower_limit = limit;
        self
    }

    /// The least that still holds of it where it is contradicted; `None` where it is not.
    pub fn contradicted(&self) -> Option<Holds> {
        self.objections.iter().map(|o| o.finding.holds).min()
    }

    /// The two-sided 95 % interval.
    pub fn interval95(&self) -> Option<Interval> {
        self.spread.interval(self.value?, 0.95)
    }
}

#[cfg(test)]
mod tests;
