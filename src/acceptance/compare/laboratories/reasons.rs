//! Why two values of one quantity differ. A reason is *shown* where a further evaluation, or a correction with known sensitivity,
//! takes the difference away; otherwise it is *possible*: the results state that this differs, and not what it does.

use super::agreement::{Agreement, Common, Score, agreement, score};
use super::given::{Evaluated, Given, Side, same_row};
use crate::i18n::{Arg, Note, note};
use crate::measurand::{BIAS_TEMPERATURE_SENSITIVITY, PowerModel, STATIC_BIAS, find};
use crate::record::{MeasurandRecord, Message, RunRecord};
use serde::{Deserialize, Serialize};

/// Relative difference of lengths and sample intervals from which they count as different.
const SAME_TO: f64 = 0.05;
/// Difference of mean temperatures from which they count as different, degC: twice what thermometers of benches agree to.
const SAME_TEMPERATURE_DEG_C: f64 = 0.5;
/// Share of a difference that a reason must take away to be the reason: a wider interval alone explains nothing.
const EXPLAINED_SHARE: f64 = 0.5;

/// What can make two values differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ReasonKind {
    /// The procedures define or evaluate the quantity differently.
    Definition,
    /// The records have different lengths.
    Length,
    /// The samples were taken or filtered differently.
    Filter,
    /// The temperatures differ.
    Temperature,
    /// The benches differ: site, table, thermometer, mounting.
    Bench,
    /// The unit changed, or something did that neither result records.
    Change,
}

impl ReasonKind {
    /// Every kind.
    pub const ALL: [ReasonKind; 6] = [
        ReasonKind::Definition,
        ReasonKind::Length,
        ReasonKind::Filter,
        ReasonKind::Temperature,
        ReasonKind::Bench,
        ReasonKind::Change,
    ];

    /// Word of it in a result.
    pub fn id(self) -> &'static str {
        match self {
            ReasonKind::Definition => "definition",
            ReasonKind::Length => "length",
            ReasonKind::Filter => "filter",
            ReasonKind::Temperature => "temperature",
            ReasonKind::Bench => "bench",
            ReasonKind::Change => "change",
        }
    }
}

/// A reason.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reason {
    /// What it is.
    pub kind: ReasonKind,
    /// True where it was shown, false where it is only possible.
    pub shown: bool,
    /// In a sentence.
    pub why: Message,
}

impl Reason {
    fn new(kind: ReasonKind, shown: bool, why: Note) -> Reason {
        Reason { kind, shown, why: why.into() }
    }
}

/// A row that both results have.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PairedRow {
    /// The row of the first result.
    pub first: MeasurandRecord,
    /// The row of the second result.
    pub second: MeasurandRecord,
    /// Difference with its uncertainty; absent where one of them is only bounded, or has no interval, and for one recording.
    pub score: Option<Score>,
    /// Whether they agree.
    pub agreement: Agreement,
    /// The same of both recordings under the procedure of the first result, where it was evaluated.
    pub by_first: Option<Score>,
    /// The same under the procedure of the second.
    pub by_second: Option<Score>,
    /// What the procedures make of the difference; the rest is of the recordings. Absent where the recordings were not evaluated
    /// under both.
    pub by_procedures: Option<f64>,
    /// Why they differ; empty where they do not.
    pub reasons: Vec<Reason>,
}

/// Everything that reasons are found from.
pub(super) struct Case<'a> {
    pub sides: &'a [Side; 2],
    pub same_recording: bool,
    pub common: &'a Common<'a>,
    pub evaluated: &'a Evaluated,
    pub given: &'a [Given<'a>; 2],
}

/// The row of a further evaluation that belongs to a row.
fn row_of<'a>(record: Option<&'a RunRecord>, row: &MeasurandRecord) -> Option<&'a MeasurandRecord> {
    record?.measurands.iter().find(|r| same_row(r, row))
}

