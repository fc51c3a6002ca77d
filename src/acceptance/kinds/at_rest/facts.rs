//! Facts that the conditions are judged by for gyros at rest.

use super::{change_detection, warm_up_transient};
use crate::acceptance::condition::{BiasStep, GyroFact, NoiseChange, WarmUpFact};
use crate::acceptance::test_kind::Reading;
use crate::measurand::{GyroEvidence, static_bias};
use crate::noise::tails::{Deviations, Shortening, TailShape};
use std::collections::BTreeMap;

/// Facts of every gyro channel, the rest of its warm-up among them. `constant`: conditions were; over
/// temperature and while it warms up a unit is not steady, and `from_lines` are the deviations of its samples from its course.
pub fn of_gyros(
    reading: &Reading<'_>,
    gyros: &[GyroEvidence],
    from_lines: &BTreeMap<String, Deviations>,
    constant: bool,
) -> (Vec<WarmUpFact>, Vec<GyroFact>) {
    let transient =
        |g: &GyroEvidence| warm_up_transient::fact(g, static_bias::uncertainty(g, true).standard());
    (
        gyros.iter().filter(|_| constant).filter_map(transient).collect(),
        gyros.iter().map(|g| gyro(g, from_lines.get(&g.channel), reading, constant)).collect(),
    )
}

fn gyro(g: &GyroEvidence, from_lines: Option<&Deviations>, reading: &Reading<'_>, rests: bool) -> GyroFact {
    let facts = reading.report.channels.iter().find(|c| c.id == g.channel);
    // Block means stand on the grid, which starts with the recording.
    let start_s = g.blocks().first_index as f64 * g.tau0_s;
    let step = change_detection::bias_step(g.blocks(), g.tau0_s).filter(|_| rests);
    let change = change_detection::noise_change(g.blocks(), g.tau0_s).filter(|_| rests);
    let step_deg_h = facts.and_then(|f| f.values.quantization_step);
    let walk = g.identification.read_angle_random_walk();
    let coarse = step_deg_h.unwrap_or(0.0);
    GyroFact {
        tails: match from_lines {
            Some(deviations) => deviations.tails(&Shortening { periodic: vec![], step_deg_h: coarse }),
            None => tails(g, coarse),
        },
        channel: g.channel.clone(),
        mean_deg_h: g.digest.mean,
        mean_uncertainty_deg_h: static_bias::uncertainty(g, false).standard(),
        earth_deg_h: g.earth.map(|e| (e.rate_deg_h, e.uncertainty_deg_h)),
        tau0_s: g.tau0_s,
        deviations: g.octaves.iter().map(|p| (p.point.m as f64 * g.tau0_s, p.point.deviation)).collect(),
        longest_stretch_s: g.longest_stretch_s,
        angle_random_walk: walk.value,
        angle_random_walk_high: walk.value.and(walk.interval95()).map(|i| i.high),
        quantization_step_deg_h: step_deg_h,
        moves_deg_h: moves(g),
        bias_step: step.map(|s| BiasStep { time_s: s.time_s + start_s, ..s }),
        noise_change: change.map(|c| NoiseChange {
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

/// How the values are spread about the means of short blocks. `None` where something else than noise rules them.
fn tails(g: &GyroEvidence, step_deg_h: f64) -> Option<TailShape> {
    let first = g.octaves.first().filter(|p| p.point.m == 1 && !g.motion.is_motion())?;
    let lines = g.lines.iter().map(|l| 0.5 * l.amplitude_deg_h.powi(2));
    let model = &g.identification.described.model;
    let narrow = model.quasi_periodic.iter().map(|q| q.rms_deg_h.powi(2));
    let shortening = Shortening { periodic: lines.chain(narrow).collect(), step_deg_h };
    Deviations::of_histogram(&g.digest.histogram, first.point.deviation).tails(&shortening)
}
