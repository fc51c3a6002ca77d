//! The serial number that a recording states of its unit.

use crate::ingest::Source;
use crate::ingest::compressed::ByteStream;

/// Words for a serial number before its value, lower case.
const KEYS: &[&str] = &[
    "serial",
    "serial number",
    "serial no",
    "serial no.",
    "serial_number",
    "s/n",
    "sn",
    "unit",
    "unit serial",
    "заводской номер",
    "зав. №",
    "серийный номер",
];
/// Bytes at the beginning of a file in which comments are looked for.
const HEAD: usize = 64 << 10;
/// Longest serial number, characters.
const LONGEST: usize = 64;

/// What the file says: its metadata, or else a comment line before the data, such as `# serial: SN-0043`.
pub(super) fn stated_serial(source: &Source) -> Option<String> {
    let from_metadata = source.metadata().iter().find_map(|(key, value)| serial(key, value));
    from_metadata.or_else(|| from_comments(source))
}

fn serial(key: &str, value: &str) -> Option<String> {
    let value = value.trim().trim_matches('"').trim();
    let fits = !value.is_empty() && value.chars().count() <= LONGEST && !value.chars().any(char::is_control);
    (fits && KEYS.contains(&key.trim().to_lowercase().as_str())).then(|| value.to_owned())
}

fn from_comments(source: &Source) -> Option<String> {
    if source.format() != "csv" {
        return None;
    }
    let mut head = vec![0; HEAD];
    let n = ByteStream::open(source.path(), source.packing()).ok()?.fill(&mut head).ok()?;
    let text = String::from_utf8_lossy(head.get(..n)?);
    text.trim_start_matches('\u{feff}')
        .lines()
        .map(str::trim_start)
        .take_while(|line| line.is_empty() || line.starts_with(['#', '%']))
        .find_map(|line| {
            let line = line.trim_start_matches(['#', '%']);
            let (key, value) = line.split_once([':', '='])?;
            serial(key, value)
        })
}
