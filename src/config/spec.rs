//! How a table of a TOML file is described: once, as data. `#[derive(Table)]` makes the descriptions from structs.
//!
//! Reading with its checks, the JSON Schema for editors and the key reference of the guide all come from these
//! descriptions, so that none can differ from another.

use crate::i18n::{Note, note};

/// A table and its keys.
#[derive(Debug, Clone, Copy)]
pub struct TableSpec {
    /// Path of the table as it is written, for example `conditions.temperature`.
    pub name: &'static str,
    /// Its purpose.
    pub doc: &'static str,
    /// Its keys, in the order of the documentation.
    pub keys: &'static [KeySpec],
}

/// One key.
#[derive(Debug, Clone, Copy)]
pub struct KeySpec {
    /// Name.
    pub name: &'static str,
    /// Kind of its value.
    pub kind: Kind,
    /// Whether it must be there.
    pub need: Need,
    /// A value as it is written in TOML; empty for tables.
    pub example: &'static str,
    /// Its meaning.
    pub doc: &'static str,
}

/// Whether a key must be there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// It must.
    Required,
    /// It need not; leaving it out means that nothing is declared.
    Optional,
    /// It need not; leaving it out means this value, written as in TOML.
    Default(&'static str),
}

/// Values a number may have, in the unit of the key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Lowest value.
    pub low: f64,
    /// Highest value.
    pub high: f64,
    /// True when the lowest value itself is not allowed.
    pub open: bool,
}

impl Range {
    /// Any finite number.
    pub const ANY: Range = Range { low: f64::MIN, high: f64::MAX, open: false };
    /// Above zero.
    pub const POSITIVE: Range = Range { low: 0.0, high: f64::MAX, open: true };
    /// A part of a whole.
    pub const SHARE: Range = Range { low: 0.0, high: 1.0, open: false };
    /// Zero or above.
    pub const NOT_NEGATIVE: Range = Range { low: 0.0, high: f64::MAX, open: false };

    /// From `low` to `high`, both allowed.
    pub const fn between(low: f64, high: f64) -> Range {
        Range { low, high, open: false }
    }

    /// Above `low`, up to `high`.
    pub const fn above_up_to(low: f64, high: f64) -> Range {
        Range { low, high, open: true }
    }

    /// True when the value is inside.
    pub fn holds(&self, value: f64) -> bool {
        value.is_finite()
            && value <= self.high
            && if self.open { value > self.low } else { value >= self.low }
    }

    /// The range in words, with a unit behind each number, as a file has it. Of a pure number (unit `1`) it speaks in
    /// per cent.
    pub fn describe(&self, unit: &str) -> Note {
        let percent = unit == "1";
        let shown = |value: f64| match unit {
            "" => value.to_string(),
            "1" => format!("{} %", value * 100.0),
            unit => format!("{value} {unit}"),
        };
        let key = match (self.low > f64::MIN, self.high < f64::MAX, self.open) {
            (false, false, _) if percent => "keyed.range.share",
            (false, false, _) => "keyed.range.number",
            (true, false, true) => "keyed.range.above",
            (true, false, false) => "keyed.range.at_least",
            (false, true, _) => "keyed.range.at_most",
            (true, true, true) => "keyed.range.above_up_to",
            (true, true, false) => "keyed.range.between",
        };
        Note::new(key).with("low", shown(self.low)).with("high", shown(self.high))
    }
}

/// One of the words a key may have, with its meaning.
pub type Word = (&'static str, &'static str);

