//! What a procedure says as a whole: references between its tables, contradictions, conditions that cannot be met.

use super::diagnostics::{Problem, SourceText};
use super::model::{
    ChannelSpec, EarthRate, MeasurandOptions, MeasurandSpec, Procedure, RangeCondition, Taus,
};
use super::named_channel::channel_of;
use super::reader::{Reader, meant, shorten};
use super::section::Section;
use crate::config::table::Table;
use crate::i18n::note;
use crate::measurand::{self, EARTH_RATE_OPTION, Options, Test};
use crate::recording::{ColumnRef, Role};
use sagnac_core::spelling::nearest;

/// Reports every contradiction.
pub(super) fn procedure(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    channels(procedure, root, reader);
    sample_rate(procedure, root, reader);
    conditions(procedure, root, reader);
    temperature_test(procedure, root, reader);
    site(procedure, root, reader);
    measurands(procedure, root, reader);
    limits(procedure, reader);
    super::derived::validate(procedure, reader);
    super::validate_bench::validate(procedure, root, reader);
    waivers(procedure, root, reader);
    averaging_times(procedure, root, reader);
    super::tables::acceleration::validate(procedure, root, reader);
    super::tables::transfer::validate(procedure, root, reader);
    super::tables::vibration::validate(procedure, root, reader);
    super::tables::start_up::validate(procedure, root, reader);
    super::tables::noise::validate(procedure, root, reader);
    super::tables::rate_table::validate(procedure, root, reader);
    super::tables::influence::validate(procedure, root, reader);
    super::tables::interim::validate(procedure, root, reader);
}

/// Remarks on a procedure that can be used.
pub(super) fn warnings(procedure: &Procedure, root: &Section, source: &SourceText) -> Vec<Problem> {
    let mut found = super::limits::warnings(&procedure.limits, source);
    found.extend(super::slips::against_channels(procedure, &procedure.limits, source));
    for section in root.tables("instrument") {
        if section.flag("required") && section.entry("calibration_due").is_none() {
            let warning = source.warning(&section.span, "check.no_calibration_due");
            found.push(warning.help("check.help.calibration_due"));
        }
    }
    let column = |c: &ChannelSpec| c.channel.column.clone();
    for (i, channel) in procedure.channels.iter().enumerate() {
        if let Some(other) = procedure.channels[..i].iter().find(|o| column(o) == column(channel)) {
            let message = note!(
                "check.same_column",
                first = other.channel.id.as_str(),
                second = channel.channel.id.as_str(),
                column = shown(&channel.channel.column)
            );
            found.push(source.warning(&channel.span, message));
        }
    }
    for section in root.tables("measurand") {
        let Some(measurand) = section.measurand("id") else { continue };
        let asked = procedure.measurands.iter().find(|m| m.measurand.id == measurand.id);
        let Some(why) = asked.and_then(|spec| super::obtainable::never(procedure, spec)) else { continue };
        let message = note!("check.never_shown", id = measurand.id, why);
        found.push(source.warning(&section.span_of("id"), message));
    }
    if root.table("conditions").is_none_or(|c| c.entry("minimum_duration").is_none()) {
        let at = root.table("conditions").map_or(0..0, |c| c.span.clone());
        found.push(source.warning(&at, "check.no_minimum_duration").help("check.help.minimum_duration"));
    }
    found
}

fn shown(column: &ColumnRef) -> String {
    match column {
        ColumnRef::Name(name) => format!("`{name}`"),
        ColumnRef::Position(position) => position.to_string(),
    }
}

fn channels(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    let sections = root.tables("channel");
    let mut seen: Vec<String> = vec![];
    let mut time: Option<String> = None;
    for section in sections {
        if let Some(id) = section.text("id") {
            if seen.contains(&id) {
                let message = note!("check.second_channel", id = id.as_str());
                reader.error(&section.span_of("id"), message, Some("check.help.second_channel".into()));
            }
            seen.push(id);
        }
        if section.word("role") == Some("time") {
            let id = section.text("id").unwrap_or_default();
            if let Some(first) = &time {
                let message = note!("check.second_time", first = first.as_str());
                reader.error(&section.span_of("role"), message, Some("check.help.second_time".into()));
            } else {
                time = Some(id);
            }
        }
        if let (Some(low), Some(high)) = (section.number("rail_low"), section.number("rail_high"))
            && low >= high
        {
            reader.error(&section.span_of("rail_low"), "check.rails", None);
        }
    }
    // A gyro channel with a problem of its own is reported there and not as missing too.
    let gyro = sections.iter().any(|s| matches!(s.word("role"), Some("rate" | "angle_increment") | None));
    if !gyro && !sections.is_empty() && procedure.gyro_channels().next().is_none() {
        let at = sections.first().map_or(0..0, |s| s.span.clone());
        reader.error(&at, "check.no_gyro", Some("check.help.no_gyro".into()));
    }
}

