//! What a text file says of itself above the data: `serial: SN-0042`, `Serial;SN-0042`, titles.

use super::fields::{Separator, words};
use crate::metadata::Metadata;

/// Adds what a line above the data says; `separator` may stand between key and value.
pub(super) fn add_line(metadata: &mut Metadata, line: &[u8], separator: Option<Separator>) {
    let text = String::from_utf8_lossy(line);
    let text = text.trim();
    if !text.chars().any(char::is_alphanumeric) || metadata.is_full() {
        return;
    }
    let cells: Vec<String> =
        separator.map(|s| s.usual_cells(line, 2)).unwrap_or_default().into_iter().map(words).collect();
    match (cells.as_slice(), text.split_once([':', '='])) {
        ([key, value], _) if separator != Some(Separator::Blanks) => {
            metadata.add(key.trim_end_matches([':', '=']), value);
        }
        // A value a channel, as LabVIEW has them: all alike count once.
        ([key, first, rest @ ..], _)
            if separator == Some(Separator::Byte(b'\t')) && !key.is_empty() && !first.is_empty() =>
        {
            let filled: Vec<&str> = rest.iter().map(String::as_str).filter(|c| !c.is_empty()).collect();
            let alike = filled.iter().all(|c| c == first);
            let all: Vec<&str> = std::iter::once(first.as_str()).chain(filled).collect();
            metadata
                .add(key.trim_end_matches([':', '=']), &if alike { first.clone() } else { all.join(" ") });
        }
        // A colon between digits is part of a time.
        (_, Some((key, value))) if key.chars().any(char::is_alphabetic) => {
            let value = value.trim_matches(|c: char| c.is_whitespace() || matches!(c, ';' | ',' | '"'));
            metadata.add(key.trim().trim_matches('"'), value);
        }
        _ => metadata.add("title", text.trim_matches(['"', ';', ',', '\t'])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_and_values_are_told_apart() {
        let mut m = Metadata::default();
        let semicolon = Some(Separator::Byte(b';'));
        for line in
            ["Serial;SN-0042", "Прибор: ВОГ-1 № 12", "Test of a gyro", "rate = 10 Hz", "---", "12:30:00"]
        {
            add_line(&mut m, line.as_bytes(), semicolon);
        }
        let list = m.entries();
        let expected = [
            ("Serial", "SN-0042"),
            ("Прибор", "ВОГ-1 № 12"),
            ("title", "Test of a gyro"),
            ("rate", "10 Hz"),
            ("title", "12:30:00"),
        ];
        assert_eq!(list, expected.map(|(k, v)| (k.to_owned(), v.to_owned())));
    }
}
