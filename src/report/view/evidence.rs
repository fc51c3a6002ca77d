//! What the verdict rests on beside the measured values: conditions, integrity, window, lines, models, power,
//! instruments, waivers, clauses.

use super::checks::{self, Unmade};
use super::common::{MODEL_NOTES, probability, required, row_name, status};
use super::conditions::{self, Condition};
use super::deviations::{self, Deviations};
use super::faults::{self, Faults};
use super::goodness::{self, Goodness};
use crate::i18n::Arg;
use crate::measurand;
use crate::noise::residual::View;
use crate::record::{
    ClauseRecord, ConditionStatus, ExcludedSpan, ExclusionRecord, GoodnessOfFitRecord, InstrumentRecord,
    LineRecord, MeasurandRecord, Message, NoiseModelRecord, PowerRecord, RunRecord, WaiverRecord,
};
use crate::report::number::{NOTHING, Rounding, count, digits, duration, limit, limit_digits, percent};
use crate::report::translator::{Field, Translator};
use serde::Serialize;

/// Lines that a report lists; a comb of harmonics would bury the rest of it.
const SHOWN_LINES: usize = 16;

/// Printed evidence. Each table is empty when the record has nothing for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Evidence {
    /// Conditions, without those on faults and instruments, which have tables of their own.
    pub conditions: Vec<Condition>,
    /// Faults and instruments, a line each.
    pub conditions_in_short: Vec<Condition>,
    /// Checks that this kind of test could make and did not.
    pub checks: Vec<Unmade>,
    /// The others, in one line; empty where there is none.
    pub checks_made: String,
    /// Faults of the recording and their budget.
    #[serde(flatten)]
    pub faults: Faults,
    /// Evaluated span.
    pub window: Vec<Field>,
    /// Spans left out.
    pub excluded: Vec<Excluded>,
    /// Spectral lines.
    pub lines: Vec<Line>,
    /// How many of the lines are shown; empty when all are.
    pub lines_shown: String,
    /// Noise models.
    pub models: Vec<Model>,
    /// How well the models fit, by view.
    pub goodness: Vec<Goodness>,
    /// The Allan family at octaves, a table for each channel.
    pub deviations: Vec<Deviations>,
    /// Steps of a rate table, a table for each channel.
    pub table_steps: Vec<super::TableSteps>,
    /// Runs or intervals, by channel.
    pub interval_means: Vec<super::IntervalMeans>,
    /// What this test can decide.
    pub power: Vec<Power>,
    /// Instruments.
    pub instruments: Vec<Instrument>,
    /// Waivers.
    pub waivers: Vec<Waiver>,
    /// Clauses.
    pub clauses: Vec<Clause>,
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
    pub coefficients: Vec<Coefficient>,
    /// Misfit per degree of freedom.
    pub misfit: String,
    /// Probability of a larger misfit if the model is right.
    pub probability: String,
    /// Where it misfits most; empty when it fits.
    pub band: String,
    /// Whether it describes the spectrum of the record, in words, with the probability of a larger misfit.
    pub fit: String,
    /// What limits the use of the model: the range of the fit, a misfit.
    pub remarks: Vec<ModelRemark>,
}

/// A coefficient of a noise model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coefficient {
    /// Symbol.
    pub label: String,
    /// Value with its unit.
    pub value: String,
    /// 95 % interval, in the same unit; empty where the record does not show the term.
    pub interval: String,
}

