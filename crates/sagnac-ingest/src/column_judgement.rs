//! What columns are by their first values, where names mislead or say too little: the scale of times, counters that count
//! nothing, quaternions, temperatures in kelvins, counts written without their sign, sensors that take turns.

use crate::column::Column;
use crate::column_inference::InferredColumn;
use crate::cycle::{self, Sensors};
use crate::time_scale::{self, Hints, TimeScale};
use sagnac_core::message::{Arg, Note, note};
use sagnac_core::recording::Role;
use sagnac_core::units::Unit;

/// First values of a column; NaN where a field is no number, nothing where the column was not read.
pub(crate) type FirstValues = Vec<f64>;

/// What the user or the header says that first values are weighed against.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stated {
    /// Unit of the time stamps, as the user gives it.
    pub time_unit: Option<Unit>,
    /// Sample rate that the file states, Hz.
    pub rate_hz: Option<f64>,
}

/// What first values show beside the columns themselves.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Judgement {
    /// What was decided, for the user.
    pub notes: Vec<Note>,
    /// Columns of two's complement without a sign, with the number of their values.
    pub unsigned: Vec<(usize, f64)>,
    /// Several sensors whose rows take turns.
    pub sensors: Option<Sensors>,
}

/// Fewest values from which a column is judged.
const MIN_JUDGED_VALUES: usize = 8;

/// Share of steps backwards from which a column is no clock.
const MAX_SHARE_BACKWARDS: f64 = 0.1;

/// Judges the columns of a file. `labels`: words in the first rows of columns of text.
pub(crate) fn judge(
    columns: &mut [Column],
    values: &[FirstValues],
    labels: &[cycle::Labels],
    stated: &Stated,
) -> Judgement {
    let mut found = Judgement::default();
    let quaternions = quaternions(columns, values);
    for (index, column) in columns.iter_mut().enumerate() {
        if column.judged.is_some() {
            continue;
        }
        let of = values.get(index).map(Vec::as_slice).unwrap_or_default();
        let judged = match column.by_name() {
            g if g.role == Role::Time => time(column, g, of, stated, &mut found.notes),
            g if g.role == Role::Counter && !counts(of) => Some(demoted(column, g, "guess.no_counter")),
            g if g.role == Role::Rate && quaternions.contains(&index) => {
                Some(demoted(column, g, "guess.quaternion"))
            }
            g if g.role == Role::Rate && !g.unit_is_named && is_letter_w(&column.name) && is_constant(of) => {
                Some(demoted(column, g, "guess.constant"))
            }
            g if g.role == Role::Temperature && !g.unit_is_named => kelvins(column, g, of),
            _ => None,
        };
        column.judged = judged.or_else(|| column.judged.take());
    }
    found.unsigned = unsigned(columns, values);
    for (index, values) in &found.unsigned {
        let name = columns.get(*index).map_or("", |c| c.name.as_str());
        let bits = values.log2().round();
        found.notes.push(note!("ingest.judged.unsigned", column = name, bits));
    }
    found.sensors = cycle::find(columns, values, labels);
    if let Some(sensors) = &found.sensors {
        found.notes.push(sensors.note());
    }
    found
}

/// The column without the role that its name speaks of.
fn demoted(column: &Column, guess: InferredColumn, key: &'static str) -> InferredColumn {
    let reason = Note::new(key).with("name", column.name.as_str());
    let unit = if guess.unit_is_named { guess.unit.clone() } else { one().unwrap_or(guess.unit.clone()) };
    InferredColumn { role: Role::Auxiliary, unit, reason, ..guess }
}

fn one() -> Option<Unit> {
    Unit::parse("1").ok()
}

/// Numbers among the values.
fn finite(values: &[f64]) -> impl Iterator<Item = f64> + '_ {
    values.iter().copied().filter(|v| v.is_finite())
}

fn is_constant(values: &[f64]) -> bool {
    let mut of = finite(values);
    let Some(first) = of.next() else { return false };
    values.len() >= MIN_JUDGED_VALUES && of.all(|v| v == first)
}

