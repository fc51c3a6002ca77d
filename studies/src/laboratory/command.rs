//! Commands that write cases, explain them and score the answers, so that a person can take them apart.

use super::answer::Answer;
use super::case;
use super::catalogue::{names, seeds};
use super::engine::{AGAIN, explain_folder};
use super::folder;
use super::score::Score;
use super::seal::{opened, seal};
use super::searches::{Least, Search, rates};
use super::tally;
use super::truth::{Family, Half, Strength};
use clap::{Args, Subcommand};
use rayon::prelude::*;
use std::io;
use std::path::{Path, PathBuf};

/// A command on a folder of cases.
#[derive(Subcommand)]
pub enum Command {
    /// Writes cases, each as a folder with recording.csv, model.toml and truth.json.
    LaboratoryWrite(Asked),
    /// Moves every truth.json into a folder of keys and writes their hashes into DIR/SEAL.
    LaboratorySeal {
        /// Folder of the cases.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// Folder for the keys.
        #[arg(long, value_name = "DIR")]
        keys: PathBuf,
    },
    /// Explains every folder that has no explain.json yet, through the library.
    LaboratoryExplain {
        /// Folder of the cases.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// Explains with augmented.toml once more.
        #[arg(long)]
        again: bool,
    },
    /// Prints the number of independent tests that each kind of search amounts to, from the answers to claims that are right.
    LaboratorySearches {
        /// Folder of the cases.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Scores the answers in the folders: explain.json, correction.csv, again.txt.
    LaboratoryScore {
        /// Folder of the cases.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// Folder of the keys of sealed cases.
        #[arg(long, value_name = "DIR")]
        keys: Option<PathBuf>,
        /// Lists the cases that are not named right.
        #[arg(long)]
        wrong: bool,
    },
}

/// Cases that are written.
#[derive(Args)]
pub struct Asked {
    /// Folder for the cases.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Held-out cases are looked at only to report.
    #[arg(long, value_enum, default_value_t = Half::Development)]
    half: Half,
    /// One family instead of all.
    #[arg(long, value_enum)]
    family: Option<Family>,
    /// One subject instead of all of the family.
    #[arg(long, value_name = "NAME")]
    subject: Option<String>,
    /// One strength instead of both.
    #[arg(long, value_enum)]
    strength: Option<Strength>,
    /// Cases of each subject and strength.
    #[arg(long, value_name = "N", default_value_t = 1)]
    count: u64,
    /// First seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

impl Command {
    /// Runs the command.
    ///
    /// # Errors
    /// A message for the user.
    pub fn run(&self) -> Result<(), String> {
        match self {
            Command::LaboratoryWrite(asked) => write(asked),
            Command::LaboratorySeal { folder, keys } => sealed(folder, keys),
            Command::LaboratoryExplain { folder, again } => explain(folder, *again),
            Command::LaboratorySearches { folder } => searches(folder),
            Command::LaboratoryScore { folder, keys, wrong } => score(folder, keys.as_deref(), *wrong),
        }
    }
}

fn write(asked: &Asked) -> Result<(), String> {
    let mut jobs = vec![];
    for family in Family::ALL.into_iter().filter(|f| asked.family.is_none_or(|only| only == *f)) {
        for name in names(family) {
            if asked.subject.as_ref().is_some_and(|s| s != name) {
                continue;
            }
            // Nulls have no strength, and stand for themselves under the first.
            let asked_for = |s: &Strength| match family {
                Family::Null => *s == Strength::Clear,
                _ => asked.strength.is_none_or(|only| only == *s),
            };
            for strength in Strength::ALL.into_iter().filter(asked_for) {
                let all = seeds(name, asked.half, asked.count, asked.seed);
                jobs.extend(all.into_iter().map(|seed| (name, strength, seed)));
            }
        }
    }
    if jobs.is_empty() {
        return Err("no case is of this half, family and subject".to_owned());
    }
    let done: Vec<Result<bool, String>> = jobs
        .par_iter()
        .map(|(name, strength, seed)| {
            let Some(case) = case::make(name, *strength, *seed) else { return Ok(false) };
            let at = asked.folder.join(&case.truth.case);
            folder::write(&case, &at).map_err(|e| format!("{}: {e}", at.display()))?;
            Ok(true)
        })
        .collect();
    let written = done.iter().filter(|d| **d == Ok(true)).count();
    for ((name, strength, seed), _) in jobs.iter().zip(&done).filter(|(_, d)| **d == Ok(false)) {
        eprintln!("{name} {} {seed}: no bench lets it be as strong as asked", strength.name());
    }
    println!("{written} cases in {}", asked.folder.display());
    done.into_iter().find_map(Result::err).map_or(Ok(()), Err)
}

/// Moves the truths away.
fn sealed(folder: &Path, keys: &Path) -> Result<(), String> {
    let failed = |e: io::Error| e.to_string();
    let cases = folders(folder).map_err(failed)?;
    println!("{} keys in {}", seal(&cases, folder, keys).map_err(failed)?, keys.display());
    Ok(())
}

/// Folders with a case, in order.
fn folders(of: &Path) -> io::Result<Vec<PathBuf>> {
    let mut all: Vec<PathBuf> = std::fs::read_dir(of)?
        .filter_map(|e| e.ok().map(|e| e.path()))
        .filter(|p| p.join("recording.csv").exists() && p.join("model.toml").exists())
        .collect();
    all.sort();
    Ok(all)
}

fn explain(folder: &Path, again: bool) -> Result<(), String> {
    let all = folders(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let open = |f: &&PathBuf| !f.join("explain.json").exists() || again && !f.join(AGAIN).exists();
    let left: Vec<&PathBuf> = all.iter().filter(open).collect();
    let failed: Vec<String> = left.par_iter().filter_map(|f| explain_folder(f, again).err()).collect();
    failed.iter().for_each(|f| eprintln!("{f}"));
    println!("{} of {} folders explained", left.len() - failed.len(), all.len());
    if failed.is_empty() { Ok(()) } else { Err(format!("{} failed", failed.len())) }
}

fn score(folder: &Path, keys: Option<&Path>, list_wrong: bool) -> Result<(), String> {
    let failed = |e: io::Error| e.to_string();
    let mut scores = vec![];
    for at in folders(folder).map_err(failed)? {
        let truth = match keys {
            None => folder::truth(&at),
            Some(keys) => {
                let name = at.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
                opened(folder, keys, &name).and_then(|key| Ok(serde_json::from_slice(&key)?))
            }
        };
        let truth = truth.map_err(failed)?;
        let Some(answer) = Answer::read(&at).map_err(failed)? else {
            eprintln!("{}: no explain.json", at.display());
            continue;
        };
        let again = std::fs::read_to_string(at.join(AGAIN)).ok();
        let time_s = times(&at).map_err(failed)?;
        scores.push(Score::of(&truth, &answer, &time_s, again.as_deref().map(str::trim)));
    }
    for half in Half::ALL {
        for family in Family::ALL {
            let own: Vec<Score> =
                scores.iter().filter(|s| s.half == half && s.family == family).cloned().collect();
            if !own.is_empty() {
                println!(
                    "{}",
                    tally::table(&format!("{}, {}", family.name(), half.name()), &tally::rows(family, &own))
                );
            }
        }
    }
    let wrong = |s: &&Score| if s.family == Family::Null { s.detected } else { !s.named };
    for s in scores.iter().filter(|_| list_wrong).filter(wrong) {
        println!("{:<48} first: {:<24} explained {:?}", s.case, s.first, s.explained);
    }
    Ok(())
}

/// Rates of the kinds of search, and the quartiles of the probability that they give to the same records.
fn searches(folder: &Path) -> Result<(), String> {
    let mut all = vec![];
    for at in folders(folder).map_err(|e| format!("{}: {e}", folder.display()))? {
        let Ok(text) = std::fs::read_to_string(at.join("explain.json")) else { continue };
        let report = serde_json::from_str(&text).map_err(|e| format!("{}: {e}", at.display()))?;
        all.extend(Least::of(&report));
    }
    if all.is_empty() {
        return Err(format!("{}: no explain.json", folder.display()));
    }
    let found = rates(&all);
    for (search, (rate, won)) in Search::ALL.iter().zip(found) {
        println!("{search:?} {rate:.2} ({won} of {})", all.len());
    }
    let mut p: Vec<f64> = all.iter().map(|l| l.probability(&found.map(|f| f.0))).collect();
    p.sort_by(f64::total_cmp);
    let quartile = |q: usize| p[(q * p.len() / 4).min(p.len() - 1)];
    println!("quartiles of p: {:.2} {:.2} {:.2}", quartile(1), quartile(2), quartile(3));
    Ok(())
}

/// First column of a recording.
fn times(at: &Path) -> io::Result<Vec<f64>> {
    let text = std::fs::read_to_string(at.join("recording.csv"))?;
    Ok(text.lines().skip(1).filter_map(|line| line.split(',').next()?.parse().ok()).collect())
}
