//! What the conditions are told about gyro channels and columns.

use super::evaluate::Found;
use super::steadiness;
use crate::condition::{ColumnFact, GyroFact};
use crate::ingest::Source;
use crate::measurand::{GyroEvidence, static_bias};

/// The gyro channels.
pub(super) fn gyros(found: &Found) -> Vec<GyroFact> {
    found.gyros.iter().map(|g| gyro(g, found)).collect()
}

fn gyro(g: &GyroEvidence, found: &Found) -> GyroFact {
    let facts = found.report.channels.iter().find(|c| c.id == g.channel);
    // Block means stand on the grid, which starts with the recording.
    let start_s = g.blocks().first_index as f64 * g.tau0_s;
    // Over temperature and while it warms up a unit is not steady.
    let rests = found.at_rest();
    let step = steadiness::bias_step(g.blocks(), g.tau0_s).filter(|_| rests);
    let change = steadiness::noise_change(g.blocks(), g.tau0_s).filter(|_| rests);
    GyroFact {
        channel: g.channel.clone(),
        mean_deg_h: g.digest.mean,
        mean_uncertainty_deg_h: static_bias::uncertainty(g, false).standard(),
        earth_deg_h: g.earth.map(|e| (e.rate_deg_h, e.uncertainty_deg_h)),
        tau0_s: g.tau0_s,
        deviations: g.octaves.iter().map(|p| (p.point.m as f64 * g.tau0_s, p.point.deviation)).collect(),
        longest_stretch_s: g.longest_stretch_s,
        angle_random_walk: g.identification.angle_random_walk.value,
        quantization_step_deg_h: facts.and_then(|f| f.values.quantization_step),
        moves_deg_h: moves(g),
        bias_step: step.map(|s| crate::condition::BiasStep { time_s: s.time_s + start_s, ..s }),
        noise_change: change.map(|c| crate::condition::NoiseChange {
            loudest_s: c.loudest_s + start_s,
            quietest_s: c.quietest_s + start_s,
            ..c
        }),
    }
}

/// Range of the bias by the model of a test over temperature or of the warm-up, deg/h.
fn moves(g: &GyroEvidence) -> Option<f64> {
    let over = g.over_temperature.as_ref().and_then(|f| f.analysis.as_ref()).map(|a| &a.modelled);
    let modelled = over.or_else(|| g.warm_up.as_ref().map(|w| &w.modelled))?;
    let (low, high) =
        modelled.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    Some(high - low).filter(|m| m.is_finite())
}

/// The columns of the channels.
pub(super) fn columns(source: &Source, found: &Found) -> Vec<ColumnFact> {
    let column = |channel: &crate::recording::Channel| {
        let place = source.resolve(&channel.column).ok()?;
        let column = source.columns().get(place)?;
        // Of stamps that a reader turned into seconds, the name may still say what they were.
        let converted = column.epoch_s.is_some() || column.rollover_s.is_some();
        let fact = || ColumnFact {
            channel: channel.id.clone(),
            name: column.name.clone(),
            unit: column.unit.clone(),
        };
        (!converted).then(fact)
    };
    found.channels.iter().filter_map(column).collect()
}
