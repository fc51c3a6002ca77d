//! What a procedure asks for and its own test can never give, known without data.

use super::model::{MeasurandSpec, Procedure};
use crate::i18n::Note;
use crate::ids::Test;
use crate::noise::static_bias::{Orientation, Uncertain, earth_rate};
use crate::rate_table::Setup;
use crate::rate_table::known::{self, Input, Positions};
use crate::rate_table::{alignment, dead_zone};
use crate::recording::Role;

/// Why a measurand can be shown for none of the channels it is asked for; `None` where it can be for one.
pub fn never(procedure: &Procedure, spec: &MeasurandSpec) -> Option<Note> {
    let channels: Vec<&str> = match &spec.channel {
        Some(own) => vec![own],
        None => procedure.gyro_channels().map(|c| c.channel.id.as_str()).collect(),
    };
    let mut reasons = channels.into_iter().map(|c| why_not(procedure, spec.id.id, c));
    let first = reasons.next()??;
    reasons.all(|r| r.is_some()).then_some(first)
}

/// Why a test on a table cannot show a measurand on a channel whatever is recorded; `None` where it can, or where that
/// is not known before the recording is read.
pub fn why_not(procedure: &Procedure, id: &str, channel: &str) -> Option<Note> {
    let setup = procedure.rate_table.as_ref()?;
    if crate::ids::find(id).is_none_or(|m| m.test != Test::RateTable) {
        return None;
    }
    let key = if setup.known.is_empty() {
        of_steps(procedure, setup, id)
    } else {
        of_known(procedure, setup, id, channel)
    };
    key.map(Note::new)
}

fn of_steps(procedure: &Procedure, setup: &Setup, id: &str) -> Option<&'static str> {
    let has = |role: Role| procedure.channels.iter().any(|c| c.channel.role == role);
    if id == "cross_axis" {
        return Some("unshown.needs_turns");
    }
    if id == "sine_response" && !setup.sine {
        return Some("unshown.needs_sine");
    }
    if alignment::IDS.contains(&id) {
        return (!has(Role::OuterRate) || !has(Role::TableAngle)).then_some("unshown.needs_outer");
    }
    let turned = has(Role::TableRate) || has(Role::TableAngle);
    (!turned).then_some(if dead_zone::IDS.contains(&id) {
        "unshown.needs_table_rates"
    } else {
        "unshown.needs_table"
    })
}

fn of_known(procedure: &Procedure, setup: &Setup, id: &str, channel: &str) -> Option<&'static str> {
    let is_turn = |k: &&known::Known| matches!(k.input, Input::Turn { .. });
    let turned = |own: bool| {
        setup
            .known
            .iter()
            .filter(is_turn)
            .any(|k| k.channel.as_deref().is_some_and(|c| (c == channel) == own))
    };
    let by_turns = match id {
        "scale_factor" | "scale_factor_error" => turned(true),
        "cross_axis" => turned(false),
        _ => false,
    };
    let by_positions = Positions::IDS.contains(&id);
    if by_turns || by_positions && earth_rates_differ(procedure, setup, channel) {
        return None;
    }
    Some(match id {
        "cross_axis" => "unshown.needs_turns",
        "scale_factor" => "unshown.needs_own_turn",
        _ if by_positions => "unshown.few_positions",
        _ => "unshown.needs_steps",
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
