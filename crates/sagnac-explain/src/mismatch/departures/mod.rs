//! Tests that name no physics: of a whitened residual that is not white, not Gaussian or not the same everywhere.
//!
//! Under a true hypothesis the cosine modes over their expected deviations are independent standard normal numbers, and
//! so is their inverse transform. Each test scans them in one view and gives the probability of its largest departure
//! with everything scanned counted.

mod columns;
mod departure;
mod episodes;
mod lags;
mod tiles;
mod tracks;

pub use departure::{Departure, Shape, White};

use super::effective_tests;
use super::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use super::several::{least_of, ln_least_of};
use super::spectral_data::SpectralData;
use crate::effect::{Domain, Drivers, Place};
use crate::estimate::{
    ln_chi_square_tail, ln_chi_square_two_sided, ln_normal_two_sided, normal_probability, normal_two_sided,
};
use crate::numeric::sums::cumulated;
use departure::{ln_at_least, windows};
use rand::{RngExt as _, SeedableRng as _};
use sagnac_fft::real_forward;
use statrs::distribution::{DiscreteCDF, Poisson};

/// Seed of the draws that take values off a grid: a report is a function of recording and claim alone.
const OFF_GRID_SEED: u64 = 0x5a67_6e61_6320_0006;

/// A scan's best so far.
struct Scan {
    ln_smallest: f64,
    from: f64,
    to: f64,
    trials: f64,
}

impl Scan {
    fn new() -> Scan {
        Scan { ln_smallest: 0.0, from: 0.0, to: 0.0, trials: 0.0 }
    }

    fn see(&mut self, ln_p: f64, from: f64, to: f64) {
        self.trials += 1.0;
        if ln_p < self.ln_smallest {
            (self.ln_smallest, self.from, self.to) = (ln_p, from, to);
        }
    }

    fn done(self, test: &'static str, domain: Domain) -> Option<Departure> {
        if self.trials == 0.0 {
            return None;
        }
        let ln_p = ln_least_of(self.ln_smallest, self.trials);
        Some(Departure {
            test,
            place: Place { domain, from: self.from, to: self.to },
            beside: None,
            ln_p,
            shape: None,
        })
    }
}

/// Every test of the residual of a fit. `level` is the local deviation of the noise, 1 where it is as the spectrum says;
/// `allowed_skewness` the third standardised moment that single samples may have.
pub fn all(
    spectra: &SpectralDataSet,
    tried: &FittedHypothesis,
    level: Option<&[f64]>,
    usable: &[bool],
    allowed_skewness: f64,
) -> Vec<Departure> {
    let spectral = &spectra.full;
    let mut white = White::of(tried, spectra);
    if let Some(level) = level {
        white.series.iter_mut().zip(level).for_each(|(e, g)| *e /= g);
        white.modes = crate::numeric::cosine::dct2(&white.series);
    }
    let mut out = vec![];
    out.extend(spectrum(spectral, &white));
    if let Some(powers) = periodogram(&white) {
        out.extend(lines(spectral, &powers));
        out.extend(comb(spectral, &powers));
    }
    out.extend(levels(spectral, &white));
    out.extend(lags::all(spectral, &white));
    out.extend(tiles::all(spectral, &white.modes));
    out.extend(tracks::all(spectral, &white));
    out.extend(episodes::all(spectral, &white));
    out.extend(
        off_lattice(spectral, &white, spectra.grid_step_arcsec)
            .and_then(|values| tails(spectral, &values, usable, allowed_skewness)),
    );
    out.extend(skewness(spectral, &white, allowed_skewness));
    out.extend(columns::all(spectral, &white));
    out
}

/// Power of the whitened modes over windows of frequency.
fn spectrum(spectral: &SpectralData, white: &White) -> Option<Departure> {
    let n = white.modes.len();
    let sums = cumulated(white.modes.iter().skip(1).map(|u| u * u));
    let mut scan = Scan::new();
    windows(n - 1, 4, |from, to| {
        let p = ln_chi_square_two_sided(sums[to] - sums[from], (to - from) as f64);
        scan.see(p, spectral.frequency_hz(from as f64 + 1.0), spectral.frequency_hz(to as f64));
    });
    scan.done("spectrum", Domain::Frequency)
}

