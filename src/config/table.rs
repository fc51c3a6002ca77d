//! Structs that are tables: `#[derive(Table)]` makes the description and the reading of a table from one struct.
//!
//! The engine reads by the description, checks every value and fills in defaults; what is here only moves sound values
//! from a [`Section`] into the fields.

use super::diagnostics::Span;
use super::read_tables::entry_of_default;
use super::section::{Allowance, Entry, Look, Named, Section, Taus};
use super::spec::{KeySpec, Kind, Need, Range, TableSpec};
use crate::i18n::LocalText;
use crate::measurand::Measurand;
use crate::recording::ColumnRef;
use crate::units::Unit;
use chrono::NaiveDate;
pub(crate) use sagnac_table_derive::Table;
use std::path::PathBuf;

/// A struct that is a table of a file, or a group of keys that several tables share.
pub(crate) trait Table: Default {
    /// Its description.
    const SPEC: &'static TableSpec;

    /// Version of the format, as a file states it; empty for what is no file.
    const FORMAT: &'static str = "";

    /// The values of a table that was read. Where a key that must be there is missing or unsound, which was reported, a field
    /// is empty: the file is refused then.
    fn read(section: &Section) -> Self;

    /// True when a field takes what the engine reads under a key.
    #[cfg(test)]
    fn takes(key: &str, entry: &Entry) -> bool;
}

/// The type of a field.
pub(crate) trait KeyValue: Sized {
    /// Kind of a key of this type, where its attribute does not say more.
    const VALUE_KIND: Kind;

    /// The value of an entry; `None` for one of another kind, such as that of an unsound value.
    fn of(entry: &Entry) -> Option<Self>;
}

/// The value of a key: as it stands in the file, or its default where it is left out; empty where it is unsound.
pub(crate) fn value<T: KeyValue + Default>(
    section: &Section,
    keys: &'static [KeySpec],
    name: &'static str,
) -> T {
    let value = match section.entry(name) {
        Some(entry) => T::of(entry),
        None => keys.iter().find(|key| key.name == name).and_then(entry_of_default).as_ref().and_then(T::of),
    };
    value.unwrap_or_default()
}

/// A table in which no key stands: every default.
pub(crate) fn empty<T: Table>() -> T {
    T::read(&Section::default())
}

/// The table in an entry.
pub(crate) fn nested<T: Table>(entry: &Entry) -> Option<T> {
    match entry {
        Entry::Table(section) => Some(T::read(section)),
        _ => None,
    }
}

/// Number of keys in parts of a table.
pub(crate) const fn count(parts: &[&[KeySpec]]) -> usize {
    let (mut sum, mut part) = (0, 0);
    while part < parts.len() {
        sum += parts[part].len();
        part += 1;
    }
    sum
}

/// The keys of all parts of a table.
pub(crate) const fn joined<const COUNT: usize>(parts: &[&[KeySpec]]) -> [KeySpec; COUNT] {
    let empty = KeySpec { name: "", kind: Kind::Flag, need: Need::Optional, example: "", doc: "" };
    let mut keys = [empty; COUNT];
    let (mut at, mut part) = (0, 0);
    while part < parts.len() {
        let mut key = 0;
        while key < parts[part].len() {
            keys[at] = parts[part][key];
            at += 1;
            key += 1;
        }
        part += 1;
    }
    keys
}

/// Types whose entries hold exactly them.
macro_rules! entries {
    ($($ty:ty: $kind:expr, $entry:pat => $value:expr;)*) => {$(
        impl KeyValue for $ty {
            const VALUE_KIND: Kind = $kind;

            fn of(entry: &Entry) -> Option<$ty> {
                match entry {
                    $entry => Some($value),
                    _ => None,
                }
            }
        }
    )*};
}

