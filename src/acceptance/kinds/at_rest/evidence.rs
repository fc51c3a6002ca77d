//! What the samples of a gyro at rest show: the digest of one pass, its lines, its noise, whether it moved.

use crate::acceptance::request::{Request, RunError};
use crate::acceptance::test_kind::{Reading, Run};
use crate::config::procedure::Procedure;
use crate::i18n::Arg;
use crate::measurand::{Earth, GyroEvidence};
use crate::noise::allan::DeviationSet;
use crate::noise::coarse;
use crate::noise::composite::{Composite, Sampling};
use crate::noise::curve_check;
use crate::noise::digest::{DigestPlan, RateAccumulator, RateDigest};
use crate::noise::envelope::Envelope;
use crate::noise::family::Estimator;
use crate::noise::identification::Identification;
use crate::noise::intervals::{BoundedPoint, bounded};
use crate::noise::lines::{SpectralLine, find_lines};
use crate::noise::motion::{Motion, motion, together};
use crate::noise::residual::GoodnessOfFit;
use crate::noise::spectral_record::SpectralRecord;
use crate::noise::whole::Whole;
use crate::recording::{Channel, Role, SampleBlock, Sink};

/// The digests of the gyro channels in the making, each with its position among the channels.
pub struct RateDigests(Vec<(usize, RateAccumulator)>);

impl RateDigests {
    /// Prepares for the gyro channels.
    ///
    /// # Errors
    /// Averaging times that do not suit the sample interval.
    pub fn new(request: &Request<'_>, channels: &[Channel], tau0_s: f64) -> Run<RateDigests> {
        let taus = request.tau_grid();
        taus.check(tau0_s)?;
        let exact = request.exact || request.procedure.analysis.exact;
        let plan = || DigestPlan {
            taus: taus.clone(),
            exact,
            estimators: Estimator::ALL.to_vec(),
            ..DigestPlan::new(tau0_s)
        };
        let gyros = channels.iter().enumerate().filter(|(_, c)| c.role.is_gyro());
        Ok(RateDigests(gyros.map(|(slot, _)| (slot, RateAccumulator::new(plan()))).collect()))
    }
}

impl Sink for RateDigests {
    fn push(&mut self, block: &SampleBlock<'_>) {
        for (slot, digest) in &mut self.0 {
            if let Some(values) = block.values.get(*slot) {
                digest.push(values, block.first_index, block.continues);
            }
        }
    }
}

/// The evidence of every gyro channel.
///
/// # Errors
/// [`RunError::Nothing`] when fewer than two samples are left of every channel.
pub fn evidence(reading: &Reading<'_>, collected: RateDigests) -> Run<Vec<GyroEvidence>> {
    let procedure = reading.procedure();
    let several = collected.0.len() > 1;
    let mut gyros: Vec<GyroEvidence> = collected
        .0
        .into_iter()
        .filter_map(|(slot, digest)| {
            let channel = reading.channels.get(slot)?.id.clone();
            let step_deg_h = reading.quantization_step(slot);
            Some(channel_evidence(procedure, channel, several, reading.tau0_s, digest.finish(), step_deg_h))
        })
        .collect();
    let warming_deg_c = warming_deg_c(reading);
    for gyro in &mut gyros {
        gyro.motion = motion(&gyro.digest.blocks, reading.tau0_s, gyro.digest.quietest_deg_h, warming_deg_c);
    }
    together(gyros.iter_mut().map(|g| &mut g.motion).collect());
    if gyros.iter().all(|g| g.digest.samples < 2) {
        let (request, warm_up_s) = (reading.request, procedure.conditions.warm_up_s);
        return Err(RunError::Nothing(if reading.window.usable_s > 0.0 || warm_up_s == 0.0 {
            request.about("run_error.too_few")
        } else {
            request
                .about("run_error.nothing_left")
                .with("warm_up", Arg::Stated(warm_up_s))
                .with("length", Arg::decimals(reading.report.duration_s, 6))
        }));
    }
    Ok(gyros)
}

/// The largest range of a temperature channel, degC.
fn warming_deg_c(reading: &Reading<'_>) -> f64 {
    let range = |e: &Envelope| {
        let means = || e.bins.iter().map(|b| b.mean).filter(|m| m.is_finite());
        means().fold(f64::NEG_INFINITY, f64::max) - means().fold(f64::INFINITY, f64::min)
    };
    let thermometers = reading.channels.iter().enumerate().filter(|(_, c)| c.role == Role::Temperature);
    thermometers.filter_map(|(slot, _)| reading.envelopes.get(&slot).map(range)).fold(0.0, f64::max)
}

