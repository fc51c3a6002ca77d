//! What the samples of a gyro at rest show: the digest of one pass, its lines, its noise, whether it moved.

use crate::acceptance::request::{Request, RunError};
use crate::acceptance::test_kind::{Reading, Run};
use crate::i18n::Arg;
use crate::measurand::evidence::Course;
use crate::measurand::{Earth, GyroEvidence};
use crate::noise::digest::{DigestPlan, RateAccumulator};
use crate::noise::envelope::Envelope;
use crate::noise::family::Estimator;
use crate::noise::motion::{motion, together};
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
            let (alarm, step_deg_h) = (procedure.analysis.line_false_alarm, reading.quantization_step(slot));
            let earth = procedure.site.as_ref().map(|site| {
                let rate = site.earth_rate_along(&channel);
                Earth { rate_deg_h: rate.value, uncertainty_deg_h: rate.uncertainty }
            });
            let gyro = GyroEvidence::identify(channel, digest.finish(), reading.tau0_s, alarm, step_deg_h);
            let noise_test = procedure.noise_test.clone();
            Some(GyroEvidence { several, earth, course: course(reading, slot), noise_test, ..gyro })
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

/// A gyro channel beside the temperatures.
fn course(reading: &Reading<'_>, slot: usize) -> Option<Course> {
    let envelope = |slot: usize| reading.envelopes.get(&slot).cloned();
    let thermometers = reading.channels.iter().enumerate().filter(|(_, c)| c.role == Role::Temperature);
    let temperatures = thermometers.filter_map(|(slot, c)| Some((c.id.clone(), envelope(slot)?)));
    Some(Course { rate: envelope(slot)?, temperatures: temperatures.collect() })
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
