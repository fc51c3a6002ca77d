//! `sagnac selftest`: published oracles re-run on this machine.

use super::{exit, place};

pub fn main() -> u8 {
    let report = crate::selftest::run();
    place::print(&report.text());
    if report.passed() { exit::PASS } else { exit::ERROR }
}
