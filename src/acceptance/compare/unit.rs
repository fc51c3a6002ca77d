//! One channel of one unit, read from a result.

use super::faults;
use super::rules::{RuleRow, rules};
use super::says;
use crate::estimate::{Interval, UpperLimit};
use crate::i18n::{Arg, Note};
use crate::measurand;
use crate::record::ComparisonRecord;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Where a unit's values come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// A recording that was analysed for the comparison.
    Recording,
    /// A `result.json` that was there.
    Result,
}

/// One measured quantity as it stands in a result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// Id of the measurand.
    pub id: String,
    /// Channel.
    pub channel: String,
    /// Value; absent where the record cannot show it.
    pub value: Option<f64>,
    /// Unit.
    pub unit: String,
    /// 95 % interval.
    pub interval: Option<Interval>,
    /// Bound where there is no value.
    pub upper_limit: Option<UpperLimit>,
    /// The limit this very quantity was judged by.
    #[serde(default)]
    pub limit: Option<Limit>,
    /// What was decided.
    #[serde(default)]
    pub verdict: String,
    /// What its notes say, by their ids.
    #[serde(default, skip_serializing)]
    pub notes: Vec<NoteId>,
}

/// The id of a note of a result.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
pub struct NoteId {
    /// Its id.
    #[serde(default)]
    pub id: String,
}

/// A limit as a result holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// Lowest value allowed.
    pub min: Option<f64>,
    /// Highest value allowed.
    pub max: Option<f64>,
    /// Unit of both.
    pub unit: String,
    /// File it stands in.
    #[serde(default)]
    pub source: String,
}

/// One channel of one unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unit {
    /// Serial number, or the name of the file.
    pub name: String,
    /// Channel.
    pub channel: String,
    /// True when the unit has more than one channel here.
    pub several: bool,
    /// File or folder as given.
    pub path: String,
    /// Where the values come from.
    pub origin: Origin,
    /// SHA-256 of the files of the recording.
    pub recording_sha256: Vec<String>,
    /// Usable time of the record, s.
    pub length_s: Option<f64>,
    /// The quantities of the comparison that the result holds.
    pub quantities: Vec<Quantity>,
    /// Allan bias instability under each read-out rule, with the ratios.
    pub rules: Vec<RuleRow>,
    /// Window statistics, predictions, octaves, null; absent where the result lacks them.
    pub detail: Option<ComparisonRecord>,
    /// True where the model departs from the record, so that what it predicts is indicative.
    pub indicative: bool,
    /// What it all says.
    #[serde(serialize_with = "crate::record::message::notes::serialize")]
    pub says: Vec<Note>,
    /// What could not be compared, and why.
    #[serde(serialize_with = "crate::record::message::notes::serialize")]
    pub missing: Vec<Note>,
}

/// The quantities that a comparison takes from a result.
const COMPARED: &[&str] = &[
    measurand::RUSSIAN_DRIFT_100S.id,
    measurand::RUSSIAN_DRIFT_100S_3SIGMA.id,
    measurand::RUSSIAN_SIGMA_10S.id,
    measurand::RUSSIAN_ARW_10S.id,
    measurand::RUSSIAN_DRIFT_100S_PREDICTED.id,
    measurand::BIAS_INSTABILITY_MINIMUM.id,
    measurand::BIAS_INSTABILITY_MINIMUM_SCALED.id,
    measurand::BIAS_INSTABILITY.id,
    measurand::ANGLE_RANDOM_WALK.id,
    measurand::RATE_RANDOM_WALK.id,
    measurand::RATIO_RUSSIAN_TO_ALLAN_BIAS.id,
    measurand::RATIO_RUSSIAN_TO_ALLAN_ARW.id,
];

/// Why a result cannot be compared.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitError(pub Note);

impl Unit {
    /// A quantity by id.
    pub fn quantity(&self, id: &str) -> Option<&Quantity> {
        self.quantities.iter().find(|q| q.id == id)
    }

    /// The value of a quantity.
    pub fn value(&self, id: &str) -> Option<f64> {
        self.quantity(id)?.value
    }

    /// The name with the channel where it has several.
    pub fn label(&self) -> String {
        if self.several { format!("{} · {}", self.name, self.channel) } else { self.name.clone() }
    }
}

