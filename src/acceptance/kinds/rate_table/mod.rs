//! Steps of a rate table: the response of every channel to the rates of the table, one linear model over short block means.

mod evidence;
mod facts;
mod steps;

use crate::acceptance::compensation_files;
use crate::acceptance::condition::table::{judge_and_log, judge_scale};
use crate::acceptance::figures;
use crate::acceptance::request::{Request, Table};
use crate::acceptance::tables;
use crate::acceptance::test_kind::{Evidence, Progress, Reading, Run, TestKind, TestOption};
use crate::config::procedure::Procedure;
use crate::config::procedure::model::MeasurandSpec;
use crate::estimate::Estimate;
use crate::figure::Figure;
use crate::ingest::Pauses;
use crate::measurand::{self, Stimulus, TableEvidence};
use crate::rate_table::blocks::Collector;
use crate::rate_table::compensation::ScaleCompensation;
use crate::rate_table::dead_zone::DeadZone;
use crate::rate_table::scale_factor::ScaleFactor;
use crate::rate_table::scale_over_temperature::ScaleOverTemperature;
use crate::rate_table::{Setup, TableRun};
use crate::record::{ConditionRecord, RunRecord};
use crate::recording::Channel;

/// A test whose rates are found in the recording of the table.
pub struct RateTable {
    setup: Setup,
}

/// What the recording shows.
pub struct StepEvidence {
    setup: Setup,
    run: TableRun,
    channels: Vec<TableChannel>,
    /// The estimates of every measurand of the procedure, in its order.
    estimates: Vec<Vec<Estimate>>,
}

/// What one gyro channel shows.
struct TableChannel {
    /// Position among the gyro channels.
    gyro: usize,
    /// The line of output over rate; `None` where none could be drawn.
    line: Option<ScaleFactor>,
    /// The response to rates near zero, where it is asked for.
    dead_zone: Option<DeadZone>,
    /// Scale factor and bias at every soak, where they are asked for and shown.
    over_temperature: Option<ScaleOverTemperature>,
}

impl StepEvidence {
    fn lines(&self) -> impl Iterator<Item = &ScaleFactor> {
        self.channels.iter().filter_map(|c| c.line.as_ref())
    }

    /// The channels whose scale factor over temperature is known, by name.
    fn over_temperature(&self) -> impl Iterator<Item = (&str, &ScaleOverTemperature)> {
        let named = |c: &'_ TableChannel| self.run.blocks.gyros.get(c.gyro).map(String::as_str);
        self.channels.iter().filter_map(move |c| named(c).zip(c.over_temperature.as_ref()))
    }

    /// Scale factor and bias over temperature as tables for firmware: TOML, JSON, C header.
    fn compensation_tables(&self, reading: &Reading<'_>) -> Vec<Table> {
        let serial = reading.request.unit.serial.as_deref();
        let highest = self.run.steps.list.iter().fold(0.0, |m: f64, s| m.max(s.rate.abs()));
        let several = self.channels.len() > 1;
        let of = |(channel, found): (&str, &ScaleOverTemperature)| {
            let made = ScaleCompensation::of(found, channel, serial, highest);
            let stem = "scale_factor_compensation";
            let stem = if several { format!("{stem}_{channel}") } else { stem.to_owned() };
            compensation_files::files(&stem, &made, made.header())
        };
        self.over_temperature().flat_map(of).collect()
    }
}

impl TestKind for RateTable {
    type Collector = Collector;
    type Evidence = StepEvidence;
    const OWN_CHECKS: &'static [&'static str] =
        &["earth_sign", "table_response", "table_reached", "table_agreement", "clock_by_turns"];
    const MISSING_REASON: &'static str = "unshown.no_line";

    fn of(procedure: &Procedure) -> Option<RateTable> {
        let setup = procedure.rate_table.clone().filter(|s| s.known.is_empty())?;
        Some(RateTable { setup })
    }

    fn options(&self, request: &Request<'_>) -> Vec<TestOption> {
        table_options(request.procedure, &self.setup)
    }

    fn pauses(&self) -> Pauses {
        Pauses { between_files: true, from_s: None }
    }

    fn collector(&self, _: &Request<'_>, channels: &[Channel], interval_s: f64) -> Run<Collector> {
        Ok(Collector::new(channels, interval_s, self.setup.temperature.as_deref()))
    }

    fn evaluate(self, reading: &Reading<'_>, collected: Collector, _: Progress<'_>) -> Run<StepEvidence> {
        let (procedure, setup) = (reading.procedure(), self.setup);
        let blocks = collected.finish(reading.report.tau0_measured_s).with_freed_temperature();
        let run = TableRun::new(blocks, &setup);
        let found = evidence::evaluate(procedure, &run, &setup);
        let of = |m: &MeasurandSpec| found.iter().flat_map(|c| m.measurand.evaluate_steps(c)).collect();
        let estimates = procedure.measurands.iter().map(of).collect();
        let channel = |c: TableEvidence<'_>| TableChannel {
            gyro: c.gyro,
            line: c.line,
            dead_zone: c.dead_zone,
            over_temperature: c.over_temperature.and_then(Result::ok),
        };
        let channels = found.into_iter().map(channel).collect();
        Ok(StepEvidence { setup, run, channels, estimates })
    }
}

