//! Long studies that are ignored tests, because they check every case and measure no rate: all corruptions of all samples,
//! many kills. Monte Carlo studies are those of `cargo xtask validate`.

use std::path::Path;
use std::process::{Command, ExitCode};

/// A study: one ignored test, or several of one name.
struct LongStudy {
    name: &'static str,
    /// What it measures, and how long it takes.
    title: &'static str,
    /// Part of the names of its tests.
    filter: &'static str,
}

const STUDIES: &[LongStudy] = &[
    LongStudy {
        name: "drill",
        title: "Every corruption of every sample; SAGNAC_WRITE_DRILL=1 writes drill.md (minutes)",
        filter: "drill::",
    },
    LongStudy { name: "kills", title: "A run that is killed 200 times (minutes)", filter: "atomic::" },
    LongStudy {
        name: "watch-soak",
        title: "A watched folder with 10 000 recordings, or SAGNAC_SOAK_FILES, over kills of the watcher (an hour)",
        filter: "a_day_of_recordings",
    },
    LongStudy {
        name: "serve-kills",
        title: "A server of the bench that is killed 100 times with orders in its queue (minutes)",
        filter: "a_hundred_kills_of_the_server",
    },
    LongStudy {
        name: "serve-latency",
        title: "How long pages of the bench take beside two running tests (minutes)",
        filter: "pages_answer_beside",
    },
    LongStudy {
        name: "store-kills",
        title: "Writers of a store that are killed 300 times (minutes)",
        filter: "300_times",
    },
    LongStudy {
        name: "store-scale",
        title: "How long a store of 100 000 runs takes to answer (minutes)",
        filter: "large_store",
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
        .args(["test", "--release", "--package", "sagnac", "--test", "it", study.filter])
        .args(["--", "--ignored", "--nocapture"])
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
