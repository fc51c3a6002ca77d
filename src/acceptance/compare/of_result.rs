//! The units of a result.

use super::rules::rules;
use super::unit::{Origin, Unit};
use super::{faults, summary};
use crate::acceptance::verdict::contradicted;
use crate::i18n::{Arg, Note, note};
use crate::measurand;
use crate::record::{MeasurandRecord, RunRecord};

/// The quantities that a comparison takes from a result.
const COMPARED_MEASURANDS: &[&str] = &[
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

/// The units of a result: one for each channel that has a quantity of the comparison.
///
/// # Errors
/// A note on a result that has none, such as one whose run failed.
pub fn units_of(result: &RunRecord, path: &str, stem: &str, origin: Origin) -> Result<Vec<Unit>, Note> {
    let rows = result.measurands.iter().filter(|r| COMPARED_MEASURANDS.contains(&r.id.as_str()));
    let quantities: Vec<&MeasurandRecord> = rows.collect();
    if quantities.is_empty() {
        return Err(note!("compare.error.nothing", path));
    }
    let serial = result.unit_under_test.serial.as_deref().filter(|s| !s.trim().is_empty());
    let mut channels: Vec<&str> = vec![];
    for q in &quantities {
        if !channels.contains(&q.channel.as_str()) {
            channels.push(&q.channel);
        }
    }
    let unit = |channel: &&str| {
        let mut unit = Unit {
            name: serial.unwrap_or(stem).to_owned(),
            channel: (*channel).to_owned(),
            several: channels.len() > 1,
            path: path.to_owned(),
            origin,
            recording_sha256: result.recording.iter().map(|f| f.sha256.clone()).collect(),
            length_s: Some(result.window.usable_s).filter(|t| *t > 0.0),
            quantities: quantities.iter().filter(|q| q.channel == *channel).map(|q| (*q).clone()).collect(),
            rules: vec![],
            deviations: result
                .deviations
                .iter()
                .filter(|d| d.channel == *channel && d.estimator == "oadev")
                .cloned()
                .collect(),
            detail: result.comparison.iter().find(|d| d.channel == *channel).cloned(),
            indicative: false,
            summary: contradictions(result, channel),
            missing: vec![],
        };
        unit.summary.extend(faults::of_recording(result));
        unit.rules = rules(&unit);
        let departs = faults::of_model(result, channel);
        let misfit = unit.detail.as_ref().and_then(summary::misfit);
        unit.indicative = departs.is_some() || misfit.is_some();
        unit.summary.extend(misfit.or(departs));
        unit.summary.extend(faults::jump(result, channel));
        unit.summary.extend(summary::sentences(&unit));
        unit.missing = summary::missing(&unit);
        // The limits of a recording are those of the file that came with it, rows or not.
        let limited = result
            .measurands
            .iter()
            .filter(|r| origin == Origin::Result && r.channel == *channel && r.limit.is_some());
        unit.missing.extend(not_compared(limited.map(|r| r.id.as_str())));
        unit
    };
    Ok(channels.iter().map(unit).collect())
}

/// What checks contradict of the compared quantities of a channel.
fn contradictions(result: &RunRecord, channel: &str) -> Vec<Note> {
    contradicted(
        result
            .measurands
            .iter()
            .filter(|r| r.channel == channel && COMPARED_MEASURANDS.contains(&r.id.as_str())),
    )
}

/// A note on limits for quantities that no comparison holds.
pub fn not_compared<'a>(limited: impl Iterator<Item = &'a str>) -> Option<Note> {
    let mut ids: Vec<&str> = limited.filter(|id| !COMPARED_MEASURANDS.contains(id)).collect();
    ids.dedup();
    let names: Vec<Arg> = ids.into_iter().map(|id| Arg::Key(format!("measurand.{id}"))).collect();
    (!names.is_empty()).then(|| note!("compare.more.limits", names = Arg::Several(names, ", ".into())))
}

/// Gives units of the same name different ones: by the name of their file, and where that is the same too, by their path.
pub fn name_apart(units: &mut [Unit]) {
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

/// Adds a note to each unit of which an earlier one has the same recording and channel: it is no second evidence.
pub fn mark_repeated(units: &mut [Unit]) {
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
            unit.missing.insert(0, note!("compare.more.repeated", name));
        }
    }
}
