//! Tests of many minutes: Monte Carlo of whole runs.

use std::io::Write as _;

/// True where long tests are wanted (`SAGNAC_LONG_TESTS` is set); else a visible line tells that one is skipped.
pub fn wanted(name: &str) -> bool {
    asked_or("SKIPPED", name)
}

/// All cases of a test where long tests are wanted, else some of them and a visible line.
pub fn cases<T: Copy>(name: &str, all: &[T], some: usize) -> Vec<T> {
    let count = if asked_or("SHORTENED", name) { all.len() } else { some };
    all.iter().copied().take(count).collect()
}

/// Whether long tests are asked for; else says what becomes of this one.
fn asked_or(otherwise: &str, name: &str) -> bool {
    let asked = std::env::var_os("SAGNAC_LONG_TESTS").is_some();
    if !asked {
        let _ = writeln!(std::io::stderr(), "{otherwise}: {name}: SAGNAC_LONG_TESTS is not set");
    }
    asked
}
