//! Monte Carlo of the comparison of Russian and Allan values against simulated truth.

mod compare_support;

use compare_support::{from_env, quantile, share, simulate};
use rayon::prelude::*;
use sagnac::measurand::{GyroEvidence, Options, evaluate};
use sagnac::noise::composite::{Bandwidth, Composite, Damped, Described, Line};
use sagnac::noise::model::NoiseModel;
use sagnac::noise::prediction::{Agreement, WindowPrediction};
use sagnac::noise::russian::null_minimum;
use sagnac::noise::simulate::{Setup, Simulator};
use sagnac::noise::windows::WindowMeans;

fn terms(n: f64, b: f64, k: f64, r: f64, q: f64) -> Composite {
    NoiseModel { n, b, k, r, q }.into()
}

fn damped(rms_deg_h: f64, frequency_hz: f64, decay_time_s: f64) -> Damped {
    Damped { rms_deg_h, frequency_hz, decay_time_s }
}

/// Mixes of terms that the identification may claim.
fn mixes() -> Vec<(&'static str, Composite)> {
    vec![
        ("N", terms(0.0023, 0.0, 0.0, 0.0, 0.0)),
        ("N+B weak", terms(0.0023, 0.0011 / 0.664, 0.0, 0.0, 0.0)),
        ("N+B", terms(0.002, 0.006, 0.0, 0.0, 0.0)),
        ("N+K weak", terms(0.0023, 0.0, 0.0015, 0.0, 0.0)),
        ("N+K", terms(0.0023, 0.0, 0.006, 0.0, 0.0)),
        ("N+K strong", terms(0.0023, 0.0, 0.02, 0.0, 0.0)),
        ("N+B+K", terms(0.002, 0.004, 0.006, 0.0, 0.0)),
        ("N+R", terms(0.0023, 0.0, 0.0, 0.003, 0.0)),
        ("N+Q", terms(0.0023, 0.0, 0.0, 0.0, 0.05)),
    ]
}

/// The same with terms beside N, B, K, R and Q.
fn composites() -> Vec<(&'static str, Composite)> {
    let white = || terms(0.0023, 0.0, 0.0, 0.0, 0.0);
    vec![
        ("short Markov", Composite { markov: vec![damped(0.08, 0.0, 2.0)], ..white() }),
        ("long Markov", Composite { markov: vec![damped(0.008, 0.0, 900.0)], ..white() }),
        ("quasi-periodic", Composite { quasi_periodic: vec![damped(0.08, 0.04, 120.0)], ..white() }),
        ("line", Composite { lines: vec![Line { amplitude_deg_h: 0.03, frequency_hz: 0.0037 }], ..white() }),
        ("filter", Composite { bandwidth: Some(Bandwidth::FirstOrder { time_constant_s: 3.0 }), ..white() }),
    ]
}

/// Truths that the measurands estimate.
struct Truth {
    predicted: f64,
    ratio_bias: f64,
    ratio_arw: f64,
}

impl Truth {
    fn of(model: &Composite, gyro: &GyroEvidence) -> Truth {
        let sigma = |window_s: f64| {
            let n = gyro.windows(window_s).expect("windows").n;
            model.expected_variance(window_s, n, gyro.tau0_s).expect("two windows").sqrt()
        };
        let longest = 0.2 * gyro.usable_s();
        let read = gyro.octaves.iter().map(|p| p.point.m as f64 * gyro.tau0_s).filter(|t| *t <= longest);
        let least = read.map(|t| model.allan_variance(t, gyro.tau0_s).sqrt()).fold(f64::INFINITY, f64::min);
        Truth {
            predicted: sigma(100.0),
            ratio_bias: sigma(100.0) / least,
            ratio_arw: 10f64.sqrt() * sigma(10.0) / 60.0 / model.terms.n,
        }
    }
}

#[derive(Default)]
struct Tally {
    records: usize,
    consistent: [usize; 2],
    above: [usize; 2],
    below: [usize; 2],
    covered: [usize; 3],
}

