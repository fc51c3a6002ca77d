//! Parameters of the chosen effects with their 95 % intervals, and what each adds to the rate.

use super::candidates::{Scenes, Tried};
use super::contribution::summed;
use super::finding::ParameterValue;
use super::hypothesis::{CourseIn, Normal, PartModes, kept};
use super::instant;
use super::noise_fit::Which;
use super::process;
use super::scene::Scene;
use super::select::Slot;
use crate::effect::{Course, Effect, Model, Param, SpectrumAct, Value, Values};
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// Half width of a 95 % interval in standard deviations.
const TWO_SIDED_95: f64 = 1.959_964;
/// Drop of the log-likelihood at the ends of a 95 % profile interval.
const DROP_95: f64 = 1.920_729;

/// Factor either way within which a parameter must be told for it to be stated.
const OPEN: f64 = 100.0;

/// Relative deviation of a number that a fit does not move, as of a whole number of samples.
const EXACT: f64 = 1e-6;

/// Name of the parameter that is an instant.
pub const INSTANT: &str = "time_s";

/// An effect's parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Estimated {
    /// As reports give them.
    pub reported: BTreeMap<String, ParameterValue>,
    /// As the augmented claim states them.
    pub stated: Values,
}

/// The 95 % interval of a parameter; `None` for one that the recording does not tell to within [`OPEN`].
fn interval(param: &Param, value: f64, deviation: f64) -> Option<[f64; 2]> {
    if value > 0.0 && param.lower >= 0.0 {
        let factor = (TWO_SIDED_95 * deviation / value).exp();
        return (factor < OPEN).then_some([value / factor, value * factor]);
    }
    Some([value - TWO_SIDED_95 * deviation, value + TWO_SIDED_95 * deviation])
}

/// The parameters of one effect of a fitted hypothesis.
pub fn of(effect: &'static dyn Effect, slot: Slot, best: &Tried, scenes: &Scenes) -> Estimated {
    match (slot, effect.model()) {
        (Slot::Course(i), Model::Course(course)) => of_course(effect, course, i, best, scenes),
        (Slot::Spectrum(i), Model::Spectrum(_)) => of_spectrum(effect, i, best, scenes),
        _ => Estimated::default(),
    }
}

/// One course among the columns of its hypothesis.
struct Placed<'a> {
    scene: &'a Scene,
    course: &'static dyn Course,
    inside: &'a CourseIn,
    columns: Vec<(Vec<f64>, f64)>,
    data: Vec<f64>,
    powers: Vec<f64>,
}

