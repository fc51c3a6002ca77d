//! Runs studies and writes `docs/validation/`; started by `cargo xtask validate`.

use clap::Parser;
use sagnac_studies::laboratory::command::Command;
use sagnac_studies::results::{CaseResult, Results, code_commit};
use sagnac_studies::study::Study;
use sagnac_studies::{STUDIES, index, pages};
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Runs Monte Carlo studies and writes their pages in docs/validation/, generated.md with all of them, and the misses
/// of all pages into README.md there. Pages kept by hand are never overwritten. A study that was interrupted goes on after
/// its last finished case, as long as the code is the same.
#[derive(Parser)]
#[command(name = "cargo xtask validate", args_conflicts_with_subcommands = true)]
struct Options {
    /// Cases of the laboratory as folders.
    #[command(subcommand)]
    laboratory: Option<Command>,
    /// Studies; without a name all.
    #[arg(value_name = "STUDY", value_parser = study)]
    studies: Vec<&'static Study>,
    /// Records of each case instead of those of the study.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    records: Option<u64>,
    /// First seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Folder for the pages instead of docs/validation/; the misses in README.md stay as they are.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Names the studies.
    #[arg(long)]
    list: bool,
    /// Runs nothing; writes generated.md of the results that are there, and the misses of all pages into README.md.
    #[arg(long)]
    index: bool,
}

fn study(id: &str) -> Result<&'static Study, String> {
    STUDIES.iter().copied().find(|s| s.id == id).ok_or_else(|| format!("no study is named {id}"))
}

fn main() -> ExitCode {
    let mut options = Options::parse();
    if let Some(command) = &options.laboratory {
        return exit_code(command.run().map_err(io::Error::other));
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("docs").join("validation");
    if options.list {
        STUDIES.iter().for_each(|s| println!("{:<20} {}", s.id, s.title));
        return ExitCode::SUCCESS;
    }
    if options.index {
        return exit_code(write_summary(&folder).and_then(|()| index::update(&folder)));
    }
    if options.studies.is_empty() {
        options.studies = STUDIES.to_vec();
    }
    exit_code(validate(&options, &folder))
}

fn exit_code(done: io::Result<()>) -> ExitCode {
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn validate(options: &Options, pages: &Path) -> io::Result<()> {
    let root =
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().ok_or_else(|| io::Error::other("no root folder"))?;
    let commit = code_commit(root)?;
    let folder = options.out.as_deref().unwrap_or(pages);
    std::fs::create_dir_all(folder)?;
    for study in &options.studies {
        let records = options.records.unwrap_or(study.records);
        let path = folder.join(format!("{}.json", study.id));
        let partial =
            root.join("target/validation").join(format!("{}-{records}-{}.json", study.id, options.seed));
        let fresh = Results::new(study, &commit, records, options.seed);
        // Results of changed code that no commit holds cannot be told from those of other changes.
        let kept = Results::read(&partial)?.filter(|r| r.commit == commit && !commit.ends_with('+'));
        let results = run(study, kept.unwrap_or(fresh), &partial)?;
        write_page(&folder.join(format!("{}.md", study.id)), &pages::study_page(study, &results))?;
        results.write(&path)?;
        write_summary(folder)?;
        if options.out.is_none() {
            index::update(folder)?;
        }
    }
    Ok(())
}

/// Writes a page of a study, never over one that is kept by hand.
fn write_page(path: &Path, page: &str) -> io::Result<()> {
    match std::fs::read_to_string(path) {
        Ok(old) if !old.contains(pages::GENERATED) => {
            Err(io::Error::other(format!("{} is kept by hand", path.display())))
        }
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(e),
        _ => std::fs::write(path, page),
    }
}

/// Runs the cases that have no result yet; keeps each as it finishes.
fn run(study: &Study, mut results: Results, partial: &Path) -> io::Result<Results> {
    let cases = (study.cases)();
    for (i, case) in cases.iter().enumerate() {
        let place = format!("{} {}/{} {}", study.id, i + 1, cases.len(), case.name);
        if results.cases.iter().any(|c| c.name == case.name) {
            eprintln!("{place}: kept");
            continue;
        }
        let start = Instant::now();
        let rows = (case.run)(results.records, results.seed);
        let elapsed_s = start.elapsed().as_secs_f64();
        eprintln!("{place}: {elapsed_s:.1} s, {} cases left", cases.len() - i - 1);
        results.cases.push(CaseResult { name: case.name.clone(), elapsed_s: Some(elapsed_s), rows });
        results.write(partial)?;
    }
    Ok(results)
}

fn write_summary(folder: &Path) -> io::Result<()> {
    let mut all = vec![];
    for study in STUDIES {
        all.extend(Results::read(&folder.join(format!("{}.json", study.id)))?);
    }
    write_page(&folder.join("generated.md"), &pages::summary(STUDIES, &all))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn a_study_and_a_command_of_the_laboratory_are_told_apart() {
        Options::command().debug_assert();
        let asked = |line: &str| Options::try_parse_from(line.split(' '));
        let study = asked("validate laboratory --records 2").unwrap();
        assert!(
            study.laboratory.is_none() && study.studies[0].id == "laboratory" && study.records == Some(2)
        );
        let write = asked("validate laboratory-write cases --half held-out --count 2 --seed 4711").unwrap();
        assert!(matches!(write.laboratory, Some(Command::LaboratoryWrite(_))) && write.studies.is_empty());
        for wrong in ["validate nothing", "validate lines --records 0", "validate laboratory-seal cases"] {
            assert!(asked(wrong).is_err(), "{wrong}");
        }
    }
}
