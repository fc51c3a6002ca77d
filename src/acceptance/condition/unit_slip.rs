//! UnitSlips of unit and of decimal mark, by the factor that they put on the values.

use crate::i18n::{Note, note};
use crate::units::Unit;

/// A wrong unit or a misplaced decimal mark.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct UnitSlip {
    /// Factor from the value as read to the value that was meant.
    pub factor: f64,
    /// Whether it is an exchange of the units that rates are mostly written in.
    pub usual: bool,
    /// What went wrong.
    pub note: Note,
}

/// Units that outputs of gyros are written in.
const RATE_UNITS: &[&str] = &[
    "deg/s", "deg/h", "rad/s", "mrad/s", "urad/s", "nrad/s", "deg/min", "rad/h", "mdeg/s", "mdeg/h",
    "arcsec/h", "arcmin/h", "deg", "rad", "mrad", "urad", "mdeg", "arcsec", "arcmin", "marcsec",
];

/// Units that rates are mostly written in.
const COMMON_RATE_UNITS: [&str; 3] = ["deg/s", "deg/h", "rad/s"];

/// The slips that a channel declared in a unit can have.
pub(super) fn rate_factors(declared: &str) -> Vec<UnitSlip> {
    let mut list: Vec<UnitSlip> = Vec::new();
    let Ok(own) = Unit::parse(declared) else { return list };
    let mut add = |factor: f64, usual: bool, note: Note| {
        let known = |m: &UnitSlip| (m.factor / factor - 1.0).abs() < 1e-4;
        if factor.is_finite() && (factor - 1.0).abs() > 1e-4 && !list.iter().any(known) {
            list.push(UnitSlip { factor, usual, note });
        }
    };
    let factors: Vec<(&str, f64)> = RATE_UNITS
        .iter()
        .filter_map(|u| Some((*u, Unit::parse(u).ok()?)))
        .filter_map(|(name, u)| Some((name, u.factor_to(&own).ok()?)))
        .collect();
    for (name, factor) in &factors {
        let digits = factor.log10();
        let shifted = (digits - digits.round()).abs() < 1e-9;
        let key = if shifted { "mistake.unit_or_shift" } else { "mistake.unit" };
        add(
            *factor,
            !shifted && COMMON_RATE_UNITS.contains(name),
            Note::new(key)
                .with("unit", *name)
                .with("declared", declared)
                .with("digits", digits.round().abs() as u64),
        );
    }
    for digits in 1..=6i32 {
        for (factor, key) in
            [(10f64.powi(digits), "mistake.shift_right"), (10f64.powi(-digits), "mistake.shift_left")]
        {
            add(factor, false, Note::new(key).with("digits", digits.unsigned_abs() as u64));
        }
    }
    for (name, factor) in &factors {
        add(1.0 / factor, false, note!("mistake.twice", unit = *name, declared));
    }
    list
}

/// The slips that stamps in seconds can have: factor from the time as read to the time that was meant.
pub(super) fn time_factors() -> Vec<UnitSlip> {
    let of = |factor: f64, note: Note| UnitSlip { factor, usual: false, note };
    let one = |factor: f64, unit: &str| of(factor, note!("mistake.time_unit", unit));
    vec![
        one(1e-3, "ms"),
        one(1e-6, "µs"),
        one(1e-9, "ns"),
        one(60.0, "min"),
        one(3600.0, "h"),
        of(1e3, note!("mistake.time_thousandth")),
        of(1e6, note!("mistake.time_millionth")),
    ]
}

/// One sentence of several that could each be true.
pub(super) fn either(mut notes: Vec<Note>) -> Option<Note> {
    let last = notes.pop()?;
    Some(notes.into_iter().rev().fold(last, |rest, note| note!("mistake.or", one = note, other = rest)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_those_of_the_units_and_none_stands_twice() {
        let list = rate_factors("deg/h");
        let of = |unit: &str| {
            let named = |m: &&UnitSlip| m.note.args.get("unit") == Some(&unit.into());
            list.iter().find(named).map(|m| m.factor)
        };
        assert!((of("deg/s").unwrap() / 3600.0 - 1.0).abs() < 1e-12);
        assert!((of("rad/s").unwrap() / 206_264.806_247 - 1.0).abs() < 1e-9);
        assert!((of("arcsec/h").unwrap() * 3600.0 - 1.0).abs() < 1e-12);
        assert!((of("deg/min").unwrap() / 60.0 - 1.0).abs() < 1e-12);
        assert_eq!(of("deg/h"), None);
        for (i, a) in list.iter().enumerate() {
            assert!(list[..i].iter().all(|b| (a.factor / b.factor - 1.0).abs() > 1e-4), "{a:?}");
        }
        // A shift by five digits is no unit of the list.
        assert!(
            list.iter().any(|m| m.note.id == "mistake.shift_left" && (m.factor * 1e5 - 1.0).abs() < 1e-12)
        );
        assert!(rate_factors("arcsec").iter().any(|m| (m.factor / 3600.0 - 1.0).abs() < 1e-12));
    }
}
