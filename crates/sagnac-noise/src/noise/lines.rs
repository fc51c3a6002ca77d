//! Spectral lines: peaks above the local noise floor, by a test with a stated family-wise false-alarm rate.
//!
//! The floor is a running robust power law: a median of ln S over neighbouring bins after the local slope in ln f is
//! taken off, so that flicker and random walk raise no alarm. Without a line a bin of the averaged periodogram is
//! Gamma distributed with the equivalent number of averages, and its ratio to the floor follows an F distribution, the
//! floor being an average of limited number itself. The rate is shared among all bins searched (Šidák). What stands out
//! from the wide floor must stand out from its nearest neighbours as well: beside the zeros of an averaging filter the
//! spectrum bends more than a power law over many bins can.
//!
//! A line is coherent where its power lies within the few modes that a sinusoid fills ([`is_coherent`]).

use super::data::WelchSpectrum;
use super::evidence::{Evidence, FineBin};
use crate::estimate::normal_probability;
use statrs::function::beta::beta_reg;

/// False-alarm rate of a whole search unless stated otherwise.
pub const FALSE_ALARM_RATE: f64 = 0.01;
/// Bins below this are not searched: slow noise and the removed mean rule there. As many are left out below the
/// Nyquist frequency, where the floor has neighbours on one side only.
pub const FIRST_BIN: usize = 4;
/// Bins below this are no part of the floor: the removed mean and the window bend slow noise there.
const FIRST_FLOOR_BIN: usize = 2;
/// Relative error of the floor beyond statistics, since no spectrum is a power law to the last digit: below bin 64,
/// where the neighbours span most of an octave, and above.
const FLOOR_ERROR: [f64; 2] = [0.05, 0.02];
/// Half width, in bins, of what a pure line fills under a Hann window.
pub(super) const HALF_LOBE_BINS: usize = 2;
/// Bins on each side that a line must stand out from.
const NEAR_HALF_WIDTH_BINS: usize = 12;
/// Variance of a median against a mean (π/2) times the correlation of neighbouring bins under a Hann window
/// (1 + 2·(4/9 + 1/36)).
const FLOOR_INFLATION: f64 = std::f64::consts::FRAC_PI_2 * 1.9444;

/// A sinusoid in block means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sinusoid {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Coefficients of cosine and sine from the middle of the first block on, deg/h.
    pub coefficients_deg_h: [f64; 2],
    /// Standard deviation of the amplitude, deg/h.
    pub amplitude_deviation_deg_h: f64,
    /// Standard deviation of the frequency, Hz.
    pub frequency_deviation_hz: f64,
    /// Rms times √2 of what a line that wanders a little has beside it, deg/h; 0 for one that does not.
    pub skirt_deg_h: f64,
}

/// A line in a spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectralLine {
    /// Frequency, interpolated between bins, Hz.
    pub frequency_hz: f64,
    /// Resolution of the spectrum: distance of its bins, Hz.
    pub resolution_hz: f64,
    /// Amplitude of the sinusoid that holds the same power over the floor, deg/h.
    pub amplitude_deg_h: f64,
    /// Power at the peak over the floor.
    pub excess: f64,
    /// Probability that noise alone shows such a peak anywhere in the spectrum.
    pub false_alarm_probability: f64,
    /// Place in the list of a stronger line of which this one is a harmonic.
    pub harmonic_of: Option<usize>,
    /// Multiple of that line's frequency; 1 where there is none.
    pub harmonic_order: u32,
    /// The line fitted to the whole record, which then gives its frequency and amplitude.
    pub sinusoid: Option<Sinusoid>,
}

/// The result of a search.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LineSearch {
    /// Lines in order of frequency.
    pub lines: Vec<SpectralLine>,
    /// Floor in the unit of the spectrum's density, one value a bin.
    pub floor: Vec<f64>,
    /// Bins searched: the family that the false-alarm rate is shared among.
    pub searched: usize,
}

