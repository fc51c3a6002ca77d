//! The Russian de-facto figures (standard deviation of 100-s and 10-s means) and their relation to a noise model.
//!
//! Sources: Barnes, NBS Technical Note 375 (variance of adjacent means); Schlossberger and Howe 2019 (octave
//! identity).

use super::data::NoiseType;
use super::model::{NoiseModel, TERMS, unit_mean_variance};

/// E\[s²\] of `windows` adjacent means over `tau_s` for a coefficient of 1, (deg/h)²; s² has windows − 1 in its
/// denominator. `None` below two windows.
pub fn unit_expected_variance(term: NoiseType, tau_s: f64, windows: u64) -> Option<f64> {
    if windows < 2 {
        return None;
    }
    let n = windows as f64;
    Some(n / (n - 1.0) * (unit_mean_variance(term, tau_s) - unit_mean_variance(term, n * tau_s)))
}

/// What a model predicts for the standard deviation of window means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// √E\[s²\], deg/h.
    pub sigma: f64,
    /// Share of each term of [`TERMS`] in E\[s²\]; they sum to 1.
    pub shares: [f64; 5],
}

/// Predicts the standard deviation of `windows` adjacent means over `tau_s`; `None` below two windows or for an
/// empty model.
pub fn predict(model: &NoiseModel, tau_s: f64, windows: u64) -> Option<Prediction> {
    let mut parts = [0.0; 5];
    for (part, term) in parts.iter_mut().zip(TERMS) {
        *part = model.coefficient(term).powi(2) * unit_expected_variance(term, tau_s, windows)?;
    }
    let total: f64 = parts.iter().sum();
    (total > 0.0).then(|| Prediction { sigma: total.sqrt(), shares: parts.map(|p| p / total) })
}

/// Standard deviation of the prediction that comes from the covariance of the coefficients (order of [`TERMS`]),
/// deg/h. The scatter of the observed value itself is not in it.
pub fn prediction_uncertainty(
    model: &NoiseModel,
    covariance: &[[f64; 5]; 5],
    tau_s: f64,
    windows: u64,
) -> Option<f64> {
    let sigma = predict(model, tau_s, windows)?.sigma;
    let mut gradient = [0.0; 5];
    for (g, term) in gradient.iter_mut().zip(TERMS) {
        *g = model.coefficient(term) * unit_expected_variance(term, tau_s, windows)? / sigma;
    }
    let mut square = 0.0;
    for (row, gi) in covariance.iter().zip(gradient) {
        square += gi * row.iter().zip(gradient).map(|(c, gj)| c * gj).sum::<f64>();
    }
    Some(square.max(0.0).sqrt())
}

/// Angle random walk from the standard deviation of 10-s means, deg/√h: N = √10·σ10/60.
///
/// The bandwidth in the formula is that of the averaging (1/10 s), not that of the instrument.
pub fn angle_random_walk_from_10s(sigma_10s_deg_h: f64) -> f64 {
    10f64.sqrt() * sigma_10s_deg_h / 60.0
}

/// One octave of the identity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Octave {
    /// Averaging time, s.
    pub tau_s: f64,
    /// Allan variance of disjoint pairs of means over it, (deg/h)².
    pub allan_variance: f64,
    /// Its share in the variance of the window means.
    pub share: f64,
}

/// How the variance of window means is made up of Allan variances: s²·(n−1)/n = ½ Σ_j σ²_A(2^j τ) exactly, with
/// disjoint pairs, for n a power of two.
#[derive(Debug, Clone, PartialEq)]
pub struct OctaveIdentity {
    /// Windows used: the largest power of two that the record holds; the rest at the end is left out.
    pub windows: usize,
    /// Sample standard deviation of the windows used (n − 1), deg/h.
    pub sigma: f64,
    /// Contributions from the shortest averaging time up.
    pub octaves: Vec<Octave>,
}

