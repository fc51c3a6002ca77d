//! Bursts, levels of noise and telegraph signals: nothing is claimed of noise that is as claimed, and what was put in is
//! found. The studies are `cargo xtask validate local-false-finds local-effects`.

use sagnac::effect::Law;
use sagnac_studies::single_samples::false_finds::{below, p_values};
use sagnac_studies::single_samples::inject::{self, Group};
use sagnac_studies::single_samples::level::{Found, rate_level};
use sagnac_studies::single_samples::records::{FLICKER, WALK, WHITE, bursts, levels, telegraph};

#[test]
fn noise_that_is_as_claimed_is_left_alone() {
    for model in [WHITE, FLICKER, WALK] {
        assert_eq!(below(&p_values(model, 6000, 24, 1000), 1e-3), [0; 3], "{model:?}");
    }
}

#[test]
fn bursts_are_found_with_their_groups() {
    let sigma = WHITE.sigma();
    for seed in 0..4 {
        let truth = std::cell::RefCell::new(vec![]);
        let (problem, tried) = WHITE.problem(12_000, 40 + seed, |r| {
            *truth.borrow_mut() = inject::bursts(r, sigma, &[30; 4], 3.0, seed);
        });
        let found = bursts(&problem, &tried).unwrap();
        let truth = truth.into_inner();
        let inside = |i: &&usize| truth.iter().any(|g: &Group| g.holds(**i));
        assert_eq!(found.groups.len(), 4, "{found:?} {truth:?}");
        assert!(found.samples.iter().filter(inside).count() as f64 >= 0.85 * found.samples.len() as f64);
        assert!(found.p_value < 1e-10 && found.gain > 60.0 && (found.deviation - 3.0).abs() < 0.7);
        // A hump at the beginning and a wrong N are none.
        let (problem, tried) = WHITE.problem(6000, 40 + seed, |r| {
            r.iter_mut().enumerate().for_each(|(i, y)| *y += 10.0 * sigma * (-(i as f64) / 60.0).exp());
        });
        assert!(bursts(&problem, &tried).is_none_or(|b| b.p_value > 1e-4));
        let (problem, tried) = WHITE.problem(6000, 40 + seed, |r| inject::level(r, sigma, |_| 1.3, seed));
        assert!(bursts(&problem, &tried).is_none_or(|b| b.p_value > 1e-4));
    }
}

#[test]
fn steps_of_the_output_are_nothing_else() {
    let sigma = WHITE.sigma();
    for (seed, times) in [(0, 3.0), (1, 3.0), (2, 6.0), (3, 6.0)] {
        let lsb = times * sigma;
        let (problem, tried) = WHITE.problem(6000, 1000 + seed, |r| {
            r.iter_mut().for_each(|y| *y = ((*y + 7.3) / lsb).round() * lsb);
        });
        assert!(problem.spectra.grid_step_arcsec.is_some());
        assert!(bursts(&problem, &tried).is_none_or(|b| b.p_value > 1e-4));
        assert!(levels(&problem, &tried).is_empty());
        assert!(telegraph(&problem, &tried).is_none());
    }
}

#[test]
fn a_changing_level_is_found_with_its_ratio() {
    let sigma = WHITE.sigma();
    let mut held = 0;
    for seed in 0..6 {
        let step = |u: f64| if u > 0.37 { 1.2 } else { 1.0 };
        let (problem, tried) = WHITE.problem(12_000, 60 + seed, |r| inject::level(r, sigma, step, seed));
        let found = levels(&problem, &tried);
        let first = &found[0];
        held += u32::from(first.ci95[0] <= 1.2 && 1.2 <= first.ci95[1]);
        assert!(first.p_value < 1e-10 && first.gain > 40.0, "{} {}", first.p_value, first.gain);
        let square = first.profile.iter().map(|g| g * g).sum::<f64>() / 12_000.0;
        assert!((square - 1.0).abs() < 1e-9);
        assert!((first.places[0].from - 444.0).abs() < 60.0 && first.places[0].to > 1199.0);
    }
    assert!(held >= 5, "{held} of 6 intervals hold the ratio");
}

#[test]
fn a_level_that_follows_the_rate_is_told_from_time() {
    let mut held = 0;
    for seed in 0..6 {
        let Found { levels: found, bursts: outliers } = rate_level(seed, 1.5, 1);
        assert_eq!(found[0].effect.kind(), "noise_variance_rate");
        assert!(matches!(found[0].law, Law::Rate { .. }) && found[0].p_value < 1e-8);
        assert!(outliers > 1e-4);
        held += u32::from(found[0].ci95[0] < 1.5 && found[0].ci95[1] > 1.5);
    }
    assert!(held >= 5, "{held} of 6 intervals hold the ratio");
}

#[test]
fn two_levels_are_told_from_a_markov_process_with_their_spectrum() {
    let sigma = WHITE.sigma();
    for seed in 0..3 {
        let (problem, tried) = WHITE.problem(12_000, 90 + seed, |r| {
            inject::telegraph(r, sigma, 60.0, seed);
        });
        let found = telegraph(&problem, &tried).unwrap();
        let told = &found.detection;
        assert!(
            told.p_value < 1e-6 && told.gain > found.rival_gain + 14.0,
            "{} {}",
            told.gain,
            found.rival_gain
        );
        let value = |name: &str| told.reported(name).unwrap().value;
        assert!((value("amplitude_deg_h") / sigma - 1.0).abs() < 0.1, "{told:?}");
        assert!((value("mean_dwell_s") / 6.0 - 1.0).abs() < 0.3, "{told:?}");
        // Dwells of 60 are a correlation time of 30, levels 1 apart a deviation of ½.
        let (problem, tried) =
            WHITE.problem(12_000, 90 + seed, |r| inject::markov(r, 0.5 * sigma, 30.0, seed));
        assert!(telegraph(&problem, &tried).is_none_or(|t| t.detection.p_value > 1e-2));
    }
}
