//! Hypotheses that were fitted, and the score of an addition to one.

use super::hypothesis::{Fit, Hypothesis, PartModes, part_modes, part_modes_of_averages, residual};
use super::several::least_of;
use super::spectral_data::SpectralData;
use super::terms::MeanTerm;
use crate::effect::{Effect, Resolution};
use crate::estimate::chi_square_tail;

/// The two resolutions a problem is looked at.
pub struct SpectralDataSet {
    /// At the sample rate.
    pub full: SpectralData,
    /// Averages, for courses that they hold; `None` where the record is short enough as it is.
    pub slow: Option<SpectralData>,
    /// Angle increment of a grid that the values lie on, arcsec.
    pub grid_step_arcsec: Option<f64>,
    /// Rows of the recording.
    pub rows: usize,
    /// Share of the samples that were drawn about a fitted course, and so repeat what the others say.
    pub repeated_share: f64,
}

impl SpectralDataSet {
    /// The data that a mean model of some resolution is fitted to.
    pub fn of(&self, resolution: Resolution) -> &SpectralData {
        match (resolution, &self.slow) {
            (Resolution::Averaged, Some(slow)) => slow,
            _ => &self.full,
        }
    }

    /// Modes of courses in the data that a model of some resolution is fitted to.
    pub fn part_modes(&self, resolution: Resolution, courses: &[MeanTerm]) -> Vec<PartModes> {
        match (resolution, &self.slow) {
            (Resolution::Averaged, Some(slow)) => part_modes_of_averages(slow, &self.full, courses),
            _ => part_modes(&self.full, courses),
        }
    }
}

/// A hypothesis with its fit.
#[derive(Clone)]
pub struct FittedHypothesis {
    /// The hypothesis, fitted.
    pub hypothesis: Hypothesis,
    /// Its fit on the full-rate data.
    pub fit: Fit,
    /// Parameters that it has beyond the claim.
    pub parameters: usize,
    /// Logarithm of the odds of each of its effects, by kind: what speaks for it against others that explain as much.
    pub odds: Vec<(&'static str, f64)>,
}

impl FittedHypothesis {
    /// −2 ln L + parameters · ln rows.
    pub fn bic(&self, rows: usize) -> f64 {
        -2.0 * self.fit.log_likelihood + self.parameters as f64 * (rows as f64).ln()
    }

    /// The odds with those of one more effect.
    pub fn odds_with(&self, effect: &dyn Effect, odds: f64) -> Vec<(&'static str, f64)> {
        self.odds.iter().copied().chain([(effect.kind(), odds)]).collect()
    }

    /// The odds without those of one effect.
    pub fn odds_without(&self, effect: &dyn Effect) -> Vec<(&'static str, f64)> {
        let mut odds = self.odds.clone();
        if let Some(at) = odds.iter().position(|(kind, _)| *kind == effect.kind()) {
            odds.remove(at);
        }
        odds
    }

    /// Modes of what the hypothesis leaves of the full-rate data.
    pub fn residual(&self, spectra: &SpectralDataSet) -> Vec<f64> {
        residual(&spectra.full, &self.hypothesis, &self.fit.mean)
    }

    /// Variance of each mode of the full-rate data, (deg/h)².
    pub fn powers(&self, spectra: &SpectralDataSet) -> Vec<f64> {
        spectra.full.powers(&self.fit.densities)
    }

