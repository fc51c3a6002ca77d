//! Sizes that an explanation says would have been noticed, in short. The study is `cargo xtask validate noticeable-sizes`.

use sagnac_studies::noticeable::bench::Place;
use sagnac_studies::noticeable::{AT_REST, Dose, ON_TABLE, run};
use sagnac_studies::study::{Row, Verdict};

/// Rows of a kind that are not as asked by more than chance.
fn misses(rows: &[Row]) -> Vec<String> {
    let missed = rows.iter().filter(|r| r.verdict == Verdict::Misses);
    missed.map(|r| format!("{}, {}: {:?}", r.quantity, r.claim, r.measured)).collect()
}

#[test]
fn an_effect_of_the_stated_size_is_noticed() {
    if !crate::support::long::wanted("an_effect_of_the_stated_size_is_noticed") {
        return;
    }
    let mut rows = run(Place::AtRest, &["temp_rate", "rate_ramp", "excess_arw"], &[Dose::Whole], 6, 1);
    rows.extend(run(Place::OnTable, &["sf_error"], &[Dose::Whole], 6, 1));
    assert_eq!(misses(&rows), Vec::<String>::new());
    let stated = rows.iter().filter(|r| r.claim == "a size is stated");
    assert!(stated.clone().count() == 4 && stated.clone().all(|r| r.measured == Some(1.0)));
}

/// `KINDS=line,bias_step RECORDS=40 SEED=1`.
#[test]
#[ignore = "a study: prints shares"]
fn shares() {
    let given = |name: &str, otherwise: &str| std::env::var(name).unwrap_or_else(|_| otherwise.to_owned());
    let kinds = given("KINDS", &AT_REST.join(","));
    let number = |name: &str, otherwise: &str| given(name, otherwise).parse().expect("a number");
    let (records, seed) = (number("RECORDS", "4"), number("SEED", "1"));
    for place in [Place::AtRest, Place::OnTable] {
        let known: &[&str] = if place == Place::AtRest { &AT_REST } else { &ON_TABLE };
        let kinds: Vec<&str> = kinds.split(',').filter(|k| known.contains(k)).collect();
        for row in run(place, &kinds, &Dose::ALL, records, seed) {
            println!("{}, {}: {:?} of {} {:?}", row.quantity, row.claim, row.measured, row.of, row.interval);
        }
    }
}
