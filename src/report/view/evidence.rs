//! What the verdict rests on beside the measured values: conditions, integrity, window, lines, models, power,
//! instruments, waivers, clauses.

use super::{Field, Words};
use crate::record::{ConditionRecord, ConditionStatus, FaultRecord, Integrity, NoiseModelRecord, RunRecord};
use crate::report::number::{NOTHING, Rounding, count, digits, duration, limit, limit_digits, percent};
use serde::Serialize;

/// Faults of one kind that a report lists; more would bury the rest of it.
const SHOWN_OF_A_KIND: usize = 20;

/// Printed evidence. Each table is empty when the record has nothing for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Evidence {
    /// Conditions.
    pub conditions: Vec<Condition>,
    /// Counts of faults by kind.
    pub fault_counts: Vec<Field>,
    /// True when no fault was found.
    pub faultless: bool,
    /// Jitter, quantisation step, threshold.
    pub integrity_facts: Vec<Field>,
    /// Faults one by one, the first of each kind.
    pub faults: Vec<Fault>,
    /// How many of the listed faults are shown; empty when all are.
    pub faults_shown: String,
    /// Evaluated span.
    pub window: Vec<Field>,
    /// Spans left out.
    pub excluded: Vec<Excluded>,
    /// Spectral lines.
    pub lines: Vec<Line>,
    /// Noise models.
    pub models: Vec<Model>,
    /// What this test can decide.
    pub power: Vec<Power>,
    /// Instruments.
    pub instruments: Vec<Instrument>,
    /// Waivers.
    pub waivers: Vec<Waiver>,
    /// Clauses.
    pub clauses: Vec<Clause>,
}

/// A condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Condition {
    /// Name.
    pub name: String,
    /// Id of the state.
    pub status: &'static str,
    /// State in words.
    pub status_word: String,
    /// What was required.
    pub required: String,
    /// What was observed.
    pub observed: String,
    /// Explanation.
    pub note: String,
}

/// A fault.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fault {
    /// Kind, in words.
    pub kind: String,
    /// Channel.
    pub channel: String,
    /// Row.
    pub row: String,
    /// Time.
    pub time: String,
    /// Samples concerned.
    pub count: String,
    /// What was seen.
    pub note: String,
}

/// A span left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Excluded {
    /// Start.
    pub from: String,
    /// End.
    pub to: String,
    /// Length.
    pub length: String,
    /// Reason, in words.
    pub reason: String,
}

/// A spectral line.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// Channel.
    pub channel: String,
    /// Frequency, Hz.
    pub frequency: String,
    /// Resolution, Hz.
    pub resolution: String,
    /// Period.
    pub period: String,
    /// Amplitude.
    pub amplitude: String,
    /// Power over the floor.
    pub excess: String,
    /// False-alarm probability.
    pub false_alarm: String,
}

/// A noise model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Model {
    /// Channel.
    pub channel: String,
    /// Method, in words.
    pub method: String,
    /// Terms that were claimed, in words.
    pub terms: String,
    /// Coefficients with symbol and unit.
    pub coefficients: Vec<Field>,
    /// Misfit per degree of freedom.
    pub misfit: String,
    /// Probability of a larger misfit if the model is right.
    pub probability: String,
    /// Where it misfits most; empty when it fits.
    pub band: String,
}

/// Power of a limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Power {
    /// Quantity.
    pub name: String,
    /// Channel.
    pub channel: String,
    /// Limit with unit.
    pub limit: String,
    /// Probability that a unit 1.5 times over would be failed.
    pub power: String,
    /// Probability that a unit at half the limit would be passed.
    pub pass: String,
    /// Record length that would do.
    pub needed: String,
    /// The same in words.
    pub message: String,
}

/// An instrument.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Instrument {
    /// Name.
    pub name: String,
    /// Serial number.
    pub serial: String,
    /// Calibration holds until.
    pub due: String,
    /// Id of the state.
    pub status: &'static str,
    /// State in words.
    pub status_word: String,
}

/// A waiver.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Waiver {
    /// Row.
    pub row: String,
    /// Who.
    pub by: String,
    /// When.
    pub date: String,
    /// Why.
    pub reason: String,
}

/// A clause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Clause {
    /// Number.
    pub clause: String,
    /// Title.
    pub title: String,
    /// Id of the state.
    pub status: String,
    /// State in words.
    pub status_word: String,
    /// Where or why.
    pub note: String,
}

