//! Limits, reference values and typical values; and how a limits file goes over the limits of a procedure.

use super::derived;
use super::diagnostics::{Problem, SourceText};
pub use super::limit_set::gyro_of;
pub use super::limit_set::{Expected, LimitSet, LimitSpec, LimitsFile, Reference};
use super::model::{Loaded, Procedure};
use super::reader::Reader;
use super::scale_factor_unit;
use super::section::Section;
use super::slips;
use super::tables::limits::{LimitKeys, ReferenceKeys, TypicalValues};
use crate::config::values::as_recorded_help;
use crate::estimate::{Limit, Rule};
use crate::i18n::{Note, note};
use crate::measurand::{Measurand, RATE_NOISE_DENSITY};
use crate::record::{LimitsFile as LimitsFileRecord, ReferenceRecord};

impl Loaded<LimitsFile> {
    /// The identity of the file as it stands in results.
    pub fn record(&self) -> LimitsFileRecord {
        LimitsFileRecord {
            id: self.value.id.clone(),
            title: self.value.title.clone(),
            revision: self.value.revision.clone(),
            source: self.value.source.clone(),
            path: self.path.clone(),
            sha256: self.sha256.clone(),
        }
    }
}

/// The limits that hold in a run: those of the procedure with those of a limits file over them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EffectiveLimits {
    /// What holds.
    pub set: LimitSet,
    /// Things worth knowing, such as limits that this procedure does not measure.
    pub warnings: Vec<Problem>,
    /// Why no limit of the file that was given can decide anything here.
    pub idle: Option<Note>,
}

impl EffectiveLimits {
    /// The limit of a measurand on a channel: one for that channel goes before one for every channel. Rows by zone, axis
    /// or level (`rate@-40`, `x<-y`) are judged by the limit of the gyro whose they are.
    pub fn limit(&self, measurand: &str, channel: &str) -> Option<&LimitSpec> {
        let of = |channel: &str| {
            let limits = self.set.limits.iter().map(|l| (l, l.measurand.id, l.channel.as_deref()));
            best(limits, measurand, channel)
        };
        of(channel).filter(|l| l.channel.is_some()).or_else(|| of(gyro_of(channel)))
    }

    /// The reference value of a measurand on a channel; the first where there are several.
    pub fn reference(&self, measurand: &str, channel: &str) -> Option<&Reference> {
        best(
            self.set.references.iter().map(|r| (r, r.measurand.id, r.channel.as_deref())),
            measurand,
            channel,
        )
    }

    /// The typical value of a measurand.
    pub fn expected(&self, measurand: &str) -> Option<f64> {
        self.set.expected.iter().find(|e| e.measurand.id == measurand).map(|e| e.value)
    }
}

/// The first entry for the channel, or else the first for every channel.
fn best<'a, T>(
    entries: impl Iterator<Item = (&'a T, &'static str, Option<&'a str>)> + Clone,
    measurand: &str,
    channel: &str,
) -> Option<&'a T> {
    let of = |wanted: Option<&str>| {
        entries.clone().find(|(_, id, own)| *id == measurand && *own == wanted).map(|(entry, _, _)| entry)
    };
    of(Some(channel)).or_else(|| of(None))
}

