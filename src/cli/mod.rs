//! The command line: one file a verb. The only place that prints and that knows exit codes.

mod analyze;
mod bench_checks;
mod check;
mod columns;
mod compare;
mod compare_laboratories;
mod datasheet;
mod demo;
mod each;
mod effects;
pub mod ending;
mod evaluate;
pub mod exit;
mod explain;
mod explain_args;
mod explain_jointly;
mod export;
mod figure;
mod follow;
mod follow_args;
mod guide;
mod help;
mod history;
mod init;
mod inputs;
mod inspect;
mod job;
mod join;
mod keep;
mod length;
mod model;
mod next_step;
mod options;
mod pack;
mod part;
mod phased_test;
mod place;
mod plan;
mod printer;
mod procedures;
mod progress;
mod prove;
mod read;
mod record;
mod rehearse;
mod report;
mod run;
mod run_args;
mod run_phases;
mod schema;
#[cfg(any(test, feature = "schema"))]
mod schema_files;
mod selftest;
mod serve;
mod sign;
#[cfg(unix)]
mod signals;
mod simulate;
mod single_test;
mod source;
mod stdout;
mod store;
mod test_setup;
mod verify;
mod watch;
mod writer;

#[cfg(feature = "schema")]
pub use schema_files::generate as generate_schemas;

use crate::config::procedure::phases::is_phased;
use crate::i18n::{Lang, visible};
use clap::builder::PossibleValuesParser;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::ffi::OsString;

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
    #[arg(long, global = true, value_name = "LANG", value_parser = PossibleValuesParser::new(Lang::ALL.iter().map(|l| l.code())))]
    lang: Option<String>,
    #[command(subcommand)]
    verb: Verb,
}