fn sample_rate(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    if procedure.sample_rate_hz.is_some()
        || root.table("recording").is_some_and(|r| r.entry("sample_rate").is_some())
    {
        return;
    }
    let sections = root.tables("channel");
    let Some(first) = sections.first() else { return };
    let help = "check.help.sample_rate";
    match sections.iter().find(|s| s.word("role") == Some("time")) {
        None if sections.iter().all(|s| s.word("role").is_some()) => {
            reader.error(&first.span.clone(), "check.no_time", Some(help.into()));
        }
        Some(time) if !time.flag("required") => {
            reader.error(&time.span_of("required"), "check.time_may_lack", Some(help.into()));
        }
        _ => {}
    }
}

fn conditions(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    if let Some(section) = root.table("conditions") {
        if let (Some(least), Some(warm_up)) = (section.number("minimum_duration"), section.number("warm_up"))
            && warm_up >= least
        {
            let help = "check.help.warm_up";
            reader.error(&section.span_of("warm_up"), "check.warm_up", Some(help.into()));
        }
        if let (Some(least), Some(planned)) =
            (section.number("minimum_duration"), section.number("planned_duration"))
            && planned < least
        {
            reader.error(&section.span_of("planned_duration"), "check.planned_duration", None);
        }
        for held in section.tables("temperature") {
            channel_of(
                (held, "channel"),
                procedure,
                root,
                |r| r == Role::Temperature,
                "check.needs_temperature",
                reader,
            );
            provable(held, "degC", reader);
        }
        for held in section.tables("supply") {
            channel_of(
                (held, "channel"),
                procedure,
                root,
                |r| r == Role::Supply,
                "check.needs_supply",
                reader,
            );
            provable(held, "V", reader);
        }
        for (held, condition) in section.tables("range").iter().zip(&procedure.conditions.ranges) {
            channel_of((held, "channel"), procedure, root, |_| true, "check.needs_supply", reader);
            range(held, condition, procedure, reader);
        }
        for (held, condition) in section.tables("status").iter().zip(&procedure.conditions.statuses) {
            channel_of(
                (held, "channel"),
                procedure,
                root,
                |r| r == Role::Status,
                "check.needs_status",
                reader,
            );
            if condition.failure_mask == 0.0 && condition.valid_mask == 0.0 {
                reader.error(&held.span.clone(), "check.no_mask", None);
            }
        }
    }
    for section in root.tables("exclude") {
        if let (Some(from), Some(to)) = (section.number("from"), section.number("to"))
            && to <= from
        {
            reader.error(&section.span_of("to"), "check.to_before_from", None);
        }
    }
}

