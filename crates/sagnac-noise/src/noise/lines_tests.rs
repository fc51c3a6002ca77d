use super::super::composite::{Composite, Damped, Line};
use super::super::data::BlockSeries;
use super::super::model::NoiseModel;
use super::super::simulate::{Setup, Simulator};
use super::super::welch::WelchAccumulator;
use super::*;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

#[derive(Clone, Copy, Debug)]
enum Mix {
    White,
    Flicker,
    Walk,
}

/// White noise of σ = 1, alone or with slow noise that rules the lower part of the spectrum.
fn noise(count: usize, mix: Mix, seed: u64) -> Vec<f64> {
    let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
    // Flicker as a sum of first-order processes, one an octave.
    let mut states = [0.0f64; 16];
    let mut walk = 0.0;
    (0..count)
        .map(|_| {
            let slow = match mix {
                Mix::White => 0.0,
                Mix::Flicker => {
                    for (k, s) in states.iter_mut().enumerate() {
                        let p = (-(0.5f64.powi(k as i32))).exp();
                        *s = p * *s + (1.0 - p * p).sqrt() * draw();
                    }
                    states.iter().sum::<f64>()
                }
                Mix::Walk => {
                    walk += 0.05 * draw();
                    walk
                }
            };
            slow + draw()
        })
        .collect()
}

#[test]
fn flanks_beside_the_zeros_of_a_moving_average_are_no_lines() {
    for (length, segment) in [(2, 2048), (4, 1024), (4, 4096), (7, 2048)] {
        let found = (0..40u64).filter(|seed| {
            let white = noise(36_000 + length, Mix::White, 5000 + seed);
            let mean: Vec<f64> =
                white.windows(length).map(|w| w.iter().sum::<f64>() / length as f64).collect();
            !search(&mean, segment).lines.is_empty()
        });
        // 1 in 100 is stated.
        assert!(found.count() <= 3, "{length} samples, segments of {segment}");
    }
}

fn search(samples: &[f64], segment: usize) -> LineSearch {
    let mut welch = WelchAccumulator::with_segment(segment);
    welch.push(samples, false);
    find_lines(&welch.finish().spectrum, 0.01, FALSE_ALARM_RATE)
}

fn false_alarms(records: u64, count: usize, segment: usize, mix: Mix) -> u64 {
    (0..records)
        .map(|seed| u64::from(!search(&noise(count, mix, 1000 + seed), segment).lines.is_empty()))
        .sum()
}

#[test]
fn noise_alone_raises_few_alarms() {
    for (mix, count, segment) in [
        (Mix::White, 1 << 14, 1024),
        (Mix::Flicker, 1 << 14, 1024),
        (Mix::Walk, 1 << 14, 1024),
        (Mix::White, 1 << 15, 256),
    ] {
        let alarms = false_alarms(40, count, segment, mix);
        // 40 searches at 1 %: more than 3 has a probability of 0.07 %. The study is `false-lines`.
        assert!(alarms <= 3, "{mix:?} {segment}: {alarms} of 40");
    }
}

#[test]
fn a_line_is_found_with_its_frequency_and_amplitude() {
    for mix in [Mix::White, Mix::Flicker, Mix::Walk] {
        for (seed, amplitude) in (0..20).zip([0.2, 0.3].into_iter().cycle()) {
            let mut y = noise(1 << 16, mix, seed);
            let frequency = 20.03 + 0.017 * seed as f64;
            y.iter_mut().enumerate().for_each(|(i, v)| {
                *v += amplitude * (std::f64::consts::TAU * frequency * 0.01 * i as f64 + 0.3).sin();
            });
            let found = search(&y, 4096);
            let near = |l: &&SpectralLine| (l.frequency_hz - frequency).abs() < 0.3 * l.resolution_hz;
            let line = found.lines.iter().find(near);
            let line = line.unwrap_or_else(|| panic!("{mix:?} {seed}: {:?}", found.lines));
            assert!((line.amplitude_deg_h / amplitude - 1.0).abs() < 0.25, "{mix:?} {line:?}");
            assert!(line.false_alarm_probability < 0.01 && line.excess > 2.0);
        }
    }
}

