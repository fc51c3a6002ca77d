//! The mean of a simulated recording: bias, temperature, scale factor or heading.

use crate::effect::{ClaimedMean, Column, Earth, Temperature};
use crate::noise::composite::Composite;
use crate::numeric::cosine::dct2;
use crate::numeric::range::{Bounds, ends};
use crate::series::Series;
use crate::units::EARTH_RATE_DEG_H;

/// Range of a temperature below which its coefficient cannot be fitted, °C.
const LEAST_RANGE_DEGC: f64 = 0.01;
/// Range of a table rate below which its scale factor cannot be fitted, deg/s.
const LEAST_RANGE_DEG_S: f64 = 1e-6;
/// Standard deviations above nil from which a dependence is claimed.
const MIN_CLAIMED_SIGMAS: f64 = 3.0;
/// Most by which the horizontal Earth rate may seem larger than the Earth rate.
const EARTH_EXCESS: f64 = 1.02;

/// Meaning of a column of the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Term {
    Temperature,
    ScaleFactor,
    Cosine,
    Sine,
}

/// The columns that the mean may depend on.
pub struct Columns {
    terms: Vec<(Term, Vec<f64>)>,
    reference_degc: f64,
    known: Vec<f64>,
    /// Place of each row on the uniform grid.
    grid: Vec<usize>,
}

/// A fitted mean.
pub struct FittedMean {
    /// The mean.
    pub claimed: ClaimedMean,
    /// Rate less mean, row by row, deg/h.
    pub residual: Vec<f64>,
    /// Standard deviation of the bias, deg/h.
    pub bias_sd: f64,
    /// Standard deviation of the temperature coefficient, deg/h/°C.
    pub temperature_sd: f64,
    /// Standard deviation of the scale factor, ppm.
    pub scale_factor_sd: f64,
}

impl Columns {
    /// The columns that vary.
    pub fn new(series: &Series) -> Columns {
        let varies = |column: Column, least: f64| {
            let values = series.columns.get(&column)?;
            let Bounds { low, high } = ends(values);
            (high - low > least).then_some(values)
        };
        let mut terms = vec![];
        let mut reference_degc = 20.0;
        if let Some(t) = varies(Column::Temperature, LEAST_RANGE_DEGC) {
            let mean = t.iter().sum::<f64>() / t.len() as f64;
            reference_degc = (mean * 10.0).round() / 10.0;
            terms.push((Term::Temperature, t.iter().map(|v| v - reference_degc).collect()));
        }
        let mut known = vec![0.0; series.rate_deg_h.len()];
        if let Some(rate) = series.columns.get(&Column::TableRate) {
            known = rate.iter().map(|v| 3600.0 * v).collect();
            if varies(Column::TableRate, LEAST_RANGE_DEG_S).is_some() {
                terms.push((Term::ScaleFactor, rate.iter().map(|v| 3600e-6 * v).collect()));
            }
        } else if let Some(angle) = varies(Column::TableAngle, 1.0) {
            terms.push((Term::Cosine, angle.iter().map(|a| a.to_radians().cos()).collect()));
            terms.push((Term::Sine, angle.iter().map(|a| a.to_radians().sin()).collect()));
        }
        let first = series.index.first().copied().unwrap_or(0);
        let grid = series.index.iter().map(|i| (i - first) as usize).collect();
        Columns { terms, reference_degc, known, grid }
    }

    /// A series on the uniform grid, straight lines in its gaps.
    fn uniform(&self, values: &[f64]) -> Vec<f64> {
        let n = self.grid.last().map_or(0, |i| i + 1);
        let mut out = Vec::with_capacity(n);
        let mut before = values.first().copied().unwrap_or(0.0);
        for (i, v) in self.grid.iter().zip(values) {
            let start = out.len();
            let steps = (i + 1).saturating_sub(start);
            for s in 1..=steps {
                out.push(before + (v - before) * s as f64 / steps as f64);
            }
            before = *v;
        }
        out
    }

