//! Exit codes, as the README documents them.

use crate::estimate::Verdict;

/// Every row passed, or there were no limits.
pub const PASS: u8 = 0;
/// At least one row failed.
pub const FAIL: u8 = 1;
/// The test could not be run, or not as required.
pub const ERROR: u8 = 2;
/// Neither pass nor fail.
pub const INDETERMINATE: u8 = 3;

/// The exit code of a verdict.
pub fn code(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::None | Verdict::Pass => PASS,
        Verdict::Fail => FAIL,
        Verdict::Indeterminate => INDETERMINATE,
        Verdict::Error => ERROR,
    }
}
