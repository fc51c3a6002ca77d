//! Conditions of a test on a rate table: steps found, the rates reached, the angle in agreement, and an output that
//! follows the table. A mistake of sign, unit or axis is named.

use super::checks::CheckLog;
use super::facts::record;
use super::unit_slip::{self, UnitSlip};
use crate::i18n::{Arg, Note, note};
use crate::record::{ConditionRecord, ConditionStatus};
use crate::units::RateUnit;

/// Findings of the table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TableFacts {
    /// Time by the angle of the table over time by the stamps.
    pub time_factor: Option<f64>,
    /// Steps that are evaluated from too early on.
    pub settling: Settling,
    /// Steps that were evaluated.
    pub steps: usize,
    /// Stretches that were too short.
    pub too_short: usize,
    /// Least time at one rate, s.
    pub minimum_step_s: f64,
    /// Lowest and highest rate of a step, deg/h.
    pub lowest: f64,
    /// Highest rate of a step, deg/h.
    pub highest: f64,
    /// True when the table turns about its other axis.
    pub about_outer: bool,
    /// Rates that differ.
    pub levels: usize,
    /// Full scale that must be reached, deg/h.
    pub full_scale: Option<f64>,
    /// Relative tolerance of it.
    pub tolerance: f64,
    /// Largest relative difference between the angle and the rate of the table, with the rate at which it was, deg/h.
    pub disagreement: Option<(f64, f64)>,
    /// Mean rate of the inner axis during the step of the outer one in which it is largest beside it, and the rate of the
    /// step, deg/h.
    pub inner_during_step: Option<(f64, f64)>,
    /// The channels.
    pub channels: Vec<ChannelFact>,
}

/// Steps that are evaluated from a time on at which the table still changed its rate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Settling {
    /// How many.
    pub steps: usize,
    /// Settling that the procedure states, s.
    pub stated_s: f64,
    /// Longest that one needed, s.
    pub needed_s: f64,
    /// Largest relative deviation of the mean rate from that at the end of the step.
    pub off: f64,
}

/// How a channel follows the table.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelFact {
    /// Channel.
    pub channel: String,
    /// Whether something is asked of it.
    pub asked: bool,
    /// Whether its polarity is a row with a limit, which a reversed output then fails.
    pub polarity_judged: bool,
    /// Unit declared for it.
    pub unit: String,
    /// Output per input; `None` where no line could be drawn.
    pub factor: Option<f64>,
    /// Standard uncertainty of it.
    pub standard: f64,
    /// Bias left by the line at rest once the Earth rate along the axis is taken out, deg/h, and that Earth rate, where the
    /// site tells it.
    pub bias_and_earth: Option<(f64, f64)>,
    /// Largest bias that the limits allow, deg/h.
    pub bias_limit: Option<f64>,
}

/// Factors that a unit may have, a dead zone or a bent response included; mistakes of unit lie beyond.
const ACCEPTED_FACTORS: std::ops::RangeInclusive<f64> = 0.3..=2.0;

/// Degrees in a radian.
const DEG_PER_RAD: f64 = 180.0 / std::f64::consts::PI;
/// Times full scale from which the value stated for it, or the unit of the table, is wrong.
const MAX_RATE_TO_FULL_SCALE: f64 = 3.0;
/// Rate of the inner axis beside that of the outer one from which it does not rest: a misalignment of 0.3 mrad.
const MAX_INNER_RATE_RATIO: f64 = 3e-4;
/// Share of the Earth rate within which a bias is twice that of the other sign.
const SIGN_TOLERANCE: f64 = 0.05;
/// Least Earth rate along the axis by which that is checked, deg/h.
const MIN_EARTH_RATE_DEG_H: f64 = 3.0;

/// Share of the tolerance of the rate by which steps may be off on average where the settling is a little short.
const MAX_SETTLING_ERROR: f64 = 0.1;
/// Relative difference within which a time is that of another unit.
const TIME_SLIP_TOLERANCE: f64 = 0.05;

