//! A procedure with a series of switching off and on, or with a comparison without and with an influence, applied to a
//! recording: one pass into blocks, then stretches, means, rows, figures.

use super::evaluate::Found;
use super::influence_noise;
use super::{
    Outcome, Request, RunError, drawn, figures, influence_acted, interval_means, settle, table, verdict,
};
use crate::acceptance::condition::influence::{ComparedFacts, RunFacts, judge_compared, judge_runs};
use crate::config::procedure::Procedure;
use crate::estimate::Estimate;
use crate::figure::Figure;
use crate::influence::comparison::{self, Beside, Comparison};
use crate::influence::cut::FileSpan;
use crate::influence::intervals;
use crate::influence::nuisance::{Following, Nuisance};
use crate::influence::repeatability::{self, Repeatability};
use crate::influence::{ComparisonTest, RepeatabilityTest, runs};
use crate::measurand::{ANGLE_RANDOM_WALK_SHIFT, ComparisonEvidence, Measurand};
use crate::rate_table::blocks::Collector;
use crate::record::{ConditionRecord, Evidence, IntervalMeanRecord, OptionRecord};
use crate::recording::{Channel, Role};
use std::collections::BTreeMap;

/// The files of a recording with their rows.
fn files(found: &Found) -> Vec<FileSpan> {
    let of = |f: &crate::ingest::FileReport| FileSpan {
        name: f.path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned()),
        phase: f.phase.clone(),
        rows: (f.rows_before + 1, f.rows_before + f.facts.rows),
    };
    found.report.files.iter().map(of).collect()
}

/// Earth rate along a channel, deg/h; 0 without a site.
fn earth(procedure: &Procedure, channel: &str) -> f64 {
    procedure.site.as_ref().map_or(0.0, |site| site.earth_rate_along(channel).value)
}

/// Rows of the measurands in the order of the procedure.
fn rows(
    request: &Request<'_>,
    channels: &[String],
    of: &dyn Fn(usize, &Measurand) -> Vec<Estimate>,
) -> Vec<crate::record::MeasurandRecord> {
    let mut rows = Vec::new();
    for spec in &request.procedure.measurands {
        for (at, channel) in channels.iter().enumerate() {
            if spec.channel.as_ref().is_some_and(|c| c != channel) {
                continue;
            }
            let estimates = of(at, spec.measurand);
            rows.extend(estimates.iter().map(|e| verdict::row(e, request.limits, request.procedure)));
        }
    }
    rows
}

fn wanted(request: &Request<'_>, id: &str) -> bool {
    request.procedure.report.shows(id)
}

fn finish(
    request: &Request<'_>,
    found: &Found,
    mut conditions: Vec<ConditionRecord>,
    rows: Vec<crate::record::MeasurandRecord>,
    drawn: Vec<Figure>,
    means: Vec<IntervalMeanRecord>,
) -> Outcome {
    conditions.extend(table::usual_conditions(request, found));
    let mut drawn = drawn;
    drawn.extend(drawn::over_time(request, found));
    let tables = vec![("interval_means.csv".to_owned(), interval_means::csv(&means))];
    let mut record = settle::record(request, found, conditions, rows, vec![], &drawn);
    record.interval_means = means;
    Outcome { record, figures: drawn, tables }
}

