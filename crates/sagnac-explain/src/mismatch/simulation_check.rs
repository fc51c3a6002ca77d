//! A check of a simulation for the effects that a recording shows beyond the claim that was taken from it.
//!
//! A claim taken from a simulation holds what the simulation resolves. What it does not resolve is no statement of the
//! simulation: an effect found in the recording is a difference of the two only where the simulation speaks against it.
//! With θ the effect as found, L the likelihood of the simulation and θ' what suits it best, 2 (L(θ') − L(θ)) over
//! 1 + n_S/n_X, the uncertainty of θ itself, is χ² where both are of one process.

use super::engine::{on_grid, uncoarsened};
use super::finding::{Explanation, Finding};
use super::fitted_hypothesis::FittedHypothesis;
use super::hypothesis::{Hypothesis, columns, fit};
use super::named::SampleFindings;
use super::noise_fit::{Noise, base_index};
use super::options::Options;
use super::problem::Problem;
use super::spectral_data::SpectralData;
use super::terms::SpectralTerm;
use crate::claim::{Claim, Stated};
use crate::effect::{Drivers, Model, Nuisance, Spectrum, SpectrumAct, Value, Values, parameter};
use crate::estimate::chi_square_tail;
use crate::numeric::least_squares::Normal;
use crate::series::Series;

/// Deviation of the logarithm of a coefficient that is all but free.
const FREE_LOG_DEVIATION: f64 = 3.0;
/// Standard deviations of a 95 % interval from end to end.
const WIDTH95: f64 = 3.92;
/// The name under which sinusoids state their phase.
const PHASE_NAME: &str = "phase_deg";
/// The name under which sinusoids state their frequency.
const FREQUENCY_NAME: &str = "frequency_hz";

/// A simulation that is asked.
pub(super) struct SimulationCheck<'a> {
    /// The simulation, its beginning at that of the recording.
    pub simulation: &'a Series,
    /// Decisions of the user.
    pub options: &'a Options,
    /// Rows of the simulation over those of the recording.
    pub share: f64,
}

/// A claim whose noise and coefficients are free.
fn free(claim: &Claim) -> Claim {
    let mut out = claim.clone();
    let u = &mut out.uncertainty;
    (u.n_rel, u.b_rel, u.k_rel) = (FREE_LOG_DEVIATION, FREE_LOG_DEVIATION, FREE_LOG_DEVIATION);
    [u.n_deg_rt_h, u.b_deg_h, u.k_deg_h_rt_h] = u.of_zero().map(|deviation| 100.0 * deviation);
    u.temperature_coefficient_deg_h_per_degc = f64::INFINITY;
    u.scale_factor_ppm = f64::INFINITY;
    out
}

fn fitted(noise: Noise, spectral: &SpectralData) -> FittedHypothesis {
    let mut hypothesis = Hypothesis { noise, courses: vec![] };
    let fit = fit(&mut hypothesis, spectral);
    FittedHypothesis { hypothesis, fit, parameters: 0, odds: vec![] }
}

/// The noise of a claim with every process of it free.
fn free_noise(claim: &Claim) -> Noise {
    let mut noise = Noise::of(claim);
    noise.spectra.iter_mut().for_each(|s| s.stated = false);
    noise
}

