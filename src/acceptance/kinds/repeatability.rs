//! A series of switching off and on: the bias of every run, and how it scatters.

use crate::acceptance::condition::influence::{RunFacts, judge_runs};
use crate::acceptance::request::{Request, Table};
use crate::acceptance::test_kind::{Evidence, Progress, Reading, Run, TestKind, TestOption};
use crate::acceptance::{figures, interval_means};
use crate::config::procedure::Procedure;
use crate::config::procedure::model::MeasurandSpec;
use crate::estimate::Estimate;
use crate::figure::Figure;
use crate::influence::repeatability::{self, Repeatability};
use crate::influence::{RepeatabilityTest, runs};
use crate::ingest::Pauses;
use crate::rate_table::blocks::Collector;
use crate::record::{self, ConditionRecord, RunRecord};
use crate::recording::Channel;

/// A series of switching off and on.
pub struct Repeated {
    test: RepeatabilityTest,
}

/// What the recording shows.
pub struct RunEvidence {
    test: RepeatabilityTest,
    series: runs::Runs,
    channels: Vec<Repeatability>,
}

impl TestKind for Repeated {
    type Collector = Collector;
    type Evidence = RunEvidence;
    const CHECKS: &'static [&'static str] = &["earth_rate", "noise_level", "distribution"];
    const MISSING: &'static str = "unshown.few_runs";

    fn of(procedure: &Procedure) -> Option<Repeated> {
        Some(Repeated { test: procedure.repeatability_test.clone()? })
    }

    fn options(&self, _: &Request<'_>) -> Vec<TestOption> {
        vec![
            ("influence.settling", format!("{} s", self.test.settling_s)),
            ("influence.minimum", format!("{} s", self.test.minimum_run_s)),
            ("influence.off", format!("{} s", self.test.off_s)),
        ]
    }

    /// Wherever the unit was off.
    fn pauses(&self) -> Pauses {
        Pauses { between_files: true, from_s: Some(self.test.off_s) }
    }

    fn collector(&self, _: &Request<'_>, channels: &[Channel], interval_s: f64) -> Run<Collector> {
        Ok(Collector::new(channels, interval_s, self.test.temperature.as_deref()))
    }

    fn evaluate(self, reading: &Reading<'_>, collected: Collector, _: Progress<'_>) -> Run<RunEvidence> {
        let blocks = collected.finish(reading.report.tau0_measured_s);
        let series = runs::find(&blocks, &self.test, &reading.file_spans());
        let site = reading.procedure().site.as_ref();
        let earth = |channel: &str| site.map_or(0.0, |site| site.earth_rate_along(channel).value);
        let channels = (0..blocks.gyros.len())
            .filter_map(|g| repeatability::evaluate(&blocks, &series, g, earth(&blocks.gyros[g])))
            .collect();
        Ok(RunEvidence { test: self.test, series, channels })
    }
}

impl Evidence for RunEvidence {
    fn conditions(&self, reading: &Reading<'_>) -> Vec<ConditionRecord> {
        vec![judge_runs(&RunFacts {
            found: self.series.list.len(),
            fewest: self.test.fewest,
            too_short: self.series.too_short,
            minimum_run_s: self.test.minimum_run_s,
            // A time without output in one file is what switching off leaves; that files or stated times are runs is declared.
            evidence: match self.test.runs.is_empty() && reading.report.files.len() < 2 {
                true => record::Evidence::Inferred,
                false => record::Evidence::Declared,
            },
        })]
    }

    fn estimates(&self, _: &Reading<'_>, spec: &MeasurandSpec) -> Vec<Estimate> {
        self.channels.iter().flat_map(|c| spec.measurand.evaluate_runs(c)).collect()
    }

    fn figures(&self, reading: &Reading<'_>) -> Vec<Figure> {
        let wanted = reading.procedure().report.shows("bias_of_runs");
        let several = self.channels.len() > 1;
        let of_runs = self.channels.iter().filter(|_| wanted);
        of_runs
            .map(|c| figures::bias_of_runs::figure(c, several))
            .chain(figures::time_series::of_every_gyro(reading))
            .collect()
    }

    fn complete(&self, _: &Reading<'_>, record: &mut RunRecord) -> Vec<Table> {
        interval_means::complete(record, self.channels.iter().flat_map(interval_means::of_runs).collect())
    }
}
