//! Positions against the Earth's rotation, and turns by known angles.

use super::rate_table::table_options;
use super::stretch_facts::Stretches;
use crate::acceptance::condition::GyroFact;
use crate::acceptance::condition::positions::{EarthFact, judge_earth, judge_stretches};
use crate::acceptance::condition::table::judge_scale;
use crate::acceptance::figures;
use crate::acceptance::request::Request;
use crate::acceptance::test_kind::{Evidence, Progress, Reading, RestFacts, Run, TestKind, TestOption};
use crate::config::procedure::Procedure;
use crate::config::procedure::model::MeasurandSpec;
use crate::estimate::Estimate;
use crate::figure::Figure;
use crate::ingest::Pauses;
use crate::measurand::{KnownInputEvidence, SCALE_FACTOR_ERROR};
use crate::noise::static_bias::{Orientation, Uncertain, earth_rate};
use crate::rate_table::blocks::{Blocks, Collector};
use crate::rate_table::known::{self, Positions};
use crate::rate_table::setup::{Input, ReferenceInput, Setup};
use crate::rate_table::turns::{self, Turns};
use crate::record::ConditionRecord;
use crate::recording::Channel;

/// A test whose positions and turns the procedure states.
pub struct InPositions {
    setup: Setup,
}

/// What the recording shows.
pub struct PositionEvidence {
    setup: Setup,
    positions: Vec<Positions>,
    turns: Option<Turns>,
    /// The channels at rest in the positions.
    rest: Vec<GyroFact>,
    /// Stated stretches that the recording lacks.
    missing: usize,
}

impl TestKind for InPositions {
    type Collector = Collector;
    type Evidence = PositionEvidence;
    const OWN_CHECKS: &'static [&'static str] = &["earth_in_positions", "noise_level", "distribution"];
    const MISSING_REASON: &'static str = "unshown.few_positions";

    fn of(procedure: &Procedure) -> Option<InPositions> {
        let setup = procedure.rate_table.clone().filter(|s| !s.known.is_empty())?;
        Some(InPositions { setup })
    }

    fn options(&self, request: &Request<'_>) -> Vec<TestOption> {
        table_options(request.procedure, &self.setup)
    }

    fn pauses(&self) -> Pauses {
        Pauses { between_files: true, from_s: None }
    }

    fn collector(&self, _: &Request<'_>, channels: &[Channel], interval_s: f64) -> Run<Collector> {
        Ok(Collector::new(channels, interval_s, self.setup.temperature.as_deref()).fine())
    }

    fn evaluate(self, reading: &Reading<'_>, collected: Collector, _: Progress<'_>) -> Run<PositionEvidence> {
        let blocks = &collected.finish(reading.report.tau0_measured_s);
        let stated = &self.setup.known;
        let phases: Vec<(String, u64, u64)> =
            reading.file_spans().into_iter().filter_map(|f| Some((f.phase?, f.rows.0, f.rows.1))).collect();
        let stretches = known::stretches(blocks, stated, &phases);
        let site = reading.procedure().site.as_ref();
        let latitude = site.map_or((0.0, 0.0), |s| (s.latitude_deg, s.latitude_uncertainty_deg));
        let earth = |heading: (f64, f64), elevation: (f64, f64)| {
            let uncertain = |(value, uncertainty)| Uncertain { value, uncertainty };
            let rate = earth_rate(&Orientation {
                latitude_deg: uncertain(latitude),
                heading_deg: uncertain(heading),
                elevation_deg: uncertain(elevation),
            });
            (rate.value, rate.uncertainty)
        };
        let evaluate =
            |known: &[ReferenceInput], gyro: usize| known::positions(blocks, known, &stretches, gyro, &earth);
        let mut positions: Vec<Positions> =
            (0..blocks.gyros.len()).filter_map(|gyro| evaluate(stated, gyro)).collect();
        for p in positions.iter_mut().filter(|p| !p.follows()) {
            p.turned_instead = turned_instead(blocks, stated, &p.channel, &evaluate);
        }
        let mut found: Vec<usize> = stretches.iter().map(|s| s.known).collect();
        found.dedup();
        let missing = stated.len() - found.len();
        let turns = turns::turns(blocks, stated, &stretches);
        let rests = |k: usize| stated.get(k).is_some_and(|k| !matches!(k.input, Input::Turn { .. }));
        let spans = stretches.iter().filter(|s| rests(s.known)).map(|s| s.blocks).collect();
        let at_rest = Stretches { blocks, spans };
        let rest = positions.iter().filter_map(|p| at_rest.fact(reading, &p.channel, None)).collect();
        Ok(PositionEvidence { setup: self.setup, positions, turns, rest, missing })
    }
}

