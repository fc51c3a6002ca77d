use super::*;
use crate::noise::digest::{DigestPlan, PartSettings, RateAccumulator, RateDigest};
use crate::noise::family::Estimator;
use crate::noise::tau_grid::TauGrid;
use proptest::prelude::*;

/// Relative difference of a sum from that of one pass.
const TOLERANCE: f64 = 1e-12;

/// Rates with an offset, a drift and a scatter that no period of a window repeats, deg/h.
fn rates(count: usize, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (0..count)
        .map(|i| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let scatter = (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
            10.0 + 2.0 * scatter + 1e-5 * i as f64
        })
        .collect()
}

/// A recording: stretches of samples with the grid index of the first.
type Recording = Vec<(u64, Vec<f64>)>;

fn recording(lengths: &[usize], seed: u64) -> Recording {
    let mut index = 7;
    lengths
        .iter()
        .enumerate()
        .map(|(k, n)| {
            let first = index;
            index += *n as u64 + 3 + k as u64;
            (first, rates(*n, seed + k as u64))
        })
        .collect()
}

/// The parts between cuts, which count samples of all stretches: each the pieces it holds, with where it starts.
fn parts(recording: &Recording, cuts: &[usize]) -> Vec<(PartStart, Recording)> {
    let total = recording.iter().map(|s| s.1.len()).sum();
    let mut bounds: Vec<usize> = cuts.iter().map(|c| c % (total + 1)).chain([0, total]).collect();
    bounds.sort_unstable();
    bounds
        .windows(2)
        .map(|bound| {
            let (mut start, mut pieces, mut before) = (None, vec![], 0);
            for (first, samples) in recording {
                let from = bound[0].clamp(before, before + samples.len()) - before;
                let to = bound[1].clamp(before, before + samples.len()) - before;
                // An empty part lies between two samples, too.
                if (before..before + samples.len()).contains(&bound[0]) || from < to {
                    let here = PartStart { first_index: first + from as u64, samples_before: from as u64 };
                    start.get_or_insert(here);
                }
                if from < to {
                    pieces.push((first + from as u64, samples[from..to].to_vec()));
                }
                before += samples.len();
            }
            (start.unwrap_or_default(), pieces)
        })
        .collect()
}

fn plan() -> DigestPlan {
    DigestPlan {
        estimators: vec![Estimator::Allan, Estimator::Modified, Estimator::Hadamard],
        taus: TauGrid::Octave,
        window_lengths_s: vec![100.0, 7.0],
        ..DigestPlan::new(0.1)
    }
}

fn accumulated(start: PartStart, pieces: &Recording, settings: PartSettings) -> RateAccumulator {
    let mut digest = RateAccumulator::of_part(plan(), start, settings);
    for (k, (first, samples)) in pieces.iter().enumerate() {
        // In blocks of odd length, as a file delivers them.
        for (b, block) in samples.chunks(997).enumerate() {
            let continues = b > 0 || (k == 0 && start.samples_before > 0);
            digest.push(block, first + 997 * b as u64, continues);
        }
    }
    digest
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= TOLERANCE * a.abs().max(b.abs()) || a == b || (a.is_nan() && b.is_nan())
}

fn assert_equal(merged: &RateDigest, whole: &RateDigest) {
    assert_eq!((merged.samples, merged.unusable), (whole.samples, whole.unusable));
    assert_eq!((merged.min, merged.max), (whole.min, whole.max));
    assert!(near(merged.mean, whole.mean));
    assert_eq!(merged.deviations.stretches, whole.deviations.stretches);
    for (a, b) in merged.deviations.curves.iter().zip(&whole.deviations.curves) {
        assert_eq!((a.estimator, a.points.len()), (b.estimator, b.points.len()));
        for (p, q) in a.points.iter().zip(&b.points) {
            assert_eq!((p.m, p.terms, p.stride), (q.m, q.terms, q.stride), "{:?}", a.estimator);
            assert!(near(p.deviation, q.deviation), "{:?} {p:?} {q:?}", a.estimator);
        }
    }
    let (a, b) = (&merged.welch, &whole.welch);
    assert_eq!((a.unused_samples, a.spectrum.segments), (b.unused_samples, b.spectrum.segments));
    assert!(near(a.spectrum.effective_averages, b.spectrum.effective_averages));
    assert!(near(a.spectrum.averages_in_sums, b.spectrum.averages_in_sums));
    assert_eq!(a.spectrum.density.len(), b.spectrum.density.len());
    let level = b.spectrum.density.iter().sum::<f64>();
    for (p, q) in a.spectrum.density.iter().zip(&b.spectrum.density) {
        assert!((p - q).abs() <= TOLERANCE * level, "{p} {q}");
    }
    let (a, b) = (&merged.blocks, &whole.blocks);
    assert_eq!((a.block_len, a.first_index, &a.count), (b.block_len, b.first_index, &b.count));
    assert!(a.mean.iter().zip(&b.mean).all(|(a, b)| near(*a, *b)));
    for (a, b) in merged.windows.iter().zip(&whole.windows) {
        assert_eq!((a.n, a.samples, &a.per_stretch), (b.n, b.samples, &b.per_stretch));
        assert!(near(a.mean, b.mean));
        assert!((a.standard_deviation - b.standard_deviation).abs() < 1e-12 || a.n < 2);
        let (a, b) = (a.means.iter().flatten(), b.means.iter().flatten());
        assert!(a.zip(b).all(|(a, b)| near(*a, *b)));
    }
    let (a, b) = (&merged.histogram, &whole.histogram);
    assert_eq!(
        (a.samples, a.unused_samples, a.below, a.above),
        (b.samples, b.unused_samples, b.below, b.above)
    );
    assert_eq!((&a.counts, a.scale), (&b.counts, b.scale));
    assert!(near(a.standard_deviation, b.standard_deviation));
    assert!((a.skewness - b.skewness).abs() < TOLERANCE);
    assert!((a.excess_kurtosis - b.excess_kurtosis).abs() < TOLERANCE);
    let (a, b) = (&merged.envelope, &whole.envelope);
    assert_eq!((a.bin_len, a.first_index, a.bins.len()), (b.bin_len, b.first_index, b.bins.len()));
    for (p, q) in a.bins.iter().zip(&b.bins) {
        assert!(p.count == q.count && (q.count == 0 || (p.min, p.max) == (q.min, q.max)));
        assert!(near(p.mean, q.mean));
    }
    assert_eq!(merged.quietest_deg_h, whole.quietest_deg_h);
}

