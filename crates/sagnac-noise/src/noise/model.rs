//! The noise model of a gyro at rest and its closed forms: spectra, Allan variances, variances of means.
//!
//! Samples are averages over their interval (rate-integrating output), so every formula holds at any averaging
//! time: the mean of m samples is a sample of the interval m·τ0.
//! Sources: IEEE Std 952 Annex C (Allan variances); Barnes, NBS Tech. Note 375 (variance of window means); Walter,
//! IEEE Trans. Instrum. Meas. 43(1) 1994 (sampled forms).

use super::data::NoiseType;
use crate::numeric::special::hurwitz_zeta_3;
use std::f64::consts::{LN_2, PI};

const SECONDS_PER_HOUR: f64 = 3600.0;

/// The terms in the order in which arrays hold them.
pub const TERMS: [NoiseType; 5] = [
    NoiseType::AngleRandomWalk,
    NoiseType::Flicker,
    NoiseType::RateRandomWalk,
    NoiseType::Quantization,
    NoiseType::RateRamp,
];

/// Coefficients of the noise terms; 0 where a term is absent.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NoiseModel {
    /// Angle random walk N, deg/√h.
    pub n: f64,
    /// Flicker coefficient B of the two-sided density B²/(2πf), deg/h. The Allan floor is 0.664 B.
    pub b: f64,
    /// Rate random walk K, deg/h/√h.
    pub k: f64,
    /// Rate ramp R, deg/h/h, with its sign.
    pub r: f64,
    /// Quantisation Q, arcsec: standard deviation of the angle error at each sampling instant.
    pub q: f64,
}

/// Where a spectrum is looked at: one bin of one transform of means over `tau_s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Averaging time of the transformed means, s.
    pub tau_s: f64,
    /// Mean over the transformed means of full count / usable count, at least 1.
    pub filling: f64,
    /// Order of the cosine mode, 0 for a bin of an averaged periodogram.
    pub mode: usize,
    /// Number of means transformed, 0 for an averaged periodogram.
    pub blocks: usize,
    /// Samples under the window of an averaged periodogram, 0 for a cosine mode.
    pub segment: usize,
}

/// A stochastic term that has a spectrum. Anything that implements it can be fitted to [`super::evidence::Evidence`].
pub trait Spectral {
    /// Two-sided density of the means, aliases included, (deg/h)²/Hz, that the transform shows on average at `bin`,
    /// for a coefficient of 1.
    fn density(&self, bin: &Bin) -> f64;

    /// True when [`Spectral::density`] knows what the window of a periodogram does to it. Otherwise the window is
    /// accounted for by the curvature of the density.
    fn knows_windows(&self) -> bool {
        false
    }
}

impl Spectral for NoiseType {
    fn density(&self, bin: &Bin) -> f64 {
        unit_density(*self, bin.frequency_hz, bin.tau_s) * bin_ratio(*self, bin)
    }
}

/// Variance of the cosine mode `mode` ≥ 1 of `blocks` means over `tau_s`, (deg/h)², for a coefficient of 1.
pub fn unit_mode_variance(term: NoiseType, mode: usize, blocks: usize, tau_s: f64) -> f64 {
    let frequency_hz = mode as f64 / (2.0 * blocks.max(1) as f64 * tau_s);
    let ratio = match term {
        NoiseType::Flicker => flicker_mode_ratio(mode, blocks),
        NoiseType::Quantization => quantization_mode_ratio(mode, blocks),
        NoiseType::AngleRandomWalk | NoiseType::RateRandomWalk | NoiseType::RateRamp => 1.0,
    };
    unit_density(term, frequency_hz, tau_s) * ratio / tau_s
}

/// What the transform shows at a bin on average, over the density there.
pub fn bin_ratio(term: NoiseType, bin: &Bin) -> f64 {
    match term {
        NoiseType::AngleRandomWalk => bin.filling.max(1.0),
        NoiseType::Flicker => flicker_mode_ratio(bin.mode, bin.blocks),
        NoiseType::Quantization => quantization_mode_ratio(bin.mode, bin.blocks),
        NoiseType::RateRandomWalk | NoiseType::RateRamp => 1.0,
    }
}

