//! Sizes against closed forms in white noise of a known level.

use super::gate::Gate;
use super::null_model::NullModel;
use super::spectrum::Expected;
use super::{course, spectrum};
use crate::effect::{Column, Drivers, Model, Nuisance, Resolution, find};
use crate::mismatch::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use crate::mismatch::hypothesis::{Hypothesis, fit};
use crate::mismatch::noise_fit::{self, Noise};
use crate::mismatch::noticeable_record::{NoticeableSize, WhyNot};
use crate::mismatch::spectral_data::SpectralData;
use rand::SeedableRng as _;
use rand_distr::{ChiSquared, Distribution as _};
use rand_xoshiro::Xoshiro256PlusPlus;

const SAMPLES: usize = 4000;
const DT_S: f64 = 3.6;
/// N, deg/√h; a sample has a deviation of 60 N/√3.6, 1 deg/h.
const N: f64 = 0.031_622_776_601_683_79;
const GATE: Gate = Gate { family: 40.0, alpha: 0.01 };

fn spectra(deviation: f64) -> SpectralDataSet {
    let temperature: Vec<f64> = (0..SAMPLES).map(|i| if i % 2 == 0 { 21.0 } else { 19.0 }).collect();
    let drivers = Drivers {
        dt_s: DT_S,
        samples: SAMPLES,
        averaged: 1,
        temperature: Some(temperature),
        ..Drivers::default()
    };
    let deviations = [(Nuisance::TemperatureCoefficient, deviation)];
    let full = SpectralData::new(drivers, &vec![0.0; SAMPLES], &deviations);
    SpectralDataSet { full, slow: None, grid_step_arcsec: None, rows: SAMPLES, repeated_share: 0.0 }
}

fn white(spectra: &SpectralDataSet) -> FittedHypothesis {
    let base = [N, 0.0, 0.0];
    let noise = Noise {
        base,
        claimed: base,
        deviation: [0.0; 3],
        bound: [0.0; 3],
        unconstrained: [false; 3],
        quantization_arcsec: 0.0,
        spectra: vec![],
        discrepancy: None,
    };
    let mut hypothesis = Hypothesis { noise, courses: vec![] };
    let fit = fit(&mut hypothesis, &spectra.full);
    FittedHypothesis { hypothesis, fit, parameters: 0, odds: vec![] }
}

fn of_course(kind: &str, spectra: &SpectralDataSet) -> Result<Vec<NoticeableSize>, WhyNot> {
    let best = white(spectra);
    let null_model = NullModel::new(&best, spectra, Resolution::FullRate, 1.0);
    let effect = find(kind).unwrap();
    let Model::Mean(model) = effect.model() else { panic!("a course") };
    course::sizes(effect, model, &null_model, &GATE)
}

#[test]
fn a_ramp_is_noticed_from_the_slope_whose_squares_pass_the_gate() {
    let sizes = of_course("rate_ramp", &spectra(0.0)).unwrap();
    // Σ (t − mean)² over n samples of 4 h: n · 16 h²/12; λ = slope² times that.
    let information = SAMPLES as f64 * 16.0 / 12.0;
    let slope = (GATE.needed(1, 1.0, 1.0) / information).sqrt();
    assert_eq!((sizes.len(), sizes[0].parameter.as_str()), (1, "slope_deg_h_per_h"));
    assert!((sizes[0].size / slope - 1.0).abs() < 0.01, "{} {slope}", sizes[0].size);
    // A line from end to end has a deviation of its range over √12.
    assert!((sizes[0].rms_deg_h.unwrap() / (4.0 * sizes[0].size / 12f64.sqrt()) - 1.0).abs() < 1e-3);
    assert!(sizes[0].claimed.is_none() && sizes[0].worst.is_none());
}

#[test]
fn what_the_claim_leaves_open_of_a_coefficient_is_not_noticed() {
    // Temperatures of ±1 °C: the coefficient is known to 1/√n.
    let own = 1.0 / (SAMPLES as f64).sqrt();
    let known = of_course("temp_linear", &spectra(0.0)).unwrap()[0].size;
    let root = GATE.threshold(1, 1.0).sqrt();
    assert!((known / (own * (root + 1.644_854)) - 1.0).abs() < 0.01, "{known}");
    // Stated to three times that: √T standard deviations of both, and 1.645 of the estimate alone.
    let open = of_course("temp_linear", &spectra(3.0 * own)).unwrap()[0].size;
    let expected = root * own * 10f64.sqrt() + 1.644_854 * own;
    assert!((open / expected - 1.0).abs() < 0.01, "{open} {expected}");
}

