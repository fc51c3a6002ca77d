//! The units of a lot against its quantities: a row for each unit, a column for each quantity with a limit.

use super::quantity::{Key, distinct, name, several, shown};
use crate::record::{LotUnit, MeasurandRecord};
use crate::report::page::{Column, Table, Value};
use crate::report::translator::Translator;

/// Most quantities that a page has room for, side by side.
const MOST_COLUMNS: usize = 12;

/// The units against the quantities.
pub struct Matrix<'a> {
    keys: Vec<Key<'a>>,
    /// The units, each with its row of every quantity; `None` where it has none.
    pub rows: Vec<(&'a LotUnit, Vec<Option<&'a MeasurandRecord>>)>,
}

impl<'a> Matrix<'a> {
    /// Of units in an order.
    pub fn new(units: &[&'a LotUnit]) -> Matrix<'a> {
        let keys = distinct(units.iter().flat_map(|u| &u.measurands).map(Key::of));
        let row = |u: &&'a LotUnit| {
            let of = |key: &Key<'a>| u.measurands.iter().find(|m| Key::of(m) == *key);
            (*u, keys.iter().map(of).collect())
        };
        Matrix { rows: units.iter().map(row).collect(), keys }
    }

    /// Names of the quantities, each with the unit of its numbers.
    pub fn heads(&self, words: Translator) -> Vec<String> {
        let several = several(self.keys.iter().map(|k| k.channel));
        let head = |(at, key): (usize, &Key<'_>)| {
            let unit = self.rows.iter().find_map(|(_, row)| row.get(at).copied().flatten());
            let unit = unit.map(|m| words.unit(&m.unit)).unwrap_or_default();
            let name = name(*key, several, words);
            if unit.is_empty() { name } else { format!("{name}, {unit}") }
        };
        self.keys.iter().enumerate().map(head).collect()
    }

    /// The table of a page, each value in the colour of its verdict; `None` without a quantity or with more than fit.
    pub(super) fn table(&self, words: Translator) -> Option<Table> {
        if self.keys.is_empty() || self.keys.len() > MOST_COLUMNS {
            return None;
        }
        let serials = self.rows.iter().map(|(unit, _)| unit.serial());
        let table = Table::new("units small", self.rows.len())
            .column(Column::text("serial", words.t("report.serial")), serials);
        let heads = self.heads(words).into_iter().enumerate();
        Some(heads.fold(table, |table, (at, head)| {
            let cells = self.rows.iter().map(|(_, row)| cell(row.get(at).copied().flatten(), words));
            table.column(Column::text("", head), cells.collect::<Vec<_>>())
        }))
    }
}

/// A value in the colour of its verdict; the word of the verdict where no value was found.
fn cell(row: Option<&MeasurandRecord>, words: Translator) -> Value {
    let Some(row) = row else { return Value::Empty };
    let printed = row.value.map(|value| match shown(row, value, words) {
        Value::Quantity(quantity) => quantity.printed,
        other => other.plain(),
    });
    Value::state(row.verdict.id(), printed.unwrap_or_else(|| words.verdict(row.verdict)))
}
