//! Parts beside N, B, K, Q and R: one more at a time, while one is worth its parameters.

use super::super::options::Options;
use super::ends::usable_evidence;
use super::fit::Joint;
use super::model::{
    Extras, Free, JointPoint, MAX_PROCESSES, MAX_TIME_SHARE, MIN_TIME_SAMPLES, ProcessKind,
    QUANTIZATION_INDEX, Shape,
};
use super::peaks::strongest;
use crate::noise::composite::{Bandwidth, Damped, Part};
use crate::noise::data::NoiseType;
use crate::noise::evidence::{Evidence, Zone};
use std::f64::consts::PI;

/// Correlation times tried, per octave.
const PER_OCTAVE: f64 = 1.5;
/// Highest frequency in units of the sample rate below which a range was cut.
const UNCUT_RANGE: f64 = 0.4;
/// Corners of processes lie at least this factor below the edge of a range that was cut.
const MIN_EDGE_DISTANCE: f64 = 4.0;
/// Steps of a fit that screens a grid, and of one that counts.
const SCREENING_STEPS: usize = 3;
const FIT_STEPS: usize = 40;
/// Peaks of a scan that are fitted.
const MAX_PEAKS: usize = 3;
/// Share of the density at its cut-off that white noise must have for a filter to be seen by it.
const FILTERED_SHARE: f64 = 0.3;

/// A candidate with the maximum it reaches.
struct Candidate {
    point: JointPoint,
    zones: Vec<Zone>,
    excess: f64,
}

/// Searches an evidence. `ramp` tells whether a ramp is part of the record.
pub fn find_extras(evidence: &Evidence, options: &Options, ramp: bool) -> Extras {
    let mut found = Extras { shape: Shape::default(), zones: vec![] };
    for _ in 0..MAX_PROCESSES {
        let resolved = usable_evidence(evidence, &found);
        let Some(joint) = Joint::new(&resolved, options.sampling) else { break };
        let current = joint.best(&found.shape, ramp);
        if !current.deviance.is_finite() {
            break;
        }
        let mut candidates = vec![];
        candidates.extend(filters(&joint, &found, &current, ramp, options));
        candidates.extend(markovs(&joint, &found, &current, ramp, options));
        candidates.extend(periodics(evidence, &joint, &found, &current, ramp, options));
        let best = candidates.into_iter().max_by(|a, b| a.excess.total_cmp(&b.excess));
        match best {
            Some(best) if best.excess > 0.0 => {
                found = Extras { shape: best.point.shape, zones: best.zones };
            }
            _ => break,
        }
    }
    found
}

/// The maximum at a given shape, from the maximum without its last part.
fn at_shape(joint: &Joint<'_>, shape: &Shape, near: &JointPoint, ramp: bool, steps: usize) -> JointPoint {
    let free = Free::all(shape, ramp, false);
    let mut start = joint.start(shape, &free.variance);
    // Half of what was found before leaves room for the new part.
    for (i, v) in near.variance.iter().enumerate() {
        if let Some(s) = start.variance.get_mut(i) {
            *s = (*v).max(1e-3 * *s);
        }
    }
    start.ramp = near.ramp;
    joint.newton_ascent(&start, &free, steps)
}

fn refined(joint: &Joint<'_>, point: &JointPoint, ramp: bool) -> JointPoint {
    joint.maximise(point, &Free::all(&point.shape, ramp, true))
}

/// The deviance at a maximum, quantisation counted with its price or left out.
fn with_priced_quantization(joint: &Joint<'_>, point: &JointPoint, ramp: bool, price: f64) -> f64 {
    let mut free = Free::all(&point.shape, ramp, true);
    let mut start = point.clone();
    (free.variance[QUANTIZATION_INDEX], start.variance[QUANTIZATION_INDEX]) = (false, 0.0);
    joint.maximise(&start, &free).deviance.min(point.deviance + price)
}

