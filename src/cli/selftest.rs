//! `sagnac selftest`: published oracles re-run on this machine.

use super::{exit, place};
use crate::i18n::Lang;

pub fn main(lang: Lang) -> Result<u8, String> {
    let report = crate::selftest::run();
    place::print(&report.text(lang));
    Ok(if report.passed() { exit::PASS } else { exit::ERROR })
}