/// Splits the variance of adjacent window means into octaves; `None` below two windows, when a mean is not finite,
/// or when all are equal.
pub fn octave_identity(means: &[f64], tau_s: f64) -> Option<OctaveIdentity> {
    let windows = 1usize << means.len().checked_ilog2()?;
    let used = means.get(..windows)?;
    if windows < 2 || used.iter().any(|m| !m.is_finite()) {
        return None;
    }
    let mut octaves: Vec<Octave> = vec![];
    let (mut level, mut tau) = (used.to_vec(), tau_s);
    while level.len() > 1 {
        let pairs: Vec<(f64, f64)> =
            level.chunks_exact(2).filter_map(|p| Some((*p.first()?, *p.last()?))).collect();
        let allan_variance =
            pairs.iter().map(|(a, b)| (a - b).powi(2)).sum::<f64>() / (2.0 * pairs.len() as f64);
        octaves.push(Octave { tau_s: tau, allan_variance, share: 0.0 });
        level = pairs.iter().map(|(a, b)| 0.5 * (a + b)).collect();
        tau *= 2.0;
    }
    let total: f64 = octaves.iter().map(|o| o.allan_variance).sum();
    if total <= 0.0 {
        return None;
    }
    for octave in &mut octaves {
        octave.share = octave.allan_variance / total;
    }
    let n = windows as f64;
    Some(OctaveIdentity { windows, sigma: (0.5 * total * n / (n - 1.0)).sqrt(), octaves })
}

/// Quantiles of the minimum of the Allan deviation of pure angle random walk over τ up to `tau_max`, in units of
/// N/√T: (T/τ_max, 5 %, 50 %, 95 %). 1500 simulated records per row.
const NULL_MINIMUM: [(f64, f64, f64, f64); 7] = [
    (2.0, 0.08, 0.78, 2.2),
    (3.0, 0.72, 1.45, 2.6),
    (4.0, 1.02, 1.80, 2.9),
    (5.0, 1.26, 2.04, 3.2),
    (6.0, 1.48, 2.31, 3.4),
    (8.0, 1.87, 2.72, 3.8),
    (10.0, 2.20, 3.03, 4.1),
];

/// What the minimum of the Allan deviation would be for a unit with angle random walk alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NullMinimum {
    /// 5, 50 and 95 % quantiles of the minimum, deg/h.
    pub minimum: [f64; 3],
    /// 5, 50 and 95 % quantiles of the ratio of the expected standard deviation of means over `window_s` to it.
    pub ratio: [f64; 3],
}

