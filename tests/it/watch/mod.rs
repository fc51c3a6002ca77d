//! A watched folder: each complete recording is tested once, over kills and restarts, and whoever is to know is told.

mod complete;
mod once;
mod rules;
mod soak;
mod told;

use crate::support::quick::Quick;
use crate::support::{Said, result, sagnac_as_typed};
use serde_json::Value;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};
use tempfile::{TempDir, tempdir};

/// A bench: a folder for recordings, and rules for them.
pub struct Bench {
    dir: TempDir,
    quick: Quick,
}

impl Bench {
    /// A bench with a rule for `*_{serial}.csv`, to which keys may be added.
    pub fn new(more: &str) -> Bench {
        Bench::with_pattern("*_{serial}.csv", more)
    }

    pub fn with_pattern(pattern: &str, more: &str) -> Bench {
        let bench = Bench { dir: tempdir().unwrap(), quick: Quick::new("pass") };
        fs::create_dir(bench.at("in")).unwrap();
        bench.rule(pattern, more);
        bench
    }

    /// Writes the rules anew.
    pub fn rule(&self, pattern: &str, more: &str) {
        let (procedure, limits) = (&self.quick.procedure, &self.quick.limits);
        let text = format!(
            "format = \"watch/1\"\npoll = \"100 ms\"\n[[rule]]\npattern = \"{pattern}\"\nprocedure = '{procedure}'\n\
             limits = '{limits}'\n{more}"
        );
        fs::write(self.at("watch.toml"), text).unwrap();
    }

    pub fn folder(&self) -> &Path {
        self.dir.path()
    }

    pub fn at(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    /// Puts a recording of a unit into the folder, last changed an hour ago; `end` is `pass` or `fail`.
    pub fn put(&self, name: &str, end: &str) {
        let text = fs::read_to_string(Quick::new(end).recording).unwrap();
        self.write(name, &text);
    }

    /// Puts a file into the folder, last changed an hour ago.
    pub fn write(&self, name: &str, text: &str) {
        let path = self.at("in").join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
        let hour_ago = SystemTime::now() - Duration::from_secs(3600);
        File::options().write(true).open(&path).unwrap().set_modified(hour_ago).unwrap();
    }

    /// A recording that differs in its first value from that of other numbers.
    pub fn numbered(&self, name: &str, number: usize) {
        let text = fs::read_to_string(&self.quick.recording).unwrap();
        self.write(name, &text.replacen("\n0,12.", &format!("\n0,12.{number:06}"), 1));
    }

    pub const ONCE: [&str; 7] = ["watch", "in", "--rules", "watch.toml", "--out", "out", "--once"];

    /// Looks once.
    pub fn once(&self) -> Said {
        sagnac_as_typed(self.folder(), &Bench::ONCE, &[])
    }

    /// The results, by the paths of their folders.
    pub fn results(&self) -> Vec<(PathBuf, Value)> {
        let mut found = vec![];
        for unit in fs::read_dir(self.at("out/results")).into_iter().flatten().flatten() {
            for test in fs::read_dir(unit.path()).unwrap().flatten() {
                found.push((test.path(), result(&test.path())));
            }
        }
        found.sort_by(|a, b| a.0.cmp(&b.0));
        found
    }

    /// Serial number and verdict of each result.
    pub fn verdicts(&self) -> Vec<(String, String)> {
        let text = |value: &Value| value.as_str().unwrap().to_owned();
        let results = self.results();
        results.iter().map(|(_, r)| (text(&r["unit_under_test"]["serial"]), text(&r["verdict"]))).collect()
    }

    /// Folder of the page of the only day.
    pub fn day(&self) -> PathBuf {
        let days: Vec<PathBuf> =
            fs::read_dir(self.at("out/days")).unwrap().map(|e| e.unwrap().path()).collect();
        // A test may run over midnight.
        days.into_iter().max().unwrap()
    }

    /// The record of the day.
    pub fn record(&self) -> Value {
        serde_json::from_slice(&fs::read(self.day().join("day.json")).unwrap()).unwrap()
    }

    /// The reasons why recordings were not tested, by their names.
    pub fn untested(&self) -> Vec<(String, String)> {
        let record = self.record();
        let all = record["untested"].as_array().unwrap();
        let text = |value: &Value| value.as_str().unwrap().to_owned();
        all.iter().map(|u| (text(&u["recording"]), text(&u["why"]["id"]))).collect()
    }

    /// Lines of the journal behind the first.
    pub fn journal(&self) -> Vec<Value> {
        let text = fs::read_to_string(self.at("out/journal.jsonl")).unwrap();
        text.lines().skip(1).map(|line| serde_json::from_str(line).unwrap()).collect()
    }
}

pub fn pairs(list: &[(&str, &str)]) -> Vec<(String, String)> {
    list.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect()
}
