//! Cases explained and scored, two at a time.

use super::case::{Case, Realisation};
use super::classes::replacements;
use super::files;
use super::oracle::told;
use super::plan::{Wish, made};
use super::score::score;
use super::table::Row;
use serde_json::Value;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Explains a recording by a model without some effects of the catalogue and leaves `explain.json`, `augmented.toml` and, where
/// there is one, `correction.csv` in a folder; the exit code. Nothing is hidden from it and nothing given but claim and
/// recording.
pub type Explainer = dyn Fn(&Path, &Path, &Path, &[&str]) -> Option<i32> + Sync;

/// `explain.json` of a folder.
pub fn report(folder: &Path) -> Value {
    let text = std::fs::read_to_string(folder.join("explain.json")).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or(Value::Null)
}

/// Columns one and two of a table with a heading.
pub fn columns(path: &Path) -> Option<(Vec<f64>, Vec<f64>)> {
    let text = std::fs::read_to_string(path).ok()?;
    let pair = |line: &str| {
        let (t, y) = line.split_once(',')?;
        Some((t.trim().parse().ok()?, y.trim().parse().ok()?))
    };
    let rows: Vec<(f64, f64)> = text.lines().skip(1).filter_map(pair).collect();
    (!rows.is_empty()).then(|| rows.into_iter().unzip())
}

fn consistent(explain: &Explainer, folder: &Path, recording: &Path, tag: &str) -> bool {
    let out = folder.join(tag);
    let code = explain(recording, &folder.join("out/augmented.toml"), &out, &[]);
    code == Some(0) && report(&out)["verdict"] == "consistent"
}

/// The recording against the augmented claim; a fresh day with the same effects; a recording of another case; a day of this
/// one without the effects, which is more than is asked.
fn closed_loop(explain: &Explainer, case: &Case, other: &Case, folder: &Path) -> [bool; 4] {
    let fresh_seed = case.seed.wrapping_add(0x5eed);
    let write = |case: &Case, seed: u64, name: &str| {
        let path = folder.join(name);
        let text = files::recording(case, &case.realise(seed), seed);
        std::fs::write(&path, text).is_ok().then_some(path)
    };
    let mut without = case.clone();
    without.left_out.clear();
    let again = consistent(explain, folder, &folder.join("recording.csv"), "again");
    let fresh =
        write(case, fresh_seed, "fresh.csv").is_some_and(|p| consistent(explain, folder, &p, "fresh"));
    let foreign =
        write(other, other.seed, "other.csv").is_some_and(|p| !consistent(explain, folder, &p, "other"));
    let bare = write(&without, fresh_seed, "without.csv")
        .is_some_and(|p| !consistent(explain, folder, &p, "without"));
    [again, fresh, foreign, bare]
}

fn set_against_the_told(row: &mut Row, case: &Case, made: &Realisation) {
    let told = told(case, made);
    for c in &row.score.covered {
        if let Some((_, width)) = told.widths.iter().find(|(name, w)| *name == c.name && *w > 0.0) {
            row.width_ratios.push(c.width / width);
        }
    }
    row.removed_ratio = row.score.removed.zip(told.removed).filter(|(_, t)| *t > 0.2).map(|(r, t)| r / t);
}

/// How cases are judged.
#[derive(Clone, Copy, Debug, Default)]
pub struct How {
    /// The closed loop is closed.
    pub close: bool,
    /// What was left out is taken out of the catalogue as well.
    pub removed: bool,
}

/// One case from its making to its score; `other` gives the recording of another case for the closed loop.
pub fn one(
    explain: &Explainer,
    case: &Case,
    other: &dyn Fn() -> Case,
    folder: &Path,
    how: How,
) -> std::io::Result<Row> {
    let mut truth = files::write(case, folder, case.seed)?;
    let out = folder.join("out");
    let mut without: Vec<&str> = vec![];
    if how.removed {
        for effect in truth["effects"].as_array_mut().into_iter().flatten() {
            let kind = effect["kind"].as_str().unwrap_or_default().to_string();
            effect["catalogued"] = false.into();
            effect["class"] = replacements(&kind, case.setting.scenario).into();
        }
        without.extend(case.left_out.iter().map(|l| l.effect.kind.as_str()));
    }
    let exit = explain(&folder.join("recording.csv"), &folder.join("model.toml"), &out, &without);
    let report = report(&out);
    let correction = columns(&out.join("correction.csv"));
    let made = case.realise(case.seed);
    let contribution = files::contribution(case, &made);
    let score = score(&truth, &report, correction.as_ref(), contribution.as_ref());
    let mut row = Row { name: case.name.clone(), score, exit, ..Row::default() };
    set_against_the_told(&mut row, case, &made);
    if how.close && row.score.detected && out.join("augmented.toml").exists() {
        row.closes = Some(closed_loop(explain, case, &other(), folder));
    }
    Ok(row)
}

/// All wishes, so many cases each, on two threads.
pub fn all(
    explain: &Explainer,
    wishes: &[Wish],
    seeds: std::ops::Range<u64>,
    strength: (f64, f64),
    how: How,
) -> Vec<Row> {
    let jobs: Vec<(&Wish, u64)> = wishes.iter().flat_map(|w| seeds.clone().map(move |s| (w, s))).collect();
    let next = AtomicUsize::new(0);
    let rows = Mutex::new(Vec::new());
    let work = || {
        while let Some((wish, seed)) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
            let case = made(wish, *seed, strength);
            let room = tempfile::tempdir().expect("a temporary folder");
            let folder = room.path().join(&case.name);
            let other = || made(wish, seed.wrapping_add(1), strength);
            let row = one(explain, &case, &other, &folder, how).expect("files can be written");
            rows.lock().expect("no thread panics holding it").push(row);
        }
    };
    std::thread::scope(|scope| {
        scope.spawn(work);
        scope.spawn(work);
    });
    let mut rows = rows.into_inner().expect("no thread panics holding it");
    rows.sort_by(|a: &Row, b| a.name.cmp(&b.name));
    rows
}
