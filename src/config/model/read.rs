//! A claim from a TOML file, with every problem at its place.

use super::tables::MODEL_FILE;
use super::{Claim, ModelFile, Profile, SimulationPlan, Stated, Uncertainty};
use crate::config::diagnostics::Problems;
use crate::config::read_tables::checked;
use crate::config::reader::{Reader, shorten};
use crate::config::section::{Given, Named, Section};
use crate::config::text_file::{self, Wording};
use crate::effect::{
    self, ClaimedMean, Column, Drivers, EFFECTS, Earth, Effect, Param, Temperature, Value, Values,
};
use crate::i18n::Note;
use crate::noise::model::NoiseModel;
use sagnac_core::spelling::nearest;
use std::path::Path;

/// What is said of a claim that cannot be read at all.
const WORDING: Wording = Wording { unreadable: "model_file.unreadable", folder: "model_file.folder" };

/// The parameter that the report of every effect gives, beside those of its forward model.
const RMS: &str = "rms_deg_h";

/// Reads a claim.
///
/// # Errors
/// Every problem of the file, each with its place.
pub fn load(path: &Path) -> Result<Claim, Problems> {
    load_model(path).map(|m| m.claim)
}

/// Reads a claim with what `simulate` needs beside it.
///
/// # Errors
/// As [`load`].
pub fn load_model(path: &Path) -> Result<ModelFile, Problems> {
    parse(&path.display().to_string(), &text_file::bytes(path, &WORDING)?)
}

/// Reads a claim from the bytes of a file; `name` stands in diagnostics.
///
/// # Errors
/// Every problem of the text.
pub fn parse(name: &str, bytes: &[u8]) -> Result<ModelFile, Problems> {
    let (model, problems) = checked(&text_file::source(name, bytes)?, &MODEL_FILE, build);
    model.ok_or(problems)
}

fn build(root: &Section, reader: &mut Reader<'_>) -> ModelFile {
    let number = |table: &str, key: &str| root.table(table).and_then(|t| t.number(key));
    let text = |key: &str| root.table("recording").and_then(|t| t.text(key)).unwrap_or_default();
    let noise = |key: &str| number("noise", key).unwrap_or(0.0);
    let known = |key: &str| number("uncertainty", key).unwrap_or(0.0);
    let quantization_lsb_arcsec = noise("quantization_lsb_arcsec");
    let columns = root.table("recording").and_then(|t| t.names("columns")).map(|names| {
        let beside = names.iter().filter(|n| !["time_s", "rate_deg_h"].contains(&n.as_str()));
        beside.map(|n| Column::of_name(n)).collect::<Vec<Column>>()
    });
    let temperature = number("temperature", "coefficient_deg_h_per_degC").map(|coefficient| Temperature {
        coefficient_deg_h_per_degc: coefficient,
        reference_degc: number("temperature", "reference_degC").unwrap_or(20.0),
    });
    let earth = number("earth", "latitude_deg").map(|latitude_deg| Earth {
        latitude_deg,
        azimuth_deg: number("earth", "azimuth_deg").unwrap_or(0.0),
    });
    let claim = Claim {
        case: text("case"),
        description: root.table("recording").and_then(|t| t.local_text("description")).unwrap_or_default(),
        sample_rate_hz: number("recording", "sample_rate_hz").unwrap_or(1.0),
        columns,
        noise: NoiseModel {
            n: noise("N_deg_rt_h"),
            b: noise("B_deg_h"),
            k: noise("K_deg_h_rt_h"),
            r: 0.0,
            q: quantization_lsb_arcsec / 12f64.sqrt(),
        },
        quantization_lsb_arcsec,
        mean: ClaimedMean {
            bias_deg_h: number("bias", "value_deg_h").unwrap_or(0.0),
            temperature,
            scale_factor_ppm: number("scale_factor", "error_ppm"),
            earth,
        },
        uncertainty: Uncertainty {
            n_rel: known("N_rel"),
            b_rel: known("B_rel"),
            k_rel: known("K_rel"),
            n_deg_rt_h: known("N_deg_rt_h"),
            b_deg_h: known("B_deg_h"),
            k_deg_h_rt_h: known("K_deg_h_rt_h"),
            n_at_most_deg_rt_h: known("N_at_most_deg_rt_h"),
            b_at_most_deg_h: known("B_at_most_deg_h"),
            k_at_most_deg_h_rt_h: known("K_at_most_deg_h_rt_h"),
            bias_deg_h: known("bias_deg_h"),
            temperature_coefficient_deg_h_per_degc: known("temperature_coefficient_deg_h_per_degC"),
            scale_factor_ppm: known("scale_factor_ppm"),
            skewness: known("skewness"),
        },
        effects: root.tables("effect").iter().filter_map(|s| stated(s, reader)).collect(),
    };
    let simulation = root.table("simulation").map(|s| plan(s, reader));
    ModelFile { claim, simulation: simulation.unwrap_or_default(), drivers: drivers(root, reader) }
}

