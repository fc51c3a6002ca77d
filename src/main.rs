//! The `sagnac` binary: parse, run, exit code.

fn main() -> std::process::ExitCode {
    sagnac::cli::main()
}
