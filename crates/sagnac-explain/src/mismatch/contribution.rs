//! Contributions of chosen effects to the rate: sample by sample, at knots, and in root mean square.

use super::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use super::noise_fit::{Noise, base_index};
use super::problem::Problem;
use super::select::Slot;
use super::spectral_data::SpectralData;
use super::terms::summed;
use crate::effect::{Domain, Knot, Model, Place, SpectrumAct};
use crate::numeric::cosine::inverse_dct2;
use crate::numeric::sums::cumulated;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Contribution to the rate of everything that a hypothesis adds to the claim, deg/h on the grid: courses, and the best
/// linear estimate of processes that are slow or narrow-band. `None` where nothing can be predicted sample by sample.
pub fn correction(best: &FittedHypothesis, spectra: &SpectralDataSet) -> Option<Vec<f64>> {
    let courses = (0..best.hypothesis.courses.len()).map(Slot::Mean);
    let processes = (0..best.hypothesis.noise.spectra.len()).map(Slot::Spectrum);
    let mut sum: Option<Vec<f64>> = None;
    for course in courses.chain(processes).filter_map(|slot| of(slot, best, spectra)) {
        match &mut sum {
            Some(sum) => sum.iter_mut().zip(course).for_each(|(s, c)| *s += c),
            None => sum = Some(course),
        }
    }
    sum
}

/// Contribution of one effect to each sample, deg/h.
fn of(slot: Slot, best: &FittedHypothesis, spectra: &SpectralDataSet) -> Option<Vec<f64>> {
    match slot {
        Slot::Mean(i) => {
            let inside = &best.hypothesis.courses[i];
            let parts = inside.course()?.regressors(&inside.nonlinear_parameters, &spectra.full.drivers);
            let samples = spectra.full.drivers.samples;
            let law = summed(&parts.columns, &inside.coefficients, parts.offset.as_ref(), samples);
            // A state before the record is a part of what the law does in it.
            Some(summed(&parts.nuisance, &inside.states, Some(&law), samples))
        }
        Slot::Spectrum(i) => course_of_process(i, best, spectra),
    }
}

/// The best linear estimate of what a process that was found adds to each sample, deg/h; `None` for one that is stated, and
/// for one that is neither slow nor narrow-band.
fn course_of_process(index: usize, best: &FittedHypothesis, spectra: &SpectralDataSet) -> Option<Vec<f64>> {
    let spectral = &spectra.full;
    let part = &best.hypothesis.noise.spectra[index];
    let Model::Spectrum(spectrum) = part.effect.model() else { return None };
    if part.stated || !spectrum.has_course() {
        return None;
    }
    let own = spectral.powers(&best.hypothesis.noise.added_densities(index, spectral));
    let modes: Vec<f64> = best
        .residual(spectra)
        .iter()
        .zip(own.iter().zip(&best.powers(spectra)))
        .map(|(x, (s, p))| if s.is_finite() && p.is_finite() { x * s / p } else { 0.0 })
        .collect();
    Some(inverse_dct2(&modes))
}

/// Time in which an effect is away from its median: between the instants before and after which lie half a hundredth of its square.
pub fn time_of(slot: Slot, best: &FittedHypothesis, spectra: &SpectralDataSet) -> Option<Place> {
    const TAIL_SHARE: f64 = 0.005;
    let course = of(slot, best, spectra)?;
    let mut sorted = course.clone();
    let middle = sorted.len() / 2;
    let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
    let sums = cumulated(course.iter().map(|c| (c - median).powi(2)));
    let all = *sums.last()?;
    let at = |share: f64| sums.partition_point(|s| *s < share * all).saturating_sub(1);
    let drivers = &spectra.full.drivers;
    let last = course.len().saturating_sub(1);
    let [from, to] = [at(TAIL_SHARE), at(1.0 - TAIL_SHARE)].map(|i| drivers.time_s(i.min(last)));
    (all > 0.0).then_some(Place { domain: Domain::Time, from, to })
}

/// Knots at most.
const MAX_KNOTS: usize = 512;
/// Seed of the draw.
const DRAW_SEED: u64 = 0x5a67_6e61_6320_0006;

