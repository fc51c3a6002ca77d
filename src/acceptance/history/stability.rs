//! Stability of one unit over days: runs within days.

use super::selection::{Group, Selection, Tested};
use super::units::{YEAR_DAYS, days};
use crate::i18n::{Note, note};
use crate::lot::stability::{Day, DayScatter, Known, MIN_DAYS, MIN_REPEATS, stability};
use crate::record::{HistoryInterval, HistoryPoint, HistoryQuantity, HistoryStability, Message};

/// Runs from which a quantity has a row, what is not known of it included.
const MIN_RUNS: usize = 3;
const MONTH_DAYS: f64 = YEAR_DAYS / 12.0;
/// Characters of the date of a moment in RFC 3339.
const DATE_LENGTH: usize = 10;

/// The stability of every quantity that enough tests have.
pub(super) fn stabilities(
    selection: &Selection<'_>,
    quantities: &[HistoryQuantity],
) -> Vec<HistoryStability> {
    let counted = Group::of(selection.all().filter(Tested::counts));
    let each = |quantity: &HistoryQuantity| one(&selection.points(quantity, &counted), quantity);
    quantities.iter().filter_map(each).collect()
}

/// A value that does not say when it was measured belongs to no day.
fn one(points: &[HistoryPoint], quantity: &HistoryQuantity) -> Option<HistoryStability> {
    let mut timed: Vec<(f64, &HistoryPoint)> =
        points.iter().filter_map(|p| Some((days(&p.evaluated_at)?, p))).collect();
    timed.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (first, last) = timed.first().zip(timed.last()).filter(|_| timed.len() >= MIN_RUNS)?;
    let found = stability(&by_date(&timed));
    let (day, at_most) = match found.day {
        Some(DayScatter::Known(known)) => (Some(known), None),
        Some(DayScatter::AtMost(most)) => (None, Some(most)),
        None => (None, None),
    };
    let interval = |known: Known| HistoryInterval { value: known.value, low: known.low, high: known.high };
    let repeats = found.runs - found.days;
    Some(HistoryStability {
        quantity: quantity.clone(),
        runs: found.runs,
        days: found.days,
        from: first.1.evaluated_at.clone(),
        to: last.1.evaluated_at.clone(),
        run_deviation: found.run.map(interval),
        day_deviation: day.map(interval),
        day_deviation_at_most: at_most,
        per_month: found.trend.map(interval),
        notes: reasons(found.days, repeats, found.run.is_some()).into_iter().map(Message::from).collect(),
    })
}

/// Runs by the date of their moments, each day at the mean of their times, in months.
fn by_date(timed: &[(f64, &HistoryPoint)]) -> Vec<Day> {
    let date = |point: &HistoryPoint| point.evaluated_at.get(..DATE_LENGTH).map(str::to_owned);
    let same = |a: &(f64, &HistoryPoint), b: &(f64, &HistoryPoint)| date(a.1) == date(b.1);
    let start = timed.first().map_or(0.0, |(t, _)| *t);
    let of_day = |own: &[(f64, &HistoryPoint)]| Day {
        time: own.iter().map(|(t, _)| (t - start) / MONTH_DAYS).sum::<f64>() / own.len() as f64,
        runs: own.iter().map(|(_, p)| p.value).collect(),
    };
    timed.chunk_by(same).map(of_day).collect()
}

/// Why something is withheld.
fn reasons(days: usize, repeats: usize, run_is_known: bool) -> Vec<Note> {
    let few_repeats = (repeats < MIN_REPEATS)
        .then(|| note!("history.stability.few_repeats", n = repeats, least = MIN_REPEATS));
    let alike = (repeats >= MIN_REPEATS && !run_is_known).then(|| note!("history.stability.alike"));
    let few_days = (days < MIN_DAYS).then(|| note!("history.stability.few_days", n = days, least = MIN_DAYS));
    [few_repeats, alike, few_days].into_iter().flatten().collect()
}