fn filters(
    joint: &Joint<'_>,
    found: &Extras,
    current: &JointPoint,
    ramp: bool,
    options: &Options,
) -> Option<Candidate> {
    let thresholds = &options.process_thresholds;
    if found.shape.filter.is_some() {
        return None;
    }
    let evidence = joint.evidence();
    let tau0_s = evidence.tau0_s;
    let highest = evidence.bands.iter().map(|b| b.high_hz).fold(0.0, f64::max);
    let mut tried = vec![];
    let mut time_s = 0.15 * tau0_s;
    // A filter below a hundredth of the highest frequency leaves no white part to be seen.
    while time_s < 100.0 / (2.0 * PI * highest.max(1e-300)) && time_s < 0.02 * evidence.span_s {
        tried.push(Bandwidth::FirstOrder { time_constant_s: time_s });
        time_s *= 2f64.powf(1.0 / PER_OCTAVE);
    }
    for samples in [2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 32, 40, 50, 64, 80, 100] {
        if f64::from(samples) * tau0_s < 0.01 * evidence.span_s {
            tried.push(Bandwidth::MovingAverage { samples });
        }
    }
    let reached: Vec<JointPoint> = tried
        .into_iter()
        .map(|filter| {
            let shape = Shape { filter: Some(filter), ..found.shape.clone() };
            at_shape(joint, &shape, current, ramp, SCREENING_STEPS)
        })
        .collect();
    // The best of each kind: a screening cannot tell kinds apart.
    let best_where = |first_order: bool| {
        reached
            .iter()
            .filter(|p| matches!(p.shape.filter, Some(Bandwidth::FirstOrder { .. })) == first_order)
            .min_by(|a, b| a.deviance.total_cmp(&b.deviance))
    };
    [true, false]
        .into_iter()
        .filter_map(best_where)
        .map(|p| refined(joint, p, ramp))
        .filter(|p| shows_filter(p, joint))
        .filter(|p| {
            p.shape.filter.is_some_and(|f| !bends_at_the_edge(evidence, options, f.cutoff_hz(tau0_s)))
        })
        .map(|point| {
            let price = thresholds.quantization_beside_filter;
            let reached = with_priced_quantization(joint, &point, ramp, price);
            let excess = current.deviance - reached - thresholds.filter;
            Candidate { point, zones: found.zones.clone(), excess }
        })
        .max_by(|a, b| a.excess.total_cmp(&b.excess))
}

/// A filter is seen by what it does to white noise: what bends flicker and random walk alone is something else.
pub(super) fn shows_filter(point: &JointPoint, joint: &Joint<'_>) -> bool {
    let (model, tau0_s) = (point.composite(joint.sampling()), joint.evidence().tau0_s);
    let Some(filter) = model.bandwidth else { return false };
    let cutoff_hz = filter.cutoff_hz(tau0_s).min(0.4 / tau0_s);
    let white = model.part_density(Part::Term(NoiseType::AngleRandomWalk), cutoff_hz, tau0_s);
    white >= FILTERED_SHARE * model.density(cutoff_hz, tau0_s)
}

fn markovs(
    joint: &Joint<'_>,
    found: &Extras,
    current: &JointPoint,
    ramp: bool,
    options: &Options,
) -> Option<Candidate> {
    let thresholds = &options.process_thresholds;
    let evidence = joint.evidence();
    let shortest_s = MIN_TIME_SAMPLES * evidence.tau0_s;
    let octaves = (MAX_TIME_SHARE * evidence.span_s / shortest_s).log2().max(0.0);
    let count = (octaves * PER_OCTAVE) as usize;
    let best = (0..=count)
        .map(|i| {
            let time_s = shortest_s * 2f64.powf(i as f64 / PER_OCTAVE);
            at_shape(
                joint,
                &found.shape.with(ProcessKind::Markov, 0.0, time_s),
                current,
                ramp,
                SCREENING_STEPS,
            )
        })
        .min_by(|a, b| a.deviance.total_cmp(&b.deviance))?;
    if current.deviance - best.deviance < 0.3 * thresholds.markov {
        return None;
    }
    let point = refined(joint, &best, ramp);
    let time_s = point.shape.damped.last()?.1.decay_time_s;
    let corner_hz = 1.0 / (2.0 * PI * time_s);
    let resolved = time_s >= shortest_s && time_s <= MAX_TIME_SHARE * evidence.span_s;
    if !resolved || bends_at_the_edge(evidence, options, corner_hz) {
        return None;
    }
    let reached = with_priced_quantization(joint, &point, ramp, thresholds.quantization);
    let excess = current.deviance - reached - thresholds.markov;
    Some(Candidate { point, zones: found.zones.clone(), excess })
}

