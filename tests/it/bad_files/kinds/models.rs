//! Broken models: every problem is reported at its place, and nothing else.

use crate::support::corpus::{cases, each_problem_at_its_place};
use sagnac::config::model;
use sagnac::i18n::Lang;

#[test]
fn broken_models_are_reported_at_their_place() {
    let read = |file: &std::path::Path| model::load(file).err().unwrap_or_default().list;
    let count = each_problem_at_its_place("model", read);
    assert!(count >= 22, "{count} cases");
}

#[test]
fn broken_models_are_told_of_in_russian() {
    let mut seen = 0;
    for file in cases("model", "toml") {
        for problem in model::load(&file).err().unwrap_or_default().list {
            let said = problem.say(Lang::Ru);
            seen += 1;
            assert!(said.starts_with("ошибка: ") && !said.contains('{'), "{said}");
        }
    }
    assert!(seen >= 22, "{seen}");
}

#[test]
fn long_lists_in_one_line_are_no_deep_nesting() {
    let numbers: Vec<String> = (0..5000).map(|i| format!("{}.5", i)).collect();
    let list = numbers.join(", ");
    let text = format!(
        "[recording]\nsample_rate_hz = 10\n[[driver]]\ncolumn = \"temp_degC\"\ntime_s = [{list}]\nvalue = [{list}]\n"
    );
    let read = model::parse("m", text.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(read.drivers[0].value.len(), 5000);
    let deep = format!("[recording]\nsample_rate_hz = 10\nx = {}1{}\n", "[".repeat(5000), "]".repeat(5000));
    assert!(model::parse("m", deep.as_bytes()).is_err());
    let dotted = format!("{}a = 1\n", "1.".repeat(5000));
    assert!(model::parse("m", dotted.as_bytes()).is_err());
}
