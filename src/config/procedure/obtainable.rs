//! What a procedure asks for and its own test can never give, known without data.

use super::model::{MeasurandSpec, Procedure};
use crate::i18n::Note;
use crate::measurand::{Measurand, Stimulus, Test, TurnAxis};
use crate::noise::static_bias::{Orientation, Uncertain, earth_rate};
use crate::rate_table::known;
use crate::rate_table::setup::{Input, ReferenceInput, Setup};
use crate::recording::Role;

/// Why a measurand can be shown for none of the channels it is asked for; `None` where it can be for one.
pub fn never(procedure: &Procedure, spec: &MeasurandSpec) -> Option<Note> {
    let channels: Vec<&str> = match &spec.channel {
        Some(own) => vec![own],
        None => procedure.gyro_channels().map(|c| c.channel.id.as_str()).collect(),
    };
    let mut reasons = channels.into_iter().map(|c| why_not(procedure, spec.measurand, c));
    let first = reasons.next()??;
    reasons.all(|r| r.is_some()).then_some(first)
}

/// Why a test on a table cannot show a measurand on a channel whatever is recorded; `None` where it can, or where that
/// is not known before the recording is read.
pub fn why_not(procedure: &Procedure, measurand: &Measurand, channel: &str) -> Option<Note> {
    let setup = procedure.rate_table.as_ref()?;
    if measurand.test() != Test::RateTable {
        return None;
    }
    let key = if setup.known.is_empty() {
        of_steps(procedure, setup, measurand)
    } else {
        of_known(procedure, setup, measurand, channel)
    };
    key.map(Note::new)
}

fn of_steps(procedure: &Procedure, setup: &Setup, measurand: &Measurand) -> Option<&'static str> {
    let has = |role: Role| procedure.channels.iter().any(|c| c.channel.role == role);
    let turned = has(Role::TableRate) || has(Role::TableAngle);
    match measurand.by_steps().map(|s| s.stimulus) {
        None => Some("unshown.needs_turns"),
        Some(Stimulus::OpenLoopRates) if !setup.sine => Some("unshown.needs_sine"),
        Some(Stimulus::OuterTurns) => {
            (!has(Role::OuterRate) || !has(Role::TableAngle)).then_some("unshown.needs_outer")
        }
        Some(Stimulus::SmallRates) => (!turned).then_some("unshown.needs_table_rates"),
        Some(Stimulus::Soaks) if !has(Role::Temperature) => Some("unshown.needs_soaks"),
        Some(Stimulus::Soaks | Stimulus::Rates | Stimulus::OpenLoopRates | Stimulus::Overload) => {
            (!turned).then_some("unshown.needs_table")
        }
    }
}

fn of_known(
    procedure: &Procedure,
    setup: &Setup,
    measurand: &Measurand,
    channel: &str,
) -> Option<&'static str> {
    let Some(input) = measurand.by_known_input() else { return Some("unshown.needs_steps") };
    let is_turn = |k: &&ReferenceInput| matches!(k.input, Input::Turn { .. });
    let turned = |own: bool| {
        setup
            .known
            .iter()
            .filter(is_turn)
            .any(|k| k.channel.as_deref().is_some_and(|c| (c == channel) == own))
    };
    let by_turns = input.turns.is_some_and(|axis| turned(axis == TurnAxis::Own));
    if by_turns || input.positions && earth_rates_differ(procedure, setup, channel) {
        return None;
    }
    Some(match input.turns {
        _ if input.positions => "unshown.few_positions",
        Some(TurnAxis::Own) => "unshown.needs_own_turn",
        Some(TurnAxis::Other) | None => "unshown.needs_turns",
    })
}

/// True when the Earth rate along a channel differs between the positions stated for it.
fn earth_rates_differ(procedure: &Procedure, setup: &Setup, channel: &str) -> bool {
    let Some(site) = &procedure.site else { return false };
    let uncertain = |(value, uncertainty)| Uncertain { value, uncertainty };
    let own = setup.known.iter().filter(|k| k.channel.as_deref().is_none_or(|c| c == channel));
    let rates = own.filter_map(|k| match k.input {
        Input::Position { heading, elevation } => Some(
            earth_rate(&Orientation {
                latitude_deg: uncertain((site.latitude_deg, site.latitude_uncertainty_deg)),
                heading_deg: uncertain(heading),
                elevation_deg: uncertain(elevation),
            })
            .value,
        ),
        _ => None,
    });
    let (low, high) = rates.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), r| (l.min(r), h.max(r)));
    high - low > known::LEAST_SPAN_DEG_H
}
