//! Equivalent degrees of freedom of the Allan family.
//!
//! The combined algorithm of Greenhall and Riley (PTTI 2003; NIST SP 1065 section 5.4.1) in the form that is right for
//! integrated rate data: the phase is an exact integral, not a quantity band-limited at the sampling frequency, so
//! their filter factor F is infinite. It is evaluated by direct summation, for any step between terms, and pooled over
//! the unbroken stretches of a record.

use super::data::{DeviationPoint, NoiseType};
use super::family::Estimator;
use super::stretches::StretchLengths;

/// Assumption about the phase between samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PhaseModel {
    /// The exact integral of the rate: gyro data.
    #[default]
    IntegratedRate,
    /// Band-limited at the sampling frequency: the convention of clock work (Stable32, allantools), for comparison.
    BandLimited,
}

/// Steps per averaging time beyond which a finer step no longer changes the result (relative 1e-4).
const MAX_STEPS_PER_TAU: f64 = 256.0;
/// Averaging factor up to which the modified deviation of integrated rate is treated as the discrete average it is.
const DISCRETE_AVERAGE_UP_TO: u64 = 32;

/// Equivalent degrees of freedom of one point of a curve, pooled over the stretches of the record that it was computed
/// from. Terms of different stretches are taken as independent.
pub fn edf(
    estimator: Estimator,
    point: &DeviationPoint,
    stretches: &StretchLengths,
    noise: NoiseType,
    model: PhaseModel,
) -> f64 {
    if estimator == Estimator::Total {
        return total_edf(stretches.longest() as f64 / point.m as f64, noise);
    }
    let (mut terms, mut variance) = (0.0, 0.0);
    for (samples, count) in stretches.iter() {
        let in_one = estimator.terms(samples, point.m, point.stride);
        if in_one > 0 {
            let (in_one, count) = (in_one as f64, count as f64);
            let edf = edf_of_terms(estimator, in_one, point.m, point.stride, noise, model);
            terms += count * in_one;
            variance += count * in_one * in_one / edf;
        }
    }
    if variance > 0.0 { terms * terms / variance } else { 0.0 }
}

/// Equivalent degrees of freedom of the non-overlapping estimate from one unbroken stretch.
pub fn edf_non_overlapping(
    point: &DeviationPoint,
    difference: u32,
    noise: NoiseType,
    model: PhaseModel,
) -> f64 {
    let estimator = if difference == 3 { Estimator::Hadamard } else { Estimator::Allan };
    edf_of_terms(estimator, point.terms as f64, point.m, point.m, noise, model)
}

/// Total deviation: b·T/τ − c, SP 1065 table 7; white angle noise as angle random walk for want of a published value.
fn total_edf(record_over_tau: f64, noise: NoiseType) -> f64 {
    let (b, c) = match noise {
        NoiseType::Quantization | NoiseType::AngleRandomWalk => (1.5, 0.0),
        NoiseType::Flicker => (1.17, 0.22),
        NoiseType::RateRandomWalk | NoiseType::RateRamp => (0.93, 0.36),
    };
    (b * record_over_tau - c).max(1.0)
}

/// Factor by which the total variance is too small: E\[TOTVAR\] / AVAR = 1 − a·τ/T (SP 1065 section 5.2.11).
pub fn total_bias(record_over_tau: f64, noise: NoiseType) -> f64 {
    let a = match noise {
        NoiseType::Quantization | NoiseType::AngleRandomWalk => 0.0,
        NoiseType::Flicker => 1.0 / (3.0 * std::f64::consts::LN_2),
        NoiseType::RateRandomWalk | NoiseType::RateRamp => 0.75,
    };
    1.0 - a / record_over_tau
}