/// Two-sided density of means over `tau_s` at `frequency_hz` ≤ 1/(2 `tau_s`), (deg/h)²/Hz, aliases included, for a
/// coefficient of 1. 0 for the ramp, which has no spectrum.
pub fn unit_density(term: NoiseType, frequency_hz: f64, tau_s: f64) -> f64 {
    let x = frequency_hz * tau_s;
    let sin2 = (PI * x).sin().powi(2);
    match term {
        NoiseType::AngleRandomWalk => SECONDS_PER_HOUR,
        NoiseType::Flicker => {
            tau_s / (2.0 * PI.powi(3)) * sin2 * (hurwitz_zeta_3(x) + hurwitz_zeta_3(1.0 - x))
        }
        NoiseType::RateRandomWalk => {
            tau_s * tau_s * (1.0 - 2.0 / 3.0 * sin2) / (4.0 * sin2) / SECONDS_PER_HOUR
        }
        NoiseType::Quantization => 4.0 * sin2 / tau_s,
        NoiseType::RateRamp => 0.0,
    }
}

/// Two-sided density at `frequency_hz` that a claim states for a coefficient of 1, (deg/h)²/Hz: 3600, 1/(2πf),
/// 1/(3600 (2πf)²), as the samples show them up to the Nyquist frequency. `None` for terms that claims do not state so.
pub fn claimed_unit_density(term: NoiseType, frequency_hz: f64) -> Option<f64> {
    let w = 2.0 * PI * frequency_hz;
    match term {
        NoiseType::AngleRandomWalk => Some(SECONDS_PER_HOUR),
        NoiseType::Flicker => Some(1.0 / w),
        NoiseType::RateRandomWalk => Some(1.0 / (SECONDS_PER_HOUR * w * w)),
        NoiseType::Quantization | NoiseType::RateRamp => None,
    }
}

/// Allan variance at `tau_s` for a coefficient of 1, (deg/h)².
pub fn unit_allan_variance(term: NoiseType, tau_s: f64) -> f64 {
    let tau_h = tau_s / SECONDS_PER_HOUR;
    match term {
        NoiseType::AngleRandomWalk => 1.0 / tau_h,
        NoiseType::Flicker => 2.0 * LN_2 / PI,
        NoiseType::RateRandomWalk => tau_h / 3.0,
        NoiseType::Quantization => 3.0 / (tau_s * tau_s),
        NoiseType::RateRamp => 0.5 * tau_h * tau_h,
    }
}

/// V(t) for a coefficient of 1, (deg/h)²: the variance of a mean over `t_s`, for terms that are not stationary up
/// to a constant that cancels in every difference. Allan variance is 2[V(τ) − V(2τ)], and the expected sample
/// variance of n adjacent means is n/(n−1)·[V(τ) − V(nτ)].
pub fn unit_mean_variance(term: NoiseType, t_s: f64) -> f64 {
    let t_h = t_s / SECONDS_PER_HOUR;
    match term {
        NoiseType::AngleRandomWalk => 1.0 / t_h,
        NoiseType::Flicker => -t_h.ln() / PI,
        NoiseType::RateRandomWalk => -t_h / 6.0,
        NoiseType::Quantization => 2.0 / (t_s * t_s),
        NoiseType::RateRamp => -t_h * t_h / 12.0,
    }
}

/// The 1/f rate noise is not stationary: its lowest cosine modes hold a fixed share of the density at their
/// frequency (0.774, 0.903, 0.931, ... for k = 1, 2, 3, ...), the same for any length of record.
fn flicker_mode_ratio(mode: usize, blocks: usize) -> f64 {
    static RATIO_TABLE: std::sync::LazyLock<Vec<f64>> = std::sync::LazyLock::new(|| {
        (1..=TABLE_LEN).map(|k| exact_flicker_mode_ratio(k, TABLE_BLOCKS)).collect()
    });
    const TABLE_LEN: usize = 48;
    const TABLE_BLOCKS: usize = 1024;
    if mode == 0 || blocks == 0 {
        return 1.0;
    }
    let shortfall = match RATIO_TABLE.get(mode - 1) {
        Some(ratio) => 1.0 - ratio,
        None => 0.2028 / mode as f64,
    };
    1.0 - shortfall * (1.0 - (mode as f64 / blocks as f64).powf(2.5))
}

/// E\[c_k²\]·τ / S(f_k) of flicker noise by summing its generalised covariance over all pairs of block means.
fn exact_flicker_mode_ratio(k: usize, blocks: usize) -> f64 {
    let (m, a) = (blocks as f64, PI * k as f64 / blocks as f64);
    let square_log = |x: f64| if x > 0.0 { x * x * x.ln() } else { 0.0 };
    let mut sum = 0.0;
    for d in 1..blocks {
        let d = d as f64;
        let covariance = -(square_log(d + 1.0) - 2.0 * square_log(d) + square_log(d - 1.0)) / (2.0 * PI);
        sum += 2.0 * covariance * ((m - d) * (a * d).cos() - (a * d).sin() / a.sin()) / m;
    }
    sum / unit_density(NoiseType::Flicker, k as f64 / (2.0 * m), 1.0)
}

