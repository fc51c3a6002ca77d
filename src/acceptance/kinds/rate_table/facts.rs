//! Facts that the conditions of a rate table are judged by.

use crate::acceptance::condition::table::{ChannelFact, Settling, TableFacts};
use crate::acceptance::request::Request;
use crate::measurand;
use crate::rate_table::inner_axis::InnerAxis;
use crate::rate_table::scale_factor::ScaleFactor;
use crate::rate_table::settling::Unsettled;
use crate::rate_table::{Setup, TableRun, stamps};

/// Facts of the table and of how every channel follows it. `lines` are the gyro channels by position, each with its
/// line; `about_outer`: the table turns about its other axis.
pub fn table_facts(
    request: &Request<'_>,
    setup: &Setup,
    run: &TableRun,
    lines: &[(usize, Option<&ScaleFactor>)],
    about_outer: bool,
) -> TableFacts {
    let steps = &run.steps;
    let inner = InnerAxis::of(&run.blocks);
    let rates = || steps.list.iter().map(|s| if about_outer { s.outer } else { s.rate });
    let worst = |f: fn(f64, f64) -> f64, start: f64| {
        let value = rates().fold(start, f);
        if value.is_finite() { value } else { 0.0 }
    };
    let disagreement = disagreement(run, &inner, about_outer);
    let unsettled: Vec<&Unsettled> = steps.list.iter().filter_map(|s| s.unsettled.as_ref()).collect();
    TableFacts {
        time_factor: if about_outer { None } else { stamps::time_factor(run) },
        settling: Settling {
            steps: unsettled.len(),
            stated_s: setup.settling_s,
            needed_s: unsettled.iter().fold(0.0, |m: f64, u| m.max(u.needed_s)),
            off: unsettled.iter().fold(0.0, |m: f64, u| m.max((u.off / u.rate).abs())),
        },
        steps: steps.list.len(),
        too_short: steps.too_short,
        minimum_step_s: setup.minimum_step_s,
        lowest: worst(f64::min, f64::INFINITY),
        highest: worst(f64::max, f64::NEG_INFINITY),
        about_outer,
        levels: if about_outer { outer_levels(run) } else { steps.levels.len() },
        full_scale: setup.full_scale_deg_h,
        tolerance: setup.rate_tolerance,
        disagreement,
        inner_during_step: inner.during_step,
        channels: lines
            .iter()
            .filter_map(|(gyro, line)| {
                let along_outer = || inner.output_per_rate.get(*gyro).copied().flatten();
                let by_steps = || line.map(|l| (l.factor, l.factor_uncertainty()));
                let factor = if about_outer { along_outer() } else { by_steps() };
                channel_fact(request, run.blocks.gyros.get(*gyro)?, *line, factor)
            })
            .collect(),
    }
}

/// The largest relative difference between the angle and the rate of the table, with the rate at which it was, deg/h.
fn disagreement(run: &TableRun, inner: &InnerAxis, about_outer: bool) -> Option<(f64, f64)> {
    if let Some(factor) = inner.angle_per_rate.filter(|_| about_outer) {
        return Some((factor - 1.0, inner.largest));
    }
    if !run.blocks.has_angle || !run.blocks.has_rate {
        return None;
    }
    let list = &run.steps.list;
    let largest = list
        .iter()
        .fold(0.0, |m: f64, s| m.max(s.rate.abs()))
        .max(list.iter().fold(0.0, |m: f64, s| m.max(s.nominal.abs())));
    list.iter()
        .filter(|s| s.nominal.abs() > 0.05 * largest && s.nominal != 0.0)
        .map(|s| (s.rate / s.nominal - 1.0, s.nominal))
        .max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
}

/// Rates of the other axis that differ.
fn outer_levels(run: &TableRun) -> usize {
    let mut rates: Vec<f64> = run.steps.list.iter().map(|s| s.outer).filter(|r| r.is_finite()).collect();
    rates.sort_by(f64::total_cmp);
    let largest = rates.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
    rates.dedup_by(|a, b| (*a - *b).abs() <= 1e-3 * largest);
    rates.len()
}

fn channel_fact(
    request: &Request<'_>,
    id: &str,
    channel: Option<&ScaleFactor>,
    factor: Option<(f64, f64)>,
) -> Option<ChannelFact> {
    let spec = request.procedure.channel(id)?;
    let earth = request.procedure.site.as_ref().map(|site| site.earth_rate_along(id).value);
    let at_rest = channel.zip(earth).map(|(c, earth)| (c.bias - c.factor * earth, earth));
    Some(ChannelFact {
        channel: id.to_owned(),
        asked: request.procedure.measurands.iter().any(|m| m.channel.as_deref().is_none_or(|c| c == id)),
        polarity_judged: request.limits.limit(measurand::POLARITY.id, id).is_some(),
        unit: spec.unit_in_file.clone(),
        factor: factor.map(|f| f.0),
        standard: factor.map_or(0.0, |f| f.1),
        bias_and_earth: at_rest,
        bias_limit: request
            .limits
            .limit(measurand::SCALE_FACTOR_BIAS.id, id)
            .and_then(|l| l.limit.largest_magnitude()),
    })
}