impl Evidence {
    /// Prints the evidence of a record.
    pub(crate) fn new(record: &RunRecord, words: Words) -> Evidence {
        let lang = words.lang;
        let shown = first_of_each_kind(&record.integrity.faults);
        let (fault_counts, faultless) = fault_counts(&record.integrity, words);
        Evidence {
            conditions: record.conditions.iter().map(|c| condition(c, words)).collect(),
            fault_counts,
            faultless,
            integrity_facts: facts(&record.integrity, words),
            faults_shown: if shown.len() < record.integrity.faults.len() {
                let listed = count(record.integrity.faults.len() as u64, lang);
                words.with(
                    "report.faults_shown",
                    &[("shown", &count(shown.len() as u64, lang)), ("listed", &listed)],
                )
            } else {
                String::new()
            },
            faults: shown.into_iter().map(|f| fault(f, words)).collect(),
            window: [
                ("report.window_from", record.window.from_s),
                ("report.window_to", record.window.to_s),
                ("report.window_usable", record.window.usable_s),
            ]
            .map(|(key, s)| Field { label: words.t(key), value: duration(s, lang) })
            .into(),
            excluded: record
                .window
                .excluded
                .iter()
                .map(|e| Excluded {
                    from: duration(e.from_s, lang),
                    to: duration(e.to_s, lang),
                    length: duration(e.to_s - e.from_s, lang),
                    reason: words.name("excluded", &e.reason),
                })
                .collect(),
            lines: record
                .lines
                .iter()
                .map(|l| Line {
                    channel: l.channel.clone(),
                    frequency: {
                        let half = 0.5 * l.resolution_hz;
                        let range = (l.frequency_hz - half, l.frequency_hz + half);
                        Rounding::of(l.frequency_hz, Some(range)).show(l.frequency_hz, lang)
                    },
                    resolution: digits(l.resolution_hz, 2, lang),
                    period: if l.frequency_hz > 0.0 {
                        duration(1.0 / l.frequency_hz, lang)
                    } else {
                        NOTHING.to_owned()
                    },
                    amplitude: digits(l.amplitude_deg_h, 3, lang),
                    excess: digits(l.excess, 3, lang),
                    false_alarm: probability(l.false_alarm_probability, words),
                })
                .collect(),
            models: record.noise_models.iter().map(|m| model(m, words)).collect(),
            power: record
                .power
                .iter()
                .map(|p| Power {
                    name: words.name("measurand", &p.id),
                    channel: p.channel.clone(),
                    limit: words.quantity(&limit(p.limit, lang), &p.unit),
                    power: percent(p.power, lang),
                    pass: percent(p.pass_probability, lang),
                    needed: p.needed_h.map_or_else(
                        || NOTHING.to_owned(),
                        |h| words.quantity(&limit_digits(h, 3, lang), "h"),
                    ),
                    message: words.say(&p.message),
                })
                .collect(),
            instruments: record
                .instruments
                .iter()
                .map(|i| Instrument {
                    name: i.name.clone(),
                    serial: i.serial.clone().unwrap_or_else(|| NOTHING.to_owned()),
                    due: i.calibration_due.clone().unwrap_or_else(|| NOTHING.to_owned()),
                    status: status(i.status),
                    status_word: words.name("calibration", status(i.status)),
                })
                .collect(),
            waivers: record
                .waivers
                .iter()
                .map(|w| Waiver {
                    row: row_name(&w.row, words),
                    by: w.by.clone(),
                    date: w.date.clone(),
                    reason: w.reason.clone(),
                })
                .collect(),
            clauses: record
                .clauses
                .iter()
                .map(|c| Clause {
                    clause: c.clause.clone(),
                    title: c.title.clone(),
                    status: c.status.clone(),
                    status_word: words.name("clause", &c.status),
                    note: c.note.clone(),
                })
                .collect(),
        }
    }
}

fn status(status: ConditionStatus) -> &'static str {
    match status {
        ConditionStatus::Ok => "ok",
        ConditionStatus::Remark => "remark",
        ConditionStatus::Invalid => "invalid",
    }
}

/// Name of the measurand or condition that a waiver is about.
fn row_name(id: &str, words: Words) -> String {
    ["measurand", "condition"]
        .iter()
        .find_map(|prefix| crate::text::lookup(words.lang, &format!("{prefix}.{id}")))
        .map_or_else(|| id.to_owned(), str::to_owned)
}