/// Searches a spectrum of samples at interval `tau0_s` for lines, with probability `false_alarm_rate` of one line or
/// more where there is none.
pub fn find_lines(spectrum: &WelchSpectrum, tau0_s: f64, false_alarm_rate: f64) -> LineSearch {
    let density = &spectrum.density;
    let end = density.len().saturating_sub(FIRST_BIN);
    if end <= 2 * FIRST_BIN || spectrum.effective_averages.is_nan() || spectrum.effective_averages <= 0.0 {
        return LineSearch::default();
    }
    let floor = floor_of(density, spectrum.effective_averages);
    let searched = end - FIRST_BIN;
    let averages = spectrum.effective_averages;
    let probability = |k: usize| {
        let wide = corrected(tail(density, (floor.level[k], floor.spread[k]), k, averages), searched);
        // Most bins stand out from nothing, and their neighbours need not be looked at.
        if wide > false_alarm_rate || half_width(k) <= NEAR_HALF_WIDTH_BINS {
            return wide;
        }
        wide.max(corrected(tail(density, nearest(density, k, averages), k, averages), searched))
    };
    let mut lines = vec![];
    let mut k = FIRST_BIN;
    while k < end {
        if probability(k) > false_alarm_rate {
            k += 1;
            continue;
        }
        let from = k;
        let mut to = k;
        while let Some(next) =
            (to + 1..(to + 2 + HALF_LOBE_BINS).min(end)).find(|j| probability(*j) <= false_alarm_rate)
        {
            to = next;
        }
        let peak = (from..=to).max_by(|a, b| (density[*a]).total_cmp(&density[*b])).unwrap_or(from);
        lines.push(line(spectrum, &floor.level, tau0_s, (from, peak, to), probability(peak)));
        k = to + 1 + HALF_LOBE_BINS;
    }
    group_harmonics(&mut lines);
    LineSearch { lines, floor: floor.level, searched }
}

fn line(
    spectrum: &WelchSpectrum,
    floor: &[f64],
    tau0_s: f64,
    (from, peak, to): (usize, usize, usize),
    false_alarm_probability: f64,
) -> SpectralLine {
    let density = &spectrum.density;
    let resolution_hz = 1.0 / (spectrum.segment_len as f64 * tau0_s);
    let excess = |k: usize| density.get(k).zip(floor.get(k)).map_or(0.0, |(p, f)| p - f);
    // Hann window: amplitudes at neighbouring bins of a line at offset δ stand as (1 + δ)/(2 − δ).
    let (below, above) = (excess(peak.saturating_sub(1)), excess(peak + 1));
    let (side, neighbour) = if above >= below { (1.0, above) } else { (-1.0, below) };
    let ratio = (neighbour.max(0.0) / excess(peak).max(f64::MIN_POSITIVE)).sqrt();
    let offset = side * ((2.0 * ratio - 1.0) / (ratio + 1.0)).clamp(0.0, 0.5);
    let lobe: f64 =
        (from.min(peak.saturating_sub(HALF_LOBE_BINS))..=to.max(peak + HALF_LOBE_BINS)).map(excess).sum();
    // A pure line on a bin fills 1.5 times its peak, any other more.
    let power = lobe.max(1.5 * excess(peak));
    SpectralLine {
        frequency_hz: (peak as f64 + offset) * resolution_hz,
        resolution_hz,
        amplitude_deg_h: 2.0 * (power.max(0.0) / spectrum.segment_len as f64).sqrt(),
        excess: density[peak] / floor[peak],
        false_alarm_probability,
        harmonic_of: None,
        harmonic_order: 1,
        sinusoid: None,
    }
}

/// Marks lines at multiples of a stronger one. Frequencies of strong lines are good to a few hundredths of
/// a bin; the error of the fundamental is multiplied with the order.
fn group_harmonics(lines: &mut [SpectralLine]) {
    for i in 0..lines.len() {
        let this = lines[i];
        let stronger = lines.iter().enumerate().filter(|(j, base)| {
            *j != i
                && base.amplitude_deg_h > this.amplitude_deg_h
                && base.frequency_hz >= 8.0 * base.resolution_hz
                && harmonic_order(base, &this) >= 2
        });
        let found = stronger
            .max_by(|a, b| a.1.amplitude_deg_h.total_cmp(&b.1.amplitude_deg_h))
            .map(|(j, base)| (j, harmonic_order(base, &this)));
        if let Some((j, order)) = found {
            lines[i].harmonic_of = Some(j);
            lines[i].harmonic_order = order;
        }
    }
}

/// The lines that `keep` holds for, harmonics marked among them.
pub fn retain(lines: &[SpectralLine], keep: impl Fn(&SpectralLine) -> bool) -> Vec<SpectralLine> {
    let mut kept: Vec<SpectralLine> = lines
        .iter()
        .filter(|l| keep(l))
        .map(|l| SpectralLine { harmonic_of: None, harmonic_order: 1, ..*l })
        .collect();
    group_harmonics(&mut kept);
    kept
}

fn harmonic_order(base: &SpectralLine, line: &SpectralLine) -> u32 {
    let order = (line.frequency_hz / base.frequency_hz).round();
    let distance = (line.frequency_hz - order * base.frequency_hz).abs();
    let tolerance = line.resolution_hz * (0.25 + 0.02 * order).min(0.6);
    if order >= 2.0 && distance <= tolerance { order as u32 } else { 1 }
}

