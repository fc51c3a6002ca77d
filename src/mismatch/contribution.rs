//! What chosen effects add to the rate, sample by sample.

use super::candidates::{Scenes, Tried};
use crate::effect::{Domain, Model, Place};
use crate::numeric::cosine::inverse_dct2;
use crate::numeric::sums::cumulated;

/// What everything that a hypothesis adds to the claim contributes to the rate, deg/h on the grid: courses, and the best
/// linear estimate of processes that are slow or narrow-band. `None` where nothing can be predicted sample by sample.
pub fn correction(best: &Tried, scenes: &Scenes) -> Option<Vec<f64>> {
    let scene = &scenes.full;
    let mut out = vec![0.0; scene.drivers.samples];
    let mut any = false;
    for inside in &best.hypothesis.courses {
        let Some(course) = inside.course() else { continue };
        let parts = course.parts(&inside.shape, &scene.drivers);
        any = true;
        if let Some(fixed) = &parts.fixed {
            out.iter_mut().zip(fixed).for_each(|(o, f)| *o += f);
        }
        for (column, c) in parts.free.iter().zip(&inside.coefficients) {
            out.iter_mut().zip(column).for_each(|(o, z)| *o += c * z);
        }
    }
    for i in 0..best.hypothesis.noise.spectra.len() {
        let Some(course) = course_of_process(i, best, scenes) else { continue };
        any = true;
        out.iter_mut().zip(course).for_each(|(o, c)| *o += c);
    }
    any.then_some(out)
}

/// The best linear estimate of what a process that was found adds to each sample, deg/h; `None` for one that is stated, and
/// for one that is neither slow nor narrow-band.
fn course_of_process(index: usize, best: &Tried, scenes: &Scenes) -> Option<Vec<f64>> {
    let scene = &scenes.full;
    let part = &best.hypothesis.noise.spectra[index];
    let Model::Spectrum(spectrum) = part.effect.model() else { return None };
    if part.stated || !spectrum.has_course() {
        return None;
    }
    let own = scene.powers(&best.hypothesis.noise.added_densities(index, scene));
    let modes: Vec<f64> = best
        .residual(scenes)
        .iter()
        .zip(own.iter().zip(&best.powers(scenes)))
        .map(|(x, (s, p))| if s.is_finite() && p.is_finite() { x * s / p } else { 0.0 })
        .collect();
    Some(inverse_dct2(&modes))
}

/// When a process that was found is away from its median: between the instants before and after which lie half a
/// hundredth of its square.
pub fn time_of_process(index: usize, best: &Tried, scenes: &Scenes) -> Option<Place> {
    const OUTSIDE: f64 = 0.005;
    let course = course_of_process(index, best, scenes)?;
    let mut sorted = course.clone();
    let middle = sorted.len() / 2;
    let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
    let sums = cumulated(course.iter().map(|c| (c - median).powi(2)));
    let all = *sums.last()?;
    let at = |share: f64| sums.partition_point(|s| *s < share * all).saturating_sub(1);
    let drivers = &scenes.full.drivers;
    let last = course.len().saturating_sub(1);
    let [from, to] = [at(OUTSIDE), at(1.0 - OUTSIDE)].map(|i| drivers.time_s(i.min(last)));
    (all > 0.0).then_some(Place { domain: Domain::Time, from, to })
}
