//! What stands in a cell, or beside a label.

/// What stands in a cell or beside a label. Each form prints it in its own way.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Value {
    /// Nothing.
    #[default]
    Empty,
    /// A text as it is, such as a serial number.
    Text(String),
    /// A sentence, in which names between backticks are code.
    Sentence(String),
    /// A name as files have it.
    Code(String),
    /// A formula, in which letters behind an underscore stand below the line.
    Formula(String),
    /// A digest of a file, such as its SHA-256.
    Digest(String),
    /// A text, and the id that files have for it. A terminal shows the text alone.
    Named {
        /// Text.
        text: String,
        /// Id.
        id: String,
    },
    /// A text that leads to another page; a link in HTML alone.
    Link {
        /// Text.
        text: String,
        /// Address, relative to the page.
        to: String,
    },
    /// A verdict or a state.
    State(State),
    /// A number with its unit.
    Quantity(Quantity),
    /// A value with what belongs to it, such as a number with its interval.
    Detailed(Box<Detailed>),
    /// A value with the numbers of footnotes.
    Noted {
        /// Value.
        value: Box<Value>,
        /// Beginning of the marks of the footnotes.
        anchor: String,
        /// Numbers of the footnotes.
        notes: Vec<usize>,
    },
    /// A value that takes the place of the cell behind it too, which is empty.
    Wide(Box<Value>),
    /// Values one behind the other.
    Several {
        /// The values.
        values: Vec<Value>,
        /// What stands between them.
        between: &'static str,
    },
    /// Sentences; in their order where they are steps.
    List {
        /// The sentences.
        items: Vec<String>,
        /// True for steps.
        ordered: bool,
    },
}

/// A verdict or a state: pages and the terminal show its word in its colour, tables for programs its id.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct State {
    /// Id such as `pass`.
    pub id: String,
    /// Word of the language of the page.
    pub word: String,
}

/// A value with its details. Pages show all of it, the terminal and tables for programs the value alone.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Detailed {
    /// Value; empty where the details stand alone.
    pub value: Value,
    /// True for the value that a reader looks for in its row: it stands out.
    pub is_strong: bool,
    /// Details, in their order.
    pub details: Vec<Detail>,
}

/// A detail of a value.
#[derive(Debug, Clone, PartialEq)]
pub struct Detail {
    /// How it follows the value.
    pub joined: Joined,
    /// Detail itself; a number has its unit.
    pub value: Value,
}

/// How a detail follows its value: HTML sets units behind a comma and all others below the value, in small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Joined {
    /// Interval, in square brackets in Markdown.
    Interval,
    /// Remark, in round brackets in Markdown; several one after the other share the brackets.
    Remark,
    /// Further value, behind a semicolon in Markdown.
    Further,
    /// Unit, behind a comma.
    Unit,
}

/// A number with its unit: tables for programs have the number, all others what is printed of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Quantity {
    /// The number; absent where none was found, or where an interval is printed.
    pub number: Option<f64>,
    /// As printed, without the unit.
    pub printed: String,
    /// Unit as printed.
    pub unit: String,
}

impl Quantity {
    /// The printed number with its unit; empty where nothing is printed.
    pub fn whole(&self) -> String {
        if self.printed.is_empty() { String::new() } else { joined(&self.printed, &self.unit) }
    }
}

impl Value {
    /// A verdict or a state by its id and its word.
    pub fn state(id: impl Into<String>, word: impl Into<String>) -> Value {
        Value::State(State { id: id.into(), word: word.into() })
    }

    /// The same, standing out in its row.
    #[must_use]
    pub fn strong(self) -> Value {
        Value::Detailed(Box::new(Detailed { is_strong: true, ..self.detailed() }))
    }

    /// The same with a detail; without it where it is empty.
    #[must_use]
    pub fn detail(self, joined: Joined, value: impl Into<Value>) -> Value {
        let value = value.into();
        if value.plain().is_empty() {
            return self;
        }
        let mut detailed = self.detailed();
        detailed.details.push(Detail { joined, value });
        Value::Detailed(Box::new(detailed))
    }

    fn detailed(self) -> Detailed {
        match self {
            Value::Detailed(detailed) => *detailed,
            value => Detailed { value, ..Detailed::default() },
        }
    }

    /// The same with remarks; empty ones are left out.
    #[must_use]
    pub fn over(self, below: impl IntoIterator<Item = Value>) -> Value {
        below.into_iter().fold(self, |value, remark| value.detail(Joined::Remark, remark))
    }

    /// The value with the numbers of footnotes, whose marks begin with `anchor`.
    #[must_use]
    pub fn noted(self, anchor: &str, notes: Vec<usize>) -> Value {
        if notes.is_empty() {
            return self;
        }
        Value::Noted { value: Box::new(self), anchor: anchor.to_owned(), notes }
    }

    /// The value as one line of plain text, as a terminal has it.
    pub fn plain(&self) -> String {
        match self {
            Value::Empty => String::new(),
            Value::Text(text) | Value::Sentence(text) => text.clone(),
            Value::Code(text) | Value::Formula(text) | Value::Digest(text) => text.clone(),
            Value::Named { text, .. } | Value::Link { text, .. } => text.clone(),
            Value::State(state) => state.word.clone(),
            Value::Quantity(quantity) => quantity.whole(),
            Value::Detailed(detailed) => detailed.value.plain(),
            Value::Noted { value, .. } | Value::Wide(value) => value.plain(),
            Value::Several { values, between } => {
                values.iter().map(Value::plain).collect::<Vec<_>>().join(between)
            }
            Value::List { items, ordered: true } => items.join("; "),
            Value::List { items, ordered: false } => items.join(" "),
        }
    }

    /// The value as tables for programs have it: the same in every language where the texts are.
    pub fn for_programs(&self) -> String {
        match self {
            Value::State(state) => state.id.clone(),
            Value::Quantity(quantity) => {
                let number = quantity.number.filter(|v| v.is_finite());
                number.map(|v| format!("{v:e}")).unwrap_or_default()
            }
            Value::Detailed(detailed) => detailed.value.for_programs(),
            other => other.plain(),
        }
    }
}

impl From<String> for Value {
    fn from(text: String) -> Value {
        Value::Text(text)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Value {
        Value::Text(text.to_owned())
    }
}

impl From<Quantity> for Value {
    fn from(quantity: Quantity) -> Value {
        Value::Quantity(quantity)
    }
}

/// A number without a unit, for tables for programs alone.
impl From<Option<f64>> for Value {
    fn from(number: Option<f64>) -> Value {
        Value::Quantity(Quantity { number, ..Quantity::default() })
    }
}

/// A printed number with its printed unit.
pub fn joined(number: &str, unit: &str) -> String {
    match unit {
        "" => number.to_owned(),
        // Degrees, minutes and seconds of arc stand at the figure.
        "°" | "′" | "″" => format!("{number}{unit}"),
        _ => format!("{number}\u{202f}{unit}"),
    }
}
