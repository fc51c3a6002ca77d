//! A Markov process that may be white noise behind a filter.

use super::search::shows_filter;
use super::slow::Slow;
use super::{ExtraThresholds, Joint, Kind, Shape};
use crate::noise::composite::Bandwidth;
use crate::noise::slow_terms::SlowPrices;

/// The shape with a filter in the place of its shortest Markov process, where that costs less. White noise behind a filter is
/// such a process; the search adds one part at a time and may have taken the process before flicker was told from both.
pub(super) fn with_filter_instead(
    joint: &Joint<'_>,
    shape: &Shape,
    slow: &Slow,
    prices: &SlowPrices,
    thresholds: &ExtraThresholds,
) -> Option<Shape> {
    if shape.filter.is_some() {
        return None;
    }
    let process = |i: usize| shape.damped.get(i).filter(|(kind, _)| *kind == Kind::Markov);
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
