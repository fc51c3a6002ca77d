//! Maximum likelihood of a shape, by Fisher scoring.

use super::super::likelihood::{
    BandPower, best_ramp, deviance, ramp_information, starting_variance, usable_bands,
};
use super::super::misfit::WhitenedBand;
use super::columns::{Base, Columns, FilteredBins, base, process};
use super::model::{BASE_TERMS, Free, JointPoint, QUANTIZATION_INDEX, Shape, Variable};
use crate::noise::composite::{Bandwidth, Damped, Sampling};
use crate::noise::evidence::{Evidence, Places};
use crate::numeric::optimize::{bounded_quadratic, shortened_steps};
use nalgebra::{DMatrix, DVector};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Fall of the deviance below which a fit is done.
const MIN_FALL: f64 = 1e-3;
/// Steps of a fit at most.
const MAX_STEPS: usize = 80;
/// Periods that an oscillation lasts at least.
const MIN_PERIODS: f64 = 2.0;
/// Filters whose columns are kept.
const MAX_FILTERS: usize = 8;
/// Processes whose columns are kept.
const MAX_KEPT_PROCESSES: usize = 128;
/// Relative step of numeric derivatives.
const DERIVATIVE_STEP: f64 = 1e-3;

/// The joint likelihood of an evidence.
pub struct Joint<'a> {
    evidence: &'a Evidence,
    sampling: Sampling,
    bands: Vec<BandPower>,
    used: Vec<usize>,
    places: Places,
    plain: Base,
    filtered_bins: OnceLock<FilteredBins>,
    filtered: Mutex<Vec<(Bandwidth, Base)>>,
    processes: Mutex<VecDeque<KeptProcess>>,
}

/// The column of a process by the bits of its frequency and decay time.
type KeptProcess = ([u64; 2], Arc<Vec<f64>>);

impl<'a> Joint<'a> {
    /// Prepares the likelihood; `None` when there is no power in any band or too few bands to say anything.
    pub fn new(evidence: &'a Evidence, sampling: Sampling) -> Option<Joint<'a>> {
        let (used, bands) = usable_bands(evidence)?;
        let mut joint = Joint {
            evidence,
            sampling,
            bands,
            used,
            places: evidence.places(),
            plain: Arc::default(),
            filtered_bins: OnceLock::new(),
            filtered: Mutex::default(),
            processes: Mutex::default(),
        };
        joint.plain = Arc::new(joint.restrict(base(evidence, sampling)));
        Some(joint)
    }

    /// How samples were taken.
    pub fn sampling(&self) -> Sampling {
        self.sampling
    }

    /// The evidence fitted.
    pub fn evidence(&self) -> &'a Evidence {
        self.evidence
    }

    fn restrict(&self, columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        if self.used.len() == self.evidence.bands.len() {
            return columns;
        }
        let pick = |c: Vec<f64>| self.used.iter().map(|i| c.get(*i).copied().unwrap_or(0.0)).collect();
        columns.into_iter().map(pick).collect()
    }

