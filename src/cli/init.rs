//! `sagnac init`: a procedure, limits and a job for continuous integration from what a recording holds.

use super::columns::{ColumnArgs, WarmUpArgs};
use super::evaluate::with_progress;
use super::join::JoinArgs;
use super::progress::{Display, Progress};
use super::read::ReadArgs;
use super::{exit, place};
use crate::acceptance::analysis::Prepared;
use crate::acceptance::column_choice::{channels, remarks};
use crate::acceptance::verdict::contradicted;
use crate::config::procedure::EffectiveLimits;
use crate::criticism::temperature;
use crate::i18n::{Lang, Localize, Note, lookup, note};
use crate::ingest::lot::stated_serial;
use crate::ingest::{Source, open_recording};
use crate::measurand::{
    ANGLE_RANDOM_WALK, ANGLE_RANDOM_WALK_AT_TEMPERATURE, BIAS_INSTABILITY, BIAS_LOOP_WIDTH,
    BIAS_OVER_TEMPERATURE_PEAK_TO_PEAK, BIAS_OVER_TEMPERATURE_RMS, BIAS_RESIDUAL_RMS,
    BIAS_TEMPERATURE_SENSITIVITY, QUANTIZATION, RATE_RAMP, RATE_RANDOM_WALK, RUSSIAN_ARW_10S,
    RUSSIAN_DRIFT_100S,
};
use crate::moment;
use crate::record::RunRecord;
use crate::recording::{Channel, ColumnRef, Role};
use crate::report::number::duration;
use clap::Args;
use minijinja::{Environment, UndefinedBehavior, context};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct InitArgs {
    /// Recording: a file of any supported format
    recording: PathBuf,
    #[command(flatten)]
    columns: ColumnArgs,
    #[command(flatten)]
    start: WarmUpArgs,
    /// Folder for the files; existing files are not replaced
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    #[command(flatten)]
    read: ReadArgs,
}

/// Ids of the measurands that a limit is proposed for.
const PROPOSED_LIMITS: &[&str] = &[
    ANGLE_RANDOM_WALK.id,
    BIAS_INSTABILITY.id,
    RATE_RANDOM_WALK.id,
    RATE_RAMP.id,
    RUSSIAN_DRIFT_100S.id,
    RUSSIAN_ARW_10S.id,
];

/// Ids of the measurands in the draft of a test over temperature.
const TEMPERATURE_MEASURANDS: &[&str] = &[
    BIAS_OVER_TEMPERATURE_PEAK_TO_PEAK.id,
    BIAS_OVER_TEMPERATURE_RMS.id,
    BIAS_TEMPERATURE_SENSITIVITY.id,
    BIAS_LOOP_WIDTH.id,
    BIAS_RESIDUAL_RMS.id,
    ANGLE_RANDOM_WALK_AT_TEMPERATURE.id,
];

/// Templates of procedure, limits and job for continuous integration.
const INIT_TEMPLATES: [&str; 3] = [
    include_str!("../../templates/init/procedure.toml"),
    include_str!("../../templates/init/limits.toml"),
    include_str!("../../templates/init/ci.yml"),
];

pub fn main(args: &InitArgs, lang: Lang) -> Result<u8, String> {
    let say = |note: Note| place::error(&note, lang);
    let names = ["procedure.toml", "limits.toml", "ci.yml"];
    let paths = names.map(|name| args.out.join(name));
    let layout = args.read.layout().map(|path| Layout::of(path, &args.out));
    let copied = layout.as_ref().and_then(|l| l.copy.as_ref());
    if let Some(path) = paths.iter().chain(copied).find(|p| p.exists()) {
        return Err(say(note!("init.exists", path = place::shown(path))));
    }
    let recording = std::slice::from_ref(&args.recording);
    JoinArgs::default().check(recording, "join.help.init", lang)?;
    let opened = open_recording(recording, &args.read.options()).map_err(|e| e.say(lang))?;
    let source = opened.source;
    let choice = args.columns.choice(args.start.warm_up.seconds);
    let channels = channels(&choice, &args.recording, &source).map_err(say)?;
    for note in remarks(&choice, &channels, &source) {
        place::eprint_diagnostic(&place::warning(&note, lang));
    }
    let (record, sample_rate_hz) = analysed(args, &channels, &source, lang)?;
    let files = written(args, layout.as_ref(), &channels, &source, (&record, sample_rate_hz), lang)
        .map_err(|e| say(note!("init.template", reason = e.to_string())))?;
    let failed = |path: &Path, e: &std::io::Error| {
        let note = note!("procedures.not_saved", path = place::shown(path));
        say(note.with("reason", e.to_string()))
    };
    std::fs::create_dir_all(&args.out).map_err(|e| failed(&args.out, &e))?;
    for (path, text) in paths.iter().zip(&files) {
        std::fs::write(path, text).map_err(|e| failed(path, &e))?;
    }
    if let (Some(from), Some(to)) = (args.read.layout(), copied) {
        std::fs::copy(from, to).map_err(|e| failed(to, &e))?;
    }
    let shown = paths.each_ref().map(|p| place::shown(p));
    for note in contradicted(&record.measurands) {
        place::print(&format!("{}\n", note.say(lang)));
    }
    let note = note!(
        "init.written",
        procedure = shown[0].as_str(),
        limits = shown[1].as_str(),
        ci = shown[2].as_str(),
        recording = place::for_shell(&args.recording.display().to_string()),
        serial = place::for_shell(&serial_of(&source))
    );
    place::print(&format!("{}\n", note.say(lang)));
    Ok(exit::PASS)
}

