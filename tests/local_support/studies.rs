//! Long studies: false finds, what other effects are taken for, what is found of what was put in.

use super::local_support::*;
use super::{below, p_values, rate_level};
use rayon::prelude::*;
use sagnac::effect::{Law, Reported};

/// What each of the three claims at p < 1e-4 in 40 records with something else in them.
fn claims(model: Model, samples: usize, change: impl Fn(&mut [f64], u64) + Sync) -> [u64; 3] {
    (0..40u64)
        .into_par_iter()
        .map(|seed| {
            let (problem, tried) = model.problem(samples, 5000 + seed, |rate| change(rate, seed));
            let b = bursts(&problem, &tried).is_some_and(|b| b.p_value < 1e-4);
            let l = levels(&problem, &tried).iter().any(|l| l.p_value < 1e-4);
            let t = telegraph(&problem, &tried).is_some_and(|t| t.detection.p_value < 1e-4);
            [b, l, t].map(u64::from)
        })
        .reduce(|| [0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]])
}

#[test]
#[ignore = "long: the study of false finds"]
fn study_of_false_finds() {
    for (samples, records) in [(6000, 600), (40_000, 150)] {
        for model in [WHITE, FLICKER, WALK] {
            let values = p_values(model, samples, records);
            for bound in [0.05, 1e-2, 1e-3, 1e-4] {
                println!("{model:?} {samples} x {records}: p < {bound}: {:?}", below(&values, bound));
            }
            assert!(below(&values, 1e-4).iter().all(|f| *f as f64 <= 0.002 * records as f64));
        }
    }
}

#[test]
#[ignore = "long: intervals of a level that follows the rate"]
fn study_of_rate() {
    for (ratio, exponent) in [(1.5, 1), (1.5, 2), (3.0, 1), (1.25, 1)] {
        let found: Vec<[f64; 4]> = (0..100u64)
            .into_par_iter()
            .map(|seed| {
                let (found, _) = rate_level(seed, ratio, exponent);
                let Some(first) = found.first() else { return [0.0; 4] };
                let Law::Rate { exponent: q, .. } = first.law else { return [0.0; 4] };
                let held = first.ci95[0] < ratio && first.ci95[1] > ratio;
                [1.0, first.ratio, f64::from(u8::from(held)), f64::from(u8::from(i32::from(q) == exponent))]
            })
            .collect();
        let sum = found.iter().fold([0.0; 4], |s, r| [0, 1, 2, 3].map(|i| s[i] + 0.01 * r[i]));
        println!("rate {ratio} {exponent}: named, ratio, inside, exponent {sum:.3?}");
    }
}

#[test]
#[ignore = "long: what other effects are taken for"]
fn study_of_confusion() {
    let sigma = WHITE.sigma();
    type Change = Box<dyn Fn(&mut [f64], u64) + Sync>;
    let ramp = move |rate: &mut [f64], size: f64| {
        let n = rate.len() as f64;
        rate.iter_mut().enumerate().for_each(|(i, y)| *y += size * i as f64 / n);
    };
    let warm = move |rate: &mut [f64], size: f64, tau: f64| {
        rate.iter_mut().enumerate().for_each(|(i, y)| *y += size * (-(i as f64) / tau).exp());
    };
    let step = move |rate: &mut [f64], size: f64| {
        let at = rate.len() / 3;
        rate[at..].iter_mut().for_each(|y| *y += size);
    };
    let line = move |rate: &mut [f64], size: f64, f: f64| {
        rate.iter_mut().enumerate().for_each(|(i, y)| *y += size * (f * i as f64).sin());
    };
    let round = move |rate: &mut [f64], lsb: f64| rate.iter_mut().for_each(|y| *y = (*y / lsb).round() * lsb);
    let carried = move |rate: &mut [f64], lsb: f64| {
        let mut angle = 0.0;
        rate.iter_mut().for_each(|y| {
            angle += *y;
            let whole = (angle / lsb).floor() * lsb;
            angle -= whole;
            *y = whole;
        });
    };
    let cases: Vec<(&str, Change)> = vec![
        ("N x 1.3", Box::new(move |r, s| inject::level(r, sigma, |_| 1.3, s))),
        ("N x 4", Box::new(move |r, s| inject::level(r, sigma, |_| 4.0, s))),
        ("N x 0.5", Box::new(move |r, _| r.iter_mut().for_each(|y| *y *= 0.5))),
        ("ramp 20 sigma", Box::new(move |r, _| ramp(r, 20.0 * sigma))),
        ("warm-up 10 sigma, 60 samples", Box::new(move |r, _| warm(r, 10.0 * sigma, 60.0))),
        ("warm-up 30 sigma, 600 samples", Box::new(move |r, _| warm(r, 30.0 * sigma, 600.0))),
        ("step 5 sigma", Box::new(move |r, _| step(r, 5.0 * sigma))),
        ("line 3 sigma", Box::new(move |r, _| line(r, 3.0 * sigma, 0.7))),
        ("slow line 3 sigma", Box::new(move |r, _| line(r, 3.0 * sigma, 0.01))),
        (
            "narrow band 3 sigma, 20 s",
            Box::new(move |r, s| inject::narrow_band(r, 3.0 * sigma, 1.3, 20.0, s)),
        ),
        ("narrow band 2 sigma, 3 s", Box::new(move |r, s| inject::narrow_band(r, 2.0 * sigma, 1.3, 3.0, s))),
        ("Markov 1 sigma, 5", Box::new(move |r, s| inject::markov(r, sigma, 5.0, s))),
        ("Markov 1 sigma, 50", Box::new(move |r, s| inject::markov(r, sigma, 50.0, s))),
        ("Markov 0.5 sigma, 500", Box::new(move |r, s| inject::markov(r, 0.5 * sigma, 500.0, s))),
        ("Markov 3 sigma, 200", Box::new(move |r, s| inject::markov(r, 3.0 * sigma, 200.0, s))),
        (
            "random walk",
            Box::new(move |r, s| {
                let walk = Model { n: 0.0, b: 0.0, k: 3.0 }.draw(r.len(), 90_000 + s);
                r.iter_mut().zip(walk).for_each(|(y, w)| *y += w);
            }),
        ),
        (
            "flicker",
            Box::new(move |r, s| {
                let flicker = Model { n: 0.0, b: 0.3, k: 0.0 }.draw(r.len(), 90_000 + s);
                r.iter_mut().zip(flicker).for_each(|(y, w)| *y += w);
            }),
        ),
        ("rounded to 3 sigma", Box::new(move |r, _| round(r, 3.0 * sigma))),
        ("rounded to 6 sigma", Box::new(move |r, _| round(r, 6.0 * sigma))),
        ("angle of 4 sigma", Box::new(move |r, _| carried(r, 4.0 * sigma))),
        ("angle of 20 sigma", Box::new(move |r, _| carried(r, 20.0 * sigma))),
    ];
    for (name, change) in &cases {
        println!("{name}: bursts, level, telegraph of 40: {:?}", claims(WHITE, 6000, change));
    }
}