/// True for a corner at the upper edge of a range that was cut: a bend there is the beginning of what was cut off, and no process,
/// filter or resonance.
fn bends_at_the_edge(evidence: &Evidence, options: &Options, corner_hz: f64) -> bool {
    edge_hz(evidence, options).is_some_and(|edge_hz| MIN_EDGE_DISTANCE * corner_hz > edge_hz)
}

/// Upper edge of a range that was cut, Hz; `None` where it reaches up to the Nyquist frequency, or where parts at the edge count.
fn edge_hz(evidence: &Evidence, options: &Options) -> Option<f64> {
    if options.parts_at_edge {
        return None;
    }
    let highest_hz = evidence.bands.iter().map(|b| b.high_hz).fold(0.0, f64::max);
    (highest_hz * evidence.tau0_s < UNCUT_RANGE).then_some(highest_hz)
}

fn periodics(
    evidence: &Evidence,
    joint: &Joint<'_>,
    found: &Extras,
    current: &JointPoint,
    ramp: bool,
    options: &Options,
) -> Option<Candidate> {
    let thresholds = &options.process_thresholds;
    let density = joint.density_at(current);
    let mut best: Option<Candidate> = None;
    for peak in strongest(joint.evidence(), &density, MAX_PEAKS) {
        let need = thresholds.quasi_periodic + 2.0 * resolved_places(evidence, &peak.zone).ln();
        if peak.gain < 0.5 * need {
            continue;
        }
        let mut zones = found.zones.clone();
        zones.push(peak.zone);
        let resolved =
            usable_evidence(evidence, &Extras { shape: found.shape.clone(), zones: zones.clone() });
        let Some(fine) = Joint::new(&resolved, joint.sampling()) else { continue };
        let before = at_shape(&fine, &found.shape, current, ramp, FIT_STEPS);
        let time_s = 1.0 / (2.0 * PI * peak.zone.half_width_hz);
        let shape = found.shape.with(ProcessKind::QuasiPeriodic, peak.zone.centre_hz, time_s);
        let point = refined(&fine, &at_shape(&fine, &shape, &before, ramp, FIT_STEPS), ramp);
        let excess = before.deviance - point.deviance - need;
        // A resonance that the edge cuts off may be anything that rises there.
        let reach_hz = |d: &Damped| d.frequency_hz + MIN_EDGE_DISTANCE / (2.0 * PI * d.decay_time_s);
        let is_cut_off = edge_hz(evidence, options)
            .zip(point.shape.damped.last())
            .is_some_and(|(edge_hz, (_, d))| reach_hz(d) > edge_hz);
        if is_cut_off {
            continue;
        }
        if best.as_ref().is_none_or(|b| excess > b.excess) {
            best = Some(Candidate { point, zones, excess });
        }
    }
    best
}

/// Places of this width that the record resolves.
fn resolved_places(evidence: &Evidence, zone: &Zone) -> f64 {
    let highest = evidence.fine().iter().map(|b| b.frequency_hz).fold(0.0, f64::max);
    let step = evidence.resolution_hz(zone.centre_hz);
    (highest / (2.0 * zone.half_width_hz).max(step)).max(1.0)
}
