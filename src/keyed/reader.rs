//! Reads a TOML file by its description: unknown keys, missing keys, types, units and ranges are checked here, all
//! at once, each with its place.

use super::diagnostics::{Problem, Problems, SourceText, Span, nearest};
use super::section::{Entry, Section};
use super::spec::{KeySpec, Kind, Need, TableSpec};
use super::values;
use crate::ids::{self, MeasurandId};
use crate::recording::Role;
use std::collections::BTreeMap;
use toml::de::{DeTable, DeValue};

/// Largest file that is read, bytes. A procedure is a few kilobytes.
const LARGEST_FILE: usize = 1 << 20;

/// At most this many syntax errors are shown: a file that is no TOML at all has one in every line.
const SYNTAX_ERRORS: usize = 5;

/// Errors after which the reader stops looking for more.
const ENOUGH: usize = 200;

/// Longest chain of dotted keys and nested brackets in one line that is handed to the TOML parser.
const DEEPEST: usize = 500;

/// Reads a file by its description.
///
/// The section is there whenever the text is TOML at all, with the values that are sound; the problems tell the rest.
pub(crate) fn read(source: &SourceText, root: &'static TableSpec) -> (Option<Section>, Problems) {
    let mut reader = Reader { source, root, problems: Problems::default() };
    if let Some(problem) = unreadable(source) {
        return (None, problem.into());
    }
    let (table, errors) = DeTable::parse_recoverable(&source.text);
    if !errors.is_empty() {
        for error in errors.iter().take(SYNTAX_ERRORS) {
            let span = error.span().unwrap_or(0..0);
            let problem = source.error(&span, format!("this is not TOML: {}", plain(error.message())));
            reader.problems.list.push(with_syntax_help(problem));
        }
        reader.problems.sort();
        return (None, reader.problems);
    }
    if let Some(problem) = other_format(source, root, table.get_ref()) {
        return (None, problem.into());
    }
    let section = reader.table(root, table.get_ref(), &(0..0));
    reader.problems.sort();
    (Some(section), reader.problems)
}

/// A file of another kind or version: one problem says it, in place of one for every key in it.
fn other_format(source: &SourceText, root: &TableSpec, table: &DeTable<'_>) -> Option<Problem> {
    let wanted = root.keys.iter().find_map(|k| match k.kind {
        Kind::Format(text) => Some(text),
        _ => None,
    })?;
    let value = table.get("format")?;
    let given = value.get_ref().as_str().filter(|given| *given != wanted)?;
    let message = format!("`{}` is not a format that is read here", shorten(given));
    let help = format!("this kind of file begins with format = \"{wanted}\"");
    Some(source.error(&value.span(), message).help(help))
}

/// Refuses a text that is no procedure by its size or nesting, before the parser sees it.
fn unreadable(source: &SourceText) -> Option<Problem> {
    if source.text.len() > LARGEST_FILE {
        let message = format!("the file is larger than {LARGEST_FILE} bytes; a procedure is a few kilobytes");
        return Some(Problem::of_file(&source.name, message, None));
    }
    let mut start = 0;
    for line in source.text.split('\n') {
        let depth = line.bytes().filter(|b| matches!(b, b'.' | b'[' | b'{')).count();
        if depth > DEEPEST && !line.trim_start().starts_with('#') && nests(line) {
            return Some(source.error(&(start..start + line.len()), "this line is nested too deeply"));
        }
        start += line.len() + 1;
    }
    None
}

/// True when the dots and brackets of a line outside quotes exceed the bound.
fn nests(line: &str) -> bool {
    let (mut quote, mut count) = (None, 0);
    for c in line.chars() {
        match (quote, c) {
            (None, '"' | '\'') => quote = Some(c),
            (Some(q), c) if c == q => quote = None,
            (None, '.' | '[' | '{') => count += 1,
            (None, '#') => break,
            _ => {}
        }
    }
    count > DEEPEST
}

/// The parser's message without the part that speaks of its grammar.
fn plain(message: &str) -> &str {
    message.strip_suffix(", expected literal string").unwrap_or(message)
}

/// Adds what to do to the syntax errors that people make most.
fn with_syntax_help(problem: Problem) -> Problem {
    let help = if problem.message.contains("duplicate key") {
        "a key or table may stand only once; lists of tables are written [[name]]"
    } else if problem.message.contains("date") || problem.message.contains("time") {
        "dates are written without quotes: calibration_due = 2030-12-31"
    } else if problem.token.starts_with(|c: char| c.is_ascii_alphanumeric())
        || problem.message.contains("string")
    {
        "texts, and numbers with a unit, stand in double quotes: warm_up = \"30 min\""
    } else {
        return problem;
    };
    problem.help(help)
}

pub(crate) struct Reader<'s> {
    pub source: &'s SourceText,
    root: &'static TableSpec,
    pub problems: Problems,
}

