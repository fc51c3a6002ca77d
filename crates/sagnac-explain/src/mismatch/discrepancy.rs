//! The discrepancy of a law: the physics bends a little where the formula does not (Kennedy and O'Hagan 2001).
//!
//! A law of size A leaves an error of some hundredths of A that is smooth in A itself. Where the law is seen at thousands of deviations,
//! the tests find that error, and other effects would be named for it one after another. So the noise of a hypothesis may hold
//! the power of such an error: that of the law and of Legendre's second and third polynomial of it, times the square of a share that
//! the record decides. The law keeps its name, its interval the width that its own error leaves it, and another effect must
//! explain what no error of the law does.

use super::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use super::hypothesis::fit;
use super::law_error::Discrepancy;
use super::spectral_data::SpectralData;
use super::terms::{MeanTerm, summed};
use std::sync::Arc;

/// Shares of a law that its own error may have.
const SHARES: [f64; 3] = [0.01, 0.03, 0.1];
/// Log-likelihood of a law from which an error of a tenth of it shows, nats.
const MIN_LAW_GAIN: f64 = 200.0;
/// Gain of a discrepancy from which a law has one, nats.
const MIN_DISCREPANCY_GAIN: f64 = 6.0;

/// The error of a fitted law as large as the law itself; `None` for a law that is nothing.
fn whole(term: &MeanTerm, spectral: &SpectralData) -> Option<Discrepancy> {
    let parts = term.course()?.regressors(&term.nonlinear_parameters, &spectral.drivers);
    let law = summed(&parts.columns, &term.coefficients, parts.offset.as_ref(), spectral.drivers.samples);
    let (low, high) = law.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    if !(half > 0.0 && half.is_finite()) {
        return None;
    }
    let legendre: [fn(f64) -> f64; 3] = [|u| u, |u| 1.5 * u * u - 0.5, |u| 0.5 * u * (5.0 * u * u - 3.0)];
    let mut density = vec![0.0; spectral.bins.len()];
    for polynomial in legendre {
        let course: Vec<f64> = law.iter().map(|x| half * polynomial((x - middle) / half)).collect();
        let power = spectral.observed(&spectral.transform(&course));
        density.iter_mut().zip(power).for_each(|(d, p)| *d += p);
    }
    // Of what lies between two modes, either may hold most.
    let beside = |i: usize| density.get(i.saturating_sub(1)..(i + 2).min(density.len())).unwrap_or_default();
    let density =
        (0..density.len()).map(|i| beside(i).iter().sum::<f64>() / beside(i).len() as f64).collect();
    let frequency_hz = spectral.bins.iter().map(|bin| bin.frequency_hz).collect();
    Some(Discrepancy { kind: term.effect.kind(), share: 1.0, frequency_hz, density })
}

/// A fitted hypothesis with the discrepancy of its largest law as the record has it, or without any where it needs none.
pub fn learned(tried: FittedHypothesis, spectra: &SpectralDataSet) -> FittedHypothesis {
    let spectral = &spectra.full;
    let mut exact = tried;
    if exact.hypothesis.courses.is_empty() {
        return exact;
    }
    if exact.hypothesis.noise.discrepancy.take().is_some() {
        exact.fit = fit(&mut exact.hypothesis, spectral);
    }
    let laws = exact.hypothesis.courses.iter().filter_map(|term| whole(term, spectral));
    let sized = laws.map(|law| (law.law_gain(&exact.fit.densities, spectral), law));
    let Some((gain, law)) = sized.max_by(|a, b| a.0.total_cmp(&b.0)) else { return exact };
    if gain < MIN_LAW_GAIN {
        return exact;
    }
    let with_share = |share: f64| {
        let mut out = exact.clone();
        out.hypothesis.noise.discrepancy = Some(Arc::new(Discrepancy { share, ..law.clone() }));
        out.fit = fit(&mut out.hypothesis, spectral);
        out
    };
    let best = SHARES.map(with_share).into_iter();
    let best = best.max_by(|a, b| a.fit.log_likelihood.total_cmp(&b.fit.log_likelihood));
    let least = exact.fit.log_likelihood + MIN_DISCREPANCY_GAIN;
    best.filter(|b| b.fit.log_likelihood >= least).unwrap_or(exact)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Drivers, find};
    use crate::mismatch::hypothesis::Hypothesis;
    use crate::mismatch::noise_fit::Noise;
    use rand::SeedableRng as _;
    use rand_distr::{Distribution as _, StandardNormal};

    /// A scale factor error of so many ppm at a table that swings, bent by a share of it, in white noise of 1 deg/h.
    fn fitted(ppm: f64, bent: f64) -> (FittedHypothesis, SpectralDataSet) {
        let n = 4000;
        let rate = |i: usize| 10.0 * (0.037 * i as f64).sin();
        let rates: Vec<f64> = (0..n).map(rate).collect();
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(3);
        let one = |r: &f64| {
            let noise: f64 = StandardNormal.sample(&mut rng);
            ppm * 0.036 * (r / 10.0 + bent * (r / 10.0).powi(3)) + noise
        };
        let residual: Vec<f64> = rates.iter().map(one).collect();
        let drivers =
            Drivers { dt_s: 1.0, samples: n, averaged: 1, table_rate: Some(rates), ..Drivers::default() };
        let full = SpectralData::new(drivers, &residual, &[]);
        let base = [1.0 / 60.0, 0.0, 0.0];
        let noise = Noise {
            base,
            claimed: base,
            deviation: [0.0; 3],
            bound: [0.0; 3],
            unconstrained: [false; 3],
            quantization_arcsec: 0.0,
            spectra: vec![],
            discrepancy: None,
        };
        let effect = find("sf_error").unwrap();
        let term = MeanTerm { effect, nonlinear_parameters: vec![], coefficients: vec![], states: vec![] };
        let mut hypothesis = Hypothesis { noise, courses: vec![term] };
        let fit = fit(&mut hypothesis, &full);
        let tried = FittedHypothesis { hypothesis, fit, parameters: 1, odds: vec![] };
        (tried, SpectralDataSet { full, slow: None, grid_step_arcsec: None, rows: n, repeated_share: 0.0 })
    }

    #[test]
    fn a_bent_law_has_an_error_and_a_straight_one_has_none() {
        let deviation = |t: &FittedHypothesis| t.fit.mean.covariance[(0, 0)].sqrt();
        // 36 deg/h in noise of 1: some 1.3 million nats.
        let (exact, spectra) = fitted(1000.0, 0.0);
        assert!(learned(exact, &spectra).hypothesis.noise.discrepancy.is_none());
        let (bent, spectra) = fitted(1000.0, 0.05);
        let learned = learned(bent.clone(), &spectra);
        let share = learned.hypothesis.noise.discrepancy.as_ref().map(|d| d.share);
        assert!(share.is_some_and(|s| s >= 0.01), "{share:?}");
        assert!(learned.fit.log_likelihood > bent.fit.log_likelihood + 100.0);
        // The interval of the coefficient is wider for it.
        assert!(deviation(&learned) > 3.0 * deviation(&bent), "{} {}", deviation(&learned), deviation(&bent));
        // A law of a few nats has no error to be seen.
        let (small, spectra) = fitted(3.0, 0.1);
        assert!(super::learned(small, &spectra).hypothesis.noise.discrepancy.is_none());
    }
}
