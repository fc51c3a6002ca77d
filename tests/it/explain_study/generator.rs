//! The generator of concealed cases held against closed forms, and its files against the contract.

use sagnac_studies::explain::case::single;
use sagnac_studies::explain::claim::Claim;
use sagnac_studies::explain::draw::Draw;
use sagnac_studies::explain::files;
use sagnac_studies::explain::kinds::{DEVELOPMENT_UNKNOWNS, HELD_OUT_UNKNOWNS, KINDS, find};
use sagnac_studies::explain::modes::{cosine_modes, mode_frequency};
use sagnac_studies::explain::noise::{
    flicker, markov, markov_variance, quantisation_variance, quantised, random_walk, resonance,
    resonance_variance, white,
};
use sagnac_studies::explain::plan::{self, Wish};
use sagnac_studies::explain::profile::Profile;
use sagnac_studies::explain::scenario::Scenario;
use sagnac_studies::explain::setting::Setting;
use sagnac_studies::explain::strength::Spectrum;
use sagnac_studies::explain::thermal::Thermal;
use sagnac_studies::explain::unknowns::divergence_of_tails;
use std::f64::consts::{PI, TAU};

/// Samples and draws of a spectrum's test.
const N: usize = 4096;
const DRAWS: usize = 250;

/// Mean over draws of modes' squares over `expected`, in octaves of mode number from `first` on.
fn ratios(
    rate: f64,
    first: usize,
    make: impl Fn(&mut Draw) -> Vec<f64>,
    expected: impl Fn(f64) -> f64,
) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); 13];
    let mut draw = Draw::new(7, "spectrum");
    for _ in 0..DRAWS {
        let modes = cosine_modes(&make(&mut draw));
        for (k, y) in modes.iter().enumerate().skip(first) {
            let octave = &mut sums[k.ilog2() as usize];
            octave.0 += y * y / expected(mode_frequency(k, N, rate));
            octave.1 += 1.0;
        }
    }
    sums.iter().filter(|s| s.1 > 0.0).map(|s| s.0 / s.1).collect()
}

/// Within 2.5 %, or four standard deviations of so many squares where there are few.
fn agree(name: &str, ratios: &[f64], first: usize) {
    for (i, ratio) in ratios.iter().enumerate() {
        let modes = (1usize << (first.ilog2() as usize + i)) * DRAWS;
        let allowed = 0.025f64.max(4.0 * (2.0 / modes as f64).sqrt());
        assert!((ratio - 1.0).abs() < allowed, "{name}: octave {i} at {ratio}");
    }
}

#[test]
fn modes_are_the_orthonormal_cosines() {
    for n in [7usize, 12] {
        let x: Vec<f64> = (0..n).map(|i| ((i * i) as f64 * 0.37).sin()).collect();
        for (k, mode) in cosine_modes(&x).iter().enumerate() {
            let scale = if k == 0 { 1.0 / n as f64 } else { 2.0 / n as f64 }.sqrt();
            let sum: f64 =
                (0..n).map(|i| x[i] * (PI * k as f64 * (2 * i + 1) as f64 / (2 * n) as f64).cos()).sum();
            assert!((mode - scale * sum).abs() < 1e-12, "{n} {k}");
        }
    }
}

#[test]
fn noise_terms_have_the_spectra_of_the_contract() {
    let claim = |n: f64, b: f64, k: f64| Claim { n, b, k, rate_hz: 5.0, ..Claim::default() };
    let (w, f) = (claim(0.01, 0.0, 0.0), claim(0.0, 0.02, 0.0));
    agree("white", &ratios(5.0, 1, |d| white(d, N, 5.0, 0.01), |x| w.mode_variance(x, [0.0; 3])), 1);
    agree("flicker", &ratios(5.0, 8, |d| flicker(d, N, 5.0, 0.02), |x| f.mode_variance(x, [0.0; 3])), 8);
    // Means of a walk: the spectrum of the increments' covariance 2/3, 1/6, over that of the difference.
    let walk = |x: f64| {
        let c = (TAU * x / 5.0).cos();
        1e-4 / (5.0 * 3600.0) * (2.0 / 3.0 + c / 3.0) / (2.0 - 2.0 * c)
    };
    agree("walk", &ratios(5.0, 16, |d| random_walk(d, N, 5.0, 0.01), walk), 16);
    // At low frequency that is the contract's K²/(3600 (2πf)²).
    let at = 0.01;
    assert!((walk(at) / claim(0.0, 0.0, 0.01).mode_variance(at, [0.0; 3]) - 1.0).abs() < 1e-3);
}

