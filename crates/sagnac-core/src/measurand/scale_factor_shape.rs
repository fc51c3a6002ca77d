//! How far the response to a rate table is from a straight line: largest and mean residual, curvature, asymmetry.

use super::descriptor::{Measurand, Stimulus};
use super::evidence::TableEvidence;
use super::sine_response;
use crate::estimate::{Estimate, SCORE_ONE_SIDED_95, Spread, UpperLimit};
use crate::message::note;
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
            None => m.not_identifiable(&line.channel, None, METHOD).note(note!("on_table.one_sign")),
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
    let at = note!("on_table.largest_at", rate = line.rate_unit().figures(rate_deg_h, 4));
    let Some(found) = found else {
        let none = m.not_identifiable(&line.channel, None, METHOD);
        return none.note(note!("on_table.few_levels")).note(at);
    };
    of_largest(m, &line.channel, found, factor.abs(), METHOD).note(at)
}

/// The largest of several magnitudes times a factor, or its bound where chance explains it.
pub(super) fn of_largest(
    m: &Measurand,
    channel: &str,
    found: &Largest,
    factor: f64,
    method: &'static str,
) -> Estimate {
    let value = found.value * factor;
    let spread = Spread::Curve(found.curve.iter().map(|(z, v)| (*z, v * factor)).collect());
    if found.by_chance > CLAIMED_BELOW {
        let bound = spread.bound(value, 0.95).map(|value| UpperLimit { value, coverage: 0.95 });
        return m.not_identifiable(channel, bound, method);
    }
    m.measured(channel, value, spread, method)
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
    if truth <= SCORE_ONE_SIDED_95 * standard {
        let value = root(truth.max(0.0) + SCORE_ONE_SIDED_95 * standard);
        return m.not_identifiable(&line.channel, Some(UpperLimit { value, coverage: 0.95 }), METHOD);
    }
    m.measured(&line.channel, root(truth), Spread::by_score(|z| root(truth + z * standard)), METHOD)
}

