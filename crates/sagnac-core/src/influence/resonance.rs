//! Resonance of a unit under vibration: where its output answers the acceleration by a pole, how sharp that is and how large.
//!
//! `H(f) = c₀ + c₁·(f − f₀) + R·D(f)`, `D = −j/Q / (1 − (f/f₀)² + jf/(Q·f₀))`: a response that hardly changes about the resonance, and that of
//! one pole pair whose size at f₀ is |R|. H is that of the averaged spectra of accelerometer and output (Bendat and Piersol, Random Data,
//! chapters 6 and 7); Q is the amplification of the resonance over its response far below.

use crate::estimate::{SCORE_ONE_SIDED_95, UpperLimit};
use crate::noise::in_band::Band;
use crate::rate_table::cross_spectrum::Bin;
use crate::rate_table::transfer_model::SHARED_BY_BINS;
use nalgebra::{DMatrix, DVector};
use sagnac_fft::Complex;

/// Quality factors of the search.
const QUALITIES: [f64; 12] = [1.6, 2.5, 4.0, 6.3, 10.0, 16.0, 25.0, 40.0, 63.0, 100.0, 160.0, 250.0];

/// Frequencies of the search in a width of the resonance.
const STEPS_PER_WIDTH: f64 = 4.0;

/// Widths of a resonance to either side over which it is fitted.
const WIDTHS_FITTED: f64 = 6.0;

/// Fewest bins of a fit.
const FEWEST_BINS: usize = 16;

/// Bins that a resonance is wide at least, so that its width is shown.
const FEWEST_BINS_OF_WIDTH: f64 = 3.0;

/// Probability with which noise alone shows a resonance anywhere in the bands.
const FALSE_ALARM: f64 = 1e-3;

/// Largest standard uncertainty of the logarithm of a quality factor that is stated.
const LARGEST_LOG_DEVIATION: f64 = 0.5;

/// Bins over which what the acceleration does not explain is averaged.
const SMOOTHED_BINS: usize = 12;

/// Variance of a bin over the smallest one up to which its frequency counts as excited.
const EXCITED_WITHIN: f64 = 1e3;

/// Share of the bins between the ends of what was excited in a band that must be excited, so that no resonance is overlooked.
const LEAST_EXCITED_SHARE: f64 = 0.9;

/// Share of the width of a band that must be excited.
const LEAST_EXCITED_WIDTH: f64 = 0.7;

/// Probability with which a bound holds.
const CLAIM_CONFIDENCE: f64 = 0.95;

/// Steps of a fit.
const MAX_STEPS: usize = 40;

/// A value with its standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Value.
    pub value: f64,
    /// Standard uncertainty.
    pub standard: f64,
}

/// A resonance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Its frequency, Hz.
    pub frequency_hz: Measured,
    /// Natural logarithm of its quality factor.
    pub log_quality: Measured,
    /// Its response at that frequency, deg/h/g.
    pub response: Measured,
    /// True where it is narrower than the segments resolve.
    pub sharp: bool,
}

/// What the recording shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shown {
    /// A resonance.
    Peak(Peak),
    /// The response rises to an end of the bands: the resonance lies beyond.
    Beyond,
    /// None, with the largest response that one could have, deg/h/g; `None` where parts of the bands were not excited.
    Nothing(Option<UpperLimit>),
    /// Nothing: the vibration was too short, or no noise-like part of it is in the bands.
    Unsearched,
}

/// The search of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonance {
    /// What was found.
    pub shown: Shown,
    /// Lowest and highest frequency that was searched, Hz.
    pub searched_hz: (f64, f64),
}

/// A bin of the search, with the variance of its neighbours.
#[derive(Clone, Copy)]
struct Point {
    bin: Bin,
    variance: f64,
}

/// A place of the search with what a resonance there gains.
#[derive(Clone, Copy)]
struct Tried {
    frequency_hz: f64,
    quality: f64,
    /// Sum of squares that the resonance explains, over what is expected by chance in a sum of one.
    gain: f64,
    /// Its response, and the largest that it may have.
    response: Complex<f64>,
    at_most: f64,
}

