//! Tests over temperature and of the warm-up in a run: what is looked for, and the table that compensates.

use super::Request;
use super::evaluate::Found;
use crate::config::procedure::Procedure;
use crate::measurand::GyroEvidence;
use crate::recording::Channel;
use crate::temperature::compensation::Compensation;
use crate::temperature::findings::{Findings, Schedule, findings, schedule};
use crate::temperature::start::start;
use crate::temperature::track::Means;
use crate::temperature::warm_up;

/// Adds what the tests showed to the evidence of each channel. `first_stamp_s` is the first stamp, where there are stamps.
pub(super) fn examine(
    procedure: &Procedure,
    channels: &[Channel],
    mut gyros: Vec<GyroEvidence>,
    means: Option<&(Vec<usize>, Means)>,
    first_stamp_s: Option<f64>,
) -> (Vec<GyroEvidence>, Option<Schedule>) {
    let Some((slots, means)) = means else { return (gyros, None) };
    let position = |id: &str| {
        let slot = channels.iter().position(|c| c.id == id)?;
        slots.iter().position(|s| *s == slot)
    };
    let mut found = None;
    if let Some(test) = &procedure.temperature_test {
        let temperature = position(&test.channel);
        let command = test.command.as_deref().and_then(position);
        found = temperature.and_then(|t| schedule(means, t, command, test));
        for gyro in &mut gyros {
            gyro.over_temperature = match (position(&gyro.channel), temperature) {
                (Some(rate), Some(t)) => Some(findings(means, rate, t, found.clone(), test)),
                _ => Some(Findings::nothing(test)),
            };
        }
    }
    if let Some(test) = &procedure.warm_up_test {
        let start = start(&test.start, means, test.start.channel().and_then(position), first_stamp_s);
        for gyro in &mut gyros {
            gyro.warm_up = position(&gyro.channel).and_then(|rate| warm_up::find(means, rate, test, start));
        }
    }
    (gyros, found)
}

/// Compensation tables of every channel with a model: TOML, JSON, C header.
pub(super) fn tables(request: &Request<'_>, found: &Found) -> Vec<(String, String)> {
    let mut out = vec![];
    for gyro in &found.gyros {
        let Some(analysis) = gyro.over_temperature.as_ref().and_then(|o| o.analysis.as_ref()) else {
            continue;
        };
        let made = Compensation::of(analysis, &gyro.channel, request.unit.serial.as_deref());
        let stem = gyro.figure_id("compensation");
        out.push((format!("{stem}.toml"), toml::to_string(&made).unwrap_or_default()));
        out.push((format!("{stem}.json"), serde_json::to_string_pretty(&made).unwrap_or_default() + "\n"));
        out.push((format!("{stem}.h"), made.header()));
    }
    out
}
