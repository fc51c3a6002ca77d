//! How far the response to a rate table is from a straight line: largest and mean residual, curvature, asymmetry.

use super::descriptor::{Measurand, Stimulus};
use super::evidence::TableEvidence;
use super::sine_response;
use crate::estimate::{Estimate, Spread, UpperLimit};
use crate::message::Note;
use crate::numeric::reml::Combination;
use crate::rate_table::combine::spread;
use crate::rate_table::largest::Largest;
use crate::rate_table::scale_factor::{METHOD, ScaleFactor};
use nalgebra::{DMatrix, DVector};

/// Largest residual of full scale.
pub static SCALE_FACTOR_NONLINEARITY: Measurand = Measurand::of_steps(
    "scale_factor_nonlinearity",
    "ppm",
    "largest residual of full scale",
    Stimulus::Rates,
    |m, e| {
        of_line(e, |line| {
            let found = line.largest.as_ref();
            let rate = found.map_or(0.0, |l| line.response.levels[l.at]);
            largest(m, line, found, rate, line.ppm_of_full_scale())
        })
    },
)
.also_called(&["sfn", "sfnl", "linearity", "nonlinearity", "sf_nonlinearity"]);

/// Largest residual of the rate itself.
pub static SCALE_FACTOR_NONLINEARITY_OF_RATE: Measurand = Measurand::of_steps(
    "scale_factor_nonlinearity_of_rate",
    "ppm",
    "largest residual of the rate itself",
    Stimulus::Rates,
    |m, e| {
        of_line(e, |line| {
            let found = line.largest_of_rate.as_ref();
            largest(m, line, found.map(|f| &f.0), found.map_or(0.0, |f| f.1), 1e6 / line.factor)
        })
    },
);

/// Root mean square of the residuals.
pub static SCALE_FACTOR_RESIDUAL: Measurand = Measurand::of_steps(
    "scale_factor_residual",
    "ppm",
    "rms of the residuals of full scale",
    Stimulus::Rates,
    |m, e| {
        if e.setup.sine {
            return vec![sine_response::residual(m, e)];
        }
        of_line(e, |line| residual(m, line))
    },
);

/// Cubic term.
pub static SCALE_FACTOR_ODD: Measurand =
    Measurand::of_steps("scale_factor_odd", "ppm", "cubic term at full scale", Stimulus::Rates, |m, e| {
        of_line(e, |line| term(m, line, 3))
    })
    .signed();

/// Quadratic term.
pub static SCALE_FACTOR_EVEN: Measurand = Measurand::of_steps(
    "scale_factor_even",
    "ppm",
    "quadratic term at full scale",
    Stimulus::Rates,
    |m, e| of_line(e, |line| term(m, line, 2)),
)
.signed();

/// Difference of the slopes of both signs.
pub static SCALE_FACTOR_ASYMMETRY: Measurand = Measurand::of_steps(
    "scale_factor_asymmetry",
    "ppm",
    "difference between positive and negative rates",
    Stimulus::Rates,
    |m, e| {
        of_line(e, |line| match slopes_differ(line) {
            Some(found) => {
                let spread = spread(&found, 1e6 / line.factor.abs(), &[]);
                m.measured(&line.channel, 1e6 * found.value / line.factor, spread, METHOD)
            }
            None => m.not_identifiable(&line.channel, None, METHOD).note(Note::new("on_table.one_sign")),
        })
    },
)
.signed();

/// Probability of a largest residual by chance above which it is not claimed. It rests on a noise that the same test tells,
/// and of what is claimed by chance no interval holds the truth: a twentieth is claimed at twice that and more.
const CLAIMED_BELOW: f64 = 0.01;

/// The row of the line, where there is one.
pub(super) fn of_line(e: &TableEvidence<'_>, of: impl Fn(&ScaleFactor) -> Estimate) -> Vec<Estimate> {
    e.line.as_ref().map(of).into_iter().collect()
}

