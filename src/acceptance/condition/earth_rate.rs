//! The Earth rate in the mean: a gyro at rest shows it, and a wrong unit, sign or axis shows itself by it.
//!
//! Judged where the site is declared, a bound of the bias is known (the limit of the static bias, or three times its
//! typical value) and the Earth rate along the axis is at least five times that bound. The mean agrees when it differs
//! from the Earth rate by no more than twice the bound and three standard uncertainties. Where it does not, single
//! mistakes are tried; one that brings it within the bound itself explains it, and the test is not valid. A bias that no
//! mistake explains is a bias: it fails by its limit.
//!
//! Where no bound of the bias is known, a mean of another size than the Earth rate which one of the usual exchanges of
//! unit (deg/h, deg/s, rad/s) brings to within an eighth of it is taken for that exchange. Over temperature, while a unit warms
//! up, from run to run and between intervals without an influence its bias is also seen to move, and one that moves little is
//! thought to be little: three times the movement stands for the bound. Where that is a fifth of the Earth rate or less, a mean
//! that a reversed sign or an Earth rate taken out before explains, to within the bound or an eighth of the Earth rate, is taken
//! for that. Where the bias moves more and the mean is not within an eighth of the Earth rate, the record says that it was not
//! judged.

use super::facts::{Condition, Facts, GyroFact, id_of, record};
use super::plausibility::{
    MIN_EARTH_TO_BIAS, TYPICAL_BIAS_FACTOR, earth_rate_is_kept, largest_plausible_bias,
    mean_shows_earth_rate, noise_is_implausible,
};
use super::stability_track::StabilityKey;
use super::unit_slip::{self, UnitSlip};
use crate::i18n::{Arg, Note, note};
use crate::measurand;
use crate::noise::static_bias::{EARTH_RATE_DEG_H, Orientation, Uncertain, earth_rate};
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct EarthRate;

/// Ratio of output to Earth rate from which a gain explains it: below, it is a bias.
const MIN_GAIN_RATIO: f64 = 1.25;
/// Ratio beyond which a gain is a mistake of another kind.
const MAX_GAIN_RATIO: f64 = 5.0;
/// Least Earth rate along the axis by which a unit is recognised where nothing is known of the bias, deg/h.
const MIN_EARTH_RATE_DEG_H: f64 = 1.0;
/// Share of the Earth rate within which a mistake of unit or sign brings the mean then.
const EXCHANGE_TOLERANCE: f64 = 0.125;
impl Condition for EarthRate {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        facts.gyros.iter().filter_map(|g| of_gyro(g, facts)).collect()
    }
}

fn of_gyro(gyro: &GyroFact, facts: &Facts<'_>) -> Option<ConditionRecord> {
    match why_not(gyro, facts) {
        Some(reason) => facts.checks.not_made("earth_rate", Some(&gyro.channel), reason),
        None => facts.checks.made("earth_rate", Some(&gyro.channel), "earth_rate"),
    }
    let (earth, _) = gyro.earth_deg_h?;
    let Some(bound) = largest_plausible_bias(gyro, facts) else {
        return exchanged_unit(gyro, earth, facts).or_else(|| by_movement(gyro, earth, facts));
    };
    let agrees = mean_shows_earth_rate(gyro, facts)?;
    let mistakes = if agrees { vec![] } else { explain(gyro, earth, bound, facts) };
    let (status, key) = match (agrees, mistakes.is_empty()) {
        (true, _) => (ConditionStatus::Ok, "earth_rate.seen"),
        (false, true) => (ConditionStatus::Remark, "earth_rate.not_seen"),
        (false, false) => (ConditionStatus::Invalid, "earth_rate.mistake"),
    };
    let required = note!("earth_rate.required", earth, bound = 2.0 * bound);
    Some(comparison(gyro, earth, (status, key, mistakes), required, facts))
}

