//! The unit of a quantity that is given as it was recorded: the scale factor, and what changes per level of an influence.

use super::limit_set::LimitSpec;
use super::model::Procedure;
use crate::i18n::{Note, note};
use crate::measurand::{Measurand, PerLevel};
use crate::recording::Role;
use crate::units::Unit;

/// Unit of the scale factor of a channel, and its size at K = 1: counts per input where the file holds counts, and a pure
/// number where it holds rates or angles, or where the test is one of positions and turns.
pub fn scale_factor_unit(procedure: &Procedure, channel: &str) -> (&'static str, f64) {
    let steps = procedure.rate_table.as_ref().is_none_or(|setup| setup.known.is_empty());
    let Some(spec) = procedure.channel(channel).filter(|_| steps) else { return ("1", 1.0) };
    let counts = matches!(spec.unit_in_file.as_str(), "count" | "counts");
    let role = spec.channel.role;
    let Some(inside) = role.internal_unit().and_then(|u| Unit::parse(u).ok()) else {
        return ("1", 1.0);
    };
    match spec.channel.unit.factor_to(&inside) {
        Ok(factor) if counts && factor * spec.channel.scale != 0.0 => {
            let per_inside = 1.0 / (factor * spec.channel.scale);
            if role == Role::Rate { ("count/(deg/h)", per_inside) } else { ("count/arcsec", per_inside) }
        }
        _ => ("1", 1.0),
    }
}

/// Unit of a measurand in the result of a procedure.
pub fn unit_of_result(procedure: &Procedure, measurand: &Measurand, channel: &str) -> &'static str {
    match (measurand.unit, PerLevel::of(measurand)) {
        ("", Some(per)) => {
            let level = procedure.comparison_test.as_ref().and_then(|test| test.setting.unit);
            level.map_or("", |level| per.unit(level))
        }
        ("", None) => scale_factor_unit(procedure, channel).0,
        (unit, _) => unit,
    }
}

/// Note on a wrong unit of a limit on a rate given as recorded; `None` where it is that of its channels.
pub fn other_unit(procedure: &Procedure, limit: &LimitSpec) -> Option<Note> {
    let given = limit.recorded_unit?;
    let concerned = |id: &str| limit.channel.as_deref().is_none_or(|c| c == id);
    let mut channels = procedure.gyro_channels().map(|c| c.channel.id.as_str()).filter(|id| concerned(id));
    channels.find_map(|id| {
        let unit = unit_of_result(procedure, limit.measurand, id);
        (unit != given).then(|| {
            note!("check.limit_other_unit", measurand = limit.measurand.id, channel = id, unit, given)
        })
    })
}