#[test]
fn a_strong_line_is_exact_and_its_harmonics_are_named() {
    let mut y = noise(1 << 16, Mix::White, 77);
    let turn = std::f64::consts::TAU * 0.01 * 4.17;
    y.iter_mut().enumerate().for_each(|(i, v)| {
        let t = turn * i as f64;
        *v += 5.0 * t.sin() + 2.0 * (2.0 * t).sin() + (3.0 * t + 1.0).sin();
    });
    let found = search(&y, 4096);
    assert_eq!(found.lines.len(), 3, "{:?}", found.lines);
    assert!((found.lines[0].frequency_hz - 4.17).abs() < 0.02 * found.lines[0].resolution_hz);
    assert!((found.lines[0].amplitude_deg_h / 5.0 - 1.0).abs() < 0.01);
    assert_eq!((found.lines[1].harmonic_of, found.lines[1].harmonic_order), (Some(0), 2));
    assert_eq!((found.lines[2].harmonic_of, found.lines[2].harmonic_order), (Some(0), 3));
}

#[test]
fn tails_of_the_f_distribution() {
    // scipy.stats.f.sf
    for (ratio, numerator, denominator, expected) in [
        (3.0, 62.0, 1000.0, 8.458_989_530e-13),
        (1.5, 400.0, 20_000.0, 5.592_305_116e-10),
        (8.0, 4.0, 200.0, 5.299_810_870e-6),
    ] {
        let got = upper_f(ratio, numerator, denominator);
        assert!((got / expected - 1.0f64).abs() < 0.1, "{got:e} {expected:e}");
    }
}

#[test]
fn odd_spectra_are_no_trouble() {
    assert_eq!(find_lines(&WelchSpectrum::default(), 1.0, 0.01), LineSearch::default());
    let flat = WelchSpectrum {
        segment_len: 64,
        segments: 3,
        effective_averages: 2.9,
        density: vec![0.0; 33],
        ..Default::default()
    };
    assert!(find_lines(&flat, 1.0, 0.01).lines.is_empty());
}

#[test]
fn the_floor_of_nearest_bins_of_a_level_spectrum_is_its_level() {
    // Mean over median of a mean of 50 is 1 + 1/150, and 20 bins are outside of the lobe.
    let (floor, spread) = nearest(&[2.0; 400], 200, 50.0);
    assert!((floor / 2.0 - 151.0 / 150.0).abs() < 1e-4, "{floor}");
    assert!((spread * 20.0 - 1.0).abs() < 0.01, "{spread}");
    // The bins of a line do not count.
    let mut density = vec![2.0; 400];
    density[200 - HALF_LOBE_BINS..=200 + HALF_LOBE_BINS].fill(1e6);
    assert_eq!(nearest(&density, 200, 50.0), (floor, spread));
}

fn evidence(model: &Composite, seed: u64) -> Evidence {
    let n = 36_000;
    let mean = Simulator::of(model, &Setup::for_record(seed, 1.0, n as u64)).take(n);
    let blocks = BlockSeries { block_len: 1, first_index: 0, count: vec![1; n], mean, rounding: vec![] };
    Evidence::new(&blocks, None, 1.0, &[])
}

fn line(frequency_hz: f64) -> SpectralLine {
    SpectralLine {
        frequency_hz,
        resolution_hz: 1.0 / 2048.0,
        amplitude_deg_h: 0.1,
        excess: 10.0,
        false_alarm_probability: 0.0,
        harmonic_of: None,
        harmonic_order: 1,
        sinusoid: None,
    }
}

#[test]
fn lines_are_told_from_disturbances_that_decay() {
    let white = Composite::from(NoiseModel { n: 0.0023, ..Default::default() });
    for seed in 0..20 {
        let frequency_hz = 0.05 + 1.7e-3 * seed as f64;
        let steady = Composite { lines: vec![Line { amplitude_deg_h: 0.05, frequency_hz }], ..white.clone() };
        assert!(is_coherent(&evidence(&steady, seed), &line(frequency_hz)), "line at {frequency_hz}");
        let process = Damped { rms_deg_h: 0.08, frequency_hz, decay_time_s: 1000.0 };
        let decaying = Composite { quasi_periodic: vec![process], ..white.clone() };
        assert!(!is_coherent(&evidence(&decaying, seed), &line(frequency_hz)), "{frequency_hz}");
    }
}