/// Power of the whitened series on a grid of frequencies twice as fine as its resolution: each is exponential with mean 1.
fn periodogram(white: &White) -> Option<Vec<f64>> {
    let n = white.series.len();
    let mut padded = white.series.clone();
    padded.resize(2 * n, 0.0);
    let plan = real_forward(2 * n);
    let mut spectrum = plan.make_output_vec();
    plan.process(&mut padded, &mut spectrum).ok()?;
    Some(spectrum.iter().take(n).map(|v| v.norm_sqr() / n as f64).collect())
}

/// The largest sum of powers at the multiples of a frequency: what repeats without being a sinusoid.
fn comb(spectral: &SpectralData, powers: &[f64]) -> Option<Departure> {
    const HARMONIC_COUNTS: [usize; 4] = [4, 8, 16, 32];
    // Periods that the record holds fewer times than this are slow courses.
    const MIN_PERIODS: usize = 5;
    let n = powers.len();
    let mut best: Option<(f64, f64, usize)> = None;
    let mut trials = 0.0f64;
    for harmonics in HARMONIC_COUNTS {
        // Steps of the fundamental of a cell over the number of harmonics: the highest is met within half a cell.
        let (mut largest, mut at) = (0.0, 0);
        for i in 2 * MIN_PERIODS * harmonics..n.saturating_sub(1) {
            let sum: f64 = (1..=harmonics).map(|h| powers[(h * i + harmonics / 2) / harmonics]).sum();
            trials += 1.0;
            if sum > largest {
                (largest, at) = (sum, i);
            }
        }
        let p = ln_chi_square_tail(2.0 * largest, 2.0 * harmonics as f64);
        if at > 0 && best.is_none_or(|b| p < b.0) {
            best = Some((p, at as f64 / harmonics as f64, harmonics));
        }
    }
    let (p, cell, harmonics) = best?;
    let fundamental = cell / (2.0 * n as f64 * spectral.drivers.dt_s);
    let place = Place { domain: Domain::Frequency, from: fundamental, to: fundamental * harmonics as f64 };
    Some(Departure { test: "comb", place, beside: None, ln_p: ln_least_of(p, trials), shape: None })
}

/// The largest line of the whitened series.
fn lines(spectral: &SpectralData, powers: &[f64]) -> Option<Departure> {
    let n = powers.len();
    let (mut best, mut at) = (0.0, 0);
    for (k, power) in powers.iter().enumerate().skip(2) {
        if *power > best {
            (best, at) = (*power, k);
        }
    }
    let step = 1.0 / (2.0 * n as f64 * spectral.drivers.dt_s);
    // Twice as many looks as independent frequencies cost about a factor of 1.6 (domain: un-padded loses up to 1.57).
    let ln_p = ln_least_of(-best, 0.8 * n as f64);
    let place =
        Place { domain: Domain::Frequency, from: (at as f64 - 2.0) * step, to: (at as f64 + 2.0) * step };
    Some(Departure { test: "line", place, beside: None, ln_p, shape: None })
}

/// Mean of the whitened series over windows of time.
fn levels(spectral: &SpectralData, white: &White) -> Option<Departure> {
    let sums = cumulated(white.series.iter().copied());
    let mut scan = Scan::new();
    windows(white.series.len(), 1, |from, to| {
        let z = (sums[to] - sums[from]) / ((to - from) as f64).sqrt();
        if to - from > 1 {
            scan.see(ln_normal_two_sided(z), spectral.drivers.time_s(from), spectral.drivers.time_s(to));
        }
    });
    scan.done("level", Domain::Time)
}

