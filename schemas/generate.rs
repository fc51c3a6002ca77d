//! Writes the schemas of this folder from the types of the records: `cargo xtask schemas`. With `--check` it only says which are stale.

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let check = std::env::args().nth(1).is_some_and(|argument| argument == "--check");
    match sagnac::cli::generate_schemas(Path::new(env!("CARGO_MANIFEST_DIR")), check) {
        Ok(stale) if stale.is_empty() || !check => ExitCode::SUCCESS,
        Ok(stale) => {
            eprintln!("run cargo xtask schemas: not up to date in schemas/: {}", stale.join(", "));
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("schemas/: {error}");
            ExitCode::FAILURE
        }
    }
}
