//! Runs studies and writes `docs/validation/`; started by `cargo xtask validate`.

use sagnac_studies::results::{CaseResult, Results, code_commit};
use sagnac_studies::study::Study;
use sagnac_studies::{STUDIES, index, laboratory, pages};
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

const USAGE: &str = "usage: cargo xtask validate [STUDY]... [--records N] [--seed N] [--out DIR] [--list] [--index]

Runs Monte Carlo studies and writes their pages in docs/validation/, generated.md with all of one build, and the misses of
all pages into README.md there. Pages kept by hand are never overwritten. Without a name: all studies.
A study that was interrupted goes on after its last finished case, as long as the code is the same.
--records  records of each case (default: that of the study)
--seed     first seed (default: 1)
--out      folder for the pages (default: docs/validation/); the misses in README.md stay as they are
--list     names the studies
--index    runs nothing; writes the misses of all pages into README.md
Cases of the laboratory as folders: laboratory-write, laboratory-seal, laboratory-explain, laboratory-score (run without arguments for help)
";

struct Options {
    studies: Vec<&'static Study>,
    records: Option<u64>,
    seed: u64,
    /// Folder for the pages instead of `docs/validation/`.
    out: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.iter().any(|a| a == "--help" || a == "-h") {
        print!("{USAGE}");
        return ExitCode::SUCCESS;
    }
    if arguments.iter().any(|a| a == "--list") {
        STUDIES.iter().for_each(|s| println!("{:<20} {}", s.id, s.title));
        return ExitCode::SUCCESS;
    }
    if let Some(done) = laboratory::command::run(&arguments) {
        return match done {
            Ok(()) => ExitCode::SUCCESS,
            Err(message) => {
                eprintln!("{message}");
                ExitCode::from(2)
            }
        };
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("docs").join("validation");
    if arguments.iter().any(|a| a == "--index") {
        return exit_code(index::update(&folder));
    }
    let options = match parse(&arguments) {
        Ok(options) => options,
        Err(message) => {
            eprint!("{message}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    exit_code(validate(&options, &folder))
}

fn exit_code(done: io::Result<()>) -> ExitCode {
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("failed to validate: {error}");
            ExitCode::FAILURE
        }
    }
}

fn parse(arguments: &[String]) -> Result<Options, String> {
    let mut options = Options { studies: vec![], records: None, seed: 1, out: None };
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        if argument == "--out" {
            let folder = rest.next().ok_or("--out lacks a folder")?;
            options.out = Some(PathBuf::from(folder));
            continue;
        }
        let mut number = || {
            let text = rest.next().ok_or_else(|| format!("{argument} lacks a number"))?;
            text.parse::<u64>().map_err(|_| format!("{argument} {text}: not a number"))
        };
        match argument.as_str() {
            "--records" => options.records = Some(number()?.max(1)),
            "--seed" => options.seed = number()?,
            id => {
                let study =
                    STUDIES.iter().find(|s| s.id == id).ok_or_else(|| format!("no study is named {id}"))?;
                options.studies.push(*study);
            }
        }
    }
    if options.studies.is_empty() {
        options.studies = STUDIES.to_vec();
    }
    Ok(options)
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
        write_summary(folder, &commit)?;
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

fn write_summary(folder: &Path, commit: &str) -> io::Result<()> {
    let mut all = vec![];
    for study in STUDIES {
        all.extend(Results::read(&folder.join(format!("{}.json", study.id)))?);
    }
    write_page(&folder.join("generated.md"), &pages::summary(STUDIES, &all, commit))
}
