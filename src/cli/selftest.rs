//! `sagnac selftest`: published oracles re-run on this machine.

use super::progress::{Display, Progress};
use super::{exit, place};
use crate::i18n::Lang;

pub fn main(lang: Lang) -> Result<u8, String> {
    let mut progress = Progress::new(Display::unless(false), lang);
    progress.stage("progress.computing");
    let report = crate::selftest::run();
    drop(progress);
    place::print(&report.text(lang));
    Ok(if report.passed() { exit::PASS } else { exit::ERROR })
}
