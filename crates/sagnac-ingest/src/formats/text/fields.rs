//! Lines into fields, and which lines are comments.

/// What separates the fields of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    /// One character.
    Byte(u8),
    /// Any run of spaces and tabs; leading and trailing ones count for nothing.
    Blanks,
}

impl Separator {
    /// The character, a space for runs of blanks.
    pub(super) fn byte(self) -> u8 {
        match self {
            Separator::Byte(b) => b,
            Separator::Blanks => b' ',
        }
    }

    /// From a character that a user stated.
    pub(super) fn of(byte: u8) -> Separator {
        if byte == b' ' { Separator::Blanks } else { Separator::Byte(byte) }
    }

    /// All fields of a line; a separator between quotes does not count.
    pub(super) fn cells(self, line: &[u8]) -> Vec<&[u8]> {
        let mut cells = Vec::new();
        match self {
            Separator::Byte(byte) => {
                let (mut start, mut quoted) = (0, false);
                for (i, &c) in line.iter().enumerate() {
                    if c == b'"' {
                        quoted = !quoted;
                    } else if c == byte && !quoted {
                        cells.push(line.get(start..i).unwrap_or_default());
                        start = i + 1;
                    }
                }
                cells.push(line.get(start..).unwrap_or_default());
            }
            Separator::Blanks => {
                let (mut start, mut quoted) = (None, false);
                for (i, &c) in line.iter().enumerate() {
                    let blank = matches!(c, b' ' | b'\t') && !quoted;
                    quoted ^= c == b'"';
                    match (blank, start) {
                        (true, Some(from)) => {
                            cells.push(line.get(from..i).unwrap_or_default());
                            start = None;
                        }
                        (false, None) => start = Some(i),
                        _ => {}
                    }
                }
                cells.extend(start.and_then(|from| line.get(from..)));
            }
        }
        cells
    }

    /// The fields of a line where `fields` are usual: a separator behind the last opens no further field.
    pub(super) fn usual_cells(self, line: &[u8], fields: usize) -> Vec<&[u8]> {
        let mut cells = self.cells(line);
        if cells.len() == fields.saturating_add(1) && cells.last().is_some_and(|c| c.trim_ascii().is_empty())
        {
            cells.pop();
        }
        cells
    }
}

/// A field without the blanks and the pair of quotes around it.
pub(super) fn bare(cell: &[u8]) -> &[u8] {
    let t = cell.trim_ascii();
    t.strip_prefix(b"\"").and_then(|r| r.strip_suffix(b"\"")).map_or(t, <[u8]>::trim_ascii)
}

/// A field as text: without blanks and quotes around it, doubled quotes made single.
pub(super) fn words(cell: &[u8]) -> String {
    String::from_utf8_lossy(bare(cell)).replace("\"\"", "\"").trim().to_owned()
}

/// What spreadsheets write for a failed formula: a bad field, no comment.
const ERRORS: [&[u8]; 6] = [b"#N/A", b"#NUM!", b"#DIV/0!", b"#VALUE!", b"#REF!", b"#NAME?"];

/// Which lines are comments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Comments {
    prefixes: Vec<Vec<u8>>,
    stated: bool,
}

impl Comments {
    /// The usual beginnings, or the one that was stated.
    pub(super) fn new(stated: Option<&str>, separator: Option<Separator>) -> Comments {
        let prefixes = match stated {
            Some(prefix) => vec![prefix.as_bytes().to_vec()],
            None => [&b"#"[..], b"%", b"//", b";"]
                .into_iter()
                .filter(|p| separator.is_none_or(|s| *p != [s.byte()]))
                .map(<[u8]>::to_vec)
                .collect(),
        };
        Comments { prefixes, stated: stated.is_some() }
    }

    /// The beginning of a comment that a line has.
    pub(super) fn prefix_of<'a>(&self, line: &'a [u8]) -> Option<&'a [u8]> {
        let line = line.trim_ascii_start();
        let prefix = self.prefixes.iter().find(|p| line.starts_with(p))?;
        let failed = !self.stated && ERRORS.iter().any(|e| line.starts_with(e));
        if failed { None } else { line.get(..prefix.len()) }
    }

    /// True when a line is a comment.
    pub(super) fn holds(&self, line: &[u8]) -> bool {
        self.prefix_of(line).is_some()
    }

    /// True when a line with this first character may be a comment.
    #[inline(always)]
    pub(super) fn may_begin(&self, first: u8) -> bool {
        self.stated || matches!(first, b'#' | b'%' | b'/' | b';' | b' ' | b'\t')
    }
}
