//! Limits, decision rules, verdicts.

use super::{Estimate, Spread};
use serde::{Deserialize, Serialize};

/// How a measured value with its uncertainty is compared with a limit.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// The value itself is compared; the risk of a wrong decision is shared (ILAC-G8). Up to 50 % at the limit.
    Simple,
    /// The one-sided bound at the stated risk is compared (JCGM 106, ISO 14253-1).
    #[default]
    GuardBand,
}

/// Limits of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "HistoryLimit"))]
pub struct Limits {
    /// Lower limit.
    pub min: Option<f64>,
    /// Upper limit.
    pub max: Option<f64>,
}

impl Limits {
    /// True where there is neither.
    pub fn is_empty(self) -> bool {
        self.min.is_none() && self.max.is_none()
    }
}

/// A limit on one quantity of a unit, with its decision rule.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// Lowest value allowed, in the unit of the estimate.
    pub min: Option<f64>,
    /// Highest value allowed, in the unit of the estimate.
    pub max: Option<f64>,
    /// Decision rule.
    pub rule: Rule,
    /// Risk of a wrong acceptance (and of a wrong rejection) that the guard band is set for.
    pub risk: f64,
    /// File the limit was read from.
    pub source: String,
}

impl Limit {
    /// Largest magnitude that it allows; `None` where it allows any.
    pub fn largest_magnitude(&self) -> Option<f64> {
        match (self.min, self.max) {
            (Some(low), Some(high)) => Some(low.abs().max(high.abs())),
            (one, other) => one.or(other).map(f64::abs),
        }
    }
}

/// The verdict of a row or of a whole run. Worst wins, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing was to be decided.
    #[default]
    None,
    /// The requirement is shown to be met.
    Pass,
    /// Neither met nor broken, as far as this test shows.
    Indeterminate,
    /// The requirement is shown not to be met.
    Fail,
    /// The test could not be carried out as required.
    Error,
}

impl Verdict {
    /// The id used in files and tables.
    pub fn id(self) -> &'static str {
        match self {
            Verdict::None => "none",
            Verdict::Pass => "pass",
            Verdict::Indeterminate => "indeterminate",
            Verdict::Fail => "fail",
            Verdict::Error => "error",
        }
    }
}

/// The outcome of comparing an estimate with a limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// The verdict.
    pub verdict: Verdict,
    /// The largest measured value that would be accepted under `max`.
    pub acceptance_max: Option<f64>,
    /// The smallest measured value that would be accepted under `min`.
    pub acceptance_min: Option<f64>,
    /// Probability that the unit lies outside the limit, given what was measured (JCGM 106, specific risk).
    pub specific_risk: Option<f64>,
    /// Distance to the nearest limit, positive inside, unit of the estimate.
    pub margin: Option<f64>,
}

/// Compares an estimate with a limit under the decision rule of the limit.
///
/// A quantity that the record cannot show passes when its bounds are inside the limit, fails when one of them is beyond it, and
/// is otherwise indeterminate. Whether one that can be negative may pass by bounds is for the caller to know.
pub fn judge(estimate: &Estimate, limit: &Limit) -> Judgement {
    let Some(value) = estimate.value else { return judge_bounds(estimate, limit) };
    let margin = [limit.max.map(|max| max - value), limit.min.map(|min| value - min)]
        .into_iter()
        .flatten()
        .reduce(f64::min);
    let above = limit.max.and_then(|max| estimate.spread.probability_above(value, max));
    let below = limit.min.and_then(|min| estimate.spread.probability_above(value, min)).map(|p| 1.0 - p);
    let specific_risk = match (above, below) {
        (Some(a), Some(b)) => Some((a + b).min(1.0)),
        (a, b) => a.or(b),
    };
    let (verdict, acceptance_max, acceptance_min) = match limit.rule {
        Rule::Simple => {
            let outside =
                limit.max.is_some_and(|max| value > max) || limit.min.is_some_and(|min| value < min);
            let verdict = if outside { Verdict::Fail } else { Verdict::Pass };
            (verdict, limit.max, limit.min)
        }
        Rule::GuardBand => guard_band(value, &estimate.spread, limit),
    };
    Judgement { verdict, acceptance_max, acceptance_min, specific_risk, margin }
}

/// Decides on a quantity without a value by its bounds; one that is not bounded from below is taken to be at least 0.
fn judge_bounds(estimate: &Estimate, limit: &Limit) -> Judgement {
    let sure = |coverage: f64| coverage >= 1.0 - limit.risk - 1e-9;
    let upper = estimate.upper_limit.filter(|bound| sure(bound.coverage)).map(|bound| bound.value);
    let lower = estimate.lower_limit.filter(|bound| sure(bound.coverage)).map(|bound| bound.value);
    let inside = limit.max.is_none_or(|max| upper.is_some_and(|bound| bound <= max))
        && limit.min.is_none_or(|min| min <= lower.unwrap_or(0.0).max(0.0))
        && (limit.max.is_some() || limit.min.is_some());
    let above = limit.max.zip(lower).filter(|(max, bound)| bound > max).map(|(max, bound)| max - bound);
    let below = limit.min.zip(upper).filter(|(min, bound)| bound < min).map(|(min, bound)| bound - min);
    let beyond = above.or(below);
    let shown = || match limit.max {
        Some(max) => estimate.upper_limit.map(|bound| max - bound.value),
        None => limit.min.zip(estimate.lower_limit).map(|(min, bound)| bound.value - min),
    };
    let verdict = match beyond {
        Some(_) => Verdict::Fail,
        None if inside => Verdict::Pass,
        None => Verdict::Indeterminate,
    };
    let margin = beyond.or_else(shown);
    Judgement { verdict, acceptance_max: None, acceptance_min: None, specific_risk: None, margin }
}

/// Verdict, largest and smallest accepted value under a guard band.
fn guard_band(value: f64, spread: &Spread, limit: &Limit) -> (Verdict, Option<f64>, Option<f64>) {
    let bounds = spread.bound(value, limit.risk).zip(spread.bound(value, 1.0 - limit.risk));
    let Some((low, high)) = bounds else { return (Verdict::Indeterminate, None, None) };
    // A spread that grows with the value (a deviation) moves the limit by a factor, any other by a difference.
    let scales = value > 0.0
        && match spread {
            Spread::ChiSquare { .. } => true,
            Spread::Curve(points) => points.first().is_some_and(|p| p.1 >= 0.0),
            _ => false,
        };
    let shift = |limit: f64, bound: f64| {
        // A limit on the other side of zero is no multiple of the value.
        if scales && bound > 0.0 && limit > 0.0 { limit * value / bound } else { limit - (bound - value) }
    };
    let passes = limit.max.is_none_or(|max| high <= max) && limit.min.is_none_or(|min| low >= min);
    let fails = limit.max.is_some_and(|max| low > max) || limit.min.is_some_and(|min| high < min);
    let verdict = match (passes, fails) {
        (true, _) => Verdict::Pass,
        (_, true) => Verdict::Fail,
        _ => Verdict::Indeterminate,
    };
    (verdict, limit.max.map(|max| shift(max, high)), limit.min.map(|min| shift(min, low)))
}