impl SimulationCheck<'_> {
    fn problem(&self, claim: &Claim) -> Option<Problem> {
        let regular = on_grid(self.simulation.clone(), claim, self.options).ok()?;
        Some(uncoarsened(&regular, claim, &mut SampleFindings::default(), self.options))
    }

    /// Probability of the simulation, or one less like it, where it holds an effect as the recording shows it; 0 where it
    /// cannot hold it. `own` is what the simulation shows itself beyond the claim.
    pub fn chance(
        &self,
        stated: &Stated,
        claim: &Claim,
        found: &Explanation,
        own: &mut dyn FnMut() -> Option<Explanation>,
    ) -> f64 {
        let by_model = match stated.effect.model() {
            Model::Spectrum(spectrum) => self.by_spectrum(spectrum, stated, claim),
            Model::Mean(_) => self.by_course(stated, claim),
            Model::Samples(_) => None,
        };
        let by_findings = stated.effect.detector().is_some() || stated.effect.claimed_by_course().is_some();
        let own = if by_findings { own() } else { None };
        let by_kind = own.map(|own| self.by_kind(stated.effect.kind(), found, &own));
        by_model.unwrap_or(0.0).max(by_kind.unwrap_or(0.0))
    }

    fn by_spectrum(&self, spectrum: &'static dyn Spectrum, stated: &Stated, claim: &Claim) -> Option<f64> {
        let mut with = free(claim);
        // A driver is stated as a course; in another record the same quantity takes another one of the same size and pace.
        let driver = stated.effect.claimed_by_course().and_then(|s| s.process(&stated.values));
        let parameters = match &driver {
            Some(driver) => driver.len(),
            None => spectrum.claimed_parameters(&stated.values)?.len(),
        };
        if driver.is_none() {
            with.effects.push(stated.clone());
        }
        let problem = self.problem(&with)?;
        let stated_step = stated.effect.rounding().and_then(|r| r.step_arcsec(&stated.values));
        if let (Some(quantization_grid), Some(lsb)) = (problem.quantization_grid, stated_step)
            && (quantization_grid.increment_arcsec / lsb - 1.0).abs() < 0.01
        {
            return Some(1.0);
        }
        let spectral = &problem.spectra.full;
        let likelihood = |noise: Noise| fitted(noise, spectral).fit.log_likelihood;
        let mut noise = free_noise(&problem.claim);
        noise.spectra.extend(driver.map(|fitted| SpectralTerm {
            effect: stated.effect,
            fitted,
            stated: false,
        }));
        let (held, best) = if let SpectrumAct::Unconstrains(term) = spectrum.act() {
            let mut held = noise.clone();
            held.deviation[base_index(term)?] = 0.0;
            (likelihood(held), likelihood(noise))
        } else {
            let at = noise.spectra.iter().rposition(|s| s.effect.kind() == stated.effect.kind())?;
            let (mut held, mut none) = (noise.clone(), noise.clone());
            held.spectra[at].stated = true;
            none.spectra.remove(at);
            (likelihood(held), likelihood(noise).max(likelihood(none)))
        };
        let ratio = 2.0 * (best - held).max(0.0) / (1.0 + self.share);
        Some(chi_square_tail(ratio, parameters.max(1) as f64))
    }

    /// Distance of the size of a course in the simulation from that in the recording. Of a sinusoid the phase is no
    /// property of the process, and its frequency is known to within the resolution.
    fn by_course(&self, stated: &Stated, claim: &Claim) -> Option<f64> {
        let mut loose = free(claim);
        if let Model::Mean(course) = stated.effect.model() {
            match course.replaces() {
                Some(Nuisance::TemperatureCoefficient) => {
                    loose.uncertainty.temperature_coefficient_deg_h_per_degc = 0.0;
                }
                Some(Nuisance::ScaleFactor) => loose.uncertainty.scale_factor_ppm = 0.0,
                _ => {}
            }
        }
        let problem = self.problem(&loose)?;
        let spectral = &problem.spectra.full;
        let tried = fitted(free_noise(&problem.claim), spectral);
        let powers = spectral.powers(&tried.fit.densities);
        let nuisances: Vec<_> = spectral.nuisances.iter().collect();
        let steps = if stated.values.contains_key(FREQUENCY_NAME) { 16 } else { 0 };
        let resolution = 1.0 / problem.drivers.length_s();
        let mut best: Option<(f64, f64)> = None;
        for step in -steps..=steps {
            let values = shifted(&stated.values, FREQUENCY_NAME, 0.25 * f64::from(step) * resolution);
            let mut parts = vec![course(stated, &values, &problem.drivers)?];
            if values.contains_key(PHASE_NAME) {
                parts.extend(course(stated, &shifted(&values, PHASE_NAME, 90.0), &problem.drivers));
            }
            let modes: Vec<Vec<f64>> = parts.iter().map(|p| spectral.transform(p)).collect();
            let mut all = columns(&nuisances, []);
            all.extend(modes.iter().map(|m| (m.as_slice(), f64::INFINITY)));
            let (solved, covariance, _) = Normal::new(&all, &spectral.modes, &powers).solve();
            let first = nuisances.len();
            let size = solved[first..].iter().map(|c| c * c).sum::<f64>().sqrt();
            let size = if modes.len() == 1 { solved[first] } else { size };
            let variance = covariance[(first, first)];
            if !(variance.is_finite() && variance < 1e30) {
                return None;
            }
            if best.is_none_or(|(most, _)| size > most) {
                best = Some((size, variance));
            }
        }
        let (size, variance) = best?;
        Some(chi_square_tail((1.0 - size).powi(2) / (variance * (1.0 + self.share)), 1.0))
    }

    /// Difference of the parameters of an effect that both records show.
    fn by_kind(&self, kind: &str, found: &Explanation, own: &Explanation) -> f64 {
        let of = |all: &Explanation| all.effects.iter().find(|f| f.effect_id() == kind).cloned();
        let (Some(here), Some(there)) = (of(found), of(own)) else { return 0.0 };
        unlike(&here, &there, self.share)
    }
}

