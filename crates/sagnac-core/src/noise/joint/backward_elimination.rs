//! Backward elimination: removes parts of a model that a later part has made superfluous.

use super::confounded::filter_price;
use super::search::{RESOLVED, all_free, best_of};
use super::slow::Slow;
use super::{BASE, ExtraThresholds, Extras, Joint, JointPoint, Kind, Shape};
use crate::noise::composite::Damped;
use crate::noise::fit::RAMP;
use crate::noise::slow_terms::{SlowPrices, holds};

/// A part beside N, B, K, Q and R.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Part {
    Filter,
    Damped(usize),
}

fn without_shape(shape: &Shape, part: Part) -> Shape {
    let mut out = shape.clone();
    match part {
        Part::Filter => out.filter = None,
        Part::Damped(i) if i < out.damped.len() => {
            out.damped.remove(i);
        }
        Part::Damped(_) => {}
    }
    out
}

pub(super) fn without(extras: &Extras, part: Part) -> Extras {
    Extras { shape: without_shape(&extras.shape, part), zones: extras.zones.clone() }
}

/// A Markov process whose corner a fit has moved beyond what the sampling resolves.
pub(super) fn unresolved(joint: &Joint<'_>, points: &[&JointPoint]) -> Option<Part> {
    let shortest_s = RESOLVED * joint.evidence().tau0_s;
    let white = |(i, (kind, d)): (usize, &(Kind, Damped))| {
        (*kind == Kind::Markov && d.decay_time_s < shortest_s).then_some(Part::Damped(i))
    };
    points.iter().find_map(|p| p.shape.damped.iter().enumerate().find_map(white))
}

/// The part to remove, if any: removing it raises the cost by less than the threshold at which it was accepted. Of several,
/// the one furthest below its threshold.
pub(super) fn backward_elimination(
    joint: &Joint<'_>,
    shape: &Shape,
    full: &JointPoint,
    slow: &Slow,
    slow_prices: &SlowPrices,
    thresholds: &ExtraThresholds,
) -> Option<Part> {
    if usize::from(shape.filter.is_some()) + shape.damped.len() < 2 {
        return None;
    }
    let ramp = holds(slow.choice.set, RAMP);
    let less_by = |part: Part, threshold: f64| {
        let less = without_shape(shape, part);
        let mut start = JointPoint { shape: less.clone(), ..full.clone() };
        if let Part::Damped(i) = part {
            start.variance.remove(BASE.len() + i);
        }
        let free = all_free(&less, ramp, true);
        // From afresh too: what is left may stand where only the part could hold it.
        let reached = joint.maximise(&start, &free).deviance.min(best_of(joint, &less, ramp).deviance);
        reached - full.deviance - threshold
    };
    let excess = |part: Part| match part {
        Part::Filter => less_by(part, filter_price(joint, full, ramp, thresholds)),
        Part::Damped(i) => match shape.damped.get(i) {
            Some((Kind::Markov, _)) => {
                // Flicker or random walk may stand in its place, each at its own price.
                Slow::of(joint, &without_shape(shape, part), slow_prices).map_or(f64::INFINITY, |in_place| {
                    let instead = slow.choice_without_rivals(slow_prices)
                        + slow_prices.in_place_of(in_place.choice.set);
                    in_place.choice.cost - (slow.choice.cost + thresholds.markov).min(instead)
                })
            }
            _ => less_by(part, thresholds.quasi_periodic),
        },
    };
    let damped = (0..shape.damped.len()).map(Part::Damped);
    let filter = shape.filter.map(|_| Part::Filter);
    filter
        .into_iter()
        .chain(damped)
        .map(|part| (part, excess(part)))
        .filter(|(_, excess)| *excess < 0.0)
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(part, _)| part)
}