#[test]
fn correlated_noise_has_its_spectrum() {
    for time_s in [0.3, 2.0, 40.0] {
        let r = ratios(5.0, 16, |d| markov(d, N, 5.0, 0.3, time_s), |x| markov_variance(x, 5.0, 0.3, time_s));
        agree(&format!("Markov {time_s}"), &r, 16);
    }
    // Published: means over T of a process of correlation time T have the variance 2/e of the process.
    let y = markov(&mut Draw::new(3, "m"), 400_000, 1.0, 1.0, 1.0);
    let variance = y.iter().map(|v| v * v).sum::<f64>() / y.len() as f64;
    assert!((variance / (2.0 / std::f64::consts::E) - 1.0).abs() < 0.02, "{variance}");
    let near = |x: f64| (x - 0.6).abs() < 0.1;
    let band = |made: bool| {
        let mut draw = Draw::new(5, "hum");
        let mut sum = 0.0;
        for _ in 0..if made { DRAWS } else { 1 } {
            let modes =
                if made { cosine_modes(&resonance(&mut draw, N, 5.0, 0.2, 0.6, 15.0)) } else { vec![0.0; N] };
            for (k, y) in modes.iter().enumerate().skip(1) {
                let x = mode_frequency(k, N, 5.0);
                if near(x) {
                    sum +=
                        if made { y * y / DRAWS as f64 } else { resonance_variance(x, 5.0, 0.2, 0.6, 15.0) };
                }
            }
        }
        sum
    };
    assert!((band(true) / band(false) - 1.0).abs() < 0.03);
}

#[test]
fn rounding_of_the_angle_adds_its_published_spectrum() {
    // Steps a third of the noise: rounding is independent of it.
    let lsb = 0.3 * 60.0 * 0.01 * 5f64.sqrt() / 5.0;
    let make = |d: &mut Draw| {
        let y = white(d, N, 5.0, 0.01);
        let rounded = quantised(&y, 5.0, lsb, d.uniform(0.0, 1.0));
        assert!(rounded.iter().all(|v| (v / (lsb * 5.0) - (v / (lsb * 5.0)).round()).abs() < 1e-6));
        y.iter().zip(rounded).map(|(a, b)| b - a).collect()
    };
    // Lower modes feel the ends of the record: a difference of white noise is not white there.
    let r = ratios(5.0, 512, make, |x| quantisation_variance(x, 5.0, lsb));
    agree("rounding", &r, 512);
}

#[test]
fn profiles_integrate_and_housings_lag() {
    let p = Profile::new(&[(0.0, 0.0), (2.0, 4.0), (3.0, 4.0), (5.0, 0.0)]);
    assert!((p.integral(5.0) - 12.0).abs() < 1e-12);
    assert!((p.mean(1.0, 2.0) - 2.0).abs() < 1e-12);
    assert!((p.mean(2.0, 1.0) - (0.5 * 3.5 + 0.5 * 4.0)).abs() < 1e-12);
    assert!((p.integral(-1.0), p.at(9.0)) == (0.0, 0.0));
    // Behind a steady ramp a first-order housing lags by rate times the sum of the time constants.
    let ramp = Profile::new(&[(-1e5, -100.0), (1e5, 100.0)]);
    let t = Thermal::solve(&mut Draw::new(1, "t"), 2e4, &ramp, 100.0, 300.0);
    assert!((t.at(1.8e4) - (18.0 - 0.4)).abs() < 0.1, "{}", t.at(1.8e4));
    assert!((t.rate(1.8e4) - 0.06).abs() < 0.01);
    let late = t.lagged(&[1.8e4], 500.0)[0];
    assert!((t.at(1.8e4) - late - 0.5).abs() < 0.05, "{late}");
}

fn plain(n: f64) -> Setting {
    let mut s = Setting::drawn(11, Scenario::Static);
    s.claim.n = n;
    (s.claim.b, s.claim.k, s.claim.lsb_arcsec) = (0.0, 0.0, 0.0);
    s.departure = Default::default();
    s
}