/// Why sign, axis and unit cannot be checked by the Earth rate.
fn why_not(gyro: &GyroFact, facts: &Facts<'_>) -> Option<&'static str> {
    if gyro.earth_deg_h.is_none() {
        return Some("check_list.no_site");
    }
    if largest_plausible_bias(gyro, facts).is_none() {
        let moves = gyro.earth_deg_h.and_then(|(earth, _)| movement(gyro, earth, facts));
        return moves.is_none_or(|(_, small)| !small).then_some("check_list.no_bias_bound");
    }
    mean_shows_earth_rate(gyro, facts).is_none().then_some("check_list.small_earth_rate")
}

/// The record of a mean beside the Earth rate, with the mistakes that explain their difference.
fn comparison(
    gyro: &GyroFact,
    earth: f64,
    (status, key, mistakes): (ConditionStatus, &'static str, Vec<Note>),
    required: Note,
    facts: &Facts<'_>,
) -> ConditionRecord {
    let difference = gyro.mean_deg_h - earth;
    let mut note = Note::new(key)
        .with("channel", gyro.channel.clone())
        .with("mean", gyro.mean_deg_h)
        .with("earth", earth)
        .with("difference", difference);
    if let Some(why) = unit_slip::either(mistakes) {
        note = note.with("why", why);
    }
    let observed = [("mean_deg_h", gyro.mean_deg_h), ("difference_deg_h", difference)];
    record(id_of("earth_rate", &gyro.channel, facts), status, &observed, Some(required), note)
}

/// One of the usual exchanges of unit, where nothing is known of the bias but that it will not cancel the Earth rate.
fn exchanged_unit(gyro: &GyroFact, earth: f64, facts: &Facts<'_>) -> Option<ConditionRecord> {
    let moved = facts.procedure.rate_table.is_some();
    let shown = |rate: f64, share: f64| (rate - earth).abs() <= share * earth.abs();
    if moved || earth.abs() < MIN_EARTH_RATE_DEG_H || shown(gyro.mean_deg_h, 0.5) {
        return None;
    }
    let declared = &facts.procedure.channel(&gyro.channel)?.unit_in_file;
    let usual = unit_slip::rate_factors(declared).into_iter().filter(|m| m.usual);
    let fits = |m: &UnitSlip| {
        let slack = 3.0 * m.factor.abs() * gyro.mean_uncertainty_deg_h;
        slack <= EXCHANGE_TOLERANCE * earth.abs()
            && shown(gyro.mean_deg_h * m.factor, EXCHANGE_TOLERANCE)
            && !noise_is_implausible(gyro, m.factor, facts)
    };
    let found: Vec<Note> = usual.filter(fits).map(|m| m.note).collect();
    if found.is_empty() {
        return None;
    }
    let required = note!("earth_rate.required_alone", earth);
    Some(comparison(gyro, earth, (ConditionStatus::Invalid, "earth_rate.mistake", found), required, facts))
}

/// Bound of the bias by how far it moves, deg/h, and whether it is small enough beside the Earth rate to tell a mistake.
/// `None` where no movement was seen, and where the Earth rate is not expected in the mean or too small.
fn movement(gyro: &GyroFact, earth: f64, facts: &Facts<'_>) -> Option<(f64, bool)> {
    let moves = gyro.moves_deg_h?;
    let ids = [measurand::BIAS_OVER_TEMPERATURE_PEAK_TO_PEAK.id, measurand::TURN_ON_TRANSIENT.id];
    let limits = ids.iter().filter_map(|id| facts.limits.limit(id, &gyro.channel)?.limit.largest_magnitude());
    let bound = TYPICAL_BIAS_FACTOR * limits.fold(moves, f64::max);
    if earth_rate_is_kept(facts) || earth.abs() < MIN_EARTH_RATE_DEG_H {
        return None;
    }
    let u = 3.0 * gyro.mean_uncertainty_deg_h;
    Some((bound, earth.abs() >= MIN_EARTH_TO_BIAS * (bound + u)))
}

/// A reversed sign, or an Earth rate taken out before, shown by how little the bias moves in a test over temperature, of the
/// warm-up, in runs or in intervals.
fn by_movement(gyro: &GyroFact, earth: f64, facts: &Facts<'_>) -> Option<ConditionRecord> {
    let (bound, small) = movement(gyro, earth, facts)?;
    let required = note!("earth_rate.required", earth, bound = 2.0 * bound);
    let u = 3.0 * gyro.mean_uncertainty_deg_h;
    let tolerance = EXCHANGE_TOLERANCE * earth.abs();
    if !small {
        let status = (ConditionStatus::Remark, "earth_rate.not_judged", vec![]);
        let shown = (gyro.mean_deg_h - earth).abs() <= tolerance;
        return (!shown).then(|| comparison(gyro, earth, status, required, facts));
    }
    let slack = bound.max(tolerance) + u;
    let near = |value: f64| (gyro.mean_deg_h - value).abs() <= slack;
    let found = if near(-earth) {
        note!("earth_rate.sign")
    } else if near(0.0) {
        note!("earth_rate.taken_out")
    } else {
        return None;
    };
    let status = (ConditionStatus::Invalid, "earth_rate.mistake", vec![found]);
    Some(comparison(gyro, earth, status, required, facts))
}

/// The single mistakes that bring the mean into agreement.
fn explain(gyro: &GyroFact, earth: f64, bound: f64, facts: &Facts<'_>) -> Vec<Note> {
    let (mean, u) = (gyro.mean_deg_h, gyro.mean_uncertainty_deg_h);
    if let Some(exchanged) = exchanged(gyro, earth, bound, facts) {
        return vec![exchanged];
    }
    let near = |value: f64, factor: f64| {
        let slack = 3.0 * factor.abs() * u;
        // A mean that noise alone could have put there says nothing.
        slack <= 0.25 * earth.abs() && (value - earth).abs() <= bound + slack
    };
    let mut found = Vec::new();
    if near(-mean, 1.0) {
        found.push(note!("earth_rate.sign"));
    }
    if let Some(spec) = facts.procedure.channel(&gyro.channel) {
        let scaled = unit_slip::rate_factors(&spec.unit_in_file);
        // A factor puts right the noise as well; where it would spoil it, the mean is near by chance.
        let fits =
            |m: &UnitSlip| near(mean * m.factor, m.factor) && !noise_is_implausible(gyro, m.factor, facts);
        found.extend(scaled.into_iter().filter(fits).map(|m| m.note));
    }
    found.extend(other_axis(gyro, earth, bound, facts));
    if found.is_empty() {
        found.extend(gain(gyro, earth, facts));
    }
    if found.is_empty() && mean.abs() <= bound + 3.0 * u {
        found.push(note!("earth_rate.taken_out"));
    }
    found
}

/// A gain: the output is the same multiple of the Earth rate as its noise is of the typical noise. A bias changes no noise.
fn gain(gyro: &GyroFact, earth: f64, facts: &Facts<'_>) -> Option<Note> {
    let ratio = gyro.mean_deg_h / earth;
    let known = 3.0 * gyro.mean_uncertainty_deg_h <= 0.1 * gyro.mean_deg_h.abs();
    let size = ratio.max(1.0 / ratio);
    if !known || !(MIN_GAIN_RATIO..=MAX_GAIN_RATIO).contains(&size) {
        return None;
    }
    let noise = gyro.angle_random_walk? / facts.limits.expected(measurand::ANGLE_RANDOM_WALK.id)?;
    let together = (noise / ratio).ln().abs() <= MIN_GAIN_RATIO.ln();
    let figures = |v: f64| Arg::figures(v, 2);
    together.then(|| note!("earth_rate.gain", ratio = figures(ratio), noise = figures(noise)))
}

/// The temperature where the rate should be, and the rate where the temperature should be.
fn exchanged(gyro: &GyroFact, earth: f64, bound: f64, facts: &Facts<'_>) -> Option<Note> {
    let conditions = facts.procedure.conditions.temperatures.iter().enumerate();
    conditions
        .filter_map(|(i, c)| Some((c, facts.stability.get(&StabilityKey::temperature(i))?)))
        .find(|(c, track)| {
            (gyro.mean_deg_h - c.nominal_deg_c).abs() <= 5.0 * c.tolerance_deg_c
                && (track.mean - earth).abs() <= bound
        })
        .map(|(c, track)| {
            note!(
                "earth_rate.exchanged",
                temperature = c.channel.clone(),
                rate = gyro.channel.clone(),
                mean = track.mean
            )
        })
}

/// The Earth rate of another channel, or of an axis that points north, south or up instead.
fn other_axis(gyro: &GyroFact, earth: f64, bound: f64, facts: &Facts<'_>) -> Vec<Note> {
    let u = gyro.mean_uncertainty_deg_h;
    let is = |rate: f64| {
        let told_apart = (rate - earth).abs() > 2.0 * bound && (rate + earth).abs() > 2.0 * bound;
        told_apart && rate.abs() > 2.0 * bound && (gyro.mean_deg_h - rate).abs() <= bound + 3.0 * u
    };
    let others = facts.gyros.iter().filter(|g| g.channel != gyro.channel);
    let other = others
        .filter(|g| g.earth_deg_h.is_some_and(|(rate, _)| is(rate)))
        .map(|g| note!("earth_rate.other_channel", other = g.channel.clone()));
    let mut found: Vec<Note> = other.collect();
    let Some(site) = facts.procedure.site.as_ref().filter(|_| found.is_empty()) else { return found };
    let exact = |value: f64| Uncertain { value, uncertainty: 0.0 };
    let directions = [
        ("earth_rate.north", 0.0, 0.0),
        ("earth_rate.south", 180.0, 0.0),
        ("earth_rate.up", 0.0, 90.0),
        ("earth_rate.down", 0.0, -90.0),
    ];
    for (key, heading, elevation) in directions {
        let rate = earth_rate(&Orientation {
            latitude_deg: exact(site.latitude_deg),
            heading_deg: exact(heading),
            elevation_deg: exact(elevation),
        });
        if rate.value.abs() <= EARTH_RATE_DEG_H && is(rate.value) {
            found.push(note!("earth_rate.axis", direction = Arg::Key(key.to_owned())));
        }
    }
    found
}