/// Kind of a value.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// A text that is not blank.
    Text,
    /// A text that is not blank, in one language for all or in several.
    LocalText,
    /// The same, and it may be blank.
    LocalRemark,
    /// The version of the format: exactly this text.
    Format(&'static str),
    /// A name of letters, digits, `_`, `-` and `.`.
    Id,
    /// `true` or `false`.
    Flag,
    /// A number without unit.
    Number(Range),
    /// A list of numbers without unit.
    Numbers(Range),
    /// A table of names that no list here holds, each with a number or a list of numbers.
    Values,
    /// A text that may be empty.
    Remark,
    /// A date such as `2027-03-01`.
    Date,
    /// One of these words.
    Choice(&'static [Word]),
    /// A list of these words.
    Choices(&'static [Word]),
    /// A list of names of columns, of which these words are known.
    Columns(&'static [Word]),
    /// A list of ids of effects of the catalogue, or `unknown`.
    Effects,
    /// A program and its arguments.
    Command,
    /// A number with its unit, in a text: `"20 degC"`.
    Quantity {
        /// Unit it is converted to.
        unit: &'static str,
        /// True for differences and uncertainties, which an offset of a temperature scale must not touch.
        difference: bool,
        /// Values allowed, in that unit.
        range: Range,
    },
    /// A number with its unit, whose dimension follows from another key of the same table.
    QuantityBy(&'static str),
    /// A table from measurand ids to numbers with units.
    QuantityMap,
    /// A unit such as `deg/h`.
    UnitText,
    /// A column: its name in the header, or its position counted from 1.
    Column,
    /// Averaging times: `"octave"`, `"decade"`, `"all"` or a list such as `["1 s", "10 s"]`.
    Taus,
    /// Moments of a growing test: `["10 h", "50 h"]`, or shares of its length such as `["10 %", 0.5, 1.0]`.
    Looks,
    /// A count such as `10`, or a share such as `"0.1 %"`.
    Allowance,
    /// The id of a measurand.
    Measurand,
    /// A table of its own.
    Table(&'static TableSpec),
    /// A list of tables, each under its own `[[name]]`.
    Tables(&'static TableSpec),
    /// One table, or a list of them.
    TableOrTables(&'static TableSpec),
}

impl Kind {
    /// The table below a key, when there is one.
    pub fn table(self) -> Option<&'static TableSpec> {
        match self {
            Kind::Table(t) | Kind::Tables(t) | Kind::TableOrTables(t) => Some(t),
            _ => None,
        }
    }

    /// The kind in words.
    pub fn describe(self) -> Note {
        match self {
            Kind::Text => note!("keyed.kind.text"),
            Kind::LocalText | Kind::LocalRemark => note!("local_text.kind"),
            Kind::Format(text) => note!("keyed.kind.quoted", text),
            Kind::Id => note!("keyed.kind.id"),
            Kind::Flag => note!("keyed.kind.flag"),
            Kind::Number(range) => note!("keyed.kind.number", range = range.describe("")),
            Kind::Numbers(range) => note!("keyed_more.numbers", range = range.describe("")),
            Kind::Values => note!("keyed_more.values"),
            Kind::Remark => note!("keyed.kind.text"),
            Kind::Date => note!("keyed.kind.date"),
            Kind::Choice(words) => one_of(words),
            Kind::Choices(words) => note!("keyed.kind.list_of", words = in_quotes(words)),
            Kind::Columns([]) => note!("proof_file.columns"),
            Kind::Columns(words) => note!("keyed.kind.columns", words = in_quotes(words)),
            Kind::Effects => note!("proof_file.effects"),
            Kind::Command => note!("watch_file.command"),
            Kind::Quantity { unit, range, .. } => {
                let shown = if unit == "1" { "%" } else { unit };
                if range == Range::ANY {
                    note!("keyed.kind.quantity", unit = shown)
                } else {
                    note!("keyed.kind.quantity_in", unit = shown, range = range.describe(unit))
                }
            }
            Kind::QuantityBy(key) => note!("keyed.kind.quantity_by", key),
            Kind::QuantityMap => note!("keyed.kind.quantity_map"),
            Kind::UnitText => note!("keyed.kind.unit"),
            Kind::Column => note!("keyed.kind.column"),
            Kind::Taus => note!("keyed.kind.taus"),
            Kind::Looks => note!("keyed.kind.looks"),
            Kind::Allowance => note!("keyed.kind.allowance"),
            Kind::Measurand => note!("keyed.kind.measurand"),
            Kind::Table(_) => note!("keyed.kind.table"),
            Kind::Tables(_) => note!("keyed.kind.tables"),
            Kind::TableOrTables(_) => note!("keyed.kind.table_or_tables"),
        }
    }
}

/// `"a" or "b" or "c"`.
fn one_of(words: &[Word]) -> Note {
    let mut words = words.iter().rev().map(|(word, _)| note!("keyed.kind.quoted", text = *word));
    let last = words.next().unwrap_or_else(|| note!("keyed.kind.text"));
    words.fold(last, |rest, word| note!("keyed.kind.or", word, rest))
}

fn in_quotes(words: &[Word]) -> String {
    words.iter().map(|(word, _)| format!("\"{word}\"")).collect::<Vec<_>>().join(", ")
}

impl TableSpec {
    /// The description of a key.
    pub fn key(&self, name: &str) -> Option<&'static KeySpec> {
        self.keys.iter().find(|k| k.name == name)
    }

    /// This table and every table below it, outermost first.
    pub fn walk(&'static self) -> Vec<&'static TableSpec> {
        let mut all = vec![self];
        for key in self.keys {
            if let Some(below) = key.kind.table() {
                all.extend(below.walk());
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::{Lang, Localize};

    #[test]
    fn ranges_know_their_ends() {
        assert!(!Range::POSITIVE.holds(0.0) && Range::POSITIVE.holds(1e-300));
        assert!(Range::NOT_NEGATIVE.holds(0.0) && !Range::NOT_NEGATIVE.holds(-1e-300));
        assert!(!Range::ANY.holds(f64::NAN) && !Range::ANY.holds(f64::INFINITY));
        assert_eq!(Range::above_up_to(0.0, 0.5).describe("").say(Lang::En), "above 0 and at most 0.5");
        assert_eq!(Range::POSITIVE.describe("s").say(Lang::En), "above 0 s");
        assert_eq!(Range::between(0.0, 1.0).describe("1").say(Lang::En), "at least 0 % and at most 100 %");
    }
}
