//! Lines that wander, come and go, or sweep: power of the whitened residual along straight tracks in time and frequency.
//!
//! The series is cut into segments and each is transformed; under a true hypothesis the powers are independent exponential
//! numbers of mean 1, and so the sum over a track of N segments follows a gamma law. A sweep of which each segment holds
//! little, far below any threshold for a single tile, adds up along its track.

use super::departure::{Departure, White};
use crate::effect::{Domain, Place};
use crate::estimate::ln_chi_square_tail;
use crate::mismatch::several::ln_least_of;
use crate::mismatch::spectral_data::SpectralData;
use crate::numeric::parallel;
use sagnac_fft::real_forward;
use std::ops::Range;

/// Numbers of segments that the record is cut into.
const SEGMENT_COUNTS: [usize; 2] = [16, 64];
/// Tracks that are followed at most for one number of segments.
const MAX_TRACKS: usize = 1_000_000;
/// Fewest samples of a segment.
const MIN_SEGMENT_SAMPLES: usize = 32;
/// Fewest segments of a part of a track.
const MIN_PART_SEGMENTS: usize = 4;
/// Frequencies at the lower end that are left out: the mean of a segment and what leaks from it.
const LEFT_OUT: usize = 4;
/// Tracks that are followed together.
const SIDE_BY_SIDE: usize = 64;

/// The best part of a track of some number of segments.
#[derive(Clone, Copy)]
struct Best {
    power: f64,
    /// First and end segment, first and last frequency bin of the whole track.
    segments: (usize, usize),
    bins: (usize, usize),
}

const NONE: Best = Best { power: 0.0, segments: (0, 1), bins: (0, 0) };

/// The most powerful track.
pub fn all(spectral: &SpectralData, white: &White) -> Option<Departure> {
    let found = SEGMENT_COUNTS.into_iter().filter_map(|segments| over(&white.series, segments));
    let (best, length, ln_p) = found.min_by(|a, b| a.2.total_cmp(&b.2))?;
    let drivers = &spectral.drivers;
    // Segments are transformed with as many zeros: a bin is half of their resolution.
    let hz = 0.5 / (length as f64 * drivers.dt_s);
    let (low, high) = (best.bins.0.min(best.bins.1), best.bins.0.max(best.bins.1));
    let at = |segment: usize| drivers.time_s(0) + (segment * length) as f64 * drivers.dt_s;
    Some(Departure {
        test: "track",
        place: Place {
            domain: Domain::Frequency,
            from: (low.saturating_sub(1)) as f64 * hz,
            to: (high + 1) as f64 * hz,
        },
        beside: Some(Place { domain: Domain::Time, from: at(best.segments.0), to: at(best.segments.1) }),
        ln_p,
        shape: None,
    })
}

/// The best track over so many segments, the samples of each, and the logarithm of its probability.
fn over(series: &[f64], segments: usize) -> Option<(Best, usize, f64)> {
    let length = series.len() / segments;
    if length < MIN_SEGMENT_SAMPLES {
        return None;
    }
    let powers = powers(series, segments, length)?;
    let bins = length;
    let reach = (MAX_TRACKS / (2 * bins)).clamp(1, bins);
    let parts = parts(segments);
    let mut lengths: Vec<usize> = parts.iter().map(|p| p.len()).collect();
    lengths.sort_unstable();
    lengths.dedup();
    let place = |part: &Range<usize>| lengths.binary_search(&part.len()).unwrap_or(0);
    let placed: Vec<(Range<usize>, usize)> = parts.iter().map(|p| (p.clone(), place(p))).collect();
    let slope = |i: usize| i as isize - reach as isize;
    let best = parallel::map(2 * reach + 1, |i| of_slope(slope(i), &powers, segments, bins, &placed));
    let larger = |a: Vec<Best>, b: Vec<Best>| {
        a.into_iter().zip(b).map(|(a, b)| if b.power > a.power { b } else { a }).collect::<Vec<Best>>()
    };
    let best = best.into_iter().fold(vec![NONE; lengths.len()], larger);
    let trials = (bins * (2 * reach).min(bins) * parts.len()) as f64;
    let rated = lengths.iter().zip(best).map(|(n, best)| {
        (best, length, ln_least_of(ln_chi_square_tail(2.0 * best.power, 2.0 * *n as f64), trials))
    });
    rated.min_by(|a, b| a.2.total_cmp(&b.2))
}