/// Puts a limits file over the limits of a procedure.
///
/// A limit of the file replaces those of the procedure for the same measurand and channel; one for every channel
/// replaces all of that measurand. References and typical values go the same way.
pub fn effective(procedure: &Loaded<Procedure>, file: Option<&Loaded<LimitsFile>>) -> EffectiveLimits {
    let own = &procedure.value.limits;
    let Some(file) = file else {
        return EffectiveLimits { set: own.clone(), ..EffectiveLimits::default() };
    };
    let over = &file.value.set;
    let replaced = |id: &str, channel: &Option<String>, by: &[(&str, &Option<String>)]| {
        by.iter().any(|(other, c)| *other == id && (c.is_none() || *c == channel))
    };
    let limits: Vec<_> = over.limits.iter().map(|l| (l.measurand.id, &l.channel)).collect();
    let references: Vec<_> = over.references.iter().map(|r| (r.measurand.id, &r.channel)).collect();
    let mut set = over.clone();
    set.limits.extend(own.limits.iter().filter(|l| !replaced(l.measurand.id, &l.channel, &limits)).cloned());
    set.references.extend(
        own.references.iter().filter(|r| !replaced(r.measurand.id, &r.channel, &references)).cloned(),
    );
    set.expected.extend(
        own.expected.iter().filter(|e| over.expected.iter().all(|o| o.measurand != e.measurand)).cloned(),
    );
    set.derived
        .extend(own.derived.iter().filter(|d| over.derived.iter().all(|o| o.derived != d.derived)).cloned());
    let mut warnings = not_measured(&procedure.value, file);
    let unusable = over.derived.iter().filter_map(|limit| derived::unusable(&procedure.value, limit));
    warnings.extend(unusable.map(|(span, message)| file.source.warning(&span, message)));
    warnings.extend(slips::against_channels(&procedure.value, over, &file.source));
    EffectiveLimits { set, warnings, idle: idle(&procedure.value, file) }
}

/// Why no limit of a file decides anything with a procedure; `None` where one does.
fn idle(procedure: &Procedure, file: &Loaded<LimitsFile>) -> Option<Note> {
    let limits = &file.value.set.limits;
    let applies = |l: &LimitSpec| {
        procedure.measures(l.measurand.id, l.channel.as_deref())
            && l.channel.as_deref().is_none_or(|c| procedure.channel(gyro_of(c)).is_some())
            && scale_factor_unit::other_unit(procedure, l).is_none()
    };
    let derived = &file.value.set.derived;
    if limits.iter().any(applies) || derived.iter().any(|d| derived::unusable(procedure, d).is_none()) {
        return None;
    }
    let key =
        if limits.is_empty() && derived.is_empty() { "check.references_only" } else { "check.none_applies" };
    Some(Note::new(key).with("path", file.path.as_str()).with("procedure", procedure.id.as_str()))
}

/// Limits of a file that the procedure does not measure. The file may serve other procedures too, so this is worth
/// knowing and no error.
fn not_measured(procedure: &Procedure, file: &Loaded<LimitsFile>) -> Vec<Problem> {
    let mut warnings = vec![];
    for limit in &file.value.set.limits {
        if !procedure.measures(limit.measurand.id, limit.channel.as_deref()) {
            let message = note!("check.not_judged", procedure = procedure.id.as_str());
            let help = note!("check.help.measure", id = limit.measurand.id);
            warnings.push(file.source.warning(&limit.span, message).help(help));
        } else if let Some(channel) = limit.channel.as_deref()
            && procedure.channel(channel).is_none()
        {
            let message = note!("check.no_such_channel", procedure = procedure.id.as_str(), channel);
            warnings.push(file.source.warning(&limit.span, message));
        } else if let Some(message) = scale_factor_unit::other_unit(procedure, limit) {
            warnings.push(file.source.warning(&limit.span, message));
        }
    }
    warnings
}

/// Limits, references and typical values of a file, checked.
pub(super) fn read_set(
    limits: Vec<LimitKeys>,
    references: Vec<ReferenceKeys>,
    typical: TypicalValues,
    general_factor: Option<f64>,
    reader: &mut Reader<'_>,
) -> LimitSet {
    let mut set = LimitSet::default();
    for keys in references {
        let (Some(measurand), Some(value)) = (keys.measurand, keys.value) else { continue };
        if value < 0.0 && !measurand.signed {
            reader.error(&keys.section.span_of("value"), about("check.never_negative", measurand), None);
        }
        set.references.push(Reference {
            measurand,
            channel: keys.channel,
            record: ReferenceRecord { value, source: keys.source, note: keys.note },
            span: keys.section.span,
        });
    }
    for (measurand, value, span) in typical {
        if value < 0.0 && !measurand.signed {
            reader.error(&span, about("check.cannot_be_negative", measurand), None);
        }
        set.expected.push(Expected { measurand, value, span });
    }
    for keys in limits {
        let section = keys.section.clone();
        if keys.measurand.is_some_and(|m| *m == RATE_NOISE_DENSITY) {
            slips::not_a_density(&section, reader);
        }
        if let Some(limit) = read_limit(keys, &set.references, reader) {
            set.limits.push(limit);
            set.fast_units.extend(slips::fast_unit(&section, reader));
        }
    }
    if let Some(factor) = general_factor {
        add_limits_by_factor(&mut set, factor, &reader.source.name);
    }
    duplicates(&set, reader);
    set
}

