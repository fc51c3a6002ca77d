//! Reads a TOML file by its description: unknown keys, missing keys, types, units and ranges are checked here, all
//! at once, each with its place.

use super::diagnostics::{Problem, Problems, SourceText, Span};
use super::reader::{Reader, Value, example, meant, shorten};
use super::section::{Entry, Section};
use super::spec::{KeySpec, Kind, Need, TableSpec};
use super::values::UnitBy;
use super::{syntax, values};
use crate::i18n::{Arg, Lang, Note, lookup, note};
use crate::measurand::Measurand;
use crate::recording::Role;
use sagnac_core::spelling::nearest;
use std::collections::BTreeMap;
use toml::de::{DeTable, DeValue};

/// At most this many syntax errors are shown: a file that is no TOML at all has one in every line.
const MAX_SYNTAX_ERRORS: usize = 5;

/// Longest chain of dotted keys and nested brackets in one line that is handed to the TOML parser.
const MAX_DEPTH: usize = 500;

/// Reads a file by its description.
///
/// The section is there whenever the text is TOML at all, with the values that are sound; the problems tell the rest.
fn read(source: &SourceText, root: &'static TableSpec) -> (Option<Section>, Problems) {
    let mut reader = Reader { source, root, problems: Problems::default() };
    if let Some(problem) = too_deep(source) {
        return (None, problem.into());
    }
    let (table, errors) = DeTable::parse_recoverable(&source.text);
    if !errors.is_empty() {
        let mut found: Vec<(Span, &str)> =
            errors.iter().map(|e| (e.span().unwrap_or(0..0), e.message())).collect();
        found.sort_by_key(|(span, _)| span.start);
        let mut line_end = 0;
        for (span, said) in found {
            // What follows on the line of a mistake is most often its consequence.
            if span.start < line_end {
                continue;
            }
            reader.problems.list.push(syntax::problem(source, &span, said));
            if reader.problems.list.len() == MAX_SYNTAX_ERRORS {
                break;
            }
            let rest = source.text.get(span.start..).unwrap_or_default();
            line_end = span.start + rest.find('\n').map_or(rest.len(), |end| end + 1);
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

/// Reads by description, builds, and gives the value only when nothing forbids its use. The problems are all there
/// are, warnings among them, in the order of the text.
pub(crate) fn checked<T>(
    source: &SourceText,
    spec: &'static TableSpec,
    build: impl FnOnce(&Section, &mut Reader<'_>) -> T,
) -> (Option<T>, Problems) {
    let (root, problems) = read(source, spec);
    let Some(root) = root else { return (None, problems) };
    let mut reader = Reader { source, root: spec, problems };
    let value = build(&root, &mut reader);
    let mut problems = reader.problems;
    problems.sort();
    ((!problems.has_errors()).then_some(value), problems)
}

/// A file of another kind or version: one problem says it, in place of one for every key in it.
fn other_format(source: &SourceText, root: &TableSpec, table: &DeTable<'_>) -> Option<Problem> {
    let wanted = root.keys.iter().find_map(|k| match k.kind {
        Kind::Format(text) => Some(text),
        _ => None,
    })?;
    let value = table.get("format")?;
    let given = value.get_ref().as_str().filter(|given| *given != wanted)?;
    let message = note!("keyed.other_format", given = shorten(given));
    let help = note!("keyed.help.format", wanted);
    Some(source.error(&value.span(), message).help(help))
}

/// Refuses a text by its nesting before the parser sees it; [`super::text_file::source`] has bounded its size.
fn too_deep(source: &SourceText) -> Option<Problem> {
    let mut start = 0;
    for line in source.text.split('\n') {
        let depth = line.bytes().filter(|b| matches!(b, b'.' | b'[' | b'{')).count();
        if depth > MAX_DEPTH && !line.trim_start().starts_with('#') && nests(line) {
            return Some(source.error(&(start..start + line.len()), "keyed.too_deep"));
        }
        start += line.len() + 1;
    }
    None
}

/// True when the dots and brackets of a line outside quotes exceed the bound. Decimal points in a list nest nothing.
fn nests(line: &str) -> bool {
    let (mut quote, mut count) = (None, 0);
    for (i, c) in line.char_indices() {
        match (quote, c) {
            (None, '"' | '\'') => quote = Some(c),
            (Some(q), c) if c == q => quote = None,
            (None, '.') if is_decimal_point(line, i) => {}
            (None, '.' | '[' | '{') => count += 1,
            (None, '#') => break,
            _ => {}
        }
    }
    count > MAX_DEPTH
}

/// True for the dot of a number that a comma or a closing bracket follows, as no dotted key is.
fn is_decimal_point(line: &str, at: usize) -> bool {
    let bytes = line.as_bytes();
    let digits_before = bytes[..at].iter().rev().take_while(|b| b.is_ascii_digit()).count();
    let before = at.checked_sub(digits_before + 1).and_then(|i| bytes.get(i));
    let begins = matches!(before, Some(b'[' | b',' | b' ' | b'-' | b'+'));
    let after = bytes.get(at + 1..).unwrap_or_default();
    let number = |b: &&u8| b.is_ascii_digit() || matches!(b, b'e' | b'E' | b'-' | b'+');
    let end = after.iter().find(|b| !number(b));
    digits_before > 0 && begins && matches!(end, Some(b',' | b']'))
}

impl Reader<'_> {
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
            let entry =
                self.value(Value { key: described, toml: value.get_ref(), span: &value.span() }, &key.span());
            // A key that is there but wrong must not be reported as missing too.
            let entry = entry.unwrap_or(Entry::Flag(false));
            section
                .entries
                .insert(described.name, (entry, span_of_value(described, value.span(), key.span())));
        }
        self.missing_keys(spec, &mut section, &meant);
        for (described, by, value) in dependent {
            let entry = dependent_unit(&section, by).and_then(|unit| {
                values::quantity_by(
                    self,
                    Value { key: described, toml: value.get_ref(), span: &value.span() },
                    &unit,
                )
            });
            let entry = entry.unwrap_or(Entry::Flag(false));
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
                    let message =
                        self.placed("keyed.missing", "keyed.missing_in", spec).with("key", written(key));
                    let help = if key.example.is_empty() {
                        note!("keyed.help.add", key = written(key), doc = doc(key))
                    } else {
                        note!("keyed.help.add_example", example = example(key))
                    };
                    self.error(&section.span.clone(), message, Some(help));
                }
                Need::Default(_) => {
                    if let Some(entry) = entry_of_default(key) {
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
            Some(near) => meant(near),
            None => self
                .elsewhere(spec, key)
                .unwrap_or_else(|| note!("keyed.help.known", keys = known.join(", "))),
        };
        let message =
            self.placed("keyed.unknown_key", "keyed.unknown_key_in", spec).with("key", shorten(key));
        self.error(span, message, Some(help));
        near
    }

    /// Says where a key belongs that is known in another table.
    fn elsewhere(&self, spec: &TableSpec, key: &str) -> Option<Note> {
        let home = self.root.walk().into_iter().find(|t| t.name != spec.name && t.key(key).is_some())?;
        Some(if home.name.is_empty() {
            note!("keyed.help.at_beginning", key)
        } else {
            note!("keyed.help.belongs", key, table = self.header(home))
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

    /// The sentence about a key of the file itself, or the one about a key in a table.
    fn placed(&self, of_file: &'static str, in_table: &'static str, spec: &TableSpec) -> Note {
        if spec.name.is_empty() {
            Note::new(of_file)
        } else {
            Note::new(in_table).with("table", self.header(spec))
        }
    }

    fn value(&mut self, value: Value<'_>, key_span: &Span) -> Option<Entry> {
        match value.key.kind {
            Kind::Table(spec) => match value.toml {
                DeValue::Table(table) => Some(Entry::Table(self.table(spec, table, key_span))),
                _ => self.wrong(value),
            },
            Kind::Tables(spec) | Kind::TableOrTables(spec) => self.tables(spec, value, key_span),
            Kind::QuantityMap => match value.toml {
                DeValue::Table(table) => Some(Entry::Quantities(self.quantities(value.key, table))),
                _ => self.wrong(value),
            },
            _ => values::scalar(self, value),
        }
    }

    /// Reads a list of tables, or one table where that is allowed.
    fn tables(&mut self, spec: &'static TableSpec, value: Value<'_>, key_span: &Span) -> Option<Entry> {
        let Value { key, toml, span } = value;
        match toml {
            DeValue::Table(table) if matches!(key.kind, Kind::TableOrTables(_)) => {
                Some(Entry::Table(self.table(spec, table, key_span)))
            }
            DeValue::Table(_) => {
                let message = note!("keyed.is_list", key = key.name);
                let help = note!("keyed.help.write_tables", table = spec.name);
                self.error(key_span, message, Some(help));
                None
            }
            DeValue::Array(items) if items.is_empty() && key.need == Need::Required => {
                let message = note!("keyed.empty", key = key.name);
                let help = note!("keyed.help.add_table", table = spec.name);
                self.error(span, message, Some(help));
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
                            let _: Option<Entry> = self.wrong(value.with(other, &item.span()));
                        }
                    }
                }
                Some(Entry::Tables(sections))
            }
            _ => self.wrong(value),
        }
    }

    fn quantities(
        &mut self,
        key: &'static KeySpec,
        table: &DeTable<'_>,
    ) -> Vec<(&'static Measurand, f64, Span)> {
        let mut found = vec![];
        for (name, value) in table.iter() {
            let Some(id) = self.measurand(name.get_ref(), &name.span()) else { continue };
            let value_of = Value { key, toml: value.get_ref(), span: &value.span() };
            let read = values::quantity_by(self, value_of, &UnitBy::of(id));
            if let Some(Entry::Number(number) | Entry::AsRecorded(number, _)) = read {
                found.push((id, number, name.span()));
            }
        }
        found
    }
}

/// The value that a key has where it is left out; `None` where it has none.
pub(crate) fn entry_of_default(key: &'static KeySpec) -> Option<Entry> {
    match key.need {
        Need::Default(text) => entry_of_literal(key, text),
        _ => None,
    }
}

/// The value of a key that is written so.
pub(crate) fn entry_of_literal(key: &'static KeySpec, literal: &str) -> Option<Entry> {
    static NO_FILE: TableSpec = TableSpec { name: "", doc: "", keys: &[] };
    let source = SourceText::new("", literal.to_owned());
    let mut reader = Reader { source: &source, root: &NO_FILE, problems: Problems::default() };
    let value = DeValue::parse(literal).ok()?;
    reader.value(Value { key, toml: value.get_ref(), span: &(0..literal.len()) }, &(0..0))
}

/// The unit a dependent quantity is converted to; `None` when the key it depends on is unusable.
fn dependent_unit(section: &Section, by: &str) -> Option<UnitBy> {
    match section.entry(by)? {
        Entry::Measurand(id) => Some(UnitBy::of(id)),
        Entry::Word(role) => {
            let role = Role::ALL.iter().find(|r| r.id() == *role)?;
            match (role.internal_unit(), section.entry("unit")) {
                (Some(unit), _) => Some(UnitBy::Known(unit.to_owned())),
                (None, Some(Entry::Unit(unit))) => Some(UnitBy::Known(unit.text().to_owned())),
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

/// Purpose of a table: in words of the locale where it has them, else as it is described.
fn doc(key: &KeySpec) -> Arg {
    let id = format!("table_doc.{}", key.name);
    if lookup(Lang::En, &id).is_some() { Arg::Key(id) } else { Arg::from(key.doc) }
}
