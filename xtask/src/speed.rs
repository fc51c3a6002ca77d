//! Speed beside bare kernels: the bench `speed`, in a release build.

use std::path::Path;
use std::process::ExitCode;

/// Measures every figure and prints the table of `docs/PERFORMANCE.md`. Fails where a ratio is a fifth above the stored one;
/// `store` writes the ratios of this run instead.
pub fn run(root: &Path, store: bool) -> ExitCode {
    let options: &[&str] = if store { &["--store"] } else { &[] };
    super::cargo(
        root,
        &["bench", "--quiet", "--package", "sagnac-benches", "--bench", "speed", "--"],
        options,
    )
}
