//! The noise of a hypothesis and its fit: penalised Whittle likelihood over the bins of a record.
//!
//! −ln L = ½ Σ n_b (ln S_b + I_b/S_b) + ½ Σ (ln c − ln c₀)²/σ²: stated coefficients move within their stated
//! uncertainty and no further. Fisher scoring on logarithms of the parameters, with backtracking
//! (Whittle, Ark. Mat. 2, 1953).
//!
//! # Why this is no fit of `noise::identification`
//! Both maximise the same sum over bins, and share no step of it. The identification asks which of a few known terms a
//! record has: it has no priors, its unknowns are variances that enter the expected powers linearly and may be exactly 0,
//! and its data are band powers of a Welch spectrum and of block means with a ramp taken out. This fit holds a *stated*
//! model against a record: coefficients carry the prior of a claim, densities are those of any effect of the catalogue,
//! filters multiply the rest, parameters are positive and enter by their logarithms, and the data are cosine modes of a
//! residual from which a mean was fitted, with no more than their own bins in common. A common optimiser would need both
//! bounded steps of variances and damped steps of logarithms, and be neither.

use super::law_error::Discrepancy;
use super::spectral_data::SpectralData;
use super::terms::SpectralTerm;
use crate::claim::Claim;
use crate::effect::{ModeBin, Model, SpectralContext, SpectrumAct};
use crate::noise::data::NoiseType;
use crate::numeric::range::Bounds;
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Index of a base coefficient in arrays.
pub fn base_index(term: NoiseType) -> Option<usize> {
    super::spectral_data::BASE_TERMS.iter().position(|t| *t == term)
}

/// The noise of a hypothesis.
#[derive(Clone)]
pub struct Noise {
    /// N deg/√h, B deg/h, K deg/h/√h.
    pub base: [f64; 3],
    /// As claimed.
    pub claimed: [f64; 3],
    /// Stated relative deviations; 0 is exact.
    pub deviation: [f64; 3],
    /// Deviation of a coefficient that is claimed as 0, in its own unit: it is positive, and as likely as a normal number of
    /// this deviation; 0 is exact.
    pub bound: [f64; 3],
    /// Set free by an effect.
    pub unconstrained: [bool; 3],
    /// Density of the claimed quantisation for Q = 1 times Q², by bin: Q, arcsec.
    pub quantization_arcsec: f64,
    /// Spectral effects, stated and found.
    pub spectra: Vec<SpectralTerm>,
    /// Error of the largest law of the mean, where the record shows one.
    pub discrepancy: Option<Arc<Discrepancy>>,
}

/// Which parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Which {
    /// N, B, K by index.
    Base(usize),
    /// Parameter of a spectral effect.
    Effect(usize, usize),
}

/// A fit of the noise.
#[derive(Debug, Clone)]
pub struct NoiseFit {
    /// Penalised log-likelihood without constants that are the same for all hypotheses.
    pub log_likelihood: f64,
    /// The fitted parameters.
    pub which: Vec<Which>,
    /// Covariance of the logarithms of those.
    pub covariance: DMatrix<f64>,
}

impl Noise {
    /// The noise as claimed.
    pub fn of(claim: &Claim) -> Noise {
        let terms = &claim.noise;
        let base = [terms.n, terms.b, terms.k];
        let u = &claim.uncertainty;
        let spectra = claim.effects.iter().filter_map(|stated| match stated.effect.model() {
            Model::Spectrum(s) => Some(SpectralTerm {
                effect: stated.effect,
                fitted: s.claimed_parameters(&stated.values)?,
                stated: true,
            }),
            _ => None,
        });
        let mut out = Noise {
            base,
            claimed: base,
            deviation: [u.n_rel, u.b_rel, u.k_rel],
            bound: u.of_zero(),
            unconstrained: [false; 3],
            quantization_arcsec: claim.quantization_lsb_arcsec / 12f64.sqrt(),
            spectra: vec![],
            discrepancy: None,
        };
        for stated in spectra {
            let act = stated.spectrum().map(|s| s.act());
            match (act, stated.fitted.first()) {
                (Some(SpectrumAct::Unconstrains(term)), Some(value)) => {
                    if let Some(i) = base_index(term) {
                        out.base[i] = *value;
                        out.claimed[i] = *value;
                    }
                }
                _ => out.spectra.push(stated),
            }
        }
        (0..3).for_each(|i| out.base[i] = out.begin(i));
        out
    }