fn study(model: &Composite, hours: f64, tau0_s: f64, records: u64, seed: u64) -> Tally {
    let unit = |run: u64| {
        let gyro = simulate(model, hours, tau0_s, seed * 1_000_003 + run);
        let agreements = [100.0, 10.0].map(|window_s| {
            let windows = gyro.windows(window_s).expect("windows");
            let described = &gyro.identification.described;
            let p = WindowPrediction::of(described, window_s, windows.n, tau0_s).expect("a model");
            p.agreement(windows.standard_deviation).expect("an interval")
        });
        let truth = Truth::of(model, &gyro);
        let options = Options { remove_earth_rate: false };
        let covered = [
            ("russian_drift_100s_predicted", truth.predicted),
            ("ratio_russian_to_allan_bias", truth.ratio_bias),
            ("ratio_russian_to_allan_arw", truth.ratio_arw),
        ]
        .map(|(id, truth)| {
            // A record that does not claim N has no ratio to it, and does not count as covered.
            let interval = evaluate(id, &gyro, &options).expect("an estimate").interval95();
            interval.is_some_and(|i| i.low <= truth && truth <= i.high)
        });
        (agreements, covered)
    };
    let mut tally = Tally { records: records as usize, ..Tally::default() };
    for (agreements, covered) in (0..records).into_par_iter().map(unit).collect::<Vec<_>>() {
        for (i, agreement) in agreements.into_iter().enumerate() {
            match agreement {
                Agreement::Consistent => tally.consistent[i] += 1,
                Agreement::Above => tally.above[i] += 1,
                Agreement::Below => tally.below[i] += 1,
            }
        }
        for (sum, covered) in tally.covered.iter_mut().zip(covered) {
            *sum += usize::from(covered);
        }
    }
    tally
}

/// `RECORDS=1000 cargo test --release --test compare_study predicted_covers -- --ignored --nocapture`
#[test]
#[ignore = "long study: every mix at two lengths"]
fn predicted_covers_observed_in_every_mix() {
    let records = from_env("RECORDS", 1000);
    println!(
        "| mix | h | σ100 consistent | above | below | σ10 consistent | predicted covers | ratio to minimum covers | ratio of ARW covers |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|--:|--:|");
    let mut worst = (1.0f64, 0.0f64);
    for (hours, tau0_s) in [(10.0, from_env("TAU0", 2) as f64), (100.0, 10.0)] {
        for (i, (name, model)) in mixes().into_iter().enumerate() {
            let t = study(&model, hours, tau0_s, records, from_env("SEED", 0) + i as u64 + 1);
            let of = |n: usize| share(n, t.records);
            println!(
                "| {name} | {hours} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} |",
                of(t.consistent[0]),
                of(t.above[0]),
                of(t.below[0]),
                of(t.consistent[1]),
                of(t.covered[0]),
                of(t.covered[1]),
                of(t.covered[2]),
            );
            worst = (worst.0.min(of(t.consistent[0])), worst.1.max(of(t.consistent[0])));
        }
    }
    // Four standard deviations of a share of 0.95 about the wanted 93 to 97 %.
    let four = 4.0 * (0.95 * 0.05 / records as f64).sqrt();
    assert!(worst.0 > 0.93 - four && worst.1 < 0.97 + four, "{worst:?}");
}

/// `RECORDS=200 cargo test --release --test compare_study identified_composites -- --ignored --nocapture`
#[test]
#[ignore = "long study: Markov noise, waves and filters, identified from each record"]
fn identified_composites_are_covered() {
    let records = from_env("RECORDS", 200);
    println!(
        "| mix | σ100 consistent | above | below | σ10 consistent | predicted covers | ratio to minimum covers |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|");
    let mut worst = (1.0f64, 0.0f64);
    // Lines are found before the identification and handed to it, which these records do not go through.
    for (i, (name, model)) in composites().into_iter().enumerate().filter(|(_, (_, m))| m.lines.is_empty()) {
        let t = study(&model, 10.0, from_env("TAU0", 1) as f64, records, from_env("SEED", 40) + i as u64);
        let of = |n: usize| share(n, t.records);
        println!(
            "| {name} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} |",
            of(t.consistent[0]),
            of(t.above[0]),
            of(t.below[0]),
            of(t.consistent[1]),
            of(t.covered[0]),
            of(t.covered[1]),
        );
        worst = (worst.0.min(of(t.consistent[0])), worst.1.max(of(t.consistent[0])));
    }
    let four = 4.0 * (0.95 * 0.05 / records as f64).sqrt();
    assert!(worst.0 > 0.93 - four && worst.1 < 0.97 + four, "{worst:?}");
}

#[test]
fn predicted_covers_observed_in_simulated_units() {
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
    let (hours, tau0_s, records) = (10.0, 1.0, 200);
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
        // 95 % of 200 is 190 with a standard deviation of 3.1.
        assert!(inside >= 178, "{name}: {inside} of {records}");
    }
}

/// A term that the model lacks is told: above, and below where the model has too much.
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

