//! From checked tables to the model.

use super::diagnostics::{Problems, SourceText};
use super::limits::{self, LimitsFile};
use super::model::{
    Analysis, ChannelSpec, Conditions, EarthRate, ExplainSpec, FaultBudget, Instrument, MeasurandSpec,
    Procedure, RecordingSpec, ReportSpec, SupplyCondition, Taus, TemperatureCondition, UnitSpec, Waiver,
};
use super::reader::Reader;
use super::section::{Entry, Section};
use super::site::{Orientation, Site};
use super::tables::PROCEDURE_FILE;
use super::tables::limits::LIMITS_FILE;
use super::unit_facts::UnitFact;
use super::{channel, recording_options, validate};
use crate::config::contained_files;
use crate::config::read_tables::checked;
use crate::measurand::EARTH_RATE_OPTION;
use crate::record::{ClauseRecord, ExclusionRecord, WaiverRecord};
use crate::signing::Role;
use crate::temperature::{SegmentKind, StartAsked, StatedSegment, TemperatureTest, WarmUpTest};
use sagnac_ingest::layout::LayoutFile;
use std::path::{Path, PathBuf};

/// Reads a procedure from its text. The second value holds every problem, warnings among them. With its folder, the
/// files that it names must be there.
pub(super) fn procedure(source: &SourceText, folder: Option<&Path>) -> (Option<Procedure>, Problems) {
    checked(source, &PROCEDURE_FILE, |root, reader| {
        let mut procedure = build(root, reader);
        let layout = named(root, "recording", "layout", folder, reader);
        procedure.recording.read.layout = layout.map(LayoutFile::at);
        let model = named(root, "explain", "model", folder, reader);
        if let (Some(spec), Some(model)) = (&mut procedure.explain, model) {
            spec.model = model;
        }
        validate::procedure(&procedure, root, reader);
        let warnings = validate::warnings(&procedure, root, reader.source);
        reader.problems.list.extend(warnings);
        procedure
    })
}

/// The path of a file that a procedure names, as it can be opened: it stands beside the procedure or below, wherever the
/// program is started.
fn named(
    root: &Section,
    table: &str,
    key: &str,
    folder: Option<&Path>,
    reader: &mut Reader<'_>,
) -> Option<PathBuf> {
    let section = root.table(table)?;
    let text = section.text(key)?;
    let at = reader.source.inside_quotes(&section.span_of(key));
    match folder {
        Some(folder) => contained_files::file(&text, folder, &at, reader).map(|f| f.path),
        None => contained_files::stays(&text, &at, reader).then(|| {
            let of_name = Path::new(&reader.source.name).parent().unwrap_or(Path::new(""));
            contained_files::joined(of_name, &text)
        }),
    }
}

/// Reads a limits file from its text.
pub(super) fn limits_file(source: &SourceText) -> (Option<LimitsFile>, Problems) {
    checked(source, &LIMITS_FILE, |root, reader| {
        let identity = root.table("limits");
        let text = |key| identity.and_then(|i| i.text(key));
        let local = |key| identity.and_then(|i| i.local_text(key));
        let set = limits::read_set(root, identity.and_then(|i| i.number("factor")), reader);
        let warnings = limits::warnings(&set, reader.source);
        reader.problems.list.extend(warnings);
        LimitsFile {
            id: text("id").unwrap_or_default(),
            title: local("title").unwrap_or_default(),
            revision: text("revision").unwrap_or_default(),
            family: local("family"),
            source: local("source"),
            set,
        }
    })
}