/// Judges a test on a table, and notes which checks were made.
pub fn judge_and_log(facts: &TableFacts, checks: &CheckLog) -> Vec<ConditionRecord> {
    let all = judge(facts);
    let made = |id: &str| all.iter().any(|c| c.id.split('.').next() == Some(id));
    let tell = |id: &str, condition: &str, reason: &'static str| {
        if made(condition) {
            checks.made(id, None, condition);
        } else {
            checks.not_made(id, None, reason);
        }
    };
    tell("table_response", "table_response", "check_list.no_response");
    tell("table_reached", "table_reached", "check_list.no_full_scale");
    tell("table_agreement", "table_agreement", "check_list.angle_or_rate_alone");
    match facts.time_factor {
        Some(_) => checks.made("clock_by_turns", None, "table_stamps"),
        None => checks.not_made("clock_by_turns", None, "check_list.angle_or_rate_alone"),
    }
    for c in facts.channels.iter().filter(|c| c.asked) {
        let reason = match c.bias_and_earth {
            None => "check_list.no_site",
            Some(_) if facts.about_outer => "check_list.other_axis",
            Some((_, earth)) if earth.abs() < MIN_EARTH_RATE_DEG_H => "check_list.small_earth_rate",
            Some(_) => {
                checks.made("earth_sign", Some(&c.channel), "table_earth_rate");
                continue;
            }
        };
        checks.not_made("earth_sign", Some(&c.channel), reason);
    }
    all
}

/// Judges a test on a table.
pub fn judge(facts: &TableFacts) -> Vec<ConditionRecord> {
    let mut all = vec![steps(facts)];
    // With stamps in a wrong unit every rate is wrong, and nothing else is worth a word.
    if let Some(wrong) = stamps(facts) {
        all.push(wrong);
        return all;
    }
    // A table that was not at its rate yet falls short of it, and its angle of its rate.
    let settling = settling(facts);
    if settling.as_ref().is_none_or(|s| s.status != ConditionStatus::Invalid) {
        all.extend(reached(facts));
        all.extend(agreement(facts));
    }
    all.extend(settling);
    all.extend(inner_axis_still(facts));
    // A channel of which nothing is asked may lie across the axis that turns.
    let asked = || facts.channels.iter().filter(|c| c.asked);
    all.extend(asked().filter_map(|c| response(c, facts)));
    all.extend(asked().filter_map(|c| earth_sign(c, facts)));
    all
}

/// The id of a condition on a channel: the channel is named where there are several.
fn id_of(id: &str, channel: &ChannelFact, facts: &TableFacts) -> String {
    if facts.channels.len() > 1 { format!("{id}.{}", channel.channel) } else { id.to_owned() }
}

/// Whether the inner axis rested while the outer one turned.
fn inner_axis_still(facts: &TableFacts) -> Option<ConditionRecord> {
    let (inner, outer) = facts.inner_during_step.filter(|_| facts.about_outer)?;
    let moves = (inner / outer).abs() > MAX_INNER_RATE_RATIO;
    let (status, key) = if moves {
        (ConditionStatus::Invalid, "on_table.inner_moves")
    } else {
        (ConditionStatus::Ok, "on_table.inner_rests")
    };
    let note = Note::new(key)
        .with("inner", RateUnit::up_to(outer).figures(inner, 3))
        .with("outer", RateUnit::up_to(outer).figures(outer, 4));
    let required = note!("on_table.required.inner_rests");
    Some(record("inner_axis_still", status, &[("inner_deg_s", inner / 3600.0)], Some(required), note))
}

/// A bias that is the Earth rate taken out with the wrong sign, twice.
fn earth_sign(channel: &ChannelFact, facts: &TableFacts) -> Option<ConditionRecord> {
    let (bias, earth) =
        channel.bias_and_earth.filter(|(_, e)| !facts.about_outer && e.abs() >= MIN_EARTH_RATE_DEG_H)?;
    let within = channel.bias_limit.unwrap_or(0.0).clamp(SIGN_TOLERANCE * earth.abs(), 0.5 * earth.abs());
    if (bias + 2.0 * earth).abs() > within {
        return None;
    }
    // Without a limit on the bias nothing that is judged rests on it.
    let status =
        if channel.bias_limit.is_some() { ConditionStatus::Invalid } else { ConditionStatus::Remark };
    let note = note!("on_table.earth_sign", bias = Arg::figures(bias, 4), earth = Arg::figures(earth, 4));
    let id = id_of("table_earth_rate", channel, facts);
    Some(record(id, status, &[("bias_deg_h", bias)], Some(note!("on_table.required.earth_sign")), note))
}

impl TableFacts {
    /// A rate of the table, in the unit that its highest one reads well in.
    fn rate(&self, rate_deg_h: f64) -> Arg {
        RateUnit::up_to(self.highest.abs().max(self.lowest.abs())).figures(rate_deg_h, 5)
    }
}