fn edf_of_terms(
    estimator: Estimator,
    terms: f64,
    m: u64,
    stride: u64,
    noise: NoiseType,
    model: PhaseModel,
) -> f64 {
    let order = if estimator == Estimator::Hadamard { 3 } else { 2 };
    if noise == NoiseType::Quantization && estimator != Estimator::Modified {
        return white_angle_edf(order, terms, m, stride);
    }
    let alpha = noise.alpha();
    let factor = m as f64;
    let full = factor / stride.max(1) as f64;
    // Clock programs sum directly up to 100 lags and go over to the limit for large m beyond.
    let direct = terms.min(f64::from(order + 1) * full) <= 100.0;
    let covariance = |t: f64| match (estimator, model) {
        (Estimator::Modified, PhaseModel::IntegratedRate) if alpha <= 0 && m <= DISCRETE_AVERAGE_UP_TO => {
            discrete_average(t, m, alpha)
        }
        (Estimator::Modified, _) => filtered(t, 1.0, alpha),
        (_, PhaseModel::BandLimited) if direct => filtered(t, factor, alpha),
        _ => generalised(t, alpha + 2),
    };
    let steps = full.min(MAX_STEPS_PER_TAU);
    let terms = (terms * steps / full).max(1.0);
    let differenced = |t: f64| {
        let pair = |k: f64| covariance(t - k) + covariance(t + k);
        if order == 2 {
            6.0 * covariance(t) - 4.0 * pair(1.0) + pair(2.0)
        } else {
            20.0 * covariance(t) - 15.0 * pair(1.0) + 6.0 * pair(2.0) - pair(3.0)
        }
    };
    let variance = differenced(0.0);
    let last = terms.min(f64::from(order + 1) * steps).ceil() as u64;
    let sum: f64 = (1..=last)
        .map(|j| j as f64)
        .take_while(|j| *j < terms)
        .map(|j| (1.0 - j / terms) * (differenced(j / steps) / variance).powi(2))
        .sum();
    (terms / (1.0 + 2.0 * sum)).max(1.0)
}

/// White angle noise, unmodified: terms are correlated only where they share a phase.
fn white_angle_edf(order: u32, terms: f64, m: u64, stride: u64) -> f64 {
    let correlations: &[f64] =
        if order == 2 { &[4.0 / 6.0, 1.0 / 6.0] } else { &[15.0 / 20.0, 6.0 / 20.0, 1.0 / 20.0] };
    let shared: f64 = correlations
        .iter()
        .zip(1u64..)
        .map(|(rho, q)| {
            let Some(lag) = q.checked_mul(m).filter(|lag| lag.is_multiple_of(stride.max(1))) else {
                return 0.0;
            };
            (terms - (lag / stride.max(1)) as f64).max(0.0) * rho * rho
        })
        .sum();
    terms * terms / (terms + 2.0 * shared)
}

/// Generalised autocovariance of the phase for rate noise f^alpha, up to a factor.
fn generalised(t: f64, alpha: i32) -> f64 {
    let t = t.abs();
    if t == 0.0 {
        return 0.0;
    }
    match alpha {
        2 => -t,
        1 => t * t * t.ln(),
        0 => t.powi(3),
        -1 => -t.powi(4) * t.ln(),
        -2 => -t.powi(5),
        _ => f64::NAN,
    }
}

/// The same after averaging over 1/F of the averaging time.
fn filtered(t: f64, f: f64, alpha: i32) -> f64 {
    f * f * (2.0 * generalised(t, alpha) - generalised(t - 1.0 / f, alpha) - generalised(t + 1.0 / f, alpha))
}

