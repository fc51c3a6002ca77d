//! What a tool answered: `explain.json` and `correction.csv`, as the contract lays them out.

use super::truth::Place;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::{fs, io};

/// A parameter with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stated {
    /// Value.
    pub value: f64,
    /// 95 % interval; absent where none is stated.
    pub ci95: Option<[f64; 2]>,
}

/// One entry of the effects.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Kind.
    pub kind: String,
    /// Equivalents.
    pub equivalents: Vec<String>,
    /// Probabilities of kinds.
    pub probabilities: BTreeMap<String, f64>,
    /// Parameters.
    pub parameters: BTreeMap<String, Stated>,
    /// Places, the principal first.
    pub places: Vec<Place>,
    /// Column that it names.
    pub column: Option<String>,
    /// Law that it names.
    pub law: Option<String>,
}

/// An answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Verdict.
    pub verdict: String,
    /// Effects, the principal first.
    pub effects: Vec<Entry>,
    /// Rows of the correction: time in s and deg/h.
    pub correction: Vec<[f64; 2]>,
}

impl Answer {
    /// Reads the report; what it lacks is empty. `None` without a verdict.
    pub fn of(report: &Value, correction: Vec<[f64; 2]>) -> Option<Answer> {
        let verdict = report["verdict"].as_str()?.to_owned();
        let effects =
            report["effects"].as_array().map_or_else(Vec::new, |all| all.iter().map(entry).collect());
        Some(Answer { verdict, effects, correction })
    }

    /// Reads a folder. `None` where it holds no `explain.json`.
    ///
    /// # Errors
    /// If a file cannot be read, or is not what the contract says.
    pub fn read(folder: &Path) -> io::Result<Option<Answer>> {
        let Some(report) = text(&folder.join("explain.json"))? else { return Ok(None) };
        let correction = text(&folder.join("correction.csv"))?.unwrap_or_default();
        let rows = correction.lines().skip(1).filter_map(|line| {
            let (time, value) = line.split_once(',')?;
            Some([time.parse().ok()?, value.parse().ok()?])
        });
        let report: Value = serde_json::from_str(&report)?;
        let answer = Answer::of(&report, rows.collect());
        answer.map(Some).ok_or_else(|| io::Error::other(format!("{}: no verdict", folder.display())))
    }

    /// Whether it names the claim right.
    pub fn consistent(&self) -> bool {
        self.verdict == "consistent"
    }

    /// The correction at instants in s, by straight lines; empty where there is none.
    pub fn correction_at(&self, time_s: &[f64]) -> Vec<f64> {
        let rows = &self.correction;
        if rows.is_empty() {
            return vec![];
        }
        let mut next = 0;
        time_s
            .iter()
            .map(|t| {
                while next + 1 < rows.len() && rows[next][0] < *t {
                    next += 1;
                }
                let ([t0, v0], [t1, v1]) = (rows[next.saturating_sub(1)], rows[next]);
                if t1 > t0 { v0 + (v1 - v0) * ((t - t0) / (t1 - t0)).clamp(0.0, 1.0) } else { v1 }
            })
            .collect()
    }
}

/// Text of a file; `None` where there is none.
fn text(path: &Path) -> io::Result<Option<String>> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(e) => Err(e),
    }
}

fn entry(value: &Value) -> Entry {
    let owned = |v: &Value| v.as_str().map(str::to_owned);
    let parameters = value["parameters"].as_object().map_or_else(BTreeMap::new, |all| {
        all.iter().filter_map(|(name, p)| Some((name.clone(), stated(p)?))).collect()
    });
    let places = match &value["where"] {
        Value::Array(all) => all.iter().filter_map(place).collect(),
        one => place(one).into_iter().collect(),
    };
    Entry {
        kind: owned(&value["kind"]).unwrap_or_default(),
        equivalents: value["equivalents"]
            .as_array()
            .map_or_else(Vec::new, |all| all.iter().filter_map(owned).collect()),
        probabilities: value["probabilities"].as_object().map_or_else(BTreeMap::new, |all| {
            all.iter().filter_map(|(kind, p)| Some((kind.clone(), p.as_f64()?))).collect()
        }),
        parameters,
        places,
        column: owned(&value["column"]),
        law: owned(&value["law"]),
    }
}

fn stated(value: &Value) -> Option<Stated> {
    let ends = [value["ci95"][0].as_f64(), value["ci95"][1].as_f64()];
    let ci95 = match ends {
        [Some(low), Some(high)] => Some([low, high]),
        // An end that is not finite has no number in JSON.
        [Some(low), None] => Some([low, f64::INFINITY]),
        [None, Some(high)] => Some([f64::NEG_INFINITY, high]),
        _ => None,
    };
    Some(Stated { value: value["value"].as_f64()?, ci95 })
}

fn place(value: &Value) -> Option<Place> {
    Some(Place::new(value["domain"].as_str()?, value["from"].as_f64()?, value["to"].as_f64()?))
}
