//! The command line: one file a verb. The only place that prints and that knows exit codes.

mod analyze;
mod check;
mod compare;
mod effects;
mod explain;
mod help;
mod inputs;
mod inspect;
mod place;
mod progress;
mod read;
mod run;
mod run_phases;
mod schema;
mod selftest;
mod simulate;

use crate::i18n::visible;
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

/// Exit codes, as the README documents them.
pub mod exit {
    /// Every row passed, or there were no limits.
    pub const PASS: u8 = 0;
    /// At least one row failed.
    pub const FAIL: u8 = 1;
    /// The test could not be run, or not as required.
    pub const ERROR: u8 = 2;
    /// Neither pass nor fail.
    pub const INDETERMINATE: u8 = 3;
}

#[derive(Debug, Parser)]
#[command(
    name = "sagnac",
    version,
    about = "Acceptance tests for precision gyroscopes: a procedure and a recording in, a report out",
    after_help = "Exit codes: 0 pass (or no limits), 1 fail, 2 could not run, 3 indeterminate.\n\n\
        Example:\n  sagnac run procedures/static-bias.toml recording.csv --limits procedures/limits/sample-unit.toml --serial SN-0042"
)]
struct Cli {
    /// Language of reports and messages [default: from the locale, else en]
    #[arg(long, global = true, value_name = "LANG", value_parser = ["en", "ru"])]
    lang: Option<String>,
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Run a test procedure on a recording and write the acceptance report
    #[command(
        after_help = "Example:\n  sagnac run procedures/static-bias.toml unit-0042.csv.gz --limits procedures/limits/sample-unit.toml \
        --serial SN-0042 --operator \"A. Ivanova\" --out reports/SN-0042"
    )]
    Run(RunArgs),
    /// Validate procedures and limits without data, and report what they cannot decide
    #[command(after_help = "Example:\n  sagnac check procedures/static-bias.toml procedures/limits/*.toml")]
    Check(CheckArgs),
    /// Show what a recording contains and which tests it supports
    #[command(after_help = "Example:\n  sagnac inspect unit-0042.parquet")]
    Inspect(InspectArgs),
    /// Analyse the noise of a recording without a procedure
    #[command(
        after_help = "Example:\n  sagnac analyze unit-0042.csv --rate gyro_x --unit deg/s --out analysis-0042"
    )]
    Analyze(AnalyzeArgs),
    /// Compare Russian and Allan figures and explain their ratio
    #[command(
        after_help = "Examples:\n  sagnac compare unit-0042.csv unit-0043.csv reports/SN-0044 --out comparison\n  \
        sagnac compare --published"
    )]
    Compare(CompareArgs),
    /// Simulate a recording from a model: noise, mean, effects and columns, reproducible to the bit
    #[command(
        after_help = "Examples:\n  sagnac simulate samples/model-static.toml --out static.csv --duration 10h --seed 7\n  \
        sagnac simulate model.toml --out simulated.parquet --like unit-0042.csv"
    )]
    Simulate(SimulateArgs),
    /// List the effects known to models and explanations, or describe one
    #[command(after_help = "Examples:\n  sagnac effects\n  sagnac effects bias_step")]
    Effects(EffectsArgs),
    /// Find where a recording differs from its simulation, and why
    #[command(
        after_help = "Exit codes: 0 consistent, 1 mismatch explained, 2 could not run, 3 unknown mismatch.\n\n\
        Examples:\n  sagnac explain recording.csv --model model.toml --out explained\n  \
        sagnac explain recording.csv --simulation simulated.csv --hide temp_degC"
    )]
    Explain(ExplainArgs),
    /// Print the JSON Schema of a file format, for completion in editors
    #[command(after_help = "Example:\n  sagnac schema procedure > procedure.schema.json")]
    Schema(SchemaArgs),
    /// Recompute published reference values on this machine and print the differences, for the QA file
    #[command(after_help = "Example:\n  sagnac selftest > selftest-2026-11-21.txt")]
    Selftest,
}

#[derive(Debug, Args)]
struct RunArgs {
    /// Procedure (TOML)
    procedure: PathBuf,
    /// Recording: a file of any supported format, several files in sequence, a quoted pattern, or a manifest
    #[arg(required = true)]
    recording: Vec<PathBuf>,
    /// Limits file; overrides the procedure's limits for the same measurand
    #[arg(long, value_name = "FILE")]
    limits: Option<PathBuf>,
    /// Serial number of the unit under test
    #[arg(long, value_name = "SN")]
    serial: Option<String>,
    /// Name of the operator
    #[arg(long, value_name = "NAME")]
    operator: Option<String>,
    /// Test station where the recording was made
    #[arg(long, value_name = "NAME")]
    station: Option<String>,
    /// Output folder [default: named after procedure, serial number and UTC time]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace an existing result made from different inputs
    #[arg(long)]
    force: bool,
    /// Folder of templates that override built-in ones of the same name
    #[arg(long, value_name = "DIR")]
    templates: Option<PathBuf>,
    #[command(flatten)]
    grid: GridArgs,
}