/// A sentence about a measurand.
fn about(key: &'static str, measurand: &Measurand) -> Note {
    Note::new(key).with("measurand", measurand.id)
}

/// The limit that a factor makes of a typical value: an upper one, or one on the magnitude of what can be negative.
/// `None` when no unit could meet it or no number could hold it.
fn by_factor(measurand: &Measurand, factor: f64, typical: f64) -> Option<Bounds> {
    let bound = factor * typical.abs();
    let usable = bound.is_finite() && bound > 0.0;
    usable.then_some(Bounds { min: measurand.signed.then_some(-bound), max: Some(bound) })
}

/// Bounds of a value, both allowed.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    min: Option<f64>,
    max: Option<f64>,
}

/// Makes a limit of every first reference value that has no limit of its own.
fn add_limits_by_factor(set: &mut LimitSet, factor: f64, source: &str) {
    let LimitKeys { rule, risk, .. } = LimitKeys::default();
    // A multiple of an output per input bounds nothing that anybody means.
    for reference in set.references.iter().filter(|r| !r.measurand.unit.is_empty()) {
        let taken = |l: &LimitSpec| {
            l.measurand == reference.measurand && (l.channel.is_none() || l.channel == reference.channel)
        };
        let made = by_factor(reference.measurand, factor, reference.record.value);
        let Some(Bounds { min, max }) = made.filter(|_| !set.limits.iter().any(taken)) else { continue };
        set.limits.push(LimitSpec {
            measurand: reference.measurand,
            channel: reference.channel.clone(),
            limit: Limit { min, max, rule, risk, source: source.to_owned() },
            recorded_unit: None,
            span: reference.span.clone(),
        });
    }
}

/// The keys that bound a value.
const BOUND_KEYS: [&str; 4] = ["min", "max", "max_abs", "factor"];

fn read_limit(keys: LimitKeys, references: &[Reference], reader: &mut Reader<'_>) -> Option<LimitSpec> {
    let (measurand, section) = (keys.measurand?, &keys.section);
    bounds_are_stated_once(section, measurand, reader)?;
    let mut bounds = stated_bounds(&keys, measurand, reader)?;
    let units: Vec<&'static str> =
        ["min", "max", "max_abs"].into_iter().filter_map(|key| section.recorded_unit(key)).collect();
    if units.windows(2).any(|pair| pair[0] != pair[1]) || keys.factor.is_some() && measurand.unit.is_empty() {
        let help = as_recorded_help(measurand.recorded_in);
        reader.error(&section.span, about("check.limit_as_recorded", measurand), Some(help));
        return None;
    }
    if let Some(factor) = keys.factor {
        let matching =
            |r: &&Reference| r.measurand == measurand && (r.channel == keys.channel || r.channel.is_none());
        let reference = references.iter().find(matching);
        bounds = bounds_by_factor(section, measurand, factor, reference, reader)?;
    }
    bounds_can_be_met(section, measurand, bounds, reader)?;
    let Bounds { min, max } = bounds;
    if min.is_none() && max.is_none() {
        return None;
    }
    let LimitKeys { channel, rule, risk, .. } = keys;
    let limit = Limit { min, max, rule, risk, source: reader.source.name.clone() };
    let recorded_unit = units.first().copied();
    Some(LimitSpec { measurand, channel, limit, recorded_unit, span: keys.section.span })
}