/// A series of switching off and on.
pub(super) fn repeatability(
    request: &Request<'_>,
    test: &RepeatabilityTest,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Outcome, RunError> {
    let (found, blocks) = table::collect_blocks(request, progress, &|channels, nominal_s| {
        Collector::new(channels, nominal_s, test.temperature.as_deref())
    })?;
    let series = runs::find(&blocks, test, &files(&found));
    let procedure = request.procedure;
    let evaluated: Vec<Repeatability> = (0..blocks.gyros.len())
        .filter_map(|g| repeatability::evaluate(&blocks, &series, g, earth(procedure, &blocks.gyros[g])))
        .collect();
    let channels: Vec<String> = evaluated.iter().map(|e| e.channel.clone()).collect();
    let rows = rows(request, &channels, &|at, measurand| measurand.evaluate_runs(&evaluated[at]));
    let conditions = vec![judge_runs(&RunFacts {
        found: series.list.len(),
        fewest: test.fewest,
        too_short: series.too_short,
        minimum_run_s: test.minimum_run_s,
        // A time without output in one file is what switching off leaves; that files or stated times are runs is declared.
        evidence: match test.runs.is_empty() && found.report.files.len() < 2 {
            true => Evidence::Inferred,
            false => Evidence::Declared,
        },
    })];
    let several = evaluated.len() > 1;
    let drawn = if wanted(request, "bias_of_runs") {
        evaluated.iter().map(|e| figures::bias_of_runs::figure(e, several)).collect()
    } else {
        vec![]
    };
    let means = evaluated.iter().flat_map(interval_means::of_runs).collect();
    Ok(finish(request, &found, conditions, rows, drawn, means))
}

/// True for a channel whose quantity may change the bias beside the influence. The temperature of the unit is judged by itself.
fn may_disturb(c: &Channel, test: &ComparisonTest) -> bool {
    let role = matches!(
        c.role,
        Role::Temperature
            | Role::Supply
            | Role::MagneticField
            | Role::Vibration
            | Role::TableRate
            | Role::OuterRate
    );
    role && c.role != test.influence.role()
}

/// What was recorded beside output and level, whose channels come first beside the blocks.
fn beside(channels: &[Channel], test: &ComparisonTest, levels: usize) -> Beside {
    let nuisance = |c: &Channel| Nuisance {
        channel: c.id.clone(),
        unit: c.role.internal_unit().unwrap_or("1"),
        temperature: c.role == Role::Temperature,
    };
    let others: Vec<&Channel> = channels.iter().filter(|c| may_disturb(c, test)).collect();
    let warm = || others.iter().filter(|c| c.role == Role::Temperature);
    let own = warm().find(|c| Some(&c.id) == test.temperature.as_ref()).or_else(|| warm().next());
    Beside {
        temperature: own.map(|c| nuisance(c)),
        others: others
            .iter()
            .enumerate()
            .filter(|(_, c)| own.is_none_or(|o| o.id != c.id))
            .map(|(at, c)| (levels + at, nuisance(c)))
            .collect(),
    }
}

/// The quantities beside, each from the gyro channel whose intervals show it most.
fn most_disturbing(evaluated: &[Comparison]) -> Vec<&Following> {
    let mut most: Vec<&Following> = vec![];
    for found in evaluated.iter().flat_map(|e| &e.others) {
        match most.iter_mut().find(|m| m.what.channel == found.what.channel) {
            Some(known) if found.by_chance < known.by_chance => *known = found,
            Some(_) => {}
            None => most.push(found),
        }
    }
    most
}

/// A comparison without and with an influence.
pub(super) fn comparison(
    request: &Request<'_>,
    test: &ComparisonTest,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Outcome, RunError> {
    let level = |c: &Channel| c.role == test.influence.role();
    let (found, blocks) = table::collect_blocks(request, progress, &|channels, nominal_s| {
        let slots = |of: &dyn Fn(&Channel) -> bool| {
            channels.iter().enumerate().filter(|(_, c)| of(c)).map(|(slot, _)| slot).collect::<Vec<usize>>()
        };
        // The channels of the level come first.
        let mut kept = slots(&level);
        kept.extend(slots(&|c| may_disturb(c, test)));
        Collector::new(channels, nominal_s, test.temperature.as_deref()).beside(kept)
    })?;
    let axes: Vec<String> = found.channels.iter().filter(|c| level(c)).map(|c| c.id.clone()).collect();
    let series = intervals::find(&blocks, test, &axes, &files(&found));
    let beside = beside(&found.channels, test, axes.len());
    let evaluated: Vec<Comparison> = (0..blocks.gyros.len())
        .filter_map(|g| comparison::evaluate(&blocks, &series, test, &beside, g))
        .collect();
    let acted = influence_acted::find(request, test, &found, &blocks, &series, &axes, progress)?;
    let procedure = request.procedure;
    let noise = if procedure.measures(ANGLE_RANDOM_WALK_SHIFT.id, None) {
        influence_noise::find(request, &found, &blocks, &series, progress)?
    } else {
        BTreeMap::new()
    };
    let channels: Vec<String> = evaluated.iter().map(|e| e.channel.clone()).collect();
    let rows = rows(request, &channels, &|at, measurand| {
        let noise = noise.get(&channels[at]).map_or(&[][..], Vec::as_slice);
        let estimates = measurand.evaluate_comparison(&ComparisonEvidence { bias: &evaluated[at], noise });
        estimates.into_iter().map(|e| acted.remark().into_iter().fold(e, Estimate::note)).collect()
    });
    match evaluated.iter().find_map(|e| e.temperature.as_ref()) {
        Some(_) => found.checks.made("temperature_in_step", None, "influence_temperature"),
        None => found.checks.not_made("temperature_in_step", None, "check_list.no_temperature"),
    }
    let conditions = judge_compared(&ComparedFacts {
        found: series.list.len(),
        with: series.with(),
        alternations: series.alternations(),
        asked: test.alternations,
        too_short: series.too_short,
        missing: series.missing,
        minimum_interval_s: test.minimum_interval_s,
        recorded: test.intervals.is_empty(),
        level_unit: test.influence.unit(),
        table: test.influence.table(),
        acted,
        temperature: evaluated.iter().find_map(|e| e.temperature.as_ref()),
        others: most_disturbing(&evaluated),
        allowed_deg_c: test.temperature_difference_deg_c,
        line: evaluated.iter().filter_map(|e| e.line).reduce(f64::min),
        squared: test.influence.degree() > 1.0,
    });
    let several = evaluated.len() > 1;
    let drawn = if wanted(request, "influence") {
        evaluated.iter().map(|e| figures::influence::figure(e, several)).collect()
    } else {
        vec![]
    };
    let means = evaluated.iter().flat_map(|e| interval_means::of_intervals(e, acted.evidence())).collect();
    Ok(finish(request, &found, conditions, rows, drawn, means))
}

/// The options of such a test; none of any other.
pub(super) fn options(procedure: &Procedure) -> Vec<OptionRecord> {
    let option = |name: &str, value: String| OptionRecord { name: name.to_owned(), value };
    if let Some(t) = &procedure.repeatability_test {
        return vec![
            option("influence.settling", format!("{} s", t.settling_s)),
            option("influence.minimum", format!("{} s", t.minimum_run_s)),
            option("influence.off", format!("{} s", t.off_s)),
        ];
    }
    let Some(t) = &procedure.comparison_test else { return vec![] };
    vec![
        option("influence.settling", format!("{} s", t.settling_s)),
        option("influence.minimum", format!("{} s", t.minimum_interval_s)),
        option("influence.reference", t.reference.to_string()),
    ]
}
