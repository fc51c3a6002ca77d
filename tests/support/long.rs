//! Tests of many minutes: Monte Carlo of whole runs.

use std::io::Write as _;

/// True where long tests are wanted (`SAGNAC_LONG_TESTS` is set); else a visible line tells that one is skipped.
pub fn wanted(name: &str) -> bool {
    let wanted = std::env::var_os("SAGNAC_LONG_TESTS").is_some();
    if !wanted {
        let _ = writeln!(std::io::stderr(), "SKIPPED: {name}: SAGNAC_LONG_TESTS is not set");
    }
    wanted
}
