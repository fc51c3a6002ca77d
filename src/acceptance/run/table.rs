//! A procedure for a rate table applied to a recording: one pass into blocks, then steps, response, rows, figures.

use super::evaluate::{self, Found};
use super::pass::{Inside, Overview};
use super::reading::{self, tidy};
use super::{Outcome, Request, RunError, figures, settle, table_evidence, table_steps, verdict};
use crate::acceptance::condition::checks::CheckLog;
use crate::acceptance::condition::table::{ChannelFact, Settling, TableFacts, judge_and_log, judge_scale};
use crate::acceptance::condition::thermometer::{Thermometer, judge_scale_of_temperature};
use crate::acceptance::condition::{Facts, judge_all};
use crate::config::procedure::Procedure;
use crate::figure::Figure;
use crate::ingest::Plan;
use crate::measurand::{self, Stimulus, TableEvidence};
use crate::noise::tau_grid::TauGrid;
use crate::rate_table::blocks::{Blocks, Collector};
use crate::rate_table::inner_axis::InnerAxis;
use crate::rate_table::scale_factor::ScaleFactor;
use crate::rate_table::settling::Unsettled;
use crate::rate_table::{Setup, TableRun, stamps};
use crate::record::{ConditionRecord, OptionRecord};
use crate::recording::window::Windowed;
use crate::recording::{Channel, Role};

