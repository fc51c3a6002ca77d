//! Who may sign: a list in the form of the `allowed_signers` of OpenSSH, read as `ssh-keygen -Y verify` reads it (`sshsig.c`). A line
//! that `ssh-keygen` passes over is passed over here too, and said.

use super::key::SIGNATURE_NAMESPACE;
use super::pattern::{Listed, matches_list};
use chrono::{DateTime, Local, NaiveDateTime, TimeZone, Utc};
use sagnac_ingest::read_file;
use ssh_key::PublicKey;
use std::io;
use std::path::Path;

/// Largest list that is read, bytes.
const MAX_LIST_BYTES: u64 = 4 << 20;

/// Keys and to whom they belong.
#[derive(Debug, Clone, Default)]
pub struct Signers {
    lines: Vec<Line>,
    /// Lines that name no key, or one with options that are not understood.
    pub passed_over: Vec<BadLine>,
}

/// A key of a list.
#[derive(Debug, Clone)]
struct Line {
    number: usize,
    /// Names, patterns and negations, separated by commas.
    principals: String,
    key: PublicKey,
    options: Options,
}

/// A line of a list that is passed over.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BadLine {
    /// Its number, from 1.
    pub line: usize,
    /// Why.
    pub fault: LineFault,
}

/// The mistake in a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineFault {
    /// A quote is not closed, or nothing follows the name.
    NoLine,
    /// There is no key, or none that can be read.
    NoKey,
    /// An option that is not known, is given twice, or is written otherwise than it must be.
    Option,
    /// A moment that is none, or an end before the beginning.
    Moment,
}

impl LineFault {
    /// The key of its text.
    pub fn key(self) -> &'static str {
        match self {
            LineFault::NoLine => "signing.fault.no_line",
            LineFault::NoKey => "signing.fault.no_key",
            LineFault::Option => "signing.fault.option",
            LineFault::Moment => "signing.fault.moment",
        }
    }
}

/// Whether a key may sign.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Standing<'a> {
    /// It may, for this owner.
    Allowed(&'a str),
    /// It stands in this line, which does not let it sign.
    Refused(usize, Refusal),
    /// It is not in the list.
    Unknown,
}

/// Why a line does not let its key sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// The key is for signatures of another purpose.
    Namespace,
    /// It is not valid yet.
    NotYet,
    /// It is not valid any more.
    Expired,
    /// It signs keys, not results.
    Authority,
    /// Every name of the line is excluded, or who is excluded cannot be told from who is not.
    Nobody,
}

impl Refusal {
    /// The key of its text.
    pub fn key(self) -> &'static str {
        match self {
            Refusal::Namespace => "signing.refusal.namespace",
            Refusal::NotYet => "signing.refusal.not_yet",
            Refusal::Expired => "signing.refusal.expired",
            Refusal::Authority => "signing.refusal.authority",
            Refusal::Nobody => "signing.refusal.nobody",
        }
    }
}

#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Options {
    authority: bool,
    namespaces: Option<String>,
    valid_after: Option<DateTime<Utc>>,
    valid_before: Option<DateTime<Utc>>,
}

impl Signers {
    /// Reads a list.
    ///
    /// # Errors
    /// As [`read_file`].
    pub fn read(path: &Path) -> io::Result<Signers> {
        Ok(Signers::of_text(&String::from_utf8_lossy(&read_file(path, MAX_LIST_BYTES)?)))
    }

    /// The list in a text.
    pub fn of_text(text: &str) -> Signers {
        let mut signers = Signers::default();
        for (i, line) in text.split('\n').enumerate() {
            let number = i + 1;
            match parse(line) {
                Ok(None) => {}
                Ok(Some((principals, key, options))) => {
                    signers.lines.push(Line { number, principals, key, options });
                }
                Err(fault) => signers.passed_over.push(BadLine { line: number, fault }),
            }
        }
        signers
    }

    /// Whether a key may sign at a moment: by the first line that lets it, or else what the first line with it says.
    pub fn standing(&self, key: &PublicKey, at: DateTime<Utc>) -> Standing<'_> {
        let of_key: Vec<&Line> = self.lines.iter().filter(|l| l.key.key_data() == key.key_data()).collect();
        let mut refused = Standing::Unknown;
        for line in of_key {
            match line.owner(at) {
                Ok(owner) => return Standing::Allowed(owner),
                Err(why) if refused == Standing::Unknown => refused = Standing::Refused(line.number, why),
                Err(_) => {}
            }
        }
        refused
    }
}