/// The smallest probability of a difference between parameters of the same name. Instants are not compared.
fn unlike(here: &Finding, there: &Finding, share: f64) -> f64 {
    let mut least = 1.0f64;
    for (name, a) in &here.parameters {
        let param = parameter(name);
        let comparable = param.is_none_or(|p| !p.instant);
        let Some(b) = there.parameters.get(name).filter(|_| comparable) else { continue };
        let chance = if let Some(together) = param.and_then(|p| p.count) {
            let (x, y) = (a.value * share, b.value);
            let spread = (x * share.max(1.0) + y).max(1.0) * together;
            chi_square_tail((x - y).powi(2) / spread, 1.0)
        } else {
            let deviation = |ends: [f64; 2]| (ends[1] - ends[0]).abs() / WIDTH95;
            let variance = deviation(a.ci95).powi(2) + deviation(b.ci95).powi(2);
            let apart = a.value.abs() - b.value.abs();
            if apart == 0.0 { 1.0 } else { chi_square_tail(apart * apart / variance.max(1e-300), 1.0) }
        };
        least = least.min(chance);
    }
    least
}

fn course(stated: &Stated, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
    match stated.effect.model() {
        Model::Mean(c) => c.course(values, drivers),
        _ => stated.effect.claimed_course(values, drivers),
    }
}

fn shifted(values: &Values, name: &str, by: f64) -> Values {
    let mut out = values.clone();
    if let Some(Value::Number(x)) = out.get_mut(name) {
        *x += by;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_compared_by_their_intervals_and_counts_by_chance() {
        let finding = |parameters: &[(&str, f64, f64)]| Finding {
            kind: String::new(),
            effect: None,
            column: None,
            column2: None,
            law: None,
            formula: None,
            shape: None,
            equivalents: vec![],
            probabilities: std::collections::BTreeMap::new(),
            parameters: parameters
                .iter()
                .map(|(name, value, half)| {
                    let ci95 = [value - 1.96 * half, value + 1.96 * half];
                    let value =
                        super::super::finding::ParameterValue { value: *value, unit: String::new(), ci95 };
                    ((*name).to_owned(), value)
                })
                .collect(),
            places: vec![],
            delta_bic: 0.0,
            p_value: 1.0,
            heldout_gain: None,
            removed_share: None,
        };
        // 5 apart, deviations 3 and 4: one deviation, 31.7 %.
        let of = |a: &[(&str, f64, f64)], b: &[(&str, f64, f64)], share: f64| {
            unlike(&finding(a), &finding(b), share)
        };
        assert!((of(&[("size", 10.0, 3.0)], &[("size", 15.0, 4.0)], 1.0) - 0.317_31).abs() < 1e-4);
        // The sign is no part of a size, and instants are not compared.
        assert_eq!(
            of(
                &[("size", 10.0, 3.0), ("time_s", 5.0, 0.1)],
                &[("size", -10.0, 3.0), ("time_s", 900.0, 0.1)],
                1.0
            ),
            1.0
        );
        // Counts of 10 and 20: (10)² over their sum.
        let chance = chi_square_tail(100.0 / 30.0, 1.0);
        assert!((of(&[("count", 10.0, 0.0)], &[("count", 20.0, 0.0)], 1.0) - chance).abs() < 1e-12);
        // Rows are lost ten together.
        let chance = chi_square_tail(100.0 / 300.0, 1.0);
        assert!(
            (of(&[("missing_rows", 10.0, 0.0)], &[("missing_rows", 20.0, 0.0)], 1.0) - chance).abs() < 1e-12
        );
    }
}