fn half_width(k: usize) -> usize {
    (k / 2).clamp(6, 128)
}

/// Bins that the floor at bin `k` rests on.
fn neighbours(k: usize, bins: usize) -> (usize, usize) {
    let h = half_width(k);
    (k.saturating_sub(h).max(FIRST_FLOOR_BIN), (k + h).min(bins.saturating_sub(2)))
}

/// The floor and, in units of the variance of one bin, how well its logarithm is known.
struct Floor {
    level: Vec<f64>,
    spread: Vec<f64>,
}

fn floor_of(density: &[f64], averages: f64) -> Floor {
    let logs: Vec<f64> = density.iter().map(|p| p.max(f64::MIN_POSITIVE).ln()).collect();
    let bins = density.len();
    let to_mean = to_mean(averages);
    let mut nodes: Vec<(f64, f64, f64)> = vec![];
    let (mut k, mut scratch) = (1, vec![]);
    while k + 1 < bins {
        let (level, spread) = log_floor(&logs, k, &mut scratch);
        nodes.push(((k as f64).ln(), level + to_mean, spread));
        k += if k < 64 { 1 } else { half_width(k) / 8 };
    }
    let mut floor = Floor { level: Vec::with_capacity(bins), spread: Vec::with_capacity(bins) };
    let mut node = 0;
    for k in 0..bins {
        let x = (k.max(1) as f64).ln();
        while node + 2 < nodes.len() && nodes[node + 1].0 <= x {
            node += 1;
        }
        let (level, spread) = match (nodes.get(node), nodes.get(node + 1)) {
            (Some(a), Some(b)) => {
                let t = ((x - a.0) / (b.0 - a.0)).clamp(0.0, 1.0);
                (a.1 + (b.1 - a.1) * t, a.2.max(b.2))
            }
            (Some(a), None) => (a.1, a.2),
            _ => (f64::NAN, f64::NAN),
        };
        floor.level.push(level.exp());
        floor.spread.push(spread);
    }
    floor
}

/// Median of ln S about bin `k`, the bins of a line at `k` left out, along the local slope in ln f; and its variance
/// in units of that of one bin, were the medians means of independent bins.
fn log_floor(logs: &[f64], k: usize, scratch: &mut Vec<(f64, f64)>) -> (f64, f64) {
    let (from, to) = neighbours(k, logs.len());
    let centre = (k as f64).ln();
    scratch.clear();
    let outside = (from..=to).filter(|j| j.abs_diff(k) > HALF_LOBE_BINS);
    scratch.extend(outside.map(|j| ((j as f64).ln() - centre, logs[j])));
    if scratch.len() < 2 { (logs[k], 1.0) } else { along_slope(scratch) }
}

/// Median of some logarithms along their slope, at 0; and its variance as above.
fn along_slope(points: &[(f64, f64)]) -> (f64, f64) {
    let (count, middle) = (points.len() as f64, points.len() / 2);
    let mut medians = [(0.0, 0.0); 2];
    for (half, out) in [0..middle, middle..points.len()].into_iter().zip(&mut medians) {
        let mut values: Vec<f64> = points[half.clone()].iter().map(|p| p.1).collect();
        let x = points[half].iter().map(|p| p.0).sum::<f64>() / values.len() as f64;
        *out = (x, median(&mut values));
    }
    let arm = medians[1].0 - medians[0].0;
    let slope = (medians[1].1 - medians[0].1) / arm;
    let slope = if slope.is_finite() { slope } else { 0.0 };
    let mut levels: Vec<f64> = points.iter().map(|p| p.1 - slope * p.0).collect();
    let off_middle = points.iter().map(|p| p.0).sum::<f64>() / count / arm;
    (median(&mut levels), (1.0 + 4.0 * off_middle * off_middle) / count)
}

/// ln of mean over median of a Gamma variate.
fn to_mean(averages: f64) -> f64 {
    -3.0 * (1.0 - 1.0 / (9.0 * averages)).max(0.1).ln()
}

