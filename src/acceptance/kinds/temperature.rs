//! A gyro at rest over temperature, and while it warms up: what a test at rest shows, and block means of rate and
//! temperature besides.

use super::at_rest::{self, RateDigests, RestEvidence};
use crate::acceptance::reading::tidy;
use crate::acceptance::request::Request;
use crate::acceptance::test_kind::{Progress, Reading, Run, TestKind, TestOption};
use crate::config::procedure::Procedure;
use crate::measurand::GyroEvidence;
use crate::recording::{Channel, Role, SampleBlock, Sink};
use crate::temperature::findings::{Findings, Schedule, findings, schedule};
use crate::temperature::start::start;
use crate::temperature::track::{Means, Track};
use crate::temperature::{TemperatureTest, WarmUpTest, warm_up};

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
    const CHECKS: &'static [&'static str] = &["earth_rate", "noise_level", "distribution"];
    const MISSING: &'static str = "unshown.no_course";

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
        let schedule = means.track.finish().and_then(|m| self.examine(reading, &mut gyros, &means.slots, &m));
        Ok(RestEvidence { gyros, schedule })
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
