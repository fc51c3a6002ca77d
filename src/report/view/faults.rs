//! Faults of the recording: what was found against what is allowed, and the first of each kind one by one.

use super::common::{required, status};
use super::part::Part;
use crate::record::{ConditionRecord, FaultRecord, Integrity, RunRecord};
use crate::report::number::{NOTHING, count, duration, limit_digits, percent};
use crate::report::page::{Block, Facts, Table, Value};
use crate::report::translator::Translator;

/// Faults of one kind that a report lists; more would bury the rest of it.
const SHOWN_OF_A_KIND: usize = 10;

/// Faults of the recording by kind.
pub struct FaultKinds {
    /// Kinds that were found, and those whose budget is broken.
    pub found: Vec<FaultKind>,
    /// Kinds that were looked for and not found.
    absent: Vec<FaultKind>,
    /// Names of the kinds that could not be looked for.
    unexamined: Vec<String>,
}

/// One kind of fault.
pub struct FaultKind {
    /// Name.
    pub name: String,
    /// How many or how much was found.
    pub found: String,
    /// Share of the rows; empty for what is no count.
    share: String,
    /// What is allowed.
    allowed: String,
    /// Id of the state; empty without a budget.
    pub status: &'static str,
    /// State in words.
    status_word: String,
}

/// Counted faults: id and count.
fn counts(i: &Integrity) -> [(&'static str, u64); 10] {
    [
        ("gaps", i.gaps),
        ("missing_samples", i.missing_samples),
        ("duplicate_timestamps", i.duplicate_timestamps),
        ("backward_timestamps", i.backward_timestamps),
        ("non_finite", i.non_finite),
        ("unparsable", i.unparsable),
        ("outliers", i.outliers),
        ("saturated", i.saturated),
        ("stuck", i.stuck),
        ("repeated", i.repeated),
    ]
}

/// Counted faults for which there is no budget: id and count.
fn grave(i: &Integrity) -> [(&'static str, u64); 2] {
    [("implausible", i.implausible), ("cut_off", i.cut_off)]
}

/// Faults that are times: id of the condition.
const TIME_CONDITIONS: &[&str] = &["longest_gap", "timestamp_jitter"];

/// True when a condition is about a fault of the recording.
pub fn is_fault(id: &str) -> bool {
    let none = Integrity::default();
    TIME_CONDITIONS.contains(&id)
        || grave(&none).iter().any(|c| c.0 == id)
        || counts(&none).iter().any(|c| c.0 == id)
}

/// What was found against what is allowed, what was not found or not looked for, and the first faults of each kind.
pub fn section(part: &Part<'_>) -> Vec<Block> {
    let (integrity, words) = (&part.record.integrity, part.words);
    let kinds = FaultKinds::new(part.record, words);
    let is_faultless = !integrity.examined.is_empty()
        && counts(integrity).iter().chain(&grave(integrity)).all(|c| c.1 == 0)
        && integrity.faults.is_empty();
    let mut below = vec![];
    if is_faultless {
        below.push(Block::Paragraph(words.t("report.faultless")));
    }
    if !kinds.found.is_empty() {
        below.push(Block::Table(budget(&kinds.found, words)));
    }
    let sentences = [sentence(&kinds.absent, words), kinds.unexamined(integrity, words)];
    below.extend(sentences.into_iter().filter(|s| !s.is_empty()).map(Block::Hint));
    let rows = facts(integrity, words);
    if !rows.is_empty() {
        below.push(Block::Facts(Facts { class: "counts", rows }));
    }
    below.extend(one_by_one(integrity, words));
    vec![Block::section("", words.t("report.integrity"), below)]
}

impl FaultKinds {
    /// The kinds of faults of a record.
    pub fn new(record: &RunRecord, words: Translator) -> FaultKinds {
        let integrity = &record.integrity;
        let rows: u64 = record.recording.iter().map(|f| f.samples).sum();
        let condition = |id: &str| record.conditions.iter().find(|c| c.id == id);
        let (mut found, mut absent, mut unexamined) = (vec![], vec![], vec![]);
        for (id, n) in counts(integrity) {
            let share = if rows > 0 { percent(n as f64 / rows as f64, words.lang) } else { String::new() };
            if n == 0 && !integrity.has_examined(id) {
                unexamined.push(words.name("condition", id));
                continue;
            }
            let kind = kind(id, count(n, words.lang), share, condition(id), words);
            if n > 0 || kind.status == "invalid" { found.push(kind) } else { absent.push(kind) }
        }
        // These are never allowed: they are listed where they were found.
        for (id, n) in grave(integrity).into_iter().filter(|(_, n)| *n > 0) {
            found.push(kind(id, count(n, words.lang), String::new(), condition(id), words));
        }
        for c in TIME_CONDITIONS.iter().filter_map(|id| condition(id)) {
            let seconds = c.observed.get("seconds").and_then(serde_json::Value::as_f64).unwrap_or(0.0);
            let kind = kind(&c.id, duration(seconds, words.lang), String::new(), Some(c), words);
            if seconds > 0.0 || kind.status == "invalid" { found.push(kind) } else { absent.push(kind) }
        }
        FaultKinds { found, absent, unexamined }
    }

    /// The kinds that could not be looked for, as a sentence; empty where there are none.
    fn unexamined(&self, integrity: &Integrity, words: Translator) -> String {
        match self.unexamined.len() {
            0 => String::new(),
            _ if integrity.examined.is_empty() && self.found.is_empty() => words.t("report.none_examined"),
            _ => words.with("report.unexamined", &[("kinds", &self.unexamined.join("; "))]),
        }
    }
}

/// What was found of each kind against what is allowed.
fn budget(found: &[FaultKind], words: Translator) -> Table {
    let text = |of: fn(&FaultKind) -> &String| found.iter().map(move |f| of(f).clone());
    let state = |f: &FaultKind| match f.status {
        "" => Value::Empty,
        id => Value::state(id, f.status_word.as_str()),
    };
    Table::new("budget cards", found.len())
        .column(words.column("report.fault"), text(|f| &f.name))
        .column(words.number_column("report.found").class("n value"), text(|f| &f.found))
        .column(words.number_column("report.share"), text(|f| &f.share))
        .column(words.column("report.allowed"), text(|f| &f.allowed))
        .column(words.column("report.state"), found.iter().map(state))
}

/// The first faults of each kind, one by one, and how many of the listed ones they are.
fn one_by_one(integrity: &Integrity, words: Translator) -> Vec<Block> {
    let shown = first_of_each_kind(&integrity.faults);
    if shown.is_empty() {
        return vec![];
    }
    let each = |of: &dyn Fn(&FaultRecord) -> String| shown.iter().map(|f| of(f)).collect::<Vec<_>>();
    let time = |f: &FaultRecord| {
        let seconds = |t| words.quantity(&limit_digits(t, 9, words.lang), "s");
        f.time_s.map_or_else(|| NOTHING.to_owned(), seconds)
    };
    let table = Table::new("faults cards", shown.len())
        .column(words.column("report.fault"), each(&|f| words.name("fault", &f.kind)))
        .column(words.column("report.channel"), each(&|f| f.channel.clone().unwrap_or_default()))
        .column(words.number_column("report.file_row"), each(&|f| count(f.row, words.lang)))
        .column(words.number_column("report.time"), each(&time))
        .column(words.number_column("report.samples"), each(&|f| count(f.count, words.lang)))
        .column(words.column("report.seen"), shown.iter().map(|f| Value::Sentence(seen(f, words))));
    let hint = (shown.len() < integrity.faults.len()).then(|| {
        let listed = count(integrity.faults.len() as u64, words.lang);
        let n = count(shown.len() as u64, words.lang);
        Block::Hint(words.with("report.faults_shown", &[("shown", &n), ("listed", &listed)]))
    });
    std::iter::once(Block::Table(table)).chain(hint).collect()
}

fn kind(id: &str, found: String, share: String, c: Option<&ConditionRecord>, words: Translator) -> FaultKind {
    let allowed = c.map(|c| required(c, words)).filter(|r| !r.is_empty());
    FaultKind {
        name: words.name("condition", id),
        found,
        share,
        allowed: allowed.unwrap_or_else(|| NOTHING.to_owned()),
        status: c.map_or("", |c| status(c.status)),
        status_word: c.map_or_else(String::new, |c| words.name("status", status(c.status))),
    }
}

/// `Looked for and not found: gaps (at most 10), …`
fn sentence(absent: &[FaultKind], words: Translator) -> String {
    let listed: Vec<String> = absent
        .iter()
        .map(|k| if k.allowed == NOTHING { k.name.clone() } else { format!("{} ({})", k.name, k.allowed) })
        .collect();
    if listed.is_empty() {
        String::new()
    } else {
        words.with("report.absent", &[("kinds", &listed.join("; "))])
    }
}

/// Jitter, quantisation step, threshold of outliers.
fn facts(i: &Integrity, words: Translator) -> Vec<(Value, Value)> {
    let lang = words.lang;
    [
        i.timestamp_jitter_s.map(|v| ("report.jitter", duration(v, lang))),
        i.quantization_step_deg_h
            .map(|v| ("report.step", words.quantity(&limit_digits(v, 4, lang), "deg/h"))),
        i.outlier_threshold.map(|v| {
            let v = limit_digits(v, 3, lang);
            ("report.outlier_threshold", words.with("report.robust_deviations", &[("value", &v)]))
        }),
    ]
    .into_iter()
    .flatten()
    .map(|(key, value)| (words.t(key).into(), value.into()))
    .collect()
}

/// The faults that a report lists, in the order of the record.
fn first_of_each_kind(faults: &[FaultRecord]) -> Vec<&FaultRecord> {
    let mut seen: std::collections::BTreeMap<&str, usize> = std::collections::BTreeMap::new();
    faults
        .iter()
        .filter(|f| {
            let n = seen.entry(&f.kind).or_default();
            *n += 1;
            *n <= SHOWN_OF_A_KIND
        })
        .collect()
}

/// What was seen of a fault, with its file where there are several.
fn seen(f: &FaultRecord, words: Translator) -> String {
    let note = f.seen.message.as_ref().map_or_else(|| f.seen.note.clone(), |m| words.say(m));
    f.file.as_ref().map_or_else(|| note.clone(), |file| format!("{file}: {note}"))
}