fn probability(p: f64, words: Words) -> String {
    if p > 0.0 && p < 1e-3 { digits(p, 2, words.lang) } else { limit_digits(p, 3, words.lang) }
}

fn condition(c: &ConditionRecord, words: Words) -> Condition {
    let mut observed: Vec<(&String, &serde_json::Value)> = c.observed.iter().collect();
    let rank =
        |name: &str| ["value", "min", "max", "mean", "std"].iter().position(|k| *k == name).unwrap_or(5);
    observed.sort_by_key(|(name, _)| rank(name));
    let observed: Vec<String> = observed
        .into_iter()
        .map(|(name, value)| {
            let shown = match value {
                serde_json::Value::Number(n) => match n.as_u64() {
                    Some(whole) => count(whole, words.lang),
                    None => n.as_f64().map_or_else(|| n.to_string(), |v| limit_digits(v, 5, words.lang)),
                },
                serde_json::Value::String(s) => s.clone(),
                serde_json::Value::Bool(b) => words.t(if *b { "report.yes" } else { "report.no" }),
                serde_json::Value::Null => NOTHING.to_owned(),
                other => other.to_string(),
            };
            // What stands alone needs no name.
            if name == "value" { shown } else { format!("{}\u{a0}{shown}", words.name("observed", name)) }
        })
        .collect();
    Condition {
        name: words.name("condition", &c.id),
        status: status(c.status),
        status_word: words.name("status", status(c.status)),
        required: c.required.clone(),
        observed: observed.join(", "),
        note: c.message.as_ref().map_or_else(|| c.note.clone(), |m| words.say(m)),
    }
}

fn fault_counts(i: &Integrity, words: Words) -> (Vec<Field>, bool) {
    let counts = [
        ("gaps", i.gaps),
        ("missing_samples", i.missing_samples),
        ("duplicate_timestamps", i.duplicate_timestamps),
        ("backward_timestamps", i.backward_timestamps),
        ("non_finite", i.non_finite),
        ("unparsable", i.unparsable),
        ("outliers", i.outliers),
        ("saturated", i.saturated),
        ("stuck", i.stuck),
    ];
    let fields = counts
        .iter()
        .map(|(id, n)| Field { label: words.name("integrity", id), value: count(*n, words.lang) })
        .collect();
    (fields, counts.iter().all(|c| c.1 == 0))
}

fn facts(i: &Integrity, words: Words) -> Vec<Field> {
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
    .map(|(key, value)| Field { label: words.t(key), value })
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

fn fault(f: &FaultRecord, words: Words) -> Fault {
    Fault {
        kind: words.name("fault", &f.kind),
        channel: f.channel.clone().unwrap_or_default(),
        row: count(f.row, words.lang),
        time: f
            .time_s
            .map_or_else(|| NOTHING.to_owned(), |t| words.quantity(&limit_digits(t, 9, words.lang), "s")),
        count: count(f.count, words.lang),
        note: f.note.clone(),
    }
}

fn model(m: &NoiseModelRecord, words: Words) -> Model {
    let lang = words.lang;
    let coefficients = [
        ("N", m.angle_random_walk, "deg/sqrt(h)"),
        ("B", m.bias_instability, "deg/h"),
        ("K", m.rate_random_walk, "deg/h/sqrt(h)"),
        ("R", m.rate_ramp, "deg/h/h"),
        ("Q", m.quantization, "arcsec"),
    ]
    .map(|(symbol, value, unit)| Field {
        label: symbol.to_owned(),
        value: words.quantity(&limit_digits(value, 4, lang), unit),
    });
    let terms: Vec<String> = m.terms.iter().map(|t| words.name("measurand", t)).collect();
    Model {
        channel: m.channel.clone(),
        method: words.name("how", &m.method),
        terms: if terms.is_empty() { NOTHING.to_owned() } else { terms.join(", ") },
        coefficients: coefficients.into(),
        misfit: digits(m.misfit, 3, lang),
        probability: probability(m.misfit_probability, words),
        band: m.misfit_band_hz.map_or_else(String::new, |[low, high]| {
            let range = words
                .with("report.interval", &[("low", &digits(low, 3, lang)), ("high", &digits(high, 3, lang))]);
            words.quantity(&range, "Hz")
        }),
    }
}
