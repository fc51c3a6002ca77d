//! `sagnac check`: procedures and limits without data.

use super::progress::{Display, Progress};
use super::{exit, place};
use crate::acceptance::power::{length, warning};
use crate::config::procedure::check::check_report;
use crate::i18n::Lang;
use crate::ingest::each_of;
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Procedures, limits files, manifests and layouts (TOML), or quoted patterns of them
    #[arg(required = true)]
    files: Vec<PathBuf>,
}

pub fn main(args: &CheckArgs, lang: Lang) -> Result<u8, String> {
    let mut files: Vec<PathBuf> = vec![];
    for named in &args.files {
        for file in each_of(named).map_err(|e| place::error(&e.note(), lang))? {
            if !files.contains(&file) {
                files.push(file);
            }
        }
    }
    let mut progress = Progress::new(Display::unless(false), lang);
    progress.stage("progress.checking");
    let paths: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    let report = check_report(&paths, lang, &warning, &length);
    drop(progress);
    place::print(&report.text);
    Ok(if report.failed > 0 { exit::ERROR } else { exit::PASS })
}
