//! `sagnac-archive`: Sagnac over an archive of recordings.
#![forbid(unsafe_code)]

mod commands;

use clap::Parser;
use commands::Command;
use std::process::ExitCode;

/// Analyse an archive of recordings, on one machine or on several
#[derive(Debug, Parser)]
#[command(name = "sagnac-archive", version, after_help = AFTER_HELP)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const AFTER_HELP: &str = "Exit codes: 0: every recording has a result; 1: some have an error instead; 2: the command \
                     could not be carried out.\nAn object store is told by the environment: AWS_ACCESS_KEY_ID, \
                     AWS_SECRET_ACCESS_KEY, AWS_REGION, AWS_ENDPOINT, AWS_ALLOW_HTTP.";

fn main() -> ExitCode {
    let cli = Cli::parse();
    // Ballista and object_store say what they do through `log`; RUST_LOG shows more of it.
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("error")).init();
    match commands::execute(cli.command) {
        Ok(code) => ExitCode::from(code),
        Err(text) => {
            let text = text.trim_end();
            let head = if text.starts_with("error: ") { "" } else { "error: " };
            eprintln!("{head}{text}");
            ExitCode::from(commands::COMMAND_FAILED)
        }
    }
}