fn build(root: &Section, reader: &mut Reader<'_>) -> Procedure {
    let identity = root.table("procedure");
    let text = |key| identity.and_then(|i| i.text(key));
    let local = |key| identity.and_then(|i| i.local_text(key));
    let recording = root.table("recording");
    Procedure {
        id: text("id").unwrap_or_default(),
        title: local("title").unwrap_or_default(),
        revision: text("revision").unwrap_or_default(),
        standard: local("standard"),
        clause: local("clause"),
        author: local("author"),
        unit_under_test: unit(root.table("unit_under_test")),
        recording: RecordingSpec {
            read: recording_options::options(recording, root.tables("channel"), reader),
        },
        sample_rate_hz: recording.and_then(|r| r.number("sample_rate")),
        sample_rate_tolerance: recording.and_then(|r| r.number("sample_rate_tolerance")).unwrap_or(0.01),
        channels: root.tables("channel").iter().filter_map(|s| one_channel(s, reader)).collect(),
        conditions: root.table("conditions").map(conditions).unwrap_or_default(),
        exclusions: root.tables("exclude").iter().map(exclusion).collect(),
        site: root.table("site").map(site),
        instruments: root.tables("instrument").iter().map(instrument).collect(),
        rate_table: root.table("rate_table").map(|s| super::tables::rate_table::setup(s, root)),
        analysis: analysis(root.table("analysis")),
        explain: root.table("explain").map(explain),
        temperature_test: root.table("temperature_test").map(temperature_test),
        warm_up_test: root.table("warm_up_test").map(warm_up_test),
        repeatability_test: root.table("repeatability_test").map(super::tables::influence::repeatability),
        comparison_test: super::tables::influence::comparison(root),
        measurands: root.tables("measurand").iter().filter_map(measurand).collect(),
        limits: limits::read_set(root, None, reader),
        clauses: root.tables("clause").iter().map(clause).collect(),
        report: report(root.table("report")),
        waivers: root.tables("waiver").iter().map(waiver).collect(),
    }
}

fn unit(section: Option<&Section>) -> UnitSpec {
    let Some(section) = section else {
        return UnitSpec { serial_required: true, ..UnitSpec::default() };
    };
    UnitSpec {
        family: section.local_text("family"),
        part: section.text("part"),
        revision: section.text("revision"),
        serial_required: section.flag("serial_required"),
        requires: required_facts(section),
    }
}

/// What a procedure demands to be known of a unit.
pub(super) fn required_facts(section: &Section) -> Vec<UnitFact> {
    match section.entry("requires") {
        Some(Entry::Words(words)) => words.iter().filter_map(|w| UnitFact::of(w)).collect(),
        _ => vec![],
    }
}

fn one_channel(section: &Section, reader: &mut Reader<'_>) -> Option<ChannelSpec> {
    let (channel, unit_in_file) = channel::read(section, reader)?;
    let rollover = channel::rollover(section, channel.role, reader);
    Some(ChannelSpec {
        channel,
        unit_in_file,
        rail_low: section.number("rail_low"),
        rail_high: section.number("rail_high"),
        rollover,
        required: section.flag("required"),
        span: section.span.clone(),
        column_span: reader.source.inside_quotes(&section.span_of("column")),
    })
}

fn conditions(section: &Section) -> Conditions {
    Conditions {
        minimum_duration_s: section.number("minimum_duration"),
        planned_duration_s: section.number("planned_duration"),
        warm_up_s: section.number("warm_up").unwrap_or(0.0),
        temperatures: section.tables("temperature").iter().map(temperature).collect(),
        supplies: section.tables("supply").iter().map(supply).collect(),
        faults: section.table("faults").map(faults).unwrap_or_default(),
    }
}

fn temperature(section: &Section) -> TemperatureCondition {
    TemperatureCondition {
        channel: section.text("channel").unwrap_or_default(),
        nominal_deg_c: section.number("nominal").unwrap_or(0.0),
        tolerance_deg_c: section.number("tolerance").unwrap_or(0.0),
        sensor_uncertainty_deg_c: section.number("sensor_uncertainty").unwrap_or(0.0),
        coverage_factor: section.number("coverage_factor").unwrap_or(2.0),
        smoothing_s: section.number("smoothing").unwrap_or(0.0),
    }
}

