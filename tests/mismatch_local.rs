//! Bursts, levels of noise and telegraph signals: nothing is claimed of noise that is as claimed, and what was put in is
//! found. Numbers of the full study are in docs/VALIDATION.md; `cargo test --release --test mismatch_local -- --ignored`
//! repeats it.

mod local_support;

use local_support::*;
use rayon::prelude::*;
use sagnac::mismatch::local::{bursts, level, telegraph};

/// Records in which each of the three claims something at p < `bound`.
fn false_finds(model: Model, samples: usize, records: u64, bound: f64) -> [u64; 3] {
    (0..records)
        .into_par_iter()
        .map(|seed| {
            let (problem, tried) = model.problem(samples, 1000 + seed, |_| {});
            let b = bursts(&problem, &tried).is_some_and(|b| b.p_value < bound);
            let l = level(&problem, &tried).iter().any(|l| l.p_value < bound);
            let t = telegraph(&problem, &tried).is_some_and(|t| t.p_value < bound);
            [b, l, t].map(u64::from)
        })
        .reduce(|| [0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]])
}

#[test]
fn noise_that_is_as_claimed_is_left_alone() {
    for model in [WHITE, FLICKER, WALK] {
        let found = false_finds(model, 6000, 40, 1e-3);
        assert_eq!(found, [0; 3], "{model:?}");
    }
}

#[test]
#[ignore = "long: the study of false finds"]
fn study_of_false_finds() {
    for (samples, records) in [(6000, 1000), (40_000, 300)] {
        for model in [WHITE, FLICKER, WALK] {
            for bound in [0.05, 1e-2, 1e-4] {
                let found = false_finds(model, samples, records, bound);
                println!("{model:?} {samples} x {records}: p < {bound}: {found:?}");
                if bound == 1e-4 {
                    assert!(found.iter().all(|f| *f as f64 <= 0.002 * records as f64 + 1.0));
                }
            }
        }
    }
}
