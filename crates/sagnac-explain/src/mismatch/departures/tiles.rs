//! Power of the whitened residual in time and frequency together.
//!
//! The modes of a band by themselves, transformed back, are a series of as many points over the same time; under a true
//! hypothesis the points are independent standard normal numbers. Bands are octaves and their halves, quarters and so
//! on; windows of time are dyadic.

use super::departure::{Departure, windows};
use crate::effect::{Domain, Place};
use crate::estimate::{ln_chi_square_two_sided, ln_normal_two_sided};
use crate::mismatch::several::ln_least_of;
use crate::mismatch::spectral_data::SpectralData;
use crate::numeric::cosine::inverse_dct2;
use crate::numeric::parallel;
use crate::numeric::special::{chi_square_normal, f_normal};
use crate::numeric::sums::cumulated;

/// Fewest modes of a band.
const MIN_BAND_MODES: usize = 32;
/// Parts of an octave, at most.
const MAX_OCTAVE_PARTS: usize = 64;
/// Shortest window, in points of its band.
const MIN_WINDOW_POINTS: usize = 16;

/// A window of a band.
#[derive(Clone, Copy)]
struct Tile {
    /// First mode and number of modes of the band.
    band: (usize, usize),
    /// Points of the window.
    window: (usize, usize),
    /// Standard normal number of its power.
    z: f64,
    power: f64,
}

impl Tile {
    const NONE: Tile = Tile { band: (0, 1), window: (0, 1), z: 0.0, power: 1.0 };

    fn larger(self, other: Tile) -> Tile {
        if other.z.abs() > self.z.abs() { other } else { self }
    }
}

/// The largest departures of some bands, and how many windows were looked at.
#[derive(Clone, Copy)]
struct Largest {
    absolute: Tile,
    relative: Tile,
    trials: f64,
}

impl Largest {
    const NONE: Largest = Largest { absolute: Tile::NONE, relative: Tile::NONE, trials: 0.0 };

    fn with(self, other: Largest) -> Largest {
        Largest {
            absolute: self.absolute.larger(other.absolute),
            relative: self.relative.larger(other.relative),
            trials: self.trials + other.trials,
        }
    }
}

/// Bands of `modes` modes: octaves and their parts, as first mode and number.
fn bands(modes: usize) -> Vec<(usize, usize)> {
    let mut out = vec![];
    let mut high = modes;
    while high / 2 >= MIN_BAND_MODES {
        let low = high / 2;
        let mut parts = 1;
        while parts <= MAX_OCTAVE_PARTS && (high - low) / parts >= MIN_BAND_MODES {
            let m = (high - low) / parts;
            out.extend((0..parts).map(|p| (low + p * m, m)));
            parts *= 2;
        }
        high = low;
    }
    out
}

fn in_band(modes: &[f64], (first, m): (usize, usize)) -> Largest {
    let series = inverse_dct2(&modes[first..first + m]);
    let sums = cumulated(series.iter().map(|v| v * v));
    let sum = sums[m];
    let mut out = Largest::NONE;
    windows(m, MIN_WINDOW_POINTS, |from, to| {
        out.trials += 1.0;
        let (dof, inside) = ((to - from) as f64, sums[to] - sums[from]);
        let tile = Tile { band: (first, m), window: (from, to), z: 0.0, power: inside };
        out.absolute = out.absolute.larger(Tile { z: chi_square_normal(inside, dof), ..tile });
        let rest = m as f64 - dof;
        // Against the band's own power elsewhere.
        if rest >= 0.25 * dof {
            let ratio = (inside / dof) / ((sum - inside) / rest);
            out.relative = out.relative.larger(Tile { z: f_normal(ratio, dof, rest), ..tile });
        }
    });
    out
}

/// Power of windows of time in bands of frequency: against what the hypothesis expects, and against the same band at
/// other times.
pub fn all(spectral: &SpectralData, modes: &[f64]) -> Vec<Departure> {
    let found = parallel::map_items(&bands(modes.len()), |band| in_band(modes, *band))
        .into_iter()
        .fold(Largest::NONE, Largest::with);
    if found.trials == 0.0 {
        return vec![];
    }
    let places = |tile: &Tile| {
        let ((first, m), (from, to)) = (tile.band, tile.window);
        let step = spectral.drivers.length_s() / m as f64;
        let start = spectral.drivers.start_s;
        let at = |i: usize| start + i as f64 * step;
        let frequency = |k: usize| spectral.frequency_hz(k as f64);
        (
            Place { domain: Domain::Time, from: at(from), to: at(to) },
            Place { domain: Domain::Frequency, from: frequency(first), to: frequency(first + m) },
        )
    };
    let (absolute, relative) = (found.absolute, found.relative);
    let (time, frequency) = places(&relative);
    let local = Departure {
        test: "local_power",
        place: time,
        beside: Some(frequency),
        ln_p: ln_least_of(ln_normal_two_sided(relative.z), found.trials),
        shape: None,
    };
    let (time, frequency) = places(&absolute);
    let dof = (absolute.window.1 - absolute.window.0) as f64;
    let tile = Departure {
        test: "tile",
        place: frequency,
        beside: Some(time),
        ln_p: ln_least_of(ln_chi_square_two_sided(absolute.power, dof), found.trials),
        shape: None,
    };
    vec![local, tile]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Drivers;
    use crate::numeric::cosine::dct2;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    fn white(seed: u64, n: usize) -> Vec<f64> {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
        (0..n).map(|_| StandardNormal.sample(&mut rng)).collect()
    }

    fn spectral(n: usize) -> SpectralData {
        let drivers = Drivers { dt_s: 0.5, start_s: 100.0, samples: n, averaged: 1, ..Drivers::default() };
        SpectralData::new(drivers, &vec![0.0; n], &[])
    }

    #[test]
    fn white_noise_departs_as_seldom_as_stated() {
        let n = 4096;
        let spectral = spectral(n);
        let (mut small, mut least) = ([0; 2], [1.0f64; 2]);
        for seed in 0..20 {
            for (i, d) in all(&spectral, &dct2(&white(seed, n))).into_iter().enumerate() {
                small[i] += i32::from(d.p_value() < 0.05);
                least[i] = least[i].min(d.p_value());
            }
        }
        // 1 of 20 at the most, by Bonferroni: 5 come about in 3 of 1000 cases, a p-value below 1e-5 in 2 of 10 000.
        assert!(small.iter().all(|c| *c <= 4) && least.iter().all(|p| *p > 1e-5), "{small:?} {least:?}");
    }

    #[test]
    fn a_tone_of_one_while_is_located_in_time_and_frequency() {
        let n = 8192;
        let mut series = white(1, n);
        for (i, v) in series.iter_mut().enumerate().take(3600).skip(3000) {
            *v += 0.9 * (std::f64::consts::TAU * 0.17 * i as f64).cos();
        }
        for d in all(&spectral(n), &dct2(&series)) {
            assert!(d.p_value() < 1e-6, "{}: {}", d.test, d.p_value());
            let (time, frequency) = match d.place.domain {
                Domain::Time => (d.place, d.beside.unwrap()),
                _ => (d.beside.unwrap(), d.place),
            };
            assert!(time.from < 1900.0 && time.to > 1600.0 && time.to - time.from < 1000.0, "{time:?}");
            assert!(frequency.from <= 0.34 && frequency.to >= 0.34, "{frequency:?}");
        }
    }
}
