//! The column that a name most likely means: case, separators and the unit at the end are ignored.

use super::column_inference::stem;

/// Shortest beginning of a name that is taken for the name, characters.
const BEGINNING: usize = 3;

/// How a column is like a name, the likest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Likeness {
    /// The same but for case and separators.
    Same,
    /// The same but for the unit too.
    SameStem,
    /// One begins with the other.
    Begins,
    /// Spelt alike; the number of changes.
    Spelt(usize),
}

/// The column that a name means; `None` where none is like it, or several are alike.
pub(crate) fn similar<'a>(name: &str, columns: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if name.len() > 200 {
        return None;
    }
    let mut found: Vec<(Likeness, &str)> =
        columns.into_iter().filter_map(|column| Some((likeness(name, column)?, column))).collect();
    found.sort();
    found.dedup();
    match found.as_slice() {
        [(first, _), (second, _), ..] if first == second => None,
        [(_, column), ..] => Some(column),
        [] => None,
    }
}

fn likeness(name: &str, column: &str) -> Option<Likeness> {
    let (name_whole, column_whole) = (joined(name), joined(column));
    if name_whole.is_empty() || column_whole.is_empty() {
        return None;
    }
    if name_whole == column_whole {
        return Some(Likeness::Same);
    }
    let (name_stem, column_stem) = (stem(name).concat(), stem(column).concat());
    let stems = !name_stem.is_empty() && !column_stem.is_empty();
    if stems && name_stem == column_stem {
        return Some(Likeness::SameStem);
    }
    let begins = |long: &str, short: &str| short.chars().count() >= BEGINNING && long.starts_with(short);
    if begins(&column_whole, &name_whole) || stems && begins(&name_stem, &column_stem) {
        return Some(Likeness::Begins);
    }
    let changes = |a: &str, b: &str| {
        let changes = strsim::damerau_levenshtein(a, b);
        (changes <= a.chars().count().min(b.chars().count()) / 3).then_some(changes)
    };
    let of_stems = stems.then(|| changes(&name_stem, &column_stem)).flatten();
    [changes(&name_whole, &column_whole), of_stems].into_iter().flatten().min().map(Likeness::Spelt)
}

/// Letters and digits alone, in lower case.
fn joined(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

#[cfg(test)]
mod tests {
    use super::similar;

    #[test]
    fn case_separators_and_units_are_ignored() {
        let columns = ["t", "Omega_z [deg/h]", "Omega_x [deg/h]", "temp_C", "Supply voltage (V)"];
        for (name, meant) in [
            ("Omega_z", Some("Omega_z [deg/h]")),
            ("omega z", Some("Omega_z [deg/h]")),
            ("OmegaZ", Some("Omega_z [deg/h]")),
            ("omega_z_deg_s", Some("Omega_z [deg/h]")),
            ("Omga_z", Some("Omega_z [deg/h]")),
            ("TIME", None),
            ("T", Some("t")),
            ("temp", Some("temp_C")),
            ("temp_degC", Some("temp_C")),
            ("temperature", Some("temp_C")),
            ("supply_voltage", Some("Supply voltage (V)")),
            ("time_s", None),
            ("rate", None),
            ("", None),
            ("[]", None),
        ] {
            assert_eq!(similar(name, columns), meant, "{name}");
        }
        // Two are alike: neither is offered.
        assert_eq!(similar("Omega", columns), None);
        assert_eq!(similar("rate", ["rate_x", "rate_y"]), None);
        assert_eq!(similar("rte", ["rate", "rate"]), Some("rate"));
    }
}