#[test]
#[ignore = "long: what is found of what was put in"]
fn study_of_detection() {
    let sigma = WHITE.sigma();
    for (lengths, times) in [
        (vec![1; 6], 12.0),
        (vec![10; 5], 4.0),
        (vec![30; 4], 3.0),
        (vec![50; 3], 2.5),
        (vec![200; 2], 2.0),
        (vec![20; 12], 3.0),
    ] {
        let rows: Vec<(f64, f64, f64, f64)> = (0..60u64)
            .into_par_iter()
            .map(|seed| {
                let truth = std::sync::Mutex::new(vec![]);
                let (problem, tried) = WHITE.problem(12_000, 700 + seed, |r| {
                    *truth.lock().unwrap() = inject::bursts(r, sigma, &lengths, times, seed);
                });
                let truth = truth.into_inner().unwrap();
                let inside = |i: usize| truth.iter().any(|g| i >= g.0 && i < g.0 + g.1);
                match bursts(&problem, &tried) {
                    Some(b) => {
                        let right = b.samples.iter().filter(|i| inside(**i)).count() as f64;
                        (1.0, b.gain, b.groups.len() as f64, right / b.samples.len() as f64)
                    }
                    None => (0.0, 0.0, 0.0, 0.0),
                }
            })
            .collect();
        let mean = |f: fn(&(f64, f64, f64, f64)) -> f64| rows.iter().map(f).sum::<f64>() / rows.len() as f64;
        println!(
            "bursts {} x {} of {times}: found {:.2} gain {:.0} groups {:.2} right {:.2}",
            lengths.len(),
            lengths[0],
            mean(|r| r.0),
            mean(|r| r.1),
            mean(|r| r.2),
            mean(|r| r.3)
        );
    }
    type Profile = fn(f64) -> f64;
    let profiles: [(&str, Profile, f64); 6] = [
        ("line to 1.3", |u| (1.3f64).powf(u), 1.3),
        ("step to 1.2", |u| if u > 0.37 { 1.2 } else { 1.0 }, 1.2),
        ("stretch 1.4 of 0.1", |u| if (0.6..0.7).contains(&u) { 1.4 } else { 1.0 }, 1.4),
        ("wave to 1.3", |u| 1.15 + 0.15 * (std::f64::consts::TAU * u).cos(), 1.3),
        ("30 waves to 1.3", |u| 1.15 + 0.15 * (30.0 * std::f64::consts::TAU * u).cos(), 1.3),
        ("decay from 1.6", |u| 1.0 + 0.6 * (-u / 0.15).exp(), 1.6),
    ];
    for (name, profile, ratio) in profiles {
        let rows: Vec<(f64, f64, f64, f64, f64)> = (0..60u64)
            .into_par_iter()
            .map(|seed| {
                let (problem, tried) =
                    WHITE.problem(12_000, 700 + seed, |r| inject::level(r, sigma, profile, seed));
                let burst = f64::from(u8::from(bursts(&problem, &tried).is_some_and(|b| b.p_value < 1e-4)));
                match levels(&problem, &tried).first() {
                    Some(l) => {
                        let inside = l.ci95[0] <= ratio && ratio <= l.ci95[1];
                        (1.0, l.gain, l.ratio, f64::from(u8::from(inside)), burst)
                    }
                    None => (0.0, 0.0, 0.0, 0.0, burst),
                }
            })
            .collect();
        let n = rows.len() as f64;
        let sum =
            rows.iter().fold([0.0; 5], |s, r| [s[0] + r.0, s[1] + r.1, s[2] + r.2, s[3] + r.3, s[4] + r.4]);
        println!(
            "level {name}: found, gain, ratio, inside, bursts {:?}",
            sum.map(|s| (s / n * 100.0).round() / 100.0)
        );
    }
}

