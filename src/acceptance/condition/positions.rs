//! Conditions of a test in positions and by turns of known angles: every stated stretch found, and the Earth's
//! rotation seen as it is. A wrong sign, unit, axis or latitude is named.

use super::facts::record;
use super::unit_slip::{self, UnitSlip};
use crate::i18n::{Arg, Note, note};
use crate::record::{ConditionRecord, ConditionStatus};

/// What a channel makes of the Earth's rotation in several positions.
#[derive(Debug, Clone, PartialEq)]
pub struct EarthFact {
    /// Channel.
    pub channel: String,
    /// Whether there are others.
    pub several: bool,
    /// Unit declared for it.
    pub unit: String,
    /// Output per Earth rate expected.
    pub factor: f64,
    /// Standard uncertainty of it.
    pub standard: f64,
    /// True where a limit judges the scale factor of the channel.
    pub limited: bool,
    /// True where a limit judges anything of the channel: only then can a wrong gain pass.
    pub judged: bool,
    /// Bias, deg/h.
    pub bias: f64,
    /// Latitude, where all axes are vertical: what the factor says of it.
    pub latitude_deg: Option<f64>,
    /// Pairs of positions that were turned in software only.
    pub software: Vec<(String, String)>,
    /// Channel that shows the Earth's rotation between these positions in place of this one, and its factor.
    pub turned_instead: Option<(String, f64)>,
}

/// Departure of the factor from 1 that a scale factor may have: beyond, a unit, a direction or the latitude is wrong.
const MAX_FACTOR_ERROR: f64 = 0.02;
/// The same where no limit judges the scale factor: gyros that show the Earth rate so well are calibrated more nearly.
const MAX_UNJUDGED_ERROR: f64 = 0.005;

/// Judges whether all stretches of a procedure were found.
pub fn judge_stretches(stated: usize, missing: usize) -> ConditionRecord {
    let (status, key) = if missing == 0 {
        (ConditionStatus::Ok, "known.stretches")
    } else {
        (ConditionStatus::Invalid, "known.stretches_missing")
    };
    let note = Note::new(key).with("n", stated).with("missing", missing);
    record("known_stretches", status, &[("stretches", (stated - missing) as f64)], None, note)
}

/// Judges whether positions show the Earth's rotation as it is.
pub fn judge_earth(fact: &EarthFact) -> ConditionRecord {
    let id = if fact.several { format!("known_earth.{}", fact.channel) } else { "known_earth".to_owned() };
    let required = Some(note!("known.required.earth"));
    let observed = [("factor", fact.factor)];
    let allowed = 4.0 * fact.standard;
    let shown = Arg::figures(fact.factor, 4);
    let invalid =
        |note: Note| record(id.clone(), ConditionStatus::Invalid, &observed, required.clone(), note);
    if let Some((first, second)) = fact.software.first() {
        return invalid(note!("known.software", first = first.as_str(), second = second.as_str()));
    }
    if let Some((other, their)) = &fact.turned_instead {
        return invalid(note!(
            "known.software_axis",
            channel = fact.channel.as_str(),
            other = other.as_str(),
            theirs = Arg::figures(*their, 4),
            factor = shown
        ));
    }
    let error = (fact.factor - 1.0).abs();
    let unjudged = !fact.limited && error > allowed.max(MAX_UNJUDGED_ERROR);
    if unjudged && error <= MAX_FACTOR_ERROR {
        let status = if fact.judged { ConditionStatus::Invalid } else { ConditionStatus::Remark };
        let note = note!(
            "known.gain",
            factor = shown,
            uncertainty = Arg::figures(fact.standard, 2),
            allowed = Arg::Stated(1e6 * MAX_UNJUDGED_ERROR)
        );
        return record(id, status, &observed, required, note);
    }
    if error <= allowed.max(MAX_FACTOR_ERROR) {
        let key = if fact.standard > 0.25 { "known.earth_weak" } else { "known.earth_seen" };
        let note = Note::new(key).with("factor", shown).with("uncertainty", Arg::figures(fact.standard, 2));
        return record(id, ConditionStatus::Ok, &observed, required, note);
    }
    if (fact.factor + 1.0).abs() <= allowed.max(MAX_FACTOR_ERROR) {
        return invalid(note!("known.reversed", factor = shown));
    }
    // A factor that is not known to a tenth says nothing of units, nor of a latitude.
    let known = allowed <= 0.1 * fact.factor.abs();
    let units = || unit_slip::rate_factors(&fact.unit).into_iter().filter(|_| known);
    let off = |m: &UnitSlip| (m.factor * fact.factor - 1.0).abs();
    let usual = units().any(|m| m.usual && off(&m) <= MAX_FACTOR_ERROR);
    if fact.factor.abs() <= allowed.max(MAX_FACTOR_ERROR) && !usual {
        return invalid(note!("known.not_turned", factor = shown));
    }
    let mistake =
        units().filter(|m| off(m) <= (allowed / fact.factor.abs()).max(MAX_FACTOR_ERROR)).min_by(|a, b| {
            let off = |m: &UnitSlip| (m.factor * fact.factor).ln().abs();
            off(a).total_cmp(&off(b))
        });
    if let Some(mistake) = mistake {
        let note = note!("on_table.mistaken", factor = shown, mistake = Arg::from(mistake.note));
        return invalid(note);
    }
    let sine = fact.latitude_deg.map(|l| l.to_radians().sin() * fact.factor);
    match sine.filter(|s| s.abs() <= 1.0 && known) {
        Some(sine) => invalid(note!(
            "known.latitude",
            factor = shown,
            stated = Arg::figures(fact.latitude_deg.unwrap_or(0.0), 4),
            fits = Arg::figures(sine.asin().to_degrees(), 3)
        )),
        None => invalid(note!("known.off", factor = shown)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_that_nothing_judges_is_named_where_it_is_known() {
        let judged = |factor: f64, standard: f64, limited: bool| {
            let fact = EarthFact {
                channel: "rate".to_owned(),
                several: false,
                unit: "deg/h".to_owned(),
                factor,
                standard,
                limited,
                judged: true,
                bias: 0.1,
                latitude_deg: Some(56.0),
                software: vec![],
                turned_instead: None,
            };
            judge_earth(&fact).message.map(|m| m.id.to_string()).unwrap_or_default()
        };
        assert_eq!(judged(1.01, 3e-4, false), "known.gain");
        assert_eq!(judged(0.99, 3e-4, false), "known.gain");
        // A limit judges it; the noise may make it; a calibrated gyro has it.
        assert_eq!(judged(1.01, 3e-4, true), "known.earth_seen");
        assert_eq!(judged(1.01, 3e-3, false), "known.earth_seen");
        assert_eq!(judged(1.004, 3e-4, false), "known.earth_seen");
        assert_eq!(judged(1.03, 3e-4, true), "known.latitude");
    }
}
