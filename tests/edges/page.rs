//! Keeps the results of the full study and writes the tables in `docs/validation/edges.md`.

use crate::case::{Case, Family, Standing};
use crate::study::Tally;
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Place of the misses, at the top of the page.
const MISSES: (&str, &str) =
    ("<!-- edge misses: begin; written by the study -->", "<!-- edge misses: end -->");
/// Place of the whole table.
const WHOLE: (&str, &str) = ("<!-- edges: begin; written by the study -->", "<!-- edges: end -->");

/// One case with its tallies, as it is kept.
#[derive(Serialize, Deserialize)]
struct Kept {
    case: String,
    edges: Vec<crate::case::Edge>,
    tallies: Vec<Tally>,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn file(family: &Family) -> PathBuf {
    root().join("docs/validation").join(format!("edges-{}.json", family.name))
}

/// Keeps the results of a family.
pub fn keep(family: &Family, results: &[(&Case, Vec<Tally>)]) {
    let kept: Vec<Kept> = results
        .iter()
        .map(|(case, tallies)| Kept {
            case: case.name.to_string(),
            edges: case.edges.to_vec(),
            tallies: tallies.clone(),
        })
        .collect();
    let path = file(family);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, serde_json::to_string_pretty(&kept).unwrap() + "\n").unwrap();
}

/// Writes the table of every family that has been kept: the misses first, then everything.
pub fn write(families: &[&Family]) {
    let mut missed = String::new();
    let mut whole = String::new();
    for family in families {
        let Ok(text) = std::fs::read_to_string(file(family)) else { continue };
        let kept: Vec<Kept> = serde_json::from_str(&text).unwrap();
        let _ = write!(whole, "\n### {}\n\n{HEAD}", family.name);
        for case in &kept {
            for tally in &case.tallies {
                whole += &row(case, tally);
                missed += &misses(case, tally);
            }
        }
    }
    let missed =
        if missed.is_empty() { "Nothing misses.\n".to_string() } else { format!("{MISSES_HEAD}{missed}") };
    let page = root().join("docs/validation/edges.md");
    let text = std::fs::read_to_string(&page).unwrap();
    let text = placed(&text, MISSES, &format!("\n{missed}\n"));
    std::fs::write(page, placed(&text, WHOLE, &format!("{whole}\n"))).unwrap();
}

/// A page with what stands between two marks replaced.
fn placed(page: &str, (begin, end): (&str, &str), what: &str) -> String {
    let (before, rest) = page.split_once(begin).unwrap_or_else(|| panic!("the page lacks {begin}"));
    let (_, after) = rest.split_once(end).unwrap_or_else(|| panic!("the page lacks {end}"));
    format!("{before}{begin}\n{what}{end}{after}")
}

const HEAD: &str = "| measurand | case | records | with a value | bounded | coverage | width over oracle | units | passed | failed | missed |\n\
                    |---|---|---|---|---|---|---|---|---|---|---|\n";

const MISSES_HEAD: &str =
    "| claim | asked | measured | verdict | command | commit |\n|---|---|---|---|---|---|\n";

/// A line for each miss. Command and commit are those of the head of the page.
fn misses(case: &Kept, tally: &Tally) -> String {
    let mut lines = String::new();
    for measured in tally.misses() {
        let (quantity, asked) = match measured.split(' ').next() {
            Some("coverage") => ("95 % intervals hold", "0.93 to 0.97"),
            Some("width") => ("width over that of the oracle", "at most 1.5"),
            _ => ("wrong decisions at the limit", "at most 0.05"),
        };
        let _ = writeln!(
            lines,
            "| `{}`, {}: {quantity} | {asked} | {measured}, of {} records | **misses** | as above | as above |",
            tally.id, case.case, tally.records
        );
    }
    lines
}

fn row(case: &Kept, tally: &Tally) -> String {
    let share = |count: usize| format!("{:.3}", count as f64 / tally.records.max(1) as f64);
    let coverage =
        if tally.given() == 0 { "withheld".to_string() } else { format!("{:.3}", tally.coverage()) };
    let width = tally.width.map_or_else(|| "–".to_string(), |w| format!("{w:.2}"));
    let (units, passed, failed) = match tally.standing {
        Standing::Unlimited => ("–", "–".to_string(), "–".to_string()),
        Standing::Good => ("good", share(tally.passed), share(tally.failed)),
        Standing::AtLimit => ("at the limit", share(tally.passed), share(tally.failed)),
        Standing::Bad => ("bad", share(tally.passed), share(tally.failed)),
    };
    format!(
        "| {} | {} | {} | {} | {} | {coverage} | {width} | {units} | {passed} | {failed} | {} |\n",
        tally.id,
        case.case,
        tally.records,
        share(tally.stated),
        share(tally.bounded),
        tally.misses().join(", "),
    )
}
