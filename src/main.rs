//! The `sagnac` binary: parse, run, exit code.

#[cfg(unix)]
mod signals;

fn main() -> std::process::ExitCode {
    #[cfg(unix)]
    signals::tidy_up_on();
    sagnac::cli::main()
}