/// What a test over temperature asks must be possible, and its measurands need its table.
fn temperature_test(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    let is_temperature = |r| r == Role::Temperature;
    if let Some(section) = root.table("temperature_test") {
        channel_of((section, "channel"), procedure, root, is_temperature, "check.needs_temperature", reader);
        if let Some(command) = section.text("command")
            && !procedure
                .channels
                .iter()
                .any(|c| c.channel.id == command && c.channel.role == Role::Temperature)
        {
            let message = note!("check_temperature.command", id = shorten(&command));
            reader.error(&section.span_of("command"), message, None);
        }
        let value = |key| section.number(key);
        if let (Some(low), Some(high)) = (value("low"), value("high"))
            && low >= high
        {
            reader.error(&section.span_of("high"), "check_temperature.ends", None);
        }
        if let (Some(slowest), Some(fastest)) = (value("slowest"), value("fastest"))
            && slowest >= fastest
        {
            reader.error(&section.span_of("fastest"), "check_temperature.rates", None);
        }
        if let (Some(tolerance), Some(u), Some(k)) =
            (value("end_tolerance"), value("sensor_uncertainty"), value("coverage_factor"))
            && k * u >= tolerance
        {
            reader.error(&section.span_of("sensor_uncertainty"), "check_temperature.not_provable", None);
        }
        let mut last = 0.0;
        for segment in section.tables("segment") {
            if let (Some(from), Some(to)) = (segment.number("from"), segment.number("to")) {
                if to <= from || from < last {
                    reader.error(&segment.span_of("from"), "check_temperature.segments", None);
                }
                last = to;
            }
        }
    }
    if root.table("warm_up_test").is_some() && procedure.conditions.warm_up_s > 0.0 {
        let at = root.table("conditions").map_or(0..0, |c| c.span_of("warm_up"));
        reader.error(&at, "check_temperature.warm_up", None);
    }
    if let Some(test) = root.table("warm_up_test") {
        let needed = match test.word("start") {
            Some("supply") => Some(Role::Supply),
            Some("temperature") => Some(Role::Temperature),
            _ => None,
        };
        let is = |id: &str, role: Role| procedure.channel(id).is_some_and(|c| c.channel.role == role);
        let named = test.text("start_channel");
        if needed.is_some_and(|role| !named.as_deref().is_some_and(|id| is(id, role))) {
            reader.error(&test.span_of("start"), "check_temperature.start_channel", None);
        }
        if needed == Some(Role::Temperature) && test.number("cold").is_none() {
            reader.error(&test.span_of("start"), "check_temperature.cold", None);
        }
    }
    let moves = root.table("temperature_test").or(root.table("warm_up_test")).is_some();
    for section in root.tables("measurand") {
        let Some(measurand) = section.measurand("id") else { continue };
        if moves && measurand.test().is_at_rest() && !measurand.from_site {
            let message = note!("check_temperature.static", id = measurand.id);
            reader.error(&section.span_of("id"), message, None);
        }
        let table = match measurand.test() {
            Test::Temperature => "temperature_test",
            Test::WarmUp => "warm_up_test",
            _ => continue,
        };
        if root.table(table).is_none() {
            let message = note!("check_temperature.needs_table", id = measurand.id, table);
            reader.error(&section.span_of("id"), message, None);
        }
    }
}

/// A tolerance that the sensor's own uncertainty uses up can never be shown to hold.
/// Bounds that a channel must keep: they are quantities of its dimension, one is stated at least, and a reading can lie
/// between them.
fn range(section: &Section, condition: &RangeCondition, procedure: &Procedure, reader: &mut Reader<'_>) {
    let Some(channel) = procedure.channel(&condition.channel) else { return };
    if condition.min.is_none() && condition.max.is_none() {
        reader.error(&section.span.clone(), "check.no_bound", None);
        return;
    }
    match condition.bounds(&channel.channel) {
        Err(wrong) => reader.error(&section.span_of(wrong.key), wrong.why.message, wrong.why.help),
        Ok(b) if b.low >= b.high => reader.error(&section.span_of("max"), "check.bounds", None),
        Ok(b) => {
            let guard = condition.coverage_factor * b.standard_uncertainty;
            if b.standard_uncertainty < 0.0 || 2.0 * guard >= b.high - b.low {
                reader.error(&section.span_of("sensor_uncertainty"), "check.bounds_not_provable", None);
            }
        }
    }
}

fn provable(section: &Section, unit: &str, reader: &mut Reader<'_>) {
    let value = |key| section.number(key);
    let (Some(tolerance), Some(u), Some(k)) =
        (value("tolerance"), value("sensor_uncertainty"), value("coverage_factor"))
    else {
        return;
    };
    if k * u >= tolerance {
        let message = note!(
            "check.not_provable",
            factor = k.to_string(),
            uncertainty = format!("{u} {unit}"),
            tolerance = format!("{tolerance} {unit}")
        );
        reader.error(&section.span_of("sensor_uncertainty"), message, Some("check.help.not_provable".into()));
    }
}

fn site(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    let Some(site) = root.table("site") else { return };
    for section in std::iter::once(site).chain(site.tables("axis")) {
        let vertical = section.number("elevation").is_none_or(|e| (e.abs() - 90.0).abs() < 1e-9);
        if !vertical && section.entry("heading").is_none() {
            let help = "check.help.heading";
            reader.error(&section.span_of("elevation"), "check.no_heading", Some(help.into()));
        }
    }
    let mut seen: Vec<String> = vec![];
    for axis in site.tables("axis") {
        channel_of((axis, "channel"), procedure, root, Role::is_gyro, "check.needs_gyro", reader);
        let id = axis.text("channel").unwrap_or_default();
        if seen.contains(&id) {
            let message = note!("check.second_direction", id = id.as_str());
            reader.error(&axis.span_of("channel"), message, None);
        }
        seen.push(id);
    }
}

