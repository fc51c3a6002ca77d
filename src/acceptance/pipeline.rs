//! The way from a recording to its record, the same for every kind of test: collect, judge, measure, record.

use super::build_record::{self, build_record};
use super::clock_component;
use super::condition::checks::CheckLog;
use super::condition::thermometer::Thermometer;
use super::condition::{ColumnFact, Facts, judge_all};
use super::derived;
use super::external;
use super::interim::{self, Interim};
use super::missing_rows;
use super::programs::{self, Given};
use super::reading::{self, tidy};
use super::request::{Outcome, Request};
use super::sinks::{Overview, StabilitySink};
use super::test_kind::{Evidence, Progress, Reading, Run, TestKind};
use super::thermometer_pairs::{self, PairSink};
use super::verdict;
use crate::config::procedure::limits::gyro_of;
use crate::estimate::Estimate;
use crate::ingest::Plan;
use crate::record::{ConditionRecord, ConditionStatus, MeasurandRecord, Window};
use crate::recording::window::Windowed;
use crate::recording::{Channel, Role};

/// A test of any kind, ready to run.
pub(super) trait Test {
    /// Ids of the checks that the test could make, apart from those of every test.
    fn checks(&self) -> &'static [&'static str];

    /// Runs it.
    ///
    /// # Errors
    /// There is nothing to evaluate.
    fn run(self: Box<Self>, request: &Request<'_>, progress: Progress<'_>) -> Run<Outcome>;
}

impl<K: TestKind> Test for K {
    fn checks(&self) -> &'static [&'static str] {
        K::OWN_CHECKS
    }

    fn run(self: Box<Self>, request: &Request<'_>, progress: Progress<'_>) -> Run<Outcome> {
        let at_look = interim::at_reached_look(request, self.pauses(), &mut *progress)?;
        let request =
            &Request { procedure: at_look.as_ref().unwrap_or(request.procedure), ..request.clone() };
        let options = self.options(request);
        let (reading, evidence) = collect(*self, request, &mut *progress)?;
        let conditions = judge(&reading, &evidence);
        let mut found = estimates(&reading, &evidence);
        clock_component::add(request, &mut found, &mut |moved| {
            let Some(kind) = K::of(moved.procedure) else { return Ok(vec![]) };
            let (reading, evidence) = collect(kind, moved, &mut *progress)?;
            Ok(estimates(&reading, &evidence))
        })?;
        let looks = Interim::of(&reading, &evidence, &found);
        let given = programs::given(&reading, &mut *progress)?;
        let rows = rows(&reading, &evidence, &found, (looks.as_ref(), &given), K::MISSING_REASON);
        let figures = evidence.figures(&reading);
        let mut record = build_record(&reading, K::OWN_CHECKS, conditions, rows, &figures, options);
        if let Some(looks) = &looks {
            looks.complete(&mut record, &externals(request));
        }
        let tables = evidence.complete(&reading, &mut record);
        Ok(Outcome { record, figures, tables })
    }
}

/// Reads the recording once, and makes evidence of what was collected.
fn collect<'r, K: TestKind>(
    kind: K,
    request: &'r Request<'r>,
    progress: Progress<'_>,
) -> Run<(Reading<'r>, K::Evidence)> {
    let procedure = request.procedure;
    let channels = reading::channels(procedure, request.source);
    let pauses = kind.pauses();
    let mut plan = reading::plan(request, &channels, pauses)?;
    let nominal_s = plan.clock().interval_s;
    let mut read = |plan: &Plan<'_>| -> Run<_> {
        let mut overview = Overview::new(procedure, &channels, tidy(nominal_s));
        let stability = StabilitySink::new(procedure, &channels, tidy(nominal_s), plan.start_s());
        let pairs = PairSink::new(procedure, &channels);
        let inside = (stability, (pairs, kind.collector(request, &channels, nominal_s)?));
        let mut windowed = Windowed::new(inside, reading::window(procedure), plan.start_s(), nominal_s);
        let report = plan.stream(&mut [&mut overview, &mut windowed], progress)?;
        Ok(((overview, windowed), report))
    };
    let ((overview, windowed), report) = reading::read_at_measured_interval(&mut plan, &mut read)?;
    let start_s = plan.start_s();
    let ((stability, (pairs, collected)), mut window) = windowed.finish();
    reading::name_pauses(&mut window, &report);
    let (stability, statuses) = stability.finish();
    let mut reading = Reading {
        request,
        channels,
        pauses,
        start_s,
        tau0_s: tidy(report.tau0_measured_s),
        report,
        window,
        stability,
        statuses,
        thermometer_pairs: pairs.finish(),
        envelopes: overview.finish(),
        checks: CheckLog::default(),
    };
    let evidence = kind.evaluate(&reading, collected, progress)?;
    reading::settle_integrity(&mut reading.report, &overview, reading.tau0_s, evidence.noise_deg_h());
    Ok((reading, evidence))
}