impl<'s> Reader<'s> {
    /// Goes on with the problems found so far, for the checks that need the whole file.
    pub fn resume(source: &'s SourceText, root: &'static TableSpec, problems: Problems) -> Reader<'s> {
        Reader { source, root, problems }
    }
}

impl Reader<'_> {
    pub fn error(&mut self, span: &Span, message: impl Into<String>, help: Option<String>) {
        if self.problems.list.len() < ENOUGH {
            let mut problem = self.source.error(span, message);
            problem.help = help;
            self.problems.list.push(problem);
        }
    }

    fn table(&mut self, spec: &'static TableSpec, table: &DeTable<'_>, span: &Span) -> Section {
        let mut section = Section { span: span.clone(), entries: BTreeMap::new() };
        let mut dependent = vec![];
        let mut meant = vec![];
        for (key, value) in table.iter() {
            let Some(described) = spec.key(key.get_ref()) else {
                meant.extend(self.unknown_key(spec, key.get_ref(), &key.span()));
                continue;
            };
            if let Kind::QuantityBy(by) = described.kind {
                dependent.push((described, by, value));
                section.entries.insert(described.name, (Entry::Flag(true), key.span()));
                continue;
            }
            let entry = self.value(described, value.get_ref(), &value.span(), &key.span());
            // A key that is there but wrong must not be reported as missing too.
            let entry = entry.unwrap_or(Entry::Flag(false));
            section
                .entries
                .insert(described.name, (entry, span_of_value(described, value.span(), key.span())));
        }
        self.missing_keys(spec, &mut section, &meant);
        for (described, by, value) in dependent {
            let entry = dependent_unit(&section, by)
                .and_then(|unit| values::quantity_by(self, described, &unit, value.get_ref(), &value.span()));
            let entry = entry.map_or(Entry::Flag(false), Entry::Number);
            section.entries.insert(described.name, (entry, value.span()));
        }
        section
    }

    /// Reports required keys that are not there and fills in defaults. A key that was misspelt is not missing too.
    fn missing_keys(&mut self, spec: &'static TableSpec, section: &mut Section, meant: &[&str]) {
        for key in spec.keys {
            if section.entries.contains_key(key.name) {
                continue;
            }
            match key.need {
                Need::Optional => {}
                Need::Required if meant.contains(&key.name) => {}
                Need::Required => {
                    let message = format!("{} is missing{}", written(key), self.in_table(spec));
                    let example = if key.example.is_empty() {
                        format!("add {}: {}", written(key), key.doc)
                    } else {
                        format!("add for example: {} = {}", key.name, key.example)
                    };
                    self.error(&section.span.clone(), message, Some(example));
                }
                Need::Default(text) => {
                    let Ok(value) = DeValue::parse(text) else { continue };
                    if let Some(entry) = self.value(key, value.get_ref(), &section.span, &section.span) {
                        section.entries.insert(key.name, (entry, section.span.clone()));
                    }
                }
            }
        }
    }

    /// Reports an unknown key; gives the key that was meant, when one is near.
    fn unknown_key(&mut self, spec: &'static TableSpec, key: &str, span: &Span) -> Option<&'static str> {
        let known: Vec<&'static str> = spec.keys.iter().map(|k| k.name).collect();
        let near = nearest(key, known.iter().copied());
        let help = match near {
            Some(near) => format!("did you mean `{near}`?"),
            None => self.elsewhere(spec, key).unwrap_or_else(|| format!("known here: {}", known.join(", "))),
        };
        self.error(span, format!("unknown key `{}`{}", shorten(key), self.in_table(spec)), Some(help));
        near
    }

    /// Says where a key belongs that is known in another table.
    fn elsewhere(&self, spec: &TableSpec, key: &str) -> Option<String> {
        let home = self.root.walk().into_iter().find(|t| t.name != spec.name && t.key(key).is_some())?;
        Some(if home.name.is_empty() {
            format!("`{key}` stands at the beginning of the file, before the first table")
        } else {
            format!("`{key}` belongs in {}", self.header(home))
        })
    }

    /// A table as its header is written.
    fn header(&self, spec: &TableSpec) -> String {
        let listed = |k: &KeySpec| matches!(k.kind, Kind::Tables(t) if t.name == spec.name);
        if self.root.walk().iter().any(|t| t.keys.iter().any(listed)) {
            format!("[[{}]]", spec.name)
        } else {
            format!("[{}]", spec.name)
        }
    }

    fn in_table(&self, spec: &TableSpec) -> String {
        if spec.name.is_empty() { String::new() } else { format!(" in {}", self.header(spec)) }
    }

    fn value(
        &mut self,
        key: &'static KeySpec,
        value: &DeValue<'_>,
        span: &Span,
        key_span: &Span,
    ) -> Option<Entry> {
        match key.kind {
            Kind::Table(spec) => match value {
                DeValue::Table(table) => Some(Entry::Table(self.table(spec, table, key_span))),
                _ => self.wrong(key, value, span),
            },
            Kind::Tables(spec) | Kind::TableOrTables(spec) => match value {
                DeValue::Table(table) if matches!(key.kind, Kind::TableOrTables(_)) => {
                    Some(Entry::Table(self.table(spec, table, key_span)))
                }
                DeValue::Table(_) => {
                    let message = format!("`{}` is a list: there may be several", key.name);
                    self.error(key_span, message, Some(format!("write [[{}]]", spec.name)));
                    None
                }
                DeValue::Array(items) if items.is_empty() && key.need == Need::Required => {
                    self.error(
                        span,
                        format!("`{}` is empty", key.name),
                        Some(format!("add a [[{}]]", spec.name)),
                    );
                    None
                }
                DeValue::Array(items) => {
                    let mut sections = vec![];
                    for item in items.iter() {
                        match item.get_ref() {
                            DeValue::Table(table) => {
                                let start = item.span();
                                sections.push(self.table(spec, table, &first_line(self.source, &start)));
                            }
                            other => {
                                let _: Option<Entry> = self.wrong(key, other, &item.span());
                            }
                        }
                    }
                    Some(Entry::Tables(sections))
                }
                _ => self.wrong(key, value, span),
            },
            Kind::QuantityMap => match value {
                DeValue::Table(table) => Some(Entry::Quantities(self.quantities(key, table))),
                _ => self.wrong(key, value, span),
            },
            _ => values::scalar(self, key, value, span),
        }
    }

    fn quantities(
        &mut self,
        key: &'static KeySpec,
        table: &DeTable<'_>,
    ) -> Vec<(&'static MeasurandId, f64, Span)> {
        let mut found = vec![];
        for (name, value) in table.iter() {
            let Some(id) = self.measurand(name.get_ref(), &name.span()) else { continue };
            if let Some(number) = values::quantity_by(self, key, id.unit, value.get_ref(), &value.span()) {
                found.push((id, number, name.span()));
            }
        }
        found
    }

    /// Looks up a measurand, and says why when it cannot be used.
    pub fn measurand(&mut self, name: &str, span: &Span) -> Option<&'static MeasurandId> {
        match ids::find(name) {
            Some(id) if id.available => return Some(id),
            Some(id) => {
                let message = format!("`{name}` is not available in this version");
                self.error(span, message, Some(format!("it belongs to {}", id.test.title())));
            }
            None => {
                let usable = || ids::MEASURANDS.iter().filter(|m| m.available).map(|m| m.id);
                let help = match nearest(name, usable()) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => format!("measurands: {}", usable().collect::<Vec<_>>().join(", ")),
                };
                self.error(span, format!("unknown measurand `{}`", shorten(name)), Some(help));
            }
        }
        None
    }

    /// Reports a value of the wrong type.
    pub fn wrong<T>(&mut self, key: &KeySpec, value: &DeValue<'_>, span: &Span) -> Option<T> {
        let message = format!("`{}` must be {}, this is {}", key.name, key.kind.describe(), type_name(value));
        let help = if key.example.is_empty() {
            key.kind.table().map(|t| format!("write a table [{}] with its keys below it", t.name))
        } else {
            Some(format!("for example: {} = {}", key.name, key.example))
        };
        self.error(span, message, help);
        None
    }
}

