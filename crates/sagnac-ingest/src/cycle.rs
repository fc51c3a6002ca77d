//! Several sensors in one table: their rows take turns, and a column says whose each is.

use crate::column::Column;
use sagnac_core::message::{Note, note};
use sagnac_core::recording::Role;

/// Words in the first rows of a column of text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Labels {
    /// Position of the column, from 0.
    pub column: usize,
    /// Its words, one a row.
    pub rows: Vec<String>,
}

/// Sensors whose rows take turns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sensors {
    /// Name of the column that tells them apart.
    pub column: String,
    /// What stands in it, in the order in which it comes first.
    pub values: Vec<String>,
}

/// Most sensors in one table.
const MAX_SENSORS: usize = 16;

/// Fewest rows from which turns are told.
const MIN_ROWS_OF_TURNS: usize = 16;

/// Words of names of columns that tell sensors apart.
const SENSOR_COLUMN_WORDS: &[&str] = &[
    "i",
    "id",
    "imu",
    "sensor",
    "sensorid",
    "device",
    "deviceid",
    "instance",
    "unit",
    "channel",
    "ch",
    "source",
    "index",
    "axis",
    "addr",
    "address",
    "node",
    "датчик",
    "канал",
    "прибор",
];

impl Sensors {
    /// What the table is, for the user.
    pub fn note(&self) -> Note {
        note!(
            "ingest.judged.sensors",
            column = self.column.as_str(),
            count = self.values.len(),
            values = self.values.join(", ")
        )
    }

    /// By which options each is read.
    pub fn hint(&self) -> Note {
        let options: Vec<String> =
            self.values.iter().take(4).map(|v| format!("--where {}={v}", self.column)).collect();
        note!("ingest.judged.hint_where", options = options.join(", "))
    }
}

/// The column by which sensors take turns: few whole numbers or words, another one in nearly every row, in the same order
/// again and again where no name says so.
pub(crate) fn find(columns: &[Column], values: &[Vec<f64>], labels: &[Labels]) -> Option<Sensors> {
    let mut candidates: Vec<(usize, Vec<String>)> = Vec::new();
    for (index, of) in values.iter().enumerate() {
        let whole = of.iter().all(|v| v.is_finite() && v.fract() == 0.0 && v.abs() < 1e9);
        if whole && of.len() >= MIN_ROWS_OF_TURNS {
            candidates.push((index, of.iter().map(f64::to_string).collect()));
        }
    }
    candidates.extend(
        labels.iter().filter(|l| l.rows.len() >= MIN_ROWS_OF_TURNS).map(|l| (l.column, l.rows.clone())),
    );
    let time = columns.iter().position(|c| c.numeric && c.inferred().role == Role::Time);
    let stamps = time.and_then(|t| values.get(t)).map(Vec::as_slice).unwrap_or_default();
    candidates.into_iter().find_map(|(index, rows)| {
        let column =
            columns.get(index).filter(|c| matches!(c.inferred().role, Role::Auxiliary | Role::Counter))?;
        let of = turns(&rows)?;
        let named = SENSOR_COLUMN_WORDS
            .contains(&column.name.to_lowercase().replace(|c: char| !c.is_alphanumeric(), "").as_str());
        let together = shared_stamps(stamps, of.len()) > 0.5;
        let text = labels.iter().any(|l| l.column == index);
        let tells = named || together || (text && is_periodic(&rows, of.len()));
        tells.then(|| Sensors { column: column.name.clone(), values: of })
    })
}

/// The values that take turns: 2 to 16, another one in at least every second row, each again and again.
fn turns(rows: &[String]) -> Option<Vec<String>> {
    let mut of: Vec<(String, usize)> = Vec::new();
    for row in rows {
        match of.iter().position(|(v, _)| v == row) {
            Some(place) => of.iter_mut().skip(place).take(1).for_each(|(_, n)| *n += 1),
            None if of.len() < MAX_SENSORS => of.push((row.clone(), 1)),
            None => return None,
        }
    }
    let changes = rows.iter().zip(rows.get(1..).unwrap_or_default()).filter(|(a, b)| a != b).count();
    let often = of.iter().all(|(_, n)| 4 * n * of.len() >= rows.len());
    (of.len() > 1 && often && 2 * changes >= rows.len() - 1).then(|| of.into_iter().map(|(v, _)| v).collect())
}

/// True where the values come in one order again and again.
fn is_periodic(rows: &[String], period: usize) -> bool {
    let pairs = rows.iter().zip(rows.get(period..).unwrap_or_default());
    let (mut all, mut same) = (0usize, 0usize);
    for (a, b) in pairs {
        all += 1;
        same += usize::from(a == b);
    }
    all > 0 && 10 * same >= 9 * all
}

/// Share of rows whose stamp is that of the row before, of those that can be where sensors share stamps.
fn shared_stamps(stamps: &[f64], sensors: usize) -> f64 {
    let equal = stamps.iter().zip(stamps.get(1..).unwrap_or_default()).filter(|(a, b)| a == b).count() as f64;
    let possible = stamps.len() as f64 * (1.0 - 1.0 / sensors as f64);
    if possible > 0.0 { equal / possible } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(name: &str) -> Column {
        Column {
            name: name.to_owned(),
            numeric: true,
            storage: "text".to_owned(),
            unit: None,
            epoch_s: None,
            rollover_s: None,
            judged: None,
        }
    }

    fn rows(of: impl Fn(usize) -> f64) -> Vec<f64> {
        (0..60).map(of).collect()
    }

    #[test]
    fn sensors_that_take_turns_are_found_and_nothing_else() {
        let paired = rows(|i| (i / 2) as f64 * 0.04);
        let even = rows(|i| i as f64 * 0.02);
        let find = |name: &str, time: &Vec<f64>, of: Vec<f64>| {
            super::find(&[column("time_s"), column(name)], &[time.clone(), of], &[]).map(|s| s.values)
        };
        let turn = || rows(|i| (i % 2) as f64);
        assert_eq!(find("I", &paired, turn()), Some(vec!["0".to_owned(), "1".to_owned()]));
        assert_eq!(find("what", &paired, turn()), Some(vec!["0".to_owned(), "1".to_owned()]));
        assert_eq!(find("sensor", &even, turn()), Some(vec!["0".to_owned(), "1".to_owned()]));
        // A flag that toggles, a phase, a counter of four bits, a temperature in whole degrees.
        assert_eq!(find("pps", &even, turn()), None);
        assert_eq!(find("phase", &even, rows(|i| (i / 20) as f64)), None);
        assert_eq!(find("temp", &even, rows(|i| 25.0 + (i / 30) as f64)), None);
        let words: Vec<String> = (0..60).map(|i| ["left", "right"][i % 2].to_owned()).collect();
        let labels = [Labels { column: 1, rows: words }];
        let found = super::find(&[column("time_s"), column("what")], &[even.clone(), vec![]], &labels);
        assert_eq!(found.map(|s| s.values), Some(vec!["left".to_owned(), "right".to_owned()]));
    }
}