/// True unless the values show that they count nothing: whole numbers that grow by the same small step nearly always.
fn counts(values: &[f64]) -> bool {
    let of: Vec<f64> = finite(values).collect();
    if of.len() < MIN_JUDGED_VALUES {
        return values.len() < MIN_JUDGED_VALUES || !of.is_empty();
    }
    if of.iter().any(|v| v.fract() != 0.0) {
        return false;
    }
    let mut steps: Vec<f64> = of.iter().zip(of.get(1..).unwrap_or_default()).map(|(a, b)| b - a).collect();
    steps.sort_by(f64::total_cmp);
    let usual = steps.get(steps.len() / 2).copied().unwrap_or(0.0);
    let like = steps.iter().filter(|s| **s == usual).count();
    (1.0..=100.0).contains(&usual) && 10 * like >= 6 * steps.len()
}

/// True for names of one letter that may be a part of a quaternion: `w`, `q.w`.
fn is_letter_w(name: &str) -> bool {
    let last = name.rsplit(|c: char| !c.is_alphanumeric()).find(|w| !w.is_empty());
    last.is_some_and(|w| w.eq_ignore_ascii_case("w"))
}

/// A time column: one that does not go forward is none, and one whose unit nobody states gets the likeliest.
fn time(
    column: &mut Column,
    guess: InferredColumn,
    values: &[f64],
    stated: &Stated,
    notes: &mut Vec<Note>,
) -> Option<InferredColumn> {
    if column.epoch_s.is_some() || column.rollover_s.is_some() {
        return None;
    }
    let of: Vec<f64> = finite(values).collect();
    let is_bare = column.name.chars().filter(|c| c.is_alphanumeric()).count() == 1 && !guess.unit_is_named;
    if is_bare && of.len() >= MIN_JUDGED_VALUES && !goes_forward(&of) {
        // `T` is a temperature where it does not run.
        let like_degrees = of.iter().all(|v| (-100.0..200.0).contains(v));
        let role = if like_degrees { Role::Temperature } else { Role::Auxiliary };
        let unit = Unit::parse(role.internal_unit().unwrap_or("1")).ok()?;
        let key = if like_degrees { "guess.temperature_letter" } else { "guess.no_time" };
        return Some(InferredColumn {
            role,
            unit,
            reason: Note::new(key).with("name", column.name.as_str()),
            ..guess
        });
    }
    if values.len() >= MIN_JUDGED_VALUES && of.is_empty() && stated.rate_hz.is_some() {
        return Some(demoted(column, guess, "guess.no_value"));
    }
    let by_user = stated.time_unit.as_ref();
    let named = by_user.map(Unit::text).or_else(|| guess.unit_is_named.then(|| guess.unit.text()));
    let lower = column.name.to_lowercase();
    let unknown = named.is_none();
    let hints = Hints { name: &lower, unit: named, rate_hz: stated.rate_hz.filter(|_| unknown) };
    let scale = time_scale::find(&of, hints);
    if by_user.is_none() && !unknown {
        dated(column, scale);
        return None;
    }
    let note = |key: &'static str| Note::new(key).with("column", column.name.as_str());
    let judged = match (by_user, scale) {
        (Some(unit), _) => {
            notes.push(note("ingest.judged.time_unit_given").with("unit", unit.text()));
            InferredColumn { unit: unit.clone(), unit_is_named: true, reason: stated_unit(column), ..guess }
        }
        (None, Some(scale)) if scale.unit != "s" || scale.scale != 1.0 => {
            notes.push(said(column, &scale));
            let unit = Unit::parse(scale.unit).ok()?;
            InferredColumn {
                unit,
                scale: scale.scale,
                unit_is_named: true,
                reason: stated_unit(column),
                ..guess
            }
        }
        _ => {
            if let Some(epoch) = scale.and_then(|s| s.epoch) {
                notes.push(note("ingest.judged.epoch").with("epoch", Note::new(epoch.key())));
            }
            return None;
        }
    };
    dated(column, scale);
    Some(judged)
}

fn stated_unit(column: &Column) -> Note {
    note!("guess.time_scale", name = column.name.as_str())
}

/// Keeps the zero of the stamps where their size shows it beyond doubt: counted in s, GPS and Unix times are alike.
fn dated(column: &mut Column, scale: Option<TimeScale>) {
    let told = |s: &TimeScale| s.unit != "s" || s.scale != 1.0;
    if let Some(epoch) = scale.filter(told).and_then(|s| s.epoch) {
        column.epoch_s = Some(epoch.zero_s());
    }
}

