//! The comparison of Russian and Allan values against simulated truth, in short. The studies are
//! `cargo xtask validate comparison published-devices`.

use sagnac::noise::composite::{Composite, Described, Line};
use sagnac::noise::prediction::{Agreement, WindowPrediction};
use sagnac::noise::simulate::{Setup, Simulator};
use sagnac::noise::windows::WindowMeans;
use sagnac_studies::comparison::{
    DEVICES, composites, damped, device, mixes, null_coverage, simulate, study, terms,
};

#[test]
fn predicted_covers_observed_in_simulated_units() {
    if !crate::support::long::wanted("predicted_covers_observed_in_simulated_units") {
        return;
    }
    for (i, (name, model)) in mixes().into_iter().enumerate().filter(|(_, m)| m.0 != "N+R") {
        let t = study(&model, 10.0, 2.0, 60, 100 + i as u64);
        // 95 % of 60 is 57 with a standard deviation of 1.7.
        assert!(t.consistent[0] >= 51, "{name}: {} of 60", t.consistent[0]);
        assert!(t.covered[0] >= 50 && t.covered[2] >= 50, "{name}: {:?}", t.covered);
        assert!(t.covered[1] >= 49, "{name}: {:?}", t.covered);
    }
}

/// With every parameter known, the scatter of s² alone must be covered, whatever the term.
#[test]
fn known_composites_are_covered() {
    let (hours, tau0_s, records) = (10.0, 1.0, 40);
    for (i, (name, model)) in composites().into_iter().enumerate() {
        let described = Described { model: model.clone(), ..Described::default() };
        let samples = (hours * 3600.0 / tau0_s) as usize;
        let mut inside = 0;
        for run in 0..records {
            let mut described = described.clone();
            let setup = Setup::for_record(7_000 * (i as u64 + 1) + run, tau0_s, samples as u64);
            let mut means = WindowMeans::new(100.0, tau0_s);
            let y = Simulator::of(&model, &setup).take(samples);
            means.push(&y, false);
            // A line is never known but from the record itself.
            for line in &mut described.model.lines {
                let turn = 2.0 * std::f64::consts::PI * line.frequency_hz * tau0_s;
                let sum = |f: fn(f64) -> f64| -> f64 {
                    y.iter().enumerate().map(|(i, v)| v * f(turn * (i as f64 + 0.5))).sum()
                };
                line.amplitude_deg_h = 2.0 / y.len() as f64 * sum(f64::cos).hypot(sum(f64::sin));
            }
            let w = means.finish();
            let p = WindowPrediction::of(&described, 100.0, w.n, tau0_s).expect("a prediction");
            inside += usize::from(p.agreement(w.standard_deviation) == Some(Agreement::Consistent));
        }
        // 95 % of 40 is 38 with a standard deviation of 1.4.
        assert!(inside >= 33, "{name}: {inside} of {records}");
    }
}

/// A term that the model lacks is reported: above, and below where the model has too much.
#[test]
fn a_model_that_is_wrong_is_told() {
    let gyro = simulate(&terms(0.0023, 0.0, 0.02, 0.0, 0.0), 10.0, 10.0, 5);
    let windows = gyro.windows(100.0).expect("windows");
    for (n, expected) in [(0.0023, Agreement::Above), (0.03, Agreement::Below)] {
        let described = Described { model: terms(n, 0.0, 0.0, 0.0, 0.0), ..Described::default() };
        let p = WindowPrediction::of(&described, 100.0, windows.n, 10.0).expect("a prediction");
        assert_eq!(p.agreement(windows.standard_deviation), Some(expected), "{n}");
    }
}

#[test]
fn the_null_holds_nine_units_in_ten() {
    // Of 40 units 36, with a standard deviation of 1.9.
    let inside = null_coverage(10.0, 10.0, 40, 900_000);
    assert!((30..=40).contains(&inside), "{inside} of 40");
}

/// The squares of two sizes, N and another part, at which E[s²] over 10 s and over 100 s are the printed ones.
fn both(target: [f64; 2], rest: [f64; 2], white: [f64; 2], other: [f64; 2]) -> [f64; 2] {
    let left = [target[0].powi(2) - rest[0], target[1].powi(2) - rest[1]];
    let determinant = white[0] * other[1] - white[1] * other[0];
    [
        (left[0] * other[1] - left[1] * other[0]) / determinant,
        (white[0] * left[1] - white[1] * left[0]) / determinant,
    ]
}

/// What the signal of each published device would have to hold for both its Russian values to follow.
#[test]
fn what_the_published_devices_would_have_to_hold() {
    let windows = |s: f64| (36_000.0 / s) as u64;
    let at = |m: &Composite, s: f64| m.expected_variance(s, windows(s), 1.0).expect("two windows");
    let pair = |m: &Composite| [at(m, 10.0), at(m, 100.0)];
    let white = pair(&terms(1.0, 0.0, 0.0, 0.0, 0.0));
    let parts: [(&str, Composite); 3] = [
        ("Q", terms(0.0, 0.0, 0.0, 0.0, 1.0)),
        ("wave", Composite { quasi_periodic: vec![damped(1.0, 0.04, 120.0)], ..Composite::default() }),
        // Whole periods in 100 s: nothing is left in σ100.
        (
            "line",
            Composite {
                lines: vec![Line { amplitude_deg_h: 1.0, frequency_hz: 0.04 }],
                ..Composite::default()
            },
        ),
    ];
    println!(
        "| device | σ100, N and floor alone, over printed | N for σ100 | N, Q | N, rms at 0.04 Hz (120 s) | N, line at 0.04 Hz |"
    );
    println!("|---|--:|--:|--:|--:|--:|");
    for (name, sigma, floor, arw, n) in DEVICES {
        let target = [60.0 * arw / 10f64.sqrt(), sigma];
        let flicker = pair(&device(0.0, floor));
        let alone = at(&device(n, floor), 100.0).sqrt() / sigma;
        let n_for_sigma = ((sigma * sigma - flicker[1]) / white[1]).sqrt();
        let mut cells = vec![];
        for (kind, part) in &parts {
            let [n2, size2] = both(target, flicker, white, pair(part));
            assert!(size2 > 0.0, "{name} needs no {kind}");
            // The solution gives both printed values back.
            for (i, value) in target.iter().enumerate() {
                let made = n2 * white[i] + size2 * pair(part)[i] + flicker[i];
                assert!((made.sqrt() / value - 1.0).abs() < 1e-9, "{name} {kind}");
            }
            cells.push(match n2 {
                n2 if n2 >= 0.0 => format!("{:.5}, {:.4}", n2.sqrt(), size2.sqrt()),
                _ => "none".to_owned(),
            });
        }
        println!("| {name} | {alone:.2} | {n_for_sigma:.5} | {} |", cells.join(" | "));
        // The largest σ100 that rounds to the printed one, with 8 % for the sampling error of ten hours, still allows the
        // printed N, except that of TIUS-500.
        let digits = if sigma < 0.002 { 5e-5 } else { 5e-4 };
        let largest = ((((sigma + digits) * 1.08).powi(2) - flicker[1]) / white[1]).sqrt();
        assert_eq!(largest < n, name == "TIUS-500", "{name}: {largest}");
    }
}