/// Searches the bins of a channel in the bands of a test.
pub fn search(bins: &[Bin], bands: &[Band]) -> Resonance {
    let inside = |b: &&Bin| bands.iter().any(|band| (band.from_hz..=band.to_hz).contains(&b.frequency_hz));
    let all: Vec<Point> = smoothed(bins);
    let own: Vec<Point> = all.into_iter().filter(|p| inside(&&p.bin)).collect();
    let smallest = own.iter().map(|p| p.variance).fold(f64::INFINITY, f64::min);
    let points: Vec<Point> =
        own.iter().copied().filter(|p| p.variance <= EXCITED_WITHIN * smallest).collect();
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return Resonance { shown: Shown::Unsearched, searched_hz: (0.0, 0.0) };
    };
    let searched_hz = (first.bin.frequency_hz, last.bin.frequency_hz);
    let found = |shown| Resonance { shown, searched_hz };
    let step_hz =
        bins.windows(2).map(|w| w[1].frequency_hz - w[0].frequency_hz).fold(f64::INFINITY, f64::min);
    let tried = tried(&points, searched_hz, step_hz);
    let covered = bands.iter().all(|band| is_covered(&points, band, step_hz));
    let Some(best) = tried.iter().max_by(|a, b| a.gain.total_cmp(&b.gain)) else {
        return found(Shown::Unsearched);
    };
    if best.gain < 2.0 * (tried.len() as f64 / FALSE_ALARM).ln() {
        let largest = tried.iter().map(|t| t.at_most).fold(0.0, f64::max);
        return found(Shown::Nothing(
            covered.then_some(UpperLimit { value: largest, coverage: CLAIM_CONFIDENCE }),
        ));
    }
    let Some(peak) = fitted(&points, best, step_hz) else { return found(Shown::Unsearched) };
    let half_width = 0.5 * peak.frequency_hz.value / peak.log_quality.value.exp();
    let within = bands.iter().any(|b| {
        let from = b.from_hz.max(searched_hz.0) + half_width;
        let to = b.to_hz.min(searched_hz.1) - half_width;
        (from..=to).contains(&peak.frequency_hz.value)
    });
    let told = peak.sharp || peak.log_quality.standard <= LARGEST_LOG_DEVIATION;
    found(if within && told { Shown::Peak(peak) } else { Shown::Beyond })
}

/// True where a band was excited from one end of what was excited in it to the other.
fn is_covered(points: &[Point], band: &Band, step_hz: f64) -> bool {
    let inside = |p: &&Point| (band.from_hz..=band.to_hz).contains(&p.bin.frequency_hz);
    let own: Vec<f64> = points.iter().filter(inside).map(|p| p.bin.frequency_hz).collect();
    let (Some(first), Some(last)) = (own.first(), own.last()) else { return false };
    own.len() as f64 >= LEAST_EXCITED_SHARE * (1.0 + (last - first) / step_hz)
        && last - first >= LEAST_EXCITED_WIDTH * band.width_hz()
}

/// Bins with the geometric mean of the variances about them: a single one is known to few degrees of freedom.
fn smoothed(bins: &[Bin]) -> Vec<Point> {
    let logs: Vec<f64> = bins.iter().map(|b| b.variance.max(f64::MIN_POSITIVE).ln()).collect();
    let of = |(i, bin): (usize, &Bin)| {
        let from = i.saturating_sub(SMOOTHED_BINS);
        let about = logs.get(from..(i + SMOOTHED_BINS + 1).min(logs.len())).unwrap_or_default();
        // Where the excitation ends within them, the bin's own side counts.
        let near: Vec<f64> = about.iter().copied().filter(|l| (l - logs[i]).abs() < 3.0).collect();
        Point { bin: *bin, variance: (near.iter().sum::<f64>() / near.len().max(1) as f64).exp() }
    };
    bins.iter().enumerate().map(of).collect()
}

/// The response of a pole pair that is 1 in size at its frequency.
fn pole_pair(frequency_hz: f64, quality: f64, f: f64) -> Complex<f64> {
    let x = f / frequency_hz;
    Complex::new(0.0, -1.0 / quality) / Complex::new(1.0 - x * x, x / quality)
}

/// The points about a resonance.
fn about(points: &[Point], frequency_hz: f64, quality: f64) -> &[Point] {
    let reach = WIDTHS_FITTED * frequency_hz / quality;
    let from = points.partition_point(|p| p.bin.frequency_hz < frequency_hz - reach);
    let to = points.partition_point(|p| p.bin.frequency_hz <= frequency_hz + reach);
    points.get(from..to).unwrap_or_default()
}

