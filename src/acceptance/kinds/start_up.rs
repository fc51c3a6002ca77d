//! Switching on: when samples and valid data come, and what power is drawn.

use crate::acceptance::figures;
use crate::acceptance::request::Request;
use crate::acceptance::test_kind::{Evidence, Progress, Reading, Run, TestKind, TestOption};
use crate::config::procedure::Procedure;
use crate::config::procedure::model::MeasurandSpec;
use crate::estimate::Estimate;
use crate::figure::Figure;
use crate::recording::Channel;
use crate::start_up::zones::SwitchingsOn;
use crate::start_up::{StartUp, StartUpTest};

/// A test of the start-up.
pub struct FromSwitchingOn {
    test: StartUpTest,
}

/// What the recording shows.
pub struct StartUpEvidence {
    channels: Vec<StartUp>,
}

impl TestKind for FromSwitchingOn {
    type Collector = SwitchingsOn;
    type Evidence = StartUpEvidence;
    const OWN_CHECKS: &'static [&'static str] = &[];
    const MISSING_REASON: &'static str = "unshown.no_start_up";

    fn of(procedure: &Procedure) -> Option<FromSwitchingOn> {
        Some(FromSwitchingOn { test: procedure.start_up_test.clone()? })
    }

    fn options(&self, _: &Request<'_>) -> Vec<TestOption> {
        vec![("start_up_test.on_voltage", format!("{} V", self.test.on_voltage_v))]
    }

    fn collector(&self, _: &Request<'_>, channels: &[Channel], interval_s: f64) -> Run<SwitchingsOn> {
        Ok(SwitchingsOn::new(self.test.clone(), channels, interval_s))
    }

    fn evaluate(
        self,
        reading: &Reading<'_>,
        collected: SwitchingsOn,
        _: Progress<'_>,
    ) -> Run<StartUpEvidence> {
        Ok(StartUpEvidence { channels: collected.finish(reading.report.tau0_measured_s) })
    }
}

impl Evidence for StartUpEvidence {
    fn estimates(&self, _: &Reading<'_>, spec: &MeasurandSpec) -> Vec<Estimate> {
        self.channels.iter().flat_map(|c| spec.measurand.evaluate_start_up(c)).collect()
    }

    fn figures(&self, reading: &Reading<'_>) -> Vec<Figure> {
        figures::time_series::of_every_gyro(reading)
    }
}