/// The verbs in the order of the help, below the headings of `help.rs`.
#[derive(Debug, Subcommand)]
enum Verb {
    /// Show what a recording contains and which tests it supports
    #[command(after_help = "Example:\n  sagnac inspect unit-0042.parquet")]
    Inspect(inspect::InspectArgs),
    /// Analyse the noise of a recording without a procedure
    #[command(
        after_help = "Example:\n  sagnac analyze unit-0042.csv --rate gyro_x --unit deg/s --out analysis-0042"
    )]
    Analyze(analyze::AnalyzeArgs),
    /// Write a procedure, limits and a CI example for a recording
    #[command(after_help = "Example:\n  sagnac init unit-0042.csv --out acceptance")]
    Init(init::InitArgs),
    /// Validate procedures and limits without data, and report what they cannot decide
    #[command(after_help = "Example:\n  sagnac check 'procedures/**/*.toml'")]
    Check(check::CheckArgs),
    /// Rehearse a test on simulated units: how likely it passes, fails or stays open, and how long it must be
    #[command(
        after_help = "Exit codes: 0 a length keeps the risk, 2 could not run, 3 no rehearsed length does.\n\n\
        Examples:\n  sagnac rehearse static-bias --limits sample-unit --out rehearsal\n  \
        sagnac rehearse procedure.toml --limits limits.toml --model family.toml --length 10h --length 40h --units 50"
    )]
    Rehearse(rehearse::RehearseArgs),
    /// Run a test procedure on a recording and write the acceptance report
    #[command(
        after_help = "Examples:\n  sagnac run procedures/static-bias.toml unit-0042.csv.gz --limits procedures/limits/sample-unit.toml \
        --serial SN-0042 --operator \"A. Ivanova\" --out reports/SN-0042\n  \
        sagnac run static-bias 'lot-7/*.csv' --each --limits sample-unit --out reports/lot-7"
    )]
    Run(run_args::RunArgs),
    /// Test every recording that appears in a folder, once, when it is complete
    #[command(
        after_help = "Exit codes: 0 ended when asked; with --once as run --each: 0 pass (or nothing new), 1 fail, 2 could not run or tell, 3 indeterminate.\n\n\
        Examples:\n  sagnac watch /data/bench-2 --rules watch.toml --out /srv/reports\n  \
        sagnac watch /data/bench-2 --procedure static-bias --limits sample-unit --once"
    )]
    Watch(watch::WatchArgs),
    /// Record a bench: what its devices say, while a schedule moves table and chamber within limits
    #[command(
        after_help = "Exit codes: 0 complete, 1 a fault ended it or a device is not safe, 2 could not begin, 3 ended early when asked, or a clock made a step.\n\n\
        Examples:\n  sagnac record bench.toml --schedule next/schedule.toml --serial SN-0042 --out recorded\n  \
        sagnac record bench.toml --duration 10h"
    )]
    Record(record::RecordArgs),
    /// Serve the pages of a bench: scan a serial number, see the verdict; with an interface for programs
    #[command(after_help = "Exit codes: 0 ended when asked, 2 could not start.\n\n\
        Examples:\n  sagnac serve --data /srv/bench --recordings /data/bench-2\n  \
        sagnac serve --rules serve.toml --store /srv/sagnac --station \"bench 2\"")]
    Serve(serve::ServeArgs),
    /// Render the report of a result again, without its recording: in another language, with other templates
    #[command(after_help = "Exit codes: 0 written, 2 could not.\n\n\
        Examples:\n  sagnac report reports/SN-0042 --lang ru --out reports/SN-0042-ru\n  \
        sagnac report result.json --format html --templates templates")]
    Report(report::ReportArgs),
    /// Write the parameters of a unit for an estimator, an autopilot or a simulator
    #[command(after_help = "Examples:\n  sagnac export reports/SN-0042 --for kalibr --out imu0.yaml\n  \
        sagnac export reports/SN-0042 --for gazebo --channels gyro_x,gyro_y,gyro_z")]
    Export(export::ExportArgs),
    /// Pack everything that goes with a unit into one archive: report, certificate, model, parameters, hashes, signatures
    #[command(after_help = "Example:\n  sagnac pack reports/SN-0042 --out SN-0042.zip")]
    Pack(pack::PackArgs),
    /// Draw a figure of results for a paper: of several records in one, with few layers, at the width of a column
    #[command(
        after_help = "Examples:\n  sagnac figure reports/SN-0042 sigma-tau --out allan.pdf --width 85mm\n  \
        sagnac figure reports/SN-0042 reports/SN-0043 sigma-tau --unit deg/sqrt(h) --out two.svg\n  \
        sagnac figure reports/SN-0042 sigma-tau --layers data,terms,labels --out terms.svg"
    )]
    Figure(figure::FigureArgs),
    /// Find where a recording differs from its simulation, and why
    #[command(
        after_help = "Exit codes: 0 consistent, 1 mismatch explained, 2 could not run, 3 unknown mismatch.\n\n\
        Examples:\n  sagnac explain recording.csv --model model.toml --out explained\n  \
        sagnac explain monday.csv tuesday.csv wednesday.csv --model model.toml\n  \
        sagnac explain recording.csv --simulation simulated.csv --hide temp_degC"
    )]
    Explain(explain_args::ExplainArgs),
    /// Plan the next test: the shortest schedule that distinguishes the explanations of a recording
    #[command(
        after_help = "Exit codes: 0 the schedule decides, or nothing is to be decided, 2 could not run, 3 not decided within limits and budget.\n\n\
        Examples:\n  sagnac plan explained --model model.toml --budget 8h --out next\n  \
        sagnac simulate model.toml --schedule next/schedule.toml --out simulated.csv"
    )]
    Plan(plan::PlanArgs),
    /// Conceal something of a recording, let the engine explain the rest, and judge its answer by rules fixed before
    #[command(
        hide = true,
        after_help = "Exit codes: 0 every rule holds, 1 a rule does not hold, 2 could not run.\n\n\
        Example:\n  sagnac prove proofs/closed-loop-ramp.toml --data /data --out proved"
    )]
    Prove(prove::ProveArgs),
    /// Simulate a recording from a model: noise, mean, effects and columns, reproducible to the bit
    #[command(
        after_help = "Examples:\n  sagnac simulate samples/model-static.toml --out static.csv --duration 10h --seed 7\n  \
        sagnac simulate model.toml --out simulated.parquet --like unit-0042.csv\n  \
        sagnac simulate model.toml --out next.csv --schedule next/schedule.toml"
    )]
    Simulate(simulate::SimulateArgs),
    /// Write the model of a recording, or of its result: noise, mean and effects with their uncertainties
    #[command(after_help = "Examples:\n  sagnac model unit-0042.csv --out model.toml\n  \
        sagnac model reports/SN-0042 --out model.toml\n  \
        sagnac model unit-0042.csv --from 0s --to 5h --out first-half.toml")]
    Model(model::ModelArgs),
    /// List the effects known to models and explanations, or describe one
    #[command(after_help = "Examples:\n  sagnac effects\n  sagnac effects bias_step")]
    Effects(effects::EffectsArgs),
    /// Print a page of the documents, or search them
    #[command(
        after_help = "Examples:\n  sagnac guide\n  sagnac guide temperature lag\n  sagnac guide rate-table"
    )]
    Guide(guide::GuideArgs),
    /// Write the data sheet of a lot from the results of its units, with limits that it can keep
    #[command(after_help = "Examples:\n  sagnac datasheet reports/*/result.json --out sheet\n  \
        sagnac datasheet 'samples/lot/*/result.json' --audience customer --out sheet\n  \
        sagnac datasheet --store /srv/sagnac --device-model OIUS-501 --lot 2026-14")]
    Datasheet(datasheet::DatasheetArgs),
    /// Compare Russian and Allan figures and explain their ratio, or two results of one unit
    #[command(
        after_help = "Examples:\n  sagnac compare unit-0042.csv unit-0043.csv reports/SN-0044 --out comparison\n  \
        sagnac compare --published\n  sagnac compare maker/SN-0042 customer/SN-0042"
    )]
    Compare(compare::CompareArgs),
    /// Keep results: immutable, addressed by content, with an index of all attempts at a test
    #[command(after_help = "Exit codes: 0 done, 1 something is wrong in the store, 2 could not.\n\n\
        Examples:\n  sagnac store init /srv/sagnac\n  \
        sagnac store import /srv/sagnac reports --recordings /data\n  \
        sagnac store verify /srv/sagnac")]
    Store(store::StoreVerbArgs),
    /// Show what the results of a store tell over time: verdicts, yields, reasons, control charts, drift
    #[command(after_help = "Examples:\n  sagnac history SN-0042 --store /srv/sagnac\n  \
        sagnac history --device-model OIUS-501 --since 2026-01-01 --format html --out history.html")]
    History(history::HistoryArgs),
    /// Sign a folder of results, and let rows pass where there is a reason
    #[command(
        after_help = "Examples:\n  sagnac sign reports/SN-0042 --key ~/.ssh/id_ed25519 --role tested --name \"A. Ivanova\"\n  \
        sagnac sign reports/SN-0042 --key lead.pub --role approved --waive bias_instability --reason \"deviation permit 17\""
    )]
    Sign(sign::SignArgs),
    /// Sign a folder of results that another has signed: `sign --role approved`
    #[command(hide = true, after_help = "Example:\n  sagnac approve reports/SN-0042 --key ~/.ssh/id_ed25519")]
    Approve(sign::SignArgs),
    /// Check that a result folder is unmodified, and who signed it
    #[command(
        after_help = "Exit codes: 0 nothing differs, 1 something differs, 2 could not, 3 a check that was asked for could not be made.\n\n\
        Examples:\n  sagnac verify reports/SN-0042 --signers allowed_signers\n  \
        sagnac verify reports/SN-0042 --recording unit-0042.csv.gz"
    )]
    Verify(verify::VerifyArgs),
    /// Run a static test on an embedded sample recording
    #[command(after_help = "Example:\n  sagnac demo --out sagnac-demo")]
    Demo(demo::DemoArgs),
    /// List, print or save the shipped procedures and limits
    #[command(
        after_help = "Examples:\n  sagnac procedures\n  sagnac procedures show static-bias > mine.toml"
    )]
    Procedures(procedures::ProceduresArgs),
    /// Print the completion script of a shell
    #[command(
        after_help = "Example:\n  sagnac completions bash > ~/.local/share/bash-completion/completions/sagnac"
    )]
    Completions {
        /// Shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page
    #[command(hide = true, after_help = "Example:\n  sagnac man > sagnac.1")]
    Man,
    /// Print the JSON Schema of a file format, for completion in editors
    #[command(hide = true, after_help = "Example:\n  sagnac schema procedure > procedure.schema.json")]
    Schema(schema::SchemaArgs),
    /// Recompute published reference values on this machine and print the differences, for the QA file
    #[command(after_help = "Example:\n  sagnac selftest > selftest-2026-11-21.txt")]
    Selftest,
}

