//! The Monte Carlo study of the identification: mixes of noise of known truth against Cramér-Rao bounds, against a fit
//! that is told the true structure, and against the usual methods on the same records.
//!
//! `RECORDS=1000 SEED=1 cargo test --release --test identification_study long_study -- --ignored --nocapture`;
//! `MIX` picks mixes by a part of their name (`=N` by the whole name), `HOURS` lengths (`10,100`).

mod study_support;

use study_support::mixes::{Mix, mixes};
use study_support::run::study;
use study_support::table;
use study_support::tally::Tally;

fn setting<T: std::str::FromStr>(name: &str, default: T) -> T {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

fn chosen() -> Vec<Mix> {
    let wanted: String = setting("MIX", String::new());
    let fits = |mix: &Mix| match wanted.strip_prefix('=') {
        Some(name) => mix.name == name,
        None => mix.name.contains(&wanted),
    };
    mixes().into_iter().filter(fits).collect()
}

#[test]
#[ignore = "long study: every mix at two lengths"]
fn long_study() {
    let records = setting("RECORDS", 200usize);
    let seed = setting("SEED", 1u64);
    let hours: String = setting("HOURS", "10,100".to_owned());
    let mut tallies: Vec<Tally> = vec![];
    let mixes = chosen();
    assert!(!mixes.is_empty(), "no such mix");
    let mut misses = 0;
    table::head();
    for hours in hours.split(',').map(|h| h.trim().parse::<f64>().expect("HOURS: numbers")) {
        for (i, mix) in mixes.iter().enumerate() {
            let tally = study(mix, hours, records, seed * 1000 + i as u64);
            misses += table::print(&tally);
            tallies.push(tally);
        }
    }
    println!();
    table::false_head();
    misses += tallies.iter().map(table::print_false).sum::<usize>();
    println!();
    table::methods_head();
    let behind: usize = tallies.iter().map(table::print_methods).sum();
    println!("\nFigures that clearly miss a criterion: {misses}. Quantities another method estimates better: {behind}.");
    assert_eq!((misses, behind), (0, 0));
}
