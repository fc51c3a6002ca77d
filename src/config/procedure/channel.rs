//! A declared channel: its unit and scale against its role.

use super::quantity;
use super::reader::Reader;
use super::recording_options;
use super::section::Section;
use super::tables::ChannelKeys;
use crate::i18n::note;
use crate::recording::{Channel, Role};
use crate::units::Unit;

/// Reads a channel; gives it with the unit of the file as written, or nothing when a problem was reported.
///
/// Counts become a physical unit here: `unit = "count"` with `scale = "0.01 arcsec/count"` is a channel in arcsec
/// with a factor of 0.01.
pub(crate) fn read(keys: &ChannelKeys, reader: &mut Reader<'_>) -> Option<(Channel, String)> {
    let section = &keys.section;
    let id = keys.id.clone()?;
    let column = recording_options::column(keys)?;
    let (role, unit) = (keys.role?, keys.unit.as_ref()?);
    let in_file = unit.text().to_owned();
    let (unit, size) = match &keys.scale {
        Some(scale) => scaled(scale, unit, role, section, reader)?,
        None => (unit.clone(), 1.0),
    };
    suits(&unit, &in_file, role, section, reader)?;
    let scale = if keys.reversed { -size } else { size };
    if role == Role::Time && scale < 0.0 {
        reader.error(&section.span_of("reversed"), "check.time_backwards", None);
        return None;
    }
    Some((Channel { id, column, role, unit, scale }, in_file))
}

/// The unit of `scale × unit of the file`, with the number of the scale.
fn scaled(
    scale: &str,
    in_file: &Unit,
    role: Role,
    section: &Section,
    reader: &mut Reader<'_>,
) -> Option<(Unit, f64)> {
    let at = section.span_of("scale");
    let (value, unit_text) = match quantity::split(scale) {
        Ok(parts) => parts,
        Err(e) => {
            reader.error(&at, e.message, Some("check.help.scale".into()));
            return None;
        }
    };
    if value == 0.0 {
        reader.error(&at, "check.scale_zero", None);
        return None;
    }
    if unit_text.is_empty() {
        return Some((in_file.clone(), value));
    }
    if let Err(e) = Unit::parse(unit_text) {
        reader.error(&at, e.note(), Some("check.help.scale".into()));
        return None;
    }
    let product = Unit::parse(&format!("({unit_text})*({})", in_file.text())).ok()?;
    // The plain unit of the role reads better in results than a product of two.
    match plain_unit(role).and_then(|u| Some((product.factor_to(&u).ok()?, u))) {
        Some((factor, plain)) => Some((plain, value * factor)),
        None => Some((product, value)),
    }
}

/// The period after which a channel starts again: s of stamps, counts of a counter, arcsec of an accumulated angle.
pub(super) fn rollover(keys: &ChannelKeys, role: Role, reader: &mut Reader<'_>) -> Option<f64> {
    let text = keys.rollover.as_ref()?;
    let at = keys.section.span_of("rollover");
    let unit = match role {
        Role::Time => "s",
        Role::Counter => "count",
        Role::AccumulatedAngle => "arcsec",
        other => {
            let note = note!("time_base.rollover_role", role = other.id());
            reader.error(&at, note, None);
            return None;
        }
    };
    let example = match role {
        Role::Counter => "rollover = \"256 count\"",
        Role::AccumulatedAngle => "rollover = \"360 deg\"",
        _ => "rollover = \"86400 s\"",
    };
    let example = || note!("keyed.help.example", example);
    match quantity::parse(text, unit, true, false) {
        Ok(period) if period > 0.0 => Some(period),
        Ok(_) => {
            reader.error(&at, "time_base.rollover_positive", Some(example()));
            None
        }
        Err(e) => {
            reader.error(&at, e.message, Some(example()));
            None
        }
    }
}

fn plain_unit(role: Role) -> Option<Unit> {
    role.internal_unit().and_then(|u| Unit::parse(u).ok())
}

/// Reports a unit that does not suit the role.
fn suits(unit: &Unit, in_file: &str, role: Role, section: &Section, reader: &mut Reader<'_>) -> Option<()> {
    let Some(wanted) = plain_unit(role) else { return Some(()) };
    if unit.same_dimension(&wanted) {
        return Some(());
    }
    let scaled = section.entry("scale").is_some();
    let at = section.span_of(if scaled { "scale" } else { "unit" });
    let counts = Unit::parse("count").is_ok_and(|c| c.same_dimension(unit));
    let message = if scaled { note!("check.scale_and_role") } else { note!("check.unit_and_role") };
    let message = message
        .with("unit", in_file)
        .with("given", unit.describe())
        .with("role", role.id())
        .with("wanted", wanted.describe());
    let help = if scaled {
        note!("check.help.product", unit = wanted.text())
    } else if counts {
        note!("check.help.count", unit = wanted.text())
    } else if role == Role::Rate && Unit::parse("arcsec").is_ok_and(|u| u.same_dimension(unit)) {
        note!("check.help.angles")
    } else if role == Role::AngleIncrement && Unit::parse("deg/h").is_ok_and(|u| u.same_dimension(unit)) {
        note!("check.help.rates")
    } else {
        note!("check.help.unit", unit = wanted.text())
    };
    reader.error(&at, message, Some(help));
    None
}
