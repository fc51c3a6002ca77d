//! Broken layouts of raw binary records: every problem is reported at its place, and nothing else.

use crate::support::corpus::each_problem_at_its_place;
use sagnac::config::layout;

#[test]
fn broken_layouts_are_reported_at_their_place() {
    let count = each_problem_at_its_place("layout", |file| layout::load(file).unwrap_err().list);
    assert!(count >= 28, "{count} cases");
}
