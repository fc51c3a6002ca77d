//! A gyro at rest over temperature, and while it warms up: what a test at rest shows, and block means of rate and
//! temperature besides.

use super::at_rest::{self, RateDigests, RestEvidence};
use crate::acceptance::reading::tidy;
use crate::acceptance::request::Request;
use crate::acceptance::test_kind::{Progress, Reading, Run, TestKind, TestOption};
use crate::config::procedure::Procedure;
use crate::measurand::GyroEvidence;
use crate::noise::tails::Deviations;
use crate::recording::{Channel, Role, SampleBlock, Sink};
use crate::temperature::findings::{Analysis, Findings, Schedule, findings, schedule};
use crate::temperature::start::start;
use crate::temperature::track::{Means, Track};
use crate::temperature::{TemperatureTest, WarmUpTest, warm_up};
use std::collections::BTreeMap;

/// A test over temperature, of the warm-up, or of both.
pub struct OverTemperature {
    temperature: Option<TemperatureTest>,
    warm_up: Option<WarmUpTest>,
}

/// Block means of gyros, temperatures and supplies in the making.
pub struct BlockMeans {
    /// Position of every tracked channel among the channels.
    slots: Vec<usize>,
    track: Track,
}

impl Sink for BlockMeans {
    fn push(&mut self, block: &SampleBlock<'_>) {
        for (at, slot) in self.slots.iter().enumerate() {
            if let Some(values) = block.values.get(*slot) {
                self.track.push(at, values, block.first_index);
            }
        }
    }
}

impl TestKind for OverTemperature {
    type Collector = (RateDigests, BlockMeans);
    type Evidence = RestEvidence;
    const OWN_CHECKS: &'static [&'static str] = &["earth_rate", "noise_level", "distribution"];
    const MISSING_REASON: &'static str = "unshown.no_course";

    fn of(procedure: &Procedure) -> Option<OverTemperature> {
        let test = OverTemperature {
            temperature: procedure.temperature_test.clone(),
            warm_up: procedure.warm_up_test.clone(),
        };
        (test.temperature.is_some() || test.warm_up.is_some()).then_some(test)
    }

    fn options(&self, request: &Request<'_>) -> Vec<TestOption> {
        at_rest::options(request)
    }

    fn collector(
        &self,
        request: &Request<'_>,
        channels: &[Channel],
        interval_s: f64,
    ) -> Run<Self::Collector> {
        let tau0_s = tidy(interval_s);
        let tracked = |c: &Channel| c.role.is_gyro() || matches!(c.role, Role::Temperature | Role::Supply);
        let slots: Vec<usize> =
            channels.iter().enumerate().filter(|(_, c)| tracked(c)).map(|(slot, _)| slot).collect();
        let track = Track::new(slots.len(), tau0_s);
        Ok((RateDigests::new(request, channels, tau0_s)?, BlockMeans { slots, track }))
    }

    fn evaluate(
        self,
        reading: &Reading<'_>,
        (digests, means): Self::Collector,
        _: Progress<'_>,
    ) -> Run<RestEvidence> {
        let mut gyros = at_rest::evidence(reading, digests)?;
        let (slots, means) = (means.slots, means.track.finish());
        let schedule = means.as_ref().and_then(|m| self.examine(reading, &mut gyros, &slots, m));
        let from_lines = means.map_or_else(BTreeMap::new, |m| from_lines(&gyros, reading, &slots, &m));
        Ok(RestEvidence { gyros, from_lines, schedule })
    }
}

impl OverTemperature {
    /// Adds what the tests showed to the evidence of each channel; gives the schedule of the temperature.
    fn examine(
        &self,
        reading: &Reading<'_>,
        gyros: &mut [GyroEvidence],
        slots: &[usize],
        means: &Means,
    ) -> Option<Schedule> {
        let position = |id: &str| {
            let slot = reading.channels.iter().position(|c| c.id == id)?;
            slots.iter().position(|s| *s == slot)
        };
        let mut found = None;
        if let Some(test) = &self.temperature {
            let temperature = position(&test.channel);
            let command = test.command.as_deref().and_then(position);
            found = temperature.and_then(|t| schedule(means, t, command, test));
            for gyro in gyros.iter_mut() {
                gyro.over_temperature = match (position(&gyro.channel), temperature) {
                    (Some(rate), Some(t)) => Some(findings(means, rate, t, found.clone(), test)),
                    _ => Some(Findings::nothing(test)),
                };
            }
        }
        if let Some(test) = &self.warm_up {
            let first_stamp_s = reading.has_stamps().then_some(reading.start_s);
            let start = start(&test.start, means, test.start.channel().and_then(position), first_stamp_s);
            for gyro in gyros {
                gyro.warm_up =
                    position(&gyro.channel).and_then(|rate| warm_up::find(means, rate, test, start));
            }
        }
        found
    }
}

/// Longest part of the residual of a model of the course whose values are set against one line, samples.
const BLOCK_OF_RESIDUAL: usize = 256;
/// The same of a course without a model, which bends.
const BLOCK_OF_COURSE: usize = 64;

/// Deviations of the samples of every gyro channel from its course. Sampled so fast that a block mean has several samples, the
/// bias hardly moves within the blocks of a test at rest, and their spread is known from those.
fn from_lines(
    gyros: &[GyroEvidence],
    reading: &Reading<'_>,
    slots: &[usize],
    means: &Means,
) -> BTreeMap<String, Deviations> {
    let of = |gyro: &GyroEvidence| {
        let slot = reading.channels.iter().position(|c| c.id == gyro.channel)?;
        let samples = means.values.get(slots.iter().position(|s| *s == slot)?)?;
        let analysis = gyro.over_temperature.as_ref().and_then(|f| f.analysis.as_ref());
        let (values, longest) = match analysis {
            Some(analysis) => (residual(samples, means, analysis), BLOCK_OF_RESIDUAL),
            None => (samples.clone(), BLOCK_OF_COURSE),
        };
        let stretches = values.split(|v| !v.is_finite());
        Some((gyro.channel.clone(), Deviations::from_lines(stretches, longest)?))
    };
    if means.samples > 1 { BTreeMap::new() } else { gyros.iter().filter_map(of).collect() }
}

/// Samples less the model of the bias, which is straight from the middle of a block to that of the next.
fn residual(samples: &[f64], means: &Means, analysis: &Analysis) -> Vec<f64> {
    let (course, modelled) = (&analysis.course, &analysis.modelled);
    let last = modelled.len().saturating_sub(1);
    let model = |time_s: f64| {
        let place = ((time_s - course.first_s) / course.block_s - 0.5).clamp(0.0, last as f64);
        let (at, share) = ((place as usize).min(last), place.fract());
        let of = |i: usize| modelled.get(i.min(last)).copied().unwrap_or(f64::NAN);
        of(at) + share * (of(at + 1) - of(at))
    };
    let time_s = |i: usize| means.first_s + (i as f64 + 0.5) * means.block_s;
    samples.iter().enumerate().map(|(i, v)| v - model(time_s(i))).collect()
}
