//! Likely slips of the pen in limits and procedures that can be used.

use super::diagnostics::{Problem, SourceText, Span};
use super::limit_set::{FastUnit, LimitSet, LimitSpec};
use super::model::{ChannelSpec, Procedure};
use super::reader::Reader;
use super::section::Section;
use crate::i18n::{Note, note};
use crate::units::Unit;

/// Unit of rates in results.
const RATE_UNIT: &str = "deg/h";

/// A unit of rate from this size on, deg/h, is one of units that turn fast: deg/s, rad/s, mrad/s.
const FAST_DEG_H: f64 = 100.0;

/// A limit this many times its typical value, or this small a part of it, is in another unit.
const UNIT_SLIP_FACTOR: f64 = 500.0;

/// No drift of a working gyro is as large, deg/h.
const IMPLAUSIBLE_DEG_H: f64 = 1000.0;

/// The fast unit that a limit is written in.
pub(super) fn fast_unit(section: &Section, reader: &Reader<'_>) -> Option<FastUnit> {
    ["max", "max_abs", "min"].into_iter().filter(|key| section.entry(key).is_some()).find_map(|key| {
        let at = reader.source.inside_quotes(&section.span_of(key));
        let text = reader.source.text.get(at.clone())?;
        let number = |c: char| c.is_ascii_digit() || matches!(c, '.' | ',' | '+' | '-' | '_' | ' ');
        let unit = text.trim_start_matches(number).trim();
        let unit = unit.strip_prefix(['e', 'E']).map_or(unit, |rest| rest.trim_start_matches(number).trim());
        let fast = size(unit).is_some_and(|s| s >= FAST_DEG_H);
        fast.then(|| FastUnit { limit: section.span.clone(), value: at, unit: unit.to_owned() })
    })
}

/// Reports a limit on a density that is written without the root of a frequency. Degrees per root hour have the same dimension,
/// and state an angle random walk: the root of a two-sided density.
pub(super) fn not_a_density(section: &Section, reader: &mut Reader<'_>) {
    for key in ["max", "max_abs", "min"].into_iter().filter(|key| section.entry(key).is_some()) {
        let at = reader.source.inside_quotes(&section.span_of(key));
        let text = reader.source.text.get(at.clone()).unwrap_or_default();
        if !["Hz", "Гц"].iter().any(|unit| text.contains(unit)) {
            let text = text.to_owned();
            reader.error(&at, note!("noise_check.no_density", text), Some("noise_check.help_density".into()));
        }
    }
}

/// Size of a unit of rate, deg/h.
fn size(unit: &str) -> Option<f64> {
    Unit::parse(unit).ok()?.factor_to(&Unit::parse(RATE_UNIT).ok()?).ok()
}

/// The slips of a set that show without a procedure.
pub(super) fn of_set(set: &LimitSet, source: &SourceText) -> Vec<Problem> {
    let slow =
        |l: &LimitSpec| l.measurand.unit == RATE_UNIT && set.fast_units.iter().all(|f| f.limit != l.span);
    let mut found = vec![];
    for limit in &set.limits {
        let bound = largest(limit);
        if let Some(fast) = set.fast_units.iter().find(|f| f.limit == limit.span) {
            let other = set.limits.iter().find(|l| slow(l) && largest(l) < bound / FAST_DEG_H);
            let why = if let Some(other) = other {
                note!("check.slip.other_limit", measurand = other.measurand.id)
            } else if bound > IMPLAUSIBLE_DEG_H && limit.measurand.drift {
                note!("check.slip.size")
            } else {
                continue;
            };
            found.push(in_fast_unit(fast, bound, why, source));
        }
        if let Some(typical) = typical(set, limit)
            && limit.span != typical.1
            && !(1.0 / UNIT_SLIP_FACTOR..=UNIT_SLIP_FACTOR).contains(&(bound / typical.0.abs()))
        {
            let message = note!(
                "check.slip.ratio",
                measurand = limit.measurand.id,
                limit = shown(bound),
                typical = shown(typical.0),
                unit = limit.measurand.unit
            );
            found.push(source.warning(&limit.span, message).help("check.help.unit_meant"));
        }
        if limit.measurand.signed && limit.limit.min.is_none() {
            let message = note!("check.slip.one_sided", measurand = limit.measurand.id);
            found.push(source.warning(&limit.span, message).help("check.help.max_abs"));
        }
    }
    found
}

/// Limits in a fast unit on channels that are all read in a slow one.
pub(super) fn against_channels(procedure: &Procedure, set: &LimitSet, source: &SourceText) -> Vec<Problem> {
    let mut found = vec![];
    for fast in &set.fast_units {
        let Some(limit) = set.limits.iter().find(|l| l.span == fast.limit) else { continue };
        let concerned =
            |c: &&ChannelSpec| limit.channel.as_deref().is_none_or(|own| own == c.channel.id.as_str());
        let mut channels = procedure.gyro_channels().filter(concerned).peekable();
        let Some(first) = channels.peek().map(|c| (c.channel.id.clone(), c.unit_in_file.clone())) else {
            continue;
        };
        if channels.all(|c| size(&c.unit_in_file).is_some_and(|s| s < FAST_DEG_H)) {
            let why = note!("check.slip.channel", channel = first.0, unit = first.1);
            found.push(in_fast_unit(fast, largest(limit), why, source));
        }
    }
    found
}

/// The bound of a limit that is farthest from zero.
fn largest(limit: &LimitSpec) -> f64 {
    [limit.limit.min, limit.limit.max].into_iter().flatten().fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// The typical value beside a limit, with the place where a reference states it.
fn typical(set: &LimitSet, limit: &LimitSpec) -> Option<(f64, Span)> {
    let same_channel = |c: &Option<String>| c.is_none() || *c == limit.channel;
    let references =
        set.references.iter().filter(|r| r.measurand == limit.measurand && same_channel(&r.channel));
    let stated = set.expected.iter().filter(|e| e.measurand == limit.measurand);
    let mut values =
        references.map(|r| (r.record.value, r.span.clone())).chain(stated.map(|e| (e.value, e.span.clone())));
    // What can be negative may be near zero and tells no size.
    values.find(|(v, _)| *v != 0.0 && !limit.measurand.signed)
}

fn in_fast_unit(fast: &FastUnit, bound: f64, why: Note, source: &SourceText) -> Problem {
    let message = note!("check.slip.fast_unit", unit = fast.unit.as_str(), value = shown(bound), why);
    source.warning(&fast.value, message).help("check.help.unit_meant")
}

fn shown(value: f64) -> String {
    let digits = (4 - value.abs().log10().floor().clamp(-300.0, 300.0) as i32).clamp(0, 12) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
