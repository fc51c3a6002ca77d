use super::*;
use crate::noise::digest::{DigestPlan, RateAccumulator};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::TAU;

/// White noise of a standard deviation of 2 deg/h, sampled every 0.1 s: 4·2·0.1 (deg/h)²/Hz one-sided.
const SIGMA: f64 = 2.0;
const TAU0_S: f64 = 0.1;
const DENSITY: f64 = SIGMA * SIGMA * 2.0 * TAU0_S;

fn white(seed: u64, count: usize) -> Vec<f64> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    (0..count)
        .map(|_| {
            let z: f64 = StandardNormal.sample(&mut rng);
            SIGMA * z
        })
        .collect()
}

fn digest(samples: &[f64]) -> RateDigest {
    let mut accumulator = RateAccumulator::new(DigestPlan::new(TAU0_S));
    accumulator.push(samples, 0, false);
    accumulator.finish()
}

fn spectrum(samples: &[f64], lines: &[SpectralLine]) -> OutputSpectrum {
    OutputSpectrum::of(&digest(samples).welch, TAU0_S, lines).unwrap()
}

fn flat(from_hz: f64, to_hz: f64, density: f64) -> [MaskPoint; 2] {
    [MaskPoint { frequency_hz: from_hz, density }, MaskPoint { frequency_hz: to_hz, density }]
}

fn line(frequency_hz: f64, amplitude_deg_h: f64, resolution_hz: f64) -> SpectralLine {
    SpectralLine {
        frequency_hz,
        resolution_hz,
        amplitude_deg_h,
        excess: 100.0,
        false_alarm_probability: 1e-9,
        harmonic_of: None,
        harmonic_order: 1,
        sinusoid: None,
    }
}

#[test]
fn the_mean_of_a_band_scatters_as_its_degrees_of_freedom_say() {
    // Narrow, wide, and all that the spectrum shows.
    for (from_hz, to_hz) in [(1.0, 1.2), (0.5, 2.0), (0.2, 4.9)] {
        let means: Vec<BandMean> = (0..200)
            .map(|seed| spectrum(&white(seed, 8192), &[]).mean(Band { from_hz, to_hz }, |_| 1.0).unwrap())
            .collect();
        let count = means.len() as f64;
        let mean = means.iter().map(|m| m.power).sum::<f64>() / count;
        let variance = means.iter().map(|m| (m.power / DENSITY - 1.0).powi(2)).sum::<f64>() / count;
        let stated = means.iter().map(|m| 2.0 / m.dof).sum::<f64>() / count;
        assert!((mean / DENSITY - 1.0).abs() < 4.0 * (stated / count).sqrt(), "{from_hz}: {mean}");
        // A variance of 200 values scatters by 10 %.
        assert!((variance / stated - 1.0).abs() < 0.35, "{from_hz}: {variance} {stated}");
    }
}

#[test]
fn wide_bands_weigh_as_the_samples_in_them() {
    // Twice the product of length and width: 2·819.2 s·3 Hz.
    let mean = spectrum(&white(3, 8192), &[]).mean(Band { from_hz: 1.0, to_hz: 4.0 }, |_| 1.0).unwrap();
    assert!((mean.dof / (2.0 * 819.2 * 3.0) - 1.0).abs() < 0.06, "{}", mean.dof);
}

#[test]
fn a_band_outside_the_spectrum_is_not_shown() {
    let spectrum = spectrum(&white(1, 8192), &[]);
    let own = spectrum.range();
    assert_eq!(own.to_hz, 5.0);
    assert!(spectrum.shows(own));
    assert!(!spectrum.shows(Band { to_hz: 5.1, ..own }) && !spectrum.shows(Band { from_hz: 0.01, ..own }));
    assert_eq!(spectrum.mean(Band { from_hz: 1.0001, to_hz: 1.0002 }, |_| 1.0), None);
    let short = RateAccumulator::new(DigestPlan::new(TAU0_S)).finish();
    assert!(OutputSpectrum::of(&short.welch, TAU0_S, &[]).is_none());
}

#[test]
fn a_line_is_left_out_of_its_band() {
    let samples: Vec<f64> =
        (0..).zip(white(5, 8192)).map(|(i, y)| y + 3.0 * (TAU * 1.5 * TAU0_S * f64::from(i)).sin()).collect();
    let step = spectrum(&samples, &[]).step_hz;
    let band = Band { from_hz: 1.0, to_hz: 2.0 };
    let with = spectrum(&samples, &[]).mean(band, |_| 1.0).unwrap().power;
    let without = spectrum(&samples, &[line(1.5, 3.0, step)]).mean(band, |_| 1.0).unwrap().power;
    // The line adds its power of 4.5 (deg/h)² over 1 Hz.
    assert!((with - DENSITY - 4.5).abs() < 0.6 && (without / DENSITY - 1.0).abs() < 0.12, "{with} {without}");
}

