//! Positions against the Earth's rotation and turns by known angles: rows and conditions.

use super::evaluate::Found;
use super::{Outcome, Request, RunError, settle, table, verdict};
use crate::acceptance::condition::positions::{EarthFact, judge_earth};
use crate::acceptance::condition::table::judge_scale;
use crate::measurand::KnownInputEvidence;
use crate::noise::static_bias::{Orientation, Uncertain, earth_rate};
use crate::rate_table::blocks::Blocks;
use crate::rate_table::known::{self, Positions};
use crate::rate_table::setup::{Input, Known, Setup};
use crate::rate_table::turns;

pub(super) fn finish(
    request: &Request<'_>,
    setup: &Setup,
    found: Found,
    blocks: &Blocks,
) -> Result<Outcome, RunError> {
    let procedure = request.procedure;
    let phases: Vec<(String, u64, u64)> = found
        .report
        .files
        .iter()
        .filter_map(|f| Some((f.phase.clone()?, f.rows_before + 1, f.rows_before + f.facts.rows)))
        .collect();
    let stretches = known::stretches(blocks, &setup.known, &phases);
    let latitude = procedure.site.as_ref().map(|s| (s.latitude_deg, s.latitude_uncertainty_deg));
    let earth = |heading: (f64, f64), elevation: (f64, f64)| {
        let uncertain = |(value, uncertainty)| Uncertain { value, uncertainty };
        let rate = earth_rate(&Orientation {
            latitude_deg: uncertain(latitude.unwrap_or((0.0, 0.0))),
            heading_deg: uncertain(heading),
            elevation_deg: uncertain(elevation),
        });
        (rate.value, rate.uncertainty)
    };
    let mut positions: Vec<Positions> = (0..blocks.gyros.len())
        .filter_map(|gyro| known::positions(blocks, &setup.known, &stretches, gyro, &earth))
        .collect();
    for p in positions.iter_mut().filter(|p| !p.follows()) {
        p.turned_instead = turned_instead(blocks, setup, &p.channel, &|known, gyro| {
            known::positions(blocks, known, &stretches, gyro, &earth)
        });
    }
    if positions.is_empty() {
        found.checks.not_made("earth_in_positions", None, "check_list.no_positions");
    }
    for p in &positions {
        found.checks.made("earth_in_positions", Some(&p.channel), "known_earth");
    }
    let turns = turns::turns(blocks, &setup.known, &stretches);
    let vertical = setup.known.iter().all(|k| match k.input {
        Input::Position { elevation, .. } => (elevation.0.abs() - 90.0).abs() < 1e-6,
        _ => true,
    });
    let mut conditions: Vec<_> = positions
        .iter()
        .map(|p| {
            judge_earth(&EarthFact {
                channel: p.channel.clone(),
                several: positions.len() > 1,
                unit: procedure.channel(&p.channel).map_or_else(String::new, |c| c.unit_in_file.clone()),
                factor: p.factor.value,
                standard: p.factor.standard,
                bias: p.bias.value,
                latitude_deg: latitude.map(|l| l.0).filter(|_| vertical),
                turned_instead: p.turned_instead.clone(),
                software: p
                    .turned_in_software()
                    .iter()
                    .map(|(a, b)| (a.name.clone(), b.name.clone()))
                    .collect(),
            })
        })
        .collect();
    let missing = setup.known.len() - {
        let mut seen: Vec<usize> = stretches.iter().map(|s| s.known).collect();
        seen.dedup();
        seen.len()
    };
    conditions
        .insert(0, crate::acceptance::condition::positions::judge_stretches(setup.known.len(), missing));
    // Along the axis or across; a factor that noise alone may make says nothing.
    let of_turns = turns.iter().flat_map(|t| &t.table).map(|t| (&t.output, t.factor));
    let mut named: Vec<&str> = vec![];
    for (channel, factor) in positions.iter().map(|p| (&p.channel, p.factor)).chain(of_turns) {
        let certain = (factor.value.abs() - 4.0 * factor.standard).max(0.0);
        if !named.contains(&channel.as_str())
            && let Some(found) =
                judge_scale(channel, certain).and_then(|_| judge_scale(channel, factor.value))
        {
            named.push(channel);
            conditions.push(found);
        }
    }
    conditions.extend(table::usual_conditions(request, &found));
    let evidence = KnownInputEvidence { positions: &positions, turns: turns.as_ref() };
    let mut rows = Vec::new();
    for spec in &procedure.measurands {
        let asked = |channel: &str| spec.channel.as_ref().is_none_or(|c| c == channel);
        for estimate in spec.measurand.evaluate_known_input(&evidence) {
            if asked(estimate.channel.split("<-").next().unwrap_or_default()) {
                rows.push(verdict::row(&estimate, request.limits, procedure));
            }
        }
    }
    let shown = request.procedure.report.shows("positions");
    let drawn: Vec<_> = positions
        .iter()
        .filter(|_| shown)
        .map(|p| super::figures::positions::figure(p, positions.len() > 1))
        .collect();
    let record = settle::record(request, &found, conditions, rows, vec![], &drawn);
    Ok(Outcome { record, figures: drawn, tables: vec![] })
}

/// The channel that shows the Earth's rotation in the positions stated for another one: that axis was turned in space,
/// and the other in software only.
fn turned_instead(
    blocks: &Blocks,
    setup: &Setup,
    channel: &str,
    evaluate: &dyn Fn(&[Known], usize) -> Option<Positions>,
) -> Option<(String, f64)> {
    let mut stated = setup.known.clone();
    for k in stated.iter_mut().filter(|k| matches!(k.input, Input::Position { .. })) {
        // Stretches go by their place in the list: what is stated for other channels stays in it and does not count.
        if k.channel.as_deref().is_some_and(|c| c != channel) {
            k.input = Input::Rest;
        }
        k.channel = None;
    }
    (0..blocks.gyros.len())
        .filter(|gyro| blocks.gyros[*gyro] != channel)
        .filter_map(|gyro| evaluate(&stated, gyro))
        .find(Positions::plainly_follows)
        .map(|p| (p.channel, p.factor.value))
}