/// The two ends of a record have one neighbour only, which raises the cosine modes of differenced white angle.
fn quantization_mode_ratio(mode: usize, blocks: usize) -> f64 {
    if mode == 0 || blocks == 0 {
        return 1.0;
    }
    let m = blocks as f64;
    1.0 + (PI * mode as f64 / (2.0 * m)).tan().powi(-2) / m
}

impl NoiseModel {
    /// The coefficient of a term (unit of the term).
    pub fn coefficient(&self, term: NoiseType) -> f64 {
        match term {
            NoiseType::AngleRandomWalk => self.n,
            NoiseType::Flicker => self.b,
            NoiseType::RateRandomWalk => self.k,
            NoiseType::RateRamp => self.r,
            NoiseType::Quantization => self.q,
        }
    }

    /// The same model with one coefficient replaced.
    #[must_use]
    pub fn with(mut self, term: NoiseType, coefficient: f64) -> NoiseModel {
        match term {
            NoiseType::AngleRandomWalk => self.n = coefficient,
            NoiseType::Flicker => self.b = coefficient,
            NoiseType::RateRandomWalk => self.k = coefficient,
            NoiseType::RateRamp => self.r = coefficient,
            NoiseType::Quantization => self.q = coefficient,
        }
        self
    }

    /// Two-sided density of means over `tau_s`, (deg/h)²/Hz, without the ramp.
    pub fn density(&self, frequency_hz: f64, tau_s: f64) -> f64 {
        self.sum(|term| unit_density(term, frequency_hz, tau_s))
    }

    /// Allan variance at `tau_s`, (deg/h)².
    pub fn allan_variance(&self, tau_s: f64) -> f64 {
        self.sum(|term| unit_allan_variance(term, tau_s))
    }

    /// V(t) of the whole model, (deg/h)²; see [`unit_mean_variance`].
    pub fn mean_variance(&self, t_s: f64) -> f64 {
        self.sum(|term| unit_mean_variance(term, t_s))
    }

    /// Share of each term of [`TERMS`] in the Allan variance at `tau_s`; zeros when the model is empty.
    pub fn shares(&self, tau_s: f64) -> [f64; 5] {
        let total = self.allan_variance(tau_s);
        TERMS.map(|term| {
            if total > 0.0 {
                self.coefficient(term).powi(2) * unit_allan_variance(term, tau_s) / total
            } else {
                0.0
            }
        })
    }

    /// The term with the largest share at `tau_s`; angle random walk when the model is empty.
    pub fn dominant(&self, tau_s: f64) -> NoiseType {
        let shares = self.shares(tau_s);
        let mut best = 0;
        for (i, share) in shares.iter().enumerate() {
            if *share > shares[best] {
                best = i;
            }
        }
        TERMS[best]
    }

