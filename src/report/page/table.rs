//! A table: described once, column by column, and shown by every form.

use super::value::{Quantity, Value};

/// A table with a head.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Classes in HTML. With `cards` among them every cell has its head beside it on a narrow screen.
    pub class: &'static str,
    /// How HTML lays it out.
    pub in_html: Layout,
    /// How Markdown lays it out.
    pub in_markdown: Layout,
    /// True where the names of the rows have the units of their quantities: on pages, numbers stand without them.
    pub units_in_names: bool,
    /// Columns; the first one names the row.
    pub columns: Vec<Column>,
    /// Rows, each with a cell for every column.
    pub rows: Vec<Row>,
}

/// How the rows of a table are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Layout {
    /// In columns, with a head.
    #[default]
    Grid,
    /// A line or a paragraph for each, without a head.
    List,
}

/// A row.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Row {
    /// A cell for every column.
    pub cells: Vec<Value>,
    /// True for the one that was chosen of those that are compared.
    pub chosen: bool,
    /// True for a row whose first cell is the heading of those below it.
    pub is_heading: bool,
    /// Id by which signatures name what it is of; empty where they do not.
    pub id: String,
    /// Channel of what it is of.
    pub channel: String,
}

/// A column.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Column {
    /// Name in tables for programs.
    pub name: String,
    /// Head.
    pub head: String,
    /// Head on a terminal, where it is another one.
    pub short: Option<String>,
    /// On which side its cells are in line.
    pub align: Align,
    /// Class of its cells in HTML.
    pub class: &'static str,
    /// How a terminal shows it.
    pub on_terminal: OnTerminal,
    /// How it follows the cell before in a list.
    pub listed: Listed,
    /// True for the column of the units of the quantities before it. Where it is not shown, the units stand at the numbers.
    pub is_unit: bool,
    /// True for a column that tables for programs do not have.
    pub for_pages: bool,
}

/// On which side the cells of a column are in line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Align {
    /// Text.
    #[default]
    Left,
    /// Numbers.
    Right,
}

/// How a terminal shows a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OnTerminal {
    /// As a column.
    #[default]
    Shown,
    /// As a column, which is left out where not all columns fit: of several, the left one first.
    Optional,
    /// In brackets behind the cell before.
    Bracketed,
    /// Not at all.
    Hidden,
}

/// How a cell follows the one before where rows are listed.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Listed {
    /// Behind a colon.
    #[default]
    Beside,
    /// In brackets.
    Bracketed,
    /// On a line of its own, behind these words.
    Below(String),
}

impl Column {
    /// A column of text.
    pub fn text(name: impl Into<String>, head: impl Into<String>) -> Column {
        Column { name: name.into(), head: head.into(), ..Column::default() }
    }

    /// A column of numbers.
    pub fn number(name: impl Into<String>, head: impl Into<String>) -> Column {
        Column { align: Align::Right, ..Column::text(name, head) }
    }

    /// The column of the units of the quantities before it.
    pub fn unit(head: impl Into<String>) -> Column {
        Column { is_unit: true, on_terminal: OnTerminal::Hidden, ..Column::text("unit", head) }
    }

    /// The same with another head on a terminal.
    #[must_use]
    pub fn short(self, head: impl Into<String>) -> Column {
        Column { short: Some(head.into()), ..self }
    }

    /// The same with a class in HTML.
    #[must_use]
    pub fn class(self, class: &'static str) -> Column {
        Column { class, ..self }
    }

    /// The same, shown in another way on a terminal.
    #[must_use]
    pub fn on_terminal(self, on_terminal: OnTerminal) -> Column {
        Column { on_terminal, ..self }
    }

    /// The same, which tables for programs do not have.
    #[must_use]
    pub fn for_pages(self) -> Column {
        Column { for_pages: true, ..self }
    }

    /// The same, following in another way in a list.
    #[must_use]
    pub fn listed(self, listed: Listed) -> Column {
        Column { listed, ..self }
    }
}

impl Table {
    /// A table without columns, for so many rows.
    pub fn new(class: &'static str, rows: usize) -> Table {
        Table { class, rows: vec![Row::default(); rows], ..Table::default() }
    }

    /// The same with a column, whose cells are in the order of the rows.
    #[must_use]
    pub fn column<V: Into<Value>>(mut self, column: Column, cells: impl IntoIterator<Item = V>) -> Table {
        let mut cells = cells.into_iter();
        for row in &mut self.rows {
            row.cells.push(cells.next().map(Into::into).unwrap_or_default());
        }
        self.columns.push(column);
        self
    }

    /// The same with the units of the quantities before as a column.
    #[must_use]
    pub fn units(mut self, head: impl Into<String>) -> Table {
        for row in &mut self.rows {
            let unit = row.cells.iter().find_map(|cell| match cell {
                Value::Quantity(Quantity { unit, .. }) => Some(unit.clone()),
                _ => None,
            });
            row.cells.push(Value::Text(unit.unwrap_or_default()));
        }
        self.columns.push(Column::unit(head));
        self
    }

    /// The same with the units of the quantities in the names of the rows.
    #[must_use]
    pub fn units_in_names(self) -> Table {
        Table { units_in_names: true, ..self }
    }

    /// The same in other layouts than a grid.
    #[must_use]
    pub fn laid_out(self, in_html: Layout, in_markdown: Layout) -> Table {
        Table { in_html, in_markdown, ..self }
    }

    /// The columns of these names alone, in this order.
    #[must_use]
    pub fn only(&self, names: &[&str]) -> Table {
        let places: Vec<usize> =
            names.iter().filter_map(|name| self.columns.iter().position(|c| c.name == *name)).collect();
        self.picked(&places)
    }

    fn picked(&self, places: &[usize]) -> Table {
        let row = |row: &Row| Row {
            cells: places.iter().filter_map(|i| row.cells.get(*i).cloned()).collect(),
            ..row.clone()
        };
        Table {
            columns: places.iter().filter_map(|i| self.columns.get(*i).cloned()).collect(),
            rows: self.rows.iter().map(row).collect(),
            ..*self
        }
    }

    /// The columns with a property, in their order.
    #[must_use]
    pub fn with(&self, has: impl Fn(&Column) -> bool) -> Table {
        let places: Vec<usize> =
            self.columns.iter().enumerate().filter(|(_, c)| has(c)).map(|(i, _)| i).collect();
        self.picked(&places)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_picked_by_name_and_order() {
        let table = Table::new("", 2)
            .column(Column::text("a", "A"), ["1", "2"])
            .column(Column::text("b", "B"), ["3"])
            .only(&["b", "none", "a"]);
        assert_eq!(table.columns.iter().map(|c| c.head.as_str()).collect::<Vec<_>>(), ["B", "A"]);
        assert_eq!(table.rows[1].cells, [Value::Empty, Value::from("2")]);
    }

    #[test]
    fn units_are_those_of_the_quantities() {
        let quantity = Quantity { number: Some(1.0), printed: "1".into(), unit: "°/h".into() };
        let table = Table::new("", 1).column(Column::number("v", "V"), [quantity]).units("Unit");
        assert_eq!(table.rows[0].cells[1], Value::from("°/h"));
        assert_eq!(table.with(|c| !c.is_unit).columns.len(), 1);
    }
}
