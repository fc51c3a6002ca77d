//! The level of the noise against what is typical of the family: far off, it is a mistake of units and no bad unit.
//!
//! White noise of coefficient N has σ(τ)·√τ = 60·N at every τ (deg/h, s, deg/sqrt(h)). Everything else adds to it at
//! some τ, and a filter takes away at short ones. So the noise is too high when the least σ(τ)·√τ/60 over octaves up to
//! a twentieth of the record is more than twenty times the typical N, and too low when the greatest is less than a
//! twentieth of it. Twenty: above it lies the smallest mistake of the clock, √1000 = 32 for ms taken as s; below it lie
//! units of one family, which differ by a factor of three at most.
//!
//! Within that factor noise above the typical one is for the limit to judge, and noise below it passes every limit: a gain that
//! is too low, a filter or a mean over samples makes it as well as a good unit. Where even the upper end of the interval of N
//! is less than four fifths of the typical one, the record says so.

use super::facts::{Condition, Facts, GyroFact, id_of, record};
use super::plausibility::{NOISE_RATIO_LIMIT, mean_shows_earth_rate, white_noise_range};
use super::unit_slip;
use crate::i18n::{Arg, Note, note};
use crate::measurand;
use crate::record::{ConditionRecord, ConditionStatus};
use crate::recording::Role;

pub(super) struct NoiseLevel;

/// Factor within which a mistake explains the ratio.
const SLIP_FACTOR: f64 = 3.0;

/// Share of the typical noise that the upper end of the interval of N must reach.
const MIN_SHARE_OF_TYPICAL: f64 = 0.8;

impl Condition for NoiseLevel {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let Some(typical) = facts.limits.expected(measurand::ANGLE_RANDOM_WALK.id).filter(|n| *n > 0.0)
        else {
            facts.checks.not_made("noise_level", None, "check_list.no_typical_noise");
            return vec![];
        };
        facts.gyros.iter().filter_map(|g| of_gyro(g, typical, facts)).collect()
    }
}

fn of_gyro(gyro: &GyroFact, typical: f64, facts: &Facts<'_>) -> Option<ConditionRecord> {
    let levels = white_noise_range(gyro);
    match levels {
        Some(_) => facts.checks.made("noise_level", Some(&gyro.channel), "noise_level"),
        None => facts.checks.not_made("noise_level", Some(&gyro.channel), "check_list.short"),
    }
    let (low, high) = levels?;
    let ratio = if low > NOISE_RATIO_LIMIT * typical {
        low / typical
    } else if high * NOISE_RATIO_LIMIT < typical {
        high / typical
    } else {
        1.0
    };
    let far = ratio != 1.0;
    let below = gyro.angle_random_walk_high.filter(|n| !far && *n < MIN_SHARE_OF_TYPICAL * typical);
    let why = if far { unit_slip::either(explain(gyro, ratio, facts)) } else { None };
    let (status, key) = match (far, why.is_some()) {
        (false, _) if below.is_some() => (ConditionStatus::Remark, "noise_level.below"),
        (false, _) => (ConditionStatus::Ok, "noise_level.usual"),
        (true, true) => (ConditionStatus::Invalid, "noise_level.mistake"),
        (true, false) => (ConditionStatus::Invalid, "noise_level.far"),
    };
    let mut note = Note::new(key)
        .with("channel", gyro.channel.clone())
        .with("low", low)
        .with("high", high)
        .with("typical", typical);
    if let Some(upper) = below {
        note = note
            .with("upper", Arg::figures(upper, 3))
            .with("percent", Arg::figures(100.0 * upper / typical, 2));
    }
    if let Some(why) = why {
        note = note.with("why", why);
    }
    let observed = [("least_arw", low), ("greatest_arw", high)];
    let required = note!(
        "noise_level.required",
        typical = Arg::Stated(typical),
        factor = Arg::Stated(NOISE_RATIO_LIMIT)
    );
    Some(record(id_of("noise_level", &gyro.channel, facts), status, &observed, Some(required), note))
}

/// The mistakes that explain a ratio, the nearest first and those as near as a fifth after it. The Earth rate tells a
/// wrong unit of the rate, which it shows, from a wrong unit of the time, which it does not.
fn explain(gyro: &GyroFact, ratio: f64, facts: &Facts<'_>) -> Vec<Note> {
    let spec = facts.procedure.channel(&gyro.channel);
    let increments = spec.is_some_and(|s| s.channel.role == Role::AngleIncrement);
    let earth = mean_shows_earth_rate(gyro, facts);
    let off = |expected: f64| (ratio / expected).ln().abs();
    let mut found: Vec<(f64, Note)> = Vec::new();
    if earth != Some(true) {
        let unit = spec.map(|s| unit_slip::rate_factors(&s.unit_in_file)).unwrap_or_default();
        found.extend(unit.into_iter().map(|m| (off(1.0 / m.factor), m.note)));
    }
    if earth != Some(false) && facts.has_stamps {
        // σ does not change with the scale of the time, and √τ does; an increment is divided by the interval.
        let power = if increments { 0.5 } else { -0.5 };
        found.extend(unit_slip::time_factors().into_iter().map(|m| (off(m.factor.powf(power)), m.note)));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let nearest = found.first().map_or(f64::INFINITY, |f| f.0);
    found.retain(|f| f.0 <= SLIP_FACTOR.ln() && f.0 <= nearest + 1.2f64.ln());
    found.into_iter().take(3).map(|f| f.1).collect()
}
