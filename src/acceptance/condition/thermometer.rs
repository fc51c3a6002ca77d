//! Scale and sign of a thermometer by its readings alone, where no temperature is stated that would tell them.

pub use super::facts::Thermometer;

use super::facts::record;
use crate::config::procedure::Procedure;
use crate::i18n::{Arg, note};
use crate::measurand::SCALE_FACTOR_TEMPERATURE_SENSITIVITY;
use crate::record::{ConditionRecord, ConditionStatus};
use crate::temperature::StartAsked;
use crate::units::Unit;

/// Temperatures of rooms with tables in them, degC.
const ROOM_DEG_C: std::ops::RangeInclusive<f64> = 5.0..=45.0;

/// Temperatures of laboratories, degC: readings that are one of these on another scale, or with the other sign, are taken for it.
const LABORATORY_DEG_C: std::ops::RangeInclusive<f64> = 15.0..=35.0;

/// Temperatures that a unit is tested at, degC: beyond, the readings are none.
const UNIT_DEG_C: std::ops::RangeInclusive<f64> = -100.0..=200.0;

/// Units of temperatures.
const TEMPERATURE_UNITS: [&str; 3] = ["degC", "K", "degF"];

impl Thermometer {
    /// The thermometer of a channel; `None` where the procedure states a temperature or a course that its readings are judged by.
    pub fn unstated(procedure: &Procedure, channel: &str, mean_deg_c: f64) -> Option<Thermometer> {
        let held = procedure.conditions.temperatures.iter().any(|c| c.channel == channel);
        let start = procedure.warm_up_test.as_ref().map(|w| &w.start);
        let starts = matches!(start, Some(StartAsked::Temperature { channel: own, .. }) if own == channel);
        if held || starts || procedure.temperature_test.is_some() || !mean_deg_c.is_finite() {
            return None;
        }
        let of_table = procedure.rate_table.as_ref().and_then(|t| t.temperature.as_ref());
        let counts = procedure.measures(SCALE_FACTOR_TEMPERATURE_SENSITIVITY.id, None);
        Some(Thermometer {
            channel: channel.to_owned(),
            unit: procedure.channel(channel)?.unit_in_file.clone(),
            mean_deg_c,
            counts: counts && of_table.is_none_or(|own| own == channel),
        })
    }
}

/// Judges scale and sign of a thermometer: nothing where its readings are those of a room, or possible and on no scale and with
/// no sign those of a laboratory.
pub fn judge_scale_of_temperature(t: &Thermometer) -> Option<ConditionRecord> {
    let (inside, own) = (Unit::parse("degC").ok()?, Unit::parse(&t.unit).ok()?);
    if ROOM_DEG_C.contains(&t.mean_deg_c) {
        return None;
    }
    let as_read = inside.convert(t.mean_deg_c, &own).ok()?;
    let of_room = TEMPERATURE_UNITS.iter().filter(|u| **u != own.text()).find_map(|u| {
        let meant = Unit::parse(u).ok()?.convert(as_read, &inside).ok()?;
        LABORATORY_DEG_C.contains(&meant).then_some((*u, meant))
    });
    let note = match of_room {
        Some((unit, meant)) => {
            note!("units.thermometer", unit, meant = Arg::figures(meant, 3))
        }
        None if LABORATORY_DEG_C.contains(&-t.mean_deg_c) => {
            note!("units.thermometer_sign", meant = Arg::figures(-t.mean_deg_c, 3))
        }
        None if !UNIT_DEG_C.contains(&t.mean_deg_c) => note!("units.thermometer_impossible"),
        None => return None,
    };
    let note = note
        .with("channel", Arg::Text(t.channel.clone()))
        .with("value", Arg::figures(as_read, 4))
        .with("declared", t.unit.as_str());
    let status = if t.counts { ConditionStatus::Invalid } else { ConditionStatus::Remark };
    let required = note!("units.required", unit = t.unit.as_str());
    let observed = [("mean_deg_c", t.mean_deg_c)];
    Some(record(format!("units.{}", t.channel), status, &observed, Some(required), note))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(unit: &str, mean_deg_c: f64) -> Option<String> {
        let t = Thermometer { channel: "t".to_owned(), unit: unit.to_owned(), mean_deg_c, counts: true };
        judge_scale_of_temperature(&t).map(|r| r.note)
    }

    #[test]
    fn readings_of_a_room_on_another_scale_are_named() {
        assert_eq!(judged("degC", 21.0), None);
        assert_eq!(judged("degC", -40.0), None);
        assert!(judged("degC", 293.0).is_some() && judged("degC", 70.0).is_some());
        // 20 read as K and as degF.
        assert!(judged("K", -253.15).is_some() && judged("degF", -6.7).is_some());
        assert!(judged("degC", 500.0).is_some());
        // The sign of a laboratory at 24 degC was reversed; a chamber at −40 degC is none.
        assert!(judged("degC", -24.5).is_some_and(|note| note.contains("24.5")));
        assert_eq!(judged("degC", -12.0), None);
    }
}