/// Share of units with angle random walk alone whose ratio lies within the 5 to 95 % of the null.
fn null_coverage(hours: f64, tau0_s: f64, records: u64) -> f64 {
    let model = terms(0.0023, 0.0, 0.0, 0.0, 0.0);
    let within = |run: &u64| {
        let gyro = simulate(&model, hours, tau0_s, 900_000 + run);
        let longest = 0.2 * gyro.usable_s();
        let read: Vec<_> = gyro
            .octaves
            .iter()
            .filter(|p| p.point.m as f64 * tau0_s <= longest && p.point.deviation > 0.0)
            .collect();
        let least = read.iter().map(|p| p.point.deviation).fold(f64::INFINITY, f64::min);
        let largest = read.last().expect("an octave").point.m as f64 * tau0_s;
        let null = null_minimum(1.0, gyro.usable_s(), largest, 100.0).expect("a null").ratio;
        let ratio = gyro.drift_100s().expect("a drift") / least;
        null[0] <= ratio && ratio <= null[2]
    };
    share((0..records).into_par_iter().filter(within).count(), records as usize)
}

#[test]
fn the_null_holds_nine_units_in_ten() {
    let inside = null_coverage(10.0, 10.0, 200);
    // Standard deviation 0.021.
    assert!((inside - 0.9).abs() < 0.07, "{inside}");
}

/// `RECORDS=1000 cargo test --release --test compare_study null_at -- --ignored --nocapture`
#[test]
#[ignore = "long study: the null at several lengths"]
fn null_at_several_lengths() {
    for (hours, tau0_s) in [(3.0, 1.0), (10.0, 5.0), (24.0, 10.0), (100.0, 10.0)] {
        let inside = null_coverage(hours, tau0_s, from_env("RECORDS", 1000));
        println!("| {hours} h | {inside:.3} |");
        assert!((inside - 0.9).abs() < 0.05, "{hours} h: {inside}");
    }
}

/// Devices of the published Table 2: σ100, Allan floor, ARW from 10 s, N.
const DEVICES: [(&str, f64, f64, f64, f64); 5] = [
    ("OIUS-200", 0.048, 0.006, 0.0092, 0.0081),
    ("TIUS-500", 0.032, 0.0025, 0.010, 0.0068),
    ("OIUS-501", 0.014, 0.0011, 0.0065, 0.0023),
    ("OIUS-1000", 0.003, 0.0006, 0.0008, 0.00055),
    ("OIUS-2000", 0.0015, 0.00024, 0.00028, 0.00025),
];

/// What a device would be with its Allan values: flicker with the printed floor.
fn device(n: f64, floor: f64) -> Composite {
    terms(n, floor / 0.664_282_47, 0.0, 0.0, 0.0)
}

/// `RECORDS=1000 cargo test --release --test compare_study table_2_simulated -- --ignored --nocapture`
#[test]
#[ignore = "long study: the published devices simulated from their Allan values"]
fn table_2_simulated() {
    let records = from_env("RECORDS", 1000);
    println!(
        "| device | h | σ100 printed | σ100 2.5 % / 50 % / 97.5 % | ARW 10 s printed | 2.5 % / 50 % / 97.5 % | σ100/min 5 % / 50 % / 95 % | B claimed |"
    );
    println!("|---|--:|--:|---|--:|---|---|--:|");
    for (name, sigma, floor, arw, n) in DEVICES {
        for (hours, tau0_s) in [(10.0, 5.0), (100.0, 10.0)] {
            let (mut s100, mut walks, mut ratios) = (vec![], vec![], vec![]);
            let mut claimed = 0;
            for run in 0..records {
                let gyro = simulate(&device(n, floor), hours, tau0_s, 31_000_000 + run);
                let s = gyro.drift_100s().expect("a drift");
                let ten = gyro.windows(10.0).expect("windows").standard_deviation;
                let longest = 0.2 * gyro.usable_s();
                let read = gyro.octaves.iter().filter(|p| p.point.m as f64 * tau0_s <= longest);
                let least =
                    read.map(|p| p.point.deviation).filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
                s100.push(s);
                walks.push(10f64.sqrt() * ten / 60.0);
                ratios.push(s / least);
                claimed += usize::from(gyro.identification.bias_instability.value.is_some());
            }
            let three = |v: &mut Vec<f64>, p: [f64; 3]| p.map(|p| quantile(v, p));
            let [a, b, c] = three(&mut s100, [0.025, 0.5, 0.975]);
            let [d, e, f] = three(&mut walks, [0.025, 0.5, 0.975]);
            let [g, h, i] = three(&mut ratios, [0.05, 0.5, 0.95]);
            println!(
                "| {name} | {hours} | {sigma} | {a:.5} / {b:.5} / {c:.5} | {arw} | {d:.6} / {e:.6} / {f:.6} | {g:.1} / {h:.1} / {i:.1} | {:.1} % |",
                100.0 * share(claimed, records as usize)
            );
        }
    }
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