/// A remark on a noise model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelRemark {
    /// The remark, in words.
    pub text: String,
    /// True when the model does not describe the record.
    pub misfit: bool,
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
    pub(crate) fn new(record: &RunRecord, words: Translator) -> Evidence {
        let (lines, lines_shown) = strongest(&record.lines, words);
        let faults = Faults::new(record, words);
        let instruments: Vec<Instrument> =
            record.instruments.iter().map(|i| instrument(i, record, words)).collect();
        Evidence {
            conditions: conditions::conditions(record, words),
            conditions_in_short: in_short(record, &faults, &instruments, words),
            checks: checks::unmade(record, words),
            checks_made: checks::made(record, words),
            faults,
            window: window(record, words),
            excluded: record.window.excluded.iter().map(|e| excluded(e, &record.exclusions, words)).collect(),
            lines: lines.into_iter().map(|l| line(l, words)).collect(),
            lines_shown,
            models: record
                .noise_models
                .iter()
                .map(|m| model(m, &record.measurands, by_frequency(record, m), words))
                .collect(),
            goodness: goodness::goodness(record, words),
            deviations: deviations::deviations(record, words),
            table_steps: super::table_steps::table_steps(record, words),
            interval_means: super::interval_means::interval_means(record, words),
            power: record.power.iter().map(|p| power(p, words)).collect(),
            instruments,
            waivers: record.waivers.iter().map(|w| waiver(w, words)).collect(),
            clauses: record.clauses.iter().map(|c| clause(c, words)).collect(),
        }
    }
}

/// The faults of the recording and the instruments, a line each.
fn in_short(
    record: &RunRecord,
    faults: &Faults,
    instruments: &[Instrument],
    words: Translator,
) -> Vec<Condition> {
    let line =
        |key: &str, worst: ConditionStatus, required: String, found: String, evidence: &str| Condition {
            name: words.t(key),
            status: status(worst),
            status_word: words.name("status", status(worst)),
            required,
            evidence: words.name("evidence", evidence),
            found,
            note: String::new(),
        };
    let worst = |of: &dyn Fn(&str) -> bool| {
        let states = record.conditions.iter().filter(|c| of(&c.id)).map(|c| c.status);
        states.max().unwrap_or(ConditionStatus::Ok)
    };
    let mut lines = vec![];
    if record.conditions.iter().any(|c| faults::is_fault(&c.id)) {
        let found: Vec<String> =
            faults.found_faults.iter().map(|f| format!("{}\u{a0}{}", f.name, f.found)).collect();
        let found = if found.is_empty() { words.t("report.faultless") } else { found.join("; ") };
        let allowed = words.t("report.within_budget");
        lines.push(line("report.integrity", worst(&faults::is_fault), allowed, found, "recorded"));
    }
    if !instruments.is_empty() {
        let calibrated = record.conditions.iter().find(|c| c.id == "calibration");
        let required = calibrated.map_or_else(String::new, |c| required(c, words));
        let mut found: Vec<(&str, u64)> = vec![];
        for i in instruments {
            match found.iter_mut().find(|(word, _)| *word == i.status_word) {
                Some((_, n)) => *n += 1,
                None => found.push((&i.status_word, 1)),
            }
        }
        let found: Vec<String> =
            found.iter().map(|(word, n)| format!("{word} ({})", count(*n, words.lang))).collect();
        let mut state = worst(&|id| id == "calibration");
        if state == ConditionStatus::Ok && instruments.iter().any(|i| i.status != "ok") {
            state = ConditionStatus::Remark;
        }
        lines.push(line("condition.calibration", state, required, found.join("; "), "declared"));
    }
    lines
}

/// The evaluated span. A run that read nothing evaluated nothing, and left nothing out.
fn window(record: &RunRecord, words: Translator) -> Vec<Field> {
    let w = &record.window;
    if w.to_s <= w.from_s {
        return vec![];
    }
    [("report.window_from", w.from_s), ("report.window_to", w.to_s), ("report.window_usable", w.usable_s)]
        .into_iter()
        .map(|(key, s)| Field { label: words.t(key), value: duration(s, words.lang) })
        .collect()
}

/// A span left out; a declared one with the reasons that the procedure gives.
fn excluded(e: &ExcludedSpan, declared: &[ExclusionRecord], words: Translator) -> Excluded {
    let of = |d: &&ExclusionRecord| e.reason == "declared" && d.from_s < e.to_s && d.to_s > e.from_s;
    let reasons: Vec<String> = declared.iter().filter(of).map(|d| words.local(&d.reason)).collect();
    let word = words.name("excluded", &e.reason);
    Excluded {
        from: duration(e.from_s, words.lang),
        to: duration(e.to_s, words.lang),
        length: duration(e.to_s - e.from_s, words.lang),
        reason: if reasons.is_empty() {
            word
        } else {
            words.with("report.excluded_because", &[("kind", &word), ("reasons", &reasons.join("; "))])
        },
    }
}

