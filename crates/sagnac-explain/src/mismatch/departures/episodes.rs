//! Power of a band that comes and goes: events that are each too weak to stand out, but recur.
//!
//! The modes of a band by themselves, transformed back, are independent standard normal numbers over the same time. Each
//! window of them has a power. Two numbers of the powers are judged over parts of the record. The sum of the squares of their
//! normal numbers (Wilson and Hilferty), of those above zero, grows where a band is louder all the time or swells; the number of
//! windows beyond a level that few reach (Berk and Jones 1979) grows where short events are scattered over the record.

use super::departure::{Departure, Shape, White, ln_at_least, windows};
use crate::effect::{Domain, Place};
use crate::estimate::{ln_chi_square_tail, normal_two_sided};
use crate::mismatch::several::ln_least_of;
use crate::mismatch::spectral_data::SpectralData;
use crate::numeric::cosine::{fast_length, inverse_dct2};
use crate::numeric::parallel;
use crate::numeric::special::chi_square_normal;
use crate::numeric::sums::cumulated;

/// Widths of the bands, octaves.
const BAND_WIDTHS_OCTAVES: [f64; 5] = [2.0, 1.0, 0.5, 0.25, 0.125];
/// Fewest modes of a band.
const MIN_BAND_MODES: usize = 48;
/// Shortest window, in points of its band.
const MIN_WINDOW_POINTS: usize = 2;
/// Fewest windows of a part of the record.
const MIN_WINDOWS: usize = 4;
/// Most parts of the record, each a power of two shorter than the one before.
const MAX_PARTS: usize = 16;
/// Standard deviations of a sum up to which it is no departure.
const MAX_USUAL_SIGMAS: f64 = 3.0;
/// Normal numbers beyond which windows are counted.
const COUNTED_LEVELS: [f64; 4] = [3.0, 3.5, 4.0, 4.5];
/// Normal number from which a window counts as an episode.
const EPISODE_LEVEL: f64 = COUNTED_LEVELS[0];

/// The largest departure of a band.
#[derive(Clone, Copy)]
struct Best {
    ln_p: f64,
    /// First mode and number of modes.
    band: (usize, usize),
    /// Points of a window.
    window: usize,
    /// First and last window of the part.
    part: (usize, usize),
    trials: f64,
}

const NONE: Best = Best { ln_p: 0.0, band: (0, 1), window: 1, part: (0, 1), trials: 0.0 };

/// Bands from the highest mode down, overlapping by half, as first mode and number of modes. The numbers are those that are fast
/// to transform.
fn bands(modes: usize) -> Vec<(usize, usize)> {
    let mut out = vec![];
    for width in BAND_WIDTHS_OCTAVES {
        let mut high = modes as f64;
        loop {
            let low = high * (-width).exp2();
            let (first, end) = (low as usize, high as usize);
            if end - first < MIN_BAND_MODES || first == 0 {
                break;
            }
            let modes = fast_length(end - first);
            out.push((end - modes, modes));
            high *= (-0.5 * width).exp2();
        }
    }
    out
}

/// Powers of the windows of a band over the number of their points.
fn powers(series: &[f64], window: usize) -> Vec<f64> {
    series.chunks_exact(window).map(|w| w.iter().map(|v| v * v).sum::<f64>() / window as f64).collect()
}

/// Normal number of the power of a window.
fn normal(power: f64, window: usize) -> f64 {
    chi_square_normal(power * window as f64, window as f64)
}

/// Share of windows beyond a normal number: that of the χ² there, of which the normal number of a short window is an approximation.
fn share_beyond(level: f64, window: usize) -> f64 {
    let dof = window as f64;
    let a = 2.0 / (9.0 * dof);
    let power = dof * (1.0 - a + level * a.sqrt()).powi(3);
    ln_chi_square_tail(power, dof).exp().max(0.5 * normal_two_sided(level))
}

/// ln of the probability of a sum of scores of some windows: a gamma law of mean ½ and variance 5/4 each.
fn ln_tail(sum: f64, windows: usize) -> f64 {
    ln_chi_square_tail(0.8 * sum, 0.4 * windows as f64)
}

/// Sums over the windows of one length in one band.
struct Looks {
    scores: Vec<f64>,
    /// For each level, how many windows are beyond it, and the share that is expected to be.
    counts: Vec<(Vec<f64>, f64)>,
}

impl Looks {
    fn new(normals: &[f64], window: usize) -> Looks {
        let beyond = |level: f64| {
            let counts = cumulated(normals.iter().map(|z| f64::from(u8::from(*z > level))));
            (counts, share_beyond(level, window))
        };
        Looks {
            scores: cumulated(normals.iter().map(|z| z.max(0.0).powi(2))),
            counts: COUNTED_LEVELS.map(beyond).into(),
        }
    }

    /// ln of the least probability over a part, and how many numbers were looked at.
    fn judge(&self, from: usize, to: usize) -> (f64, f64) {
        let windows = to - from;
        // A usual number is not worked out.
        let large = |seen: f64, mean: f64, variance: f64| seen > mean + MAX_USUAL_SIGMAS * variance.sqrt();
        let (sum, many) = (self.scores[to] - self.scores[from], windows as f64);
        let by_sum = if large(sum, 0.5 * many, 1.25 * many) { ln_tail(sum, windows) } else { 0.0 };
        let by_count = |(counts, share): &(Vec<f64>, f64)| {
            let (seen, expected) = (counts[to] - counts[from], share * many);
            let judged = large(seen, expected, expected);
            if judged { ln_at_least(seen.round() as usize, expected) } else { 0.0 }
        };
        let least = self.counts.iter().map(by_count).fold(by_sum, f64::min);
        (least, 1.0 + self.counts.len() as f64)
    }
}