/// Choice of the averaging times.
#[derive(Debug, Args)]
struct GridArgs {
    /// Averaging times: octave, decade, all, or a list in seconds (1,10,100), each a multiple of the sample interval
    #[arg(long, value_name = "GRID")]
    taus: Option<String>,
    /// Sum every overlapping term at any length (8 bytes of memory per sample)
    #[arg(long)]
    exact: bool,
}

#[derive(Debug, Args)]
struct CheckArgs {
    /// Procedures, limits files, manifests and layouts (TOML)
    #[arg(required = true)]
    files: Vec<PathBuf>,
}

#[derive(Debug, Args)]
struct InspectArgs {
    /// Recording: a file of any supported format, several files in sequence, a quoted pattern, or a manifest
    #[arg(required = true)]
    recording: Vec<PathBuf>,
    /// Sample rate, if the recording has no time column
    #[arg(long, value_name = "HZ")]
    sample_rate: Option<f64>,
    #[command(flatten)]
    read: read::ReadArgs,
}

#[derive(Debug, Args)]
struct AnalyzeArgs {
    /// Recording: a file of any supported format, several files in sequence, a quoted pattern, or a manifest
    #[arg(required = true)]
    recording: Vec<PathBuf>,
    /// Rate column by name or position; may be repeated [default: every column that looks like a gyro output]
    #[arg(long, value_name = "COLUMN")]
    rate: Vec<String>,
    /// Accumulated-angle column by name or position, differenced to a rate; may be repeated
    #[arg(long, value_name = "COLUMN")]
    angle: Vec<String>,
    /// Unit of the rate columns [default: from their names]
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Sample counter by name or position; used to detect lost and repeated samples
    #[arg(long, value_name = "COLUMN")]
    counter: Option<String>,
    /// Time column by name or position, or `none` to use only the sample rate [default: from the names]
    #[arg(long, value_name = "COLUMN")]
    time: Option<String>,
    /// Sample rate, required without a time column
    #[arg(long, value_name = "HZ")]
    sample_rate: Option<f64>,
    /// Time excluded at the start, s
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    warm_up: f64,
    /// Output folder [default: named after the recording and UTC time]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace an existing result made from different inputs
    #[arg(long)]
    force: bool,
    /// Folder of templates that override built-in ones of the same name
    #[arg(long, value_name = "DIR")]
    templates: Option<PathBuf>,
    #[command(flatten)]
    grid: GridArgs,
    #[command(flatten)]
    read: read::ReadArgs,
}

#[derive(Debug, Args)]
struct CompareArgs {
    /// Units: one recording each, in any supported format; or a result.json, or its folder
    #[arg(required_unless_present = "published")]
    recording: Vec<PathBuf>,
    /// Check the published tables of Russian and Allan figures
    #[arg(long)]
    published: bool,
    /// Rate column by name or position; may be repeated [default: every column that looks like a gyro output]
    #[arg(long, value_name = "COLUMN")]
    rate: Vec<String>,
    /// Accumulated-angle column by name or position, differenced to a rate; may be repeated
    #[arg(long, value_name = "COLUMN")]
    angle: Vec<String>,
    /// Unit of the rate columns [default: from their names]
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Sample counter by name or position; used to detect lost and repeated samples
    #[arg(long, value_name = "COLUMN")]
    counter: Option<String>,
    /// Time column by name or position, or `none` to use only the sample rate [default: from the names]
    #[arg(long, value_name = "COLUMN")]
    time: Option<String>,
    /// Sample rate, required without a time column
    #[arg(long, value_name = "HZ")]
    sample_rate: Option<f64>,
    /// Time excluded at the start, s
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    warm_up: f64,
    /// Limits file: each limit applies to the figure it names; a result keeps its own limits
    #[arg(long, value_name = "FILE")]
    limits: Option<PathBuf>,
    /// Output folder [default: named after the first unit and UTC time]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace an existing result made from different inputs
    #[arg(long)]
    force: bool,
    /// Folder of templates that override built-in ones of the same name
    #[arg(long, value_name = "DIR")]
    templates: Option<PathBuf>,
    #[command(flatten)]
    read: read::ReadArgs,
}

