//! What the tallies of edges call wrong.

use sagnac_studies::edges::case::{LimitKey, Standing, Truth};
use sagnac_studies::edges::tally::Tally;
use sagnac_studies::study;

fn tally(held: usize, of: usize) -> Tally {
    Tally {
        id: "x".into(),
        records: of,
        stated: of,
        bounded: 0,
        held,
        standing: Standing::AtLimit,
        passed: 0,
        failed: 0,
        width: Some(1.0),
    }
}

#[test]
fn a_short_study_finds_what_no_accident_explains() {
    assert_eq!(tally(6, 8).certainly_wrong(), None);
    assert!(tally(3, 8).certainly_wrong().is_some());
    assert!(Tally { passed: 5, ..tally(8, 8) }.certainly_wrong().is_some());
    assert_eq!(Tally { passed: 8, standing: Standing::Good, ..tally(8, 8) }.certainly_wrong(), None);
}

#[test]
fn a_long_study_is_held_to_what_is_asked() {
    let misses = |t: Tally| -> Vec<String> {
        t.rows().into_iter().filter(|r| r.verdict == study::Verdict::Misses).map(|r| r.claim).collect()
    };
    let holds = "95 % interval or bound holds the truth";
    assert!(misses(tally(950, 1000)).is_empty());
    assert_eq!(misses(tally(900, 1000)), [holds]);
    assert_eq!(misses(tally(995, 1000)), [holds]);
    assert!(misses(Tally { bounded: 1, ..tally(995, 1000) }).is_empty());
    assert_eq!(misses(Tally { failed: 120, ..tally(950, 1000) }), ["a unit at its limit fails"]);
    assert_eq!(misses(Tally { passed: 120, ..tally(950, 1000) }), ["a unit at its limit passes"]);
    let wide = Tally { width: Some(2.0), ..tally(950, 1000) };
    assert_eq!(misses(wide), ["median width over that of an oracle that knows all else"]);
}

#[test]
fn a_truth_stands_where_its_limit_puts_it() {
    let standing = |value, key, limit| Truth::new("x", value).limited(key, limit).standing();
    assert_eq!(standing(-2.0, LimitKey::MaxAbs, 2.0), Standing::AtLimit);
    assert_eq!(standing(-2.0, LimitKey::MaxAbs, 2.1), Standing::Good);
    assert_eq!(standing(1.0, LimitKey::Min, 2.0), Standing::Bad);
    assert_eq!(Truth::new("x", 1.0).oracle(0.1).on("y").standing(), Standing::Unlimited);
    assert_eq!(standing(1.0, LimitKey::Max, 0.5), Standing::Bad);
}