impl<'a> Placed<'a> {
    fn new(course: &'static dyn Course, index: usize, best: &'a Tried, scenes: &'a Scenes) -> Placed<'a> {
        let scene = scenes.of(course.pace());
        let powers = scene.powers(&best.hypothesis.noise.densities(scene));
        let parts = scenes.part_modes(course.pace(), &best.hypothesis.courses);
        let mut data = scene.modes.clone();
        let mut columns: Vec<(Vec<f64>, f64)> =
            kept(scene, &best.hypothesis.courses).iter().map(|n| (n.modes.clone(), n.deviation)).collect();
        for (j, part) in parts.into_iter().enumerate() {
            if j == index {
                continue;
            }
            if let Some(fixed) = &part.fixed {
                data.iter_mut().zip(fixed).for_each(|(d, f)| *d -= f);
            }
            columns.extend(part.free.into_iter().chain(part.beside).map(|c| (c, f64::INFINITY)));
        }
        Placed { scene, course, inside: &best.hypothesis.courses[index], columns, data, powers }
    }

    fn parts(&self, shape: &[f64]) -> PartModes {
        PartModes::of(self.course.parts(shape, &self.scene.drivers), self.scene)
    }

    /// Penalised sum of squares over −2 for a shape: the log-likelihood with the noise held.
    fn log_likelihood(&self, shape: &[f64]) -> (f64, Vec<f64>) {
        let parts = self.parts(shape);
        let mut data = self.data.clone();
        if let Some(fixed) = &parts.fixed {
            data.iter_mut().zip(fixed).for_each(|(d, f)| *d -= f);
        }
        let mut columns: Vec<(&[f64], f64)> = self.columns.iter().map(|(c, s)| (c.as_slice(), *s)).collect();
        let others = columns.len();
        columns.extend(parts.free.iter().chain(&parts.beside).map(|c| (c.as_slice(), f64::INFINITY)));
        let (coefficients, _, left) = Normal::new(&columns, &data, &self.powers).solve();
        (-0.5 * left, coefficients[others..others + parts.free.len()].to_vec())
    }

    /// Covariance of shape and coefficients of the free columns, everything else free beside.
    fn covariance(&self, coefficients: &[f64]) -> DMatrix<f64> {
        let shape = &self.inside.shape;
        let parts = self.parts(shape);
        let bounds = self.course.bounds(&self.scene.drivers);
        let slopes: Vec<Vec<f64>> = (0..shape.len()).map(|i| self.slope(i, &bounds, coefficients)).collect();
        // A number that is whole, or held by its bounds, has no derivative and no part in the uncertainty.
        let moves = |i: &usize| !self.course.whole().contains(i) && slopes[*i].iter().any(|s| *s != 0.0);
        let active: Vec<usize> = (0..shape.len()).filter(moves).collect();
        let columns: Vec<(&[f64], f64)> = active
            .iter()
            .map(|i| &slopes[*i])
            .chain(&parts.free)
            .chain(&parts.beside)
            .map(|c| (c.as_slice(), f64::INFINITY))
            .chain(self.columns.iter().map(|(c, s)| (c.as_slice(), *s)))
            .collect();
        let (_, covariance, _) = Normal::new(&columns, &self.data, &self.powers).solve();
        let wanted = shape.len() + parts.free.len();
        let places: Vec<usize> = active.iter().copied().chain(shape.len()..wanted).collect();
        let mut out = DMatrix::zeros(wanted, wanted);
        for (a, i) in places.iter().enumerate() {
            for (b, j) in places.iter().enumerate() {
                out[(*i, *j)] = covariance[(a, b)];
            }
        }
        out
    }

    /// Standard deviation that the rms of a course has from a nuisance of the claim that the course takes over: how much
    /// of the two is the claim's own is known no better than the claim states it.
    fn nuisance_deviation(&self, series: &[f64]) -> f64 {
        let Some(replaced) = self.course.replaces() else { return 0.0 };
        let Some(nuisance) = self.scene.nuisances.iter().find(|n| n.nuisance == replaced) else { return 0.0 };
        let modes = self.scene.transform(series);
        let square: f64 = modes.iter().map(|x| x * x).sum();
        let both: f64 = modes.iter().zip(&nuisance.modes).map(|(a, b)| a * b).sum();
        let n = self.scene.drivers.samples.max(1) as f64;
        if square > 0.0 { nuisance.deviation * both.abs() / (square * n).sqrt() } else { 0.0 }
    }

    /// Derivative of the course by a number of its shape, in modes.
    fn slope(&self, i: usize, bounds: &[(f64, f64)], coefficients: &[f64]) -> Vec<f64> {
        let (low, high) = bounds.get(i).copied().unwrap_or((f64::MIN, f64::MAX));
        let shape = &self.inside.shape;
        let step = (1e-3 * shape[i].abs()).max(1e-6 * (high - low).min(1e12)).max(1e-12);
        let at = |x: f64| {
            let mut moved = shape.clone();
            moved[i] = x.clamp(low, high);
            let parts = self.parts(&moved);
            let mut sum = parts.fixed.unwrap_or_else(|| vec![0.0; self.data.len()]);
            for (column, c) in parts.free.iter().zip(coefficients) {
                sum.iter_mut().zip(column).for_each(|(s, z)| *s += c * z);
            }
            (sum, moved[i])
        };
        let ((up, a), (down, b)) = (at(shape[i] + step), at(shape[i] - step));
        if a <= b {
            return vec![0.0; up.len()];
        }
        up.iter().zip(&down).map(|(u, d)| (u - d) / (a - b)).collect()
    }

    /// Position of the only number of a shape that is not whole.
    fn free_number(&self) -> Option<usize> {
        let mut free = (0..self.inside.shape.len()).filter(|i| !self.course.whole().contains(i));
        free.next().filter(|_| free.next().is_none())
    }

    /// The shape with that number in its place.
    fn shape_at(&self, i: usize, x: f64) -> Vec<f64> {
        let mut shape = self.inside.shape.clone();
        shape[i] = x;
        shape
    }

    /// Ends of the interval of the only number of a shape that is not whole, at which the profile log-likelihood has
    /// dropped.
    fn profile(&self, deviation: f64) -> Option<[f64; 2]> {
        let i = self.free_number()?;
        let at = self.inside.shape[i];
        let (low, high) = *self.course.bounds(&self.scene.drivers).get(i)?;
        if high <= low {
            return None;
        }
        let top = self.log_likelihood(&self.inside.shape).0;
        let drop = |x: f64| top - self.log_likelihood(&self.shape_at(i, x)).0;
        let first = if deviation.is_finite() && deviation > 0.0 { deviation } else { 0.01 * (high - low) };
        let side = |sign: f64| {
            let (mut inside, mut step) = (at, first);
            let mut outside = None;
            for _ in 0..24 {
                let x = (at + sign * step).clamp(low, high);
                if drop(x) >= DROP_95 {
                    outside = Some(x);
                    break;
                }
                inside = x;
                if x == low || x == high {
                    break;
                }
                step *= 1.7;
            }
            let Some(mut outside) = outside else { return inside };
            for _ in 0..10 {
                let middle = 0.5 * (inside + outside);
                if drop(middle) >= DROP_95 { outside = middle } else { inside = middle }
            }
            0.5 * (inside + outside)
        };
        Some([side(-1.0), side(1.0)])
    }
}

/// Standard deviation of a course over the record.
fn rms(sum: &[f64]) -> f64 {
    let n = sum.len().max(1) as f64;
    let mean = sum.iter().sum::<f64>() / n;
    (sum.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / n).sqrt()
}

fn of_course(
    effect: &'static dyn Effect,
    course: &'static dyn Course,
    index: usize,
    best: &Tried,
    scenes: &Scenes,
) -> Estimated {
    let placed = Placed::new(course, index, best, scenes);
    let drivers = &placed.scene.drivers;
    let shape = &placed.inside.shape;
    let (_, coefficients) = placed.log_likelihood(shape);
    let covariance = placed.covariance(&coefficients);
    let free = placed.free_number();
    let deviation_of_shape = free.map_or(f64::NAN, |i| covariance[(i, i)].sqrt());
    let profile = placed.profile(deviation_of_shape);
    let at = |x: f64| free.map_or_else(|| shape.clone(), |i| placed.shape_at(i, x));
    let values = course.parameters(shape, &coefficients, drivers);
    let parts = course.parts(shape, drivers);
    let series = summed(&parts.free, &coefficients, parts.fixed.as_ref(), drivers.samples);
    let spread = rms(&series);
    // Everything that is a function of shape and coefficients, with the rms last.
    let all = |shape: &[f64], coefficients: &[f64]| {
        let mut out = course.parameters(shape, coefficients, drivers);
        let parts = course.parts(shape, drivers);
        out.push(rms(&summed(&parts.free, coefficients, parts.fixed.as_ref(), drivers.samples)));
        out
    };
    let deviations = propagate(shape, &coefficients, &covariance, all);
    let mut out = Estimated::default();
    for (i, (param, value)) in effect.params().iter().zip(&values).enumerate() {
        if !value.is_finite() {
            continue;
        }
        out.stated.insert(param.name.to_owned(), Value::Number(*value));
        if !param.reported {
            continue;
        }
        // A parameter that the shape alone determines takes the interval of the shape.
        let by_shape = profile.and_then(|ends| {
            let moved = ends.map(|x| course.parameters(&at(x), &coefficients, drivers).get(i).copied());
            let (Some(a), Some(b)) = (moved[0], moved[1]) else { return None };
            let still =
                course.parameters(shape, &coefficients.iter().map(|c| 1.01 * c).collect::<Vec<_>>(), drivers);
            (still.get(i) == Some(value) && a != b).then_some([a.min(b), a.max(b)])
        });
        let Some(mut ci95) = by_shape.or_else(|| interval(param, *value, deviations[i])) else { continue };
        if param.name == INSTANT
            && let Some([from, to]) = instant::interval(placed.inside, best, scenes)
        {
            ci95 = [from.min(*value), to.max(*value)];
        }
        let unit = param.unit.to_owned();
        out.reported.insert(param.name.to_owned(), ParameterValue { value: *value, unit, ci95 });
    }
    for (name, list) in course.lists(shape, &coefficients, drivers) {
        out.stated.insert(name.to_owned(), Value::List(list));
    }
    let deviation = deviations.last().copied().unwrap_or(f64::NAN).hypot(placed.nuisance_deviation(&series));
    if spread.is_finite() && deviation.is_finite() && spread > 0.0 {
        let factor = (TWO_SIDED_95 * deviation / spread).min(30.0).exp();
        // A course without coefficients is as large as its shape makes it.
        let by_shape = profile.filter(|_| coefficients.is_empty()).map(|ends| {
            let of = |x: f64| all(&at(x), &[]).last().copied().unwrap_or(spread);
            let (a, b) = (of(ends[0]), of(ends[1]));
            [a.min(b).min(spread), a.max(b).max(spread)]
        });
        let ci95 = by_shape.unwrap_or([spread / factor, spread * factor]);
        out.reported
            .insert("rms_deg_h".to_owned(), ParameterValue { value: spread, unit: "deg/h".to_owned(), ci95 });
    }
    out
}

/// Standard deviations of functions of shape and coefficients by their numerical derivatives.
fn propagate(
    shape: &[f64],
    coefficients: &[f64],
    covariance: &DMatrix<f64>,
    functions: impl Fn(&[f64], &[f64]) -> Vec<f64>,
) -> Vec<f64> {
    let (d, p) = (shape.len(), shape.len() + coefficients.len());
    let mut slopes: Vec<Vec<f64>> = vec![];
    for i in 0..p {
        let deviation = covariance[(i, i)].max(0.0).sqrt();
        let value = if i < d { shape[i] } else { coefficients[i - d] };
        let step = if deviation > 0.0 { 0.05 * deviation } else { 1e-6 * value.abs().max(1e-9) };
        let moved = |sign: f64| {
            let (mut s, mut c) = (shape.to_vec(), coefficients.to_vec());
            if i < d {
                s[i] += sign * step
            } else {
                c[i - d] += sign * step
            }
            functions(&s, &c)
        };
        let (up, down) = (moved(1.0), moved(-1.0));
        slopes.push(up.iter().zip(&down).map(|(a, b)| (a - b) / (2.0 * step)).collect());
    }
    let count = slopes.first().map_or_else(|| functions(shape, coefficients).len(), Vec::len);
    (0..count)
        .map(|k| {
            let mut sum = 0.0;
            for i in 0..p {
                for j in 0..p {
                    sum += slopes[i][k] * covariance[(i, j)] * slopes[j][k];
                }
            }
            sum.max(0.0).sqrt()
        })
        .collect()
}

fn of_spectrum(effect: &'static dyn Effect, index: usize, best: &Tried, scenes: &Scenes) -> Estimated {
    let scene = &scenes.full;
    let Model::Spectrum(spectrum) = effect.model() else { return Estimated::default() };
    let noise = &best.hypothesis.noise;
    let part = &noise.spectra[index];
    let which: Vec<Option<usize>> = (0..part.fitted.len())
        .map(|p| {
            let wanted = match spectrum.act() {
                SpectrumAct::Frees(term) => Which::Base(super::noise_fit::base_index(term).unwrap_or(0)),
                _ => Which::Effect(index, p),
            };
            best.fit.noise.which.iter().position(|w| *w == wanted)
        })
        .collect();
    let covariance = |i: usize, j: usize| match (which[i], which[j]) {
        (Some(a), Some(b)) => best.fit.noise.covariance[(a, b)],
        _ => 0.0,
    };
    let residual = &best.residual(scenes);
    let all = |fitted: &[f64]| {
        let mut out = spectrum.parameters(fitted);
        out.push(process::added_rms(noise, index, fitted, scene, residual).0);
        out
    };
    let values = all(&part.fitted);
    let p = part.fitted.len();
    let slopes: Vec<Vec<f64>> = (0..p)
        .map(|i| {
            let moved = |step: f64| {
                let mut fitted = part.fitted.clone();
                fitted[i] *= step.exp();
                all(&fitted)
            };
            moved(1e-3).iter().zip(&moved(-1e-3)).map(|(a, b)| (a - b) / 2e-3).collect()
        })
        .collect();
    let deviation = |k: usize| {
        let mut sum = 0.0;
        for i in 0..p {
            for j in 0..p {
                sum += slopes[i][k] * covariance(i, j) * slopes[j][k];
            }
        }
        f64::max(sum, 0.0).sqrt()
    };
    let mut out = Estimated::default();
    for (i, (param, value)) in effect.params().iter().zip(&values).enumerate() {
        if !value.is_finite() {
            continue;
        }
        out.stated.insert(param.name.to_owned(), Value::Number(*value));
        if param.reported
            && let Some(ci95) = interval(param, *value, deviation(i).max(EXACT * value.abs()))
        {
            let unit = param.unit.to_owned();
            out.reported.insert(param.name.to_owned(), ParameterValue { value: *value, unit, ci95 });
        }
    }
    let chance = process::added_rms(noise, index, &part.fitted, scene, residual).1;
    let (spread, last) = (values[values.len() - 1], deviation(values.len() - 1).hypot(chance));
    if spread > 0.0 && spread.is_finite() {
        let factor = (TWO_SIDED_95 * last / spread).min(30.0).exp();
        let ci95 = [spread / factor, spread * factor];
        out.reported
            .insert("rms_deg_h".to_owned(), ParameterValue { value: spread, unit: "deg/h".to_owned(), ci95 });
    }
    out
}
