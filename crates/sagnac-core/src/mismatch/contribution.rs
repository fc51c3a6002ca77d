//! What chosen effects add to the rate, sample by sample.

use super::select::Slot;
use super::tried::{SpectralDataSet, Tried};
use crate::effect::{Domain, Model, Place};
use crate::numeric::cosine::inverse_dct2;
use crate::numeric::sums::cumulated;

/// What everything that a hypothesis adds to the claim contributes to the rate, deg/h on the grid: courses, and the best
/// linear estimate of processes that are slow or narrow-band. `None` where nothing can be predicted sample by sample.
pub fn correction(best: &Tried, spectra: &SpectralDataSet) -> Option<Vec<f64>> {
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

/// Fixed part and columns times their coefficients, of so many samples.
pub(super) fn summed(
    columns: &[Vec<f64>],
    coefficients: &[f64],
    fixed: Option<&Vec<f64>>,
    samples: usize,
) -> Vec<f64> {
    let mut sum = fixed.cloned().unwrap_or_else(|| vec![0.0; samples]);
    for (column, c) in columns.iter().zip(coefficients) {
        sum.iter_mut().zip(column).for_each(|(s, z)| *s += c * z);
    }
    sum
}

/// What one effect adds to each sample, deg/h.
fn of(slot: Slot, best: &Tried, spectra: &SpectralDataSet) -> Option<Vec<f64>> {
    match slot {
        Slot::Mean(i) => {
            let inside = &best.hypothesis.courses[i];
            let parts = inside.course()?.regressors(&inside.nonlinear_parameters, &spectra.full.drivers);
            let samples = spectra.full.drivers.samples;
            Some(summed(&parts.columns, &inside.coefficients, parts.offset.as_ref(), samples))
        }
        Slot::Spectrum(i) => course_of_process(i, best, spectra),
    }
}

/// The best linear estimate of what a process that was found adds to each sample, deg/h; `None` for one that is stated, and
/// for one that is neither slow nor narrow-band.
fn course_of_process(index: usize, best: &Tried, spectra: &SpectralDataSet) -> Option<Vec<f64>> {
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

/// When an effect is away from its median: between the instants before and after which lie half a hundredth of its square.
pub fn time_of(slot: Slot, best: &Tried, spectra: &SpectralDataSet) -> Option<Place> {
    const OUTSIDE: f64 = 0.005;
    let course = of(slot, best, spectra)?;
    let mut sorted = course.clone();
    let middle = sorted.len() / 2;
    let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
    let sums = cumulated(course.iter().map(|c| (c - median).powi(2)));
    let all = *sums.last()?;
    let at = |share: f64| sums.partition_point(|s| *s < share * all).saturating_sub(1);
    let drivers = &spectra.full.drivers;
    let last = course.len().saturating_sub(1);
    let [from, to] = [at(OUTSIDE), at(1.0 - OUTSIDE)].map(|i| drivers.time_s(i.min(last)));
    (all > 0.0).then_some(Place { domain: Domain::Time, from, to })
}