/// The analysis of the recording without a procedure; the sample rate where there is no time column.
fn analysed(
    args: &InitArgs,
    channels: &[Channel],
    source: &Source,
    lang: Lang,
) -> Result<(RunRecord, Option<f64>), String> {
    let say = |note: Note| place::error(&note, lang);
    let prepared = Prepared::new(
        channels.to_vec(),
        &args.columns.choice(args.start.warm_up.seconds),
        &args.recording,
        source,
    );
    let prepared = prepared.map_err(say)?;
    let limits = EffectiveLimits::default();
    let request = prepared.request(source, &limits, moment::now());
    let mut progress = Progress::new(Display::unless(false), lang);
    let outcome =
        with_progress(&request, &note!("cli.reading").say(lang), &mut progress).map_err(|e| say(e.note()))?;
    Ok((outcome.record, prepared.sample_rate_without_stamps_hz()))
}

/// The layout of a raw binary file as the procedure names it: a procedure refers to files in its folder only.
struct Layout {
    /// Path relative to the folder of the procedure.
    name: String,
    /// Path of its copy, if it does not lie in that folder.
    copy: Option<PathBuf>,
}

impl Layout {
    fn of(path: &Path, folder: &Path) -> Layout {
        let inside = path.canonicalize().ok().zip(folder.canonicalize().ok());
        let inside = inside.and_then(|(path, folder)| Some(path.strip_prefix(folder).ok()?.to_owned()));
        match inside {
            Some(name) => Layout { name: name.display().to_string(), copy: None },
            None => Layout { name: "layout.toml".to_owned(), copy: Some(folder.join("layout.toml")) },
        }
    }
}

/// The three files, their comments in a language.
fn written(
    args: &InitArgs,
    layout: Option<&Layout>,
    channels: &[Channel],
    source: &Source,
    (record, sample_rate_hz): (&RunRecord, Option<f64>),
    lang: Lang,
) -> Result<[String; 3], minijinja::Error> {
    let mut environment = Environment::empty();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    let name = one_line(&args.recording.display().to_string());
    let stem = args.recording.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let usable_s = record.window.usable_s;
    let sweep = swept(record);
    let at_rest = || [QUANTIZATION.id].into_iter().chain(PROPOSED_LIMITS.iter().copied()).collect();
    let ids: Vec<&str> = if sweep.is_some() { TEMPERATURE_MEASURANDS.to_vec() } else { at_rest() };
    let measurands: Vec<_> = ids.iter().map(|id| context! { id => *id, name => title(id, lang) }).collect();
    let channel_ids = ids_of(channels);
    let is_temperature = |(c, _): &(&Channel, &String)| c.role == Role::Temperature;
    let temperature = channels.iter().zip(&channel_ids).find(is_temperature).map(|(_, id)| id);
    let mut read: Vec<(&str, String)> =
        args.read.keys().into_iter().map(|(key, value)| (key, value.to_string())).collect();
    read.extend(layout.map(|l| ("layout", toml_text(&l.name))));
    let values = context! {
        read => read.into_iter().map(|(key, value)| context! { key, value }).collect::<Vec<_>>(),
        recording => name,
        recording_shell => place::for_shell(&args.recording.display().to_string()),
        procedure => "procedure.toml",
        id => toml_text(&id_of(&stem)),
        channels => channels.iter().zip(&channel_ids).map(|(c, id)| context! {
            id => toml_text(id),
            column => match &c.column {
                ColumnRef::Name(name) => toml_text(name),
                ColumnRef::Position(position) => position.to_string(),
            },
            role => c.role.id(),
            unit => toml_text(c.unit.text()),
            scale => (c.scale != 1.0).then(|| toml_text(&c.scale.to_string())),
        }).collect::<Vec<_>>(),
        unused => unused(channels, source, lang),
        example => if sweep.is_some() { "temperature-ramp" } else { "static-bias" },
        serial => one_line(&serial_of(source)),
        serial_text => toml_text(&serial_of(source)),
        sample_rate => sample_rate_hz.map(|hz| toml_text(&format!("{hz} Hz"))),
        duration => duration(usable_s, lang),
        minimum_duration => toml_text(&minimum_duration(usable_s)),
        warm_up => toml_text(&format!("{} s", args.start.warm_up.seconds)),
        temperature => temperature.map(|id| toml_text(id)),
        sweep => sweep.zip(temperature).map(|((low, high), channel)| context! {
            channel => toml_text(channel),
            low => toml_text(&format!("{} degC", low.ceil())),
            high => toml_text(&format!("{} degC", high.floor())),
        }),
        measurands => measurands,
        limits => limits(record, lang),
    };
    // A template loses the end of its last line.
    let render = |template: &str| {
        let text = environment.render_str(&commented(template, lang), &values)?;
        Ok::<_, minijinja::Error>(format!("{}\n", text.trim_end()))
    };
    let [procedure, limits, ci] = INIT_TEMPLATES;
    Ok([render(procedure)?, render(limits)?, render(ci)?])
}

