//! Checked values of a table, by key.

use super::diagnostics::Span;
use crate::i18n::LocalText;
use crate::measurand::Measurand;
use crate::recording::ColumnRef;
use crate::units::Unit;
use chrono::NaiveDate;
use std::collections::BTreeMap;

/// A checked value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Entry {
    Text(String),
    LocalText(LocalText),
    Flag(bool),
    Number(f64),
    /// A number in one of the units that a quantity has as it was recorded.
    AsRecorded(f64, &'static str),
    Numbers(Vec<f64>),
    Values(Vec<Named>),
    Date(NaiveDate),
    Word(&'static str),
    Words(Vec<&'static str>),
    Names(Vec<String>),
    Unit(Unit),
    Column(ColumnRef),
    Taus(Taus),
    Looks(Vec<Look>),
    Allowance(Allowance),
    Measurand(&'static Measurand),
    Quantities(Vec<(&'static Measurand, f64, Span)>),
    Table(Section),
    Tables(Vec<Section>),
}

/// A number or a list of numbers under a name that the reader does not know.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Named {
    pub name: String,
    /// Where the name stands.
    pub at: Span,
    pub given: Given,
    /// Where the value stands.
    pub span: Span,
}

/// What stands under such a name.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Given {
    Number(f64),
    List(Vec<f64>),
    Text(String),
}

/// A moment at which a growing test is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Look {
    /// After this much of the evaluated time, s.
    Time(f64),
    /// After this share of the full duration.
    Share(f64),
}

/// Averaging times asked for.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Taus {
    /// Powers of two times the sample interval.
    #[default]
    Octave,
    /// 1, 2, 5 per decade.
    Decade,
    /// Every multiple of the sample interval.
    All,
    /// Exactly these, s.
    List(Vec<f64>),
}

/// How many faults are tolerated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Allowance {
    /// At most this many.
    Count(u64),
    /// At most this share of the samples, 0 to 1.
    Share(f64),
}

impl Allowance {
    /// True when `count` faults among `samples` are tolerated.
    pub fn allows(self, count: u64, samples: u64) -> bool {
        match self {
            Allowance::Count(most) => count <= most,
            Allowance::Share(share) => count as f64 <= share * samples as f64,
        }
    }
}

impl std::fmt::Display for Allowance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Allowance::Count(count) => write!(f, "{count}"),
            // Ten digits hide the rounding of a per cent and no share that anyone writes.
            Allowance::Share(share) => write!(f, "{} %", (share * 1e12).round() / 1e10),
        }
    }
}

/// A table that was read: the values that are sound.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Section {
    /// Where the table begins.
    pub span: Span,
    pub entries: BTreeMap<&'static str, (Entry, Span)>,
}

impl Section {
    pub fn entry(&self, key: &str) -> Option<&Entry> {
        self.entries.get(key).map(|(entry, _)| entry)
    }

    /// Where a value stands; the table itself where there is none.
    pub fn span_of(&self, key: &str) -> Span {
        self.entries.get(key).map_or_else(|| self.span.clone(), |(_, span)| span.clone())
    }

    pub fn text(&self, key: &str) -> Option<String> {
        match self.entry(key) {
            Some(Entry::Text(text)) => Some(text.clone()),
            _ => None,
        }
    }

    pub fn flag(&self, key: &str) -> bool {
        matches!(self.entry(key), Some(Entry::Flag(true)))
    }

    pub fn number(&self, key: &str) -> Option<f64> {
        match self.entry(key) {
            Some(Entry::Number(number) | Entry::AsRecorded(number, _)) => Some(*number),
            _ => None,
        }
    }

    /// The unit of a number whose unit is as recorded.
    pub fn recorded_unit(&self, key: &str) -> Option<&'static str> {
        match self.entry(key) {
            Some(Entry::AsRecorded(_, unit)) => Some(unit),
            _ => None,
        }
    }

    pub fn word(&self, key: &str) -> Option<&'static str> {
        match self.entry(key) {
            Some(Entry::Word(word)) => Some(word),
            _ => None,
        }
    }

    pub fn measurand(&self, key: &str) -> Option<&'static Measurand> {
        match self.entry(key) {
            Some(Entry::Measurand(id)) => Some(id),
            _ => None,
        }
    }

    pub fn table(&self, key: &str) -> Option<&Section> {
        match self.entry(key) {
            Some(Entry::Table(section)) => Some(section),
            _ => None,
        }
    }

    /// The tables of a list; one table alone counts as a list of one.
    pub fn tables(&self, key: &str) -> &[Section] {
        match self.entry(key) {
            Some(Entry::Tables(sections)) => sections,
            Some(Entry::Table(section)) => std::slice::from_ref(section),
            _ => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_counts_samples_and_a_count_does_not() {
        assert!(Allowance::Share(0.001).allows(36, 36_000) && !Allowance::Share(0.001).allows(37, 36_000));
        assert!(Allowance::Count(0).allows(0, 5) && !Allowance::Count(0).allows(1, 36_000_000));
        assert_eq!(Allowance::Share(0.001).to_string(), "0.1 %");
    }
}
