//! Classical read-outs: a line of fixed slope through the points of σ(τ) that follow it, read where its coefficient is
//! the ordinate.
//!
//! A log-log plot is read this way in data sheets, and some limits are written in such values. It is no estimate of a
//! term beside others: where two terms are near each other the line is too high. Source: IEEE Std 952 Annex C.

use super::data::NoiseType;
use std::ops::Range;

/// Largest difference of the slope over an octave from that of the law.
pub const SLOPE_TOLERANCE: f64 = 0.15;
/// Largest averaging time read, as a share of the record.
pub const LARGEST_SHARE: f64 = 0.1;

/// A point of σ(τ).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlopePoint {
    /// Averaging time, s.
    pub tau_s: f64,
    /// Deviation, deg/h.
    pub deviation: f64,
    /// Degrees of freedom of its variance.
    pub edf: f64,
}

/// A line that was read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReadOut {
    /// Coefficient in its unit.
    pub value: f64,
    /// Degrees of freedom of its square.
    pub dof: f64,
    /// Shortest averaging time on the line, s.
    pub from_s: f64,
    /// Longest averaging time on the line, s.
    pub to_s: f64,
    /// Points on the line.
    pub points: usize,
}

/// Slope of the deviation of a term; 0 for flicker.
pub fn slope(term: NoiseType) -> f64 {
    match term {
        NoiseType::Quantization => -1.0,
        NoiseType::AngleRandomWalk => -0.5,
        NoiseType::Flicker => 0.0,
        NoiseType::RateRandomWalk => 0.5,
        NoiseType::RateRamp => 1.0,
    }
}

/// Averaging time at which the coefficient of a term is the ordinate, s: N at 1 h, K at 3 h, R at √2 h, Q at √3 s.
pub fn reading_time_s(term: NoiseType) -> f64 {
    match term {
        NoiseType::Quantization => 3f64.sqrt(),
        NoiseType::AngleRandomWalk | NoiseType::Flicker => 3600.0,
        NoiseType::RateRandomWalk => 3.0 * 3600.0,
        NoiseType::RateRamp => 2f64.sqrt() * 3600.0,
    }
}

/// Correlation of ln σ² at neighbouring octaves (3000 simulated records; a ramp taken as a walk).
fn neighbour_correlation(term: NoiseType) -> f64 {
    match term {
        NoiseType::Quantization => 0.7,
        NoiseType::AngleRandomWalk => 0.52,
        NoiseType::Flicker => 0.68,
        NoiseType::RateRandomWalk | NoiseType::RateRamp => 0.88,
    }
}

/// The line of the slope of a term through given points, at the geometric mean of what each would read; `None` without
/// a point.
pub fn through(points: &[SlopePoint], term: NoiseType) -> Option<ReadOut> {
    let (first, last) = (points.first()?, points.last()?);
    let n = points.len() as f64;
    let at = reading_time_s(term);
    let read = |p: &SlopePoint| (p.deviation * (at / p.tau_s).powf(slope(term))).ln();
    let value = (points.iter().map(read).sum::<f64>() / n).exp();
    let rho = neighbour_correlation(term);
    let mut variance = 0.0;
    for (i, a) in points.iter().enumerate() {
        for (j, b) in points.iter().enumerate() {
            variance += rho.powi(i.abs_diff(j) as i32) * 0.5 / (a.edf * b.edf).sqrt();
        }
    }
    variance /= n * n;
    (value.is_finite() && value > 0.0).then(|| ReadOut {
        value,
        dof: if variance > 0.0 && variance.is_finite() { 0.5 / variance } else { 0.0 },
        from_s: first.tau_s,
        to_s: last.tau_s,
        points: points.len(),
    })
}

/// Every run of two octaves or more that follows the slope of a term. `octaves` ascend.
pub fn runs(octaves: &[SlopePoint], term: NoiseType) -> Vec<Range<usize>> {
    let follows = |a: &SlopePoint, b: &SlopePoint| {
        let local = (b.deviation / a.deviation).ln() / (b.tau_s / a.tau_s).ln();
        (local - slope(term)).abs() <= SLOPE_TOLERANCE
    };
    let (mut out, mut start) = (vec![], 0);
    for i in 1..=octaves.len() {
        let goes_on = i < octaves.len() && follows(&octaves[i - 1], &octaves[i]);
        if !goes_on {
            if i - start >= 2 {
                out.push(start..i);
            }
            start = i;
        }
    }
    out
}

/// The longest run of octaves that follow the slope of a term, the one at the shorter τ of equal ones; `None` where no
/// octave does. `octaves` ascend.
pub fn read(octaves: &[SlopePoint], term: NoiseType) -> Option<ReadOut> {
    let longest = runs(octaves, term).into_iter().rev().max_by_key(Range::len)?;
    through(octaves.get(longest)?, term)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::model::{TERMS, unit_allan_variance};

    #[test]
    fn a_pure_term_reads_its_coefficient() {
        for term in TERMS.into_iter().filter(|t| *t != NoiseType::Flicker) {
            let points: Vec<SlopePoint> = (0..12)
                .map(|k| f64::from(1u32 << k))
                .map(|tau_s| SlopePoint {
                    tau_s,
                    deviation: 0.3 * unit_allan_variance(term, tau_s).sqrt(),
                    edf: 50.0,
                })
                .collect();
            let found = read(&points, term).unwrap();
            assert!((found.value / 0.3 - 1.0).abs() < 1e-12 && found.points == 12, "{term:?} {found:?}");
            assert!(found.dof > 50.0 && found.dof < 600.0);
            for other in TERMS.into_iter().filter(|t| *t != term && *t != NoiseType::Flicker) {
                assert_eq!(read(&points, other), None, "{term:?} read as {other:?}");
            }
        }
    }

    #[test]
    fn nothing_is_read_from_one_point_or_none() {
        assert_eq!(read(&[], NoiseType::AngleRandomWalk), None);
        let one = SlopePoint { tau_s: 1.0, deviation: 1.0, edf: 9.0 };
        assert_eq!(read(&[one], NoiseType::AngleRandomWalk), None);
        assert_eq!(through(&[], NoiseType::AngleRandomWalk), None);
    }
}
