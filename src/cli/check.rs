//! `sagnac check`: procedures and limits without data.

use super::progress::{Display, Progress};
use super::{exit, place};
use crate::acceptance::power::warning;
use crate::config::diagnostics::Problem;
use crate::config::procedure::check::{Checked, check, check_report_with};
use crate::config::procedure::power::{questions, warnings};
use crate::config::procedure::{LimitsFile, Loaded, effective};
use crate::i18n::Lang;
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Procedures, limits files, manifests and layouts (TOML)
    #[arg(required = true)]
    files: Vec<PathBuf>,
}

pub fn main(args: &CheckArgs, lang: Lang) -> Result<u8, String> {
    let paths: Vec<&Path> = args.files.iter().map(|p| p.as_path()).collect();
    let mut progress = Progress::new(Display::unless(false), lang);
    progress.stage("progress.checking");
    // Limits files among the arguments are also set against every procedure among them.
    let limits: Vec<Loaded<LimitsFile>> = paths
        .iter()
        .filter_map(|p| match check(p) {
            Ok(Checked::Limits(l)) => Some(*l),
            _ => None,
        })
        .collect();
    let report = check_report_with(&paths, None, lang, |procedure, _| {
        let sets: Vec<Option<&Loaded<LimitsFile>>> =
            if limits.is_empty() { vec![None] } else { limits.iter().map(Some).collect() };
        sets.into_iter()
            .flat_map(|file| {
                let effective = effective(procedure, file);
                let asked = questions(&procedure.value, &effective);
                let mut found = effective.warnings.clone();
                let idle = effective.idle.clone().zip(file.filter(|f| !f.value.set.limits.is_empty()));
                found.extend(idle.map(|(note, file)| Problem::remark_on_file(&file.path, note)));
                found.extend(warnings(&asked, procedure, file, warning));
                found
            })
            .collect()
    });
    drop(progress);
    place::print(&report.text);
    Ok(if report.failed > 0 { exit::ERROR } else { exit::PASS })
}
