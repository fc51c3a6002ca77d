//! Sinusoids as samples see them: means over the sampling interval.

use rayon::prelude::*;
use std::f64::consts::PI;

/// Samples that are worth handing to another core.
const SHARE: usize = 1 << 14;

/// What a mean over so many cycles leaves of a sinusoid.
pub(super) fn averaged(cycles: f64) -> f64 {
    let x = PI * cycles;
    if x.abs() < 1e-6 { 1.0 - x * x / 6.0 } else { x.sin() / x }
}

/// Cosine and sine of the phase of each sample, given in cycles, with what the sample's own mean leaves of them.
pub(super) fn pair(samples: usize, phase: impl Fn(usize) -> (f64, f64) + Sync) -> Vec<Vec<f64>> {
    let of = |i: usize| {
        let (cycles, left) = phase(i);
        let (s, c) = (2.0 * PI * cycles.fract()).sin_cos();
        (left * c, left * s)
    };
    let (cosine, sine) = (0..samples).into_par_iter().with_min_len(SHARE).map(of).unzip();
    vec![cosine, sine]
}

/// Amplitude and phase, deg, of `a cos x + b sin x` as `A cos(x + φ)`; NaN for other than two coefficients.
pub(super) fn polar(coefficients: &[f64]) -> (f64, f64) {
    match coefficients {
        [a, b] => (a.hypot(*b), (-b).atan2(*a).to_degrees()),
        _ => (f64::NAN, f64::NAN),
    }
}

/// `A cos(x + φ)` of the columns that [`pair`] gives.
pub(super) fn wave(amplitude: f64, phase_deg: f64, columns: &[Vec<f64>]) -> Vec<f64> {
    let (s, c) = phase_deg.to_radians().sin_cos();
    match columns {
        [cosine, sine] => cosine.iter().zip(sine).map(|(x, y)| amplitude * (c * x - s * y)).collect(),
        _ => vec![],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_of_a_sinusoid_is_its_integral_over_the_interval() {
        for cycles in [1e-9f64, 0.1, 0.49, 0.9] {
            let steps = 20_000;
            let mean = (0..steps)
                .map(|i| (2.0 * PI * cycles * ((f64::from(i) + 0.5) / f64::from(steps) - 0.5)).cos())
                .sum::<f64>()
                / f64::from(steps);
            assert!((averaged(cycles) - mean).abs() < 1e-8, "{cycles}");
        }
    }

    #[test]
    fn amplitude_and_phase_give_the_columns_back() {
        let columns = pair(50, |i| (0.07 * i as f64, 1.0));
        let (amplitude, phase) = polar(&[0.3, -1.1]);
        for (i, x) in wave(amplitude, phase, &columns).iter().enumerate() {
            let y = 2.0 * PI * 0.07 * i as f64;
            assert!((x - (0.3 * y.cos() - 1.1 * y.sin())).abs() < 1e-12);
        }
    }
}