/// An effect with its parameters, checked.
pub(crate) fn stated(section: &Section, reader: &mut Reader<'_>) -> Option<Stated> {
    let kind = section.text("kind")?;
    let Some(effect) = effect::find(&kind) else {
        let help = match nearest(&kind, EFFECTS.iter().map(|e| e.kind())) {
            Some(near) => Note::new("keyed.help.did_you_mean_value").with("value", near),
            None => Note::new("model_file.help.kinds"),
        };
        let at = reader.source.inside_quotes(&section.span_of("kind"));
        reader.error(&at, Note::new("model_file.no_kind").with("kind", shorten(&kind)), Some(help));
        return None;
    };
    let mut values = Values::new();
    for named in section.values("parameters") {
        if let Some(value) = value(effect, named, reader) {
            values.insert(named.name.clone(), value);
        }
    }
    if let effect::Model::Spectrum(spectrum) = effect.model()
        && section.values("parameters").len() == values.len()
        && spectrum.claimed_parameters(&values).is_none()
        && effect.claimed_course(&values, &Drivers { samples: 1, dt_s: 1.0, ..Drivers::default() }).is_none()
    {
        let all = effect.params().iter().chain(effect.list_params());
        let missing: Vec<&str> = all.map(|p| p.name).filter(|n| !values.contains_key(*n)).collect();
        let message = Note::new("model_file.missing").with("kind", effect.kind());
        let help = if missing.is_empty() {
            Note::new("model_file.help.unfit")
        } else {
            Note::new("model_file.help.missing").with("names", missing.join(", "))
        };
        reader.error(&section.span_of("kind"), message, Some(help));
    }
    Some(Stated { effect, values })
}

/// A parameter of an effect, checked.
fn value(effect: &'static dyn Effect, named: &Named, reader: &mut Reader<'_>) -> Option<Value> {
    let find = |list: &'static [Param]| list.iter().find(|p| p.name == named.name);
    let outside = |p: &Param, v: f64| !(p.lower..=p.upper).contains(&v);
    let wrong = |p: &Param, reader: &mut Reader<'_>| {
        let bounds = crate::config::spec::Range::between(p.lower, p.upper).describe(p.unit);
        let message = Note::new("keyed.out_of_range").with("key", p.name).with("range", bounds);
        reader.error(&named.span, message, None);
    };
    match (&named.given, find(effect.params()), find(effect.list_params())) {
        (Given::Number(v), _, _) if named.name == RMS => Some(Value::Number(*v)),
        (Given::Number(v), Some(p), _) => {
            if outside(p, *v) {
                wrong(p, reader);
                return None;
            }
            Some(Value::Number(*v))
        }
        (Given::List(list), _, Some(p)) => {
            if list.iter().any(|v| outside(p, *v)) {
                wrong(p, reader);
                return None;
            }
            Some(Value::List(list.clone()))
        }
        (Given::Text(text), None, None) if effect.text_params().contains(&named.name.as_str()) => {
            Some(Value::Text(text.clone()))
        }
        (_, Some(_), _) => {
            reader.error(
                &named.span,
                Note::new("model_file.no_number").with("name", named.name.as_str()),
                None,
            );
            None
        }
        (_, _, Some(_)) => {
            reader.error(
                &named.span,
                Note::new("model_file.no_list").with("name", named.name.as_str()),
                None,
            );
            None
        }
        _ => {
            unknown(effect, named, reader);
            None
        }
    }
}

fn unknown(effect: &'static dyn Effect, named: &Named, reader: &mut Reader<'_>) {
    let numbers = effect.params().iter().chain(effect.list_params()).map(|p| p.name);
    let known: Vec<&str> = numbers.chain(effect.text_params().iter().copied()).collect();
    let help = match nearest(&named.name, known.iter().copied()) {
        Some(near) => Note::new("keyed.help.did_you_mean").with("name", near),
        None if known.is_empty() => Note::new("model_file.help.no_parameters"),
        None => Note::new("keyed.help.known").with("keys", known.join(", ")),
    };
    let message =
        Note::new("model_file.no_parameter").with("kind", effect.kind()).with("name", shorten(&named.name));
    reader.error(&named.at, message, Some(help));
}

fn plan(section: &Section, reader: &mut Reader<'_>) -> SimulationPlan {
    let seed = section.number("seed");
    if seed.is_some_and(|s| s.fract() != 0.0) {
        reader.error(&section.span_of("seed"), Note::new("reading.whole").with("key", "seed"), None);
    }
    SimulationPlan {
        duration_s: section.number("duration_s"),
        seed: seed.map(|s| s as u64),
        start_s: section.number("start_s").unwrap_or(0.0),
    }
}

fn drivers(root: &Section, reader: &mut Reader<'_>) -> Vec<Profile> {
    let mut found: Vec<Profile> = vec![];
    for section in root.tables("driver") {
        let (Some(word), Some(time_s), Some(value)) =
            (section.word("column"), section.numbers("time_s"), section.numbers("value"))
        else {
            continue;
        };
        let Some(column) = Column::KNOWN.into_iter().find(|c| c.name() == word) else { continue };
        let place = |key: &str| section.span_of(key);
        if found.iter().any(|p| p.column == column) {
            let message = Note::new("model_file.driver_twice").with("column", word);
            reader.error(&reader.source.inside_quotes(&place("column")), message, None);
        }
        if time_s.len() != value.len() {
            let message =
                Note::new("model_file.points").with("times", time_s.len()).with("values", value.len());
            reader.error(&place("value"), message, Some("model_file.help.points".into()));
        }
        if time_s.windows(2).any(|w| w[1] < w[0]) {
            reader.error(&place("time_s"), "model_file.falling", None);
        }
        let (amplitude, period) = (section.number("sine_amplitude"), section.number("sine_period_s"));
        if amplitude.is_some_and(|a| a != 0.0) && period.is_none() && !section.flag("sine_period_s") {
            reader.error(
                &place("sine_amplitude"),
                "model_file.no_period",
                Some("model_file.help.period".into()),
            );
        }
        found.push(Profile {
            column,
            time_s: time_s.to_vec(),
            value: value.to_vec(),
            sine_amplitude: amplitude.unwrap_or(0.0),
            sine_period_s: period.unwrap_or(0.0),
            sine_phase_deg: section.number("sine_phase_deg").unwrap_or(0.0),
            noise: section.number("noise").unwrap_or(0.0),
        });
    }
    found
}
