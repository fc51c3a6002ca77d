//! From checked tables to the model.

use super::diagnostics::{Problems, SourceText, Span};
use super::limits::{self, LimitsFile};
use super::model::{ChannelSpec, MeasurandKeys, Procedure, RecordingSpec};
use super::reader::Reader;
use super::section::Section;
use super::tables::limits::{LIMITS_FILE, LimitsTables};
use super::tables::{ChannelKeys, PROCEDURE_FILE, ProcedureFile};
use super::{channel, derived, recording_options, validate};
use crate::config::contained_files;
use crate::config::external;
use crate::config::program;
use crate::config::read_tables::checked;
use crate::config::table::Table;
use crate::influence::ComparisonTest;
use crate::recording::Role;
use sagnac_ingest::layout::LayoutFile;
use std::path::{Path, PathBuf};

/// Reads a procedure from its text. The second value holds every problem, warnings among them. With its folder, the
/// files that it names must be there.
pub(super) fn procedure(source: &SourceText, folder: Option<&Path>) -> (Option<Procedure>, Problems) {
    checked(source, &PROCEDURE_FILE, |root, reader| {
        let procedure = build(ProcedureFile::read(root), root, folder, reader);
        validate::procedure(&procedure, root, reader);
        let warnings = validate::warnings(&procedure, root, reader.source);
        reader.problems.list.extend(warnings);
        procedure
    })
}

/// The path of a file that a procedure names, as it can be opened: it stands beside the procedure or below, wherever the
/// program is started.
fn named(text: &str, at: &Span, folder: Option<&Path>, reader: &mut Reader<'_>) -> Option<PathBuf> {
    let at = reader.source.inside_quotes(at);
    match folder {
        Some(folder) => contained_files::file(text, folder, &at, reader).map(|f| f.path),
        None => contained_files::stays(text, &at, reader).then(|| {
            let of_name = Path::new(&reader.source.name).parent().unwrap_or(Path::new(""));
            contained_files::joined(of_name, text)
        }),
    }
}

/// Reads a limits file from its text.
pub(super) fn limits_file(source: &SourceText) -> (Option<LimitsFile>, Problems) {
    checked(source, &LIMITS_FILE, |root, reader| {
        let file = LimitsTables::read(root);
        let identity = file.identity;
        let mut set = limits::read_set(file.limits, file.references, file.expected, identity.factor, reader);
        set.derived = derived::read_limits(file.derived_limits, reader);
        let warnings = limits::warnings(&set, reader.source);
        reader.problems.list.extend(warnings);
        LimitsFile {
            id: identity.id,
            title: identity.title,
            revision: identity.revision,
            family: identity.family,
            source: identity.source,
            set,
        }
    })
}

fn build(file: ProcedureFile, root: &Section, folder: Option<&Path>, reader: &mut Reader<'_>) -> Procedure {
    let (identity, recording) = (file.procedure, file.recording);
    let layout_at = recording.section.span_of("layout");
    let layout = recording.layout.as_deref().and_then(|text| named(text, &layout_at, folder, reader));
    let mut explain = file.explain;
    if let Some((spec, section)) = explain.as_mut().zip(root.table("explain"))
        && let Some(text) = spec.model.to_str().filter(|text| !text.is_empty())
        && let Some(model) = named(text, &section.span_of("model"), folder, reader)
    {
        spec.model = model;
    }
    let by_angle = file.channels.iter().any(|c| c.role == Some(Role::TableAngle));
    let channels: Vec<ChannelSpec> =
        file.channels.iter().filter_map(|keys| one_channel(keys, reader)).collect();
    let comparison = [
        file.magnetic_test.map(ComparisonTest::from),
        file.supply_test.map(ComparisonTest::from),
        file.vibration_test.map(|keys| ComparisonTest {
            by_frequency: file.vibration_spectrum.map(|spectrum| spectrum.asked(&channels)),
            ..keys.into()
        }),
        file.influence_test.map(|keys| keys.test(&channels, reader)),
    ];
    let (sample_rate_hz, sample_rate_tolerance) = (recording.sample_rate_hz, recording.sample_rate_tolerance);
    let mut read = recording_options::options(recording, &file.channels, reader);
    read.layout = layout.map(LayoutFile::at);
    let mut limits = limits::read_set(file.limits, file.references, file.expected, None, reader);
    limits.derived = derived::read_limits(file.derived_limits, reader);
    let externals = external::asked(file.externals, reader);
    let beside = program::Beside {
        channels: channels.iter().map(|c| c.channel.id.as_str()).collect(),
        externals: externals.iter().map(|e| e.id.as_str()).collect(),
        folder,
    };
    let programs = program::read(file.programs, &beside, reader);
    Procedure {
        id: identity.id,
        title: identity.title,
        revision: identity.revision,
        standard: identity.standard,
        clause: identity.clause,
        author: identity.author,
        unit_under_test: file.unit_under_test,
        recording: RecordingSpec { read },
        sample_rate_hz,
        sample_rate_tolerance,
        channels,
        interim: file.interim.map(|keys| keys.plan(file.conditions.planned_duration_s)),
        conditions: file.conditions,
        exclusions: file.exclusions.into_iter().map(Into::into).collect(),
        site: file.site,
        instruments: file.instruments,
        bench: file.bench,
        thermometer_pairs: file.thermometer_pairs.into_iter().filter_map(Into::into).collect(),
        rate_table: file.rate_table.map(|keys| keys.setup(by_angle)),
        analysis: file.analysis,
        explain,
        noise_test: file.noise_test.map(Into::into),
        temperature_test: file.temperature_test.map(Into::into),
        warm_up_test: file.warm_up_test.map(Into::into),
        acceleration_test: file.acceleration_test.map(Into::into),
        transfer_test: file.transfer_test.map(Into::into),
        start_up_test: file.start_up_test.map(Into::into),
        repeatability_test: file.repeatability_test.map(Into::into),
        comparison_test: comparison.into_iter().flatten().next(),
        measurands: file.measurands.into_iter().filter_map(MeasurandKeys::spec).collect(),
        derived: derived::read(file.derived, reader),
        externals,
        programs,
        limits,
        clauses: file.clauses.into_iter().map(Into::into).collect(),
        report: file.report,
        waivers: file.waivers,
    }
}

fn one_channel(keys: &ChannelKeys, reader: &mut Reader<'_>) -> Option<ChannelSpec> {
    let (channel, unit_in_file) = channel::read(keys, reader)?;
    let rollover = channel::rollover(keys, channel.role, reader);
    Some(ChannelSpec {
        channel,
        unit_in_file,
        rail_low: keys.rail_low,
        rail_high: keys.rail_high,
        rollover,
        required: keys.required,
        span: keys.section.span.clone(),
        column_span: reader.source.inside_quotes(&keys.section.span_of("column")),
    })
}