/// Floor of the nearest neighbours and its variance in units of that of a bin: their median, or the one along their
/// slope where that is larger. On a steep flank the first is the level at the middle, whatever it bends.
fn nearest(density: &[f64], k: usize, averages: f64) -> (f64, f64) {
    let from = k.saturating_sub(NEAR_HALF_WIDTH_BINS).max(FIRST_FLOOR_BIN);
    let to = (k + NEAR_HALF_WIDTH_BINS).min(density.len().saturating_sub(2));
    let logs: Vec<f64> =
        density.get(from..=to).unwrap_or_default().iter().map(|p| p.max(f64::MIN_POSITIVE).ln()).collect();
    let mut points: Vec<(f64, f64)> = vec![];
    let centre = k - from;
    points.extend(
        (0..logs.len())
            .filter(|j| j.abs_diff(centre) > HALF_LOBE_BINS)
            .map(|j| (((from + j) as f64 / k as f64).ln(), logs[j])),
    );
    let mut plain: Vec<f64> = points.iter().map(|p| p.1).collect();
    let (sloped, spread) = along_slope(&points);
    ((sloped.max(median(&mut plain)) + to_mean(averages)).exp(), spread)
}

fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { f64::NAN } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Probability of a ratio to a floor of some level and spread at least as large as that of bin `k`, noise alone.
fn tail(density: &[f64], (level, spread): (f64, f64), k: usize, averages: f64) -> f64 {
    let ratio = density[k] / level;
    if ratio <= 1.0 || ratio.is_nan() {
        return 1.0;
    }
    let error = FLOOR_ERROR[usize::from(k >= 64)];
    let variance = FLOOR_INFLATION * spread / averages + error * error;
    upper_f(ratio, 2.0 * averages, 2.0 / variance)
}

/// Upper tail of the F distribution. Beyond 200 degrees of freedom, where the incomplete beta function converges
/// slowly, Paulson's cube-root normal approximation (Biometrics 1942), good to a few percent of the tail there.
fn upper_f(ratio: f64, numerator: f64, denominator: f64) -> f64 {
    let denominator = denominator.max(1.0);
    if numerator <= 200.0 && denominator <= 2000.0 {
        let x = denominator / (denominator + numerator * ratio);
        return beta_reg(0.5 * denominator, 0.5 * numerator, x.clamp(0.0, 1.0));
    }
    let (a, b) = (2.0 / (9.0 * numerator), 2.0 / (9.0 * denominator));
    let root = ratio.cbrt();
    let z = ((1.0 - b) * root - (1.0 - a)) / (a + root * root * b).sqrt();
    normal_probability(-z)
}

fn corrected(probability: f64, family: usize) -> f64 {
    -(family as f64 * (-probability).ln_1p()).exp_m1()
}

/// Share of the power over the floor that a line has in its core.
const CORE_SHARE: f64 = 0.7;
/// Half width of the core in modes, where a line of any phase and frequency keeps nine tenths of its power, and in
/// bins of a windowed periodogram.
const CORE_HALF_WIDTH: [usize; 2] = [3, 2];
/// Bins of the periodogram to each side that a disturbance may fill.
const WINDOW_BINS: f64 = 8.0;
/// Excess, in standard deviations of noise, that is needed to tell.
const MIN_SCORE: f64 = 6.0;

/// True for a line that keeps its phase over the record: its power lies within the few modes that a sinusoid fills. False where
/// it is spread over more of them, as that of a disturbance that decays; true where the evidence cannot tell.
pub fn is_coherent(evidence: &Evidence, line: &SpectralLine) -> bool {
    let near = |bin: &&FineBin, reach: f64| (bin.frequency_hz - line.frequency_hz).abs() <= reach;
    let reach_hz = WINDOW_BINS * line.resolution_hz;
    let ring: Vec<f64> = evidence
        .fine()
        .iter()
        .filter(|b| near(b, 3.0 * reach_hz) && !near(b, reach_hz))
        .map(|b| b.power)
        .collect();
    let window: Vec<&FineBin> = evidence.fine().iter().filter(|b| near(b, reach_hz)).collect();
    let single = window.windows(2).all(|w| w[0].precedes(w[1]));
    if ring.len() < 8 || window.len() < 5 || !single {
        return true;
    }
    let floor = ring.iter().sum::<f64>() / ring.len() as f64;
    let dof = window.first().map_or(1.0, |b| b.dof);
    let excess: f64 = window.iter().map(|b| b.power - floor).sum();
    let sigma = floor * (2.0 * window.len() as f64 / dof).sqrt();
    if excess < MIN_SCORE * sigma {
        return true;
    }
    let peak = (0..window.len()).max_by(|a, b| window[*a].power.total_cmp(&window[*b].power)).unwrap_or(0);
    let half = if dof > 1.5 { CORE_HALF_WIDTH[1] } else { CORE_HALF_WIDTH[0] };
    let core = window.get(peak.saturating_sub(half)..(peak + half + 1).min(window.len())).unwrap_or(&[]);
    core.iter().map(|b| b.power - floor).sum::<f64>() >= CORE_SHARE * excess
}

#[cfg(test)]
#[path = "lines_tests.rs"]
mod tests;
