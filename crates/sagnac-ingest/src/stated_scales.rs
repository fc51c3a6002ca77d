//! Units and scales of columns that the header of a file states above its data.

use crate::column::Column;
use crate::column_inference::{InferredColumn, stem};
use crate::metadata::number_with_unit;
use sagnac_core::message::{Note, note};
use sagnac_core::recording::Role;
use sagnac_core::units::Unit;

/// Words of entries that give the size of a count.
const SCALE_WORDS: &[&str] = &[
    "scale",
    "scalefactor",
    "sensitivity",
    "resolution",
    "lsb",
    "gscale",
    "factor",
    "масштаб",
    "чувствительность",
    "цена",
    "коэффициент",
];
/// Words of entries that give a unit.
const UNIT_WORDS: &[&str] = &["unit", "units", "единица", "единицы", "размерность"];
/// Words of entries about a gyro.
const GYRO_WORDS: &[&str] =
    &["gyro", "gyroscope", "rate", "gyr", "angular", "fog", "гироскоп", "гироскопа", "вог", "скорость"];
/// Words of entries about other sensors.
const OTHER_SENSOR_WORDS: &[&str] =
    &["accel", "acc", "accelerometer", "mag", "magnetometer", "temperature", "temp", "pressure"];

/// Gives columns the units and scales that entries state; tells each.
pub(crate) fn apply(
    columns: &mut [Column],
    values: &[Vec<f64>],
    metadata: &[(String, String)],
    notes: &mut Vec<Note>,
) {
    let gyroflow = metadata.iter().any(|(_, value)| value.starts_with("GYROFLOW"));
    for (key, value) in metadata {
        let words = stem(key);
        let has = |list: &[&str]| words.iter().any(|w| list.contains(&w.as_str()));
        let stated = match () {
            () if gyroflow && key == "tscale" => scale(value, "s").map(|s| (Role::Time, s)),
            () if gyroflow && key == "gscale" => scale(value, "rad/s").map(|s| (Role::Rate, s)),
            () if has(OTHER_SENSOR_WORDS) => None,
            () if has(SCALE_WORDS) && has(GYRO_WORDS) => size_of_count(value),
            () if has(UNIT_WORDS) => unit(value, has(GYRO_WORDS) || words.len() == 1),
            () => None,
        };
        let Some((role, stated)) = stated else { continue };
        let mut taken = Vec::new();
        for (index, column) in columns.iter_mut().enumerate() {
            let guess = column.by_name();
            let of = values.get(index).map(Vec::as_slice).unwrap_or_default();
            if !takes(&guess, role, &stated, &column.name, of) {
                continue;
            }
            let reason = note!("guess.header", name = column.name.as_str(), key = key.as_str());
            column.judged = Some(InferredColumn {
                role,
                unit: stated.unit.clone(),
                scale: stated.scale,
                unit_is_named: true,
                reason,
            });
            taken.push(column.name.clone());
        }
        if !taken.is_empty() {
            notes.push(note!(
                "ingest.judged.header",
                key = key.as_str(),
                value = value.as_str(),
                columns = taken.join(", ")
            ));
        }
    }
}

/// A unit with the factor from the numbers in the file to it.
struct Stated {
    unit: Unit,
    scale: f64,
}

fn scale(value: &str, unit: &str) -> Option<Stated> {
    let (scale, _) = number_with_unit(value)?;
    let unit = Unit::parse(unit).ok()?;
    (scale.is_finite() && scale != 0.0).then_some(Stated { unit, scale })
}

/// The size of a count, as `0.0076 deg/s/LSB`, `131 LSB/(deg/s)` or `0.1 arcsec/pulse`.
fn size_of_count(value: &str) -> Option<(Role, Stated)> {
    let (number, unit) = number_with_unit(value)?;
    let unit = unit?;
    let usable = number.is_finite() && number != 0.0;
    for (role, inside) in [(Role::Rate, "deg/s"), (Role::AngleIncrement, "arcsec")] {
        let inside = Unit::parse(inside).ok()?;
        let factor = |text: String| unit.factor_to(&Unit::parse(&text).ok()?).ok();
        let per_count = factor(format!("({})/count", inside.text())).or_else(|| unit.factor_to(&inside).ok());
        let counts = || factor(format!("count/({})", inside.text()));
        let size = per_count.map(|f| number * f).or_else(|| counts().map(|f| 1.0 / (number * f)));
        if let Some(scale) = size.filter(|s| usable && s.is_normal()) {
            return Some((role, Stated { unit: inside, scale }));
        }
    }
    None
}

/// A unit of the rates, or of the times.
fn unit(value: &str, of_rates: bool) -> Option<(Role, Stated)> {
    let unit = Unit::parse(value).ok()?;
    let like = |text: &str| Unit::parse(text).is_ok_and(|u| u.same_dimension(&unit));
    match () {
        () if of_rates && like("deg/h") => Some((Role::Rate, Stated { unit, scale: 1.0 })),
        () if !of_rates && like("s") => Some((Role::Time, Stated { unit, scale: 1.0 })),
        () => None,
    }
}

/// True for a column whose own unit is not told, or that holds counts of a gyro, where the header states the size of one.
fn takes(guess: &InferredColumn, role: Role, stated: &Stated, name: &str, values: &[f64]) -> bool {
    if role == Role::Time {
        return guess.role == Role::Time && !guess.unit_is_named;
    }
    let is_count = Unit::parse("count").is_ok_and(|c| c.same_dimension(&guess.unit));
    let of_gyro = stem(name).iter().any(|w| GYRO_WORDS.contains(&w.as_str()));
    let whole = values.iter().all(|v| !v.is_finite() || v.fract() == 0.0);
    let counts = is_count && guess.unit_is_named && of_gyro;
    let unnamed = guess.role.is_gyro() && !guess.unit_is_named;
    if stated.scale == 1.0 { unnamed } else { counts || (unnamed && whole) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_of_counts_are_read_both_ways() {
        for (text, role, scale) in [
            ("131 LSB/(deg/s)", Role::Rate, 1.0 / 131.0),
            ("131 LSB/dps", Role::Rate, 1.0 / 131.0),
            ("0.0175 dps/LSB", Role::Rate, 0.0175),
            ("17.5 mdps/LSB", Role::Rate, 0.0175),
            ("0.5 arcsec/pulse", Role::AngleIncrement, 0.5),
        ] {
            let (found, stated) = size_of_count(text).unwrap();
            assert!(found == role && (stated.scale / scale - 1.0).abs() < 1e-9, "{text}: {}", stated.scale);
        }
        assert!(size_of_count("16384 LSB/g").is_none() && size_of_count("131").is_none());
    }
}
