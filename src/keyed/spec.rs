//! How a table of a TOML file is described: once, as data.
//!
//! Reading with its checks, the JSON Schema for editors and the key reference of the guide all come from these
//! descriptions, so that none can differ from another.

/// A table and its keys.
#[derive(Debug)]
pub struct TableSpec {
    /// Path of the table as it is written, for example `conditions.temperature`.
    pub name: &'static str,
    /// What it declares.
    pub doc: &'static str,
    /// Its keys, in the order of the documentation.
    pub keys: &'static [KeySpec],
}

/// One key.
#[derive(Debug)]
pub struct KeySpec {
    /// Name.
    pub name: &'static str,
    /// What its value must be.
    pub kind: Kind,
    /// Whether it must be there.
    pub need: Need,
    /// A value as it is written in TOML; empty for tables.
    pub example: &'static str,
    /// What it means.
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

    /// The range in words, with a unit behind each number. Of a pure number (unit `1`) it speaks in per cent.
    pub fn describe(&self, unit: &str) -> String {
        let percent = unit == "1";
        let shown = |value: f64| match unit {
            "" => value.to_string(),
            "1" => format!("{} %", value * 100.0),
            unit => format!("{value} {unit}"),
        };
        let low = if self.open { "above" } else { "at least" };
        match (self.low > f64::MIN, self.high < f64::MAX) {
            (false, false) if percent => "any finite share".to_owned(),
            (false, false) => "any finite number".to_owned(),
            (true, false) => format!("{low} {}", shown(self.low)),
            (false, true) => format!("at most {}", shown(self.high)),
            (true, true) => format!("{low} {} and at most {}", shown(self.low), shown(self.high)),
        }
    }
}

/// One of the words a key may have, with its meaning.
pub type Word = (&'static str, &'static str);

/// What a value must be.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// A text that is not blank.
    Text,
    /// The version of the format: exactly this text.
    Format(&'static str),
    /// A name of letters, digits, `_`, `-` and `.`.
    Id,
    /// `true` or `false`.
    Flag,
    /// A number without unit.
    Number(Range),
    /// A date such as `2027-03-01`.
    Date,
    /// One of these words.
    Choice(&'static [Word]),
    /// A list of these words.
    Choices(&'static [Word]),
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

    /// What a value must be, in words.
    pub fn describe(self) -> String {
        match self {
            Kind::Text => "a text".to_owned(),
            Kind::Format(text) => format!("\"{text}\""),
            Kind::Id => "a name of letters, digits, `_`, `-` and `.`".to_owned(),
            Kind::Flag => "true or false".to_owned(),
            Kind::Number(range) => format!("a number, {}", range.describe("")),
            Kind::Date => "a date such as 2030-12-31".to_owned(),
            Kind::Choice(words) => words_in_quotes(words, " or "),
            Kind::Choices(words) => format!("a list of {}", words_in_quotes(words, ", ")),
            Kind::Quantity { unit, range, .. } => {
                let bounds =
                    if range == Range::ANY { String::new() } else { format!(", {}", range.describe(unit)) };
                format!("a text with number and unit ({}){bounds}", if unit == "1" { "%" } else { unit })
            }
            Kind::QuantityBy(key) => {
                format!("a text with number and unit, of the dimension that `{key}` needs")
            }
            Kind::QuantityMap => "a table from measurand ids to texts with number and unit".to_owned(),
            Kind::UnitText => "a unit such as \"deg/h\"".to_owned(),
            Kind::Column => "the name of a column, or its position counted from 1".to_owned(),
            Kind::Taus => {
                "\"octave\", \"decade\", \"all\", or a list of times such as [\"1 s\", \"10 s\"]".to_owned()
            }
            Kind::Allowance => "a count such as 10, or a share such as \"0.1 %\"".to_owned(),
            Kind::Measurand => "the id of a measurand".to_owned(),
            Kind::Table(_) => "a table".to_owned(),
            Kind::Tables(_) => "a list of tables".to_owned(),
            Kind::TableOrTables(_) => "a table or a list of tables".to_owned(),
        }
    }
}

fn words_in_quotes(words: &[Word], between: &str) -> String {
    words.iter().map(|(word, _)| format!("\"{word}\"")).collect::<Vec<_>>().join(between)
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

/// A key that must be there.
pub(crate) const fn required(
    name: &'static str,
    kind: Kind,
    example: &'static str,
    doc: &'static str,
) -> KeySpec {
    KeySpec { name, kind, need: Need::Required, example, doc }
}

/// A key that may be left out.
pub(crate) const fn optional(
    name: &'static str,
    kind: Kind,
    example: &'static str,
    doc: &'static str,
) -> KeySpec {
    KeySpec { name, kind, need: Need::Optional, example, doc }
}

/// A key with a value that holds when it is left out.
pub(crate) const fn with_default(
    name: &'static str,
    kind: Kind,
    default: &'static str,
    example: &'static str,
    doc: &'static str,
) -> KeySpec {
    KeySpec { name, kind, need: Need::Default(default), example, doc }
}

/// A quantity in a unit.
pub(crate) const fn quantity(unit: &'static str, range: Range) -> Kind {
    Kind::Quantity { unit, difference: false, range }
}

/// A difference or an uncertainty in a unit.
pub(crate) const fn difference(unit: &'static str, range: Range) -> Kind {
    Kind::Quantity { unit, difference: true, range }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_know_their_ends() {
        assert!(!Range::POSITIVE.holds(0.0) && Range::POSITIVE.holds(1e-300));
        assert!(Range::NOT_NEGATIVE.holds(0.0) && !Range::NOT_NEGATIVE.holds(-1e-300));
        assert!(!Range::ANY.holds(f64::NAN) && !Range::ANY.holds(f64::INFINITY));
        assert_eq!(Range::above_up_to(0.0, 0.5).describe(""), "above 0 and at most 0.5");
        assert_eq!(Range::POSITIVE.describe("s"), "above 0 s");
        assert_eq!(Range::between(0.0, 1.0).describe("1"), "at least 0 % and at most 100 %");
    }
}