/// The null of the minimum for a record of `length_s` read up to `tau_max_s` (the largest τ evaluated): what record
/// length alone produces. An observed minimum not above the 95 % value is no evidence of a floor.
///
/// Interpolated in ln(T/τ_max); beyond T/10 it scales as √(T/τ_max). `None` when τ_max is above T/2 or not positive.
pub fn null_minimum(n: f64, length_s: f64, tau_max_s: f64, window_s: f64) -> Option<NullMinimum> {
    let span = length_s / tau_max_s;
    let first = NULL_MINIMUM.first()?;
    let last = NULL_MINIMUM.last()?;
    if span.is_nan() || span < first.0 || !span.is_finite() || n <= 0.0 {
        return None;
    }
    let quantiles = |row: &(f64, f64, f64, f64)| [row.1, row.2, row.3];
    let scaled = if span >= last.0 {
        quantiles(last).map(|q| q * (span / last.0).sqrt())
    } else {
        let upper = NULL_MINIMUM.iter().position(|row| row.0 > span)?;
        let (a, b) = (NULL_MINIMUM.get(upper - 1)?, NULL_MINIMUM.get(upper)?);
        let weight = (span / a.0).ln() / (b.0 / a.0).ln();
        let (qa, qb) = (quantiles(a), quantiles(b));
        std::array::from_fn(|i| qa[i] + weight * (qb[i] - qa[i]))
    };
    let minimum = scaled.map(|q| q * n / (length_s / 3600.0).sqrt());
    let sigma = 60.0 * n / window_s.sqrt();
    Some(NullMinimum { minimum, ratio: [sigma / minimum[2], sigma / minimum[1], sigma / minimum[0]] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::simulate::{Setup, Simulator};

    #[test]
    fn expected_variances_agree_with_the_published_bias_functions() {
        // Barnes B1 at n = 36, 100, 864: flicker, random walk, ramp; quantisation (2/3)(n+1)/n.
        for (n, flicker, walk, ramp) in [
            (36u64, 2.658819, 18.0, 222.0),
            (100, 3.355483, 50.0, 1683.3333),
            (864, 4.883095, 432.0, 124560.0),
        ] {
            let ratio = |term| {
                unit_expected_variance(term, 100.0, n).unwrap()
                    / crate::noise::model::unit_allan_variance(term, 100.0)
            };
            assert!((ratio(NoiseType::Flicker) / flicker - 1.0).abs() < 1e-6);
            assert!((ratio(NoiseType::RateRandomWalk) / walk - 1.0).abs() < 1e-9);
            assert!((ratio(NoiseType::RateRamp) / ramp - 1.0).abs() < 1e-6);
            assert!((ratio(NoiseType::AngleRandomWalk) - 1.0).abs() < 1e-12);
            let q = 2.0 / 3.0 * (n as f64 + 1.0) / n as f64;
            assert!((ratio(NoiseType::Quantization) / q - 1.0).abs() < 1e-12);
        }
        assert_eq!(unit_expected_variance(NoiseType::Flicker, 100.0, 1), None);
    }

    #[test]
    fn hundred_second_sigma_of_white_noise_is_six_n() {
        let p = predict(&NoiseModel { n: 0.0081, ..Default::default() }, 100.0, 360).unwrap();
        assert!((p.sigma - 0.0486).abs() < 1e-12);
        assert_eq!(p.shares[0], 1.0);
        assert!((angle_random_walk_from_10s(60.0 * 0.0023 / 10f64.sqrt()) - 0.0023).abs() < 1e-15);
    }

    #[test]
    fn predictions_hold_in_simulated_records() {
        let model = NoiseModel { n: 0.002, b: 0.01, k: 0.004, r: 0.0005, q: 0.5 };
        let (n, runs) = (64, 200);
        let mut sum = 0.0;
        for run in 0..runs {
            let setup = Setup { bias_deg_h: 7.77, ..Setup::for_record(run, 100.0, n as u64) };
            let y = Simulator::new(&model, &setup).take(n);
            let mean = y.iter().sum::<f64>() / n as f64;
            sum += y.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1) as f64;
        }
        let ratio = sum / runs as f64 / predict(&model, 100.0, n as u64).unwrap().sigma.powi(2);
        // The walk and the ramp leave the variance fewer degrees of freedom than the samples: a record scatters by a half.
        assert!((ratio - 1.0).abs() < 4.0 * 0.5 / (runs as f64).sqrt(), "{ratio}");
    }

    #[test]
    fn octave_identity_is_exact_on_data() {
        let y: Vec<f64> = (0..70).map(|i: i64| ((i * i * 31) % 17) as f64 + 0.1 * i as f64).collect();
        let identity = octave_identity(&y, 100.0).unwrap();
        let used = &y[..64];
        let mean = used.iter().sum::<f64>() / 64.0;
        let sigma = (used.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 63.0).sqrt();
        assert_eq!((identity.windows, identity.octaves.len()), (64, 6));
        assert!((identity.sigma / sigma - 1.0).abs() < 1e-13);
        assert!((identity.octaves.iter().map(|o| o.share).sum::<f64>() - 1.0).abs() < 1e-13);
        assert_eq!(octave_identity(&[1.0], 100.0), None);
        assert_eq!(octave_identity(&[1.0, f64::NAN], 100.0), None);
    }

    #[test]
    fn null_of_the_minimum_gives_the_published_ratios() {
        // Pure angle random walk, 10 h: median of sigma over 100 s to the minimum is 6.3, 9.3, 13, 24.
        for (span, expected) in [(10.0, 6.3), (5.0, 9.3), (3.0, 13.0), (2.0, 24.0)] {
            let null = null_minimum(0.0023, 36000.0, 36000.0 / span, 100.0).unwrap();
            assert!((null.ratio[1] / expected - 1.0).abs() < 0.03, "{span}: {}", null.ratio[1]);
        }
        assert_eq!(null_minimum(0.0023, 36000.0, 30000.0, 100.0), None);
    }
}