fn power(p: &PowerRecord, words: Translator) -> Power {
    let hours = |h| words.quantity(&limit_digits(h, 3, words.lang), "h");
    Power {
        name: words.name("measurand", &p.id),
        channel: p.channel.clone(),
        limit: words.quantity(&limit(p.limit, words.lang), &p.unit),
        power: percent(p.power, words.lang),
        pass: percent(p.pass_probability, words.lang),
        needed: p.needed_h.map_or_else(|| NOTHING.to_owned(), hours),
        message: words.say(&p.message),
    }
}

fn instrument(i: &InstrumentRecord, record: &RunRecord, words: Translator) -> Instrument {
    Instrument {
        name: words.local(&i.name),
        serial: i.serial.clone().unwrap_or_else(|| NOTHING.to_owned()),
        due: i.calibration_due.clone().unwrap_or_else(|| NOTHING.to_owned()),
        status: if calibration(i, record) == "unidentified" { "remark" } else { status(i.status) },
        status_word: words.name("calibration", calibration(i, record)),
    }
}

/// Id of what is to be said of a calibration: why it is remarked on, where its condition says so.
fn calibration(i: &InstrumentRecord, record: &RunRecord) -> &'static str {
    let of_instrument = |n: &&Message| match n.args.get("instrument") {
        Some(Arg::Text(name)) => *name == i.name.text(),
        Some(Arg::Local(name)) => *name == i.name,
        _ => false,
    };
    let notes = record.conditions.iter().filter(|c| c.id == "calibration").filter_map(|c| c.message.as_ref());
    match notes.into_iter().find(of_instrument).map(|n| n.id.as_ref()) {
        Some("note.condition.calibration_unidentified") => "unidentified",
        Some("note.condition.calibration_overdue") => "overdue",
        Some("note.condition.calibration_unknown") => "unknown",
        // Results of earlier versions called an instrument without a serial number valid.
        _ if i.serial.is_none() && i.status == ConditionStatus::Ok => "unidentified",
        _ => status(i.status),
    }
}

fn waiver(w: &WaiverRecord, words: Translator) -> Waiver {
    Waiver {
        row: row_name(&w.row, words),
        by: words.local(&w.by),
        date: w.date.clone(),
        reason: words.local(&w.reason),
    }
}

fn clause(c: &ClauseRecord, words: Translator) -> Clause {
    Clause {
        clause: words.local(&c.clause),
        title: words.local(&c.title),
        status: c.status.clone(),
        status_word: words.name("clause", &c.status),
        note: words.local(&c.note),
    }
}

/// The strongest lines, by frequency, and how many they are of all.
fn strongest(lines: &[LineRecord], words: Translator) -> (Vec<&LineRecord>, String) {
    let mut shown: Vec<&LineRecord> = lines.iter().collect();
    shown.sort_by(|a, b| b.amplitude_deg_h.total_cmp(&a.amplitude_deg_h));
    shown.truncate(SHOWN_LINES);
    shown.sort_by(|a, b| a.channel.cmp(&b.channel).then(a.frequency_hz.total_cmp(&b.frequency_hz)));
    let hint = if shown.len() < lines.len() {
        let (n, all) = (count(shown.len() as u64, words.lang), count(lines.len() as u64, words.lang));
        words.with("report.lines_shown", &[("shown", &n), ("all", &all)])
    } else {
        String::new()
    };
    (shown, hint)
}

fn line(l: &LineRecord, words: Translator) -> Line {
    let lang = words.lang;
    let half = 0.5 * l.resolution_hz;
    let range = (l.frequency_hz - half, l.frequency_hz + half);
    Line {
        channel: l.channel.clone(),
        frequency: Rounding::of(l.frequency_hz, Some(range)).show(l.frequency_hz, lang),
        resolution: digits(l.resolution_hz, 2, lang),
        period: if l.frequency_hz > 0.0 { duration(1.0 / l.frequency_hz, lang) } else { NOTHING.to_owned() },
        amplitude: digits(l.amplitude_deg_h, 3, lang),
        excess: digits(l.excess, 3, lang),
        false_alarm: probability(l.false_alarm_probability, words),
    }
}