fn supply(section: &Section) -> SupplyCondition {
    SupplyCondition {
        channel: section.text("channel").unwrap_or_default(),
        nominal_v: section.number("nominal").unwrap_or(0.0),
        tolerance_v: section.number("tolerance").unwrap_or(0.0),
        sensor_uncertainty_v: section.number("sensor_uncertainty").unwrap_or(0.0),
        coverage_factor: section.number("coverage_factor").unwrap_or(2.0),
    }
}

fn faults(section: &Section) -> FaultBudget {
    FaultBudget {
        gaps: section.allowance("gaps"),
        missing_samples: section.allowance("missing_samples"),
        longest_gap_s: section.number("longest_gap"),
        duplicate_timestamps: section.allowance("duplicate_timestamps"),
        backward_timestamps: section.allowance("backward_timestamps"),
        non_finite: section.allowance("non_finite"),
        unparsable: section.allowance("unparsable"),
        outliers: section.allowance("outliers"),
        saturated: section.allowance("saturated"),
        stuck: section.allowance("stuck"),
        repeated: section.allowance("repeated"),
        timestamp_jitter_s: section.number("timestamp_jitter"),
    }
}

fn exclusion(section: &Section) -> ExclusionRecord {
    ExclusionRecord {
        from_s: section.number("from").unwrap_or(0.0),
        to_s: section.number("to").unwrap_or(0.0),
        reason: section.local_text("reason").unwrap_or_default(),
    }
}

fn orientation(section: &Section) -> Orientation {
    Orientation {
        heading_deg: section.number("heading").unwrap_or(0.0),
        heading_uncertainty_deg: section.number("heading_uncertainty").unwrap_or(0.0),
        elevation_deg: section.number("elevation").unwrap_or(0.0),
        elevation_uncertainty_deg: section.number("elevation_uncertainty").unwrap_or(0.0),
    }
}

fn site(section: &Section) -> Site {
    let axis = |s: &Section| (s.text("channel").unwrap_or_default(), orientation(s));
    Site {
        latitude_deg: section.number("latitude").unwrap_or(0.0),
        latitude_uncertainty_deg: section.number("latitude_uncertainty").unwrap_or(0.0),
        orientation: orientation(section),
        axes: section.tables("axis").iter().map(axis).collect(),
    }
}

fn instrument(section: &Section) -> Instrument {
    Instrument {
        name: section.local_text("name").unwrap_or_default(),
        serial: section.text("serial"),
        calibration_due: section.date("calibration_due"),
        required: section.flag("required"),
        span: section.span.clone(),
    }
}

fn analysis(section: Option<&Section>) -> Analysis {
    let taus = match section.and_then(|s| s.entry("taus")) {
        Some(Entry::Taus(taus)) => taus.clone(),
        _ => Taus::Octave,
    };
    Analysis {
        taus,
        exact: section.is_some_and(|s| s.flag("exact")),
        line_false_alarm: section.and_then(|s| s.number("line_false_alarm")).unwrap_or(0.01),
    }
}

fn explain(section: &Section) -> ExplainSpec {
    ExplainSpec {
        model: section.text("model").unwrap_or_default().into(),
        alpha: section.number("alpha").unwrap_or(0.01),
        max_effects: section.number("max_effects").map_or(3, |n| n as usize),
    }
}