    /// Value from which the fit of a claimed coefficient begins: its claim, or one within its bound.
    pub fn begin(&self, i: usize) -> f64 {
        const BOUND_START_SHARE: f64 = 0.1;
        if self.is_bound(i) { BOUND_START_SHARE * self.bound[i] } else { self.claimed[i] }
    }

    /// Puts each coefficient that no effect unconstrains back to where its fit begins.
    pub fn restate(&mut self) {
        for i in 0..3 {
            if !self.unconstrained[i] {
                self.base[i] = self.begin(i);
            }
        }
    }

    /// True for a coefficient that is claimed as 0 with a bound.
    fn is_bound(&self, i: usize) -> bool {
        self.claimed[i] <= 0.0 && self.bound[i] > 0.0
    }

    /// The effects that multiply the density of everything else.
    pub fn filters(&self) -> impl Iterator<Item = &SpectralTerm> {
        self.spectra.iter().filter(|s| s.spectrum().is_some_and(|x| x.act() == SpectrumAct::Filters))
    }

    /// Density of each bin, (deg/h)²/Hz.
    pub fn densities(&self, spectral: &SpectralData) -> Vec<f64> {
        let q2 = self.quantization_arcsec.powi(2);
        let one = |(bin, units): (&ModeBin, &[f64; 3])| {
            let sum: f64 = self.base.iter().zip(units).map(|(c, u)| c * c * u).sum();
            let unit = |b: &ModeBin| {
                crate::noise::model::unit_density(NoiseType::Quantization, b.frequency_hz, b.dt_s)
            };
            if q2 > 0.0 { sum + q2 * unit(bin) } else { sum }
        };
        let mut out: Vec<f64> = spectral.bins.iter().zip(&spectral.units).map(one).collect();
        let parts = || self.spectra.iter().filter_map(|part| Some((part, part.spectrum()?)));
        for (part, spectrum) in parts().filter(|(_, s)| s.act() == SpectrumAct::Adds) {
            let added = spectrum.densities(&part.fitted, &spectral.bins);
            out.iter_mut().zip(added).for_each(|(s, a)| *s += a);
        }
        for (part, spectrum) in parts().filter(|(_, s)| s.act() == SpectrumAct::Filters) {
            let factors = spectrum.densities(&part.fitted, &spectral.bins);
            out.iter_mut().zip(factors).for_each(|(s, f)| *s *= f);
        }
        if let Some(discrepancy) = &self.discrepancy {
            discrepancy.add_to(&mut out, spectral);
        }
        out.iter_mut().for_each(|s| *s = s.max(f64::MIN_POSITIVE * 1e60));
        out
    }

    /// Density of one found effect alone, filters of others included, (deg/h)²/Hz.
    pub fn part_densities(&self, index: usize, spectral: &SpectralData) -> Vec<f64> {
        let Some(part) = self.spectra.get(index) else { return vec![0.0; spectral.bins.len()] };
        let Some(spectrum) = part.spectrum() else { return vec![0.0; spectral.bins.len()] };
        match spectrum.act() {
            SpectrumAct::Adds => spectrum.densities(&part.fitted, &spectral.bins),
            SpectrumAct::Unconstrains(term) => {
                let i = base_index(term).unwrap_or(0);
                spectral.units.iter().map(|u| self.base[i].powi(2) * u[i]).collect()
            }
            SpectrumAct::Filters => vec![0.0; spectral.bins.len()],
        }
    }

    /// Density that a part adds to the claim, (deg/h)²/Hz by bin: of an unconstrained coefficient, the excess over the claimed
    /// one by.
    pub fn added_densities(&self, index: usize, spectral: &SpectralData) -> Vec<f64> {
        let mut out = self.part_densities(index, spectral);
        let act = self.spectra.get(index).and_then(|p| p.spectrum()).map(|s| s.act());
        if let Some(SpectrumAct::Unconstrains(term)) = act
            && let Some(i) = base_index(term)
        {
            let stated = self.claimed[i].powi(2);
            out.iter_mut().zip(&spectral.units).for_each(|(d, u)| *d = (*d - stated * u[i]).max(0.0));
        }
        out
    }