fn measurands(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    let sections = root.tables("measurand");
    let has_site = root.entry("site").is_some();
    for (i, section) in sections.iter().enumerate() {
        channel_of((section, "channel"), procedure, root, Role::is_gyro, "check.needs_gyro", reader);
        let Some(measurand) = section.measurand("id") else { continue };
        let clash = sections[..i].iter().any(|other| {
            let (a, b) = (other.text("channel"), section.text("channel"));
            other.measurand("id") == Some(measurand) && (a == b || a.is_none() || b.is_none())
        });
        if clash {
            let message = note!("check.declared_twice", id = measurand.id);
            reader.error(&section.span_of("id"), message, Some("check.help.declared_twice".into()));
        }
        let options = section.table("options");
        let removes = options.and_then(|o| o.word(EARTH_RATE_OPTION)) != Some("keep");
        if measurand.needs_site(&Options { remove_earth_rate: removes }) && !has_site {
            let message = note!("check.needs_site", id = measurand.id);
            let help = if measurand.from_site { "check.help.site" } else { "check.help.site_or_keep" };
            reader.error(&section.span_of("id"), message, Some(help.into()));
        }
        for key in MeasurandOptions::SPEC.keys {
            let set = options.is_some_and(|o| o.entry(key.name).is_some());
            if set && !measurand.options.contains(&key.name) {
                let at = options.map_or_else(|| section.span.clone(), |o| o.span_of(key.name));
                let message = note!("check.no_option", key = key.name, id = measurand.id);
                reader.error(&at, message, None);
            }
        }
    }
}

/// A limit on what is not measured would be met by saying nothing.
fn limits(procedure: &Procedure, reader: &mut Reader<'_>) {
    for limit in &procedure.limits.limits {
        if let Some(channel) = limit.channel.as_deref().filter(|c| procedure.channel(c).is_none()) {
            let known: Vec<&str> = procedure.channels.iter().map(|c| c.channel.id.as_str()).collect();
            let help = nearest(channel, known.iter().copied()).map(meant);
            let message = note!("check.limit_of_undeclared", channel = shorten(channel));
            reader.error(&limit.span, message, help);
        } else if !procedure.measures(limit.measurand.id, limit.channel.as_deref()) {
            let message = note!("check.limit_not_measured", id = limit.measurand.id);
            let help = note!("check.help.limit_not_measured", id = limit.measurand.id);
            reader.error(&limit.span, message, Some(help));
        } else if let Some(message) = super::scale_factor_unit::other_unit(procedure, limit) {
            reader.error(&limit.span, message, None);
        }
    }
    for reference in &procedure.limits.references {
        if let Some(channel) = reference.channel.as_deref().filter(|c| procedure.channel(c).is_none()) {
            let message = note!("check.reference_of_undeclared", channel = shorten(channel));
            reader.error(&reference.span, message, None);
        }
    }
}

/// A waiver for a row that is not in the report would never be seen.
fn waivers(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    for section in root.tables("waiver") {
        let Some(row) = section.text("row") else { continue };
        if procedure.measures(&row, None) {
            continue;
        }
        let measured = procedure.measurands.iter().map(|m| m.measurand.id);
        let help = match (nearest(&row, measured), measurand::find(&row)) {
            (Some(near), _) => meant(near),
            (None, Some(_)) => note!("check.help.waiver_not_measured"),
            // Anything else may be the id of a condition.
            (None, None) => continue,
        };
        let message = note!("check.no_row", row = shorten(&row));
        reader.error(&section.span_of("row"), message, Some(help));
    }
}

/// Averaging times are multiples of the sample interval.
fn averaging_times(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    let (Taus::List(list), Some(rate)) = (&procedure.analysis.taus, procedure.sample_rate_hz) else { return };
    for tau in list {
        let samples = tau * rate;
        let multiple = samples >= 0.5 && (samples - samples.round()).abs() <= 1e-6 * samples.max(1.0);
        if !multiple {
            let at = root.table("analysis").map_or(0..0, |a| a.span_of("taus"));
            let message = note!(
                "check.tau_no_multiple",
                tau = format!("{tau} s"),
                interval = format!("{} s", 1.0 / rate)
            );
            reader.error(&at, message, None);
        }
    }
}

impl MeasurandSpec {
    /// The choices of the procedure for it.
    pub fn options(&self) -> Options {
        Options { remove_earth_rate: self.earth_rate == EarthRate::Remove }
    }

    /// True when the Earth rate along the input axis is needed.
    pub fn needs_earth_rate(&self) -> bool {
        self.measurand.needs_site(&self.options())
    }
}
