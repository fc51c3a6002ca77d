//! What is usually done with an Allan plot: fits of the five variances, and straight lines.

use super::allan::{Point, nonnegative};
use sagnac::noise::data::NoiseType;
use sagnac::noise::model::TERMS;

/// Coefficients in the order of [`TERMS`]; `None` where a method gives no value.
pub type Values = [Option<f64>; 5];

/// A term counts as found by a fit when it makes this share of the fitted variance at some averaging time.
const VISIBLE: f64 = 0.01;
/// Departure of a slope from that of a term at which the term is still read.
const SLOPE_TOLERANCE: f64 = 0.15;
/// Averaging times a line is read over at least.
const READ_POINTS: usize = 3;
const FLOOR: f64 = 0.664;

/// Allan variance of a term of coefficient 1 (IEEE Std 952 Annex C).
fn unit(term: NoiseType, tau_s: f64) -> f64 {
    let hours = tau_s / 3600.0;
    match term {
        NoiseType::AngleRandomWalk => 1.0 / hours,
        NoiseType::Flicker => 2.0 * std::f64::consts::LN_2 / std::f64::consts::PI,
        NoiseType::RateRandomWalk => hours / 3.0,
        NoiseType::Quantization => 3.0 / (tau_s * tau_s),
        NoiseType::RateRamp => 0.5 * hours * hours,
    }
}

fn total(squares: &[f64], tau_s: f64) -> f64 {
    squares.iter().zip(TERMS).map(|(v, t)| v * unit(t, tau_s)).sum()
}

fn visible(squares: &[f64], points: &[Point]) -> Values {
    let mut out = [None; 5];
    for ((o, v), term) in out.iter_mut().zip(squares).zip(TERMS) {
        let share =
            points.iter().map(|p| v * unit(term, p.tau_s) / total(squares, p.tau_s)).fold(0.0, f64::max);
        *o = (share > VISIBLE).then(|| v.sqrt());
    }
    out
}

fn weighted(points: &[Point]) -> Vec<f64> {
    let rows: Vec<Vec<f64>> =
        points.iter().map(|p| TERMS.iter().map(|t| unit(*t, p.tau_s) / p.variance).collect()).collect();
    nonnegative(&rows, &vec![1.0; points.len()])
}

/// Nonnegative least squares of the variances with weights 1/σ⁴.
pub fn nonnegative_variances(points: &[Point]) -> Values {
    visible(&weighted(points), points)
}

/// Least squares of ln σ, all points of equal weight.
pub fn log_log(points: &[Point]) -> Values {
    let cost =
        |v: &[f64]| -> f64 { points.iter().map(|p| (p.variance / total(v, p.tau_s)).ln().powi(2)).sum() };
    let mut squares = weighted(points);
    let mut best = cost(&squares);
    for _ in 0..100 {
        // Gauss and Newton: the logarithm about the present fit, solved without negative squares.
        let rows: Vec<Vec<f64>> = points
            .iter()
            .map(|p| TERMS.iter().map(|t| unit(*t, p.tau_s) / total(&squares, p.tau_s)).collect())
            .collect();
        let right: Vec<f64> =
            points.iter().map(|p| 1.0 + (p.variance / total(&squares, p.tau_s)).ln()).collect();
        let target = nonnegative(&rows, &right);
        let mut step = 1.0;
        let mut moved = false;
        for _ in 0..20 {
            let trial: Vec<f64> = squares.iter().zip(&target).map(|(a, b)| a + step * (b - a)).collect();
            let value = cost(&trial);
            if value < best {
                moved = best - value > 1e-10 * best;
                (squares, best) = (trial, value);
                break;
            }
            step *= 0.5;
        }
        if !moved {
            break;
        }
    }
    visible(&squares, points)
}

/// Straight lines: the longest stretch of averaging times on which the local slope is that of the term, read at 1 h, on
/// the floor, at 3 h, √2 h and √3 s.
pub fn slopes(points: &[Point]) -> Values {
    let local: Vec<f64> = points
        .windows(2)
        .map(|w| 0.5 * (w[1].variance / w[0].variance).ln() / (w[1].tau_s / w[0].tau_s).ln())
        .collect();
    TERMS.map(|term| {
        let slope = match term {
            NoiseType::Quantization => -1.0,
            NoiseType::AngleRandomWalk => -0.5,
            NoiseType::Flicker => 0.0,
            NoiseType::RateRandomWalk => 0.5,
            NoiseType::RateRamp => 1.0,
        };
        let mut longest = 0..0;
        let mut from = 0;
        for i in 0..=local.len() {
            if i == local.len() || (local[i] - slope).abs() > SLOPE_TOLERANCE {
                if i - from > longest.len() {
                    longest = from..i;
                }
                from = i + 1;
            }
        }
        if longest.len() + 1 < READ_POINTS {
            return None;
        }
        let read = &points[longest.start..=longest.end];
        let mean: f64 = read.iter().map(|p| 0.5 * (p.variance / unit(term, p.tau_s)).ln()).sum::<f64>()
            / read.len() as f64;
        Some(mean.exp())
    })
}

/// The lowest deviation over 0.664, for the bias instability only.
pub fn minimum(points: &[Point]) -> Values {
    let least = points.iter().map(|p| p.variance.sqrt()).fold(f64::INFINITY, f64::min);
    let mut out = [None; 5];
    out[1] = Some(least / FLOOR);
    out
}
