//! Pages of `docs/validation/` that studies write: what misses first. Pages kept by hand stand beside them.

use crate::results::Results;
use crate::study::{Row, Study, Verdict};
use std::fmt::Write;

/// The page of one study.
pub fn study_page(study: &Study, results: &Results) -> String {
    let mut page = format!("# {}\n\n{}\n\n{}\n\n", study.title, GENERATED, study.method);
    let _ = writeln!(
        page,
        "`{}`, code of commit {}, {} of {} cases, {} records each.\n",
        results.command,
        results.commit,
        results.cases.len(),
        (study.cases)().len(),
        results.records
    );
    let mut lines: Vec<(&str, &Row)> =
        results.cases.iter().flat_map(|c| c.rows.iter().map(|r| (c.name.as_str(), r))).collect();
    // Stable: within a verdict the order of the cases.
    lines.sort_by_key(|(_, row)| row.verdict);
    page += "| case | quantity | claim | asked | measured | Monte Carlo 95 % | records | verdict |\n\
             |---|---|---|---|--:|---|--:|---|\n";
    for (case, row) in lines {
        let _ = writeln!(
            page,
            "| {case} | {} | {} | {} | {} | {} | {} | {} |",
            row.quantity,
            row.claim,
            row.asked,
            measured(row),
            interval(row),
            row.of,
            row.verdict.name()
        );
    }
    page
}

/// The summary: every miss, then a line for each claim of each study.
///
/// It holds the latest results of each study with the commit of their build, so that no miss is lost when another study is run.
pub fn summary(studies: &[&Study], results: &[Results]) -> String {
    let mut page = format!("# Studies of simulated units\n\n{GENERATED}\n\n{INTRODUCTION}\n\n## Misses\n\n");
    let measured: Vec<(&Study, &Results)> =
        studies.iter().filter_map(|s| Some((*s, results.iter().find(|r| r.study == s.id)?))).collect();
    page += &misses(&measured);
    page += "\n## Every claim\n\n\
             | study | claim | asked | worst measured | lines | miss | unresolved | verdict | command | commit |\n\
             |---|---|---|--:|--:|--:|--:|---|---|---|\n";
    for (study, results) in &measured {
        page += &claims(study, results);
    }
    let absent: Vec<&&Study> =
        studies.iter().filter(|s| !measured.iter().any(|(m, _)| m.id == s.id)).collect();
    if !absent.is_empty() {
        let _ = writeln!(page, "\n## Without results here\n");
        for study in absent {
            let _ = writeln!(page, "- {}: `cargo xtask validate {}`", study.title, study.id);
        }
    }
    page
}

fn misses(studies: &[(&Study, &Results)]) -> String {
    let mut text = String::new();
    for (study, results) in studies {
        for case in &results.cases {
            for row in case.rows.iter().filter(|r| r.verdict == Verdict::Misses) {
                let _ = writeln!(
                    text,
                    "| [{}]({}.md) | {}, {}: {} | {} | {} | {} |",
                    study.title,
                    study.id,
                    case.name,
                    row.quantity,
                    row.claim,
                    row.asked,
                    measured(row),
                    interval(row)
                );
            }
        }
    }
    if text.is_empty() {
        let none = if studies.is_empty() { "No study was run." } else { "No line misses." };
        return format!("{none}\n");
    }
    format!("| study | claim | asked | measured | Monte Carlo 95 % |\n|---|---|---|--:|---|\n{text}")
}

/// A line for each claim of a study, in the order in which they appear.
fn claims(study: &Study, results: &Results) -> String {
    let rows: Vec<&Row> = results.cases.iter().flat_map(|c| &c.rows).collect();
    let mut seen: Vec<(&str, String)> = vec![];
    for row in &rows {
        let key = (row.claim.as_str(), row.asked.to_string());
        if !seen.contains(&key) {
            seen.push(key);
        }
    }
    let mut text = String::new();
    for (claim, asked) in seen {
        let group: Vec<&&Row> =
            rows.iter().filter(|r| r.claim == claim && r.asked.to_string() == asked).collect();
        let count = |verdict| group.iter().filter(|r| r.verdict == verdict).count();
        let verdict = group.iter().map(|r| r.verdict).min().unwrap_or(Verdict::Reported);
        let worst = group.iter().copied().max_by(|a, b| a.shortfall().total_cmp(&b.shortfall()));
        let _ = writeln!(
            text,
            "| [{}]({}.md) | {claim} | {asked} | {} | {} | {} | {} | {} | `{}` | {} |",
            study.title,
            study.id,
            worst.map_or_else(String::new, |r| measured(r)),
            group.len(),
            count(Verdict::Misses),
            count(Verdict::Unresolved),
            verdict.name(),
            results.command,
            results.commit
        );
    }
    text
}

fn measured(row: &Row) -> String {
    row.measured.map_or_else(|| "none".to_owned(), |v| format!("{v:.3}"))
}

fn interval(row: &Row) -> String {
    row.interval.map_or_else(|| "–".to_owned(), |[low, high]| format!("{low:.3} to {high:.3}"))
}

/// Stands on every page that a study writes; a page without it is kept by hand and never overwritten.
pub const GENERATED: &str = "<!-- Written by `cargo xtask validate`; edits are lost. -->";

const INTRODUCTION: &str = "Monte Carlo studies of simulated units whose truth is known. *Misses*: the whole 95 % interval of \
the Monte Carlo lies outside what is asked. *Unresolved*: the number lies outside, but so few records do not decide. A line \
names its command and the commit of the build; run again with that build, the command gives the same numbers. What was measured otherwise \
stands on the pages of the [summary](README.md).";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::CaseResult;
    use crate::study::Asked;

    static STUDY: Study =
        Study { id: "one", title: "One", method: "Simulated.", records: 10, cases: || vec![] };
    static OTHER: Study =
        Study { id: "other", title: "Other", method: "Simulated.", records: 10, cases: || vec![] };

    fn results() -> Results {
        let rows = vec![
            Row::share("a", "95 % interval holds the truth", Asked::AtLeast(0.93), 950, 1000),
            Row::share("b", "95 % interval holds the truth", Asked::AtLeast(0.93), 800, 1000),
        ];
        let mut results = Results::new(&STUDY, "abc", 1000, 1);
        results.cases.push(CaseResult { name: "case".into(), elapsed_s: Some(1.0), rows });
        results
    }

    #[test]
    fn what_misses_stands_first() {
        let page = study_page(&STUDY, &results());
        assert!(page.find("| case | b |").unwrap() < page.find("| case | a |").unwrap(), "{page}");
        let summary = summary(&[&STUDY, &OTHER], &[results()]);
        let (misses, all) = summary.split_once("## Every claim").unwrap();
        assert!(misses.contains("| case, b: ") && !misses.contains("case, a: "), "{misses}");
        assert!(all.contains("| 0.800 | 2 | 1 | 0 | **misses** |"), "{all}");
        assert!(all.contains("- Other: `cargo xtask validate other`"), "{all}");
    }

    #[test]
    fn the_summary_names_the_build_of_each_study() {
        let other = Results { cases: results().cases, ..Results::new(&OTHER, "def", 10, 1) };
        let summary = summary(&[&STUDY, &OTHER], &[results(), other]);
        let commits =
            ["abc", "def"].map(|c| summary.lines().filter(|l| l.ends_with(&format!("| {c} |"))).count());
        assert_eq!(commits, [1, 1], "{summary}");
    }
}