impl Line {
    /// For whom the line lets its key sign at a moment.
    fn owner(&self, at: DateTime<Utc>) -> Result<&str, Refusal> {
        let options = &self.options;
        // A key that signs other keys stands for none itself; signatures here are made by plain keys.
        if options.authority {
            return Err(Refusal::Authority);
        }
        let is_for = |list: &String| matches_list(SIGNATURE_NAMESPACE, list) == Listed::Yes;
        if !options.namespaces.as_ref().is_none_or(is_for) {
            return Err(Refusal::Namespace);
        }
        if options.valid_after.is_some_and(|after| at < after) {
            return Err(Refusal::NotYet);
        }
        if options.valid_before.is_some_and(|before| at > before) {
            return Err(Refusal::Expired);
        }
        // Nobody is asked for by name: a name that the line itself lets through, or the patterns where they exclude nobody.
        let names = || self.principals.split(',');
        let own = names().find(|name| {
            !name.contains(['*', '?', '!']) && !name.is_empty() && {
                matches_list(name, &self.principals) == Listed::Yes
            }
        });
        let excludes = names().any(|name| name.starts_with('!'));
        match own {
            Some(name) => Ok(name),
            None if excludes || names().all(str::is_empty) => Err(Refusal::Nobody),
            None => Ok(&self.principals),
        }
    }
}

/// What a line says; `None` for an empty one or a comment.
fn parse(line: &str) -> Result<Option<(String, PublicKey, Options)>, LineFault> {
    let line = line.trim_start_matches([' ', '\t', '\r']);
    if line.is_empty() || line.starts_with('#') {
        return Ok(None);
    }
    let (principals, rest) = first_word(line).ok_or(LineFault::NoLine)?;
    if let Some(key) = key(rest) {
        return Ok(Some((principals, key, Options::default())));
    }
    let end = end_of_options(rest).ok_or(LineFault::NoLine)?;
    let (options, rest) = rest.split_at_checked(end).ok_or(LineFault::NoKey)?;
    let key = key(rest.trim_start_matches([' ', '\t'])).ok_or(LineFault::NoKey)?;
    Ok(Some((principals, key, Options::parse(options)?)))
}

/// The first word of a line, of which a part may stand in quotes, and what follows it.
fn first_word(line: &str) -> Option<(String, &str)> {
    const SPACE_CHARS: [char; 4] = [' ', '\t', '\r', '\n'];
    let end = line.find(|c: char| SPACE_CHARS.contains(&c) || c == '"')?;
    let (before, rest) = line.split_at_checked(end)?;
    let (word, rest) = match rest.strip_prefix('"') {
        Some(quoted) => {
            let (inside, rest) = quoted.split_once('"')?;
            (format!("{before}{inside}"), rest)
        }
        None => (before.to_owned(), rest),
    };
    Some((word, rest.trim_start_matches(SPACE_CHARS)))
}

/// The key that a text begins with: its kind and itself. What follows is a comment.
fn key(text: &str) -> Option<PublicKey> {
    let mut words = text.split([' ', '\t', '\r']).filter(|word| !word.is_empty());
    let (kind, key) = (words.next()?, words.next()?);
    PublicKey::from_openssh(&format!("{kind} {key}")).ok()
}

/// Where the options end that a text begins with; `None` where a quote is not closed.
fn end_of_options(text: &str) -> Option<usize> {
    let (mut quoted, mut escaped) = (false, false);
    for (i, c) in text.char_indices() {
        match c {
            ' ' | '\t' if !quoted => return Some(i),
            '"' if !escaped => quoted = !quoted,
            _ => {}
        }
        escaped = c == '\\' && !escaped;
    }
    (!quoted).then_some(text.len())
}

impl Options {
    fn parse(text: &str) -> Result<Options, LineFault> {
        const AUTHORITY_OPTION: &str = "cert-authority";
        let mut options = Options::default();
        let mut rest = text.trim_end_matches('\r');
        loop {
            if let Some(after) = without_prefix(rest, AUTHORITY_OPTION) {
                options.authority = true;
                rest = after;
            } else {
                let (name, after) = rest.split_once('=').ok_or(LineFault::Option)?;
                let (value, after) = unquoted(after).ok_or(LineFault::Option)?;
                let twice = match name.to_ascii_lowercase().as_str() {
                    "namespaces" => options.namespaces.replace(value).is_some(),
                    "valid-after" => options.valid_after.replace(moment(&value)?).is_some(),
                    "valid-before" => options.valid_before.replace(moment(&value)?).is_some(),
                    _ => true,
                };
                if twice {
                    return Err(LineFault::Option);
                }
                rest = after;
            }
            if rest.is_empty() {
                break;
            }
            rest = rest.strip_prefix(',').filter(|more| !more.is_empty()).ok_or(LineFault::Option)?;
        }
        match (options.valid_after, options.valid_before) {
            (Some(after), Some(before)) if before <= after => Err(LineFault::Moment),
            _ => Ok(options),
        }
    }
}

