//! What two procedures do differently: the keys of their files that differ.

use toml::{Table, Value};

/// Tables that say who made a procedure and how it reports, and nothing of what is measured; instruments are the bench.
const TELLS_NOTHING: [&str; 9] =
    ["procedure", "report", "clause", "waiver", "limit", "limits", "reference", "expected", "instrument"];

/// The keys of two procedure files that differ, such as `conditions.warm_up`, in alphabetical order. A table of a list is named by
/// its `id`, else by its place from 1. Empty where a file is no TOML.
pub fn differing_keys(first: &str, second: &str) -> Vec<String> {
    let (Ok(first), Ok(second)) = (first.parse::<Table>(), second.parse::<Table>()) else { return vec![] };
    let mut found = vec![];
    tables(&first, &second, "", &mut found);
    found.retain(|key| !TELLS_NOTHING.contains(&key.split('.').next().unwrap_or_default()));
    found.sort();
    found
}

fn tables(first: &Table, second: &Table, above: &str, found: &mut Vec<String>) {
    let keys = first.keys().chain(second.keys().filter(|k| !first.contains_key(*k)));
    for key in keys {
        let path = if above.is_empty() { key.clone() } else { format!("{above}.{key}") };
        values(first.get(key), second.get(key), path, found);
    }
}

fn values(first: Option<&Value>, second: Option<&Value>, path: String, found: &mut Vec<String>) {
    match (first, second) {
        (Some(Value::Table(a)), Some(Value::Table(b))) => tables(a, b, &path, found),
        (Some(Value::Array(a)), Some(Value::Array(b))) if a.iter().chain(b).all(Value::is_table) => {
            let (a, b) = (named(a), named(b));
            let names = a.iter().chain(b.iter().filter(|(name, _)| !a.iter().any(|(n, _)| n == name)));
            for (name, _) in names {
                let of = |list: &[(String, &Value)]| {
                    list.iter().find(|(n, _)| n == name).map(|(_, v)| (*v).clone())
                };
                values(of(&a).as_ref(), of(&b).as_ref(), format!("{path}.{name}"), found);
            }
        }
        (a, b) if a == b => {}
        _ => found.push(path),
    }
}

/// The tables of a list with their names.
fn named(list: &[Value]) -> Vec<(String, &Value)> {
    let name = |(i, value): (usize, &Value)| {
        let id = value.get("id").and_then(Value::as_str).map(str::to_owned);
        id.unwrap_or_else(|| (i + 1).to_string())
    };
    list.iter().enumerate().map(|(i, value)| (name((i, value)), value)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_that_decide_are_named_and_others_are_not() {
        let maker = "[procedure]\nid = \"a\"\n[conditions]\nwarm_up = \"30 min\"\nminimum_duration = \"10 h\"\n\
                     [[channel]]\nid = \"rate\"\nunit = \"deg/h\"\n[[measurand]]\nid = \"static_bias\"\n";
        let customer = maker
            .replace("id = \"a\"", "id = \"b\"")
            .replace("30 min", "60 min")
            .replace("unit = \"deg/h\"", "unit = \"deg/s\"")
            + "[[measurand]]\nid = \"russian_drift_100s\"\n[site]\nlatitude = \"56 deg\"\n";
        let found = differing_keys(maker, &customer);
        let wanted = ["channel.rate.unit", "conditions.warm_up", "measurand.russian_drift_100s", "site"];
        assert_eq!(found, wanted);
        assert_eq!(differing_keys(maker, maker), Vec::<String>::new());
        assert_eq!(differing_keys(maker, "no toml ["), Vec::<String>::new());
    }
}