#[test]
fn a_mask_is_straight_in_the_logarithms() {
    let mask = [(0.1, 8.0), (1.0, 2.0), (10.0, 2.0)]
        .map(|(frequency_hz, density)| MaskPoint { frequency_hz, density });
    for (hz, expected) in
        [(0.1, Some(8.0)), (10f64.powf(-0.5), Some(4.0)), (1.0, Some(2.0)), (5.0, Some(2.0))]
    {
        let found = mask_at(&mask, hz);
        assert!(
            found.zip(expected).is_some_and(|(a, b): (f64, f64)| (a - b).abs() < 1e-9),
            "{hz}: {found:?}"
        );
    }
    assert_eq!((mask_at(&mask, 0.09), mask_at(&mask, 10.1), mask_at(&[], 1.0)), (None, None, None));
}

#[test]
fn sections_cover_a_mask_without_a_gap() {
    let spectrum = spectrum(&white(1, 8192), &[]);
    let sections = spectrum.sections(&flat(0.05, 8.0, 1.0));
    assert_eq!(sections.first().map(|s| s.from_hz), Some(spectrum.range().from_hz));
    assert_eq!(sections.last().map(|s| s.to_hz), Some(5.0));
    assert!(sections.windows(2).all(|w| (w[0].to_hz - w[1].from_hz).abs() < 1e-6), "{sections:?}");
    let bins = |s: &Band| spectrum.powers(*s, |_| 1.0).iter().flatten().count();
    assert!(sections.iter().all(|s| bins(s) >= LEAST_BINS_OF_SECTION), "{sections:?}");
    assert!(spectrum.sections(&[]).is_empty() && spectrum.mask_ratio(&flat(6.0, 8.0, 1.0)).is_none());
}

#[test]
fn the_largest_ratio_is_bounded_whether_one_section_rules_or_all_are_alike() {
    // A flat mask: every section is alike. One that is low at one place: that section rules.
    let low = [(0.2, 10.0), (1.0, 10.0), (1.05, 0.5), (1.4, 0.5), (1.5, 10.0), (4.8, 10.0)]
        .map(|(frequency_hz, density)| MaskPoint { frequency_hz, density });
    for (mask, truth) in
        [(flat(0.2, 4.8, 0.5).to_vec(), DENSITY.sqrt() / 0.5), (low.to_vec(), DENSITY.sqrt() / 0.5)]
    {
        let (mut above, mut below) = (0, 0);
        for seed in 0..200 {
            let found = spectrum(&white(seed, 4096), &[]).mask_ratio(&mask).unwrap();
            let bound = |confidence| found.spread.bound(found.ratio, confidence).unwrap();
            assert!(found.sections > 10);
            above += usize::from(bound(0.95) < truth);
            below += usize::from(bound(0.05) > truth);
        }
        // 5 % of 200 is 10, with a deviation of 3.
        assert!(above <= 19 && below <= 19, "{above} {below}");
    }
}

#[test]
fn an_rms_of_white_noise_has_as_many_degrees_of_freedom_as_samples() {
    let found = digest(&white(2, 40_000));
    let dof = rms_dof(&found, &[]).unwrap();
    assert!((dof / 40_000.0 - 1.0).abs() < 0.1, "{dof}");
    assert_eq!(rms_dof(&digest(&[1.0; 4000]), &[]), None);
}

#[test]
fn an_rms_scatters_as_its_degrees_of_freedom_say() {
    // Means of four neighbours, and white noise with a line four times as strong.
    let smooth = |y: Vec<f64>| y.windows(4).map(|w| w.iter().sum::<f64>() / 4.0).collect::<Vec<f64>>();
    let with_line = |y: Vec<f64>| -> Vec<f64> {
        (0..).zip(y).map(|(i, y)| y + 5.66 * (TAU * 1.5 * TAU0_S * f64::from(i)).sin()).collect()
    };
    let resolution = spectrum(&white(0, 8192), &[]).step_hz;
    let of_line = [line(1.5, 5.66, resolution)];
    type Made<'a> = &'a dyn Fn(Vec<f64>) -> Vec<f64>;
    let kinds: [Made<'_>; 2] = [&smooth, &with_line];
    for (kind, lines) in kinds.into_iter().zip([&[][..], &of_line[..]]) {
        let found: Vec<(f64, f64)> = (0..150)
            .map(|seed| {
                let digest = digest(&kind(white(seed, 8192)));
                (digest.histogram.standard_deviation.powi(2), rms_dof(&digest, lines).unwrap())
            })
            .collect();
        let count = found.len() as f64;
        let mean = found.iter().map(|f| f.0).sum::<f64>() / count;
        let variance = found.iter().map(|f| (f.0 / mean - 1.0).powi(2)).sum::<f64>() / (count - 1.0);
        let stated = found.iter().map(|f| 2.0 / f.1).sum::<f64>() / count;
        assert!((variance / stated - 1.0).abs() < 0.4, "{variance} {stated}");
    }
}
