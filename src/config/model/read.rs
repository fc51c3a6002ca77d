//! A claim from a TOML file, with every problem at its place.

use super::tables::{DriverKeys, EffectKeys, MODEL_FILE, ModelTables, SimulationKeys};
use super::{Claim, ModelFile, Profile, SimulationPlan, Stated, Uncertainty};
use crate::config::diagnostics::Problems;
use crate::config::read_tables::checked;
use crate::config::reader::{Reader, shorten};
use crate::config::section::{Given, Named, Section};
use crate::config::table::Table;
use crate::config::text_file::{self, Wording};
use crate::effect::{
    self, ClaimedMean, Column, Drivers, EFFECTS, Earth, Effect, Param, Temperature, Value, Values,
};
use crate::i18n::note;
use crate::noise::model::NoiseModel;
use sagnac_core::spelling::nearest;
use std::path::Path;

/// Messages for a claim that cannot be read at all.
const READ_MESSAGES: Wording = Wording { unreadable: "model_file.unreadable", folder: "model_file.folder" };

/// The parameter that the report of every effect gives, beside those of its forward model.
const RMS_PARAMETER: &str = "rms_deg_h";

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
    parse(&path.display().to_string(), &text_file::bytes(path, &READ_MESSAGES)?)
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
    let tables = ModelTables::read(root);
    let (recording, noise, known) = (tables.recording, tables.noise, tables.uncertainty);
    let columns = recording.columns.map(|names| {
        let beside = names.iter().filter(|n| !["time_s", "rate_deg_h"].contains(&n.as_str()));
        beside.map(|n| Column::of_name(n)).collect::<Vec<Column>>()
    });
    let claim = Claim {
        case: recording.case,
        description: recording.description,
        sample_rate_hz: recording.sample_rate_hz,
        columns,
        noise: NoiseModel {
            n: noise.n_deg_rt_h,
            b: noise.b_deg_h,
            k: noise.k_deg_h_rt_h,
            r: 0.0,
            q: noise.quantization_lsb_arcsec / 12f64.sqrt(),
        },
        quantization_lsb_arcsec: noise.quantization_lsb_arcsec,
        mean: ClaimedMean {
            bias_deg_h: tables.bias.value_deg_h,
            temperature: tables.temperature.map(|t| Temperature {
                coefficient_deg_h_per_degc: t.coefficient_deg_h_per_degc,
                reference_degc: t.reference_degc,
            }),
            scale_factor_ppm: tables.scale_factor.map(|s| s.error_ppm),
            earth: tables.earth.map(|e| Earth { latitude_deg: e.latitude_deg, azimuth_deg: e.azimuth_deg }),
        },
        uncertainty: Uncertainty {
            n_rel: known.n_rel,
            b_rel: known.b_rel,
            k_rel: known.k_rel,
            n_deg_rt_h: known.n_deg_rt_h,
            b_deg_h: known.b_deg_h,
            k_deg_h_rt_h: known.k_deg_h_rt_h,
            n_at_most_deg_rt_h: known.n_at_most_deg_rt_h,
            b_at_most_deg_h: known.b_at_most_deg_h,
            k_at_most_deg_h_rt_h: known.k_at_most_deg_h_rt_h,
            bias_deg_h: known.bias_deg_h,
            temperature_coefficient_deg_h_per_degc: known.temperature_coefficient_deg_h_per_degc,
            scale_factor_ppm: known.scale_factor_ppm,
            skewness: known.skewness,
        },
        effects: tables.effects.into_iter().filter_map(|keys| keys.stated(reader)).collect(),
    };
    let simulation = plan(tables.simulation, reader);
    ModelFile { claim, simulation, drivers: drivers(tables.drivers, reader) }
}