/// Every place of the search.
fn tried(points: &[Point], (from, to): (f64, f64), step_hz: f64) -> Vec<Tried> {
    let mut all = vec![];
    for quality in QUALITIES {
        let mut frequency_hz = from;
        while frequency_hz <= to {
            if frequency_hz / quality >= FEWEST_BINS_OF_WIDTH * step_hz {
                all.extend(one(about(points, frequency_hz, quality), frequency_hz, quality));
            }
            frequency_hz *= 1.0 + 1.0 / (STEPS_PER_WIDTH * quality);
        }
    }
    all
}

/// A resonance of given frequency and quality factor beside a straight line.
fn one(points: &[Point], frequency_hz: f64, quality: f64) -> Option<Tried> {
    if points.len() < FEWEST_BINS {
        return None;
    }
    let line: Vec<Complex<f64>> =
        points.iter().map(|p| Complex::from(p.bin.frequency_hz - frequency_hz)).collect();
    let ones = vec![Complex::from(1.0); points.len()];
    let mut pole: Vec<Complex<f64>> = points
        .iter()
        .map(|p| p.bin.window.read(p.bin.frequency_hz, |f| pole_pair(frequency_hz, quality, f)))
        .collect();
    let mut response: Vec<Complex<f64>> = points.iter().map(|p| p.bin.response).collect();
    let product = |a: &[Complex<f64>], b: &[Complex<f64>]| -> Complex<f64> {
        a.iter().zip(b).zip(points).map(|((a, b), p)| a.conj() * b / p.variance).sum()
    };
    let without = |what: &mut [Complex<f64>], column: &[Complex<f64>]| {
        let share = product(column, what) / product(column, column);
        what.iter_mut().zip(column).for_each(|(w, c)| *w -= share * c);
    };
    let mut line = line;
    without(&mut line, &ones);
    for column in [&ones, &line] {
        without(&mut pole, column);
        without(&mut response, column);
    }
    let (own, shared) = (product(&pole, &pole).re, product(&pole, &response));
    if own.is_nan() || own <= 0.0 {
        return None;
    }
    let explained = shared.norm_sqr() / own;
    let rest = product(&response, &response).re - explained;
    // Three complex coefficients are fitted.
    let misfit = (rest / (2.0 * points.len() as f64 - 6.0)).max(1.0);
    let amplitude = shared / own;
    let standard = (SHARED_BY_BINS * misfit / own).sqrt();
    Some(Tried {
        frequency_hz,
        quality,
        gain: explained / (SHARED_BY_BINS * misfit),
        response: amplitude,
        at_most: amplitude.norm() + SCORE_ONE_SIDED_95 * standard,
    })
}

/// Parameters of a fit: logarithms of frequency and quality factor, then real and imaginary parts of c₀, c₁ and R.
type Parameters = DVector<f64>;

/// Residuals over their standard deviations, real and imaginary parts; c₁ is that of `scale_hz`.
fn residuals(points: &[Point], p: &Parameters, (centre_hz, scale_hz): (f64, f64)) -> DVector<f64> {
    let (frequency_hz, quality) = (p[0].exp(), p[1].exp());
    let (level, slope, size) = (Complex::new(p[2], p[3]), Complex::new(p[4], p[5]), Complex::new(p[6], p[7]));
    let response =
        |f: f64| level + slope * ((f - centre_hz) / scale_hz) + size * pole_pair(frequency_hz, quality, f);
    let mut out = Vec::with_capacity(2 * points.len());
    for point in points {
        let left = point.bin.response - point.bin.window.read(point.bin.frequency_hz, response);
        let deviation = point.variance.sqrt();
        out.extend([left.re / deviation, left.im / deviation]);
    }
    DVector::from_vec(out)
}

fn jacobian(points: &[Point], p: &Parameters, about: (f64, f64), size: f64) -> DMatrix<f64> {
    let step = |i: usize| if i < 2 { 1e-6 } else { 1e-4 * size };
    let columns: Vec<DVector<f64>> = (0..p.len())
        .map(|i| {
            let (mut more, mut less) = (p.clone(), p.clone());
            more[i] += step(i);
            less[i] -= step(i);
            (residuals(points, &more, about) - residuals(points, &less, about)) / (2.0 * step(i))
        })
        .collect();
    DMatrix::from_columns(&columns)
}