/// Reports a limit without bounds, or with `max_abs` or `factor` beside other bounds.
fn bounds_are_stated_once(section: &Section, measurand: &Measurand, reader: &mut Reader<'_>) -> Option<()> {
    let states = |key: &str| section.entry(key).is_some();
    if !BOUND_KEYS.iter().any(|key| states(key)) {
        let help = Some("check.help.limit_value".into());
        reader.error(&section.span, about("check.limit_without_value", measurand), help);
        return None;
    }
    let others = |key: &str| BOUND_KEYS.iter().any(|k| *k != key && states(k));
    if let Some(key) = ["max_abs", "factor"].into_iter().find(|key| states(key) && others(key)) {
        let message = note!("check.stands_alone", key);
        reader.error(&section.span_of(key), message, Some("check.help.stands_alone".into()));
        return None;
    }
    Some(())
}

/// The bounds that are given as values.
fn stated_bounds(keys: &LimitKeys, measurand: &Measurand, reader: &mut Reader<'_>) -> Option<Bounds> {
    let Some(bound) = keys.max_abs else {
        return Some(Bounds { min: keys.min, max: keys.max });
    };
    let at = keys.section.span_of("max_abs");
    if !measurand.signed {
        let help = Some("check.help.max_for_max_abs".into());
        reader.error(&at, about("check.never_negative", measurand), help);
        return None;
    }
    if bound <= 0.0 {
        reader.error(&at, "check.max_abs_zero", None);
        return None;
    }
    Some(Bounds { min: Some(-bound), max: Some(bound) })
}

/// The bounds that a factor makes of the typical value.
fn bounds_by_factor(
    section: &Section,
    measurand: &Measurand,
    factor: f64,
    reference: Option<&Reference>,
    reader: &mut Reader<'_>,
) -> Option<Bounds> {
    let at = section.span_of("factor");
    let Some(reference) = reference else {
        let help = Some("check.help.factor".into());
        reader.error(&at, about("check.factor_without_reference", measurand), help);
        return None;
    };
    let made = by_factor(measurand, factor, reference.record.value);
    if made.is_none() {
        let value = reference.record.value.to_string();
        let message = note!("check.factor_gives_none", value);
        reader.error(&at, message, Some("check.help.max_for_factor".into()));
    }
    made
}

/// Reports bounds that no value can meet.
fn bounds_can_be_met(
    section: &Section,
    measurand: &Measurand,
    Bounds { min, max }: Bounds,
    reader: &mut Reader<'_>,
) -> Option<()> {
    if let (Some(low), Some(high)) = (min, max)
        && low > high
    {
        let message = note!(
            "check.min_above_max",
            low = low.to_string(),
            high = high.to_string(),
            unit = measurand.unit
        );
        reader.error(&section.span_of("min"), message, Some("check.help.nothing_meets".into()));
        return None;
    }
    if let Some(high) = max.filter(|high| !measurand.signed && *high <= 0.0) {
        let key = if high < 0.0 { "check.unmet_negative" } else { "check.unmet_zero" };
        let at = if section.number("factor").is_some() { "factor" } else { "max" };
        reader.error(&section.span_of(at), about(key, measurand), None);
        return None;
    }
    Some(())
}

/// Two limits for the same measurand and channel contradict each other.
fn duplicates(set: &LimitSet, reader: &mut Reader<'_>) {
    for (i, limit) in set.limits.iter().enumerate() {
        if set.limits[..i].iter().any(|l| l.measurand == limit.measurand && l.channel == limit.channel) {
            let message = about("check.second_limit", limit.measurand);
            reader.error(&limit.span, message, Some("check.help.second_limit".into()));
        }
    }
}

/// Says what is worth knowing about limits that can be used.
pub(super) fn warnings(set: &LimitSet, source: &SourceText) -> Vec<Problem> {
    let mut found = slips::of_set(set, source);
    for limit in &set.limits {
        let typical = set.references.iter().find(|r| r.measurand == limit.measurand).map(|r| r.record.value);
        let too_tight = matches!((limit.limit.max, typical), (Some(max), Some(value)) if max <= value);
        if too_tight && limit.limit.rule == Rule::GuardBand {
            let message = about("check.limit_at_typical", limit.measurand);
            found.push(source.warning(&limit.span, message).help("check.help.above_typical"));
        }
    }
    found
}
