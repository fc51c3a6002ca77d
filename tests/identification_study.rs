//! The Monte Carlo study of the identification: mixes of noise of known truth against Cramér-Rao bounds, against a fit
//! that is told the true structure, and against the usual methods on the same records.
//!
//! `RECORDS=1000 SEED=1 cargo test --release --test identification_study long_study -- --ignored --nocapture`;
//! `MIX` picks mixes by a part of their name (`=N` by the whole name), `HOURS` lengths (`10,100`).

mod study_support;

use study_support::generator::Generator;
use study_support::mixes::{Mix, TAU0_S, mixes};
use study_support::run::{simulated, study};
use study_support::table;
use study_support::tally::Tally;
use study_support::whittle::Layout;

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
    println!(
        "\nFigures that clearly miss a criterion: {misses}. Quantities another method estimates better: {behind}."
    );
    assert_eq!((misses, behind), (0, 0));
}

/// Power over its expectation, by bands, of records of a mix from one source.
fn departures(
    mix: &Mix,
    samples: usize,
    records: u64,
    source: &dyn Fn(u64) -> Vec<f64>,
) -> Vec<(usize, f64)> {
    let layout = Layout::new(samples, &mix.truth);
    let mut sums: Vec<(f64, f64)> = vec![];
    for seed in 0..records {
        let bands = layout.whitened(&layout.data(&source(seed)), &mix.truth, 30.0);
        sums.resize(bands.len(), (0.0, 0.0));
        for (sum, (ratio, dof)) in sums.iter_mut().zip(bands) {
            *sum = (sum.0 + ratio * dof, sum.1 + dof);
        }
    }
    // Normal scores: a mean of χ² of so many degrees of freedom.
    sums.into_iter().map(|(sum, dof)| (sum / dof - 1.0) / (2.0 / dof).sqrt()).enumerate().collect()
}

#[test]
fn both_sources_of_records_have_the_spectrum_of_the_mix() {
    let samples = 12_000;
    for mix in mixes() {
        let generator = Generator::new(&mix, samples, TAU0_S);
        let own = departures(&mix, samples, 24, &|seed| simulated(&mix, samples, 4_000 + seed));
        let other = departures(&mix, samples, 24, &|seed| generator.record(4_000 + seed, 0.37));
        for (source, scores) in [("simulator", own), ("generator", other)] {
            let worst = scores.iter().copied().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).expect("bands");
            assert!(
                worst.1.abs() < 4.5,
                "{} {source}: band {} of {} by {:.1} σ",
                mix.name,
                worst.0,
                scores.len(),
                worst.1
            );
            let square = scores.iter().map(|s| s.1 * s.1).sum::<f64>() / scores.len() as f64;
            let slack = 4.5 * (2.0 / scores.len() as f64).sqrt();
            assert!((square - 1.0).abs() < slack, "{} {source}: {square} ± {slack}", mix.name);
        }
    }
}
