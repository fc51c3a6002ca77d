//! Quantities of several channels side by side: a line for each quantity, a column for each channel.

use super::rows::Row;
use serde::Serialize;

/// Channels that fit side by side on a page.
const MAX_COLUMNS: usize = 4;

/// Rows set out by channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Matrix {
    /// Channels, in the order of the record.
    pub channels: Vec<String>,
    /// One line for each quantity.
    pub rows: Vec<MatrixRow>,
}

/// One quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MatrixRow {
    /// Name of the quantity.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// How it was obtained, in words.
    pub method: String,
    /// One cell for each channel; none where the channel lacks the quantity.
    pub cells: Vec<Option<Row>>,
}

impl Matrix {
    /// Sets rows out by channel; `None` for one channel, for more than fit, or for a quantity that a channel has twice.
    pub fn new(rows: &[Row]) -> Option<Matrix> {
        let mut channels: Vec<String> = vec![];
        for row in rows {
            if !channels.contains(&row.channel) {
                channels.push(row.channel.clone());
            }
        }
        // Rows by zone or by ramp are a list, not a channel beside others.
        if !(2..=MAX_COLUMNS).contains(&channels.len()) || rows.iter().any(|r| r.is_part) {
            return None;
        }
        let mut lines: Vec<(&str, MatrixRow)> = vec![];
        for row in rows {
            let column = channels.iter().position(|c| *c == row.channel)?;
            let same = |(id, line): &(&str, MatrixRow)| *id == row.id && line.unit == row.unit;
            let at = lines.iter().position(same).unwrap_or_else(|| {
                let line = MatrixRow {
                    name: row.name.clone(),
                    unit: row.unit.clone(),
                    method: row.method.clone(),
                    cells: vec![None; channels.len()],
                };
                lines.push((&row.id, line));
                lines.len() - 1
            });
            let cell = lines.get_mut(at)?.1.cells.get_mut(column)?;
            if cell.is_some() {
                return None;
            }
            *cell = Some(row.clone());
        }
        Some(Matrix { channels, rows: lines.into_iter().map(|l| l.1).collect() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(id: &str, channel: &str) -> Row {
        Row {
            id: id.into(),
            channel: channel.into(),
            is_part: channel.contains('@'),
            name: id.into(),
            place: String::new(),
            bound: String::new(),
            method: String::new(),
            unit: String::new(),
            value: format!("{id} of {channel}"),
            interval: String::new(),
            identifiable: true,
            hint: String::new(),
            limit: String::new(),
            acceptance: String::new(),
            rule: String::new(),
            margin: String::new(),
            risk: String::new(),
            reference: String::new(),
            verdict: "none",
            verdict_word: String::new(),
            footnotes: vec![],
        }
    }

    #[test]
    fn no_row_is_lost_and_none_stands_under_another_channel() {
        let rows = [row("a", "x"), row("a", "y"), row("b", "y"), row("c", "x")];
        let matrix = Matrix::new(&rows).unwrap();
        assert_eq!(matrix.channels, ["x", "y"]);
        assert_eq!(matrix.rows.len(), 3);
        let cells: Vec<&Row> = matrix.rows.iter().flat_map(|r| r.cells.iter().flatten()).collect();
        assert_eq!(cells.len(), rows.len());
        for line in &matrix.rows {
            for (cell, channel) in line.cells.iter().zip(&matrix.channels) {
                assert!(cell.as_ref().is_none_or(|c| c.channel == *channel && c.name == line.name));
            }
        }
    }

    #[test]
    fn what_does_not_fit_side_by_side_stays_a_list() {
        assert_eq!(Matrix::new(&[row("a", "x"), row("b", "x")]), None);
        assert_eq!(Matrix::new(&[row("a", "x"), row("a", "x"), row("a", "y")]), None);
        let many: Vec<Row> = (0..5).map(|i| row("a", &i.to_string())).collect();
        assert_eq!(Matrix::new(&many), None);
    }
}
