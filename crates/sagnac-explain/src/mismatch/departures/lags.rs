//! Autocorrelation of the whitened residual: what comes a second time, some time later.

use super::departure::{Departure, White};
use crate::effect::{Domain, Place};
use crate::estimate::ln_normal_two_sided;
use crate::mismatch::several::ln_least_of;
use crate::mismatch::spectral_data::SpectralData;
use crate::noise::autocorrelation::lagged_products;

/// Longest lag, in samples, and fewest of its lengths in a record.
const MAX_LAG_SAMPLES: usize = 20_000;
const MIN_RECORD_LAGS: usize = 8;
/// Fewest samples.
const MIN_SAMPLES: usize = 256;

/// The lag at which the whitened residual is most correlated with itself; under a true hypothesis the correlation at each
/// lag has a variance of one over the number of samples.
pub fn all(spectral: &SpectralData, white: &White) -> Option<Departure> {
    let n = white.series.len();
    if n < MIN_SAMPLES {
        return None;
    }
    let longest = (n / MIN_RECORD_LAGS).min(MAX_LAG_SAMPLES);
    let sums = lagged_products(white.series.iter().copied(), (n + longest + 1).next_power_of_two(), longest)?;
    let variance = sums[0] / n as f64;
    // Of n − k products the sum has a standard deviation of √(n − k) variances.
    let z = |k: usize| sums[k] / (variance * ((n - k) as f64).sqrt());
    let lag = (1..=longest).max_by(|a, b| z(*a).abs().total_cmp(&z(*b).abs()))?;
    let z = z(lag);
    let dt = spectral.drivers.dt_s;
    let place = Place { domain: Domain::Lag, from: (lag as f64 - 0.5) * dt, to: (lag as f64 + 0.5) * dt };
    let ln_p = ln_least_of(ln_normal_two_sided(z), longest as f64);
    Some(Departure { test: "lag", place, beside: None, ln_p, shape: None })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Drivers;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    fn tested(seed: u64, echo: f64) -> Departure {
        let (n, lag) = (4096, 37);
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
        let noise: Vec<f64> = (0..n + lag).map(|_| StandardNormal.sample(&mut rng)).collect();
        let series: Vec<f64> = (0..n).map(|i| noise[i + lag] + echo * noise[i]).collect();
        let drivers = Drivers { dt_s: 0.5, samples: n, averaged: 1, ..Drivers::default() };
        let spectral = SpectralData::new(drivers, &series, &[]);
        let modes = crate::numeric::cosine::dct2(&series);
        let white = White { modes, series, roots: vec![1.0; n] };
        all(&spectral, &white).expect("long enough")
    }

    #[test]
    fn an_echo_is_found_at_its_lag_and_white_noise_has_none() {
        let found = tested(1, -0.15);
        assert!(found.p_value() < 1e-9 && found.place.from < 18.5 && found.place.to > 18.5, "{found:?}");
        let p_values: Vec<f64> = (2..22).map(|seed| tested(seed, 0.0).p_value()).collect();
        // 1 of 20 at the most, by Bonferroni: 5 come about in 3 of 1000 cases, a p-value below 1e-5 in 2 of 10 000.
        let small = p_values.iter().filter(|p| **p < 0.05).count();
        assert!(small <= 4 && p_values.iter().all(|p| *p > 1e-5), "{p_values:?}");
    }
}