/// The same after the mean of `m` phases that are exact integrals.
fn discrete_average(t: f64, m: u64, alpha: i32) -> f64 {
    let factor = m as f64;
    (1..m).map(|u| u as f64).fold(generalised(t, alpha + 2), |sum, u| {
        let shift = u / factor;
        let weight = 1.0 - shift;
        sum + weight * (generalised(t - shift, alpha + 2) + generalised(t + shift, alpha + 2))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use NoiseType::{AngleRandomWalk, Flicker, Quantization, RateRandomWalk};

    fn of(
        estimator: Estimator,
        m: u64,
        stride: u64,
        samples: u64,
        noise: NoiseType,
        model: PhaseModel,
    ) -> f64 {
        let terms = estimator.terms(samples, m, stride);
        let point = DeviationPoint { m, terms, stride, deviation: 1.0 };
        edf(estimator, &point, &StretchLengths::of(samples), noise, model)
    }

    fn allan(m: u64, noise: NoiseType) -> f64 {
        of(Estimator::Allan, m, 1, 1000, noise, PhaseModel::IntegratedRate)
    }

    /// Exact sums over the covariance of the terms, 1001 phases of integrated rate.
    #[test]
    fn integrated_rate_agrees_with_the_exact_covariance_sum() {
        const M: [u64; 8] = [1, 2, 4, 8, 16, 64, 128, 256];
        for (noise, expected) in [
            (Quantization, [514.04, 513.27, 511.75, 508.70, 502.61, 466.56, 420.28, 343.51]),
            (AngleRandomWalk, [666.22, 570.20, 346.06, 181.88, 91.15, 21.23, 9.55, 3.88]),
            (Flicker, [880.00, 565.96, 289.62, 144.33, 71.29, 16.49, 7.38, 2.90]),
            (RateRandomWalk, [888.10, 461.82, 230.46, 114.47, 56.47, 12.97, 5.73, 2.16]),
        ] {
            for (m, expected) in M.into_iter().zip(expected) {
                let got = allan(m, noise);
                assert!((got / expected - 1.0).abs() < 5e-3, "{noise:?} {m}: {got} {expected}");
            }
        }
        for (m, expected) in [(1, 513.52), (4, 291.38), (16, 76.96), (64, 17.12), (128, 7.15)] {
            let got = of(Estimator::Hadamard, m, 1, 1000, AngleRandomWalk, PhaseModel::IntegratedRate);
            assert!((got / expected - 1.0).abs() < 5e-3, "hadamard {m}: {got} {expected}");
        }
        for (m, expected) in [(1, 1364.9), (2, 1169.1), (8, 374.6), (64, 45.8), (512, 4.00)] {
            let got = of(Estimator::Allan, m, 1, 2048, AngleRandomWalk, PhaseModel::IntegratedRate);
            assert!((got / expected - 1.0).abs() < 5e-3, "P = 2049, {m}: {got} {expected}");
        }
    }

    /// Stable32 1.60 as printed for its sample file, and allantools 2024.6.
    #[test]
    fn the_clock_convention_reproduces_stable32() {
        let clock = |e, m, noise| of(e, m, 1, 1000, noise, PhaseModel::BandLimited);
        for (m, overlapping, modified) in [
            (1, 782.0303, 782.0303),
            (2, 540.6812, 478.9962),
            (4, 306.0916, 239.9958),
            (8, 165.9878, 118.8731),
            (16, 86.3701, 58.2752),
            (32, 43.3512, 27.9797),
            (64, 21.2395, 12.8485),
            (128, 9.5510, 5.3215),
        ] {
            let got = clock(Estimator::Allan, m, AngleRandomWalk);
            assert!((got / overlapping - 1.0).abs() < 6e-3, "{m}: {got} {overlapping}");
            let got = clock(Estimator::Modified, m, AngleRandomWalk);
            assert!((got / modified - 1.0).abs() < 6e-3, "modified {m}: {got} {modified}");
        }
        for (m, expected) in [(1, 608.5487), (4, 256.7196), (16, 72.5414), (64, 17.1230), (128, 7.1513)] {
            let got = clock(Estimator::Hadamard, m, AngleRandomWalk);
            assert!((got / expected - 1.0).abs() < 6e-3, "hadamard {m}: {got} {expected}");
        }
        for (m, expected) in [(4, 282.3577), (64, 16.5439), (128, 7.3902)] {
            let got = clock(Estimator::Allan, m, Flicker);
            assert!((got / expected - 1.0).abs() < 6e-3, "flicker {m}: {got} {expected}");
        }
        for (m, expected) in [(1, 762.2905), (4, 227.0924), (16, 56.4112), (128, 5.7299)] {
            let got = clock(Estimator::Allan, m, RateRandomWalk);
            assert!((got / expected - 1.0).abs() < 6e-3, "random walk {m}: {got} {expected}");
        }
        for (m, expected) in [(4, 171.3910), (16, 41.1789), (64, 9.5610), (128, 4.2353)] {
            let point = DeviationPoint { m, terms: 1000 / m - 1, stride: m, deviation: 1.0 };
            let got = edf_non_overlapping(&point, 2, AngleRandomWalk, PhaseModel::BandLimited);
            assert!((got / expected - 1.0).abs() < 6e-3, "non-overlapping {m}: {got} {expected}");
        }
        assert!((clock(Estimator::Total, 16, AngleRandomWalk) / 93.8438 - 1.0).abs() < 2e-3);
    }

    #[test]
    fn a_modified_deviation_at_m_1_is_the_allan_deviation() {
        for noise in [AngleRandomWalk, Flicker, RateRandomWalk] {
            let modified = of(Estimator::Modified, 1, 1, 1000, noise, PhaseModel::IntegratedRate);
            assert!((modified / allan(1, noise) - 1.0).abs() < 1e-9);
            let discrete = of(Estimator::Modified, 32, 1, 1000, noise, PhaseModel::IntegratedRate);
            let limit = of(Estimator::Modified, 32, 1, 1000, noise, PhaseModel::BandLimited);
            assert!((discrete / limit - 1.0).abs() < 3e-3, "{noise:?} {discrete} {limit}");
        }
    }

    #[test]
    fn a_stride_of_one_sixty_fourth_costs_less_than_one_percent() {
        for noise in [AngleRandomWalk, Flicker, RateRandomWalk] {
            for (estimator, worst) in
                [(Estimator::Allan, 0.99), (Estimator::Hadamard, 0.99), (Estimator::Modified, 0.99)]
            {
                let all = of(estimator, 4096, 1, 1 << 20, noise, PhaseModel::IntegratedRate);
                let some = of(estimator, 4096, 64, 1 << 20, noise, PhaseModel::IntegratedRate);
                assert!(some / all > worst && some / all < 1.001, "{estimator:?} {noise:?} {some} {all}");
            }
        }
        let all = of(Estimator::Allan, 4096, 1, 1 << 20, Quantization, PhaseModel::IntegratedRate);
        let some = of(Estimator::Allan, 4096, 64, 1 << 20, Quantization, PhaseModel::IntegratedRate);
        assert!(some / all < 0.02);
    }

    #[test]
    fn stretches_add_up() {
        let point = DeviationPoint { m: 8, terms: 0, stride: 1, deviation: 1.0 };
        let mut two = StretchLengths::of(1000);
        two.add(1000);
        let got = edf(Estimator::Allan, &point, &two, Flicker, PhaseModel::IntegratedRate);
        assert!((got / (2.0 * allan(8, Flicker)) - 1.0).abs() < 1e-12);
        two.add(10);
        assert!(edf(Estimator::Allan, &point, &two, Flicker, PhaseModel::IntegratedRate) == got);
    }

    /// SP 1065 table 7 and section 5.2.11: degrees of freedom b·T/τ − c, and 1 − a·τ/T.
    #[test]
    fn the_total_deviation_has_the_published_constants() {
        for (noise, edf, bias) in [
            (AngleRandomWalk, 15.0, 1.0),
            (Flicker, 11.48, 1.0 - 0.480_898_346_962_987_8 / 10.0),
            (RateRandomWalk, 8.94, 0.925),
        ] {
            assert!((total_edf(10.0, noise) - edf).abs() < 1e-12, "{noise:?}");
            assert!((total_bias(10.0, noise) - bias).abs() < 1e-15, "{noise:?}");
        }
        assert_eq!((total_edf(1.0, RateRandomWalk), total_bias(1.5, NoiseType::RateRamp)), (1.0, 0.5));
    }
}