pub(super) fn execute(
    request: &Request<'_>,
    setup: &Setup,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Outcome, RunError> {
    let (found, run) = collect(request, setup, progress)?;
    let procedure = request.procedure;
    if !setup.known.is_empty() {
        return super::table_known::finish(request, setup, found, &run.blocks);
    }
    let evaluated = table_evidence::evaluate(procedure, &run, setup);
    let mut conditions = judge_and_log(&facts(request, &run, setup, &evaluated), &found.checks);
    if setup.known.is_empty() && wants_alignment(procedure) {
        // The input axis is square to the axis that is turned about: its output follows by the tilt only.
        conditions.retain(|c| c.id != "table_reached");
    }
    let scales = evaluated.iter().filter_map(|c| c.line.as_ref());
    conditions.extend(scales.filter_map(|c| judge_scale(&c.channel, c.factor)));
    if let Some(thermometer) = temperature(request, setup, &run) {
        found.checks.made("temperature_unit", Some(&thermometer.channel), "units");
        conditions.extend(judge_scale_of_temperature(&thermometer));
    }
    conditions.extend(usual_conditions(request, &found));
    let mut rows = Vec::new();
    for spec in &procedure.measurands {
        let asked = |c: &&TableEvidence<'_>| spec.channel.as_ref().is_none_or(|own| *own == c.channel);
        let estimates = evaluated.iter().filter(asked).flat_map(|c| spec.measurand.evaluate_steps(c));
        rows.extend(estimates.map(|e| verdict::row(&e, request.limits, procedure)));
    }
    let mut drawn = draw(request, &run, &evaluated);
    let shown = |id: &str| procedure.report.shows(id);
    if shown("dead_zone") {
        let several = evaluated.len() > 1;
        let zones = evaluated.iter().filter_map(|c| c.dead_zone.as_ref());
        drawn.extend(zones.map(|z| figures::dead_zone::figure(z, several)));
    }
    let mut record = settle::record(request, &found, conditions, rows, vec![], &drawn);
    record.table_steps = evaluated
        .iter()
        .filter_map(|c| Some(table_steps::records(&run, c.line.as_ref()?, c.gyro)))
        .flatten()
        .collect();
    let tables = vec![("table_steps.csv".to_owned(), table_steps::csv(&record.table_steps))];
    Ok(Outcome { record, figures: drawn, tables })
}

/// The thermometer of the test, where the procedure states no temperature that its readings are judged by.
fn temperature(request: &Request<'_>, setup: &Setup, run: &TableRun) -> Option<Thermometer> {
    let procedure = request.procedure;
    let is_it = |id: &str| setup.temperature.as_ref().is_none_or(|t| t == id);
    let spec =
        procedure.channels.iter().find(|c| c.channel.role == Role::Temperature && is_it(&c.channel.id))?;
    let id = &spec.channel.id;
    let readings = run.blocks.list.iter().map(|b| b.temperature).filter(|t| t.is_finite());
    let (sum, n) = readings.fold((0.0, 0.0), |(s, n), t| (s + t, n + 1.0));
    let stated = procedure.conditions.temperatures.iter().any(|c| c.channel == *id);
    (n > 0.0 && !stated).then(|| Thermometer {
        channel: id.clone(),
        unit: spec.unit_in_file.clone(),
        mean_deg_c: sum / n,
        counts: procedure.measures(measurand::SCALE_FACTOR_TEMPERATURE_SENSITIVITY.id, None),
    })
}

/// Rates of the other axis that differ.
fn outer_levels(run: &TableRun) -> usize {
    let mut rates: Vec<f64> = run.steps.list.iter().map(|s| s.outer).filter(|r| r.is_finite()).collect();
    rates.sort_by(f64::total_cmp);
    let largest = rates.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
    rates.dedup_by(|a, b| (*a - *b).abs() <= 1e-3 * largest);
    rates.len()
}

fn wants_alignment(procedure: &Procedure) -> bool {
    table_evidence::wants(procedure, Stimulus::OuterTurns)
}

/// The conditions that every test has.
pub(super) fn usual_conditions(request: &Request<'_>, found: &Found) -> Vec<ConditionRecord> {
    judge_all(&Facts {
        procedure: request.procedure,
        integrity: &found.report.integrity,
        rows: found.report.rows,
        sample_interval_s: found.tau0_s,
        clock_notes: &found.report.notes,
        has_stamps: request.use_stamps && found.channels.iter().any(|c| c.role == Role::Time),
        usable_s: found.window.usable_s,
        longest_gap_s: evaluate::longest_gap_s(&found.window),
        stability: &found.stability,
        warm_up: &[],
        gyros: &[],
        limits: request.limits,
        columns: &super::gyro_facts::columns(request.source, found),
        duration_s: found.report.duration_s,
        stated_serials: &request.source.stated_serials(),
        serial: request.unit.serial.as_deref(),
        today: request.now.date_naive(),
        schedule: None,
        checks: &found.checks,
    })
}

fn collect(
    request: &Request<'_>,
    setup: &Setup,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<(Found, TableRun), RunError> {
    let (found, blocks) = collect_blocks(request, progress, &|channels, nominal_s| {
        let blocks = Collector::new(channels, nominal_s, setup.temperature.as_deref());
        if setup.known.is_empty() { blocks } else { blocks.fine() }
    })?;
    Ok((found, TableRun::new(blocks, setup)))
}

/// Reads a recording into blocks, with what conditions are judged by.
pub(super) fn collect_blocks(
    request: &Request<'_>,
    progress: &mut dyn FnMut(u64, u64),
    collector: &dyn Fn(&[Channel], f64) -> Collector,
) -> Result<(Found, Blocks), RunError> {
    let procedure = request.procedure;
    let channels = reading::channels(procedure, request.source);
    let mut plan = reading::plan(request, &channels)?;
    let nominal_s = plan.clock().interval_s;
    let mut read = |plan: &Plan<'_>| -> Result<_, RunError> {
        let mut overview = Overview::new(procedure, &channels, tidy(nominal_s));
        let grid = TauGrid::Octave;
        let inside = Inside::new(procedure, &channels, &grid, &[], false, tidy(nominal_s), plan.start_s());
        let window = reading::window(procedure);
        let mut held = Windowed::new(inside.stability_only(), window.clone(), plan.start_s(), nominal_s);
        let mut blocks = Windowed::new(collector(&channels, nominal_s), window, plan.start_s(), nominal_s);
        let report = plan.stream(&mut [&mut overview, &mut held, &mut blocks], progress)?;
        Ok(((overview, held, blocks), report))
    };
    let ((overview, held, blocks), mut report) = reading::read_at_measured_interval(&mut plan, &mut read)?;
    let (held, mut window) = held.finish();
    reading::name_pauses(&mut window, &report);
    let (blocks, _) = blocks.finish();
    let tau0_s = tidy(report.tau0_measured_s);
    reading::settle_integrity(&mut report, &overview, tau0_s, &[]);
    let blocks = blocks.finish(report.tau0_measured_s);
    let found = Found {
        channels,
        report,
        tau0_s,
        window,
        gyros: vec![],
        stability: held.finish().stability,
        envelopes: overview.finish(),
        grid: TauGrid::Octave,
        exact: false,
        schedule: None,
        checks: CheckLog::default(),
    };
    Ok((found, blocks))
}

fn facts(
    request: &Request<'_>,
    run: &TableRun,
    setup: &Setup,
    evaluated: &[TableEvidence<'_>],
) -> TableFacts {
    let (procedure, steps) = (request.procedure, &run.steps);
    let inner = InnerAxis::of(&run.blocks);
    // Where the input axis is square to the axis that is turned about, that is the other one.
    let about_outer = wants_alignment(procedure);
    let rates = || steps.list.iter().map(|s| if about_outer { s.outer } else { s.rate });
    let worst = |f: fn(f64, f64) -> f64, start: f64| {
        let value = rates().fold(start, f);
        if value.is_finite() { value } else { 0.0 }
    };
    let disagreement = (run.blocks.has_angle && run.blocks.has_rate)
        .then(|| {
            let largest = steps
                .list
                .iter()
                .fold(0.0, |m: f64, s| m.max(s.rate.abs()))
                .max(steps.list.iter().fold(0.0, |m: f64, s| m.max(s.nominal.abs())));
            let counted = steps.list.iter().filter(|s| s.nominal.abs() > 0.05 * largest && s.nominal != 0.0);
            counted
                .map(|s| (s.rate / s.nominal - 1.0, s.nominal))
                .max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
        })
        .flatten();
    let disagreement = match inner.angle_per_rate {
        Some(factor) if about_outer => Some((factor - 1.0, inner.largest)),
        _ => disagreement,
    };
    let unsettled: Vec<&Unsettled> = steps.list.iter().filter_map(|s| s.unsettled.as_ref()).collect();
    TableFacts {
        time_factor: if about_outer { None } else { stamps::time_factor(run) },
        settling: Settling {
            steps: unsettled.len(),
            stated_s: setup.settling_s,
            needed_s: unsettled.iter().fold(0.0, |m: f64, u| m.max(u.needed_s)),
            off: unsettled.iter().fold(0.0, |m: f64, u| m.max((u.off / u.rate).abs())),
        },
        steps: steps.list.len(),
        too_short: steps.too_short,
        minimum_step_s: setup.minimum_step_s,
        lowest: worst(f64::min, f64::INFINITY),
        highest: worst(f64::max, f64::NEG_INFINITY),
        about_outer,
        levels: if about_outer { outer_levels(run) } else { steps.levels.len() },
        full_scale: setup.full_scale_deg_h,
        tolerance: setup.rate_tolerance,
        disagreement,
        inner_during_step: inner.during_step,
        channels: evaluated
            .iter()
            .filter_map(|c| {
                let along_outer = || inner.output_per_rate.get(c.gyro).copied().flatten();
                let by_steps = || c.line.as_ref().map(|l| (l.factor, l.factor_uncertainty()));
                let factor = if about_outer { along_outer() } else { by_steps() };
                channel_fact(request, &c.channel, c.line.as_ref(), factor)
            })
            .collect(),
    }
}

fn channel_fact(
    request: &Request<'_>,
    id: &str,
    channel: Option<&ScaleFactor>,
    factor: Option<(f64, f64)>,
) -> Option<ChannelFact> {
    let spec = request.procedure.channel(id)?;
    let earth = request.procedure.site.as_ref().map(|site| site.earth_rate_along(id).value);
    let at_rest = channel.zip(earth).map(|(c, earth)| (c.bias - c.factor * earth, earth));
    Some(ChannelFact {
        channel: id.to_owned(),
        asked: request.procedure.measurands.iter().any(|m| m.channel.as_deref().is_none_or(|c| c == id)),
        unit: spec.unit_in_file.clone(),
        factor: factor.map(|f| f.0),
        standard: factor.map_or(0.0, |f| f.1),
        bias_and_earth: at_rest,
        bias_limit: request
            .limits
            .limit(measurand::SCALE_FACTOR_BIAS.id, id)
            .and_then(|l| l.limit.largest_magnitude()),
    })
}

fn draw(request: &Request<'_>, run: &TableRun, evaluated: &[TableEvidence<'_>]) -> Vec<Figure> {
    let wanted = |id: &str| request.procedure.report.shows(id);
    let several = evaluated.len() > 1;
    let mut drawn = Vec::new();
    for channel in evaluated.iter().filter_map(|c| c.line.as_ref()) {
        if wanted("scale_factor_residual") {
            let limit = request
                .limits
                .limit(measurand::SCALE_FACTOR_NONLINEARITY.id, &channel.channel)
                .map(|l| &l.limit);
            drawn.push(figures::scale_factor::residuals(run, channel, limit, several));
        }
        if wanted("table_polar") {
            drawn.extend(figures::polar::figure(run, channel, several));
        }
        if wanted("table_steps") {
            drawn.push(figures::scale_factor::over_time(run, channel, several));
        }
    }
    drawn
}

/// The options that a table test was evaluated with.
pub(super) fn options(procedure: &Procedure, setup: &Setup, use_stamps: bool) -> Vec<OptionRecord> {
    let option = |name: &str, value: String| OptionRecord { name: name.to_owned(), value };
    let mut list = vec![
        option("rate_table.by_angle", setup.by_angle.to_string()),
        option("rate_table.whole_turns", setup.whole_turns.to_string()),
        option("rate_table.settling", format!("{} s", setup.settling_s)),
        option("rate_table.minimum_step", format!("{} s", setup.minimum_step_s)),
        option("conditions.warm_up", format!("{} s", procedure.conditions.warm_up_s)),
        option("recording.use_stamps", use_stamps.to_string()),
    ];
    if setup.rows_are_steps {
        list.insert(0, option("rate_table.rows_are_steps", setup.rows_are_steps.to_string()));
    }
    list
}
