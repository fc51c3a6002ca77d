//! Words in which people write the role of a channel, so that the role can be offered, and the place of a sensor.

use crate::recording::Role;

/// Words in lower case and the role that each stands for. Beginnings such as `temp` need no word here.
const ROLE_WORDS: &[(&str, Role)] = &[
    ("acc", Role::Vibration),
    ("acceleration", Role::Vibration),
    ("accelerometer", Role::Vibration),
    ("amps", Role::Current),
    ("angle", Role::AccumulatedAngle),
    ("angular_rate", Role::Rate),
    ("baro", Role::Pressure),
    ("barometer", Role::Pressure),
    ("bit", Role::Status),
    ("clock", Role::Time),
    ("dtheta", Role::AngleIncrement),
    ("delta_angle", Role::AngleIncrement),
    ("encoder", Role::TableAngle),
    ("field", Role::MagneticField),
    ("flags", Role::Status),
    ("frame", Role::Counter),
    ("gyro", Role::Rate),
    ("increment", Role::AngleIncrement),
    ("index", Role::Counter),
    ("omega", Role::Rate),
    ("other", Role::Auxiliary),
    ("output", Role::Rate),
    ("power", Role::Supply),
    ("sample", Role::Counter),
    ("sequence", Role::Counter),
    ("stamp", Role::Time),
    ("t", Role::Time),
    ("thermometer", Role::Temperature),
    ("timestamp", Role::Time),
    ("voltage", Role::Supply),
];

/// The role that a word means which is none: whole, without what follows it (`temp_c`), or by meaning.
pub(crate) fn meant(word: &str) -> Option<&'static str> {
    let plain = word.trim().to_lowercase().replace(['-', ' '], "_");
    let by_meaning = |w: &str| ROLE_WORDS.iter().find(|(known, _)| *known == w).map(|(_, role)| role.id());
    by_meaning(&plain).or_else(|| {
        let first = plain.split('_').next().unwrap_or_default();
        let begun = |role: &Role| first.len() >= 3 && role.id().starts_with(first);
        let mut roles = Role::ALL.iter().filter(|r| begun(r));
        match (roles.next(), roles.next()) {
            (Some(role), None) => Some(role.id()),
            _ => by_meaning(first),
        }
    })
}

/// Beginnings of words for places that are not on the unit, in lower case.
const PLACES_ELSEWHERE: [&str; 10] =
    ["rack", "room", "ambient", "outside", "outdoor", "hall", "air", "помещ", "комн", "стойк"];

/// True where the name of a column says that its sensor is somewhere else than on the unit.
pub(crate) fn is_elsewhere(name: &str) -> bool {
    let name = name.to_lowercase();
    PLACES_ELSEWHERE.iter().any(|place| name.contains(place))
}

#[cfg(test)]
mod tests {
    use super::{is_elsewhere, meant};

    #[test]
    fn the_name_of_a_column_may_say_that_its_sensor_is_not_on_the_unit() {
        for on_the_unit in ["temp_degC", "T_housing [degC]", "Температура"] {
            assert!(!is_elsewhere(on_the_unit), "{on_the_unit}");
        }
        for elsewhere in ["rack_degC", "Room temperature", "Температура помещения"] {
            assert!(is_elsewhere(elsewhere), "{elsewhere}");
        }
    }

    #[test]
    fn roles_are_offered_by_meaning_before_spelling() {
        for (word, role) in [
            ("temp", Some("temperature")),
            ("Temp_C", Some("temperature")),
            ("timestamp", Some("time")),
            ("gyro", Some("rate")),
            ("gyro_x", Some("rate")),
            ("omega", Some("rate")),
            ("voltage", Some("supply")),
            ("mag", Some("magnetic_field")),
            ("vib", Some("vibration")),
            ("aux", Some("auxiliary")),
            ("encoder", Some("table_angle")),
            ("table", None),
            ("zebra", None),
        ] {
            assert_eq!(meant(word), role, "{word}");
        }
    }
}