/// A template with its comments in a language. Another than English translates them line by line in its table `init_comment`, whose
/// keys are the English lines.
fn commented(template: &str, lang: Lang) -> String {
    let translated = |line: &str| {
        let comment = line.strip_prefix("# ")?;
        Some(format!("# {}", lookup(lang, &format!("init_comment.{comment}"))?))
    };
    template.lines().map(|l| translated(l).unwrap_or_else(|| l.to_owned())).collect::<Vec<_>>().join("\n")
}

/// The range of temperature that the bias followed, degC, where it did.
fn swept(record: &RunRecord) -> Option<(f64, f64)> {
    let mut objections = record.measurands.iter().flat_map(|m| &m.objections);
    let found = &objections.find(|o| o.check == temperature::CHECK_ID)?.found;
    let end = |name: &str| found.args.get(name)?.number();
    Some((end("low")?, end("high")?))
}

/// A limit for each quantity that every channel bounds and no check contradicts: by the largest of them.
fn limits(record: &RunRecord, lang: Lang) -> Vec<minijinja::Value> {
    let rows = |id: &str| record.measurands.iter().filter(|m| m.id == id).collect::<Vec<_>>();
    let proposal = |id: &&str| {
        let rows = rows(id);
        if rows.iter().any(|m| !m.objections.is_empty()) {
            return None;
        }
        let upper = |m: &&crate::record::MeasurandRecord| {
            m.interval
                .map(|i| i.high)
                .or(m.upper_limit.map(|u| u.value))
                .filter(|v| *v > 0.0 && v.is_finite())
        };
        let largest = rows.iter().map(upper).collect::<Option<Vec<f64>>>()?.into_iter().fold(0.0, f64::max);
        let unit = &rows.first()?.unit;
        let measured = format!("{} {unit}", rounded_up(largest));
        let max = toml_text(&format!("{} {unit}", rounded_up(1.5 * largest)));
        (largest > 0.0).then(|| context! { id => *id, name => title(id, lang), measured, max })
    };
    PROPOSED_LIMITS.iter().filter_map(proposal).collect()
}

/// Two significant digits, upwards.
fn rounded_up(value: f64) -> f64 {
    let scale = 10f64.powf(value.log10().floor() - 1.0);
    let digits = (value / scale - 1e-9).ceil();
    format!("{:.1e}", digits * scale).parse().unwrap_or(value)
}

/// Nine tenths of what was recorded, in hours where that is a round number.
fn minimum_duration(usable_s: f64) -> String {
    let hours = (0.9 * usable_s / 3600.0).floor();
    if hours >= 1.0 { format!("{hours} h") } else { format!("{} s", (0.9 * usable_s).floor().max(1.0)) }
}

fn title(id: &str, lang: Lang) -> String {
    lookup(lang, &format!("measurand.{id}")).unwrap_or(id).to_owned()
}

/// Names of the columns that no channel reads, on one line.
fn unused(channels: &[Channel], source: &Source, lang: Lang) -> String {
    let used: Vec<usize> = channels.iter().filter_map(|c| source.resolve(&c.column).ok()).collect();
    let left = source.columns().iter().enumerate().filter(|(i, _)| !used.contains(i));
    let names: Vec<String> = left.map(|(_, c)| one_line(&c.name)).collect();
    if names.is_empty() { note!("init.no_column").say(lang) } else { names.join(", ") }
}

