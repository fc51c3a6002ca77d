//! The lines above the data: names, units, the rest.

use super::fields::{Separator, words};
use sagnac_core::units::Unit;

/// Names and units as they stand above the data.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Header {
    /// Line of the names and the names.
    pub names: Option<(u64, Vec<String>)>,
    /// Line of the units and the units; empty where a column has none.
    pub units: Option<(u64, Vec<String>)>,
    /// The names end with one for remarks, which the rows leave out.
    pub remarks: bool,
}

/// Names of columns of remarks, in lower case, as LabVIEW and operators write them.
const REMARKS: &[&str] = &[
    "comment",
    "comments",
    "note",
    "notes",
    "remark",
    "remarks",
    "комментарий",
    "комментарии",
    "примечание",
];

/// Key of the line in which LabVIEW gives the unit of each channel.
const LABVIEW_UNITS: &[u8] = b"Y_Unit_Label";

/// The units of channels that LabVIEW states above the names, by column: channels in their order, times in s.
pub(super) fn labview_units(above: &[&[u8]], separator: Separator, names: &[String]) -> Vec<Option<String>> {
    let line =
        above.iter().find(|l| separator.cells(l).first().is_some_and(|c| c.trim_ascii() == LABVIEW_UNITS));
    let Some(line) = line else { return vec![None; names.len()] };
    let mut units = separator.cells(line).into_iter().skip(1).map(words);
    let of = |name: &String| match name.as_str() {
        "X_Value" => Some("s".to_owned()),
        _ => units.next().filter(|u| Unit::parse(u).is_ok()),
    };
    names.iter().map(of).collect()
}

impl Header {
    /// True when a line was taken for names or units.
    pub(super) fn uses(&self, number: u64) -> bool {
        self.names.as_ref().is_some_and(|n| n.0 == number)
            || self.units.as_ref().is_some_and(|u| u.0 == number)
    }
}

/// A line above the data: its number, its text without the sign of a comment, whether it is a comment.
pub(super) type Above<'a> = (u64, &'a [u8], bool);

/// Finds names and units among the lines above the data. `stated`: the line that the user says holds the names.
pub(super) fn find(above: &[Above<'_>], separator: Separator, fields: usize, stated: Option<u64>) -> Header {
    let named = |line: &[u8]| names(line, separator, fields);
    let mut header = Header {
        remarks: above.iter().any(|l| ends_with_remarks(l.1, separator, fields)),
        ..Header::default()
    };
    if let Some(number) = stated {
        let line = above.iter().find(|l| l.0 == number);
        header.names = line.and_then(|l| named(l.1)).map(|n| (number, n));
        let below = above.iter().filter(|l| l.0 > number);
        header.units = below.filter_map(|l| Some((l.0, units(l.1, separator, fields)?))).next();
        return header;
    }
    // Plain lines go before comments; of each the last counts.
    for comments in [false, true] {
        let mut lines = above
            .iter()
            .rev()
            .filter(|l| l.2 == comments && lettered(l.1) && (!comments || nameable(l.1, separator)));
        let Some(last) = lines.next() else { continue };
        let spelt = units(last.1, separator, fields);
        let before = lines.next().and_then(|l| Some((l.0, named(l.1)?)));
        match (spelt, before) {
            (Some(spelt), Some(before)) if !all_units(&before.1) => {
                header.units = Some((last.0, spelt));
                header.names = Some(before);
            }
            (Some(spelt), _) if comments && header.names.is_some() => header.units = Some((last.0, spelt)),
            _ if header.names.is_none() => header.names = named(last.1).map(|n| (last.0, n)),
            _ => {}
        }
    }
    header
}

/// True for a line with a letter: rows of numbers that are skipped name nothing.
fn lettered(line: &[u8]) -> bool {
    String::from_utf8_lossy(line).chars().any(|c| c.is_alphabetic() || c == '№')
}

/// True when a comment may hold names: no key with a value where blanks separate.
fn nameable(line: &[u8], separator: Separator) -> bool {
    let keyed = line.iter().any(|c| matches!(c, b':' | b'='));
    !(keyed && separator == Separator::Blanks)
}

fn all_units(names: &[String]) -> bool {
    names.iter().all(|n| unit_of(n).is_some())
}

/// The names in a line, when there are as many as fields.
fn names(line: &[u8], separator: Separator, fields: usize) -> Option<Vec<String>> {
    let cells: Vec<String> = separator.usual_cells(line, fields).into_iter().map(words).collect();
    let found = if cells.len() == fields {
        cells
    } else if ends_with_remarks(line, separator, fields) {
        cells.into_iter().take(fields).collect()
    } else if separator == Separator::Blanks {
        wide(line, fields)?
    } else {
        // Separators at the end of the names where the rows have none, or the other way round.
        let filled = cells.iter().rposition(|c| !c.is_empty()).map_or(0, |i| i + 1);
        let short = filled < cells.len() && filled <= fields && cells.len() >= fields;
        short.then(|| cells.into_iter().take(fields).collect())?
    };
    found.iter().any(|n| !n.is_empty()).then_some(found)
}

/// True for names of which the last is for remarks, and one more than fields.
fn ends_with_remarks(line: &[u8], separator: Separator, fields: usize) -> bool {
    let cells = separator.usual_cells(line, fields);
    let last = cells.last().map(|c| words(c).to_lowercase()).unwrap_or_default();
    cells.len() == fields + 1 && REMARKS.contains(&last.as_str())
}

/// Names with single blanks in them: cut at wider gaps, or before brackets.
fn wide(line: &[u8], fields: usize) -> Option<Vec<String>> {
    let text = String::from_utf8_lossy(line).replace('\t', "  ");
    let gaps: Vec<String> =
        text.split("  ").map(str::trim).filter(|t| !t.is_empty()).map(str::to_owned).collect();
    if gaps.len() == fields {
        return Some(gaps);
    }
    let mut merged: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match merged.last_mut() {
            Some(last) if word.starts_with(['[', '(', '{']) || last.ends_with(',') => {
                last.push(' ');
                last.push_str(word);
            }
            _ => merged.push(word.to_owned()),
        }
    }
    (merged.len() == fields).then_some(merged)
}

