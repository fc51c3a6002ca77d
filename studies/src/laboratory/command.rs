//! Commands that write cases, explain them and score the answers, so that a person can take them apart.

use super::answer::Answer;
use super::case;
use super::catalogue::{names, seeds};
use super::engine::{AGAIN, explain_folder};
use super::folder;
use super::score::Score;
use super::seal::{opened, seal};
use super::tally;
use super::truth::{Family, Half, Strength};
use rayon::prelude::*;
use std::io;
use std::path::{Path, PathBuf};

/// Help of the commands.
pub const USAGE: &str =
    "usage: sagnac-studies laboratory-write DIR [--half HALF] [--family NAME] [--subject NAME] \
[--strength NAME] [--count N] [--seed N]
       sagnac-studies laboratory-seal DIR --keys DIR
       sagnac-studies laboratory-explain DIR [--again]
       sagnac-studies laboratory-score DIR [--keys DIR] [--wrong]

laboratory-write    writes cases, each as a folder with recording.csv, model.toml and truth.json
  --half      development (default) or held-out; the latter is looked at only to report
  --family    temperature, driver, unrecorded, table, event, noise, several, unknown or null (default: all)
  --subject   one subject (default: all of the family)
  --strength  clear or middling (default: both)
  --count     cases of each subject and strength (default: 1)
  --seed      first seed (default: 1)
laboratory-seal     moves every truth.json into a folder of keys and writes their hashes into DIR/SEAL
laboratory-explain  explains every folder that has no explain.json yet, through the library
  --again     explains with augmented.toml once more
laboratory-score    scores the answers in the folders: explain.json, correction.csv, again.txt
  --keys      the folder of keys of sealed cases
  --wrong     lists the cases that are not named right
";

/// What was asked for on the command line.
#[derive(Debug, Clone)]
struct Asked {
    folder: PathBuf,
    half: Half,
    families: Vec<Family>,
    subject: Option<String>,
    strengths: Vec<Strength>,
    count: u64,
    seed: u64,
    keys: Option<PathBuf>,
    flag: bool,
}

/// Runs one of the commands. `None` if the name is none of them.
///
/// # Errors
/// A message for the user.
pub fn run(arguments: &[String]) -> Option<Result<(), String>> {
    let (name, rest) = arguments.split_first()?;
    let command: fn(&Asked) -> Result<(), String> = match name.as_str() {
        "laboratory-write" => write,
        "laboratory-seal" => sealed,
        "laboratory-explain" => explain,
        "laboratory-score" => score,
        _ => return None,
    };
    Some(parse(rest).map_err(|message| format!("{message}\n{USAGE}")).and_then(|asked| command(&asked)))
}

fn parse(arguments: &[String]) -> Result<Asked, String> {
    let mut asked = Asked {
        folder: PathBuf::new(),
        half: Half::Development,
        families: Family::ALL.to_vec(),
        subject: None,
        strengths: Strength::ALL.to_vec(),
        count: 1,
        seed: 1,
        keys: None,
        flag: false,
    };
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        let mut value = || rest.next().ok_or_else(|| format!("{argument} lacks its value"));
        let number = |text: &String| text.parse::<u64>().map_err(|_| format!("{text}: not a number"));
        match argument.as_str() {
            "--half" => asked.half = one(&Half::ALL, |h| h.name(), value()?)?,
            "--family" => asked.families = vec![one(&Family::ALL, |f| f.name(), value()?)?],
            "--strength" => asked.strengths = vec![one(&Strength::ALL, |s| s.name(), value()?)?],
            "--subject" => asked.subject = Some(value()?.clone()),
            "--count" => asked.count = number(value()?)?,
            "--seed" => asked.seed = number(value()?)?,
            "--keys" => asked.keys = Some(PathBuf::from(value()?)),
            "--again" | "--wrong" => asked.flag = true,
            option if option.starts_with('-') => return Err(format!("{option} is no option")),
            folder => asked.folder = PathBuf::from(folder),
        }
    }
    if asked.folder.as_os_str().is_empty() {
        return Err("the folder is missing".to_owned());
    }
    Ok(asked)
}

/// The one of several that has a name.
fn one<T: Copy>(all: &[T], name: impl Fn(T) -> &'static str, asked: &str) -> Result<T, String> {
    let known = || all.iter().map(|t| name(*t)).collect::<Vec<_>>().join(", ");
    all.iter().copied().find(|t| name(*t) == asked).ok_or_else(|| format!("{asked} is none of {}", known()))
}

fn write(asked: &Asked) -> Result<(), String> {
    let mut jobs = vec![];
    for family in &asked.families {
        for name in names(*family) {
            if asked.subject.as_ref().is_some_and(|s| s != name) {
                continue;
            }
            let strengths = if *family == Family::Null { &[Strength::Clear][..] } else { &asked.strengths };
            for strength in strengths {
                let all = seeds(name, asked.half, asked.count, asked.seed);
                jobs.extend(all.into_iter().map(|seed| (name, *strength, seed)));
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
fn sealed(asked: &Asked) -> Result<(), String> {
    let Some(keys) = &asked.keys else { return Err(format!("--keys is missing\n{USAGE}")) };
    let failed = |e: io::Error| e.to_string();
    let cases = folders(&asked.folder).map_err(failed)?;
    println!("{} keys in {}", seal(&cases, &asked.folder, keys).map_err(failed)?, keys.display());
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

fn explain(asked: &Asked) -> Result<(), String> {
    let all = folders(&asked.folder).map_err(|e| format!("{}: {e}", asked.folder.display()))?;
    let open = |f: &&PathBuf| !f.join("explain.json").exists() || asked.flag && !f.join(AGAIN).exists();
    let left: Vec<&PathBuf> = all.iter().filter(open).collect();
    let failed: Vec<String> = left.par_iter().filter_map(|f| explain_folder(f, asked.flag).err()).collect();
    failed.iter().for_each(|f| eprintln!("{f}"));
    println!("{} of {} folders explained", left.len() - failed.len(), all.len());
    if failed.is_empty() { Ok(()) } else { Err(format!("{} failed", failed.len())) }
}

fn score(asked: &Asked) -> Result<(), String> {
    let failed = |e: io::Error| e.to_string();
    let mut scores = vec![];
    for at in folders(&asked.folder).map_err(failed)? {
        let truth = match &asked.keys {
            None => folder::truth(&at),
            Some(keys) => {
                let name = at.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
                opened(&asked.folder, keys, &name).and_then(|key| Ok(serde_json::from_slice(&key)?))
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
    for s in scores.iter().filter(|_| asked.flag).filter(wrong) {
        println!("{:<48} first: {:<24} explained {:?}", s.case, s.first, s.explained);
    }
    Ok(())
}

/// First column of a recording.
fn times(at: &Path) -> io::Result<Vec<f64>> {
    let text = std::fs::read_to_string(at.join("recording.csv"))?;
    Ok(text.lines().skip(1).filter_map(|line| line.split(',').next()?.parse().ok()).collect())
}
