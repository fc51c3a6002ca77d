//! The `sagnac` binary: parse, run, exit code.

#[cfg(feature = "allocator")]
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    sagnac::cli::begin();
    let arguments: Vec<_> = std::env::args_os().collect();
    sagnac::cli::run(&arguments).into()
}