/// The resonance fitted by least squares from the best place of the search.
fn fitted(points: &[Point], best: &Tried, step_hz: f64) -> Option<Peak> {
    let own = about(points, best.frequency_hz, best.quality);
    let place = (best.frequency_hz, best.frequency_hz / best.quality);
    let size = best.response.norm();
    let mut p = DVector::from_vec(vec![
        best.frequency_hz.ln(),
        best.quality.ln(),
        0.0,
        0.0,
        0.0,
        0.0,
        best.response.re,
        best.response.im,
    ]);
    let mut squares = residuals(own, &p, place).norm_squared();
    let mut damping = 1e-3;
    for _ in 0..MAX_STEPS {
        let j = jacobian(own, &p, place, size);
        let information = j.transpose() * &j;
        let gradient = j.transpose() * residuals(own, &p, place);
        let mut damped = information.clone();
        for i in 0..damped.nrows() {
            damped[(i, i)] *= 1.0 + damping;
        }
        let next = &p - damped.lu().solve(&gradient)?;
        let lower = residuals(own, &next, place).norm_squared();
        if lower < squares {
            let gained = squares - lower;
            (p, squares) = (next, lower);
            damping = (damping * 0.3).max(1e-9);
            if gained < 1e-9 * squares {
                break;
            }
        } else if damping > 1e9 {
            break;
        } else {
            damping *= 5.0;
        }
    }
    let j = jacobian(own, &p, place, size);
    let misfit = (squares / (2.0 * own.len() as f64 - p.len() as f64).max(1.0)).max(1.0);
    let covariance = (j.transpose() * &j).try_inverse()? * (SHARED_BY_BINS * misfit);
    let standard = |i: usize| covariance[(i, i)].max(0.0).sqrt();
    let (frequency_hz, quality) = (p[0].exp(), p[1].exp());
    let response = Complex::new(p[6], p[7]);
    let along = DVector::from_vec(vec![response.re, response.im]) / response.norm();
    let of_response = covariance.view((6, 6), (2, 2)).into_owned();
    let variance = (along.transpose() * of_response * &along)[(0, 0)];
    let is_told = frequency_hz.is_finite() && quality.is_finite() && variance.is_finite();
    is_told.then(|| Peak {
        frequency_hz: Measured { value: frequency_hz, standard: frequency_hz * standard(0) },
        log_quality: Measured { value: p[1], standard: standard(1) },
        response: Measured { value: response.norm(), standard: variance.max(0.0).sqrt() },
        sharp: frequency_hz / quality < FEWEST_BINS_OF_WIDTH * step_hz,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rate_table::cross_spectrum::WindowTerms;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const BAND: [Band; 1] = [Band { from_hz: 20.0, to_hz: 100.0 }];

    /// Bins of a response of 5 deg/h/g with a resonance of 40 deg/h/g and Q 12 at `frequency_hz`.
    fn bins(frequency_hz: f64, size: f64, seed: u64) -> Vec<Bin> {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let one = |i: u32| {
            let f = 0.25 * f64::from(i);
            let truth = Complex::new(5.0, 1.0) + pole_pair(frequency_hz, 12.0, f) * Complex::new(0.0, size);
            let response = truth + Complex::new(normal(), normal());
            Bin { frequency_hz: f, response, window: WindowTerms::default(), variance: 1.0, coherence: 0.5 }
        };
        (40..480).map(one).collect()
    }

    #[test]
    fn a_resonance_is_found_with_its_sharpness_and_size() {
        let mut outside = 0;
        for seed in 0..40 {
            let Shown::Peak(peak) = search(&bins(56.3, 40.0, seed), &BAND).shown else { panic!("{seed}") };
            // Bins are independent here, so that uncertainties are too large by the root of what bins share.
            let far = |m: Measured, truth: f64| (m.value - truth).abs() > 1.96 * m.standard;
            outside += usize::from(far(peak.frequency_hz, 56.3));
            outside += usize::from(far(peak.log_quality, 12f64.ln()));
            outside += usize::from(far(peak.response, 40.0));
            assert!(peak.log_quality.standard < 0.2 && !peak.sharp);
        }
        assert!(outside <= 6, "{outside}");
    }

    #[test]
    fn a_level_response_shows_none_and_says_how_large_one_may_be() {
        for seed in 0..20 {
            let Shown::Nothing(Some(most)) = search(&bins(56.3, 0.0, seed), &BAND).shown else { panic!() };
            assert!(most.value > 1.0 && most.value < 12.0, "{most:?}");
        }
    }

    #[test]
    fn a_resonance_beyond_the_bands_is_not_one_within() {
        let found = search(&bins(103.0, 60.0, 1), &BAND);
        assert_eq!(found.shown, Shown::Beyond);
        assert_eq!(search(&[], &BAND).shown, Shown::Unsearched);
    }
}
