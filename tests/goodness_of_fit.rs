//! Goodness of fit on simulated records: correct models are called wrong as often as stated, and departures are found
//! and placed.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use sagnac::noise::allan::{AllanAccumulator, AllanPlan};
use sagnac::noise::block_series::BlockSeriesAccumulator;
use sagnac::noise::composite::{Composite, Damped, Described, Sampling};
use sagnac::noise::data::{BlockSeries, DeviationPoint, WelchSpectrum};
use sagnac::noise::family::Estimator;
use sagnac::noise::model::NoiseModel;
use sagnac::noise::residual::{GoodnessOfFit, View};
use sagnac::noise::simulate::{Setup, Simulator};
use sagnac::noise::spectral_record::SpectralRecord;
use sagnac::noise::tau_grid::TauGrid;
use sagnac::noise::welch::WelchAccumulator;

/// What one pass leaves of a record at 1 Hz.
struct Record {
    blocks: BlockSeries,
    welch: WelchSpectrum,
    octaves: Vec<DeviationPoint>,
}

impl Record {
    /// With at most `most` block means.
    fn of(samples: &[f64], most: usize) -> Record {
        let mut blocks = BlockSeriesAccumulator::with_most_blocks(most);
        blocks.push(samples, 0);
        let mut welch = WelchAccumulator::with_segment(1024);
        welch.push(samples, false);
        let mut allan = AllanAccumulator::new(AllanPlan {
            tau0_s: 1.0,
            grid: TauGrid::Octave,
            exact: false,
            estimators: vec![Estimator::Allan],
        });
        allan.push(samples, 0, false);
        Record {
            blocks: blocks.finish(),
            welch: welch.finish().spectrum,
            octaves: allan.finish().curve(Estimator::Allan).unwrap().points.clone(),
        }
    }

    fn spectral(&self) -> SpectralRecord<'_> {
        SpectralRecord {
            blocks: &self.blocks,
            welch: Some(&self.welch),
            tau0_s: 1.0,
            lines: &[],
            sampling: Sampling::Averaging,
        }
    }

    /// Judges what identification made of the record, or a description that is given.
    fn judge(&self, given: Option<&Described>) -> GoodnessOfFit {
        let record = self.spectral();
        let found =
            given.map_or_else(|| record.identify("rate").ranged.identification.described, Clone::clone);
        GoodnessOfFit::of(&record, &found, &self.octaves)
    }
}

/// A record of a model. Quantisation is white noise of the angle here: the simulator rounds, which is no white noise
/// unless the steps are small.
fn simulated(model: &Composite, seed: u64, samples: usize) -> Vec<f64> {
    let q = model.terms.q;
    let mut rest = model.clone();
    rest.terms.q = 0.0;
    let mut record = Simulator::of(&rest, &Setup::for_record(seed, 1.0, samples as u64)).take(samples);
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(!seed);
    let mut angle = || q * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng);
    let mut last = angle();
    for y in &mut record {
        let next = angle();
        // Arcseconds a second are degrees an hour.
        *y += next - last;
        last = next;
    }
    record
}

fn p_value(fit: &GoodnessOfFit, view: View) -> Option<f64> {
    fit.views.iter().find(|j| j.view == view).map(|j| j.p_value)
}

struct Mix {
    name: &'static str,
    model: Composite,
    /// Judged with the true parameters and not with fitted ones.
    told: bool,
    samples: usize,
    most_blocks: usize,
}

fn mixes() -> Vec<Mix> {
    let terms = |n, b, k, r, q| Composite::from(NoiseModel { n, b, k, r, q });
    let fitted = |name, model| Mix { name, model, told: false, samples: 16_384, most_blocks: 1 << 18 };
    let markov = Composite {
        markov: vec![Damped { rms_deg_h: 0.1, frequency_hz: 0.0, decay_time_s: 20.0 }],
        ..terms(0.002, 0.0, 0.0, 0.0, 0.0)
    };
    let periodic = Composite {
        quasi_periodic: vec![Damped { rms_deg_h: 0.06, frequency_hz: 0.02, decay_time_s: 300.0 }],
        ..terms(0.002, 0.003, 0.0, 0.0, 0.0)
    };
    vec![
        fitted("N", terms(0.002, 0.0, 0.0, 0.0, 0.0)),
        fitted("N B", terms(0.002, 0.02, 0.0, 0.0, 0.0)),
        fitted("N K", terms(0.002, 0.0, 0.02, 0.0, 0.0)),
        fitted("N B K", terms(0.002, 0.02, 0.02, 0.0, 0.0)),
        fitted("N Q", terms(0.002, 0.0, 0.0, 0.0, 0.1)),
        fitted("N R", terms(0.002, 0.0, 0.0, 0.01, 0.0)),
        Mix {
            most_blocks: 4096,
            samples: 65_536,
            ..fitted("N B, blocks of 16", terms(0.002, 0.02, 0.0, 0.0, 0.0))
        },
        Mix {
            most_blocks: 4096,
            samples: 65_536,
            ..fitted("N K Q, blocks of 16", terms(0.002, 0.0, 0.02, 0.0, 0.1))
        },
        Mix { told: true, ..fitted("N Markov, told", markov) },
        Mix { told: true, ..fitted("N B quasi-periodic, told", periodic) },
    ]
}