/// The whitened series with counts of a continuous law: values on a grid are moved by an even draw over its step.
/// `None` where the steps are too coarse for that.
fn off_lattice(spectral: &SpectralData, white: &White, grid_step_arcsec: Option<f64>) -> Option<Vec<f64>> {
    const MAX_FINE_STEP: f64 = 0.1;
    const MAX_GRID_STEP: f64 = 1.5;
    let n = white.series.len();
    let per_deg_h = white.roots.iter().skip(1).map(|r| 1.0 / r).sum::<f64>() / n.max(2) as f64;
    let step = grid_step_arcsec.map_or(0.0, |a| a / spectral.drivers.dt_s * per_deg_h);
    if step <= MAX_FINE_STEP {
        return Some(white.series.clone());
    }
    if step >= MAX_GRID_STEP {
        return None;
    }
    let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(OFF_GRID_SEED);
    let scale = (1.0 + step * step / 12.0).sqrt();
    Some(white.series.iter().map(|e| (e + step * (rng.random::<f64>() - 0.5)) / scale).collect())
}

/// Probability of a value beyond so many deviations on either side, of a normal value with a part of its own square: the law that has
/// a third standardised moment with the lightest further moments (Cornish and Fisher).
fn beyond(bound: f64, skewness: f64) -> f64 {
    // z + c (z² − 1) has the third moment 6c + 8c³.
    let c = skewness / 6.0;
    if c < 1e-6 {
        return normal_two_sided(bound);
    }
    let scale = (1.0 + 2.0 * c * c).sqrt();
    let between_roots = |value: f64| {
        let root = (1.0 + 4.0 * c * (c + value * scale)).max(0.0).sqrt();
        normal_probability((root - 1.0) / (2.0 * c)) - normal_probability((-root - 1.0) / (2.0 * c))
    };
    1.0 - between_roots(bound) + between_roots(-bound)
}

/// Values of the whitened series beyond 2 to 5 deviations, too many for the skewness that single values may have, or too few.
fn tails(
    spectral: &SpectralData,
    series: &[f64],
    usable: &[bool],
    allowed_skewness: f64,
) -> Option<Departure> {
    let values = || series.iter().zip(usable).filter(|(_, u)| **u).map(|(e, _)| e.abs());
    let n = values().count() as f64;
    let mut scan = Scan::new();
    let mut largest = (0.0, 0);
    for (i, e) in series.iter().enumerate() {
        if usable[i] && e.abs() > largest.0 {
            largest = (e.abs(), i);
        }
    }
    for bound in [2.0, 3.0, 4.0, 5.0] {
        let (even, skewed) = (n * normal_two_sided(bound), n * beyond(bound, allowed_skewness));
        let seen = values().filter(|e| *e > bound).count() as u64;
        let Ok(law) = Poisson::new(even.min(skewed)) else { continue };
        let few = law.cdf(seen).max(1e-300).ln();
        let ln_p = ln_at_least(seen as usize, even.max(skewed)).min(few);
        scan.see((std::f64::consts::LN_2 + ln_p).min(0.0), 0.0, 0.0);
    }
    let ln_largest = ln_normal_two_sided(largest.0).max(beyond(largest.0, allowed_skewness).ln());
    scan.see((n.ln() + ln_largest).min(0.0), 0.0, 0.0);
    let mut found = scan.done("tails", Domain::Time)?;
    // Where the values beyond three deviations are.
    let far: Vec<usize> = (0..series.len()).filter(|i| usable[*i] && series[*i].abs() > 3.5).collect();
    let from = far.first().copied().unwrap_or(largest.1);
    let to = far.last().copied().unwrap_or(largest.1);
    found.place =
        Place { domain: Domain::Time, from: spectral.drivers.time_s(from), to: spectral.drivers.time_s(to) };
    Some(found)
}

/// Third standardised moment of the means of so many samples, and its deviation where their law is even.
fn third_moment(series: &[f64], m: usize) -> (f64, f64) {
    let means = crate::effect::averages(series, m);
    let n = means.len() as f64;
    let variance = means.iter().map(|e| e * e).sum::<f64>() / n;
    let third = means.iter().map(|e| e.powi(3)).sum::<f64>() / n;
    // The law has heavier tails than the normal one for few values; a tenth more spread covers them.
    (third / variance.powf(1.5), (6.0 / n).sqrt() * (1.0 + 8.0 / n.sqrt()))
}