    /// The parameters that a fit moves.
    pub fn which(&self) -> Vec<Which> {
        let base = (0..3)
            .filter(|i| {
                let known = if self.is_bound(*i) { self.bound[*i] } else { self.deviation[*i] };
                self.unconstrained[*i] || (self.base[*i] > 0.0 && known > 0.0)
            })
            .map(Which::Base);
        let effects = self.spectra.iter().enumerate().filter(|(_, s)| !s.stated).flat_map(|(e, s)| {
            let spectrum = s.spectrum().filter(|x| !matches!(x.act(), SpectrumAct::Unconstrains(_)));
            let moves = move |p: &usize| spectrum.is_some_and(|x| x.is_refined(&s.fitted, *p));
            (0..s.fitted.len()).filter(moves).map(move |p| Which::Effect(e, p))
        });
        base.chain(effects).collect()
    }

    /// Value of a parameter.
    pub fn value(&self, which: Which) -> f64 {
        match which {
            Which::Base(i) => self.base[i],
            Which::Effect(e, p) => self.spectra[e].fitted[p],
        }
    }

    /// Changes a parameter.
    pub fn set(&mut self, which: Which, value: f64) {
        match which {
            Which::Base(i) => {
                self.base[i] = value;
                for part in &mut self.spectra {
                    if let Some(SpectrumAct::Unconstrains(term)) = part.spectrum().map(|s| s.act())
                        && base_index(term) == Some(i)
                    {
                        part.fitted = vec![value];
                    }
                }
            }
            Which::Effect(e, p) => self.spectra[e].fitted[p] = value,
        }
    }

    /// −½ Σ (ln c − ln c₀)²/σ² of the stated coefficients.
    pub fn prior(&self) -> f64 {
        let one = |i: usize| {
            if self.is_bound(i) && !self.unconstrained[i] {
                return -0.5 * (self.base[i] / self.bound[i]).powi(2);
            }
            if self.unconstrained[i] || self.deviation[i] <= 0.0 || self.claimed[i] <= 0.0 {
                return 0.0;
            }
            -0.5 * ((self.base[i] / self.claimed[i]).ln() / self.deviation[i]).powi(2)
        };
        (0..3).map(one).sum()
    }

    /// Bounds of the logarithm of a parameter.
    fn log_bounds(&self, which: Which, context: &SpectralContext<'_>) -> Bounds {
        match which {
            Which::Base(i) => {
                let c = match self.claimed[i] {
                    claimed if claimed > 0.0 => claimed,
                    _ if self.is_bound(i) && !self.unconstrained[i] => self.bound[i],
                    _ => self.base[i].max(1e-30),
                };
                Bounds::new((c * 1e-4).ln(), (c * 1e4).ln())
            }
            Which::Effect(e, p) => {
                let bounds = self.spectra[e].spectrum().map(|s| s.bounds(context)).unwrap_or_default();
                let Bounds { low, high } = bounds.get(p).copied().unwrap_or(Bounds::new(1e-30, 1e30));
                Bounds::new(low.max(1e-300).ln(), high.max(1e-300).ln())
            }
        }
    }
}

/// Log-likelihood of mean squares `observed` under densities, constants left out.
pub fn whittle(spectral: &SpectralData, observed: &[f64], densities: &[f64]) -> f64 {
    let terms = spectral.bins.iter().zip(observed).zip(densities);
    -0.5 * terms.map(|((bin, i), s)| spectral.weight(bin) * (s.ln() + i / s)).sum::<f64>()
}

/// Steps of a whole fit.
const MAX_STEPS: usize = 40;

/// Fits the noise to mean squares of modes, by bin.
pub fn fit(noise: &mut Noise, spectral: &SpectralData, observed: &[f64]) -> NoiseFit {
    fit_in(noise, spectral, observed, MAX_STEPS)
}