#[test]
fn strength_agrees_with_closed_forms() {
    let mut s = plain(0.01);
    s.claim.uncertainty.n_rel = 1e-6;
    let spectrum = Spectrum::of(&s);
    let sigma = s.claim.white_sigma();
    let step = (find("bias_step").expect("a kind").make)(&mut Draw::new(2, "x"), &s, 1.0);
    let value = |name: &str| step.parameters.iter().find(|(n, _)| *n == name).expect("a parameter").1;
    let p = value("time_s") / s.duration_s();
    let expected = 0.5 * s.rows as f64 * p * (1.0 - p) * (value("step_deg_h") / sigma).powi(2);
    assert!((spectrum.gain(&s, &step) / expected - 1.0).abs() < 1e-3, "{expected}");
    let more = (find("excess_arw").expect("a kind").make)(&mut Draw::new(2, "x"), &s, 1.0);
    let ratio = (more.parameters[0].1 / s.claim.n).powi(2);
    let expected = 0.5 * (s.rows - 1) as f64 * (ratio - 1.0 - ratio.ln());
    assert!((spectrum.gain(&s, &more) / expected - 1.0).abs() < 1e-3, "{expected}");
    // With an N of which nothing is known nothing is gained.
    s.claim.uncertainty.n_rel = 100.0;
    assert!(spectrum.gain(&s, &more).abs() < 0.01);
}

#[test]
fn tails_diverge_as_their_samples_do() {
    // The mean of the log ratio over draws of Student's t made of normals.
    let (nu, mut draw, count) = (5, Draw::new(4, "t"), 400_000);
    let scale = (3.0f64 / 5.0).sqrt();
    // Γ(3)/(Γ(2.5) √(5π)) with Γ(2.5) = 3√π/4.
    let constant = 2.0 / (0.75 * PI * 5f64.sqrt());
    let mut sum = 0.0;
    for _ in 0..count {
        let chi: f64 = (0..nu).map(|_| draw.normal().powi(2)).sum();
        let t = draw.normal() / (chi / f64::from(nu)).sqrt();
        let x = t * scale;
        let density = constant * (1.0 + t * t / 5.0).powi(-3) / scale;
        sum += density.ln() + 0.5 * (TAU.ln() + x * x);
    }
    let measured = sum / f64::from(count);
    assert!((divergence_of_tails(5.0) / measured - 1.0).abs() < 0.05, "{measured}");
    assert!(divergence_of_tails(200.0) < 1e-4);
}

/// The contract's mean, computed from the files alone.
fn mean_of_files(model: &toml::Value, names: &[&str], row: &[f64]) -> f64 {
    let get = |name: &str| names.iter().position(|n| *n == name).map(|i| row[i]);
    let key =
        |table: &str, key: &str| model.get(table).and_then(|t| t.get(key)).and_then(toml::Value::as_float);
    let mut m = key("bias", "value_deg_h").expect("a bias");
    if let Some(c) = key("temperature", "coefficient_deg_h_per_degC") {
        let reference = key("temperature", "reference_degC").expect("a reference");
        m += c * (get("temp_degC").expect("a column") - reference);
    }
    if let Some(ppm) = key("scale_factor", "error_ppm") {
        m += 3600.0 * (1.0 + 1e-6 * ppm) * get("table_rate_deg_s").expect("a column");
    }
    if let Some(latitude) = key("earth", "latitude_deg") {
        let angle =
            get("table_angle_deg").expect("a column") + key("earth", "azimuth_deg").expect("an azimuth");
        m += 15.041067 * latitude.to_radians().cos() * angle.to_radians().cos();
    }
    m
}