/// The largest residual at a rate, or its bound where chance explains it.
fn largest(
    m: &Measurand,
    line: &ScaleFactor,
    found: Option<&Largest>,
    rate_deg_h: f64,
    factor: f64,
) -> Estimate {
    let at = Note::new("on_table.largest_at").with("rate", line.rate_unit().figures(rate_deg_h, 4));
    let Some(found) = found else {
        let none = m.not_identifiable(&line.channel, None, METHOD);
        return none.note(Note::new("on_table.few_levels")).note(at);
    };
    let factor = factor.abs();
    let value = found.value * factor;
    let spread = Spread::Curve(found.curve.iter().map(|(z, v)| (*z, v * factor)).collect());
    if found.by_chance > CLAIMED_BELOW {
        let bound = spread.bound(value, 0.95).map(|value| UpperLimit { value, coverage: 0.95 });
        return m.not_identifiable(&line.channel, bound, METHOD).note(at);
    }
    m.measured(&line.channel, value, spread, METHOD).note(at)
}

/// Root mean square of the residuals of the levels without what noise adds to it.
fn residual(m: &Measurand, line: &ScaleFactor) -> Estimate {
    let n = line.levels.len() as f64;
    let observed = line.levels.iter().map(|(r, _)| r * r).sum::<f64>() / n;
    let noise = line.levels.iter().map(|(_, u)| u * u).sum::<f64>() / n;
    // Variance of a sum of squares of correlated values.
    let r = DVector::from_iterator(line.levels.len(), line.levels.iter().map(|l| l.0));
    let c = &line.covariance;
    let cross = 4.0 * r.dot(&(c * &r)) + 2.0 * c.component_mul(c).sum();
    let standard = cross.max(0.0).sqrt() / n;
    let truth = observed - noise;
    let factor = line.ppm_of_full_scale().abs();
    let root = |v: f64| v.max(0.0).sqrt() * factor;
    if truth <= 1.645 * standard {
        let value = root(truth.max(0.0) + 1.645 * standard);
        return m.not_identifiable(&line.channel, Some(UpperLimit { value, coverage: 0.95 }), METHOD);
    }
    let curve = (-12..=12).map(|z| 0.25 * f64::from(z)).map(|z| (z, root(truth + z * standard))).collect();
    m.measured(&line.channel, root(truth), Spread::Curve(curve), METHOD)
}

/// A term of a polynomial of third order at full scale.
fn term(m: &Measurand, line: &ScaleFactor, power: usize) -> Estimate {
    match polynomial_term(line, power) {
        Some(found) => {
            let ppm = line.ppm_of_full_scale();
            m.measured(&line.channel, found.value * ppm, spread(&found, ppm.abs(), &[]), METHOD)
        }
        None => m.not_identifiable(&line.channel, None, METHOD).note(Note::new("on_table.few_levels")),
    }
}

/// The same, deg/h.
fn polynomial_term(line: &ScaleFactor, power: usize) -> Option<Combination> {
    let levels = &line.response.levels;
    if levels.len() < 5 {
        return None;
    }
    let a = DMatrix::from_fn(levels.len(), 4, |i, j| (levels[i] / line.full_scale).powi(j as i32));
    let h = (a.transpose() * &a).try_inverse()? * a.transpose();
    Some(line.response.of_levels(&h.row(power).iter().copied().collect::<Vec<f64>>()))
}

/// K₊ − K₋ from slopes of both signs with one intercept.
fn slopes_differ(line: &ScaleFactor) -> Option<Combination> {
    let levels = &line.response.levels;
    let signs = |s: f64| levels.iter().filter(|r| *r * s > 1e-6 * line.full_scale).count();
    if signs(1.0) < 1 || signs(-1.0) < 1 || levels.len() < 3 {
        return None;
    }
    let a = DMatrix::from_fn(levels.len(), 3, |i, j| match j {
        0 => 1.0,
        1 => levels[i].max(0.0),
        _ => levels[i].min(0.0),
    });
    let h = (a.transpose() * &a).try_inverse()? * a.transpose();
    let weights: Vec<f64> = (0..levels.len()).map(|i| h[(1, i)] - h[(2, i)]).collect();
    Some(line.response.of_levels(&weights))
}