impl EffectKeys {
    /// An effect with its parameters, checked.
    pub(crate) fn stated(self, reader: &mut Reader<'_>) -> Option<Stated> {
        let kind = self.kind.as_deref()?;
        let Some(effect) = effect::find(kind) else {
            let help = match nearest(kind, EFFECTS.iter().map(|e| e.kind())) {
                Some(near) => note!("keyed.help.did_you_mean_value", value = near),
                None => note!("model_file.help.kinds"),
            };
            let at = reader.source.inside_quotes(&self.section.span_of("kind"));
            reader.error(&at, note!("model_file.no_kind", kind = shorten(kind)), Some(help));
            return None;
        };
        let mut values = Values::new();
        for named in &self.parameters {
            if let Some(value) = value(effect, named, reader) {
                values.insert(named.name.clone(), value);
            }
        }
        if let effect::Model::Spectrum(spectrum) = effect.model()
            && self.parameters.len() == values.len()
            && spectrum.claimed_parameters(&values).is_none()
            && effect
                .claimed_course(&values, &Drivers { samples: 1, dt_s: 1.0, ..Drivers::default() })
                .is_none()
        {
            let all = effect.params().iter().chain(effect.list_params());
            let missing: Vec<&str> = all.map(|p| p.name).filter(|n| !values.contains_key(*n)).collect();
            let message = note!("model_file.missing", kind = effect.kind());
            let help = if missing.is_empty() {
                note!("model_file.help.unfit")
            } else {
                note!("model_file.help.missing", names = missing.join(", "))
            };
            reader.error(&self.section.span_of("kind"), message, Some(help));
        }
        Some(Stated { effect, values })
    }
}

/// A parameter of an effect, checked.
fn value(effect: &'static dyn Effect, named: &Named, reader: &mut Reader<'_>) -> Option<Value> {
    let find = |list: &'static [Param]| list.iter().find(|p| p.name == named.name);
    let outside = |p: &Param, v: f64| !(p.lower..=p.upper).contains(&v);
    let wrong = |p: &Param, reader: &mut Reader<'_>| {
        let bounds = crate::config::spec::Range::between(p.lower, p.upper).describe(p.unit);
        let message = note!("keyed.out_of_range", key = p.name, range = bounds);
        reader.error(&named.span, message, None);
    };
    match (&named.given, find(effect.params()), find(effect.list_params())) {
        (Given::Number(v), _, _) if named.name == RMS_PARAMETER => Some(Value::Number(*v)),
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
            reader.error(&named.span, note!("model_file.no_number", name = named.name.as_str()), None);
            None
        }
        (_, _, Some(_)) => {
            reader.error(&named.span, note!("model_file.no_list", name = named.name.as_str()), None);
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
        Some(near) => note!("keyed.help.did_you_mean", name = near),
        None if known.is_empty() => note!("model_file.help.no_parameters"),
        None => note!("keyed.help.known", keys = known.join(", ")),
    };
    let message = note!("model_file.no_parameter", kind = effect.kind(), name = shorten(&named.name));
    reader.error(&named.at, message, Some(help));
}

fn plan(keys: SimulationKeys, reader: &mut Reader<'_>) -> SimulationPlan {
    if keys.seed.is_some_and(|s| s.fract() != 0.0) {
        let message = note!("reading.whole", key = "seed");
        reader.error(&keys.section.span_of("seed"), message, None);
    }
    let seed = keys.seed.map(|s| s as u64);
    SimulationPlan { duration_s: keys.duration_s, seed, start_s: keys.start_s }
}

fn drivers(tables: Vec<DriverKeys>, reader: &mut Reader<'_>) -> Vec<Profile> {
    let mut found: Vec<Profile> = vec![];
    for keys in tables {
        let (Some(column), Some(time_s), Some(value)) = (keys.column, keys.time_s, keys.value) else {
            continue;
        };
        let place = |key: &str| keys.section.span_of(key);
        if found.iter().any(|p| p.column == column) {
            let message = note!("model_file.driver_twice", column = column.name());
            reader.error(&reader.source.inside_quotes(&place("column")), message, None);
        }
        if time_s.len() != value.len() {
            let message = note!("model_file.points", times = time_s.len(), values = value.len());
            reader.error(&place("value"), message, Some("model_file.help.points".into()));
        }
        if time_s.windows(2).any(|w| w[1] < w[0]) {
            reader.error(&place("time_s"), "model_file.falling", None);
        }
        if keys.sine_amplitude != 0.0 && keys.sine_period_s.is_none() {
            reader.error(
                &place("sine_amplitude"),
                "model_file.no_period",
                Some("model_file.help.period".into()),
            );
        }
        found.push(Profile {
            column,
            time_s,
            value,
            sine_amplitude: keys.sine_amplitude,
            sine_period_s: keys.sine_period_s.unwrap_or_default(),
            sine_phase_deg: keys.sine_phase_deg,
            noise: keys.noise,
        });
    }
    found
}