#[test]
fn recordings_of_correct_claims_are_draws_of_their_claims() {
    let (mut scenarios, mut worst) = (std::collections::BTreeSet::new(), 0f64);
    for seed in 0..40 {
        let mut case = plan::made(&Wish::Null, seed, (60.0, 60.0));
        if !case.stated.is_empty() || case.setting.rows > 60_000 {
            continue;
        }
        // Nothing is off: the claim must fit without any freedom.
        case.setting.departure = Default::default();
        scenarios.insert(format!("{:?}", case.setting.scenario));
        let made = case.realise(seed);
        let text = files::recording(&case, &made, seed);
        let model: toml::Value = toml::from_str(&case.setting.claim.toml()).expect("TOML");
        let mut lines = text.lines();
        let names: Vec<&str> = lines.next().expect("a heading").split(',').collect();
        let listed = model["recording"]["columns"].as_array().expect("columns");
        assert_eq!(listed.iter().filter_map(|c| c.as_str()).collect::<Vec<_>>(), names);
        let residual: Vec<f64> = lines
            .map(|l| {
                let row: Vec<f64> = l.split(',').map(|v| v.parse().expect("a number")).collect();
                assert_eq!(row.len(), names.len());
                row[1] - mean_of_files(&model, &names, &row)
            })
            .collect();
        assert_eq!(residual.len(), case.setting.rows);
        let c = &case.setting.claim;
        let modes = cosine_modes(&residual);
        let mut sums = vec![(0.0, 0.0); 20];
        for (k, y) in modes.iter().enumerate().skip(16) {
            let v = c.mode_variance(mode_frequency(k, modes.len(), c.rate_hz), [0.0; 3]);
            let octave = &mut sums[k.ilog2() as usize];
            octave.0 += y * y / v;
            octave.1 += 1.0;
        }
        for (sum, count) in sums.iter().filter(|s| s.1 > 0.0) {
            worst = worst.max((sum - count).abs() / (2.0 * count).sqrt());
        }
        // Large steps of the angle are not quite white.
        let limit = if c.lsb_arcsec > 0.0 { 8.0 } else { 5.0 };
        assert!(worst < limit, "{}: {worst}", case.name);
        worst = 0.0;
    }
    assert!(scenarios.len() >= 9, "{scenarios:?}");
}

#[test]
fn contributions_are_what_the_effect_adds() {
    for name in
        ["temp_rate", "line", "time_offset", "unobserved_driver", "reset_ripple", "markov_long", "excess_rrw"]
    {
        let case = single(5, find(name).expect("a kind"), (100.0, 100.0));
        let mut without = case.clone();
        without.left_out.clear();
        let (with, bare) = (case.realise(9), without.realise(9));
        assert_eq!(case.realise(9).rate_deg_h, with.rate_deg_h, "{name}: the same seed");
        assert_ne!(case.realise(10).rate_deg_h, with.rate_deg_h, "{name}: another seed");
        let contribution = &with.contributions[0];
        let size = contribution.iter().fold(0f64, |m, v| m.max(v.abs()));
        let largest = with.rate_deg_h.iter().fold(0f64, |m, v| m.max(v.abs()));
        for ((a, b), c) in with.rate_deg_h.iter().zip(&bare.rate_deg_h).zip(contribution) {
            assert!((a - b - c).abs() <= 1e-9 * size + 1e-13 * largest, "{name}: {} against {c}", a - b);
        }
    }
}

/// Section 3 of the contract.
const CONTRACT: &str = "temp_linear temp_polynomial temp_rate thermal_lag temp_hysteresis warmup_exponential rate_ramp \
    diurnal unobserved_driver excess_arw excess_flicker excess_rrw markov_short markov_long quasi_periodic line \
    quantization bandwidth_filter noise_variance_time noise_variance_rate outlier_bursts random_telegraph bias_step \
    heading_change earth_rate_projection table_harmonic reset_ripple sf_error sf_asymmetry sf_nonlinearity \
    sf_temperature dead_zone saturation cross_axis supply_sensitivity dropped_samples time_offset clock_drift";

#[test]
fn every_kind_is_made_at_the_strength_asked_for() {
    let kinds: Vec<&str> = KINDS.iter().map(|k| k.name).collect();
    assert_eq!(kinds, CONTRACT.split_whitespace().collect::<Vec<_>>());
    assert!(DEVELOPMENT_UNKNOWNS.len() >= 6 && HELD_OUT_UNKNOWNS.len() >= 6);
    // These come in their own sizes: a filter below Nyquist, gaps, limits and steps that are real.
    let own =
        ["bandwidth_filter", "dropped_samples", "saturation", "dead_zone", "quantization", "outlier_bursts"];
    for kind in KINDS.iter().chain(DEVELOPMENT_UNKNOWNS).chain(HELD_OUT_UNKNOWNS) {
        for seed in [21, 22] {
            let case = single(seed, kind, (100.0, 100.0));
            let left = &case.left_out[0];
            assert_eq!(left.effect.kind, kind.name);
            assert!(!left.effect.wheres.is_empty() && left.effect.wheres.iter().all(|w| w.from <= w.to));
            let off = (left.strength / 100.0 - 1.0).abs();
            assert!(off < 0.06 || own.contains(&kind.name), "{} {seed}: {}", kind.name, left.strength);
            assert!(left.effect.course.iter().all(|v| v.is_finite()), "{}", kind.name);
        }
    }
}