    fn sum(&self, unit: impl Fn(NoiseType) -> f64) -> f64 {
        TERMS
            .iter()
            .map(|&term| {
                let c = self.coefficient(term);
                // An absent term must not bring in an infinity of its unit form.
                if c == 0.0 { 0.0 } else { c * c * unit(term) }
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 4 ∫ S sin⁴(πfτ)/(πfτ)² df of the samples' own spectrum, by the sum over a discrete band: for a series of
    /// interval τ0 the Allan variance at τ0 is ∫ S(f)·4 sin²(πfτ0)/2 df over −½..½ /τ0.
    fn allan_from_sampled_density(term: NoiseType, tau: f64) -> f64 {
        let steps = 200_000;
        let width = 0.5 / tau / f64::from(steps);
        (0..steps)
            .map(|i| {
                let f = (f64::from(i) + 0.5) * width;
                2.0 * unit_density(term, f, tau) * 2.0 * (PI * f * tau).sin().powi(2) * width
            })
            .sum()
    }

    #[test]
    fn sampled_spectra_integrate_to_the_allan_variances() {
        for term in [
            NoiseType::AngleRandomWalk,
            NoiseType::Flicker,
            NoiseType::RateRandomWalk,
            NoiseType::Quantization,
        ] {
            for tau in [0.01, 1.0, 640.0] {
                let ratio = allan_from_sampled_density(term, tau) / unit_allan_variance(term, tau);
                assert!((ratio - 1.0).abs() < 1e-6, "{term:?} {tau}: {ratio}");
            }
        }
    }

    #[test]
    fn allan_variances_follow_from_the_variance_of_means() {
        for term in TERMS {
            for tau in [0.5, 100.0, 7200.0] {
                let from_means = 2.0 * (unit_mean_variance(term, tau) - unit_mean_variance(term, 2.0 * tau));
                assert!((from_means / unit_allan_variance(term, tau) - 1.0).abs() < 1e-12, "{term:?}");
            }
        }
    }

    #[test]
    fn published_reading_points() {
        let at = |m: NoiseModel, tau| m.allan_variance(tau).sqrt();
        assert!((at(NoiseModel { n: 0.01, ..Default::default() }, 3600.0) - 0.01).abs() < 1e-15);
        assert!((at(NoiseModel { k: 0.02, ..Default::default() }, 10800.0) - 0.02).abs() < 1e-15);
        assert!(
            (at(NoiseModel { r: 0.03, ..Default::default() }, 2f64.sqrt() * 3600.0) - 0.03).abs() < 1e-15
        );
        assert!((at(NoiseModel { q: 0.04, ..Default::default() }, 3f64.sqrt()) - 0.04).abs() < 1e-15);
        assert!((at(NoiseModel { b: 1.0, ..Default::default() }, 5.0) - 0.664_282_470_3).abs() < 1e-9);
        // With N and K only the minimum lies at √3 N/K hours and equals 1.0745699 √(NK).
        let (n, k): (f64, f64) = (0.003, 0.0007);
        let minimum = at(NoiseModel { n, k, ..Default::default() }, 3f64.sqrt() * n / k * 3600.0);
        assert!((minimum / (n * k).sqrt() - 1.074_569_9).abs() < 1e-6);
    }

    #[test]
    fn sampled_flicker_lies_below_the_continuous_line_by_the_published_amounts() {
        let ratio = |x: f64| unit_density(NoiseType::Flicker, x, 1.0) * 2.0 * PI * x;
        assert!((ratio(1e-4) - 1.0).abs() < 1e-6);
        assert!((0.89..0.91).contains(&ratio(0.2)), "{}", ratio(0.2));
        assert!((0.84..0.86).contains(&ratio(0.5)), "{}", ratio(0.5));
    }

    #[test]
    fn lowest_modes_hold_the_computed_share_of_flicker() {
        // Exact quadratic forms computed with an independent program at 65536 blocks.
        for (k, expected) in [(1, 0.7737), (2, 0.90282), (10, 0.97978), (63, 0.99678), (200, 0.99899)] {
            assert!((flicker_mode_ratio(k, 65536) - expected).abs() < 3e-5, "{k}");
        }
        assert!((flicker_mode_ratio(8, 16) - 0.9793).abs() < 1e-3);
    }

    #[test]
    fn shares_sum_to_one_and_name_the_largest() {
        let model = NoiseModel { n: 0.002, b: 0.003, k: 0.001, r: 0.0005, q: 0.1 };
        for tau in [0.01, 1.0, 1e3, 1e5] {
            assert!((model.shares(tau).iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
        assert_eq!(model.dominant(0.1), NoiseType::Quantization);
        assert_eq!(model.dominant(1e6), NoiseType::RateRamp);
        assert_eq!(NoiseModel::default().dominant(1.0), NoiseType::AngleRandomWalk);
    }

    #[test]
    fn stated_densities_are_those_of_the_samples_far_below_their_rate() {
        // 3600; 1/(2πf); 1/(3600 (2πf)²) at f = 1/(2π).
        let at = |term| claimed_unit_density(term, 0.5 / PI);
        assert_eq!(at(NoiseType::AngleRandomWalk), Some(3600.0));
        assert!((at(NoiseType::Flicker).unwrap() - 1.0).abs() < 1e-15);
        assert!((at(NoiseType::RateRandomWalk).unwrap() * 3600.0 - 1.0).abs() < 1e-15);
        assert_eq!((at(NoiseType::Quantization), at(NoiseType::RateRamp)), (None, None));
        for term in [NoiseType::AngleRandomWalk, NoiseType::Flicker, NoiseType::RateRandomWalk] {
            for f in [1e-5, 1e-4] {
                let ratio = unit_density(term, f, 1.0) / claimed_unit_density(term, f).unwrap();
                assert!((ratio - 1.0).abs() < 1e-3, "{term:?} {f}: {ratio}");
            }
        }
    }
}