/// The course of a smooth process of a hypothesis at knots, for a claim to state. A draw of what it may have been given the record, not the
/// expectation: what the expectation leaves of the record is quieter than the noise, and the claim would not fit.
pub fn drawn_course(best: &FittedHypothesis, index: usize, problem: &Problem) -> Vec<Knot> {
    let spectral = &problem.spectra.full;
    let own = spectral.powers(&best.hypothesis.noise.part_densities(index, spectral));
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(DRAW_SEED);
    let (residual, powers) = (best.residual(&problem.spectra), best.powers(&problem.spectra));
    let modes = residual.iter().zip(own.iter().zip(&powers)).map(|(x, (s, p))| {
        let z: f64 = StandardNormal.sample(&mut rng);
        if s.is_finite() && p.is_finite() { x * s / p + z * (s * (1.0 - s / p).max(0.0)).sqrt() } else { 0.0 }
    });
    let course = inverse_dct2(&modes.collect::<Vec<f64>>());
    let group = course.len().div_ceil(MAX_KNOTS).max(1);
    let drivers = &problem.drivers;
    let middle = |g: usize, len: usize| drivers.time_s(g * group) + 0.5 * (len - 1) as f64 * drivers.dt_s;
    let chunks = || course.chunks(group).enumerate();
    let mean = |c: &[f64]| c.iter().sum::<f64>() / c.len() as f64;
    chunks().map(|(g, c)| Knot { at: middle(g, c.len()), value: mean(c) }).collect()
}

/// Course that a spectral effect added to a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AddedRms {
    /// Its root mean square, deg/h; 0 for an effect that takes away, or filters.
    pub rms_deg_h: f64,
    /// Standard deviation of that, which the recording leaves open, deg/h.
    pub deviation_deg_h: f64,
}

/// The best estimate of what a spectral effect with some fitted parameters added to the record of a residual (cosine modes,
/// deg/h).
///
/// A mode x of variance P holds a part of variance S: x S/P on average, with a variance of S (1 − S/P) about it.
pub fn added_rms(
    noise: &Noise,
    index: usize,
    fitted: &[f64],
    spectral: &SpectralData,
    residual: &[f64],
) -> AddedRms {
    let mut noise = noise.clone();
    let mut base = None;
    if let Some(part) = noise.spectra.get_mut(index) {
        part.fitted = fitted.to_vec();
        if let Model::Spectrum(s) = part.effect.model()
            && let SpectrumAct::Unconstrains(term) = s.act()
        {
            base = base_index(term);
        }
    }
    if let (Some(i), Some(value)) = (base, fitted.first()) {
        noise.base[i] = *value;
    }
    let (own, whole) = (noise.added_densities(index, spectral), noise.densities(spectral));
    let n = spectral.drivers.samples.max(1) as f64;
    let (mut square, mut variance) = (0.0, 0.0);
    for ((bin, s), p) in spectral.bins.iter().zip(&own).zip(&whole) {
        let share = (s / p).clamp(0.0, 1.0);
        let open = share * (1.0 - share) * p / bin.dt_s;
        for x in residual.get(bin.mode..bin.mode + bin.modes).unwrap_or_default() {
            let estimate = x * share;
            square += estimate * estimate + open;
            variance += 2.0 * open * open + 4.0 * estimate * estimate * open;
        }
    }
    let rms_deg_h = (square / n).sqrt();
    // d√(q/n) = dq/(2n rms).
    let deviation_deg_h = if rms_deg_h > 0.0 { variance.sqrt() / (2.0 * n * rms_deg_h) } else { 0.0 };
    AddedRms { rms_deg_h, deviation_deg_h }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Drivers, find};
    use crate::mismatch::terms::SpectralTerm;
    use crate::numeric::cosine::dct2;

    #[test]
    fn the_interval_of_an_added_walk_holds_what_was_added() {
        let (n, runs) = (2000, 40);
        // White noise of 1 deg/h and a walk of 0.03 deg/h a step, of which the claim knows nothing.
        let k = 0.03 * 60.0;
        let mut held = 0;
        for seed in 0..runs {
            let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
            let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
            let mut level = 0.0;
            let walk: Vec<f64> = (0..n)
                .map(|_| {
                    level += 0.03 * draw();
                    level
                })
                .collect();
            let series: Vec<f64> = walk.iter().map(|w| w + draw()).collect();
            let drivers = Drivers { dt_s: 1.0, samples: n, averaged: 1, ..Drivers::default() };
            let spectral = SpectralData::new(drivers, &series, &[]);
            let effect = find("excess_rrw").expect("in the catalogue");
            let noise = Noise {
                base: [1.0 / 60.0, 0.0, k],
                claimed: [1.0 / 60.0, 0.0, 0.0],
                bound: [0.0; 3],
                deviation: [0.0; 3],
                unconstrained: [false, false, true],
                quantization_arcsec: 0.0,
                spectra: vec![SpectralTerm { effect, fitted: vec![k], stated: false }],
                discrepancy: None,
            };
            let added = added_rms(&noise, 0, &[k], &spectral, &dct2(&series));
            let mean = walk.iter().sum::<f64>() / n as f64;
            let truth = (walk.iter().map(|w| (w - mean).powi(2)).sum::<f64>() / n as f64).sqrt();
            held += i32::from((truth - added.rms_deg_h).abs() < 1.96 * added.deviation_deg_h);
        }
        // 38 of 40 on average, give or take 1.4.
        assert!((33..=40).contains(&held), "{held} of {runs}");
    }
}