    /// The columns of N, B, K and Q behind a filter. Those of the last filters are kept: a search asks for them with many
    /// processes beside.
    fn base(&self, filter: Option<Bandwidth>) -> Base {
        let Some(filter) = filter else { return self.plain.clone() };
        let kept = || self.filtered.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, base)) = kept().iter().find(|(f, _)| *f == filter) {
            return base.clone();
        }
        let bins = self.filtered_bins.get_or_init(|| FilteredBins::new(self.evidence, self.sampling));
        let mut made = self.restrict(bins.columns(self.evidence, filter));
        made.extend(self.plain.get(QUANTIZATION_INDEX).cloned());
        let made = Arc::new(made);
        let mut kept = kept();
        if kept.len() >= MAX_FILTERS {
            kept.remove(0);
        }
        kept.push((filter, made.clone()));
        made
    }

    /// The column of a process. Those of the last processes are kept: every fit begins where another ended, and searches of many
    /// shapes go through the same times.
    fn process(&self, damped: &Damped) -> Arc<Vec<f64>> {
        let key = [damped.frequency_hz.to_bits(), damped.decay_time_s.to_bits()];
        let kept = || self.processes.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, column)) = kept().iter().rev().find(|(k, _)| *k == key) {
            return column.clone();
        }
        let made = process(&self.places, self.evidence.tau0_s, damped, self.sampling);
        let made = Arc::new(self.restrict(vec![made]).pop().unwrap_or_default());
        let mut kept = kept();
        if kept.len() >= MAX_KEPT_PROCESSES {
            kept.pop_front();
        }
        kept.push_back((key, made.clone()));
        made
    }

    pub(super) fn columns(&self, shape: &Shape) -> Columns {
        let damped = shape.damped.iter().map(|(_, d)| self.process(d)).collect();
        Columns { base: self.base(shape.filter), damped }
    }

    fn density(&self, columns: &Columns, variance: &[f64]) -> Vec<f64> {
        let mut s = vec![0.0; self.bands.len()];
        for (column, v) in columns.all().zip(variance) {
            if *v > 0.0 {
                for (s, c) in s.iter_mut().zip(column) {
                    *s += v * c;
                }
            }
        }
        s
    }

    /// Every band with its expected power.
    fn expected<'b>(&'b self, s: &'b [f64]) -> impl Iterator<Item = (&'b BandPower, f64)> + Clone + 'b {
        self.bands.iter().zip(s.iter().copied())
    }

    /// A start: every free variance at the size at which it alone would make the smallest bands.
    pub fn start(&self, shape: &Shape, free: &[bool]) -> JointPoint {
        let columns = self.columns(shape);
        let active = free.iter().filter(|f| **f).count().max(1) as f64;
        let scale = |column: &Vec<f64>| starting_variance(self.bands.iter(), column.iter().copied()) / active;
        let variance = columns.all().zip(free).map(|(c, f)| if *f { scale(c) } else { 0.0 }).collect();
        JointPoint { variance, shape: shape.clone(), ramp: 0.0, deviance: f64::INFINITY }
    }

    /// The variables of a fit beside the ramp.
    pub(super) fn variables(&self, shape: &Shape, free: &Free) -> Vec<Variable> {
        let mut out: Vec<Variable> = free
            .variance
            .iter()
            .enumerate()
            .filter(|(_, f)| **f)
            .map(|(i, _)| Variable::Variance(i))
            .collect();
        if free.nonlinear {
            if let Some(Bandwidth::FirstOrder { .. }) = shape.filter {
                out.push(Variable::FilterTime);
            }
            for (i, (_, d)) in shape.damped.iter().enumerate() {
                if free.variance.get(BASE_TERMS.len() + i) == Some(&true) {
                    out.push(Variable::DecayTime(i));
                    if d.frequency_hz > 0.0 {
                        out.push(Variable::Frequency(i));
                    }
                }
            }
        }
        out.retain(|v| Some(*v) != free.held);
        out
    }

    /// The scale on which a variable is stepped: the derivative of the density to it is per this step.
    fn moved(&self, shape: &Shape, variable: Variable, step: f64) -> Shape {
        let mut out = shape.clone();
        let (span, tau0) = (self.evidence.span_s.max(self.evidence.tau0_s), self.evidence.tau0_s);
        match variable {
            Variable::FilterTime => {
                if let Some(Bandwidth::FirstOrder { time_constant_s }) = &mut out.filter {
                    *time_constant_s = (*time_constant_s * step.exp()).clamp(0.05 * tau0, span);
                }
            }
            Variable::DecayTime(i) => {
                if let Some((_, d)) = out.damped.get_mut(i) {
                    // A process that decays in less than a few periods is a bump and no oscillation.
                    let least = if d.frequency_hz > 0.0 { MIN_PERIODS / d.frequency_hz } else { 0.05 * tau0 };
                    d.decay_time_s = (d.decay_time_s * step.exp()).max(least).min(100.0 * span);
                }
            }
            Variable::Frequency(i) => {
                if let Some((_, d)) = out.damped.get_mut(i) {
                    let width = 1.0 / (2.0 * std::f64::consts::PI * d.decay_time_s).max(0.3 / span);
                    let width = width.min(0.1 * d.frequency_hz).max(0.3 / span);
                    d.frequency_hz = (d.frequency_hz + step * width).clamp(1.0 / span, 0.5 / tau0);
                    d.decay_time_s = d.decay_time_s.max(MIN_PERIODS / d.frequency_hz);
                }
            }
            Variable::Variance(_) | Variable::Ramp => {}
        }
        out
    }

    /// d density / d variable, one column a variable.
    pub(super) fn gradient(
        &self,
        point: &JointPoint,
        columns: &Columns,
        variables: &[Variable],
    ) -> Vec<Vec<f64>> {
        let column = |variable: &Variable| -> Vec<f64> {
            match *variable {
                Variable::Variance(i) => columns.all().nth(i).cloned().unwrap_or_default(),
                Variable::FilterTime => {
                    let moved = self.base(self.moved(&point.shape, *variable, DERIVATIVE_STEP).filter);
                    let mut out = vec![0.0; self.bands.len()];
                    for ((now, then), v) in columns.base.iter().zip(moved.iter()).zip(&point.variance) {
                        for ((o, a), b) in out.iter_mut().zip(now).zip(then) {
                            *o += v * (b - a) / DERIVATIVE_STEP;
                        }
                    }
                    out
                }
                Variable::DecayTime(i) | Variable::Frequency(i) => {
                    let up = self.moved(&point.shape, *variable, DERIVATIVE_STEP);
                    let Some(((_, d), v)) = up.damped.get(i).zip(point.variance.get(BASE_TERMS.len() + i))
                    else {
                        return vec![0.0; self.bands.len()];
                    };
                    let Some(now) = columns.damped.get(i) else { return vec![0.0; self.bands.len()] };
                    let then = self.process(d);
                    now.iter().zip(then.iter()).map(|(a, b)| v * (b - a) / DERIVATIVE_STEP).collect()
                }
                Variable::Ramp => vec![0.0; self.bands.len()],
            }
        };
        variables.iter().map(column).collect()
    }

    /// Fisher information of variables at a point, per unit of variance and per step of [`Joint::moved`].
    pub(super) fn information(&self, s: &[f64], gradient: &[Vec<f64>]) -> DMatrix<f64> {
        let p = gradient.len();
        let mut h = DMatrix::zeros(p, p);
        for (a, ga) in gradient.iter().enumerate() {
            for (b, gb) in gradient.iter().enumerate().take(a + 1) {
                let mut sum = 0.0;
                for (((row, s), x), y) in self.bands.iter().zip(s).zip(ga).zip(gb) {
                    sum += 0.5 * row.dof * x * y / (s * s);
                }
                h[(a, b)] = sum;
                h[(b, a)] = sum;
            }
        }
        h
    }

    /// The maximum from a start; variances that are not free keep their value.
    pub fn maximise(&self, start: &JointPoint, free: &Free) -> JointPoint {
        self.newton_ascent(start, free, MAX_STEPS)
    }

    /// The maximum with N, B, K, Q and the parts of a shape.
    pub(super) fn best(&self, shape: &Shape, ramp: bool) -> JointPoint {
        let free = Free::all(shape, ramp, !shape.is_plain());
        self.maximise(&self.start(shape, &free.variance), &free)
    }

    /// At most `steps` steps of Fisher scoring (Newton's method with the expected information) from a start. Variances stay at or
    /// above zero; a step that does not lower the deviance is shortened.
    pub(super) fn newton_ascent(&self, start: &JointPoint, free: &Free, steps: usize) -> JointPoint {
        let mut point = start.clone();
        let restricted = free.ramp && free.held != Some(Variable::Ramp);
        let mut columns = self.columns(&point.shape);
        self.leave_boundary(&mut point, &columns, free);
        let mut s = self.density(&columns, &point.variance);
        if restricted {
            point.ramp = best_ramp(self.expected(&s));
        }
        point.deviance = deviance(self.expected(&s), point.ramp, restricted);
        if !point.deviance.is_finite() {
            return point;
        }
        let mut damping = 0.0;
        for _ in 0..steps {
            let variables = self.variables(&point.shape, free);
            if variables.is_empty() {
                break;
            }
            let gradient = self.gradient(&point, &columns, &variables);
            let mut h = self.information(&s, &gradient);
            let ramp_variance = if restricted {
                1.0 / ramp_information(self.expected(&s)).max(f64::MIN_POSITIVE)
            } else {
                0.0
            };
            let g = DVector::from_fn(variables.len(), |a, _| {
                let mut sum = 0.0;
                for ((row, s), x) in self.bands.iter().zip(&s).zip(&gradient[a]) {
                    let power = row.without_ramp(point.ramp) + ramp_variance * row.ramp;
                    sum += 0.5 * row.dof * x * (power - s) / (s * s);
                }
                sum
            });
            let mut lower = vec![f64::NEG_INFINITY; variables.len()];
            for (a, variable) in variables.iter().enumerate() {
                match variable {
                    Variable::Variance(i) => lower[a] = -point.variance[*i],
                    // Times and frequencies bend: a little damping keeps steps short where nothing holds them.
                    _ => h[(a, a)] += 0.05 + damping * h[(a, a)],
                }
            }
            let step = bounded_quadratic(&h, &g, &lower);
            let before = point.deviance;
            let shorter = |scale: f64| scale * if scale > 0.2 { 0.5 } else { 0.25 };
            let (better, scale) = shortened_steps(12, shorter, |scale| {
                let (mut trial, bent) = self.moved_along(&point, &variables, &step, scale);
                let trial_columns = if bent { self.columns(&trial.shape) } else { columns.clone() };
                let trial_s = self.density(&trial_columns, &trial.variance);
                if restricted && trial_s.iter().all(|s| *s > 0.0) {
                    trial.ramp = best_ramp(self.expected(&trial_s));
                }
                trial.deviance = deviance(self.expected(&trial_s), trial.ramp, restricted);
                (trial.deviance < point.deviance).then_some((trial, trial_columns, trial_s))
            });
            let improved = better.is_some();
            if let Some(better) = better {
                (point, columns, s) = better;
            }
            damping = if scale < 1.0 { (damping + 0.1) * 2.0 } else { damping * 0.3 };
            if !improved || before - point.deviance < MIN_FALL {
                break;
            }
        }
        point
    }

    /// The point after a share of a step, and whether that changed a time or a frequency.
    fn moved_along(
        &self,
        point: &JointPoint,
        variables: &[Variable],
        step: &DVector<f64>,
        scale: f64,
    ) -> (JointPoint, bool) {
        let (mut trial, mut bent) = (point.clone(), false);
        for (variable, d) in variables.iter().zip(step.iter()) {
            match variable {
                Variable::Variance(i) => {
                    trial.variance[*i] = (trial.variance[*i] + scale * d).max(0.0);
                }
                other => {
                    trial.shape = self.moved(&trial.shape, *other, (scale * d).clamp(-1.0, 1.0));
                    bent = true;
                }
            }
        }
        (trial, bent)
    }

    /// Moves free variances that are exactly zero off the boundary, so that the first step sees a gradient of their terms.
    fn leave_boundary(&self, point: &mut JointPoint, columns: &Columns, free: &Free) {
        let s = self.density(columns, &point.variance);
        point.variance.resize(BASE_TERMS.len() + point.shape.damped.len(), 0.0);
        let any = s.iter().any(|s| *s > 0.0);
        for (i, column) in columns.all().enumerate() {
            let held = free.held == Some(Variable::Variance(i));
            if free.variance.get(i) != Some(&true) || held || point.variance[i] > 0.0 {
                continue;
            }
            let smallest = self
                .bands
                .iter()
                .zip(&s)
                .zip(column)
                .filter(|(_, c)| **c > 0.0)
                .map(|((row, s), c)| if any { s / c } else { row.power / c })
                .fold(f64::INFINITY, f64::min);
            if smallest.is_finite() {
                point.variance[i] = if any { 1e-3 * smallest } else { smallest };
            }
        }
    }

    /// The bands set against the model at a point.
    pub fn whitened(&self, point: &JointPoint) -> Vec<WhitenedBand> {
        let s = self.density(&self.columns(&point.shape), &point.variance);
        self.expected(&s)
            .map(|(band, s)| WhitenedBand { ratio: band.without_ramp(point.ramp) / s, dof: band.dof })
            .collect()
    }

    pub(super) fn density_at(&self, point: &JointPoint) -> Vec<f64> {
        self.density(&self.columns(&point.shape), &point.variance)
    }

    pub(super) fn ramp_sigma(&self, s: &[f64]) -> f64 {
        let information = ramp_information(self.expected(s));
        if information > 0.0 { information.sqrt().recip() } else { 0.0 }
    }

    /// How far one step of [`Joint::moved`] changes the reported value of a variable.
    pub(super) fn unit_of(&self, point: &JointPoint, variable: Variable) -> f64 {
        let mut moved = point.clone();
        moved.shape = self.moved(&point.shape, variable, DERIVATIVE_STEP);
        (moved.reported(variable) - point.reported(variable)) / DERIVATIVE_STEP
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::linear_fit::Likelihood;
    use super::*;
    use crate::noise::model::NoiseModel;

    #[test]
    fn without_further_parts_it_ends_where_the_linear_fit_ends() {
        let model = NoiseModel { n: 0.002, b: 0.004, k: 0.01, ..NoiseModel::default() };
        let evidence = Evidence::expected(&model, 36_000, 1.0);
        let joint = Joint::new(&evidence, Sampling::Averaging).unwrap();
        let point = joint.best(&Shape::default(), false);
        let linear = Likelihood::new(&evidence).unwrap();
        let other = linear.maximise(&[true, true, true, true, false], None, None).unwrap();
        assert!((point.deviance - other.deviance).abs() < 1e-2, "{} {}", point.deviance, other.deviance);
        for (a, b) in [(point.terms().n, model.n), (point.terms().b, model.b), (point.terms().k, model.k)] {
            assert!((a / b - 1.0).abs() < 1e-2, "{a} {b}");
        }
    }
}