/// The units in a line, when every field that is filled spells one.
fn units(line: &[u8], separator: Separator, fields: usize) -> Option<Vec<String>> {
    let cells: Vec<String> = separator.usual_cells(line, fields).into_iter().map(words).collect();
    if cells.len() != fields {
        return None;
    }
    let nothing = |c: &str| c.is_empty() || matches!(c, "-" | "–" | "—" | "[]" | "()" | "[-]" | "(-)");
    let spelt = cells.iter().filter(|c| !nothing(c)).all(|c| unit_of(c).is_some());
    let some = cells.iter().any(|c| !nothing(c));
    (spelt && some).then(|| cells.iter().map(|c| unit_of(c).unwrap_or_default()).collect())
}

/// The unit that a text spells, with or without brackets around it.
fn unit_of(text: &str) -> Option<String> {
    let inner = text.trim().trim_start_matches(['[', '(']).trim_end_matches([']', ')']).trim();
    Unit::parse(if text.contains('[') { inner } else { text.trim() })
        .or_else(|_| Unit::parse(inner))
        .ok()
        .map(|u| u.text().to_owned())
}

/// The unit that a name tells in brackets or behind a comma: `rate [deg/h]`, `Rate (°/h)`, `Скорость, град/ч`.
pub(super) fn unit_in_name(name: &str) -> Option<String> {
    let (_, bracketed) = crate::column_inference::split_brackets(name);
    bracketed.filter(|b| Unit::parse(b).is_ok() && b != "1")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_units_are_found_above_the_data() {
        let semicolon = Separator::Byte(b';');
        let lines: Vec<Above<'_>> =
            vec![(1, b"Test 7", false), (2, b"time;rate;temp", false), (3, b"s;deg/h;degC", false)];
        let h = find(&lines, semicolon, 3, None);
        assert_eq!(h.names.unwrap(), (2, ["time", "rate", "temp"].map(str::to_owned).to_vec()));
        assert_eq!(h.units.unwrap(), (3, ["s", "deg/h", "degC"].map(str::to_owned).to_vec()));
        let h = find(&[(4, b"t [s] rate [deg/h]", true)], Separator::Blanks, 2, None);
        assert_eq!(h.names.unwrap().1, ["t [s]", "rate [deg/h]"]);
        assert_eq!(find(&[(1, b"g;V", false)], semicolon, 2, None).names.unwrap().1, ["g", "V"]);
    }
}