/// Parts between cuts merged in their order, and in pairs from the end, against one pass.
fn check(recording: &Recording, cuts: &[usize], dense_below: Option<u64>) {
    let settings = PartSettings { segment_len: Some(256), histogram_scale_deg_h: Some(0.6), dense_below };
    let first = PartStart { first_index: 7, samples_before: 0 };
    let whole = accumulated(first, recording, settings).finish();
    let parts: Vec<RateAccumulator> = parts(recording, cuts)
        .into_iter()
        .map(|(start, pieces)| accumulated(start, &pieces, settings))
        .collect();
    let onwards = parts.iter().cloned().reduce(|a, b| a.merged(b).unwrap()).unwrap();
    assert_equal(&onwards.finish(), &whole);
    let backwards = parts.into_iter().rev().reduce(|b, a| a.merged(b).unwrap()).unwrap();
    assert_equal(&backwards.finish(), &whole);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn merged_parts_equal_one_pass(
        lengths in prop::collection::vec(1usize..9000, 1..4),
        cuts in prop::collection::vec(0usize..30_000, 0..6),
        seed in 0u64..1000,
        dense in prop::option::of(0u64..40),
    ) {
        check(&recording(&lengths, seed), &cuts, dense);
    }
}

#[test]
fn cuts_beside_windows_and_gaps_and_parts_of_a_few_samples() {
    let recording = recording(&[5000, 3, 4100], 3);
    for dense in [None, Some(0), Some(8)] {
        // Empty parts; cuts at the gaps and one sample beside them, at ends of blocks, segments and windows.
        check(&recording, &[0, 0, 5000, 5003, 9103], dense);
        check(&recording, &[331, 331, 5001, 5001], dense);
        check(&recording, &[2000, 2000, 2000, 7000, 7000], dense);
        check(&recording, &[1, 2, 3, 4999, 5001, 5002, 5004, 9102], dense);
        check(&recording, &[64, 256, 1000, 1024, 1025, 4096, 4097], dense);
        check(&recording, &(0..400).map(|k| 1000 + 11 * k).collect::<Vec<_>>(), dense);
    }
}

#[test]
fn a_part_that_begins_elsewhere_or_has_other_settings_is_refused() {
    let samples = rates(3000, 1);
    let settings =
        PartSettings { segment_len: Some(256), histogram_scale_deg_h: Some(0.6), dense_below: Some(0) };
    let part = |from: usize, to: usize, told: u64, settings: PartSettings| {
        let start = PartStart { first_index: from as u64, samples_before: told };
        let mut part = RateAccumulator::of_part(plan(), start, settings);
        part.push(&samples[from..to], from as u64, told > 0);
        part
    };
    let first = || part(0, 1000, 0, settings);
    let wrong = first().merged(part(1000, 2000, 999, settings));
    assert_eq!(wrong.err(), Some(MergeError::Position { expected: 999, found: 1000 }));
    for other in [
        PartSettings { segment_len: Some(512), ..settings },
        PartSettings { histogram_scale_deg_h: Some(0.5), ..settings },
        PartSettings { dense_below: Some(1 << 12), ..settings },
    ] {
        let refused = first().merged(part(1000, 3000, 1000, other)).err();
        assert_eq!(refused, Some(MergeError::Settings), "{other:?}");
    }
    assert!(first().merged(part(1000, 3000, 1000, settings)).is_ok());
}

#[test]
fn a_periodogram_that_has_not_chosen_follows_any_other() {
    use crate::noise::welch::WelchAccumulator;
    let samples = rates(20_000, 5);
    let mut whole = WelchAccumulator::new();
    whole.push(&samples, false);
    let mut first = WelchAccumulator::new();
    first.push(&samples[..7001], false);
    let mut second = WelchAccumulator::of_part(7001, None);
    second.push(&samples[7001..], true);
    first.merge(second).unwrap();
    assert_eq!(first.finish(), whole.finish());
}