#[derive(Debug, Args)]
struct SimulateArgs {
    /// Model (TOML): the expected content of the recording
    #[arg(value_name = "FILE")]
    model: PathBuf,
    /// File to write, .csv or .parquet
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Replace an existing file with different content
    #[arg(long)]
    force: bool,
    /// Seed, a whole number; equal seeds give equal recordings [default: as in the model, else 1]
    #[arg(long, value_name = "SEED")]
    seed: Option<u64>,
    /// Length with its unit, such as 10h, 600s or "2 d" [default: as in the model]
    #[arg(long, value_name = "LENGTH")]
    duration: Option<String>,
    /// Recording that provides rows and columns: timestamps, gaps, temperatures, table rates
    #[arg(long, value_name = "RECORDING")]
    like: Option<PathBuf>,
}

#[derive(Debug, Args)]
struct EffectsArgs {
    /// Effect to describe [default: list all]
    #[arg(value_name = "NAME")]
    effect: Option<String>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct ExplainArgs {
    /// Recording: a file of any supported format, several files in sequence, a quoted pattern, or a manifest
    #[arg(required = true)]
    recording: Vec<PathBuf>,
    /// The claimed simulation (TOML)
    #[arg(long, value_name = "FILE", required_unless_present = "simulation", conflicts_with = "simulation")]
    model: Option<PathBuf>,
    /// Simulated recording from which the claim is identified, instead of a model
    #[arg(long, value_name = "FILE")]
    simulation: Option<PathBuf>,
    /// Probability of calling a correct claim a mismatch [default: 0.01]
    #[arg(long, value_name = "PROBABILITY")]
    alpha: Option<f64>,
    /// Column to treat as not recorded, by its standard name (temp_degC); may be repeated
    #[arg(long, value_name = "COLUMN")]
    hide: Vec<String>,
    /// Maximum number of effects to add to the claim [default: 3]
    #[arg(long, value_name = "COUNT")]
    max_effects: Option<usize>,
    /// Effect to exclude from the search, by id (`sagnac effects`); may be repeated
    #[arg(long, value_name = "EFFECT")]
    without: Vec<String>,
    /// Rate column by name or position [default: the only column that looks like a gyro output]
    #[arg(long, value_name = "COLUMN")]
    rate: Option<String>,
    /// Unit of the rate column [default: from its name]
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Sample rate, required without a time column
    #[arg(long, value_name = "HZ")]
    sample_rate: Option<f64>,
    /// Output folder [default: named after the recording and UTC time]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace an existing result made from different inputs
    #[arg(long)]
    force: bool,
    /// Folder of templates that override built-in ones of the same name
    #[arg(long, value_name = "DIR")]
    templates: Option<PathBuf>,
    #[command(flatten)]
    read: read::ReadArgs,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum SchemaKind {
    /// A test procedure
    Procedure,
    /// A limits file
    Limits,
    /// A layout of raw binary records
    Layout,
    /// result.json
    Result,
    /// A manifest: several files as one recording
    Manifest,
    /// A model: the expected content of a recording
    Model,
}

#[derive(Debug, Args)]
struct SchemaArgs {
    /// File format
    kind: SchemaKind,
}

/// Parses the command line, runs the verb, gives the exit code.
pub fn main() -> ExitCode {
    let arguments: Vec<OsString> = std::env::args_os().collect();
    let lang = help::language(&arguments);
    let cli = match help::command(Cli::command(), lang)
        .try_get_matches_from(&arguments)
        .and_then(|matches| Cli::from_arg_matches(&matches))
    {
        Ok(cli) => cli,
        Err(error) => {
            // What was typed stands in the complaint: on one line, without what steers.
            let typed = arguments.iter().map(|a| visible(&a.to_string_lossy()).into_owned());
            let again = help::command(Cli::command(), lang).try_get_matches_from(typed).err();
            return help::refuse(&again.unwrap_or(error), lang);
        }
    };
    let code = match cli.verb {
        Verb::Run(args) => run::main(&args, lang),
        Verb::Check(args) => check::main(&args, lang),
        Verb::Inspect(args) => inspect::main(&args, lang),
        Verb::Analyze(args) => analyze::main(&args, lang),
        Verb::Compare(args) => compare::main(&args, lang),
        Verb::Simulate(args) => simulate::main(&args, lang),
        Verb::Effects(args) => effects::main(&args, lang),
        Verb::Explain(args) => explain::main(&args, lang),
        Verb::Schema(args) => schema::main(&args),
        Verb::Selftest => selftest::main(lang),
    };
    ExitCode::from(code)
}
