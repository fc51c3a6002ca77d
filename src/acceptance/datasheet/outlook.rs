//! Outlook of a lot on limits: what more units would promise, how the present limit compares, and what is risked by it.

use crate::lot::population::{Population, Side};
use crate::lot::risk::Judged;
use crate::lot::tolerance::{Promise, normal_factor};
use crate::record::{SheetOutlook, SheetRisk, SheetSide};

/// Times as many units as were tested, for the outlook.
const OUTLOOK_LOT_FACTOR: usize = 2;
/// Lengths of a test that are compared, in parts of the present one.
const LENGTH_FACTORS: [f64; 4] = [1.0, 0.5, 0.25, 0.1];

/// The bound for measured values that more units would promise, if median and spread stayed as they are estimated: the distance of
/// the bound from the median shrinks with the factor of a normal sample. Everything on the scale of the quantity.
pub(super) fn outlook(
    population: &Population,
    units: usize,
    bound: f64,
    side: Side,
    promise: Promise,
) -> Option<SheetOutlook> {
    let factor = |n: usize| normal_factor(n as f64, n as f64 - 1.0, promise);
    let more = OUTLOOK_LOT_FACTOR * units;
    let median = population.typical(0.5).value;
    let ratio = factor(more)? / factor(units)?;
    let side = if side == Side::Upper { SheetSide::Upper } else { SheetSide::Lower };
    let value = median + (bound - median) * ratio;
    (ratio.is_finite() && value.is_finite()).then_some(SheetOutlook { units: more, side, value })
}

/// The risks of an upper limit, for the present test and for shorter ones whose uncertainty grows as the root of the length falls.
/// `limit` on the scale of the quantity.
pub(super) fn risks(population: &Population, limit: f64) -> Vec<SheetRisk> {
    let total = population.between_lots().unwrap_or(0.0).hypot(population.between_units());
    let judged =
        Judged { mean: population.typical(0.5).value, units: total, measurement: population.measurement() };
    let at = |length: f64| {
        let risk = Judged { measurement: judged.measurement / length.sqrt(), ..judged }.upper(limit)?;
        Some(SheetRisk { length, consumer: risk.consumer, producer: risk.producer })
    };
    LENGTH_FACTORS.into_iter().filter_map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lot::population::{Of, Reading, Unit};

    /// Units at even quantiles of a normal law.
    fn population(n: usize, standard: f64) -> Population {
        let at = |i: usize| crate::estimate::normal_quantile((i as f64 + 0.5) / n as f64);
        let unit = |i: usize| Unit { lot: 0, reading: Reading::Value { value: at(i), standard } };
        Population::of(&(0..n).map(unit).collect::<Vec<_>>()).unwrap_or_else(|| panic!("they scatter"))
    }

    #[test]
    fn more_units_promise_what_the_factor_of_their_number_gives() {
        let promise = Promise { proportion: 0.95, confidence: 0.95 };
        let of_30 = population(30, 0.0);
        let bound = of_30.bound(Of::Measured, Side::Upper, promise).map(|b| b.value);
        let outlook = bound.and_then(|b| outlook(&of_30, 30, b, Side::Upper, promise));
        let (Some(bound), Some(outlook)) = (bound, outlook) else { panic!("a bound") };
        // Factors of the tables: 2.21984 for 30 units, 2.02216 for 60.
        assert_eq!(outlook.units, 60);
        assert!((outlook.value / bound - 2.022_16 / 2.219_84).abs() < 1e-3, "{outlook:?} {bound}");
    }

    #[test]
    fn shorter_tests_risk_more() {
        let risks = risks(&population(40, 0.2), 1.5);
        assert_eq!(risks.len(), 4);
        assert!(risks.windows(2).all(|w| w[1].producer > w[0].producer && w[1].consumer > w[0].consumer));
        assert!(super::risks(&population(40, 0.0), 1.5).is_empty());
    }
}