/// The serial number that the recording states, or else an example.
fn serial_of(source: &Source) -> String {
    stated_serial(source).unwrap_or_else(|| "SN-0001".to_owned())
}

/// A text for a comment: nothing in it ends the line.
fn one_line(text: &str) -> String {
    crate::i18n::visible(text).into_owned()
}

fn toml_text(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// An id for each channel, no two alike.
fn ids_of(channels: &[Channel]) -> Vec<String> {
    let mut ids: Vec<String> = vec![];
    for channel in channels {
        let id = id_of_column(&channel.id, channel.role);
        let numbered = (2..).map(|n| format!("{}_{n}", id.chars().take(60).collect::<String>()));
        let free = std::iter::once(id.clone()).chain(numbered).find(|id| !ids.contains(id));
        ids.push(free.unwrap_or(id));
    }
    ids
}

/// The id of a channel: its name as an id, or its role where the name is of another alphabet and little of it would remain.
fn id_of_column(name: &str, role: Role) -> String {
    let letters = || name.chars().filter(|c| c.is_alphabetic());
    let kept = letters().filter(char::is_ascii).count();
    if 2 * kept < letters().count() { role.id().to_owned() } else { id_of(name) }
}

/// A text as an id: letters a to z, digits, `_`, `-` and `.`, 64 at most, the first a letter or digit.
fn id_of(text: &str) -> String {
    let safe = |c: char| if c.is_ascii_alphanumeric() || "_-.".contains(c) { c } else { '_' };
    let id: String = text.chars().map(safe).collect();
    let parts: Vec<&str> = id.split('_').filter(|part| !part.is_empty()).collect();
    let id: String = parts.join("_").trim_start_matches(['-', '.', '_']).chars().take(64).collect();
    if id.is_empty() { "unit".to_owned() } else { id }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn proposals_are_rounded_upwards() {
        assert_eq!(rounded_up(0.003041), 0.0031);
        assert_eq!(rounded_up(0.0031), 0.0031);
        assert_eq!(rounded_up(99.5), 100.0);
    }

    #[test]
    fn any_text_gives_an_id() {
        assert_eq!(id_of("odd name"), "odd_name");
        assert_eq!(id_of("_Ωz [deg/h]"), "z_deg_h");
        assert_eq!(id_of("Ω"), "unit");
        assert_eq!(id_of("Темп. корпуса, °C"), "C");
        assert_eq!(id_of("-_.x"), "x");
        assert_eq!(id_of(&"a".repeat(100)).len(), 64);
    }

    #[test]
    fn a_column_of_another_alphabet_is_named_by_its_role() {
        assert_eq!(id_of_column("Темп. корпуса, °C", Role::Temperature), "temperature");
        assert_eq!(id_of_column("Выход ВОГ, град/ч", Role::Rate), "rate");
        assert_eq!(id_of_column("Ω_z [deg/h]", Role::Rate), "z_deg_h");
    }

    #[test]
    fn durations_are_below_what_was_recorded() {
        assert_eq!(minimum_duration(36_000.0), "9 h");
        assert_eq!(minimum_duration(1_000.0), "900 s");
        assert_eq!(minimum_duration(0.0), "1 s");
    }

    #[test]
    fn every_comment_of_the_templates_has_a_translation_and_none_is_left_over() {
        let sources = INIT_TEMPLATES.iter().flat_map(|template| template.lines());
        let comments: BTreeSet<&str> = sources.filter_map(|line| line.strip_prefix("# ")).collect();
        // A key that is commented out, a table or a name is the same in every language.
        let same = |comment: &str| {
            comment.starts_with('[') || comment.contains(" = ") || comment.ends_with("m.name }}")
        };
        for lang in Lang::ALL.iter().filter(|lang| **lang != Lang::En) {
            let keys = crate::i18n::table(*lang).keys().filter_map(|key| key.strip_prefix("init_comment."));
            let keys: BTreeSet<&str> = keys.collect();
            let missing: Vec<&str> =
                comments.iter().copied().filter(|c| !same(c) && !keys.contains(c)).collect();
            assert!(missing.is_empty(), "{lang:?} has no translation of {missing:#?}");
            let left_over: Vec<&&str> = keys.difference(&comments).collect();
            assert!(left_over.is_empty(), "{lang:?} translates what no template says: {left_over:#?}");
        }
        assert_eq!(commented(INIT_TEMPLATES[1], Lang::En), INIT_TEMPLATES[1].trim_end_matches('\n'));
    }
}
