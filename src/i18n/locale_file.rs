//! Locale files read line by line.
//!
//! They are TOML of the plainest kind: headers of tables, and keys with a text in double quotes, a line each, or with a paragraph between
//! lines that end in three of them. Every command reads one, and a reader of all TOML takes longer for it than all else that a short
//! command does.

use super::Table;

/// What begins a paragraph at the end of a line, and ends it.
const PARAGRAPH: &str = "\"\"\"";

/// The texts by their dotted keys; `None` where a line is of another kind, which TOML may allow.
pub(super) fn read(source: &str) -> Option<Table> {
    let (mut out, mut header) = (Table::new(), "");
    let mut lines = source.lines();
    while let Some(line) = lines.next() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        if let Some(rest) = line.strip_prefix('[') {
            header = rest.strip_suffix(']').filter(|name| is_bare(name))?;
            continue;
        }
        let Entry { name, text } = entry(line)?;
        let key = if header.is_empty() { name } else { format!("{header}.{name}") };
        let text = match text {
            PARAGRAPH => resolved(&paragraph(&mut lines)?)?,
            text => resolved(text.strip_prefix('"')?.strip_suffix('"')?)?,
        };
        // A key that stands there twice is a mistake, which the other reader names.
        if out.insert(key, text).is_some() {
            return None;
        }
    }
    Some(out)
}

/// A line with a key.
struct Entry<'a> {
    name: String,
    /// What stands behind the equals sign.
    text: &'a str,
}

/// The key of a line, bare or between quotes.
fn entry(line: &str) -> Option<Entry<'_>> {
    let (name, rest) = if let Some(quoted) = line.strip_prefix('"') {
        let mut is_escaped = false;
        let end = quoted.find(|c| {
            let ends = c == '"' && !is_escaped;
            is_escaped = c == '\\' && !is_escaped;
            ends
        })?;
        (resolved(quoted.get(..end)?)?, quoted.get(end + 1..)?)
    } else if let Some(quoted) = line.strip_prefix('\'') {
        let (name, rest) = quoted.split_once('\'')?;
        (name.to_owned(), rest)
    } else {
        let end = line.find('=')?;
        let name = line.get(..end)?.trim();
        (is_bare(name).then(|| name.to_owned())?, line.get(end..)?)
    };
    Some(Entry { name, text: rest.trim_start().strip_prefix('=')?.trim() })
}

/// True for a name without quotes or escapes, its parts divided by dots.
fn is_bare(name: &str) -> bool {
    let is_plain = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-');
    name.split('.').all(|part| !part.is_empty() && part.bytes().all(is_plain))
}

/// The lines up to the one that ends a paragraph.
fn paragraph(lines: &mut std::str::Lines<'_>) -> Option<String> {
    let mut out = String::new();
    loop {
        let line = lines.next()?;
        if let Some(last) = line.strip_suffix(PARAGRAPH) {
            out.push_str(last);
            return Some(out);
        }
        out.push_str(line);
        out.push('\n');
    }
}

/// A text from between its quotes, its escapes resolved; `None` for one that is not known, and for a quote without it.
fn resolved(mut rest: &str) -> Option<String> {
    let mut out = String::with_capacity(rest.len());
    while let Some(at) = rest.find(['\\', '"']) {
        let (plain, special) = rest.split_at(at);
        out.push_str(plain);
        let mut characters = special.strip_prefix('\\')?.chars();
        match characters.next()? {
            own @ ('"' | '\\') => out.push(own),
            'n' => out.push('\n'),
            't' => out.push('\t'),
            'u' => {
                let code = u32::from_str_radix(characters.as_str().get(..4)?, 16).ok()?;
                out.push(char::from_u32(code)?);
                characters = characters.as_str().get(4..)?.chars();
            }
            _ => return None,
        }
        rest = characters.as_str();
    }
    out.push_str(rest);
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::{Lang, flatten};

    #[test]
    fn the_shipped_files_read_as_toml_reads_them() {
        for lang in Lang::ALL {
            let read = read(lang.source());
            assert!(read.is_some(), "{lang:?} is read by the slower reader");
            assert_eq!(read, flatten(lang.source()), "{lang:?}");
        }
    }

    #[test]
    fn what_is_not_of_the_plainest_kind_is_left_to_the_reader_of_toml() {
        let one = |key: &str, text: &str| Some(Table::from([(key.to_owned(), text.to_owned())]));
        assert_eq!(
            read("# none\n\n[a.b]\nc-d = \"x \\\"y\\\" \\\\ = z\" \n"),
            one("a.b.c-d", "x \"y\" \\ = z")
        );
        assert_eq!(read("\"a.b\" = \"\""), one("a.b", ""));
        assert_eq!(read("\"a = \\\"b\\\".\" = \"c\""), one("a = \"b\".", "c"));
        assert_eq!(read("'a = \"b\\' = \"c\""), one("a = \"b\\", "c"));
        assert_eq!(
            read("a = \"\"\"\n  b\n\\\"c\"\"\"\nd = \"\"").and_then(|t| t.get("a").cloned()).as_deref(),
            Some("  b\n\"c")
        );
        assert_eq!(read("a = \"1\\u202f000\\n\""), one("a", "1\u{202f}000\n"));
        for other in [
            "a = 1",
            "a = \"b",
            "a = \"b\" # c",
            "a = 'b'",
            "a = \"\\x\"",
            "a = \"b\"\na = \"c\"",
            "[[a]]",
            "[a",
            "a",
            "a b = \"c\"",
            "a = \"\"\"b\"\"\"",
            "a = \"\"\"\nb",
            "a = \"\"\"\nb \\\n c\"\"\"",
        ] {
            assert_eq!(read(other), None, "{other}");
        }
    }
}