impl Evidence for PositionEvidence {
    fn conditions(&self, reading: &Reading<'_>) -> Vec<ConditionRecord> {
        let PositionEvidence { setup, positions, turns, missing, .. } = self;
        if positions.is_empty() {
            reading.checks.not_made("earth_in_positions", None, "check_list.no_positions");
        }
        for p in positions {
            reading.checks.made("earth_in_positions", Some(&p.channel), "known_earth");
        }
        let mut conditions = vec![judge_stretches(setup.known.len(), *missing)];
        let facts = positions.iter().map(|p| self.earth_fact(p, reading.request, positions.len() > 1));
        conditions.extend(facts.map(|fact| judge_earth(&fact)));
        // Along the axis or across; a factor that noise alone may make says nothing.
        let of_turns = turns.iter().flat_map(|t| &t.table).map(|t| (&t.output, t.factor));
        let mut named: Vec<&str> = vec![];
        for (channel, factor) in positions.iter().map(|p| (&p.channel, p.factor)).chain(of_turns) {
            let certain = (factor.value.abs() - 4.0 * factor.standard).max(0.0);
            if !named.contains(&channel.as_str())
                && let Some(impossible) =
                    judge_scale(channel, certain).and_then(|_| judge_scale(channel, factor.value))
            {
                named.push(channel);
                conditions.push(impossible);
            }
        }
        conditions
    }

    fn rest_facts(&self, reading: &Reading<'_>) -> RestFacts<'_> {
        RestFacts::of_gyros(reading, &self.rest)
    }

    fn estimates(&self, _: &Reading<'_>, spec: &MeasurandSpec) -> Vec<Estimate> {
        let (positions, turns) = (&self.positions, self.turns.as_ref());
        spec.measurand.evaluate_known_input(&KnownInputEvidence { positions, turns })
    }

    fn figures(&self, reading: &Reading<'_>) -> Vec<Figure> {
        let shown = reading.procedure().report.shows("positions");
        let positions = &self.positions;
        let figure = |p: &Positions| figures::positions::figure(p, positions.len() > 1);
        positions.iter().filter(|_| shown).map(figure).collect()
    }
}

impl PositionEvidence {
    /// What a channel makes of the Earth's rotation.
    fn earth_fact(&self, p: &Positions, request: &Request<'_>, several: bool) -> EarthFact {
        let procedure = request.procedure;
        let limited = |id: &str| request.limits.limit(id, &p.channel).is_some();
        let vertical = self.setup.known.iter().all(|k| match k.input {
            Input::Position { elevation, .. } => (elevation.0.abs() - 90.0).abs() < 1e-6,
            _ => true,
        });
        EarthFact {
            channel: p.channel.clone(),
            several,
            unit: procedure.channel(&p.channel).map_or_else(String::new, |c| c.unit_in_file.clone()),
            factor: p.factor.value,
            standard: p.factor.standard,
            limited: limited(SCALE_FACTOR_ERROR.id),
            judged: procedure.measurands.iter().any(|m| limited(m.measurand.id)),
            bias: p.bias.value,
            latitude_deg: procedure.site.as_ref().map(|s| s.latitude_deg).filter(|_| vertical),
            turned_instead: p.turned_instead.clone(),
            software: p.turned_in_software().iter().map(|(a, b)| (a.name.clone(), b.name.clone())).collect(),
        }
    }
}

/// The channel that shows the Earth's rotation in the positions stated for another one: that axis was turned in space,
/// and the other in software only.
fn turned_instead(
    blocks: &Blocks,
    stated: &[ReferenceInput],
    channel: &str,
    evaluate: &dyn Fn(&[ReferenceInput], usize) -> Option<Positions>,
) -> Option<(String, f64)> {
    let mut stated = stated.to_vec();
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
