//! Spectral effects held against simulation: densities must be what simulation makes, searches must begin near the truth.

use super::*;
use crate::effect::{Drivers, ModeBin, Model, SpectralContext, Value, Values};
use crate::noise::composite::Composite;
use crate::noise::model::{NoiseModel, unit_density};
use crate::noise::simulate::{Setup, Simulator};
use crate::numeric::cosine::dct2;

fn values(effect: &dyn Effect, numbers: &[f64], lists: Vec<(&'static str, Vec<f64>)>) -> Values {
    let numbers = effect.params().iter().zip(numbers);
    let numbers = numbers.map(|(p, x)| (p.name.to_owned(), Value::Number(*x)));
    numbers.chain(lists.into_iter().map(|(name, x)| (name.to_owned(), Value::List(x)))).collect()
}

#[test]
fn simulated_spectra_have_the_density_that_fits_use() {
    let (n, runs) = (2048usize, 60u64);
    let white = NoiseModel { n: 0.01, ..NoiseModel::default() };
    let cases: [(&str, Vec<f64>); 7] = [
        ("markov_short", vec![2.0, 0.5]),
        ("markov_long", vec![400.0, 0.5]),
        ("quasi_periodic", vec![0.07, 0.4, 600.0]),
        ("quantization", vec![0.5]),
        ("bandwidth_filter", vec![0.06]),
        ("excess_flicker", vec![0.3]),
        ("power_law_noise", vec![2.0, 0.6, 0.02]),
    ];
    for (kind, fitted) in cases {
        let effect = find(kind).unwrap();
        let Model::Spectrum(spectrum) = effect.model() else { panic!("{kind}") };
        let mut model = Composite::from(white);
        spectrum.compose(&fitted, 1.0, &mut model);
        let mut power = vec![0.0; n];
        for run in 0..runs {
            let setup = Setup::for_record(run * 7 + 3, 1.0, n as u64);
            let modes = dct2(&Simulator::of(&model, &setup).take(n));
            power.iter_mut().zip(modes).for_each(|(p, c)| *p += c * c / runs as f64);
        }
        let density = |bin: &ModeBin| {
            let part = |term| unit_density(term, bin.frequency_hz, bin.dt_s);
            let white = 3600.0 * 0.01f64.powi(2);
            match spectrum.act() {
                crate::effect::SpectrumAct::Adds => white + spectrum.density(&fitted, bin),
                crate::effect::SpectrumAct::Filters => white * spectrum.density(&fitted, bin),
                crate::effect::SpectrumAct::Unconstrains(term) => white + fitted[0].powi(2) * part(term),
            }
        };
        let (mut low, mut bins) = (1usize, 0);
        while low < n {
            let high = (low + low / 6 + 1).min(n);
            let modes = high - low;
            let frequency_hz = (low as f64 + 0.5 * (modes as f64 - 1.0)) / (2.0 * n as f64);
            let expected =
                density(&ModeBin { frequency_hz, mode: low, modes, samples: n, dt_s: 1.0, even_ends: false });
            let got = power[low..high].iter().sum::<f64>() / modes as f64;
            let single = |k: usize| {
                let frequency_hz = k as f64 / (2.0 * n as f64);
                density(&ModeBin { frequency_hz, mode: k, modes: 1, samples: n, dt_s: 1.0, even_ends: false })
            };
            // A resonance inside a bin makes the scatter that of few modes.
            let square = (low..high).map(|k| single(k).powi(2)).sum::<f64>();
            let scatter = (2.0 * square / runs as f64).sqrt() / (modes as f64 * expected);
            assert!(
                (got / expected - 1.0).abs() < 4.5 * scatter + 0.03,
                "{kind}, modes {low} to {high}: {}",
                got / expected
            );
            low = high;
            bins += 1;
        }
        assert!(bins > 20);
    }
}

#[test]
fn spectral_searches_begin_near_the_truth() {
    // Bins with the density of white noise and the effect, seen without scatter.
    let (n, dt) = (16_384usize, 0.1);
    let mut bins = vec![];
    let mut low = 1usize;
    while low < n {
        let modes = (low / 12).max(1).min(n - low);
        let frequency_hz = (low as f64 + 0.5 * (modes as f64 - 1.0)) / (2.0 * n as f64 * dt);
        bins.push(ModeBin { frequency_hz, mode: low, modes, samples: n, dt_s: dt, even_ends: false });
        low += modes;
    }
    let cases: [(&str, Vec<f64>); 7] = [
        ("markov_short", vec![0.4, 0.3]),
        ("markov_long", vec![40.0, 0.2]),
        ("quasi_periodic", vec![0.9, 0.2, 30.0]),
        ("quantization", vec![0.1]),
        ("bandwidth_filter", vec![1.5]),
        ("unobserved_driver", vec![0.3, 200.0]),
        ("power_law_noise", vec![0.3, 0.6, 0.05]),
    ];
    let white = 3600.0 * 0.003f64.powi(2);
    for (kind, fitted) in cases {
        let effect = find(kind).unwrap();
        let Model::Spectrum(spectrum) = effect.model() else { panic!("{kind}") };
        let total = |fitted: &[f64], bin: &ModeBin| match spectrum.act() {
            crate::effect::SpectrumAct::Filters => white * spectrum.density(fitted, bin),
            _ => white + spectrum.density(fitted, bin),
        };
        let expected = vec![white; bins.len()];
        let observed: Vec<f64> = bins.iter().map(|b| total(&fitted, b)).collect();
        let context =
            SpectralContext { bins: &bins, observed: &observed, expected: &expected, grid_step_arcsec: None };
        let likelihood = |density: &dyn Fn(&ModeBin) -> f64| {
            let terms = bins.iter().zip(&observed).map(|(b, i)| {
                let s = density(b);
                b.modes as f64 * (s.ln() + i / s)
            });
            -0.5 * terms.sum::<f64>()
        };
        let (at_truth, before) = (likelihood(&|b| total(&fitted, b)), likelihood(&|_| white));
        let starts = spectrum.starts(&context);
        let bounds = spectrum.bounds(&context);
        assert!((1..=12).contains(&starts.len()) && spectrum.trials(&context) >= 1.0, "{kind}");
        let mut best = f64::NEG_INFINITY;
        for start in &starts {
            assert_eq!(start.len(), bounds.len(), "{kind}");
            best = best.max(likelihood(&|b| total(start, b)));
        }
        for (x, bounds) in fitted.iter().zip(&bounds) {
            assert!(bounds.low < *x && *x < bounds.high, "{kind}: {x} outside {bounds:?}");
        }
        let share = (best - before) / (at_truth - before);
        assert!(share > 0.3, "{kind}: {share} of {} from {starts:?}", at_truth - before);
        let places = spectrum.places(&fitted, &context);
        assert!((1..=3).contains(&places.len()) && places.iter().all(|p| p.from <= p.to), "{kind}");
        assert_eq!(places[0].domain, effect.domain(), "{kind}");
    }
}

#[test]
fn stated_spectra_give_their_fitted_parameters_back() {
    for effect in EFFECTS {
        let Model::Spectrum(spectrum) = effect.model() else { continue };
        let numbers: Vec<f64> = (0..effect.params().len()).map(|i| 0.5 + i as f64).collect();
        let stated = spectrum.claimed_parameters(&values(*effect, &numbers, vec![]));
        if effect.kind() == "unobserved_driver" {
            assert!(stated.is_none());
            let knots = vec![("knots_time_s", vec![0.0, 10.0]), ("knots_deg_h", vec![1.0, 2.0])];
            let drivers = Drivers { dt_s: 5.0, samples: 3, averaged: 1, ..Drivers::default() };
            let course = effect.claimed_course(&values(*effect, &[], knots), &drivers);
            assert_eq!(course, Some(vec![1.0, 1.5, 2.0]));
            continue;
        }
        assert_eq!(spectrum.parameters(&stated.unwrap()), numbers, "{}", effect.kind());
        assert!(spectrum.claimed_parameters(&Values::new()).is_none(), "{}", effect.kind());
    }
}