/// The best tracks that rise by `change` bins over the record, one a place of the parts. Many are followed side by side.
fn of_slope(
    change: isize,
    powers: &[f64],
    segments: usize,
    bins: usize,
    parts: &[(Range<usize>, usize)],
) -> Vec<Best> {
    // There are no more places than parts.
    let mut best = vec![NONE; parts.len()];
    let mut sums = vec![[0.0; SIDE_BY_SIDE]; segments + 1];
    let step = change as f64 / (segments - 1) as f64;
    let offsets: Vec<isize> = (0..segments).map(|s| (step * s as f64 + 0.5).floor() as isize).collect();
    let (lowest, highest) = (LEFT_OUT as isize, bins as isize - 1);
    // Both ends are among the bins that are looked at.
    let (low, high) = (lowest.max(lowest - change), highest.min(highest - change));
    for first in (low..=high).step_by(SIDE_BY_SIDE) {
        let width = SIDE_BY_SIDE.min((high - first + 1) as usize);
        for (s, offset) in offsets.iter().enumerate() {
            let begin = s * bins + (first + offset) as usize;
            let (before, after) = sums.split_at_mut(s + 1);
            let (before, after) = (&before[s], &mut after[0]);
            let terms = before.iter().zip(&powers[begin..begin + width]);
            after.iter_mut().zip(terms).for_each(|(sum, (before, power))| *sum = before + power);
            after[width..].fill(0.0);
        }
        for (part, place) in parts {
            let mut part_powers = sums[part.end];
            part_powers.iter_mut().zip(&sums[part.start]).for_each(|(power, before)| *power -= before);
            let most = largest(&part_powers);
            if most > best[*place].power {
                let at = part_powers.iter().position(|p| *p >= most).unwrap_or(0) as isize;
                let bin = |s: usize| (first + at + offsets[s]) as usize;
                let bins = (bin(part.start), bin(part.end - 1));
                best[*place] = Best { power: most, segments: (part.start, part.end), bins };
            }
        }
    }
    best
}

/// The largest of some powers.
fn largest(powers: &[f64; SIDE_BY_SIDE]) -> f64 {
    let mut lanes = [0.0; 8];
    for chunk in powers.chunks_exact(lanes.len()) {
        lanes.iter_mut().zip(chunk).for_each(|(most, p)| *most = if *p > *most { *p } else { *most });
    }
    lanes.into_iter().fold(0.0, f64::max)
}

/// Dyadic parts of a track, overlapping by half, and the whole of it.
fn parts(segments: usize) -> Vec<Range<usize>> {
    let mut out = vec![];
    let mut length = segments;
    while length >= MIN_PART_SEGMENTS {
        let step = (length / 2).max(1);
        out.extend((0..=segments - length).step_by(step).map(|from| from..from + length));
        length /= 2;
    }
    out
}

/// Powers of the segments, one row each, exponential of mean 1 in white noise.
fn powers(series: &[f64], segments: usize, length: usize) -> Option<Vec<f64>> {
    let plan = real_forward(2 * length);
    let (mut padded, mut spectrum) = (plan.make_input_vec(), plan.make_output_vec());
    let mut out = Vec::with_capacity(segments * length);
    for segment in series.chunks_exact(length).take(segments) {
        padded[..length].copy_from_slice(segment);
        padded[length..].fill(0.0);
        plan.process(&mut padded, &mut spectrum).ok()?;
        out.extend(spectrum.iter().take(length).map(|v| v.norm_sqr() / length as f64));
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Drivers;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    fn found(added: impl Fn(f64) -> f64, seed: u64) -> Departure {
        let n = 16_384;
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
        let series: Vec<f64> = (0..n)
            .map(|i| {
                let e: f64 = StandardNormal.sample(&mut rng);
                e + added(i as f64)
            })
            .collect();
        let drivers = Drivers { dt_s: 1.0, samples: n, averaged: 1, ..Drivers::default() };
        let spectral = SpectralData::new(drivers, &vec![0.0; n], &[]);
        all(&spectral, &White { modes: vec![], series, roots: vec![] }).unwrap()
    }

    #[test]
    fn a_sweep_too_weak_for_any_segment_is_found_along_its_track() {
        // From 0.05 to 0.15 Hz with a fifth of the deviation of a sample.
        let phase = |t: f64| std::f64::consts::TAU * (0.05 * t + 0.5 * 0.1 / 16_384.0 * t * t);
        let sweep = found(|t| 0.2 * phase(t).sin(), 3);
        assert!(sweep.ln_p < -20.0, "{sweep:?}");
        assert!(sweep.place.from < 0.06 && sweep.place.to > 0.14, "{sweep:?}");
        // A line during a quarter of the record.
        let line = found(|t| if (6000.0..10_000.0).contains(&t) { 0.25 * (0.9 * t).sin() } else { 0.0 }, 4);
        let hz = 0.9 / std::f64::consts::TAU;
        assert!(line.ln_p < -10.0 && line.place.from < hz && line.place.to > hz, "{line:?}");
        let time = line.beside.unwrap();
        assert!(time.from >= 4000.0 && time.to <= 12_000.0, "{time:?}");
    }

    #[test]
    fn noise_alone_departs_no_more_often_than_its_probability() {
        let departs = (0..40).filter(|seed| found(|_| 0.0, 100 + seed).ln_p < (0.05f64).ln()).count();
        // 2 of 40 on average, if the parts were independent.
        assert!(departs <= 5, "{departs} of 40");
    }

    #[test]
    fn parts_cover_a_track_in_dyadic_lengths() {
        assert_eq!(parts(8), [0..8, 0..4, 2..6, 4..8]);
    }
}
