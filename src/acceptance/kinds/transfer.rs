//! Motion of a table over frequency: the transfer function.

use crate::acceptance::figures;
use crate::acceptance::request::Request;
use crate::acceptance::test_kind::{Evidence, Progress, Reading, Run, TestKind, TestOption};
use crate::config::procedure::Procedure;
use crate::config::procedure::model::MeasurandSpec;
use crate::estimate::Estimate;
use crate::figure::Figure;
use crate::rate_table::cross_spectrum::CrossSpectra;
use crate::rate_table::transfer::{Transfer, TransferTest, evaluate};
use crate::recording::Channel;

/// A test of the transfer function.
pub struct OverFrequency {
    test: TransferTest,
}

/// What the recording shows.
pub struct TransferEvidence {
    channels: Vec<Transfer>,
}

impl TestKind for OverFrequency {
    type Collector = CrossSpectra;
    type Evidence = TransferEvidence;
    const OWN_CHECKS: &'static [&'static str] = &[];
    const MISSING_REASON: &'static str = "unshown.no_motion";

    fn of(procedure: &Procedure) -> Option<OverFrequency> {
        Some(OverFrequency { test: procedure.transfer_test? })
    }

    fn options(&self, _: &Request<'_>) -> Vec<TestOption> {
        vec![("transfer_test.least_coherence", self.test.least_coherence.to_string())]
    }

    fn collector(&self, _: &Request<'_>, channels: &[Channel], interval_s: f64) -> Run<CrossSpectra> {
        Ok(CrossSpectra::new(channels, interval_s))
    }

    fn evaluate(
        self,
        reading: &Reading<'_>,
        collected: CrossSpectra,
        _: Progress<'_>,
    ) -> Run<TransferEvidence> {
        let spectra = collected.finish(reading.report.tau0_measured_s);
        let channels = spectra.iter().map(|(channel, bins)| evaluate(channel, bins, self.test)).collect();
        Ok(TransferEvidence { channels })
    }
}

impl Evidence for TransferEvidence {
    fn estimates(&self, _: &Reading<'_>, spec: &MeasurandSpec) -> Vec<Estimate> {
        self.channels.iter().flat_map(|c| spec.measurand.evaluate_transfer(c)).collect()
    }

    fn figures(&self, reading: &Reading<'_>) -> Vec<Figure> {
        let wanted = reading.procedure().report.shows("bode");
        let several = self.channels.len() > 1;
        let of_response = self.channels.iter().filter(|c| wanted && !c.bands.is_empty());
        of_response
            .map(|c| figures::bode::figure(c, several))
            .chain(figures::time_series::of_every_gyro(reading))
            .collect()
    }
}
