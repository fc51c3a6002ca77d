//! What the conditions are judged by for gyros at rest.

use super::{change_detection, warm_up_transient};
use crate::acceptance::condition::{BiasStep, GyroFact, NoiseChange, TailShape, WarmUpFact};
use crate::acceptance::test_kind::Reading;
use crate::estimate::normal_probability;
use crate::measurand::{GyroEvidence, static_bias};
use crate::noise::histogram::Histogram;

/// What is left of the warm-up on every channel, and what every channel shows. `constant`: conditions were; over
/// temperature and while it warms up a unit is not steady.
pub fn of_gyros(
    reading: &Reading<'_>,
    gyros: &[GyroEvidence],
    constant: bool,
) -> (Vec<WarmUpFact>, Vec<GyroFact>) {
    let transient =
        |g: &GyroEvidence| warm_up_transient::fact(g, static_bias::uncertainty(g, true).standard());
    (
        gyros.iter().filter(|_| constant).filter_map(transient).collect(),
        gyros.iter().map(|g| gyro(g, reading, constant)).collect(),
    )
}

fn gyro(g: &GyroEvidence, reading: &Reading<'_>, rests: bool) -> GyroFact {
    let facts = reading.report.channels.iter().find(|c| c.id == g.channel);
    // Block means stand on the grid, which starts with the recording.
    let start_s = g.blocks().first_index as f64 * g.tau0_s;
    let step = change_detection::bias_step(g.blocks(), g.tau0_s).filter(|_| rests);
    let change = change_detection::noise_change(g.blocks(), g.tau0_s).filter(|_| rests);
    let step_deg_h = facts.and_then(|f| f.values.quantization_step);
    GyroFact {
        tails: tails(g, step_deg_h),
        channel: g.channel.clone(),
        mean_deg_h: g.digest.mean,
        mean_uncertainty_deg_h: static_bias::uncertainty(g, false).standard(),
        earth_deg_h: g.earth.map(|e| (e.rate_deg_h, e.uncertainty_deg_h)),
        tau0_s: g.tau0_s,
        deviations: g.octaves.iter().map(|p| (p.point.m as f64 * g.tau0_s, p.point.deviation)).collect(),
        longest_stretch_s: g.longest_stretch_s,
        angle_random_walk: g.identification.read_angle_random_walk().value,
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

/// Share of the variance that lines and disturbances may have where the spread of the values is judged.
const MAX_NARROW_SHARE: f64 = 0.2;
/// Bins of the histogram from which values are counted as far out: three standard deviations, to a bin.
const TAIL_SIGMA: f64 = 3.0;

/// How the values are spread about the means of short blocks. `None` where something else than noise rules them: lines,
/// coarse steps, a motion within the blocks.
fn tails(g: &GyroEvidence, step_deg_h: Option<f64>) -> Option<TailShape> {
    let histogram: &Histogram = &g.digest.histogram;
    let deviation = histogram.standard_deviation;
    let variance = deviation * deviation;
    if histogram.samples < 4096 || variance.is_nan() || variance <= 0.0 || g.motion.is_motion() {
        return None;
    }
    // White to within a factor: what wanders within a block has no distribution of its own.
    let first = g.octaves.first().filter(|p| p.point.m == 1)?;
    if !(0.5..=2.0).contains(&(first.point.deviation.powi(2) / variance)) {
        return None;
    }
    let lines = g.lines.iter().map(|l| 0.5 * l.amplitude_deg_h.powi(2));
    let model = &g.identification.described.model;
    let narrow = model.quasi_periodic.iter().map(|q| q.rms_deg_h.powi(2));
    let shares: Vec<f64> = lines.chain(narrow).map(|v| v / variance).collect();
    let rounding = step_deg_h.map_or(0.0, |s| s * s / (12.0 * variance));
    if shares.iter().sum::<f64>() > MAX_NARROW_SHARE || rounding > MAX_NARROW_SHARE {
        return None;
    }
    let explained = shares.iter().map(|s| 1.5 * s * s).sum::<f64>() + 1.2 * rounding * rounding;
    let bins = histogram.counts.len() / 2;
    let edge = (TAIL_SIGMA * deviation / histogram.bin_width).round().min(bins as f64) as usize;
    let inside: u64 = histogram.counts.get(bins - edge..bins + edge)?.iter().sum();
    let sigma = edge as f64 * histogram.bin_width / deviation;
    Some(TailShape {
        samples: histogram.samples,
        excess_kurtosis: histogram.excess_kurtosis,
        explained,
        sigma,
        beyond: histogram.samples.saturating_sub(inside),
        expected_beyond: 2.0 * normal_probability(-sigma) * histogram.samples as f64,
    })
}
