//! The figures of a run: which channels and evaluations are drawn, in the order of the report.

use super::evaluate::Found;
use super::{Request, figures};
use crate::config::procedure::Procedure;
use crate::figure::Figure;
use crate::measurand;
use crate::measurand::GyroEvidence;
use crate::recording::{Channel, Role};

/// Every figure that the report asks for.
pub(super) fn draw(request: &Request<'_>, found: &Found) -> Vec<Figure> {
    let wanted = |id: &str| request.procedure.report.shows(id);
    let mut drawn = Vec::new();
    for gyro in &found.gyros {
        drawn.extend(channel_over_time(request, found, &gyro.channel, gyro.several));
        drawn.extend(figures::thermal::figures(gyro, found.schedule.as_ref(), request.procedure, &wanted));
        if !found.at_rest() {
            continue;
        }
        if wanted("sigma_tau") {
            let limit = |id: &str| request.limits.limit(id, &gyro.channel).map(|l| &l.limit);
            drawn.push(figures::sigma_tau::figure(
                gyro,
                limit(measurand::RUSSIAN_DRIFT_100S.id),
                limit(measurand::BIAS_INSTABILITY_MINIMUM.id),
            ));
        }
        let optional = [
            ("allan_family", figures::allan_family::figure as fn(&GyroEvidence) -> Option<Figure>),
            ("spectrum", figures::spectrum::figure),
            ("autocorrelation", figures::autocorrelation::figure),
            ("histogram", figures::histogram::figure),
            ("residual", figures::residual::figure),
        ];
        drawn.extend(optional.into_iter().filter(|(id, _)| wanted(id)).filter_map(|(_, f)| f(gyro)));
    }
    drawn
}

/// Every gyro channel over time, for tests that are not evaluated sample by sample.
pub(super) fn over_time(request: &Request<'_>, found: &Found) -> Vec<Figure> {
    let gyros: Vec<&Channel> = found.channels.iter().filter(|c| c.role.is_gyro()).collect();
    let several = gyros.len() > 1;
    gyros.iter().filter_map(|channel| channel_over_time(request, found, &channel.id, several)).collect()
}

/// One channel over time, where the report asks for it.
fn channel_over_time(request: &Request<'_>, found: &Found, channel: &str, several: bool) -> Option<Figure> {
    let wanted = |id: &str| request.procedure.report.shows(id);
    if !wanted("rate") && !wanted("temperature") {
        return None;
    }
    let slot = found.channels.iter().position(|c| c.id == channel)?;
    let below = if wanted("temperature") { below(request.procedure, found) } else { vec![] };
    Some(figures::time_series::figure(
        if several { format!("time_series_{channel}") } else { "time_series".to_owned() },
        if several { channel.to_owned() } else { String::new() },
        found.envelopes.get(&slot)?,
        &below,
        &found.window,
        found.tau0_s,
    ))
}

/// The other channels drawn under the rate, with the bands that they must keep.
fn below<'a>(procedure: &Procedure, found: &'a Found) -> Vec<figures::time_series::Below<'a>> {
    let mut list = Vec::new();
    for (slot, channel) in found.channels.iter().enumerate() {
        let Some(envelope) = found.envelopes.get(&slot) else { continue };
        let (label, unit, legend, limits) = match channel.role {
            Role::Temperature => {
                let condition = procedure.conditions.temperatures.iter().find(|c| c.channel == channel.id);
                let limits = condition
                    .map(|c| (c.nominal_deg_c - c.tolerance_deg_c, c.nominal_deg_c + c.tolerance_deg_c));
                ("axis.temperature", "degC", "figure.legend.temperature", limits)
            }
            Role::Supply => {
                let condition = procedure.conditions.supplies.iter().find(|c| c.channel == channel.id);
                let limits = condition.map(|c| (c.nominal_v - c.tolerance_v, c.nominal_v + c.tolerance_v));
                ("axis.supply", "V", "figure.legend.supply", limits)
            }
            _ => continue,
        };
        list.push(figures::time_series::Below { envelope, label, unit, legend, limits });
    }
    list
}
