//! The `sagnac` binary: parse, run, exit code.

#[cfg(unix)]
mod signals;

fn main() -> std::process::ExitCode {
    keep_caught_panics_quiet();
    #[cfg(unix)]
    signals::tidy_up_on();
    sagnac::cli::main()
}

/// A decoder that panics on a damaged file is caught, and the diagnostic of the file says so: the message of the panic
/// itself would only confuse.
fn keep_caught_panics_quiet() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !sagnac::ingest::decoder_is_running() {
            usual(panic);
        }
    }));
}
