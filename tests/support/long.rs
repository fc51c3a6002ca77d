//! Tests of many minutes: Monte Carlo of whole runs.

use std::io::Write as _;

/// True where long tests are wanted (`SAGNAC_LONG_TESTS` is set); else a visible line tells that one is skipped.
#[allow(dead_code, reason = "each test program uses its part")]
pub fn wanted(name: &str) -> bool {
    asked() || tell("SKIPPED", name)
}

/// All cases of a test where long tests are wanted, else some of them and a visible line.
#[allow(dead_code, reason = "each test program uses its part")]
pub fn cases<T: Copy>(name: &str, all: &[T], some: usize) -> Vec<T> {
    let count = if asked() || tell("SHORTENED", name) { all.len() } else { some };
    all.iter().copied().take(count).collect()
}

fn asked() -> bool {
    std::env::var_os("SAGNAC_LONG_TESTS").is_some()
}

fn tell(what: &str, name: &str) -> bool {
    let _ = writeln!(std::io::stderr(), "{what}: {name}: SAGNAC_LONG_TESTS is not set");
    false
}