/// As [`fit`], in so many steps at most: enough to find the better of several starting points.
pub fn fit_in(noise: &mut Noise, spectral: &SpectralData, observed: &[f64], steps: usize) -> NoiseFit {
    let which = noise.which();
    let expected = noise.densities(spectral);
    let context =
        SpectralContext { bins: &spectral.bins, observed, expected: &expected, grid_step_arcsec: None };
    let bounds: Vec<Bounds> = which.iter().map(|w| noise.log_bounds(*w, &context)).collect();
    let value = |noise: &Noise, densities: &[f64]| whittle(spectral, observed, densities) + noise.prior();
    let mut densities = expected.clone();
    let mut best = value(noise, &densities);
    let p = which.len();
    let mut information = DMatrix::zeros(p, p);
    let mut damping = 1e-3;
    for _ in 0..steps {
        let (gradient, fisher) = derivatives(noise, &which, spectral, observed, &densities);
        information = fisher;
        if p == 0 {
            break;
        }
        let mut moved = false;
        for _ in 0..12 {
            let mut damped = information.clone();
            for i in 0..p {
                damped[(i, i)] += damping * information[(i, i)].max(1e-12) + 1e-12;
            }
            let Some(step) = damped.cholesky().map(|c| c.solve(&gradient)) else {
                damping = (damping * 10.0).max(1e-6);
                continue;
            };
            let mut next = noise.clone();
            for (i, w) in which.iter().enumerate() {
                let x = bounds[i].clamp(noise.value(*w).max(1e-300).ln() + step[i].clamp(-2.0, 2.0));
                next.set(*w, x.exp());
            }
            let tried = next.densities(spectral);
            let got = value(&next, &tried);
            if got > best {
                moved = got - best > 1e-5;
                *noise = next;
                densities = tried;
                best = got;
                damping = (damping * 0.2).max(1e-9);
                break;
            }
            damping = (damping * 6.0).max(1e-6);
        }
        if !moved {
            break;
        }
    }
    let mut inverse = information;
    for i in 0..p {
        inverse[(i, i)] += 1e-9;
    }
    let covariance = inverse.try_inverse().unwrap_or_else(|| DMatrix::zeros(p, p));
    NoiseFit { log_likelihood: best, which, covariance }
}

/// Gradient of the penalised log-likelihood and the expected information, in logarithms of the parameters.
fn derivatives(
    noise: &Noise,
    which: &[Which],
    spectral: &SpectralData,
    observed: &[f64],
    densities: &[f64],
) -> (DVector<f64>, DMatrix<f64>) {
    let p = which.len();
    let (mut gradient, mut fisher) = (DVector::zeros(p), DMatrix::zeros(p, p));
    let slopes = log_slopes(noise, which, spectral, densities);
    for (b, bin) in spectral.bins.iter().enumerate() {
        let n = spectral.weight(bin);
        let excess = observed[b] / densities[b] - 1.0;
        for i in 0..p {
            gradient[i] += 0.5 * n * excess * slopes[i][b];
            for j in 0..=i {
                fisher[(i, j)] += 0.5 * n * slopes[i][b] * slopes[j][b];
            }
        }
    }
    for (i, w) in which.iter().enumerate() {
        if let Which::Base(c) = *w
            && !noise.unconstrained[c]
            && noise.is_bound(c)
        {
            let square = (noise.base[c] / noise.bound[c]).powi(2);
            gradient[i] -= square;
            fisher[(i, i)] += 2.0 * square;
        } else if let Which::Base(c) = *w
            && !noise.unconstrained[c]
            && noise.deviation[c] > 0.0
        {
            let weight = noise.deviation[c].powi(-2);
            gradient[i] -= (noise.base[c] / noise.claimed[c]).ln() * weight;
            fisher[(i, i)] += weight;
        }
    }
    for i in 0..p {
        for j in 0..i {
            fisher[(j, i)] = fisher[(i, j)];
        }
    }
    (gradient, fisher)
}