    /// Fits the mean: by ordinary least squares without a noise, by generalised ones with it.
    pub fn fit(&self, series: &Series, noise: Option<&Composite>) -> FittedMean {
        let target: Vec<f64> = series.rate_deg_h.iter().zip(&self.known).map(|(y, k)| y - k).collect();
        let modes = |v: &[f64]| dct2(&self.uniform(v));
        let y = modes(&target);
        let x: Vec<Vec<f64>> = self.terms.iter().map(|(_, column)| modes(column)).collect();
        let n = y.len();
        let dt = series.sample_interval_s;
        let weight: Vec<f64> = (0..n)
            .map(|k| {
                let f = k as f64 / (2.0 * n as f64 * dt);
                // The mean of the record is free: mode 0 says nothing of the columns.
                let power = noise.map_or(1.0, |m| m.density(f, dt) / dt);
                if k > 0 && power > 0.0 && power.is_finite() { 1.0 / power } else { 0.0 }
            })
            .collect();
        let dot =
            |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).zip(&weight).map(|((a, b), w)| w * a * b).sum() };
        let normal: Vec<Vec<f64>> = x.iter().map(|a| x.iter().map(|b| dot(a, b)).collect()).collect();
        let right: Vec<f64> = x.iter().map(|a| dot(a, &y)).collect();
        let (solution, covariance) = solve(&normal, &right);
        self.fitted(
            &target,
            &solution,
            &covariance,
            noise.map(|m| m.density(0.5 / (n as f64 * dt), dt) / dt / n as f64),
        )
    }

    fn fitted(
        &self,
        target: &[f64],
        b: &[f64],
        covariance: &[f64],
        power_of_mean: Option<f64>,
    ) -> FittedMean {
        let of = |term: Term| {
            let i = self.terms.iter().position(|(t, _)| *t == term)?;
            Some((b.get(i).copied()?, covariance.get(i).copied().unwrap_or(0.0).max(0.0).sqrt()))
        };
        // A dependence that does not differ from nil is not claimed, and takes nothing out.
        let clear = |(value, sd): (f64, f64)| value.abs() > MIN_CLAIMED_SIGMAS * sd;
        // A coefficient that does not differ from nil is claimed with its deviation: that is all that is known of it.
        let temperature = of(Term::Temperature);
        let scale = of(Term::ScaleFactor);
        let heading = of(Term::Cosine).zip(of(Term::Sine)).filter(|(c, s)| {
            let size = c.0.hypot(s.0);
            clear((size, c.1.max(s.1))) && size <= EARTH_EXCESS * EARTH_RATE_DEG_H
        });
        let used = |term: Term| match term {
            Term::Temperature => temperature.map_or(0.0, |t| t.0),
            Term::ScaleFactor => scale.map_or(0.0, |s| s.0),
            Term::Cosine => heading.map_or(0.0, |h| h.0.0),
            Term::Sine => heading.map_or(0.0, |h| h.1.0),
        };
        let mut residual = target.to_vec();
        for (term, column) in &self.terms {
            let coefficient = used(*term);
            for (r, c) in residual.iter_mut().zip(column) {
                *r -= coefficient * c;
            }
        }
        let bias = residual.iter().sum::<f64>() / residual.len().max(1) as f64;
        residual.iter_mut().for_each(|r| *r -= bias);
        FittedMean {
            claimed: ClaimedMean {
                bias_deg_h: bias,
                temperature: temperature.map(|(value, _)| Temperature {
                    coefficient_deg_h_per_degc: value,
                    reference_degc: self.reference_degc,
                }),
                scale_factor_ppm: scale.map(|(value, _)| value),
                earth: heading.map(|((c, _), (s, _))| Earth {
                    latitude_deg: (c.hypot(s) / EARTH_RATE_DEG_H).min(1.0).acos().to_degrees(),
                    azimuth_deg: (-s).atan2(c).to_degrees().rem_euclid(360.0),
                }),
            },
            residual,
            bias_sd: power_of_mean.map_or(0.0, f64::sqrt),
            temperature_sd: temperature.map_or(0.0, |t| t.1),
            scale_factor_sd: scale.map_or(0.0, |s| s.1),
        }
    }
}

/// Solves the normal equations; gives the diagonal of the inverse too. Columns that others hold already get nothing.
fn solve(normal: &[Vec<f64>], right: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let n = right.len();
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut row = normal[i].clone();
            row.push(right[i]);
            row.extend((0..n).map(|j| if i == j { 1.0 } else { 0.0 }));
            row
        })
        .collect();
    let mut dead = vec![false; n];
    for i in 0..n {
        let pivot = rows[i][i];
        if pivot.is_nan() || pivot <= 1e-10 * normal[i][i] {
            dead[i] = true;
            continue;
        }
        let row: Vec<f64> = rows[i].iter().map(|v| v / pivot).collect();
        for (j, other) in rows.iter_mut().enumerate() {
            if j != i {
                let factor = other[i];
                for (a, b) in other.iter_mut().zip(&row) {
                    *a -= factor * b;
                }
            }
        }
        rows[i] = row;
    }
    let of = |i: usize, at: usize| if dead[i] { 0.0 } else { rows[i][at] };
    ((0..n).map(|i| of(i, n)).collect(), (0..n).map(|i| of(i, n + 1 + i)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_equations_are_solved_and_a_column_twice_is_left_out_once() {
        let (solution, covariance) = solve(&[vec![4.0, 2.0], vec![2.0, 3.0]], &[10.0, 9.0]);
        // Determinant 8: (30 − 18)/8 and (36 − 20)/8; the inverse has 3/8 and 4/8.
        assert!((solution[0] - 1.5).abs() < 1e-12 && (solution[1] - 2.0).abs() < 1e-12, "{solution:?}");
        assert!(
            (covariance[0] - 0.375).abs() < 1e-12 && (covariance[1] - 0.5).abs() < 1e-12,
            "{covariance:?}"
        );
        let (solution, covariance) = solve(&[vec![4.0, 4.0], vec![4.0, 4.0]], &[8.0, 8.0]);
        assert_eq!((solution, covariance[1]), (vec![2.0, 0.0], 0.0));
    }
}