fn temperature_test(section: &Section) -> TemperatureTest {
    let number = |key| section.number(key);
    let (low, high) = (number("low").unwrap_or(0.0), number("high").unwrap_or(0.0));
    let zones = number("zones").unwrap_or(5.0) as usize;
    let zone = |i: usize| match zones {
        1 => 0.5 * (low + high),
        n => low + (high - low) * i as f64 / (n - 1) as f64,
    };
    TemperatureTest {
        channel: section.text("channel").unwrap_or_default(),
        command: section.text("command"),
        low_deg_c: low,
        high_deg_c: high,
        end_tolerance_deg_c: number("end_tolerance").unwrap_or(2.0),
        overshoot_deg_c: number("overshoot"),
        ramp_rate_deg_c_h: number("ramp_rate"),
        ramp_rate_tolerance: number("ramp_rate_tolerance").unwrap_or(0.1),
        slowest_deg_c_h: number("slowest").unwrap_or(4.0),
        fastest_deg_c_h: number("fastest").unwrap_or(60.0),
        dwell_s: number("dwell"),
        dwell_drift_deg_c_h: number("dwell_drift").unwrap_or(1.0),
        ramps_each_way: number("ramps_each_way").unwrap_or(1.0) as usize,
        sensor_uncertainty_deg_c: number("sensor_uncertainty").unwrap_or(0.0),
        coverage_factor: number("coverage_factor").unwrap_or(2.0),
        zones_deg_c: (0..zones).map(zone).collect(),
        residual_average_s: number("residual_average").unwrap_or(100.0),
        highest_order: number("highest_order").unwrap_or(6.0) as usize,
        segments: section.tables("segment").iter().filter_map(segment).collect(),
    }
}

fn segment(section: &Section) -> Option<StatedSegment> {
    let kind = SegmentKind::ALL.into_iter().find(|k| section.word("kind") == Some(k.id()))?;
    Some(StatedSegment { kind, from_s: section.number("from")?, to_s: section.number("to")? })
}

fn warm_up_test(section: &Section) -> WarmUpTest {
    WarmUpTest {
        band_deg_h: section.number("band").unwrap_or(0.0),
        final_share: section.number("final_share").unwrap_or(0.25),
        start: started(section).unwrap_or(StartAsked::Nothing),
    }
}

fn started(section: &Section) -> Option<StartAsked> {
    let channel = section.text("start_channel");
    Some(match section.word("start")? {
        "declared" => StartAsked::Declared,
        "stamp" => StartAsked::Stamp { power_on_s: section.number("power_on").unwrap_or(0.0) },
        "supply" => StartAsked::Supply { channel: channel? },
        _ => StartAsked::Temperature {
            channel: channel?,
            cold_deg_c: section.number("cold")?,
            tolerance_deg_c: section.number("cold_tolerance").unwrap_or(0.5),
        },
    })
}

fn measurand(section: &Section) -> Option<MeasurandSpec> {
    let earth_rate = match section.table("options").and_then(|o| o.word(EARTH_RATE_OPTION)) {
        Some("keep") => EarthRate::Keep,
        _ => EarthRate::Remove,
    };
    let measurand = section.measurand("id")?;
    Some(MeasurandSpec {
        measurand,
        channel: section.text("channel"),
        earth_rate,
        span: section.span.clone(),
    })
}

pub(super) fn clause(section: &Section) -> ClauseRecord {
    ClauseRecord {
        clause: section.local_text("clause").unwrap_or_default(),
        title: section.local_text("title").unwrap_or_default(),
        status: section.word("status").unwrap_or_default().to_owned(),
        note: section.local_text("note").unwrap_or_default(),
    }
}

fn report(section: Option<&Section>) -> ReportSpec {
    let figures = match section.and_then(|s| s.entry("figures")) {
        Some(Entry::Words(words)) => Some(words.clone()),
        _ => None,
    };
    ReportSpec {
        title: section.and_then(|s| s.local_text("title")),
        figures,
        show_reference: section.is_none_or(|s| s.flag("show_reference")),
        signatures: match section.and_then(|s| s.entry("signatures")) {
            Some(Entry::Words(words)) => words.iter().filter_map(|w| Role::of(w)).collect(),
            _ => vec![],
        },
    }
}

fn waiver(section: &Section) -> Waiver {
    Waiver {
        serial: section.text("serial").unwrap_or_default(),
        record: WaiverRecord {
            row: section.text("row").unwrap_or_default(),
            by: section.local_text("by").unwrap_or_default(),
            reason: section.local_text("reason").unwrap_or_default(),
            date: section.date("date").map(|d| d.to_string()).unwrap_or_default(),
        },
    }
}