impl Case<'_> {
    /// Two rows compared, with the reasons where they differ.
    pub(super) fn row(&self, first: MeasurandRecord, second: MeasurandRecord) -> PairedRow {
        if self.same_recording {
            return self.of_one_recording(first, second);
        }
        let found = score(&first, &second, self.common);
        let agreement = agreement(&first, &second, found.as_ref());
        let second_by_first = row_of(self.evaluated.second_by_first.as_ref(), &first);
        let first_by_second = row_of(self.evaluated.first_by_second.as_ref(), &second);
        let by_first = second_by_first.and_then(|again| score(&first, again, self.common));
        let by_second = first_by_second.and_then(|again| score(again, &second, self.common));
        // The mean of what the change of procedure does to either recording: with it, what the recordings do adds up to the whole.
        let change = |from: Option<f64>, to: Option<f64>| Some(to? - from?);
        let by_procedures = change(first.value, first_by_second.and_then(|r| r.value))
            .zip(change(second_by_first.and_then(|r| r.value), second.value))
            .map(|(of_first, of_second)| 0.5 * (of_first + of_second));
        let mut row = PairedRow {
            first,
            second,
            score: found,
            agreement,
            by_first,
            by_second,
            by_procedures,
            reasons: vec![],
        };
        if row.agreement == Agreement::Differs {
            row.reasons = self.reasons(&row);
        }
        row
    }

    /// Two rows from one recording: any difference is one of definition.
    fn of_one_recording(&self, first: MeasurandRecord, second: MeasurandRecord) -> PairedRow {
        let difference = first.value.zip(second.value).map(|(x, y)| y - x);
        let differs = difference.is_some_and(|d| d != 0.0);
        let agreement = match difference {
            None => Agreement::Undecided,
            Some(_) if differs => Agreement::Differs,
            Some(_) => Agreement::Agrees,
        };
        let why = note!("laboratories.why.one_recording");
        let reasons = differs.then(|| Reason::new(ReasonKind::Definition, true, why));
        PairedRow {
            first,
            second,
            score: None,
            agreement,
            by_first: None,
            by_second: None,
            by_procedures: difference,
            reasons: reasons.into_iter().collect(),
        }
    }

    fn reasons(&self, row: &PairedRow) -> Vec<Reason> {
        let found =
            [definition(row), self.length(row), self.temperature(row), self.filter(row), self.bench(row)];
        let mut found: Vec<Reason> = found.into_iter().flatten().collect();
        // What was shown leaves nothing to be supposed.
        if found.iter().any(|reason| reason.shown) {
            found.retain(|reason| reason.shown);
        } else {
            let key = if found.is_empty() { "laboratories.why.change" } else { "laboratories.why.or_change" };
            found.push(Reason::new(ReasonKind::Change, false, Note::new(key)));
        }
        found
    }

    /// The beginning of the longer record against the whole of the other one.
    fn length(&self, row: &PairedRow) -> Option<Reason> {
        let [first, second] = self.sides;
        let (short, long) = (first.usable_s.min(second.usable_s), first.usable_s.max(second.usable_s));
        if short <= 0.0 || long / short < 1.0 + SAME_TO {
            return None;
        }
        let [hours, long_h] = [short, long].map(|s| Arg::figures(s / 3600.0, 3));
        let again = self.evaluated.shortened.as_ref();
        let again = again.and_then(|(longer, record)| Some((*longer, row_of(Some(record), &row.first)?)));
        let Some((longer, again)) = again else {
            let why = note!("laboratories.why.length", short = hours, long = long_h);
            return Some(Reason::new(ReasonKind::Length, false, why));
        };
        let now = match longer {
            0 => score(again, &row.second, self.common),
            _ => score(&row.first, again, self.common),
        };
        let (now, before) = (now?, row.score?);
        let why = note!("laboratories.why.length_shown", hours, en = score_arg(now.en));
        explains(now, before).then(|| Reason::new(ReasonKind::Length, true, why))
    }

    /// The temperatures, with the sensitivity where one of the results states it.
    fn temperature(&self, row: &PairedRow) -> Option<Reason> {
        let [Some(first), Some(second)] = self.sides.each_ref().map(|s| s.temperature_deg_c) else {
            return None;
        };
        let step = second - first;
        if step.abs() < SAME_TEMPERATURE_DEG_C {
            return None;
        }
        let before = row.score?;
        let of_bias = row.first.id == STATIC_BIAS.id;
        let sensitivity = self.given.iter().filter(|_| of_bias).find_map(|given| {
            let rows = given.record.measurands.iter();
            let own = |r: &&MeasurandRecord| {
                r.id == BIAS_TEMPERATURE_SENSITIVITY.id
                    && r.channel == row.first.channel
                    && r.objections.is_empty()
            };
            rows.filter(own).find_map(|r| r.value)
        });
        let (step_arg, unit) = (Arg::figures(step, 2), Arg::Text(row.first.unit.clone()));
        let Some(sensitivity) = sensitivity else {
            let needed = Arg::figures(before.difference / step, 2);
            let why = note!("laboratories.why.temperature", step = step_arg, needed, unit);
            return Some(Reason::new(ReasonKind::Temperature, false, why));
        };
        let difference = before.difference - sensitivity * step;
        let now = Score { difference, en: difference / before.expanded, ..before };
        let (sensitivity, en) = (Arg::figures(sensitivity, 2), score_arg(now.en));
        let why = note!("laboratories.why.temperature_shown", step = step_arg, sensitivity, unit, en);
        explains(now, before).then(|| Reason::new(ReasonKind::Temperature, true, why))
    }

    /// The samples, for all but a mean, which is that of the record however it is sampled.
    fn filter(&self, row: &PairedRow) -> Option<Reason> {
        if find(&row.first.id).is_some_and(|m| m.power == Some(PowerModel::Mean)) {
            return None;
        }
        let [Some(first), Some(second)] = self.sides.each_ref().map(|s| s.sample_interval_s) else {
            return None;
        };
        let why = note!(
            "laboratories.why.filter",
            first = Arg::rounded(first, 4),
            second = Arg::rounded(second, 4)
        );
        let differs = (first / second).max(second / first) > 1.0 + SAME_TO;
        differs.then(|| Reason::new(ReasonKind::Filter, false, why))
    }

    /// The benches, for rows of which the budget names site, table, thermometer or source.
    fn bench(&self, row: &PairedRow) -> Option<Reason> {
        let rests = [&row.first, &row.second].iter().any(|r| r.budget.iter().any(|c| c.common_to.is_some()));
        let why = note!("laboratories.why.bench");
        (rests && !self.common.is_one_bench()).then(|| Reason::new(ReasonKind::Bench, false, why))
    }
}

/// The procedures: under one of them, whichever, the recordings agree.
fn definition(row: &PairedRow) -> Option<Reason> {
    let (by_first, by_second, before) = (row.by_first?, row.by_second?, row.score?);
    let part = row.by_procedures? / before.difference;
    let agrees = by_first.agrees() && by_second.agrees() && part >= EXPLAINED_SHARE;
    let key = match (agrees, part >= SAME_TO) {
        (true, _) => "laboratories.why.definition",
        (false, true) => "laboratories.why.definition_partly",
        (false, false) => return None,
    };
    let why = Note::new(key).with("share", Arg::rounded(100.0 * part, 2));
    let why = why.with("first", score_arg(by_first.en)).with("second", score_arg(by_second.en));
    Some(Reason::new(ReasonKind::Definition, agrees, why))
}

/// True where a difference is taken away: it lies within its uncertainty, and not only because that became larger.
fn explains(now: Score, before: Score) -> bool {
    now.agrees() && now.difference.abs() <= (1.0 - EXPLAINED_SHARE) * before.difference.abs()
}

/// A score as it is printed.
fn score_arg(en: f64) -> Arg {
    Arg::fixed(en, 2)
}
