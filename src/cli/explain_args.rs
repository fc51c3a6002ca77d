//! Command-line arguments of `sagnac explain`, for one recording and for several.

use super::inputs::Inputs;
use super::job::Frame;
use super::join::JoinArgs;
use super::options::OutputArgs;
use super::part::PartArgs;
use super::place;
use super::read::ReadArgs;
use crate::effect::{Column, EFFECTS, find};
use crate::i18n::{Note, note};
use crate::mismatch::Options;
use crate::series::{Series, SeriesOptions};
use clap::Args;
use sagnac_core::spelling::nearest;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct ExplainArgs {
    /// Recording: a file of any supported format, or a manifest; several files or a quoted pattern are recordings of one unit
    /// that are explained together, or one recording with --join
    #[arg(required = true)]
    pub(super) recording: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) join: JoinArgs,
    #[command(flatten)]
    pub(super) part: PartArgs,
    /// The claimed simulation (TOML)
    #[arg(long, value_name = "FILE", required_unless_present = "simulation", conflicts_with = "simulation")]
    pub(super) model: Option<PathBuf>,
    /// Simulated recording from which the claim is identified, instead of a model
    #[arg(long, value_name = "FILE")]
    pub(super) simulation: Option<PathBuf>,
    /// Probability of calling a correct claim a mismatch [default: 0.01]
    #[arg(long, value_name = "PROBABILITY")]
    pub(super) alpha: Option<f64>,
    /// Column to treat as not recorded, by its standard name (temp_degC) or, if it has none, its own; may be repeated
    #[arg(long, value_name = "COLUMN")]
    pub(super) hide: Vec<String>,
    /// Maximum number of effects to add to the claim [default: 3]
    #[arg(long, value_name = "COUNT")]
    pub(super) max_effects: Option<usize>,
    /// Effect to exclude from the search, by id (`sagnac effects`); may be repeated
    #[arg(long, value_name = "EFFECT")]
    pub(super) without: Vec<String>,
    /// Rate column by name or position [default: the only column that looks like a gyro output]
    #[arg(long, value_name = "COLUMN")]
    pub(super) rate: Option<String>,
    /// Unit of the rate column [default: from its name]
    #[arg(long, value_name = "UNIT")]
    pub(super) unit: Option<String>,
    /// Sample rate, required without a time column
    #[arg(long, value_name = "HZ")]
    pub(super) sample_rate: Option<f64>,
    /// Output folder [default: named after the recording and UTC time]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    #[command(flatten)]
    pub(super) output: OutputArgs,
    #[command(flatten)]
    pub(super) read: ReadArgs,
}

/// A path as diagnostics and pages show it.
pub(super) fn shown(path: &Path) -> String {
    path.display().to_string()
}

/// The decisions of the user.
pub(super) fn options(args: &ExplainArgs) -> Result<Options, Note> {
    let default = Options::default();
    let alpha = args.alpha.unwrap_or(default.alpha);
    if !(alpha > 0.0 && alpha < 1.0) {
        return Err(note!("explain.error.alpha", given = alpha.to_string()));
    }
    let max_effects = args.max_effects.unwrap_or(default.max_effects);
    if max_effects == 0 {
        return Err("explain.error.max_effects".into());
    }
    let mut hide = vec![];
    for name in &args.hide {
        hide.push(Column::of_name(name));
    }
    let mut without = vec![];
    for name in &args.without {
        let Some(effect) = find(name) else {
            let note = note!("explain.error.effect", given = name.as_str());
            return Err(match nearest(name, EFFECTS.iter().map(|e| e.kind())) {
                Some(near) => {
                    note!("explain.error.effect_near", given = name.as_str(), near)
                }
                None => note,
            });
        };
        without.push(effect.kind());
    }
    Ok(Options { alpha, hide, max_effects, without })
}

/// Reads a recording.
pub(super) fn read(args: &ExplainArgs, paths: &[PathBuf], frame: &mut Frame<'_>) -> Result<Series, String> {
    let options = SeriesOptions {
        read: args.read.options(),
        rate: args.rate.clone(),
        unit: args.unit.clone(),
        any_rate: false,
        channels: vec![],
        sample_rate_hz: args.sample_rate,
    };
    frame.series(paths, &options)
}

/// Reads the part of a recording that is explained.
pub(super) fn read_part(
    args: &ExplainArgs,
    paths: &[PathBuf],
    frame: &mut Frame<'_>,
) -> Result<Series, String> {
    let lang = frame.lang;
    let mut series = args.part.of(read(args, paths, frame)?).map_err(|note| place::error(&note, lang))?;
    series.notes.extend(args.part.remark());
    Ok(series)
}

/// The inputs of an explanation: its recordings, the model and the options.
pub(super) fn inputs(args: &ExplainArgs, recordings: &[PathBuf], frame: &Frame<'_>) -> Inputs {
    let inputs = frame.inputs().recording(recordings, &args.read.options());
    let inputs = inputs.file("model", args.model.as_deref());
    let decided = (
        (&args.rate, &args.unit, args.sample_rate, &args.read),
        (&args.hide, &args.without, args.alpha, args.max_effects),
    );
    // That of the whole is the same as before a part could be chosen.
    if args.part.is_whole() { inputs.options(&decided) } else { inputs.options(&(decided, args.part)) }
}