fn steps(facts: &TableFacts) -> ConditionRecord {
    let enough = facts.levels >= 2;
    let (status, key) = match (enough, facts.steps) {
        (true, _) if facts.about_outer => (ConditionStatus::Ok, "on_table.steps_found_outer"),
        (true, _) => (ConditionStatus::Ok, "on_table.steps_found"),
        (false, 0) if facts.too_short > 0 => (ConditionStatus::Invalid, "on_table.steps_too_short"),
        (false, 0) => (ConditionStatus::Invalid, "on_table.steps_none"),
        (false, found) if facts.too_short > found => {
            (ConditionStatus::Invalid, "on_table.steps_mostly_short")
        }
        (false, _) => (ConditionStatus::Invalid, "on_table.steps_one"),
    };
    let note = Note::new(key)
        .with("steps", facts.steps)
        .with("levels", facts.levels)
        .with("short", facts.too_short)
        .with("least", Arg::figures(facts.minimum_step_s, 3))
        .with("low", facts.rate(facts.lowest))
        .with("high", facts.rate(facts.highest));
    let observed = [("steps", facts.steps as f64), ("levels", facts.levels as f64)];
    record("table_steps", status, &observed, Some(note!("on_table.required.steps")), note)
}

/// Whether full scale was reached, on every side that was turned to.
fn reached(facts: &TableFacts) -> Option<ConditionRecord> {
    let full = facts.full_scale.filter(|_| facts.steps > 0)?;
    let least = full * (1.0 - facts.tolerance);
    let sides = [facts.highest, -facts.lowest];
    let turned = sides.iter().filter(|s| **s > 0.0);
    let worst = turned.fold(f64::INFINITY, |m, s| m.min(*s));
    let one_side = sides.iter().any(|s| *s <= 0.0);
    let worst = if worst.is_finite() { worst } else { 0.0 };
    let (status, key) = if worst < least {
        (ConditionStatus::Invalid, "on_table.not_reached")
    } else if sides.iter().any(|s| *s > MAX_RATE_TO_FULL_SCALE * full) {
        (ConditionStatus::Invalid, "on_table.beyond")
    } else if one_side {
        (ConditionStatus::Remark, "on_table.one_side")
    } else {
        (ConditionStatus::Ok, "on_table.reached")
    };
    let note = Note::new(key)
        .with("low", facts.rate(facts.lowest))
        .with("high", facts.rate(facts.highest))
        .with("full", facts.rate(full));
    let required = note!(
        "on_table.required.reached",
        full = facts.rate(full),
        tolerance = Arg::figures(100.0 * facts.tolerance, 2)
    );
    Some(record("table_reached", status, &[("worst_deg_s", worst / 3600.0)], Some(required), note))
}

/// Whether angle and rate of the table tell the same.
fn agreement(facts: &TableFacts) -> Option<ConditionRecord> {
    let (difference, rate) = facts.disagreement?;
    let agrees = difference.abs() <= facts.tolerance;
    let factor = 1.0 + difference;
    let key = if agrees {
        "on_table.agrees"
    } else if (factor + 1.0).abs() <= facts.tolerance {
        "on_table.angle_reversed"
    } else if (factor * DEG_PER_RAD - 1.0).abs() <= facts.tolerance.max(0.01) {
        "on_table.angle_in_radians"
    } else if factor.abs() < 0.98 {
        "on_table.fell_short"
    } else {
        "on_table.disagrees"
    };
    let status = if agrees { ConditionStatus::Ok } else { ConditionStatus::Invalid };
    let note = Note::new(key)
        .with("percent", Arg::figures(100.0 * difference, 3))
        .with("angle", facts.rate(rate * factor))
        .with("rate", facts.rate(rate));
    let required = note!("on_table.required.agreement", tolerance = Arg::figures(100.0 * facts.tolerance, 2));
    Some(record("table_agreement", status, &[("difference", difference)], Some(required), note))
}

/// Whether the output follows the table: its factor is near 1, and otherwise what is wrong. Where the input axis is square to
/// the axis that turns, nothing but a turn of the inner axis tells.
fn response(channel: &ChannelFact, facts: &TableFacts) -> Option<ConditionRecord> {
    let id = id_of("table_response", channel, facts);
    let required = Some(note!(
        "on_table.required.response",
        low = Arg::Stated(*ACCEPTED_FACTORS.start()),
        high = Arg::Stated(*ACCEPTED_FACTORS.end())
    ));
    let Some(factor) = channel.factor else {
        let note = note!("on_table.no_line");
        return (!facts.about_outer).then(|| record(id, ConditionStatus::Invalid, &[], required, note));
    };
    let observed = [("factor", factor)];
    if ACCEPTED_FACTORS.contains(&factor) {
        let note = note!("on_table.follows", factor = Arg::figures(factor, 5));
        return Some(record(id, ConditionStatus::Ok, &observed, required, note));
    }
    let note = response_error(channel, factor, facts);
    // A reversed output is what a limit on the polarity is for: the row fails, and the test was done right.
    let left_to_row = channel.polarity_judged && note.id == "on_table.reversed";
    let status = if left_to_row { ConditionStatus::Remark } else { ConditionStatus::Invalid };
    Some(record(id, status, &observed, required, note))
}