    /// Criterion by which hypotheses are ordered: BIC less twice the logarithm of the prior odds of their effects.
    pub fn rank(&self, rows: usize) -> f64 {
        self.bic(rows) - 2.0 * self.odds.iter().map(|(_, odds)| odds).sum::<f64>()
    }
}

/// An addition that was fitted.
#[derive(Clone)]
pub struct Candidate {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// The hypothesis with it.
    pub tried: FittedHypothesis,
    /// Gain of log-likelihood over the hypothesis without it.
    pub gain: f64,
    /// Parameters that it adds.
    pub parameters: usize,
    /// BIC without it less BIC with it.
    pub delta_bic: f64,
    /// Probability of such a gain without it, its own search counted.
    pub p_value: f64,
}

/// Effort of the search for an addition.
#[derive(Debug, Clone, Copy)]
pub(super) struct SearchEffort {
    /// Numbers that were fitted.
    pub numbers: usize,
    /// Independent places that its own search looked at.
    pub trials: f64,
}

/// An addition with its gain, ΔBIC and p-value.
pub(super) fn score_candidate(
    effect: &'static dyn Effect,
    tried: FittedHypothesis,
    before: &FittedHypothesis,
    effort: SearchEffort,
    rows: usize,
) -> Candidate {
    let gain = tried.fit.log_likelihood - before.fit.log_likelihood;
    let parameters = tried.parameters - before.parameters;
    let chance = chi_square_tail(2.0 * gain.max(0.0), effort.numbers as f64);
    let p_value = least_of(chance, effort.trials);
    let delta_bic = before.bic(rows) - tried.bic(rows);
    Candidate { effect, tried, gain, parameters, delta_bic, p_value }
}

/// Logarithm of the odds of an effect without a kind in the format of explanations against one that has one: it is named
/// only where nothing with a name comes near.
pub(super) fn own_odds(effect: &dyn Effect) -> f64 {
    if effect.in_format() { 0.0 } else { -3.0 }
}

/// Excess of the charge of BIC for parameters, nats: a parameter costs half the logarithm of the modes that inform on it, and not
/// of all rows.
pub(super) fn bic_overcharge(parameters: usize, modes: f64, rows: usize) -> f64 {
    /// Modes below which a parameter is no cheaper.
    const MIN_CHARGED_MODES: f64 = 55.0;
    parameters as f64 * 0.5 * (rows as f64 / modes.max(MIN_CHARGED_MODES)).ln().max(0.0)
}

/// Effective number of modes, from the information of each: their number where all inform alike.
pub(super) fn effective_modes(informations: impl Iterator<Item = f64>) -> f64 {
    let (sum, squares) = informations
        .filter(|i| i.is_finite())
        .fold((0.0, 0.0), |(sum, squares), i| (sum + i, squares + i * i));
    if squares > 0.0 { sum * sum / squares } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::effect::{Drivers, find};
    use crate::mismatch::hypothesis::{LeastSquares, fit};
    use crate::mismatch::noise_fit::Noise;

    fn tried(log_likelihood: f64, parameters: usize, odds: f64) -> FittedHypothesis {
        let drivers = Drivers { dt_s: 1.0, samples: 64, averaged: 1, ..Drivers::default() };
        let spectral = SpectralData::new(drivers, &[0.0; 64], &[]);
        let base = [1.0, 0.0, 0.0];
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
        let mut hypothesis = Hypothesis { noise, courses: vec![] };
        let mut fit = fit(&mut hypothesis, &spectral);
        fit.log_likelihood = log_likelihood;
        assert!(matches!(&fit.mean, LeastSquares { coefficients, .. } if coefficients.is_empty()));
        FittedHypothesis { hypothesis, fit, parameters, odds: vec![("line", odds)] }
    }

    #[test]
    fn a_parameter_that_few_modes_tell_of_is_charged_for_those() {
        // A hundred equal modes of 10 000 rows: ½ ln 100 less for each of three.
        let of = |modes: f64| bic_overcharge(3, modes, 10_000);
        assert!((of(100.0) - 1.5 * 100f64.ln()).abs() < 1e-9, "{}", of(100.0));
        assert_eq!(of(10_000.0), 0.0);
        assert_eq!((of(1.0), of(0.0)), (of(55.0), of(55.0)));
        let modes = |count: usize| effective_modes((0..1000).map(|k| if k < count { 2.0 } else { 0.0 }));
        assert_eq!((modes(100), modes(0)), (100.0, 0.0));
        // One that tells ten times as much as ninety others: (10 + 90)²/(100 + 90).
        let uneven = effective_modes(std::iter::once(10.0).chain(std::iter::repeat_n(1.0, 90)));
        assert!((uneven - 10_000.0 / 190.0).abs() < 1e-9, "{uneven}");
    }

    #[test]
    fn an_addition_pays_the_logarithm_of_the_rows_for_each_parameter() {
        let (before, after) = (tried(-100.0, 1, 0.0), tried(-80.0, 3, -3.0));
        let one = score_candidate(
            find("line").unwrap(),
            after,
            &before,
            SearchEffort { numbers: 2, trials: 50.0 },
            1000,
        );
        assert_eq!((one.gain, one.parameters), (20.0, 2));
        // 2 · 20 − 2 ln 1000.
        assert!((one.delta_bic - (40.0 - 2.0 * 1000f64.ln())).abs() < 1e-9);
        // χ² of 40 with two degrees of freedom is e⁻²⁰, for each of 50 looks: 1 − (1 − e⁻²⁰)⁵⁰.
        let of_fifty = -(50.0 * (-(-20f64).exp()).ln_1p()).exp_m1();
        assert!((one.p_value / of_fifty - 1.0).abs() < 1e-9, "{}", one.p_value);
        // Odds of e⁻³ cost 6 of the rank.
        assert!((one.tried.rank(1000) - one.tried.bic(1000) - 6.0).abs() < 1e-9);
        assert_eq!((own_odds(find("line").unwrap()), own_odds(find("drifting_line").unwrap())), (0.0, -3.0));
    }
}