/// Relative difference below which a row and the model speak of the same value.
const SAME: f64 = 5e-3;

/// The view by frequency of the channel of a model.
fn by_frequency<'a>(record: &'a RunRecord, m: &NoiseModelRecord) -> Option<&'a GoodnessOfFitRecord> {
    record.goodness_of_fit.iter().find(|g| g.channel == m.channel && g.view == View::Frequency)
}

/// `fit`: the view by frequency of the channel, where the record is long enough for one.
fn model(
    m: &NoiseModelRecord,
    rows: &[MeasurandRecord],
    fit: Option<&GoodnessOfFitRecord>,
    words: Translator,
) -> Model {
    let lang = words.lang;
    let coefficients = [
        ("N", &measurand::ANGLE_RANDOM_WALK, m.angle_random_walk),
        ("B", &measurand::BIAS_INSTABILITY, m.bias_instability),
        ("K", &measurand::RATE_RANDOM_WALK, m.rate_random_walk),
        ("R", &measurand::RATE_RAMP, m.rate_ramp),
        ("Q", &measurand::QUANTIZATION, m.quantization),
    ]
    .map(|(symbol, term, value)| {
        let (id, unit) = (term.id, term.unit);
        // Its row has the interval, when it speaks of the same value: the fit that is drawn was polished once more.
        let row = rows.iter().find(|r| {
            r.id == id
                && r.channel == m.channel
                && r.unit == unit
                && value != 0.0
                && r.value.is_some_and(|v| (v - value).abs() < SAME * value.abs())
        });
        let (value, interval) = match row {
            Some(row) => {
                (words.quantity(&super::rows::value(row, words), unit), super::rows::interval(row, words))
            }
            None if value == 0.0 => (NOTHING.to_owned(), String::new()),
            None => (words.quantity(&limit_digits(value, 4, lang), unit), String::new()),
        };
        Coefficient { label: symbol.to_owned(), value, interval }
    });
    let terms: Vec<String> = m.terms.iter().map(|t| words.name("term", t.id())).collect();
    let mut remarks: Vec<ModelRemark> = vec![];
    let of_model = rows.iter().filter(|r| r.channel == m.channel).flat_map(|r| &r.notes);
    for note in of_model.filter(|n| MODEL_NOTES.contains(&n.id.as_ref())) {
        let remark = ModelRemark { text: words.say(note), misfit: note.id == "note.model_misfit" };
        if !remarks.contains(&remark) {
            remarks.push(remark);
        }
    }
    remarks.extend(m.remarks.iter().map(|note| ModelRemark { text: words.say(note), misfit: false }));
    // One question, one probability: that of the view by frequency, which stands beside the others of the goodness of fit.
    let p = probability(fit.map_or(m.misfit_probability, |f| f.p_value), words);
    // The remark on the misfit names the band.
    let misfit_said = remarks.iter().any(|r| r.misfit);
    let departs = misfit_said || fit.map_or(m.misfit_band_hz.is_some(), |f| f.departs);
    Model {
        channel: m.channel.clone(),
        method: words.name("how", &m.method),
        terms: if terms.is_empty() { NOTHING.to_owned() } else { terms.join(", ") },
        coefficients: coefficients.into(),
        misfit: digits(m.misfit, 3, lang),
        fit: words.with(if departs { "report.fit_departs" } else { "report.fit_good" }, &[("p", &p)]),
        probability: p,
        band: m.misfit_band_hz.filter(|_| !misfit_said).map_or_else(String::new, |[low, high]| {
            let range = words
                .with("report.interval", &[("low", &digits(low, 3, lang)), ("high", &digits(high, 3, lang))]);
            words.quantity(&range, "Hz")
        }),
        remarks,
    }
}