/// Prepares a process that runs the program: a signal that ends it leaves nothing half made.
///
/// A decoder that panics on a damaged file is caught, and the diagnostic of the file says so: the message of the panic
/// itself would only confuse, and is not printed.
pub fn begin() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !crate::ingest::decoder_is_running() {
            usual(panic);
        }
    }));
    #[cfg(unix)]
    signals::tidy_up_on();
}

/// Parses the command line, runs the verb, gives the exit code.
pub fn run(arguments: &[OsString]) -> u8 {
    let lang = help::language(arguments);
    let cli = match help::command(Cli::command(), lang)
        .try_get_matches_from(arguments)
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
    let done = match cli.verb {
        Verb::Run(args) if args.each.each => each::main(&args, lang),
        Verb::Run(args) if is_phased(&args.procedure) => run_phases::main(&args, lang),
        Verb::Run(args) => run::main(&args, lang),
        Verb::Watch(args) => watch::main(&args, lang),
        Verb::Record(args) => record::main(&args, lang),
        Verb::Serve(args) => serve::main(&args, lang),
        Verb::Check(args) => check::main(&args, lang),
        Verb::Rehearse(args) => rehearse::main(&args, lang),
        Verb::Inspect(args) => inspect::main(&args, lang),
        Verb::Init(args) => init::main(&args, lang),
        Verb::Analyze(args) => analyze::main(&args, lang),
        Verb::Report(args) => report::main(&args, lang),
        Verb::Export(args) => export::main(&args, lang),
        Verb::Pack(args) => pack::main(&args, lang),
        Verb::Figure(args) => figure::main(&args, lang),
        Verb::Compare(args) => compare::main(&args, lang),
        Verb::Datasheet(args) => datasheet::main(&args, lang),
        Verb::Model(args) => model::main(&args, lang),
        Verb::Simulate(args) => simulate::main(&args, lang),
        Verb::Effects(args) => effects::main(&args, lang),
        Verb::Guide(args) => guide::main(&args, lang),
        Verb::Explain(args) => explain::main(&args, lang),
        Verb::Plan(args) => plan::main(&args, lang),
        Verb::Prove(args) => prove::main(&args, lang),
        Verb::Verify(args) => verify::main(&args, lang),
        Verb::Sign(args) => sign::sign(&args, lang),
        Verb::Approve(args) => sign::approve(&args, lang),
        Verb::Store(args) => store::main(&args, lang),
        Verb::History(args) => history::main(&args, lang),
        Verb::Procedures(args) => procedures::main(&args, lang),
        Verb::Demo(args) => demo::main(args, lang),
        Verb::Completions { shell } => {
            let mut script = vec![];
            clap_complete::generate(shell, &mut help::command(Cli::command(), lang), "sagnac", &mut script);
            place::print(&String::from_utf8_lossy(&script));
            Ok(exit::PASS)
        }
        Verb::Man => {
            let mut page = vec![];
            let rendered = clap_mangen::Man::new(help::command(Cli::command(), lang)).render(&mut page);
            place::print(&String::from_utf8_lossy(&page));
            rendered.map(|()| exit::PASS).map_err(|e| e.to_string())
        }
        Verb::Schema(args) => schema::main(&args),
        Verb::Selftest => selftest::main(lang),
    };
    let code = done.unwrap_or_else(|message| {
        place::eprint_diagnostic(&message);
        exit::ERROR
    });
    place::settled(code, lang)
}
