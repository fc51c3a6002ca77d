//! Commands for people who work on Sagnac.

mod dist;
mod features;
mod long_studies;
mod modules;
mod notices;
mod proofs;
mod same_results;
mod speed;
mod test_names;
mod weight;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const USAGE: &str = "usage: cargo xtask COMMAND

validate [STUDY]... [--records N] [--seed N] [--out DIR] [--list] [--index]
    Run Monte Carlo studies and write their pages in docs/validation/.
study [NAME]
    Run a long study of corrupted samples or killed runs, which is an ignored test; without a name: list them.
same-results OLD NEW [--only TEXT]
    Run every shipped sample with two binaries and compare their result.json: numbers to the last digit.
features [CARGO OPTION]...
    Check sagnac-ingest with every cargo feature alone, with none and with all.
proofs DATA [WORD]...
    Run the proofs with the recordings of a folder, those whose path contains a word or all, and add a line a run to docs/PROOFS.md.
schemas [--check]
    Write schemas/: JSON Schema of results, generated from the types of the records.
dist [--profile PROFILE] [--out DIR] [--without-pdf] [--without-wheels]
    Write target/dist: the program with PDF, completions, manual page, its packages (CycloneDX), hashes, a Debian package, and wheels.
notices [--check]
    Write THIRD-PARTY.md: licences and notices of the packages that the program contains.
tests COMMIT
    Print the tests that went and those that came since a commit, by the names of their functions.
speed [--store]
    Measure what users wait for beside bare kernels, in one run, and print the table of docs/PERFORMANCE.md. Fails where a ratio is
    a fifth above the stored one; --store keeps those of this run.
weight [--since DATE]
    Print how many lines, files and types there are, and how many files a commit touches for one more field, measurand or effect.
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some(root) = Path::new(env!("CARGO_MANIFEST_DIR")).parent() else { return ExitCode::from(2) };
    match arguments.split_first() {
        Some((command, rest)) if command == "validate" => validate(root, rest),
        Some((command, rest)) if command == "same-results" => match same_results_options(rest) {
            Some((old, new, only)) => same_results::compare(root, &old, &new, &only),
            None => usage(),
        },
        Some((command, rest)) if command == "study" && rest.len() < 2 => long_studies::run(root, rest),
        Some((command, [data, words @ ..])) if command == "proofs" => proofs::run(root, data, words),
        Some((command, rest)) if command == "features" => features::check(root, rest),
        Some((command, [])) if command == "schemas" => schemas(root, &[]),
        Some((command, [check])) if command == "schemas" && check == "--check" => schemas(root, &[check]),
        Some((command, rest)) if command == "dist" => match dist::Options::of(root, rest) {
            Some(options) => dist::run(root, &options),
            None => usage(),
        },
        Some((command, [])) if command == "notices" => notices::run(root, false),
        Some((command, [check])) if command == "notices" && check == "--check" => notices::run(root, true),
        Some((command, [commit])) if command == "tests" => test_names::compare(root, commit),
        Some((command, [])) if command == "speed" => speed::run(root, false),
        Some((command, [option])) if command == "speed" && option == "--store" => speed::run(root, true),
        Some((command, [])) if command == "weight" => weight::print(root, weight::COMMITS_SINCE),
        Some((command, [option, date])) if command == "weight" && option == "--since" => {
            weight::print(root, date)
        }
        _ => usage(),
    }
}

fn usage() -> ExitCode {
    eprint!("{USAGE}");
    ExitCode::from(2)
}

/// Studies run optimised, whatever profile this program has.
fn validate(root: &Path, arguments: &[String]) -> ExitCode {
    cargo(root, &["run", "--release", "--quiet", "--package", "sagnac-studies", "--"], arguments)
}

/// The generator is a build of its own: own packages with the feature `schema`, which nothing optimises, and the dependencies that
/// there are already.
fn schemas(root: &Path, arguments: &[&String]) -> ExitCode {
    let unoptimised =
        ["sagnac", "sagnac-base", "sagnac-core", "sagnac-explain", "sagnac-ingest", "sagnac-noise"]
            .map(|package| format!("--config=profile.dev.package.{package}.opt-level=0"));
    let options: Vec<&str> = unoptimised.iter().map(String::as_str).collect();
    let run = ["run", "--quiet", "--package", "sagnac", "--features", "schema", "--bin", "generate-schemas"];
    cargo(root, &[&run, &options[..], &["--"]].concat(), arguments)
}

fn cargo(root: &Path, command: &[&str], arguments: &[impl AsRef<OsStr>]) -> ExitCode {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo).current_dir(root).args(command).args(arguments).status();
    match status {
        Ok(status) => ExitCode::from(status.code().and_then(|c| u8::try_from(c).ok()).unwrap_or(1)),
        Err(error) => {
            eprintln!("failed to start cargo: {error}");
            ExitCode::FAILURE
        }
    }
}

fn same_results_options(arguments: &[String]) -> Option<(PathBuf, PathBuf, String)> {
    let (files, only) = match arguments {
        [old, new] => ([old, new], String::new()),
        [old, new, option, text] if option == "--only" => ([old, new], text.clone()),
        _ => return None,
    };
    // The programs are started in the root folder.
    let [old, new] = files.map(std::path::absolute);
    Some((old.ok()?, new.ok()?, only))
}