const VIEWS: usize = View::ALL.len();

/// Share of records of correct models that each view calls wrong at a level, by mix.
fn false_alarms<const LEVELS: usize>(
    records: u64,
    seed: u64,
    levels: [f64; LEVELS],
) -> Vec<(&'static str, [[f64; VIEWS]; LEVELS])> {
    (0u64..)
        .zip(mixes())
        .map(|(place, mix)| {
            let seed = seed + place * 10_000_000;
            let given = Described { model: mix.model.clone(), ..Default::default() };
            let counts = (0..records)
                .into_par_iter()
                .map(|i| {
                    let samples = simulated(&mix.model, seed + i, mix.samples);
                    let fit = Record::of(&samples, mix.most_blocks).judge(mix.told.then_some(&given));
                    let found = View::ALL.map(|v| p_value(&fit, v).expect("long enough"));
                    levels.map(|level| found.map(|p| u32::from(p < level)))
                })
                .reduce(
                    || [[0; VIEWS]; LEVELS],
                    |a, b| std::array::from_fn(|l| std::array::from_fn(|v| a[l][v] + b[l][v])),
                );
            (mix.name, counts.map(|level| level.map(|c| f64::from(c) / records as f64)))
        })
        .collect()
}

#[test]
fn correct_models_are_called_wrong_as_often_as_stated() {
    // At 5 %: in 60 records of each mix, 11 or more come with a probability of 1e-4.
    for (name, shares) in false_alarms(60, 4_000_000, [0.05]) {
        for (view, share) in View::ALL.iter().zip(shares[0]) {
            assert!(share < 11.0 / 60.0, "{name} {view:?}: {share}");
        }
    }
}

/// The departure of a view, which must be significant.
fn departure(fit: &GoodnessOfFit, view: View) -> (f64, f64, f64) {
    let failures = fit.failures();
    let judged =
        failures.iter().find(|j| j.view == view).unwrap_or_else(|| panic!("{view:?}: {:?}", fit.views));
    (judged.departure.from, judged.departure.to, judged.departure.excess)
}

#[test]
fn a_disturbance_that_the_model_lacks_is_placed_in_every_view_that_shows_it() {
    let white = Composite::from(NoiseModel { n: 0.002, ..Default::default() });
    let disturbed = Composite {
        quasi_periodic: vec![Damped { rms_deg_h: 0.05, frequency_hz: 0.05, decay_time_s: 60.0 }],
        ..white.clone()
    };
    let given = Described { model: white, ..Default::default() };
    let samples = simulated(&disturbed, 11, 32_768);
    let fit = Record::of(&samples, 1 << 18).judge(Some(&given));
    // Full width at half power 1/(π·60 s) = 0.0053 Hz; power there 2σ²T = 0.3/2 over 0.0144 of white noise.
    let (from, to, excess) = departure(&fit, View::Frequency);
    assert!(from > 0.03 && from < 0.05 && to > 0.05 && to < 0.08 && excess > 1.0, "{from} {to} {excess}");
    // Autocorrelation of the disturbance: maxima at multiples of 20 s, minima between.
    let (lag, _, r) = departure(&fit, View::Lag);
    let expected =
        0.0025 / (0.0144 + 0.0025) * (-lag / 60.0).exp() * (2.0 * std::f64::consts::PI * 0.05 * lag).cos();
    assert!((r - expected).abs() < 0.04 && r.abs() > 0.08, "{lag} {r} {expected}");
    // Its Allan deviation is largest at 0.37 of its period.
    let (from, to, excess) = departure(&fit, View::AveragingTime);
    assert!(from <= 8.0 && (8.0..=256.0).contains(&to) && excess > 0.1, "{from} {to} {excess}");
    for octave in fit.octaves.iter().filter(|o| (4.0..=32.0).contains(&o.tau_s)) {
        let truth =
            disturbed.allan_variance(octave.tau_s, 1.0) / given.model.allan_variance(octave.tau_s, 1.0);
        assert!((octave.ratio / truth - 1.0).abs() < 0.1, "{octave:?} {truth}");
    }
    assert!(p_value(&fit, View::Amplitude).unwrap() > 0.001);
}

