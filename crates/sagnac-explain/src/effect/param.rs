//! Parameters of effects and the values that a claim states for them.

use std::collections::BTreeMap;

/// One parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Param {
    /// Name in files; ends in the unit.
    pub name: &'static str,
    /// Unit as reports print it; empty for a pure number.
    pub unit: &'static str,
    /// Lowest plausible value.
    pub lower: f64,
    /// Highest plausible value.
    pub upper: f64,
    /// True when explanations report it; others serve the forward model alone.
    pub reported: bool,
    /// True when its sign has a meaning: reports print the plus.
    pub signed: bool,
    /// True for a whole number: reports print no decimals.
    pub whole: bool,
    /// True when it is an instant of the record, of which another record has another.
    pub instant: bool,
    /// Of a count of events that come by chance: the variance of the count over its mean. 1 where they come one by one.
    pub count: Option<f64>,
    /// True when a claim states the same quantity, so that the effect corrects a stated value and adds nothing new.
    pub corrects_claim: bool,
}

impl Param {
    /// A parameter that reports give.
    pub const fn reported(name: &'static str, unit: &'static str, lower: f64, upper: f64) -> Param {
        Param {
            name,
            unit,
            lower,
            upper,
            reported: true,
            signed: false,
            whole: false,
            instant: false,
            count: None,
            corrects_claim: false,
        }
    }

    /// A parameter that only the forward model needs.
    pub const fn inner(name: &'static str, unit: &'static str, lower: f64, upper: f64) -> Param {
        Param { reported: false, ..Param::reported(name, unit, lower, upper) }
    }

    /// A copy whose sign has a meaning.
    pub const fn signed(self) -> Param {
        Param { signed: true, ..self }
    }

    /// A copy that is a whole number.
    pub const fn whole(self) -> Param {
        Param { whole: true, ..self }
    }

    /// A copy that is an instant of the record.
    pub const fn instant(self) -> Param {
        Param { instant: true, ..self }
    }

    /// A copy that counts events which come by chance in groups of about `together`.
    pub const fn count(self, together: f64) -> Param {
        Param { whole: true, count: Some(together), ..self }
    }

    /// A copy that corrects a value which a claim states under this name.
    pub const fn corrects_claim(self) -> Param {
        Param { corrects_claim: true, ..self }
    }
}

/// A stated value of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A list, for courses that no few numbers describe.
    List(Vec<f64>),
    /// A text, such as the name of a column.
    Text(String),
}

/// Stated parameters by name.
pub type Values = BTreeMap<String, Value>;

/// The number of a name; `None` where there is none.
pub fn number(values: &Values, name: &str) -> Option<f64> {
    match values.get(name) {
        Some(Value::Number(x)) => Some(*x),
        _ => None,
    }
}

/// The text of a name; `None` where there is none.
pub fn text<'a>(values: &'a Values, name: &str) -> Option<&'a str> {
    match values.get(name) {
        Some(Value::Text(x)) => Some(x),
        _ => None,
    }
}

/// The list of a name; empty where there is none.
pub fn list<'a>(values: &'a Values, name: &str) -> &'a [f64] {
    match values.get(name) {
        Some(Value::List(x)) => x,
        _ => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_lists_are_told_apart() {
        let values = Values::from([
            ("size".to_owned(), Value::Number(2.0)),
            ("times".to_owned(), Value::List(vec![1.0, 3.0])),
        ]);
        assert_eq!((number(&values, "size"), number(&values, "times")), (Some(2.0), None));
        assert_eq!((list(&values, "times"), list(&values, "size")), (&[1.0, 3.0][..], &[][..]));
        let count = Param::reported("missing_rows", "", 1.0, 1e7).count(10.0);
        assert!(count.whole && count.count == Some(10.0) && !count.instant && count.reported);
    }
}