/// Third standardised moment, of either sign, that single samples may have by what a hypothesis leaves: what they show and twice
/// its deviation; 0 where they show none.
pub fn skewness_shown(spectra: &SpectralDataSet, tried: &FittedHypothesis) -> f64 {
    /// Deviations from which a moment is shown.
    const MIN_SHOWN_SIGMAS: f64 = 2.0;
    let white = White::of(tried, spectra);
    let (moment, deviation) = third_moment(&white.series, 1);
    if moment.abs() > MIN_SHOWN_SIGMAS * deviation { moment.abs() + 2.0 * deviation } else { 0.0 }
}

/// Third moment of the whitened series at the sample rate and averaged, beyond that which single samples may have: that of a mean
/// of m independent ones is smaller by the root of m.
fn skewness(spectral: &SpectralData, white: &White, allowed: f64) -> Option<Departure> {
    let mut scan = Scan::new();
    let mut m = 1;
    while white.series.len() / m >= 256 {
        let (moment, deviation) = third_moment(&white.series, m);
        let beyond = (moment.abs() - allowed / (m as f64).sqrt()).max(0.0);
        scan.see(
            ln_normal_two_sided(beyond / deviation),
            spectral.drivers.start_s,
            spectral.drivers.start_s + spectral.drivers.length_s(),
        );
        m *= 8;
    }
    // A law that is not even shows in the size of the residual wherever it is looked at.
    let seen = white.roots.iter().filter(|r| r.is_finite());
    let variance = seen.map(|r| r * r).sum::<f64>() / white.roots.len().max(2) as f64;
    let largest = white.series.iter().fold(0.0f64, |m, e| m.max(e.abs()));
    let size = Place { domain: Domain::Amplitude, from: 0.0, to: largest * variance.sqrt() };
    scan.done("skewness", Domain::Time).map(|d| Departure { beside: Some(size), ..d })
}

/// The smallest of several p-values.
pub fn smallest(departures: &[Departure]) -> f64 {
    departures.iter().map(Departure::p_value).fold(1.0, f64::min)
}