/// The units of a result: one for each channel that has a quantity of the comparison.
///
/// # Errors
/// A result of another format, or one whose run failed.
pub fn units_of(result: &Value, path: &str, stem: &str, origin: Origin) -> Result<Vec<Unit>, UnitError> {
    let refuse = |key: &'static str| UnitError(Note::new(key).with("path", path));
    if result.get("format").and_then(Value::as_str) != Some(crate::record::RESULT_FORMAT) {
        return Err(refuse("compare.error.not_a_result"));
    }
    let rows = result.get("measurands").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let quantities: Vec<Quantity> = rows
        .iter()
        .filter(|r| r.get("id").and_then(Value::as_str).is_some_and(|id| COMPARED.contains(&id)))
        .map(|r| Quantity::deserialize(r).map_err(|_| refuse("compare.error.not_a_result")))
        .collect::<Result<_, _>>()?;
    if quantities.is_empty() {
        return Err(refuse("compare.error.nothing"));
    }
    let details: Vec<ComparisonRecord> = match result.get("comparison") {
        Some(list) => Vec::deserialize(list).map_err(|_| refuse("compare.error.not_a_result"))?,
        None => vec![],
    };
    let serial = result.pointer("/unit_under_test/serial").and_then(Value::as_str);
    let files = result.get("recording").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let digest = |f: &Value| Some(f.get("sha256")?.as_str()?.to_owned());
    let recording_sha256: Vec<String> = files.iter().filter_map(digest).collect();
    let mut channels: Vec<&str> = vec![];
    for q in &quantities {
        if !channels.contains(&q.channel.as_str()) {
            channels.push(&q.channel);
        }
    }
    let unit = |channel: &&str| {
        let mut unit = Unit {
            name: serial.filter(|s| !s.trim().is_empty()).unwrap_or(stem).to_owned(),
            channel: (*channel).to_owned(),
            several: channels.len() > 1,
            path: path.to_owned(),
            origin,
            recording_sha256: recording_sha256.clone(),
            length_s: result.pointer("/window/usable_s").and_then(Value::as_f64).filter(|t| *t > 0.0),
            quantities: quantities.iter().filter(|q| q.channel == *channel).cloned().collect(),
            rules: vec![],
            detail: details.iter().find(|d| d.channel == *channel).cloned(),
            indicative: false,
            says: faults::of_recording(result),
            missing: vec![],
        };
        unit.rules = rules(&unit);
        let departs = faults::of_model(result, channel);
        let misfit = unit.detail.as_ref().and_then(says::misfit);
        unit.indicative = departs.is_some() || misfit.is_some();
        unit.says.extend(misfit.or(departs));
        unit.says.extend(faults::jump(result, channel));
        unit.says.extend(says::sentences(&unit));
        unit.missing = says::missing(&unit);
        // The limits of a recording are those of the file that came with it, rows or not.
        let limited = |r: &&Value| {
            origin == Origin::Result
                && r.get("channel").and_then(Value::as_str) == Some(channel)
                && r.get("limit").is_some_and(|l| !l.is_null())
        };
        let ids = rows.iter().filter(limited).filter_map(|r| r.get("id").and_then(Value::as_str));
        unit.missing.extend(not_compared(ids));
        unit
    };
    Ok(channels.iter().map(unit).collect())
}

/// Said of limits on what no comparison holds.
pub fn not_compared<'a>(limited: impl Iterator<Item = &'a str>) -> Option<Note> {
    let mut ids: Vec<&str> = limited.filter(|id| !COMPARED.contains(id)).collect();
    ids.dedup();
    let names: Vec<Arg> = ids.into_iter().map(|id| Arg::Key(format!("measurand.{id}"))).collect();
    (!names.is_empty())
        .then(|| Note::new("compare.more.limits").with("names", Arg::Several(names, ", ".into())))
}

/// Tells units of the same name apart: by the name of their file, and where that is the same too, by their path.
pub fn tell_apart(units: &mut [Unit]) {
    let file = |u: &Unit| {
        let name = std::path::Path::new(&u.path).file_name();
        name.map_or_else(|| u.path.clone(), |n| n.to_string_lossy().into_owned())
    };
    for by in [file, |u: &Unit| u.path.clone()] {
        let shared: Vec<bool> =
            units.iter().map(|u| units.iter().any(|o| o.path != u.path && o.label() == u.label())).collect();
        for (unit, shared) in units.iter_mut().zip(shared) {
            if shared {
                unit.name = by(unit);
            }
        }
    }
}

/// Says of each unit that an earlier one comes from the same recording and channel: it is no second piece of evidence.
pub fn tell_repeated(units: &mut [Unit]) {
    let first: Vec<Option<String>> = units
        .iter()
        .enumerate()
        .map(|(i, unit)| {
            let same = |u: &&Unit| u.recording_sha256 == unit.recording_sha256 && u.channel == unit.channel;
            let known = !unit.recording_sha256.is_empty();
            known.then(|| units.iter().take(i).find(same).map(Unit::label)).flatten()
        })
        .collect();
    for (unit, first) in units.iter_mut().zip(first) {
        if let Some(name) = first {
            unit.missing.insert(0, Note::new("compare.more.repeated").with("name", name));
        }
    }
}
