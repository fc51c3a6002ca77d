//! Units: that of a column's name against the declared one, and that of a temperature by its values.

use super::facts::{Condition, Facts, record};
use super::stability_track::StabilityKey;
use super::thermometer::judge_scale_of_temperature;
use crate::config::procedure::model::TemperatureCondition;
use crate::i18n::{Arg, Note, note};
use crate::record::{ConditionRecord, ConditionStatus};
use crate::recording::column_inference;
use crate::units::{Affine, Unit};

pub(super) struct Units;

impl Condition for Units {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let mut records: Vec<ConditionRecord> =
            facts.procedure.channels.iter().filter_map(|c| named(c, facts)).collect();
        let temperatures = facts.procedure.conditions.temperatures.iter().enumerate();
        if facts.procedure.conditions.temperatures.is_empty() && facts.thermometers.is_empty() {
            facts.checks.not_made("temperature_unit", None, "check_list.no_nominal_temperature");
        }
        records.extend(temperatures.filter_map(|(position, c)| by_value(position, c, facts)));
        for thermometer in facts.thermometers {
            facts.checks.made("temperature_unit", Some(&thermometer.channel), "units");
            records.extend(judge_scale_of_temperature(thermometer));
        }
        records
    }
}

fn invalid(channel: &str, declared: &str, note: Note) -> ConditionRecord {
    let required = note!("units.required", unit = declared);
    record(format!("units.{channel}"), ConditionStatus::Invalid, &[], Some(required), note)
}

/// The name or the format of a column states another unit than the procedure.
fn named(spec: &crate::config::procedure::model::ChannelSpec, facts: &Facts<'_>) -> Option<ConditionRecord> {
    let column = facts.columns.iter().find(|c| c.channel == spec.channel.id)?;
    let declared = Unit::parse(&spec.unit_in_file).ok()?;
    let stated = column_inference::named_unit(&column.name, column.unit.as_deref());
    match &stated {
        Some(_) => facts.checks.made("column_units", Some(&spec.channel.id), "units"),
        None => facts.checks.not_made("column_units", Some(&spec.channel.id), "check_list.no_unit_in_column"),
    }
    let stated = stated?;
    // A scale that is no mere sign is a conversion that somebody meant.
    if !stated.same_dimension(&declared) || spec.channel.scale.abs() != 1.0 {
        return None;
    }
    let Affine { factor, offset } = stated.affine_to(&declared).ok()?;
    if (factor - 1.0).abs() < 1e-9 && offset.abs() < 1e-9 {
        return None;
    }
    let note = note!(
        "units.contradict",
        column = format!("`{}`", column.name),
        stated = stated.text(),
        declared = declared.text(),
        channel = spec.channel.id.clone()
    );
    Some(invalid(&spec.channel.id, declared.text(), note))
}

/// A temperature far from nominal that is near it in another unit.
fn by_value(position: usize, c: &TemperatureCondition, facts: &Facts<'_>) -> Option<ConditionRecord> {
    let track = facts.stability.get(&StabilityKey::temperature(position));
    match track {
        Some(_) => facts.checks.made("temperature_unit", Some(&c.channel), "units"),
        None => facts.checks.not_made("temperature_unit", Some(&c.channel), "check_list.no_temperature"),
    }
    let track = track?;
    if (track.mean - c.nominal_deg_c).abs() <= 10.0 * c.tolerance_deg_c {
        return None;
    }
    let declared = &facts.procedure.channel(&c.channel)?.unit_in_file;
    let (inside, own) = (Unit::parse("degC").ok()?, Unit::parse(declared).ok()?);
    let as_read = inside.convert(track.mean, &own).ok()?;
    let near = |unit: &str| {
        let meant = Unit::parse(unit).and_then(|u| u.convert(as_read, &inside));
        unit != own.text()
            && meant.is_ok_and(|v| (v - c.nominal_deg_c).abs() <= (5.0 * c.tolerance_deg_c).max(2.0))
    };
    let unit = ["degF", "K", "degC"].into_iter().find(|u| near(u))?;
    let meant = Unit::parse(unit).and_then(|u| u.convert(as_read, &inside)).ok()?;
    let note = note!(
        "units.temperature",
        channel = c.channel.clone(),
        value = as_read,
        declared = declared.as_str(),
        unit,
        meant,
        nominal = Arg::Stated(c.nominal_deg_c)
    );
    Some(invalid(&c.channel, declared, note))
}
