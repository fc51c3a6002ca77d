//! Confidence curves and covariance of the variables of a joint fit.

use super::super::profile::{Trace, trace_curve};
use super::fit::Joint;
use super::model::{BASE_TERMS, Free, JointPoint, Variable};
use crate::estimate::Spread;
use nalgebra::DMatrix;

/// Normal score between its points.
const SCORE_SPACING: f64 = 0.6;

/// The covariance of the variables of a fit, in the units they are reported in, the ramp last where it is free.
///
/// Fisher information at the point; a variance at zero has no coefficient and is left out.
pub fn parameter_covariance(
    joint: &Joint<'_>,
    point: &JointPoint,
    free: &Free,
) -> (Vec<Variable>, Vec<Vec<f64>>) {
    let columns = joint.columns(&point.shape);
    let s = joint.density_at(point);
    let mut variables = joint.variables(&point.shape, free);
    variables.retain(|v| match v {
        Variable::Variance(i) => point.variance.get(*i).is_some_and(|v| *v > 0.0),
        Variable::DecayTime(i) | Variable::Frequency(i) => {
            point.variance.get(BASE_TERMS.len() + i).is_some_and(|v| *v > 0.0)
        }
        _ => true,
    });
    let information = joint.information(&s, &joint.gradient(point, &columns, &variables));
    let p = variables.len();
    let scale: Vec<f64> = (0..p).map(|i| information[(i, i)].max(0.0).sqrt()).collect();
    let unit: Vec<f64> = variables
        .iter()
        .map(|v| match v {
            Variable::Variance(i) => 0.5 / point.variance.get(*i).copied().unwrap_or(1.0).sqrt(),
            other => joint.unit_of(point, *other),
        })
        .collect();
    let normal = DMatrix::from_fn(p, p, |a, b| {
        let ridge = if a == b { 1e-9 } else { 0.0 };
        let scales = scale[a] * scale[b];
        if scales > 0.0 { information[(a, b)] / scales + ridge } else { ridge + f64::from(u8::from(a == b)) }
    });
    let inverse = normal.try_inverse().unwrap_or_else(|| DMatrix::zeros(p, p));
    let size = p + usize::from(free.ramp);
    let mut out = vec![vec![0.0; size]; size];
    for a in 0..p {
        for b in 0..p {
            if scale[a] > 0.0 && scale[b] > 0.0 {
                out[a][b] = inverse[(a, b)] / (scale[a] * scale[b]) * unit[a] * unit[b];
            }
        }
    }
    if free.ramp {
        variables.push(Variable::Ramp);
        out[p][p] = joint.ramp_sigma(&s).powi(2);
    }
    (variables, out)
}

/// The profile likelihood of one variable.
pub struct JointProfile<'a> {
    joint: &'a Joint<'a>,
    best: JointPoint,
    free: Free,
    variable: Variable,
    top: f64,
    sigma: f64,
}

impl<'a> JointProfile<'a> {
    /// The profile about the maximum `best` of a fit with `free`.
    pub fn new(joint: &'a Joint<'a>, best: &JointPoint, free: &Free, variable: Variable) -> JointProfile<'a> {
        let free = Free { held: Some(variable), ..free.clone() };
        let mut profile =
            JointProfile { joint, best: best.clone(), free, variable, top: best.deviance, sigma: 0.0 };
        if variable == Variable::Ramp {
            // At a held ramp the likelihood is the plain one: its own maximum is the reference.
            profile.top = profile.fit(best.ramp, best).deviance;
        }
        profile.sigma = profile.first_sigma();
        profile
    }

    fn first_sigma(&self) -> f64 {
        let open = Free { held: None, ramp: self.free.ramp, ..self.free.clone() };
        let (variables, covariance) = parameter_covariance(self.joint, &self.best, &open);
        let at = variables.iter().position(|v| *v == self.variable);
        let sigma = at.map_or(0.0, |i| covariance[i][i].max(0.0).sqrt());
        if let Variable::Variance(i) = self.variable {
            let s = self.joint.density_at(&self.best);
            let columns = self.joint.columns(&self.best.shape);
            let information = columns
                .all()
                .nth(i)
                .map_or(0.0, |c| self.joint.information(&s, std::slice::from_ref(c))[(0, 0)]);
            // Near zero the information of the coefficient vanishes; that of its square does not.
            let near_zero = if information > 0.0 { information.powf(-0.25) } else { 0.0 };
            return if sigma <= 0.0 || sigma > near_zero { near_zero } else { sigma };
        }
        sigma
    }

    fn fit(&self, value: f64, from: &JointPoint) -> JointPoint {
        let mut start = from.clone();
        start.set_reported(self.variable, value);
        self.joint.maximise(&start, &self.free)
    }

    fn is_time(&self) -> bool {
        matches!(self.variable, Variable::FilterTime | Variable::DecayTime(_))
    }

    /// The next value in a direction, `steps` standard deviations on.
    fn next(&self, at: f64, steps: f64) -> f64 {
        if self.is_time() {
            // Times are stepped by ratios, at most doubled.
            let value = self.best.reported(self.variable);
            return at * (steps * self.sigma / value).clamp(-0.7, 0.7).exp();
        }
        let next = at + steps * self.sigma;
        if self.variable == Variable::Ramp { next } else { next.max(0.0) }
    }

    /// Pairs (normal score, value), ascending, from −4 or the boundary to 4.
    pub fn spread(&self) -> Spread {
        if !(self.sigma > 0.0 && self.sigma.is_finite()) {
            return Spread::Unknown;
        }
        let value = self.best.reported(self.variable);
        let limit_s = 20.0 * self.joint.evidence().span_s;
        let next = |at: f64, step: f64| {
            let next = self.next(at, step);
            if self.is_time() && next > limit_s { at } else { next }
        };
        let rise = |value: f64, point: &mut JointPoint| {
            *point = self.fit(value, point);
            point.deviance - self.top
        };
        let trace = Trace { first_step: SCORE_SPACING, spacing: SCORE_SPACING, max_points: 24 };
        trace_curve(value, trace, self.best.clone(), next, rise)
    }

    /// The largest size of the variable whose deviance is not more than `rise` above the minimum.
    pub fn upper_limit(&self, rise: f64) -> Option<f64> {
        if !(self.sigma > 0.0 && self.sigma.is_finite()) {
            return None;
        }
        let side = |direction: f64| {
            let start = self.best.reported(self.variable);
            let (mut low, mut low_rise, mut step) = (start, 0.0, 1.0);
            let mut point = self.best.clone();
            for _ in 0..40 {
                let next = low + direction * step * self.sigma;
                point = self.fit(next, &point);
                let at = (point.deviance - self.top).max(0.0);
                if at >= rise {
                    // Between two scores the root of the rise is nearly straight.
                    let (a, b, want) = (f64::sqrt(low_rise), at.sqrt(), rise.sqrt());
                    let share = if b > a { (want - a) / (b - a) } else { 1.0 };
                    return low + (next - low) * share.clamp(0.0, 1.0);
                }
                (low, low_rise) = (next, at);
                step *= 1.6;
            }
            low
        };
        let up = side(1.0).abs();
        let limit = if self.variable == Variable::Ramp { up.max(side(-1.0).abs()) } else { up };
        limit.is_finite().then_some(limit)
    }
}
