//! A series of switching off and on: the bias of every run, and how it scatters.

use super::stretch_facts::{RestMean, Stretches, range};
use crate::acceptance::condition::GyroFact;
use crate::acceptance::condition::influence::{RunFacts, judge_runs};
use crate::acceptance::request::{Request, Table};
use crate::acceptance::test_kind::{Evidence, Progress, Reading, RestFacts, Run, TestKind, TestOption};
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
    /// The channels at rest in the runs.
    rest: Vec<GyroFact>,
}

impl TestKind for Repeated {
    type Collector = Collector;
    type Evidence = RunEvidence;
    const OWN_CHECKS: &'static [&'static str] = &["earth_rate", "noise_level", "distribution"];
    const MISSING_REASON: &'static str = "unshown.few_runs";

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
        let channels: Vec<Repeatability> = (0..blocks.gyros.len())
            .filter_map(|g| repeatability::evaluate(&blocks, &series, g, earth(&blocks.gyros[g])))
            .collect();
        let runs = Stretches { blocks: &blocks, spans: series.list.iter().map(|r| r.blocks).collect() };
        let fact = |c: &Repeatability| runs.fact(reading, &c.channel, Some(&rest_mean(c, earth(&c.channel))));
        let rest = channels.iter().filter_map(fact).collect();
        Ok(RunEvidence { test: self.test, series, channels, rest })
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

    fn rest_facts(&self, reading: &Reading<'_>) -> RestFacts<'_> {
        RestFacts::of_gyros(reading, &self.rest)
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

/// Mean output of all runs, the Earth rate that was taken out put back.
fn rest_mean(c: &Repeatability, earth_deg_h: f64) -> RestMean {
    let noise = c.runs.iter().map(|r| r.bias.standard.powi(2)).sum::<f64>();
    let count = c.runs.len().max(1) as f64;
    RestMean {
        mean_deg_h: c.mean + earth_deg_h,
        uncertainty_deg_h: (c.plain.powi(2) / count + noise / (count * count)).sqrt(),
        range_deg_h: range(c.runs.iter().map(|r| r.bias.value)),
    }
}