/// What the scale of stamps is, and by which option another is given.
fn said(column: &Column, scale: &TimeScale) -> Note {
    let unit: Arg = if scale.scale == 1.0 {
        scale.unit.into()
    } else {
        note!("time_scale.parts", size = scale.scale, unit = scale.unit).into()
    };
    let note =
        |key: &'static str| Note::new(key).with("column", column.name.as_str()).with("unit", unit.clone());
    match scale.epoch {
        Some(epoch) => note("ingest.judged.time_unit_dated").with("epoch", Note::new(epoch.key())),
        None => note("ingest.judged.time_unit"),
    }
}

/// True where values grow nearly always; one that starts again now and then does.
fn goes_forward(values: &[f64]) -> bool {
    let steps = || values.iter().zip(values.get(1..).unwrap_or_default()).map(|(a, b)| b - a);
    let all = values.len().saturating_sub(1).max(1) as f64;
    let growing = steps().filter(|d| *d > 0.0).count() as f64;
    let falling = steps().filter(|d| *d < 0.0).count() as f64;
    growing > 0.0 && falling / all <= MAX_SHARE_BACKWARDS && growing / all > 0.02
}

/// A temperature without a unit: in kelvins where the values are those.
fn kelvins(column: &Column, guess: InferredColumn, values: &[f64]) -> Option<InferredColumn> {
    let warm =
        finite(values).count() >= MIN_JUDGED_VALUES && finite(values).all(|v| (200.0..420.0).contains(&v));
    let unit = Unit::parse("K").ok().filter(|_| warm)?;
    let reason = note!("guess.kelvin", name = column.name.as_str());
    Some(InferredColumn { unit, reason, ..guess })
}

/// Columns that are the four parts of unit quaternions: alike in name but for the last part, their squares sum to 1.
fn quaternions(columns: &[Column], values: &[FirstValues]) -> Vec<usize> {
    let part = |name: &str| -> Option<(String, usize)> {
        let last = name.chars().next_back()?.to_ascii_lowercase();
        let place = ["wxyz", "0123"].into_iter().find_map(|parts| parts.find(last))?;
        let mut stem: Vec<char> = name.chars().collect();
        stem.pop();
        Some((stem.into_iter().collect(), place))
    };
    let named: Vec<(usize, (String, usize))> =
        columns.iter().enumerate().filter_map(|(i, c)| Some((i, part(&c.name)?))).collect();
    let mut found = Vec::new();
    for (_, (stem, _)) in named.iter().filter(|(_, (_, place))| *place == 0) {
        let of = |wanted: usize| named.iter().find(|(_, (s, p))| s == stem && *p == wanted).map(|(i, _)| *i);
        let Some(parts) = (0..4).map(of).collect::<Option<Vec<usize>>>() else { continue };
        let rows = parts.iter().filter_map(|i| values.get(*i)).map(Vec::len).min().unwrap_or(0);
        let norm = |row: usize| -> f64 {
            parts.iter().filter_map(|i| values.get(*i)?.get(row)).map(|v| v * v).sum()
        };
        if rows >= MIN_JUDGED_VALUES && (0..rows).all(|row| (norm(row) - 1.0).abs() < 0.01) {
            found.extend(parts);
        }
    }
    found
}

