//! `sagnac selftest`: published oracles re-run on this machine.

use super::{exit, place};
use crate::i18n::Lang;

pub fn main(lang: Lang) -> u8 {
    let report = crate::selftest::run();
    place::print(&report.text(lang));
    if report.passed() { exit::PASS } else { exit::ERROR }
}
