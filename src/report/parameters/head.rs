//! The head of an exported file, in words: conventions, what each value stands for, what was left out, what error the form leaves.

use super::axis::{Axis, Level};
use super::form::{FormError, RatioAt, one_process};
use super::quantity::Source;
use super::target::Target;
use crate::i18n::{Arg, Lang, Localize, Note, note};
use crate::measurand::{BIAS_INSTABILITY, Measurand, QUANTIZATION, RATE_RAMP, RATE_RANDOM_WALK};
use crate::record::RunRecord;
use crate::report::generator;
use crate::report::unit::pretty;

/// Names of the axes.
const AXIS_NAMES: [&str; 3] = ["x", "y", "z"];

/// Significant digits of values.
const DIGITS: usize = 4;

fn quantity(m: &Measurand) -> Arg {
    Arg::key("measurand", m.id)
}

/// Unit, procedure, program and conventions.
pub fn introduction(record: &RunRecord, target: &Target, lang: Lang) -> Vec<String> {
    let unit = record.unit_under_test.serial.as_deref();
    let serial =
        unit.map_or_else(|| Arg::from(Note::new("export.no_serial")), |serial| Arg::Text(serial.to_owned()));
    let of = note!("export.of", unit = serial, program = generator());
    vec![of.say(lang), Note::new(target.convention).say(lang)]
}

/// The lines of one axis.
pub fn of_axis(
    index: usize,
    axis: &Axis,
    error: Option<FormError>,
    target: &Target,
    lang: Lang,
) -> Vec<String> {
    let name = AXIS_NAMES.get(index).copied().unwrap_or_default();
    let mut notes = vec![note!("export.axis", axis = name, channel = axis.channel.as_str())];
    for q in target.quantities {
        if let Some((m, level)) = q.source.row(axis) {
            notes.push(row(m, level, lang).with("name", q.name));
        }
    }
    if target.quantities.iter().any(|q| q.source == Source::SlowProcess) {
        notes.push(process(axis));
    }
    notes.extend(left_out(axis, target, lang));
    if let Some(error) = error {
        notes.push(form_error(&error));
    }
    notes.iter().map(|n| n.say(lang)).collect()
}

/// What the value of a quantity stands for.
fn row(m: &Measurand, level: Level, lang: Lang) -> Note {
    let unit = pretty(m.unit, lang);
    let shown = |v: f64| Arg::rounded(v, DIGITS);
    match level {
        Level::Measured { value, interval: Some(i) } => note!(
            "export.measured",
            quantity = quantity(m),
            value = shown(value),
            low = shown(i.low),
            high = shown(i.high),
            unit = unit,
            percent = Arg::rounded(100.0 * i.coverage, 3)
        ),
        Level::Measured { value, interval: None } => {
            note!("export.without_interval", quantity = quantity(m), value = shown(value), unit = unit)
        }
        Level::AtMost { value, coverage } => note!(
            "export.at_most",
            quantity = quantity(m),
            value = shown(value),
            unit = unit,
            percent = Arg::rounded(100.0 * coverage, 3)
        ),
        Level::NotStated => note!("export.not_stated", quantity = quantity(m)),
    }
}

/// What the one process stands for.
fn process(axis: &Axis) -> Note {
    let Some(process) = one_process(axis) else { return Note::new("export.no_process") };
    let key = match (axis.markov.is_empty(), axis.flicker) {
        (false, _) => "export.process_of_markov",
        (true, Level::AtMost { .. }) => "export.process_of_limit",
        _ => "export.process_of_flicker",
    };
    Note::new(key)
        .with("rms", Arg::rounded(process.rms_deg_h, DIGITS))
        .with("time_s", Arg::rounded(process.decay_time_s, DIGITS))
}

/// What was measured and has no place in the form.
fn left_out(axis: &Axis, target: &Target, lang: Lang) -> Vec<Note> {
    let places = target.places;
    let rows = [
        (&RATE_RANDOM_WALK, axis.random_walk, places.random_walk),
        (&BIAS_INSTABILITY, axis.flicker, places.holds_flicker(axis)),
        (&QUANTIZATION, axis.quantization, false),
        (&RATE_RAMP, axis.ramp, false),
    ];
    let mut notes: Vec<Note> = rows
        .into_iter()
        .filter(|(_, level, held)| !held && level.measured() != 0.0)
        .map(|(m, level, _)| {
            let (value, unit) = (Arg::rounded(level.measured(), DIGITS), pretty(m.unit, lang));
            note!("export.left_out", quantity = quantity(m), value = value, unit = unit)
        })
        .collect();
    let processes = axis.markov.len() - places.markov_held(axis) + axis.quasi_periodic.len();
    if processes > 0 {
        notes.push(note!("export.processes_left_out", n = processes));
    }
    notes
}

fn form_error(error: &FormError) -> Note {
    let ratio = |r: RatioAt| Arg::rounded(r.ratio, 3);
    let time = |s: f64| Arg::rounded(s, 3);
    note!(
        "export.form_error",
        lowest = ratio(error.lowest),
        lowest_s = time(error.lowest.tau_s),
        highest = ratio(error.highest),
        highest_s = time(error.highest.tau_s),
        from_s = time(error.from_s),
        to_s = time(error.to_s)
    )
}

/// The axes that were not measured, and what stands for them.
pub fn repeated(measured: usize, worst: &Axis, lang: Lang) -> String {
    let missing = AXIS_NAMES.get(measured..).unwrap_or_default().join(", ");
    note!("export.repeated", missing = missing, channel = worst.channel.as_str()).say(lang)
}

/// The factor with which the form understates the deviation nowhere.
pub fn inflation(factor: f64, applied: bool, lang: Lang) -> String {
    let shown = Arg::rounded(factor, 3);
    let note = match (applied, factor.is_finite(), factor > 1.0 + 1e-9) {
        (_, false, _) => Note::new("export.no_factor"),
        (_, _, false) => Note::new("export.factor_one"),
        (true, ..) => note!("export.inflated", factor = shown),
        (false, ..) => note!("export.factor", factor = shown),
    };
    note.say(lang)
}