/// The unit a dependent quantity is converted to; `None` when the key it depends on is unusable.
fn dependent_unit(section: &Section, by: &str) -> Option<String> {
    match section.entry(by)? {
        Entry::Measurand(id) => Some(id.unit.to_owned()),
        Entry::Word(role) => {
            let role = Role::ALL.iter().find(|r| r.id() == *role)?;
            match (role.internal_unit(), section.entry("unit")) {
                (Some(unit), _) => Some(unit.to_owned()),
                (None, Some(Entry::Unit(unit))) => Some(unit.text().to_owned()),
                _ => None,
            }
        }
        _ => None,
    }
}

fn span_of_value(key: &KeySpec, value: Span, name: Span) -> Span {
    if key.kind.table().is_some() { name } else { value }
}

/// The first line of a span: the header of a table.
fn first_line(source: &SourceText, span: &Span) -> Span {
    let text = source.text.get(span.clone()).unwrap_or("");
    span.start..span.start + text.find('\n').unwrap_or(text.len())
}

fn written(key: &KeySpec) -> String {
    match key.kind {
        Kind::Table(t) | Kind::TableOrTables(t) => format!("[{}]", t.name),
        Kind::Tables(t) => format!("[[{}]]", t.name),
        _ => format!("`{}`", key.name),
    }
}

/// A name short enough for a message.
pub(crate) fn shorten(name: &str) -> String {
    if name.chars().count() <= 60 {
        name.to_owned()
    } else {
        name.chars().take(57).chain("...".chars()).collect()
    }
}

fn type_name(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}