fn in_band(modes: &[f64], band: (usize, usize)) -> Best {
    let (first, m) = band;
    let series = inverse_dct2(&modes[first..first + m]);
    let mut best = NONE;
    let mut window = MIN_WINDOW_POINTS;
    while m / window >= 8 {
        let normals: Vec<f64> = powers(&series, window).into_iter().map(|p| normal(p, window)).collect();
        let looks = Looks::new(&normals, window);
        windows(normals.len(), (normals.len() / MAX_PARTS).max(MIN_WINDOWS), |from, to| {
            let (ln_p, looked) = looks.judge(from, to);
            best.trials += looked;
            if ln_p < best.ln_p {
                best = Best { ln_p, band, window, part: (from, to), ..best };
            }
        });
        window *= 2;
    }
    best
}

/// The band and the part of the record in which power most comes and goes.
pub fn all(spectral: &SpectralData, white: &White) -> Option<Departure> {
    let better = |a: Best, b: Best| {
        let trials = a.trials + b.trials;
        Best { trials, ..if b.ln_p < a.ln_p { b } else { a } }
    };
    let best = parallel::map_items(&bands(white.modes.len()), |b| in_band(&white.modes, *b))
        .into_iter()
        .fold(NONE, better);
    if best.trials == 0.0 {
        return None;
    }
    let (first, m) = best.band;
    let window_s = best.window as f64 * spectral.drivers.length_s() / m as f64;
    let at = |w: usize| spectral.drivers.start_s + w as f64 * window_s;
    let frequency = |k: usize| spectral.frequency_hz(k as f64);
    let time = Place { domain: Domain::Time, from: at(best.part.0), to: at(best.part.1) };
    Some(Departure {
        test: "episodes",
        place: Place { domain: Domain::Frequency, from: frequency(first), to: frequency(first + m) },
        beside: Some(time),
        ln_p: ln_least_of(best.ln_p, best.trials),
        shape: shape(white, &best, window_s),
    })
}

/// Number of times that the band is loud within the part, and its power there.
fn shape(white: &White, best: &Best, window_s: f64) -> Option<Shape> {
    let (first, m) = best.band;
    let series = inverse_dct2(&white.modes[first..first + m]);
    let all = powers(&series, best.window);
    let part = all.get(best.part.0..best.part.1)?;
    let loud: Vec<bool> = part.iter().map(|p| normal(*p, best.window) > EPISODE_LEVEL).collect();
    // Neighbours are one episode.
    let count = (0..loud.len()).filter(|i| loud[*i] && (*i == 0 || !loud[i - 1])).count();
    let excess = part.iter().sum::<f64>() / part.len().max(1) as f64 - 1.0;
    let band: f64 = white.roots[first..first + m].iter().filter(|r| r.is_finite()).map(|r| r * r).sum();
    let variance = excess.max(0.0) * band / white.roots.len().max(1) as f64;
    Some(Shape {
        count: (count > 0).then_some(count),
        each_s: Some(window_s),
        rms_deg_h: Some(variance.sqrt()).filter(|r| *r > 0.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Drivers;
    use crate::numeric::cosine::dct2;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    fn found(added: impl Fn(f64) -> f64, seed: u64) -> Departure {
        let n = 12_000;
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let series: Vec<f64> = (0..n).map(|i| normal() + added(i as f64)).collect();
        let drivers = Drivers { dt_s: 1.0, samples: n, averaged: 1, ..Drivers::default() };
        let spectral = SpectralData::new(drivers, &vec![0.0; n], &[]);
        let white = White { modes: dct2(&series), roots: vec![1.0; n], series };
        all(&spectral, &white).unwrap()
    }

    #[test]
    fn an_oscillation_that_comes_now_and_then_is_found_with_its_band() {
        // Ten times 100 s at 0.1 Hz with half the deviation of a sample.
        let packet = |t: f64| if t % 1200.0 < 100.0 { 0.7 * (0.628 * t).sin() } else { 0.0 };
        let episodes = found(packet, 3);
        assert!(episodes.ln_p < -12.0, "{episodes:?}");
        assert!(episodes.place.from < 0.1 && episodes.place.to > 0.1, "{episodes:?}");
        let shape = episodes.shape.unwrap();
        assert!(shape.count.is_some_and(|n| (5..=20).contains(&n)), "{shape:?}");
        // Its mean square over the record is 0.245/12.
        assert!(shape.rms_deg_h.is_some_and(|r| (0.08..0.25).contains(&r)), "{shape:?}");
    }

    #[test]
    fn short_events_that_are_scattered_are_found_by_their_number() {
        // Nine groups of 8 samples of five times the power of the noise.
        let sign = |t: f64| if (t as u64 * 2_654_435_761) % 7 < 3 { 2.0 } else { -2.0 };
        let events = found(|t| if t % 1300.0 < 8.0 { sign(t) } else { 0.0 }, 8);
        assert!(events.ln_p < -10.0, "{events:?}");
        assert!(events.shape.unwrap().each_s.is_some_and(|s| s < 40.0), "{events:?}");
    }

    #[test]
    fn noise_alone_departs_no_more_often_than_its_probability() {
        let departs = (0..60).filter(|seed| found(|_| 0.0, 500 + seed).ln_p < 0.05f64.ln()).count();
        // 3 of 60 on average, if the sums were independent; they overlap.
        assert!(departs <= 6, "{departs} of 60");
    }

    #[test]
    fn bands_overlap_by_half_of_their_width() {
        let all = bands(1024);
        assert_eq!(all[0], (256, 768));
        assert_eq!(all[1], (128, 384));
        assert!(all.iter().all(|(first, m)| *m >= MIN_BAND_MODES && first + m <= 1024));
    }
}