/// Lines of a channel, and its noise with the lines left out. `step_deg_h` is the step of its output.
pub fn identify_noise(
    channel: &str,
    digest: &RateDigest,
    tau0_s: f64,
    line_false_alarm: f64,
    step_deg_h: Option<f64>,
) -> (Vec<SpectralLine>, Identification) {
    let lines = find_lines(&digest.welch.spectrum, tau0_s, line_false_alarm).lines;
    let record = SpectralRecord {
        blocks: &digest.blocks,
        welch: Some(&digest.welch.spectrum),
        tau0_s,
        lines: &lines,
        sampling: Sampling::Averaging,
    };
    let curve = digest.octaves.as_ref().unwrap_or(&digest.deviations).curve(Estimator::Allan);
    let points: Vec<(u64, f64)> =
        curve.map(|c| c.points.iter().map(|p| (p.m, p.deviation)).collect()).unwrap_or_default();
    let rounded_above_hz = step_deg_h.and_then(|step| coarse::highest_hz(step, tau0_s, &points));
    let noise = record.identify_up_to(channel, rounded_above_hz);
    (noise.lines, noise.ranged.identification)
}

/// How well the description of a channel fits it.
fn goodness(
    digest: &RateDigest,
    lines: &[SpectralLine],
    identification: &Identification,
    octaves: &[BoundedPoint],
    tau0_s: f64,
) -> GoodnessOfFit {
    let record = SpectralRecord {
        blocks: &digest.blocks,
        welch: Some(&digest.welch.spectrum),
        tau0_s,
        lines,
        sampling: Sampling::Averaging,
    };
    let points: Vec<_> = octaves.iter().map(|p| p.point).collect();
    GoodnessOfFit::of(&record, &identification.described, &points)
}

fn channel_evidence(
    procedure: &Procedure,
    channel: String,
    several: bool,
    tau0_s: f64,
    digest: RateDigest,
    step_deg_h: Option<f64>,
) -> GyroEvidence {
    let alarm = procedure.analysis.line_false_alarm;
    let (mut lines, mut identification) = identify_noise(&channel, &digest, tau0_s, alarm, step_deg_h);
    let model = &identification.described.model;
    let sigma_tau = allan_points(&digest.deviations, model, tau0_s);
    let octaves =
        digest.octaves.as_ref().map_or_else(|| sigma_tau.clone(), |set| allan_points(set, model, tau0_s));
    let whole = Whole::of(&digest, &octaves, identification.highest_hz);
    let withheld_line = whole.lines(&mut lines);
    if withheld_line.is_some() {
        let kept: Vec<f64> = lines.iter().map(|l| l.frequency_hz).collect();
        identification.described.keep_lines(|line| kept.contains(&line.frequency_hz));
    }
    whole.parts(&mut identification);
    curve_check::contest(&mut identification, &octaves, tau0_s, digest.samples);
    let goodness = goodness(&digest, &lines, &identification, &octaves, tau0_s);
    let longest_stretch_s = digest.deviations.stretches.longest() as f64 * tau0_s;
    let earth = procedure.site.as_ref().map(|site| {
        let rate = site.earth_rate_along(&channel);
        Earth { rate_deg_h: rate.value, uncertainty_deg_h: rate.uncertainty }
    });
    GyroEvidence {
        channel,
        several,
        tau0_s,
        longest_stretch_s,
        digest,
        sigma_tau,
        octaves,
        identification,
        goodness,
        lines,
        withheld_line,
        motion: Motion::Unknown,
        earth,
        over_temperature: None,
        warm_up: None,
    }
}

/// What makes a deviation scatter: all of a description but its lines. A line adds to a deviation and does not scatter,
/// so its slope says nothing about degrees of freedom.
pub fn scattering(model: &Composite) -> Composite {
    Composite { lines: vec![], ..model.clone() }
}

/// The points of the overlapping Allan deviation with their intervals.
fn allan_points(set: &DeviationSet, model: &Composite, tau0_s: f64) -> Vec<BoundedPoint> {
    let model = scattering(model);
    set.curve(Estimator::Allan).map_or_else(Vec::new, |curve| {
        curve
            .points
            .iter()
            .map(|p| {
                bounded(Estimator::Allan, p, &curve.stretches, model.dominant(p.m as f64 * tau0_s, tau0_s))
            })
            .collect()
    })
}
