//! What the uncertainty of the clocks of files beside the recording adds to estimates, the same for every kind of test and
//! every quantity: each estimate is made again with such a clock moved by its standard uncertainty to either side, and what
//! it changes by is a component of its uncertainty.

use super::request::Request;
use super::test_kind::Run;
use crate::estimate::{Component, Estimate, InputQuantity, Spread, UncertaintySource};
use crate::i18n::{Arg, Note, note};
use crate::ingest::{ClockUncertainty, Source};

/// Share of the half width of its interval above which a component is told beside an estimate.
const TOLD_SHARE: f64 = 0.01;

/// Sides to which a clock is moved.
const SIDES: usize = 2;

/// Adds the components to estimates of a request; `again` makes those of another request by the same test.
///
/// # Errors
/// Those of reading.
pub(super) fn add(
    request: &Request<'_>,
    estimates: &mut [Estimate],
    again: &mut dyn FnMut(&Request<'_>) -> Run<Vec<Estimate>>,
) -> Run<()> {
    for uncertainty in request.source.clock_uncertainties() {
        let mut with_clock_moved = |factor: f64| -> Run<Vec<Estimate>> {
            let source: Source = request.source.with_clock_moved(&uncertainty, factor);
            again(&Request { source: &source, ..request.clone() })
        };
        let sides: [Vec<Estimate>; SIDES] = [with_clock_moved(1.0)?, with_clock_moved(-1.0)?];
        for position in 0..estimates.len() {
            let moved: Vec<Estimate> =
                sides.iter().filter_map(|side| same(estimates, position, side).cloned()).collect();
            if let Some(estimate) = estimates.get_mut(position) {
                widen(estimate, &moved, &uncertainty);
            }
        }
    }
    Ok(())
}

/// The estimate of the same quantity among others: where several share quantity and channel, the one at the same place.
fn same<'e>(estimates: &[Estimate], position: usize, others: &'e [Estimate]) -> Option<&'e Estimate> {
    let own = estimates.get(position)?;
    let is = |e: &&Estimate| e.id == own.id && e.channel == own.channel;
    let before = estimates.iter().take(position).filter(is).count();
    others.iter().filter(is).nth(before)
}

/// Adds what a quantity changed by to its uncertainty, or to its limits where it has no value.
fn widen(estimate: &mut Estimate, moved: &[Estimate], by: &ClockUncertainty) {
    let changes = |of: &dyn Fn(&Estimate) -> Option<f64>| -> f64 {
        let Some(here) = of(estimate) else { return 0.0 };
        let squares: Vec<f64> = moved.iter().filter_map(of).map(|there| (there - here).powi(2)).collect();
        (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
    };
    let component = changes(&|e| e.value);
    let upper = changes(&|e| e.upper_limit.map(|l| l.value));
    let lower = changes(&|e| e.lower_limit.map(|l| l.value));
    if let Some(limit) = &mut estimate.upper_limit {
        limit.value += upper;
    }
    if let Some(limit) = &mut estimate.lower_limit {
        limit.value -= lower;
    }
    let Some(value) = estimate.value else { return };
    let file = by.file.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    if moved.len() < SIDES || moved.iter().any(|e| e.value.is_none()) {
        // Shown by one clock and not by another as likely: how much it depends on the clock is not known.
        estimate.spread = Spread::Unknown;
        estimate.notes.push(note!("note.clock_decides", file));
        return;
    }
    let half_width = estimate.interval95().map_or(0.0, |i| 0.5 * (i.high - i.low));
    estimate.spread = estimate.spread.with_component(value, component);
    let (input, standard, unit) = if by.offset_s > 0.0 {
        (InputQuantity::ClockOffset, by.offset_s, "s")
    } else {
        (InputQuantity::ClockRate, by.rate, "1")
    };
    let source = if by.estimated { UncertaintySource::Measured } else { UncertaintySource::Certificate };
    estimate
        .components
        .push(Component { source, ..Component::of(input, standard, unit, component / standard) });
    if component > TOLD_SHARE * half_width {
        let (key, size) = if by.offset_s > 0.0 {
            ("note.clock_offset_component", by.offset_s)
        } else {
            ("note.clock_rate_component", by.rate * 1e6)
        };
        let told = Note::new(key).with("file", file).with("size", Arg::figures(size, 2));
        let told = told.with("component", Arg::figures(component, 2));
        estimate.notes.push(told.with("unit", Arg::key("unit", estimate.unit)));
    }
}