/// What follows a word, whatever its case.
fn without_prefix<'a>(text: &'a str, word: &str) -> Option<&'a str> {
    let (head, rest) = text.split_at_checked(word.len())?;
    head.eq_ignore_ascii_case(word).then_some(rest)
}

/// A text in quotes, in which `\"` is one, and what follows it.
fn unquoted(text: &str) -> Option<(String, &str)> {
    let mut rest = text.strip_prefix('"')?;
    let mut out = String::new();
    loop {
        if let Some(after) = rest.strip_prefix("\\\"") {
            out.push('"');
            rest = after;
        } else if let Some(after) = rest.strip_prefix('"') {
            return Some((out, after));
        } else {
            let c = rest.chars().next()?;
            out.push(c);
            rest = rest.get(c.len_utf8()..)?;
        }
    }
}

/// A moment: `YYYYMMDD`, `YYYYMMDDHHMM` or `YYYYMMDDHHMMSS`, in the local time unless `Z` or `UTC` follows.
pub fn moment(text: &str) -> Result<DateTime<Utc>, LineFault> {
    let upper = text.to_ascii_uppercase();
    let universal = upper.strip_suffix('Z').or_else(|| upper.strip_suffix("UTC"));
    let digits = universal.unwrap_or(&upper);
    let whole = match digits.len() {
        8 => format!("{digits}000000"),
        12 => format!("{digits}00"),
        14 => digits.to_owned(),
        _ => return Err(LineFault::Moment),
    };
    if !whole.bytes().all(|b| b.is_ascii_digit()) {
        return Err(LineFault::Moment);
    }
    let at = NaiveDateTime::parse_from_str(&whole, "%Y%m%d%H%M%S").map_err(|_| LineFault::Moment)?;
    let at = match universal {
        Some(_) => at.and_utc(),
        None => Local.from_local_datetime(&at).earliest().ok_or(LineFault::Moment)?.to_utc(),
    };
    // Zero stands for no moment at all, and there are none before.
    if at.timestamp() > 0 { Ok(at) } else { Err(LineFault::Moment) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: &str = "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAINdamAGCsQq31Uv+08lkBzoO4XLz2qYjJa8CGmj3B1Ea";

    fn standing(list: &str) -> (String, Vec<BadLine>) {
        let signers = Signers::of_text(&list.replace("KEY", KEY));
        let at = moment("20260101Z").unwrap();
        let standing = match signers.standing(&PublicKey::from_openssh(KEY).unwrap(), at) {
            Standing::Allowed(owner) => owner.to_owned(),
            Standing::Refused(line, why) => {
                format!("{line} {}", why.key().rsplit('.').next().unwrap_or_default())
            }
            Standing::Unknown => "unknown".to_owned(),
        };
        (standing, signers.passed_over)
    }

    #[test]
    fn lines_let_their_owners_sign_or_say_why_not() {
        for (list, expected) in [
            ("# list\n\n anna@factory\tnamespaces=\"sagnac\" KEY anna", "anna@factory"),
            ("\"anna\" KEY\r\n", "anna"),
            ("!bob,anna KEY", "anna"),
            ("*@factory KEY", "*@factory"),
            ("*,!anna KEY", "1 nobody"),
            ("anna,!a* KEY", "1 nobody"),
            ("anna NameSpaces=\"git,sag*\" KEY", "anna"),
            ("anna namespaces=\"*,!sagnac\" KEY", "1 namespace"),
            ("anna valid-after=\"20270101\" KEY", "1 not_yet"),
            ("anna valid-before=\"202512312359Z\" KEY", "1 expired"),
            ("anna cert-authority KEY", "1 authority"),
            ("anna valid-before=\"20250101\" KEY\nberta KEY", "berta"),
        ] {
            assert_eq!(standing(list), (expected.to_owned(), vec![]), "{list}");
        }
    }

    #[test]
    fn lines_that_cannot_be_read_are_passed_over_and_named() {
        for (line, fault) in [
            ("anna", LineFault::NoLine),
            ("\"anna KEY", LineFault::NoLine),
            ("anna nothing", LineFault::NoKey),
            ("anna foo KEY", LineFault::Option),
            ("anna namespaces=sagnac KEY", LineFault::Option),
            ("anna namespaces=\"sagnac\", KEY", LineFault::Option),
            ("anna namespaces=\"a\",namespaces=\"sagnac\" KEY", LineFault::Option),
            ("anna valid-after=\"20261301\" KEY", LineFault::Moment),
            ("anna valid-after=\"19700101Z\" KEY", LineFault::Moment),
            ("anna valid-after=\"20260101\",valid-before=\"20250101\" KEY", LineFault::Moment),
        ] {
            assert_eq!(standing(line), ("unknown".to_owned(), vec![BadLine { line: 1, fault }]), "{line}");
            assert_eq!(standing(&format!("{line}\nanna KEY")).0, "anna", "{line}");
        }
    }
}