/// The fault of an output that does not follow the table.
fn response_error(channel: &ChannelFact, factor: f64, facts: &TableFacts) -> Note {
    let shown = Arg::figures(factor, 4);
    let mistakes = unit_slip::rate_factors(&channel.unit);
    let mistaken = |why: Note| note!("on_table.mistaken", factor = shown.clone(), mistake = Arg::from(why));
    // An exchange of unit leaves next to nothing of the output, which is known well all the same.
    let resolved = factor.abs() > 10.0 * channel.standard;
    let exchanged = |m: &&UnitSlip| m.usual && ACCEPTED_FACTORS.contains(&(m.factor * factor));
    if let Some(exchange) = mistakes.iter().find(exchanged).filter(|_| resolved) {
        return mistaken(exchange.note.clone());
    }
    let other = facts.channels.iter().find(|c| {
        c.channel != channel.channel && c.factor.is_some_and(|f| ACCEPTED_FACTORS.contains(&f.abs()))
    });
    if factor.abs() < 0.1 && factor.abs() < 20.0 * channel.standard.max(0.005) {
        return match other {
            Some(other) if facts.channels.len() > 2 => note!(
                "table_motion.one_axis",
                channel = channel.channel.as_str(),
                other = other.channel.as_str(),
                factor = shown
            ),
            Some(other) => note!(
                "on_table.another_axis",
                channel = channel.channel.as_str(),
                other = other.channel.as_str(),
                factor = shown
            ),
            None => note!("on_table.does_not_follow", factor = shown),
        };
    }
    if ACCEPTED_FACTORS.contains(&-factor) {
        return note!("on_table.reversed", factor = shown);
    }
    let off = |m: &UnitSlip| (m.factor * factor.abs()).ln().abs();
    let nearest = mistakes.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))).filter(|m| off(m) < 0.1);
    match nearest {
        Some(mistake) => mistaken(mistake.note),
        None => note!("on_table.off", factor = shown),
    }
}

/// Whether steps are evaluated before the table is at its rate; `None` where none is.
fn settling(facts: &TableFacts) -> Option<ConditionRecord> {
    let s = &facts.settling;
    if s.steps == 0 {
        return None;
    }
    let status = if s.off > MAX_SETTLING_ERROR * facts.tolerance {
        ConditionStatus::Invalid
    } else {
        ConditionStatus::Remark
    };
    let note = note!(
        "table_motion.settling_short",
        steps = s.steps,
        of = facts.steps,
        stated = Arg::Stated(s.stated_s),
        needed = Arg::figures(s.needed_s, 2)
    );
    let observed = [("needed_s", s.needed_s), ("stated_s", s.stated_s)];
    Some(record("table_settling", status, &observed, Some(note!("table_motion.required.settled")), note))
}

/// Stamps of a unit that the angle and the rate of the table contradict; `None` where they do not.
fn stamps(facts: &TableFacts) -> Option<ConditionRecord> {
    let factor = facts.time_factor.filter(|f| *f > 0.0)?;
    let mistake = unit_slip::time_factors()
        .into_iter()
        .find(|m| (factor / m.factor - 1.0).abs() < TIME_SLIP_TOLERANCE)?;
    let note = note!("table_motion.stamps", mistake = Arg::from(mistake.note));
    let required = note!("table_motion.required.stamps");
    Some(record("table_stamps", ConditionStatus::Invalid, &[("factor", factor)], Some(required), note))
}

/// Largest scale factor, output per input in the declared units, of a unit that works: the worst MEMS gyro is off by
/// some per cent, and a wrong unit by a factor of 57 or 3600.
const MAX_SCALE_FACTOR: f64 = 5.0;

/// Judges whether a scale factor is possible; nothing where it is. One that is too small is a fault of the unit.
pub fn judge_scale(channel: &str, factor: f64) -> Option<ConditionRecord> {
    if factor.abs() <= MAX_SCALE_FACTOR {
        return None;
    }
    let high = || Arg::Stated(MAX_SCALE_FACTOR);
    let note = note!("plausible.scale", channel = Arg::Text(channel.to_owned()));
    let note = note.with("value", Arg::figures(factor, 5)).with("high", high());
    let required = note!("plausible.scale_required", high = high());
    let observed = [("factor", factor)];
    Some(record("table_scale", ConditionStatus::Invalid, &observed, Some(required), note))
}
