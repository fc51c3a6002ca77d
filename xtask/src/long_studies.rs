//! Long Monte Carlo studies that are ignored tests, because they share their generators with the tests of every day.

use std::path::Path;
use std::process::{Command, ExitCode};

/// A study: one ignored test, or several of one name.
struct LongStudy {
    name: &'static str,
    /// What it measures, and how long it takes.
    title: &'static str,
    /// Arguments of `cargo test` that select it.
    target: &'static [&'static str],
    /// Names of its tests begin or contain this.
    filter: &'static str,
}

const STUDIES: &[LongStudy] = &[
    LongStudy {
        name: "edges",
        title: "Every measurand at the edges of its range; writes edges.md (an hour; FAMILY, RECORDS)",
        target: &["--test", "edges"],
        filter: "the_table",
    },
    LongStudy {
        name: "noise",
        title: "Identification of noise, every mix at two lengths (hours)",
        target: &["--test", "identification_study"],
        filter: "long_study",
    },
    LongStudy {
        name: "explain",
        title: "Explanations of concealed effects (hours; KINDS, COUNT, SEED, STRENGTH)",
        target: &["--test", "explain_study"],
        filter: "study",
    },
    LongStudy {
        name: "local-effects",
        title: "Steps, telegraph signals, outliers: false finds, detection, confusion (an hour)",
        target: &["--test", "mismatch_local"],
        filter: "study_of",
    },
    LongStudy {
        name: "temperature",
        title: "Temperature: intervals with and without dwells, warm-up, settling (an hour; SAGNAC_RUNS, SAGNAC_FIRST)",
        target: &["--test", "thermal_study"],
        filter: "",
    },
    LongStudy {
        name: "rate-table",
        title: "Rate table: intervals, tilts, positions, dead zones (an hour; SAGNAC_RUNS, SAGNAC_FIRST)",
        target: &["--test", "rate_table"],
        filter: "long_study",
    },
    LongStudy {
        name: "influence",
        title: "Magnetic field, supply, vibration, repeatability (an hour; SAGNAC_RUNS, SAGNAC_FIRST)",
        target: &["--test", "influence"],
        filter: "long",
    },
    LongStudy {
        name: "drill",
        title: "Every corruption of every sample; SAGNAC_WRITE_DRILL=1 writes drill.md (minutes)",
        target: &["--test", "drill"],
        filter: "",
    },
    LongStudy {
        name: "kills",
        title: "A run that is killed 200 times (minutes)",
        target: &["--test", "atomic"],
        filter: "",
    },
];

/// Runs the named study, or lists all.
pub fn run(root: &Path, arguments: &[String]) -> ExitCode {
    let [name] = arguments else {
        STUDIES.iter().for_each(|s| println!("{:<14} {}", s.name, s.title));
        return ExitCode::SUCCESS;
    };
    let Some(study) = STUDIES.iter().find(|s| s.name == name) else {
        eprintln!("no study is named {name}; `cargo xtask study` lists all");
        return ExitCode::from(2);
    };
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .current_dir(root)
        .args(["test", "--release", "--package", "sagnac"])
        .args(study.target)
        .args([study.filter, "--", "--ignored", "--nocapture", "--skip", "write_"])
        .status();
    match status {
        Ok(status) if status.success() => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("failed to start cargo: {error}");
            ExitCode::FAILURE
        }
    }
}
