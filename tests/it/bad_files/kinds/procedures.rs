//! Broken procedures and limits files: every problem is reported at its place, and nothing else.

use crate::support::corpus::{cases, each_problem_at_its_place, problems};
use sagnac::config::procedure::{Problem, parse_limits, parse_procedure};
use std::path::Path;

fn name(file: &Path) -> String {
    file.file_name().unwrap().to_string_lossy().into_owned()
}

fn of_procedure(file: &Path) -> Vec<Problem> {
    problems(parse_procedure(&name(file), &std::fs::read(file).unwrap()))
}

fn of_limits(file: &Path) -> Vec<Problem> {
    problems(parse_limits(&name(file), &std::fs::read(file).unwrap()))
}

#[test]
fn broken_procedures_are_reported_at_their_place() {
    let count = each_problem_at_its_place("procedure", of_procedure);
    assert!(count >= 70, "{count} cases");
}

#[test]
fn broken_limits_are_reported_at_their_place() {
    let count = each_problem_at_its_place("limits", of_limits);
    assert!(count >= 19, "{count} cases");
}

#[test]
fn every_report_of_the_corpus_shows_file_line_and_help_in_full() {
    for file in cases("procedure", "toml") {
        for problem in of_procedure(&file) {
            let shown = problem.to_string();
            let place = format!("--> {}:{}:{}", name(&file), problem.line, problem.column);
            assert!(shown.contains(&place), "{shown}");
            let line = shown.lines().find(|l| l.starts_with(&format!("{} | ", problem.line))).unwrap();
            let carets = shown.lines().find(|l| l.trim_start_matches([' ', '|']).starts_with('^')).unwrap();
            let (from, width) = (
                carets.chars().position(|c| c == '^').unwrap(),
                carets.chars().filter(|c| *c == '^').count(),
            );
            let underlined: String = line.chars().skip(from).take(width).collect();
            assert!(problem.token.is_empty() || underlined == problem.token, "{shown}");
        }
    }
}