entries! {
    bool: Kind::Flag, Entry::Flag(flag) => *flag;
    String: Kind::Text, Entry::Text(text) => text.clone();
    LocalText: Kind::LocalText, Entry::LocalText(text) => text.clone();
    NaiveDate: Kind::Date, Entry::Date(date) => *date;
    Unit: Kind::UnitText, Entry::Unit(unit) => unit.clone();
    ColumnRef: Kind::Column, Entry::Column(column) => column.clone();
    Taus: Kind::Taus, Entry::Taus(taus) => taus.clone();
    Vec<Look>: Kind::Looks, Entry::Looks(looks) => looks.clone();
    Allowance: Kind::Allowance, Entry::Allowance(allowance) => *allowance;
    &'static Measurand: Kind::Measurand, Entry::Measurand(measurand) => measurand;
    Vec<(&'static Measurand, f64, Span)>: Kind::QuantityMap, Entry::Quantities(list) => list.clone();
    PathBuf: Kind::Text, Entry::Text(path) => path.into();
    // A word is one of those that its key lists.
    &'static str: Kind::Choice(&[]), Entry::Word(word) => word;
    Vec<&'static str>: Kind::Choices(&[]), Entry::Words(words) => words.clone();
    Vec<String>: Kind::Columns(&[]), Entry::Names(names) => names.clone();
    Vec<Named>: Kind::Values, Entry::Values(values) => values.clone();
    f64: Kind::Number(Range::ANY), Entry::Number(number) | Entry::AsRecorded(number, _) => *number;
    u64: Kind::Number(Range::NOT_NEGATIVE), Entry::Number(number) => *number as u64;
    usize: Kind::Number(Range::NOT_NEGATIVE), Entry::Number(number) => *number as usize;
    Vec<f64>: Kind::Numbers(Range::ANY), Entry::Numbers(numbers) => numbers.clone();
}

/// Makes an enum the value of a key, and lists of it: the words of the key, and the value of a word.
macro_rules! words {
    ($ty:ty, $words:expr, $of:expr) => {
        impl $crate::config::table::KeyValue for $ty {
            const VALUE_KIND: $crate::config::spec::Kind = $crate::config::spec::Kind::Choice($words);

            fn of(entry: &$crate::config::section::Entry) -> Option<$ty> {
                match entry {
                    $crate::config::section::Entry::Word(word) => $of(word),
                    _ => None,
                }
            }
        }

        impl $crate::config::table::KeyValue for Vec<$ty> {
            const VALUE_KIND: $crate::config::spec::Kind = $crate::config::spec::Kind::Choices($words);

            fn of(entry: &$crate::config::section::Entry) -> Option<Vec<$ty>> {
                match entry {
                    $crate::config::section::Entry::Words(words) => {
                        Some(words.iter().filter_map(|word| $of(word)).collect())
                    }
                    _ => None,
                }
            }
        }
    };
}

pub(crate) use words;

impl<T: KeyValue> KeyValue for Option<T> {
    const VALUE_KIND: Kind = T::VALUE_KIND;

    fn of(entry: &Entry) -> Option<Option<T>> {
        T::of(entry).map(Some)
    }
}

/// A list of tables; one table alone counts as a list of one.
impl<T: Table> KeyValue for Vec<T> {
    const VALUE_KIND: Kind = Kind::Tables(T::SPEC);

    fn of(entry: &Entry) -> Option<Vec<T>> {
        match entry {
            Entry::Tables(sections) => Some(sections.iter().map(T::read).collect()),
            Entry::Table(section) => Some(vec![T::read(section)]),
            _ => None,
        }
    }
}

/// Asserts that the fields of a table take what its own examples and defaults are read as.
#[cfg(test)]
pub(crate) fn takes_what_it_describes<T: Table>() {
    for key in T::SPEC.keys {
        // The unit of such a value stands under another key.
        if let Kind::QuantityBy(by) = key.kind {
            assert!(T::SPEC.key(by).is_some() && T::takes(key.name, &Entry::Number(1.0)), "{}", key.name);
            continue;
        }
        let literals = [key.example, if let Need::Default(default) = key.need { default } else { "" }];
        for literal in literals.into_iter().filter(|literal| !literal.is_empty()) {
            let entry = super::read_tables::entry_of_literal(key, literal);
            assert!(entry.is_some_and(|entry| T::takes(key.name, &entry)), "{} = {literal}", key.name);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::diagnostics::SourceText;
    use crate::config::read_tables::checked;

    /// Places of a line.
    #[derive(Debug, PartialEq, Table)]
    struct Ends {
        /// Beginning.
        #[key(quantity = "s", min = 0, example = "0 s")]
        from_s: f64,
        /// End.
        #[key(quantity = "s", above = 0, max = 100, default = "10 s", example = "20 s")]
        to_s: f64,
    }

    /// A file of every sort of key.
    #[derive(Debug, PartialEq, Table)]
    #[table("", format = "tested/1")]
    struct File {
        /// A count.
        #[key(min = 1, max = 9, default = 3, example = 4)]
        count: usize,
        #[key(flatten)]
        ends: Ends,
        /// A flag.
        #[key(default = true, example = false)]
        flag: bool,
        /// Parts of it.
        #[key(one_or_several)]
        part: Vec<Part>,
        /// Its options.
        #[key(optional)]
        options: Part,
    }

    /// A part.
    #[derive(Debug, PartialEq, Table)]
    #[table("part")]
    struct Part {
        /// A name.
        #[key(id, default = "x", example = "y")]
        name: String,
        /// A number.
        #[key(name = "value", example = 0.5)]
        given: Option<f64>,
    }

    static FILE: TableSpec = *File::SPEC;

    fn read(text: &str) -> (Option<File>, String) {
        let source = SourceText::new("f.toml", text.to_owned());
        let (file, problems) = checked(&source, &FILE, |root, _| File::read(root));
        (file, problems.to_string())
    }

    #[test]
    fn a_struct_is_read_with_its_defaults() {
        let (file, problems) = read("format = \"tested/1\"\nfrom = \"1 min\"\n[part]\nvalue = 2\n");
        let part = |given| Part { name: "x".into(), given };
        let ends = Ends { from_s: 60.0, to_s: 10.0 };
        let expected = File { count: 3, ends, flag: true, part: vec![part(Some(2.0))], options: part(None) };
        assert_eq!(file, Some(expected), "{problems}");
        let names: Vec<&str> = FILE.keys.iter().map(|k| k.name).collect();
        assert_eq!(names, ["format", "count", "from", "to", "flag", "part", "options"]);
    }

    #[test]
    fn what_is_missing_or_out_of_range_is_said_at_its_place() {
        let (file, problems) = read("format = \"tested/1\"\ncount = 12\nto = \"200 s\"\nflagg = true\n");
        assert_eq!(file, None);
        for said in ["f.toml:2:9", "f.toml:3:6", "f.toml:4:1", "`from`"] {
            assert!(problems.contains(said), "{said}: {problems}");
        }
        assert!(problems.contains("above 0 s and at most 100 s"), "{problems}");
    }

    #[test]
    fn a_default_stands_once() {
        let part = Part::default();
        assert_eq!((part.name.as_str(), File::default().ends.to_s), ("x", 10.0));
    }
}