#[test]
fn heavy_tails_show_in_the_amplitudes_alone() {
    let white = Composite::from(NoiseModel { n: 0.002, ..Default::default() });
    let mut samples = simulated(&white, 12, 32_768);
    // One sample in a thousand five standard deviations off.
    for (i, y) in samples.iter_mut().enumerate().filter(|(i, _)| i % 1000 == 500) {
        *y += if i % 2000 == 500 { 0.6 } else { -0.6 };
    }
    let fit = Record::of(&samples, 1 << 18).judge(None);
    let failures: Vec<View> = fit.failures().iter().map(|j| j.view).collect();
    assert_eq!(failures, [View::Amplitude]);
    let amplitude = fit.amplitude.unwrap();
    assert!(amplitude.beyond > 15 && amplitude.expected_beyond < 3.0, "{amplitude:?}");
    assert!(amplitude.excess_kurtosis > 0.3);
}

#[test]
fn noise_above_the_block_rate_is_judged_on_single_samples() {
    let white = Composite::from(NoiseModel { n: 0.002, ..Default::default() });
    let markov = Composite {
        markov: vec![Damped { rms_deg_h: 0.05, frequency_hz: 0.0, decay_time_s: 1.5 }],
        ..white.clone()
    };
    let samples = simulated(&markov, 13, 65_536);
    let given = Described { model: white, ..Default::default() };
    let fit = Record::of(&samples, 2048).judge(Some(&given));
    assert_eq!(fit.whitened.as_ref().unwrap().step_s, 32.0);
    let samples_look = fit.sample_correlation.as_ref().unwrap();
    assert_eq!(samples_look.step_s, 1.0);
    assert!(samples_look.p_value < 1e-6 && samples_look.worst <= 3, "{samples_look:?}");
    let (lag, _, r) = departure(&fit, View::Lag);
    assert!(lag <= 3.0 && r > 0.03, "{lag} {r}");
}

#[test]
fn only_the_longest_stretch_is_whitened_and_its_share_is_known() {
    let white = Composite::from(NoiseModel { n: 0.002, ..Default::default() });
    let samples = simulated(&white, 14, 10_000);
    let mut record = Record::of(&samples, 1 << 18);
    for i in 2000..2500 {
        (record.blocks.mean[i], record.blocks.count[i]) = (f64::NAN, 0);
    }
    let whitened = record.judge(None).whitened.unwrap();
    assert_eq!(whitened.values.len(), 7500);
    assert!((whitened.share - 7500.0 / 9500.0).abs() < 1e-12);
    let variance = whitened.values.iter().map(|v| v * v).sum::<f64>() / 7500.0;
    assert!((variance - 1.0).abs() < 0.08, "{variance}");
}

#[test]
fn records_too_short_or_without_a_model_have_no_views() {
    let record = Record::of(&[0.1, -0.2, 0.3, 0.05, -0.1], 1 << 18);
    assert_eq!(record.judge(None), GoodnessOfFit::default());
    let constant = Record::of(&[1.0; 5000], 1 << 18);
    assert!(constant.judge(None).views.is_empty());
}

#[test]
#[ignore = "long study"]
fn study_of_false_alarms() {
    let number = |name: &str, otherwise: u64| {
        std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(otherwise)
    };
    let records = number("RECORDS", 2000);
    let seed = number("SEED", 1);
    let levels = [0.01, 0.05];
    let found = false_alarms(records, seed, levels);
    for (l, level) in levels.into_iter().enumerate() {
        eprintln!("| mix, level {level} | frequency | lag | averaging time | amplitude | jumps |");
        eprintln!("|---|--:|--:|--:|--:|--:|");
        let mut mean = [0.0; VIEWS];
        for (name, shares) in &found {
            let cells: Vec<String> = shares[l].iter().map(|s| format!("{:.2} %", 100.0 * s)).collect();
            eprintln!("| {name} | {} |", cells.join(" | "));
            mean.iter_mut().zip(shares[l]).for_each(|(m, s)| *m += s / found.len() as f64);
        }
        for (view, share) in View::ALL.iter().zip(mean) {
            eprintln!("mean of {view:?}: {:.2} %", 100.0 * share);
            // What a fitted walk took of the largest jump makes the last an upper bound.
            let least = if *view == View::Jump { 0.0 } else { 0.5 * level };
            assert!((least..=1.5 * level).contains(&share), "{view:?} at {level}: {share}");
        }
    }
}
