//! Revision of a model that the search has found: parts that became superfluous are removed, a filter may take the place
//! of a Markov process, and parts that cannot be told from one another near the upper end of the spectrum cost more.

use super::super::claims::{SlowPrices, contains_term};
use super::super::linear_fit::RAMP_INDEX;
use super::super::options::ProcessThresholds;
use super::fit::Joint;
use super::interval::parameter_covariance;
use super::model::{
    BASE_TERMS, Extras, Free, JointPoint, MIN_TIME_SAMPLES, ProcessKind, QUANTIZATION_INDEX, Shape, Variable,
};
use super::search::shows_filter;
use super::slow::Slow;
use crate::noise::composite::{Bandwidth, Damped};

/// Growth of the uncertainty of N by letting a part in from which the two count as confounded: a superfluous part then
/// displaces N by several of the deviations it would have without.
const CONFOUNDING_GROWTH: f64 = 2.0;

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
    let shortest_s = MIN_TIME_SAMPLES * joint.evidence().tau0_s;
    let white = |(i, (kind, d)): (usize, &(ProcessKind, Damped))| {
        (*kind == ProcessKind::Markov && d.decay_time_s < shortest_s).then_some(Part::Damped(i))
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
    thresholds: &ProcessThresholds,
) -> Option<Part> {
    if usize::from(shape.filter.is_some()) + shape.damped.len() < 2 {
        return None;
    }
    let ramp = contains_term(slow.choice.set, RAMP_INDEX);
    let less_by = |part: Part, threshold: f64| {
        let less = without_shape(shape, part);
        let mut start = JointPoint { shape: less.clone(), ..full.clone() };
        if let Part::Damped(i) = part {
            start.variance.remove(BASE_TERMS.len() + i);
        }
        let free = Free::all(&less, ramp, true);
        // From afresh too: what is left may stand where only the part could hold it.
        let reached = joint.maximise(&start, &free).deviance.min(joint.best(&less, ramp).deviance);
        reached - full.deviance - threshold
    };
    let excess = |part: Part| match part {
        Part::Filter => less_by(part, filter_price(joint, full, ramp, thresholds)),
        Part::Damped(i) => match shape.damped.get(i) {
            Some((ProcessKind::Markov, _)) => {
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

/// The shape with a filter in the place of its shortest Markov process, where that costs less. White noise behind a filter is
/// such a process; the search adds one part at a time and may have taken the process before flicker was told from both.
pub(super) fn with_filter_instead(
    joint: &Joint<'_>,
    shape: &Shape,
    slow: &Slow,
    prices: &SlowPrices,
    thresholds: &ProcessThresholds,
) -> Option<Shape> {
    if shape.filter.is_some() {
        return None;
    }
    let process = |i: usize| shape.damped.get(i).filter(|(kind, _)| *kind == ProcessKind::Markov);
    let times = (0..shape.damped.len()).filter_map(|i| Some((i, process(i)?.1.decay_time_s)));
    let (at, time_s) = times.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let mut filtered = shape.clone();
    filtered.filter = Some(Bandwidth::FirstOrder { time_constant_s: time_s });
    filtered.damped.remove(at);
    let instead = Slow::of(joint, &filtered, prices)?;
    let cost = instead.choice.cost + thresholds.filter;
    let kept = slow.choice.cost + thresholds.markov;
    (cost < kept && shows_filter(&instead.level, joint)).then_some(instead.level.shape)
}

/// What quantisation costs at a maximum.
///
/// Beside a short Markov process it rises where the process falls, and the white level between them can be nearly
/// anything: N would be wrong by far more than its interval said if chance alone brought it in.
pub(super) fn quantization_price(
    joint: &Joint<'_>,
    point: &JointPoint,
    ramp: bool,
    thresholds: &ProcessThresholds,
) -> f64 {
    if confounds_white(joint, point, ramp) {
        thresholds.quantization_confounded
    } else {
        thresholds.quantization
    }
}

/// True when N is several times less certain with quantisation free than with it held, or stands beside a Markov
/// process: there the likelihood may have two tops, with quantisation and without, each of which knows its own N well.
fn confounds_white(joint: &Joint<'_>, point: &JointPoint, ramp: bool) -> bool {
    if point.shape.damped.iter().any(|(kind, _)| *kind == ProcessKind::Markov) {
        return true;
    }
    let mut free = Free::all(&point.shape, ramp, true);
    let mut sigma = |quantization: bool| {
        free.variance[QUANTIZATION_INDEX] = quantization;
        sigma_of_white(joint, point, &free)
    };
    match (sigma(true), sigma(false)) {
        (Some(with), Some(without)) => with > CONFOUNDING_GROWTH * without,
        // Where N has vanished, quantisation stands in its place.
        _ => point.variance.get(QUANTIZATION_INDEX).is_some_and(|v| *v > 0.0) && !point.shape.is_plain(),
    }
}

/// What a filter costs at a maximum. Beside a short Markov process it falls where the process does, and the white level
/// under the process is then shown by the filter alone.
pub(super) fn filter_price(
    joint: &Joint<'_>,
    point: &JointPoint,
    ramp: bool,
    thresholds: &ProcessThresholds,
) -> f64 {
    let sigma = |shape: Shape| {
        let mut free = Free::all(&shape, ramp, true);
        free.variance[QUANTIZATION_INDEX] = point.variance.get(QUANTIZATION_INDEX).is_some_and(|v| *v > 0.0);
        sigma_of_white(joint, &JointPoint { shape, ..point.clone() }, &free)
    };
    let without = Shape { filter: None, ..point.shape.clone() };
    match (sigma(point.shape.clone()), sigma(without)) {
        (Some(with), Some(without)) if with > CONFOUNDING_GROWTH * without => thresholds.filter_confounded,
        _ => thresholds.filter,
    }
}

fn sigma_of_white(joint: &Joint<'_>, point: &JointPoint, free: &Free) -> Option<f64> {
    let (variables, covariance) = parameter_covariance(joint, point, free);
    let at = variables.iter().position(|v| *v == Variable::Variance(0))?;
    Some(covariance.get(at)?.get(at)?.max(0.0).sqrt())
}