/// Judges the conditions: those of the kind of test, then those of every test.
fn judge(reading: &Reading<'_>, evidence: &dyn Evidence) -> Vec<ConditionRecord> {
    let request = reading.request;
    let mut conditions = evidence.conditions(reading);
    let rest = evidence.rest_facts(reading);
    // Without a procedure the unit comes from the name of the column, or from a user who knows better.
    let (columns, stated_serials) =
        if request.is_run() { (columns(reading), request.source.stated_serials()) } else { (vec![], vec![]) };
    let thermometers = thermometers(reading);
    let files = build_record::recording(reading);
    conditions.extend(judge_all(&Facts {
        procedure: request.procedure,
        integrity: &reading.report.integrity,
        rows: reading.report.rows,
        sample_interval_s: reading.tau0_s,
        clock_notes: &reading.report.notes,
        has_stamps: reading.has_stamps(),
        usable_s: reading.window.usable_s,
        longest_gap_s: longest_gap_s(&reading.window),
        stability: &reading.stability,
        statuses: &reading.statuses,
        warm_up: &rest.warm_up,
        gyros: &rest.gyros,
        limits: request.limits,
        thermometers: &thermometers,
        columns: &columns,
        duration_s: reading.report.duration_s,
        stated_serials: &stated_serials,
        serial: request.unit.serial.as_deref(),
        serial_of_recording: request.serial_of_recording,
        schedule: rest.schedule,
        today: request.now.date_naive(),
        on_bench: request.on_bench(&files),
        bench_checks: request.bench_checks,
        checks: &reading.checks,
    }));
    if !request.is_run() {
        // An analysis asks nothing of a recording and judges no unit.
        for c in conditions.iter_mut().filter(|c| c.status == ConditionStatus::Invalid) {
            c.status = ConditionStatus::Remark;
        }
    }
    conditions
}

/// The estimates of every measurand of the procedure.
fn estimates(reading: &Reading<'_>, evidence: &dyn Evidence) -> Vec<Estimate> {
    let mut estimates = Vec::new();
    for spec in &reading.request.procedure.measurands {
        let asked = |channel: &str| spec.channel.as_deref().is_none_or(|c| c == gyro_of(channel));
        estimates.extend(evidence.estimates(reading, spec).into_iter().filter(|e| asked(&e.channel)));
    }
    estimates
}

/// Sets each estimate, and what programs of the user gave, against its limit. `missing` is the key of the reason for a measurand without an estimate.
fn rows(
    reading: &Reading<'_>,
    evidence: &dyn Evidence,
    estimates: &[Estimate],
    (looks, given): (Option<&Interim<'_>>, &[Given<'_>]),
    missing: &'static str,
) -> Vec<MeasurandRecord> {
    let limits = looks.map(|looks| looks.limits(reading.request.limits));
    let request = reading.request;
    let request = &Request { limits: limits.as_ref().unwrap_or(request.limits), ..request.clone() };
    let procedure = request.procedure;
    let rows = estimates.iter().map(|e| verdict::row(e, request.limits, procedure)).collect();
    // An analysis shows what the recording has; nobody asked for one value by name.
    let mut rows = if request.is_run() {
        missing_rows::complete(request, &reading.channels, missing, rows)
    } else {
        rows
    };
    let gyros = reading.channels.iter().filter(|c| c.role.is_gyro());
    let gyros: Vec<&str> = gyros.map(|c| c.id.as_str()).collect();
    let correlation = |one: &_, other: &_| evidence.correlation(one, other);
    rows.extend(derived::rows(procedure, request.limits, &gyros, estimates, &correlation));
    rows.extend(external::rows(procedure, request.limits, &request.unit));
    rows.extend(thermometer_pairs::rows(procedure, &reading.thermometer_pairs, request.limits));
    rows.extend(programs::rows(given, request.limits));
    if let Some(looks) = looks {
        looks.settle(&mut rows, &externals(request));
    }
    rows
}

/// Ids of the rows that come from other tests.
fn externals(request: &Request<'_>) -> Vec<String> {
    request.procedure.externals.iter().map(|e| e.id.clone()).collect()
}

/// The longest gap in what was evaluated, s.
fn longest_gap_s(window: &Window) -> f64 {
    let gaps = window.excluded.iter().filter(|s| s.reason == "gap");
    gaps.map(|s| s.to_s - s.from_s).fold(0.0, f64::max)
}

/// The thermometers whose readings no stated temperature or course tells, each with its mean.
fn thermometers(reading: &Reading<'_>) -> Vec<Thermometer> {
    let own = reading.channels.iter().filter(|c| c.role == Role::Temperature);
    own.filter_map(|channel| {
        let read = reading.report.channels.iter().find(|c| c.id == channel.id)?;
        Thermometer::unstated(reading.procedure(), &channel.id, read.values.mean)
    })
    .collect()
}

/// The columns that the channels were read from.
fn columns(reading: &Reading<'_>) -> Vec<ColumnFact> {
    let source = reading.request.source;
    let column = |channel: &Channel| {
        let place = source.resolve(&channel.column).ok()?;
        let column = source.columns().get(place)?;
        // Of stamps that a reader turned into seconds, the name may still say what they were.
        let converted = column.epoch_s.is_some() || column.rollover_s.is_some();
        let fact = || ColumnFact {
            channel: channel.id.clone(),
            name: column.name.clone(),
            unit: column.unit.clone(),
        };
        (!converted).then(fact)
    };
    reading.channels.iter().filter_map(column).collect()
}