#[test]
#[ignore = "long: telegraph signals of several sizes"]
fn study_of_telegraph() {
    let sigma = WHITE.sigma();
    for (model, amplitude, dwell, samples) in [
        (WHITE, 0.5, 300.0, 12_000),
        (WHITE, 1.0, 60.0, 12_000),
        (WHITE, 2.5, 10.0, 12_000),
        (WHITE, 0.3, 2000.0, 40_000),
        (FLICKER, 0.5, 300.0, 12_000),
        (WALK, 0.5, 300.0, 12_000),
        (WALK, 1.0, 60.0, 12_000),
    ] {
        let rows: Vec<[f64; 9]> = (0..40u64)
            .into_par_iter()
            .map(|seed| {
                let (problem, tried) = model.problem(samples, 700 + seed, |r| {
                    inject::telegraph(r, amplitude * sigma, dwell, seed);
                });
                match telegraph(&problem, &tried) {
                    Some(t) => {
                        let (a, d) = (amplitude * sigma, dwell / RATE_HZ);
                        let held =
                            |r: &Reported, x: f64| f64::from(u8::from(r.ci95[0] <= x && x <= r.ci95[1]));
                        let told = &t.detection;
                        let value = |name: &str| told.reported(name).unwrap();
                        let (size, time) = (value("amplitude_deg_h"), value("mean_dwell_s"));
                        let sure = f64::from(u8::from(told.p_value < 1e-4));
                        let burst =
                            f64::from(u8::from(bursts(&problem, &tried).is_some_and(|b| b.p_value < 1e-4)));
                        [
                            1.0,
                            sure,
                            told.gain,
                            t.rival_gain,
                            size.value / a,
                            held(size, a),
                            time.value / d,
                            held(time, d),
                            burst,
                        ]
                    }
                    None => [0.0; 9],
                }
            })
            .collect();
        let n = rows.len() as f64;
        let mut sum = [0.0; 9];
        rows.iter().for_each(|r| sum.iter_mut().zip(r).for_each(|(s, x)| *s += x / n));
        println!(
            "telegraph {model:?} {amplitude} {dwell} {samples}: found, sure, gain, rival, size, inside, dwell, inside, bursts {:?}",
            sum.map(|s| (s * 100.0).round() / 100.0)
        );
    }
}

#[test]
#[ignore = "long: a telegraph signal in processes that have none"]
fn study_of_telegraph_in_other_processes() {
    let sigma = WHITE.sigma();
    type Change = Box<dyn Fn(&mut [f64], u64) + Sync>;
    let add = |model: Model| -> Change {
        Box::new(move |r: &mut [f64], s: u64| {
            let other = model.draw(r.len(), 90_000 + s);
            r.iter_mut().zip(other).for_each(|(y, w)| *y += w);
        })
    };
    let cases: Vec<(&str, Change)> = vec![
        ("flicker", add(Model { n: 0.0, b: 0.3, k: 0.0 })),
        ("random walk", add(Model { n: 0.0, b: 0.0, k: 3.0 })),
        (
            "Markov",
            Box::new(move |r, s| {
                inject::markov(
                    r,
                    sigma * (0.3 + 0.01 * (s % 100) as f64),
                    10.0 * 1.05f64.powf((s % 97) as f64),
                    s,
                );
            }),
        ),
    ];
    for (name, change) in &cases {
        let found: Vec<f64> = (0..300u64)
            .into_par_iter()
            .map(|seed| {
                let (problem, tried) = WHITE.problem(6000, 5000 + seed, |rate| change(rate, seed));
                telegraph(&problem, &tried).map_or(1.0, |t| t.detection.p_value)
            })
            .collect();
        let below = |bound: f64| found.iter().filter(|p| **p < bound).count();
        println!("{name}: of 300 at p < 0.05, 0.01, 1e-4: {:?}", [0.05, 0.01, 1e-4].map(below));
        assert_eq!(below(1e-4), 0, "{name}");
    }
}