/// A term of a polynomial of third order at full scale.
fn term(m: &Measurand, line: &ScaleFactor, power: usize) -> Estimate {
    match polynomial_term(line, power) {
        Some(found) => {
            let ppm = line.ppm_of_full_scale();
            m.measured(&line.channel, found.value * ppm, spread(&found, ppm.abs(), &[]), METHOD)
        }
        None => m.not_identifiable(&line.channel, None, METHOD).note(note!("on_table.few_levels")),
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

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{
        curve, diagonal, line, near, notes, on_table, shows, student, told, withholds,
    };
    use super::*;
    use crate::message::Arg;
    use crate::rate_table::Setup;

    /// A line through these rates with a factor of −1.25 and a full scale of 200 deg/h: 1 deg/h is −4000 ppm of full scale.
    /// Means of the levels have a variance of 0.01.
    fn found(rates: &[f64], means: &[f64]) -> ScaleFactor {
        let (_, mut line) = line(rates, means, &[], diagonal(&vec![0.01; rates.len()]));
        (line.factor, line.full_scale) = (-1.25, 200.0);
        line
    }

    const RATES: [f64; 5] = [-200.0, -100.0, 0.0, 100.0, 200.0];

    fn row(m: &Measurand, line: &ScaleFactor) -> Estimate {
        let (setup, steps) = (Setup::default(), crate::rate_table::steps::Steps::default());
        assert!(m.evaluate_steps(&on_table(&setup, &steps, None)).is_empty());
        let mut rows = m.evaluate_steps(&on_table(&setup, &steps, Some(line.clone())));
        assert_eq!(rows.len(), 1);
        rows.remove(0)
    }

    fn largest_of(by_chance: f64) -> Largest {
        Largest { at: 3, value: 0.4, curve: vec![(-2.0, 0.2), (0.0, 0.4), (2.0, 0.6)], by_chance }
    }

    #[test]
    fn the_largest_residual_is_stated_where_chance_does_not_explain_it() {
        let mut line = found(&RATES, &[0.0; 5]);
        let per_hour = |rate: f64| line_note(rate);
        line.largest = Some(largest_of(0.01));
        let shown = row(&SCALE_FACTOR_NONLINEARITY, &line);
        shows(&shown, 1600.0, METHOD);
        assert_eq!(curve(&shown)[0], (-2.0, 800.0));
        near(curve(&shown)[2].1, 2400.0);
        assert_eq!(told(&shown, "on_table.largest_at", "rate"), &per_hour(100.0));
        // By chance in one test of fifty: 0.4 + 0.2·1.645/2 at most.
        line.largest = Some(largest_of(0.02));
        withholds(&row(&SCALE_FACTOR_NONLINEARITY, &line), Some(4000.0 * 0.564_485_362_695_147_2), METHOD);
        line.largest = None;
        let none = row(&SCALE_FACTOR_NONLINEARITY, &line);
        withholds(&none, None, METHOD);
        assert_eq!(notes(&none), ["on_table.few_levels", "on_table.largest_at"]);
    }

    fn line_note(rate: f64) -> Arg {
        crate::units::RateUnit::up_to(200.0).figures(rate, 4)
    }

    #[test]
    fn the_largest_residual_of_the_rate_is_relative_to_the_factor_alone() {
        let mut line = found(&RATES, &[0.0; 5]);
        line.largest_of_rate = Some((Largest { value: 2e-3, ..largest_of(0.005) }, -200.0));
        let shown = row(&SCALE_FACTOR_NONLINEARITY_OF_RATE, &line);
        shows(&shown, 1600.0, METHOD);
        assert_eq!(told(&shown, "on_table.largest_at", "rate"), &line_note(-200.0));
    }

    #[test]
    fn the_rms_of_the_residuals_has_the_noise_taken_out() {
        let mut line = found(&RATES, &[0.0; 5]);
        let levels = |of: [f64; 5], u: f64| of.map(|r| (r, u)).to_vec();
        (line.levels, line.covariance) = (levels([3.0, -1.0, 2.0, 0.0, -4.0], 0.2), diagonal(&[0.04; 5]));
        line.covariance[(0, 1)] = 0.01;
        line.covariance[(1, 0)] = 0.01;
        // Mean square 6 less 0.04; Var Σr² = 4 rᵀCr + 2 ΣC² with rᵀCr = 0.04·30 − 2·0.03.
        let standard = (4.0f64 * 1.14 + 2.0 * (5.0 * 0.0016 + 2.0 * 1e-4)).sqrt() / 5.0;
        let shown = row(&SCALE_FACTOR_RESIDUAL, &line);
        shows(&shown, 4000.0 * 5.96f64.sqrt(), METHOD);
        let points = curve(&shown);
        assert_eq!((points.len(), points[0].0, points[24].0), (25, -3.0, 3.0));
        near(points[0].1, 4000.0 * (5.96 - 3.0 * standard).sqrt());
        near(points[16].1, 4000.0 * (5.96 + standard).sqrt());
        // Not clear of zero: 0.8 − 0.5 with a deviation of √(4·0.5·4 + 2·5·0.25)/5.
        (line.levels, line.covariance) =
            (levels([1.0, -1.0, 1.0, -1.0, 0.0], 0.5f64.sqrt()), diagonal(&[0.5; 5]));
        let limit = 4000.0 * (0.3 + SCORE_ONE_SIDED_95 * 10.5f64.sqrt() / 5.0).sqrt();
        withholds(&row(&SCALE_FACTOR_RESIDUAL, &line), Some(limit), METHOD);
        // Less than its noise: √(2·5·0.25)/5 above nothing.
        line.levels = levels([0.0; 5], 0.5f64.sqrt());
        let limit = 4000.0 * (SCORE_ONE_SIDED_95 * 2.5f64.sqrt() / 5.0).sqrt();
        withholds(&row(&SCALE_FACTOR_RESIDUAL, &line), Some(limit), METHOD);
    }

    #[test]
    fn terms_of_a_polynomial_are_those_at_full_scale() {
        // 0.1 + 0.2 x + 0.7 x² − 0.3 x³ of full scale.
        let x = [-1.0f64, -0.5, 0.0, 0.5, 1.0];
        let line = found(&RATES, &x.map(|x| 0.1 + 0.2 * x + 0.7 * x * x - 0.3 * x.powi(3)));
        let (odd, even) = (row(&SCALE_FACTOR_ODD, &line), row(&SCALE_FACTOR_EVEN, &line));
        shows(&even, -2800.0, METHOD);
        shows(&odd, 1200.0, METHOD);
        // Σx² = 2.5, Σx⁴ = 2.125, Σx⁶ = 2.03125: variances 5/(5·2.125 − 2.5²) and 2.5/(2.5·2.03125 − 2.125²) of a level's.
        near(student(&even).0, 400.0 * (5.0f64 / 4.375).sqrt());
        near(student(&odd).0, 400.0 * (2.5f64 / 0.5625).sqrt());
        let four = found(&RATES[..4], &[0.0; 4]);
        let none = row(&SCALE_FACTOR_ODD, &four);
        withholds(&none, None, METHOD);
        assert_eq!(notes(&none), ["on_table.few_levels"]);
    }

    #[test]
    fn asymmetry_is_the_difference_of_the_slopes_of_both_signs() {
        // 3e-3 of positive rates and 1e-3 of negative ones beyond the line, over a factor of −1.25.
        let means = RATES.map(|r| 2.0 + if r > 0.0 { 3e-3 * r } else { 1e-3 * r });
        let shown = row(&SCALE_FACTOR_ASYMMETRY, &found(&RATES, &means));
        shows(&shown, -1600.0, METHOD);
        // Half the difference is the slope over |x|, Σ(|x| − 120)² = 28000.
        near(student(&shown).0, 8e5 * (4.0f64 * 0.01 / 28_000.0).sqrt());
        // Three levels with one of each sign are enough.
        shows(
            &row(&SCALE_FACTOR_ASYMMETRY, &found(&[-100.0, 0.0, 50.0], &[-0.1, 0.0, 0.2])),
            -2400.0,
            METHOD,
        );
        for rates in
            [[100.0, 150.0, 200.0], [-200.0, -150.0, -100.0], [-1e-5, 100.0, 200.0], [-200.0, -100.0, 1e-5]]
        {
            let none = row(&SCALE_FACTOR_ASYMMETRY, &found(&rates, &[0.0; 3]));
            withholds(&none, None, METHOD);
            assert_eq!(notes(&none), ["on_table.one_sign"]);
        }
        withholds(&row(&SCALE_FACTOR_ASYMMETRY, &found(&[-100.0, 100.0], &[0.0; 2])), None, METHOD);
    }
}