/// Probability of the smallest p-value of the tests of a residual, in a record with such columns.
pub fn family(departures: &[Departure], drivers: &Drivers) -> f64 {
    least_of(smallest(departures), effective_tests::of_residual(drivers))
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::numeric::cosine::dct2;

    fn white(series: Vec<f64>) -> White {
        White { modes: dct2(&series), roots: vec![1.0; series.len()], series }
    }

    fn spectral(n: usize) -> SpectralData {
        let drivers = Drivers { dt_s: 0.5, samples: n, averaged: 1, ..Drivers::default() };
        SpectralData::new(drivers, &vec![0.0; n], &[])
    }

    #[test]
    fn a_line_has_the_power_of_a_quarter_of_its_square_a_sample() {
        let n = 1024;
        let series: Vec<f64> =
            (0..n).map(|i| 0.8 * (std::f64::consts::TAU * 0.125 * f64::from(i)).cos()).collect();
        let white = white(series);
        let powers = periodogram(&white).unwrap();
        // a² n/4 at cell 2 n f.
        assert!((powers[256] - 0.16 * 1024.0).abs() < 1e-6, "{}", powers[256]);
        let found = lines(&spectral(1024), &powers).unwrap();
        assert!(found.place.from < 0.25 && found.place.to > 0.25, "{found:?}");
        assert!((found.ln_p - ((0.8 * 1024f64).ln() - powers[256])).abs() < 1e-9);
    }

    #[test]
    fn a_skewness_that_is_allowed_is_no_outlier() {
        let n = 20_000;
        let normal = |i: usize| crate::estimate::normal_quantile((i as f64 + 0.5) / n as f64);
        let part = 0.06;
        let scale = (1.0f64 + 2.0 * part * part).sqrt();
        let skewed: Vec<f64> = (0..n).map(normal).map(|z| (z + part * (z * z - 1.0)) / scale).collect();
        let (spectral, usable) = (spectral(n), vec![true; n]);
        let p = |allowed: f64| tails(&spectral, &skewed, &usable, allowed).unwrap().p_value();
        assert!(p(0.0) < 0.01 && p(0.4) > 0.2, "{} {}", p(0.0), p(0.4));
        // By the law itself: as many values are beyond each bound as it says.
        for bound in [2.0, 3.0] {
            let seen = skewed.iter().filter(|y| y.abs() > bound).count() as f64 / n as f64;
            assert!((seen / beyond(bound, 0.36) - 1.0).abs() < 0.02, "{seen}");
        }
    }

    #[test]
    fn values_too_large_or_too_seldom_are_told() {
        let n = 4000;
        // Quantiles of a normal law in a scattered order: as many in each tail as expected.
        let order = |i: usize| (i * 1597) % n;
        let normal = |i: usize| crate::estimate::normal_quantile((order(i) as f64 + 0.5) / n as f64);
        let even: Vec<f64> = (0..n).map(normal).collect();
        let (spectral, usable) = (spectral(n), vec![true; n]);
        assert!(tails(&spectral, &even, &usable, 0.0).unwrap().p_value() > 0.5);
        let mut far = even.clone();
        far[1700] = 9.0;
        let found = tails(&spectral, &far, &usable, 0.0).unwrap();
        assert!(found.p_value() < 1e-12 && found.place.to == 850.0, "{found:?}");
        // Set aside, it tells of nothing.
        let mut without = usable.clone();
        without[1700] = false;
        assert!(tails(&spectral, &far, &without, 0.0).unwrap().p_value() > 0.5);
        // A law that ends at two deviations has too few beyond.
        let short: Vec<f64> = even.iter().map(|e| e.clamp(-1.9, 1.9)).collect();
        assert!(tails(&spectral, &short, &usable, 0.0).unwrap().p_value() < 1e-12);
    }

    #[test]
    fn a_law_that_is_not_even_departs_by_what_the_claim_does_not_allow() {
        let n = 4096;
        // Quantiles of a χ² law of 100 degrees of freedom in a scattered order: a third moment of √(8/100).
        let cube = |z: f64| (1.0 - 2.0 / 900.0 + z * (2.0f64 / 900.0).sqrt()).powi(3);
        let chi =
            |i: usize| cube(crate::estimate::normal_quantile((((i * 1597) % n) as f64 + 0.5) / n as f64));
        let mean = (0..n).map(chi).sum::<f64>() / n as f64;
        let deviation = ((0..n).map(|i| (chi(i) - mean).powi(2)).sum::<f64>() / n as f64).sqrt();
        let white = white((0..n).map(|i| (chi(i) - mean) / deviation).collect());
        let (moment, spread) = third_moment(&white.series, 1);
        assert!((moment - 0.08f64.sqrt()).abs() < 0.01, "{moment}");
        let ln_p = |allowed: f64| skewness(&spectral(n), &white, allowed).unwrap().ln_p;
        assert!(ln_p(0.0) < -20.0 && ln_p(moment) > -0.1, "{} {}", ln_p(0.0), ln_p(moment));
        // Of what is allowed only in part, the rest is judged.
        let rest = ln_normal_two_sided(3.0) + 2f64.ln();
        assert!((ln_p(moment - 3.0 * spread) - rest).abs() < 0.5, "{}", ln_p(moment - 3.0 * spread));
    }

    #[test]
    fn a_level_that_stays_is_found_where_it_is() {
        let n = 1024;
        let series: Vec<f64> = (0..n).map(|i| if (256..512).contains(&i) { 1.0 } else { 0.0 }).collect();
        let found = levels(&spectral(n), &white(series)).unwrap();
        // 256 ones are 16 deviations.
        assert_eq!((found.place.from, found.place.to), (128.0, 256.0));
        let trials = found.ln_p - ln_normal_two_sided(16.0);
        assert!((trials.exp() - 2037.0).abs() < 20.0, "{}", trials.exp());
    }

    #[test]
    fn the_smallest_of_several_probabilities_is_judged_by_their_number() {
        let place = Place { domain: Domain::Time, from: 0.0, to: 1.0 };
        let of = |p: f64| Departure { test: "level", place, beside: None, ln_p: p.ln(), shape: None };
        let drivers = spectral(64).drivers;
        let tests = effective_tests::of_residual(&drivers);
        for some in [&[of(0.5), of(0.01), of(0.2)][..], &[of(0.01)]] {
            let together = family(some, &drivers);
            assert!((together - (1.0 - 0.99f64.powf(tests))).abs() < 1e-12, "{together}");
        }
    }
}