#[test]
fn a_line_is_noticed_alike_at_all_frequencies_of_white_noise_and_a_step_best_in_the_middle() {
    let line = &of_course("line", &spectra(0.0)).unwrap()[0];
    // A²n/2 of a sinusoid; at the highest frequency the mean over a sample leaves sinc(0.475) = 0.668 of it.
    let amplitude = (2.0 * GATE.needed(3, SAMPLES as f64, 1.0) / SAMPLES as f64).sqrt();
    assert!((line.size / amplitude - 1.0).abs() < 0.03, "{} {amplitude}", line.size);
    let worst = line.worst.as_ref().unwrap();
    assert!((worst.size / (amplitude / 0.668) - 1.0).abs() < 0.03, "{worst:?}");
    assert!(worst.at["frequency_hz"] > 0.4 / DT_S);
    let step = &of_course("bias_step", &spectra(0.0)).unwrap()[0];
    let worst = step.worst.as_ref().unwrap();
    // n s (1 − s) of a step after the share s: 0.0475 at a twentieth.
    let needed = GATE.needed(2, (SAMPLES as f64).powf(0.75), 1.0);
    let expected = (needed / (SAMPLES as f64 * 0.0475)).sqrt();
    assert!((worst.size / expected - 1.0).abs() < 0.01, "{worst:?} {expected}");
    assert!(step.size < worst.size);
}

#[test]
fn white_noise_is_noticed_from_the_level_whose_likelihood_passes_the_gate() {
    let spectra = spectra(0.0);
    let best = white(&spectra);
    let null_model = NullModel::new(&best, &spectra, Resolution::FullRate, 1.0);
    let expected = Expected::new(&best, &spectra, &null_model);
    let of = |kind: &str| {
        let effect = find(kind).unwrap();
        let Model::Spectrum(model) = effect.model() else { panic!("a spectrum") };
        spectrum::size(effect, model, &expected, &GATE)
    };
    let size = of("excess_arw").unwrap();
    // Of n − 1 modes: (n − 1)(r − 1 − ln r) with r the ratio of the densities.
    let r = (1.0 + size.size / N).powi(2);
    let gain = (SAMPLES - 1) as f64 * (r - 1.0 - r.ln());
    assert!((gain / GATE.needed(1, 1.0, 1.0) - 1.0).abs() < 0.08, "{gain}");
    assert_eq!((size.claimed, size.below), (Some(N), false));
    // A filter is the more to be seen, the lower its cutoff.
    let filter = of("bandwidth_filter").unwrap();
    assert!(filter.below && filter.size > 0.0, "{filter:?}");
}

/// Few modes tell of a random walk, and their powers scatter: the share of drawn spectra that pass the gate is that stated.
#[test]
fn a_random_walk_of_the_stated_size_passes_the_gate_in_95_of_100_drawn_spectra() {
    let spectra = spectra(0.0);
    let best = white(&spectra);
    let null_model = NullModel::new(&best, &spectra, Resolution::FullRate, 1.0);
    let expected = Expected::new(&best, &spectra, &null_model);
    let effect = find("excess_rrw").unwrap();
    let Model::Spectrum(model) = effect.model() else { panic!("a spectrum") };
    let size = spectrum::size(effect, model, &expected, &GATE).unwrap().size;
    let mut free = best.hypothesis.noise.clone();
    (free.base[2], free.unconstrained[2]) = (size, true);
    let truth = free.densities(&spectra.full);
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(9);
    let mut passes = 0;
    for _ in 0..400 {
        let drawn: Vec<f64> = spectra
            .full
            .bins
            .iter()
            .zip(&truth)
            .map(|(b, s)| s * ChiSquared::new(b.modes as f64).unwrap().sample(&mut rng) / b.modes as f64)
            .collect();
        let fitted = |noise: &Noise| noise_fit::fit(&mut noise.clone(), &spectra.full, &drawn).log_likelihood;
        let gain = fitted(&free) - fitted(&best.hypothesis.noise);
        passes += u32::from(2.0 * gain >= GATE.threshold(1, 1.0));
    }
    // 95 of 100 within three deviations of 1.09.
    assert!((368..=393).contains(&passes), "{passes} of 400 at {size}");
}

#[test]
fn what_no_single_number_sizes_is_not_computed() {
    assert_eq!(of_course("temp_polynomial", &spectra(0.0)), Err(WhyNot::NoSingleSize));
    // Without a claimed coefficient no delay of the temperature does anything.
    assert_eq!(of_course("thermal_lag", &spectra(0.0)), Err(WhyNot::NeverLargeEnough));
    assert!(find("temp_linear").unwrap().needs().contains(&Column::Temperature));
}
