//! What a text file says of itself above the data: `serial: SN-0042`, `Serial;SN-0042`, titles.

use super::fields::{Separator, words};

/// Most entries that are kept.
const MOST: usize = 64;

/// Longest key and value, characters.
const LONGEST: usize = 200;

/// Collects entries.
#[derive(Debug, Default)]
pub(super) struct Metadata {
    list: Vec<(String, String)>,
}

impl Metadata {
    /// Takes a line above the data; `separator` may stand between key and value.
    pub(super) fn take(&mut self, line: &[u8], separator: Option<Separator>) {
        let text = String::from_utf8_lossy(line);
        let text = text.trim();
        if text.is_empty() || !text.chars().any(char::is_alphanumeric) || self.list.len() >= MOST {
            return;
        }
        let cells: Vec<String> =
            separator.map(|s| s.usual_cells(line, 2)).unwrap_or_default().into_iter().map(words).collect();
        let (key, value) = match (cells.as_slice(), text.split_once([':', '='])) {
            ([key, value], _) if separator != Some(Separator::Blanks) => {
                (key.trim_end_matches([':', '=']).trim().to_owned(), value.clone())
            }
            // A colon between digits is part of a time.
            (_, Some((key, value))) if key.chars().any(char::is_alphabetic) => {
                let value = value.trim_matches(|c: char| c.is_whitespace() || matches!(c, ';' | ',' | '"'));
                (key.trim().trim_matches('"').to_owned(), value.to_owned())
            }
            _ => ("title".to_owned(), text.trim_matches(['"', ';', ',', '\t']).trim().to_owned()),
        };
        if !value.is_empty() && !key.is_empty() {
            self.list.push((cut(&key), cut(&value)));
        }
    }

    /// The entries in order.
    pub(super) fn into_list(self) -> Vec<(String, String)> {
        self.list
    }
}

fn cut(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(LONGEST).collect()
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
            m.take(line.as_bytes(), semicolon);
        }
        let list = m.into_list();
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