/// d ln S/d ln parameter in each bin, for each of `which`.
///
/// By differences to one side with a step that a rounded density bears and a narrow resonance does: what is compared with
/// is at hand.
fn log_slopes(noise: &Noise, which: &[Which], spectral: &SpectralData, densities: &[f64]) -> Vec<Vec<f64>> {
    const DERIVATIVE_STEP: f64 = 1e-5;
    let filtered = noise.filters().next().is_some();
    // Of one part at a time.
    let mut alone: Option<(usize, Vec<f64>)> = None;
    let mut one = |which: Which| {
        let whole = || {
            let mut up = noise.clone();
            up.set(which, noise.value(which) * DERIVATIVE_STEP.exp());
            up.densities(spectral)
                .iter()
                .zip(densities)
                .map(|(a, b)| (a / b).ln() / DERIVATIVE_STEP)
                .collect()
        };
        if filtered {
            return whole();
        }
        match which {
            Which::Base(i) => {
                let c2 = 2.0 * noise.base[i].powi(2);
                spectral.units.iter().zip(densities).map(|(u, s)| c2 * u[i] / s).collect()
            }
            // The part alone: differences of the whole would lose it in rounding where it is small.
            Which::Effect(e, p) => {
                let part = &noise.spectra[e];
                let Some(spectrum) = part.spectrum() else { return whole() };
                if alone.as_ref().is_none_or(|(known, _)| *known != e) {
                    alone = Some((e, spectrum.densities(&part.fitted, &spectral.bins)));
                }
                let at = alone.iter().flat_map(|(_, at)| at).zip(densities);
                if let Some(power) = spectrum.scales_with(p) {
                    return at.map(|(a, s)| power * a / s).collect();
                }
                let mut up = part.fitted.clone();
                up[p] *= DERIVATIVE_STEP.exp();
                let up = spectrum.densities(&up, &spectral.bins);
                up.into_iter().zip(at).map(|(up, (a, s))| (up - a) / (DERIVATIVE_STEP * s)).collect()
            }
        }
    };
    which.iter().map(|w| one(*w)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(n: f64, deviation: f64) -> Noise {
        let base = [n, 0.0, 0.0];
        Noise {
            base,
            claimed: base,
            deviation: [deviation, 0.0, 0.0],
            bound: [0.0; 3],
            unconstrained: [false; 3],
            quantization_arcsec: 0.0,
            spectra: vec![],
            discrepancy: None,
        }
    }

    fn empty(samples: usize) -> SpectralData {
        let drivers = crate::effect::Drivers { dt_s: 1.0, samples, averaged: 1, ..Default::default() };
        SpectralData::new(drivers, &vec![0.0; samples], &[])
    }

    #[test]
    fn white_noise_has_3600_times_n_squared() {
        let spectral = empty(500);
        // N = 1/60 deg/√h is 1 (deg/h)²/Hz.
        let densities = noise(1.0 / 60.0, 0.0).densities(&spectral);
        assert!(densities.iter().all(|s| (s - 1.0).abs() < 1e-12));
        // ½ Σ n (ln S + I/S) of 499 modes with I = 2 and S = 1.
        let observed = vec![2.0; spectral.bins.len()];
        assert!((whittle(&spectral, &observed, &densities) + 499.0).abs() < 1e-9);
    }

    #[test]
    fn the_prior_weighs_a_claim_against_the_record() {
        let spectral = empty(500);
        let observed = vec![4.0; spectral.bins.len()];
        // Set free, N doubles.
        let mut free = noise(1.0 / 60.0, 0.0);
        free.unconstrained[0] = true;
        fit(&mut free, &spectral, &observed);
        assert!((free.base[0] * 60.0 / 2.0 - 1.0).abs() < 1e-4, "{}", free.base[0]);
        // Claimed to within 1 %: the slopes of −½ · 499 (2x + 4 e^(−2x)) and of −½ (x/0.01)² meet at x = ln(N/N₀).
        let mut held = noise(1.0 / 60.0, 0.01);
        fit(&mut held, &spectral, &observed);
        let x = (held.base[0] * 60.0).ln();
        assert!((499.0 * (4.0 * (-2.0 * x).exp() - 1.0) - x / 1e-4).abs() < 1.0, "{x}");
        assert!((held.prior() + 0.5 * (x / 0.01).powi(2)).abs() < 1e-9);
        // A coefficient claimed as 0 with a bound is as likely as a normal number of it.
        let bound =
            Noise { base: [0.3, 0.0, 0.0], claimed: [0.0; 3], bound: [0.1, 0.0, 0.0], ..noise(0.0, 0.0) };
        assert!((bound.prior() + 4.5).abs() < 1e-12 && (bound.begin(0) - 0.01).abs() < 1e-12);
    }
}
