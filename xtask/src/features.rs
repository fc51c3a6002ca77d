//! Every cargo feature of `sagnac-ingest` alone, none and all of them: does it compile without a warning?

use std::path::Path;
use std::process::{Command, ExitCode};

/// Checks every combination with the given options of cargo; the first that fails ends the run.
pub fn check(root: &Path, options: &[String]) -> ExitCode {
    let manifest = root.join("crates/sagnac-ingest/Cargo.toml");
    let features = match std::fs::read_to_string(&manifest) {
        Ok(text) => features(&text),
        Err(error) => {
            eprintln!("failed to read {}: {error}", manifest.display());
            return ExitCode::FAILURE;
        }
    };
    let mut combinations: Vec<Vec<&str>> = vec![vec!["--no-default-features"], vec![]];
    combinations.extend(features.iter().map(|f| vec!["--no-default-features", "--features", f]));
    for combination in &combinations {
        // Not `-D warnings`: other flags would compile every dependency anew.
        let mut arguments = vec!["check", "--quiet", "--all-targets", "--color", "never"];
        arguments.extend(combination);
        match cargo(root, &arguments, options) {
            Ok(said) if said.is_empty() => {}
            Ok(said) => {
                eprintln!("{said}\nsagnac-ingest has warnings or errors: {}", combination.join(" "));
                return ExitCode::FAILURE;
            }
            Err(error) => {
                eprintln!("failed to start cargo: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    println!("sagnac-ingest compiles with all, with none and with each of {} features", features.len());
    ExitCode::SUCCESS
}

/// The names under `[features]`, but for those of all formats together.
fn features(manifest: &str) -> Vec<String> {
    let lines = manifest.lines().skip_while(|l| l.trim() != "[features]").skip(1);
    let names = lines.take_while(|l| !l.starts_with('[')).filter_map(|l| l.split_once('='));
    names.map(|(name, _)| name.trim().to_owned()).filter(|name| name != "default" && name != "all").collect()
}

/// What cargo says of the package on standard error: warnings and errors.
fn cargo(root: &Path, arguments: &[&str], options: &[String]) -> std::io::Result<String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let command = Command::new(cargo)
        .current_dir(root)
        .args(arguments)
        .args(["--package", "sagnac-ingest"])
        .args(options)
        .output()?;
    Ok(String::from_utf8_lossy(&command.stderr).into_owned())
}
