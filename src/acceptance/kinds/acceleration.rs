//! Positions in the field of gravity: how the bias depends on acceleration.

use super::stretch_facts::Stretches;
use crate::acceptance::condition::GyroFact;
use crate::acceptance::condition::positions::judge_stretches;
use crate::acceptance::figures;
use crate::acceptance::request::Request;
use crate::acceptance::test_kind::{Evidence, Progress, Reading, RestFacts, Run, TestKind, TestOption};
use crate::config::procedure::Procedure;
use crate::config::procedure::model::MeasurandSpec;
use crate::estimate::Estimate;
use crate::figure::Figure;
use crate::ingest::Pauses;
use crate::noise::static_bias::{Orientation, Uncertain, earth_rate};
use crate::rate_table::acceleration::{self, Acceleration, AccelerationTest};
use crate::rate_table::blocks::Collector;
use crate::rate_table::known;
use crate::record::ConditionRecord;
use crate::recording::Channel;

/// A test in positions in the field of gravity.
pub struct InGravity {
    test: AccelerationTest,
}

/// What the recording shows.
pub struct GravityEvidence {
    test: AccelerationTest,
    channels: Vec<Acceleration>,
    /// The channels at rest in the positions.
    rest: Vec<GyroFact>,
    /// Stated positions that the recording lacks.
    missing: usize,
}

impl TestKind for InGravity {
    type Collector = Collector;
    type Evidence = GravityEvidence;
    const OWN_CHECKS: &'static [&'static str] = &["noise_level", "distribution"];
    const MISSING_REASON: &'static str = "unshown.few_positions";

    fn of(procedure: &Procedure) -> Option<InGravity> {
        Some(InGravity { test: procedure.acceleration_test.clone()? })
    }

    fn options(&self, _: &Request<'_>) -> Vec<TestOption> {
        let terms = self.test.order.terms().len().to_string();
        let uncertainty = format!("{} ppm", 1e6 * self.test.scale_factor_uncertainty);
        vec![("acceleration_test.terms", terms), ("acceleration_test.scale_factor_uncertainty", uncertainty)]
    }

    fn pauses(&self) -> Pauses {
        Pauses { between_files: true, from_s: None }
    }

    fn collector(&self, _: &Request<'_>, channels: &[Channel], interval_s: f64) -> Run<Collector> {
        Ok(Collector::new(channels, interval_s, None).fine())
    }

    fn evaluate(self, reading: &Reading<'_>, collected: Collector, _: Progress<'_>) -> Run<GravityEvidence> {
        let blocks = &collected.finish(reading.report.tau0_measured_s);
        let test = self.test;
        let phases: Vec<(String, u64, u64)> =
            reading.file_spans().into_iter().filter_map(|f| Some((f.phase?, f.rows.0, f.rows.1))).collect();
        let stretches = known::stretches(blocks, &test.positions, &phases);
        let site = reading.procedure().site.as_ref();
        let latitude = site.map_or((0.0, 0.0), |s| (s.latitude_deg, s.latitude_uncertainty_deg));
        let uncertain = |(value, uncertainty)| Uncertain { value, uncertainty };
        let earth = |heading: (f64, f64), elevation: (f64, f64)| {
            let rate = earth_rate(&Orientation {
                latitude_deg: uncertain(latitude),
                heading_deg: uncertain(heading),
                elevation_deg: uncertain(elevation),
            });
            (rate.value, rate.uncertainty)
        };
        let of = |gyro: usize| acceleration::evaluate(blocks, &test, &stretches, gyro, &earth);
        let channels: Vec<Acceleration> = (0..blocks.gyros.len()).filter_map(of).collect();
        let at_rest = Stretches { blocks, spans: stretches.iter().map(|s| s.blocks).collect() };
        let rest = channels.iter().filter_map(|c| at_rest.fact(reading, &c.channel, None)).collect();
        let mut found: Vec<usize> = stretches.iter().map(|s| s.known).collect();
        found.sort_unstable();
        found.dedup();
        let missing = test.positions.len() - found.len();
        Ok(GravityEvidence { test, channels, rest, missing })
    }
}

impl Evidence for GravityEvidence {
    fn conditions(&self, _: &Reading<'_>) -> Vec<ConditionRecord> {
        vec![judge_stretches(self.test.positions.len(), self.missing)]
    }

    fn rest_facts(&self, reading: &Reading<'_>) -> RestFacts<'_> {
        RestFacts::of_gyros(reading, &self.rest)
    }

    fn estimates(&self, _: &Reading<'_>, spec: &MeasurandSpec) -> Vec<Estimate> {
        self.channels.iter().flat_map(|c| spec.measurand.evaluate_acceleration(c)).collect()
    }

    fn figures(&self, reading: &Reading<'_>) -> Vec<Figure> {
        let wanted = reading.procedure().report.shows("gravity");
        let several = self.channels.len() > 1;
        let of_positions = self.channels.iter().filter(|_| wanted);
        of_positions
            .map(|c| figures::gravity::figure(c, several))
            .chain(figures::time_series::of_every_gyro(reading))
            .collect()
    }
}