impl Evidence for StepEvidence {
    fn conditions(&self, reading: &Reading<'_>) -> Vec<ConditionRecord> {
        let procedure = reading.procedure();
        let lines: Vec<_> = self.channels.iter().map(|c| (c.gyro, c.line.as_ref())).collect();
        // Where the input axis is square to the axis that is turned about, that is the other one.
        let about_outer = wants_alignment(procedure);
        let facts = facts::table_facts(reading.request, &self.setup, &self.run, &lines, about_outer);
        let mut conditions = judge_and_log(&facts, &reading.checks);
        if about_outer {
            // The output follows by the tilt only.
            conditions.retain(|c| c.id != "table_reached");
        }
        conditions.extend(self.lines().filter_map(|c| judge_scale(&c.channel, c.factor)));
        conditions
    }

    fn estimates(&self, reading: &Reading<'_>, spec: &MeasurandSpec) -> Vec<Estimate> {
        let mut specs = reading.procedure().measurands.iter();
        let at = specs.position(|m| std::ptr::eq(m, spec));
        at.and_then(|at| self.estimates.get(at)).cloned().unwrap_or_default()
    }

    fn figures(&self, reading: &Reading<'_>) -> Vec<Figure> {
        let request = reading.request;
        let wanted = |id: &str| request.procedure.report.shows(id);
        let several = self.channels.len() > 1;
        let mut list = Vec::new();
        for line in self.lines() {
            if wanted("scale_factor_residual") {
                let limit = request
                    .limits
                    .limit(measurand::SCALE_FACTOR_NONLINEARITY.id, &line.channel)
                    .map(|l| &l.limit);
                list.push(figures::scale_factor::residuals(&self.run, line, limit, several));
            }
            if wanted("table_polar") {
                list.extend(figures::polar::figure(&self.run, line, several));
            }
            if wanted("table_steps") {
                list.push(figures::scale_factor::over_time(&self.run, line, several));
            }
        }
        if wanted("scale_over_temperature") {
            let shown = |(name, found): (&str, &ScaleOverTemperature)| {
                figures::scale_over_temperature::figure(found, name, several)
            };
            list.extend(self.over_temperature().map(shown));
        }
        if wanted("dead_zone") {
            let zones = self.channels.iter().filter_map(|c| c.dead_zone.as_ref());
            list.extend(zones.map(|z| figures::dead_zone::figure(z, several)));
        }
        list
    }

    fn complete(&self, reading: &Reading<'_>, record: &mut RunRecord) -> Vec<Table> {
        let of = |c: &TableChannel| Some(steps::records(&self.run, c.line.as_ref()?, c.gyro));
        record.table_steps = self.channels.iter().filter_map(of).flatten().collect();
        let steps = ("table_steps.csv".to_owned(), tables::table_steps(&record.table_steps));
        std::iter::once(steps).chain(self.compensation_tables(reading)).collect()
    }
}

/// True when the direction of the input axis is asked for.
fn wants_alignment(procedure: &Procedure) -> bool {
    evidence::wants(procedure, Stimulus::OuterTurns)
}

/// The options of a test on a table, known positions and turns included.
pub fn table_options(procedure: &Procedure, setup: &Setup) -> Vec<TestOption> {
    let by_rows = setup.rows_are_steps.then(|| ("rate_table.rows_are_steps", "true".to_owned()));
    let usual = [
        ("rate_table.by_angle", setup.by_angle.to_string()),
        ("rate_table.whole_turns", setup.whole_turns.to_string()),
        ("rate_table.settling", format!("{} s", setup.settling_s)),
        ("rate_table.minimum_step", format!("{} s", setup.minimum_step_s)),
        ("conditions.warm_up", format!("{} s", procedure.conditions.warm_up_s)),
    ];
    by_rows.into_iter().chain(usual).collect()
}
