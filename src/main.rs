//! The `sagnac` binary: parse, run, exit code.

fn main() -> std::process::ExitCode {
    sagnac::cli::begin();
    let arguments: Vec<_> = std::env::args_os().collect();
    sagnac::cli::run(&arguments).into()
}