/// Columns of two's complement that is written without its sign: whole numbers near both ends of the range of 16, 24 or
/// 32 bits and none between, that cross from one end to the other again and again.
fn unsigned(columns: &[Column], values: &[FirstValues]) -> Vec<(usize, f64)> {
    let numeric = |i: usize| {
        columns.get(i).is_some_and(|c| c.numeric && !matches!(c.inferred().role, Role::Time | Role::Counter))
    };
    let range = |i: usize| -> Option<f64> {
        let of: Vec<f64> = values.get(i).into_iter().flatten().copied().filter(|v| v.is_finite()).collect();
        let sizes = [16, 24, 32].map(|bits| 2f64.powi(bits));
        let size =
            sizes.into_iter().find(|size| of.iter().all(|v| v.fract() == 0.0 && (0.0..*size).contains(v)))?;
        let (low, high) = (|v: f64| v < 0.25 * size, |v: f64| v >= 0.75 * size);
        let apart = of.len() >= MIN_JUDGED_VALUES && of.iter().all(|v| low(*v) || high(*v));
        let crossings = of.iter().zip(of.get(1..)?).filter(|(a, b)| low(**a) != low(**b)).count();
        (apart && crossings >= 3).then_some(size)
    };
    let found: Vec<(usize, f64)> =
        (0..columns.len()).filter(|i| numeric(*i)).filter_map(|i| Some((i, range(i)?))).collect();
    let Some(size) = found.first().map(|(_, size)| *size) else { return found };
    // Its neighbours are written alike, though their first values do not show it: whole numbers stay what they are below
    // half the range.
    let like = |i: &usize| {
        let of = values.get(*i).map(Vec::as_slice).unwrap_or_default();
        numeric(*i)
            && of.len() >= MIN_JUDGED_VALUES
            && finite(of).all(|v| v.fract() == 0.0 && (0.0..size).contains(&v))
    };
    (0..columns.len()).filter(like).map(|i| (i, size)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(columns: &[(&str, FirstValues)]) -> (Vec<Column>, Judgement) {
        let mut described: Vec<Column> = columns
            .iter()
            .map(|(name, _)| Column {
                name: (*name).to_owned(),
                numeric: true,
                storage: "text".to_owned(),
                unit: None,
                epoch_s: None,
                rollover_s: None,
                judged: None,
            })
            .collect();
        let values: Vec<FirstValues> = columns.iter().map(|(_, v)| v.clone()).collect();
        let found = judge(&mut described, &values, &[], &Stated::default());
        (described, found)
    }

    fn rows(of: impl Fn(f64) -> f64) -> FirstValues {
        (0..64).map(|i| of(f64::from(i))).collect()
    }

    #[test]
    fn roles_by_name_are_checked_by_value() {
        let wavy = |i: f64| (1.7 * i).sin();
        let (columns, _) = judged(&[
            ("timestamp", rows(|i| 12_345_875.0 + 40_000.0 * i)),
            ("samples", rows(|_| 8.0)),
            ("clip_counter[0]", rows(|_| 0.0)),
            ("seq", rows(|i| 1000.0 + i)),
            ("T", rows(|_| 35.0)),
            ("w", rows(|_| 1.0)),
            ("wx", rows(wavy)),
            ("w_z", rows(wavy)),
            ("temp", rows(|i| 298.0 + 0.01 * i)),
            ("PacketCounter", rows(|i| (65_500.0 + i) % 65_536.0)),
        ]);
        let found: Vec<(Role, &str)> = columns.iter().map(|c| (c.inferred().role, c.name.as_str())).collect();
        let expected = [
            (Role::Time, "timestamp"),
            (Role::Auxiliary, "samples"),
            (Role::Auxiliary, "clip_counter[0]"),
            (Role::Counter, "seq"),
            (Role::Temperature, "T"),
            (Role::Auxiliary, "w"),
            (Role::Rate, "wx"),
            (Role::Rate, "w_z"),
            (Role::Temperature, "temp"),
            (Role::Counter, "PacketCounter"),
        ];
        assert_eq!(found, expected);
        assert_eq!(columns[0].inferred().unit.text(), "us");
        assert_eq!(columns[8].inferred().unit.text(), "K");
    }

    #[test]
    fn parts_of_a_quaternion_are_no_rates() {
        let turn = |i: f64| 0.05 * i;
        let (columns, _) = judged(&[
            ("qw", rows(|i| turn(i).cos())),
            ("qx", rows(|i| turn(i).sin())),
            ("qy", rows(|_| 0.0)),
            ("qz", rows(|_| 0.0)),
            ("body.w", rows(|i| turn(i).cos())),
            ("body.x", rows(|i| turn(i).sin())),
            ("body.y", rows(|_| 0.0)),
            ("body.z", rows(|_| 0.0)),
        ]);
        assert!(columns.iter().all(|c| !c.inferred().role.is_gyro()));
    }

    #[test]
    fn counts_without_a_sign_are_told_from_counts_and_counters() {
        let signs = |i: f64| if i as i64 % 3 == 0 { 65_533.0 } else { 4.0 };
        let (_, found) = judged(&[
            ("gyro_x_counts", rows(signs)),
            ("gyro_y_counts", rows(|i| 40.0 + i)),
            ("count", rows(|i| (65_500.0 + i) % 65_536.0)),
            ("rate", rows(|i| 0.5 + i)),
        ]);
        assert_eq!(found.unsigned, [(0, 65_536.0), (1, 65_536.0)]);
        let (_, found) = judged(&[("gyro_x_counts", rows(|i| 30_000.0 + i))]);
        assert_eq!(found.unsigned, []);
    }
}
