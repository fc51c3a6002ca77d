//! Scale factor and what belongs to it, from a series of steps.
//!
//! The line is that of least squares through the means of the levels, each with the same weight. K is output per input;
//! outputs are read with the nominal scale factor of the procedure, so that K = 1 is a unit that is just as stated.

use super::combine::spread;
use super::largest::{Largest, largest};
use super::model::{Extra, Response};
use super::steps::Steps;
use super::{Setup, TableRun, model};
use crate::estimate::{Estimate, Spread, UpperLimit};
use crate::message::{Arg, Note};
use crate::numeric::reml::Combination;
use crate::units::RateUnit;
use nalgebra::{DMatrix, DVector};

/// Ids that this evaluation gives.
pub const IDS: &[&str] = &[
    "scale_factor",
    "scale_factor_error",
    "scale_factor_bias",
    "scale_factor_nonlinearity",
    "scale_factor_nonlinearity_of_rate",
    "scale_factor_residual",
    "scale_factor_asymmetry",
    "scale_factor_odd",
    "scale_factor_even",
    "scale_factor_repeatability",
    "scale_factor_hysteresis",
    "scale_factor_temperature_sensitivity",
    "table_harmonic_1",
    "table_harmonic_2",
];

/// Method of every value here.
const METHOD: &str = "table_levels";

/// Probability of a largest residual by chance above which it is not claimed. It rests on a noise that the same test tells,
/// and of what is claimed by chance no interval holds the truth: a twentieth is claimed at twice that and more.
const CLAIMED_BELOW: f64 = 0.01;

/// One step against the line.
#[derive(Debug, Clone, PartialEq)]
pub struct StepResidual {
    /// Position of the step in [`Steps::list`].
    pub step: usize,
    /// Output about the line, deg/h.
    pub residual: f64,
    /// Standard uncertainty of it, deg/h.
    pub standard: f64,
}

/// A channel evaluated.
#[derive(Debug, Clone)]
pub struct ScaleFactor {
    /// Channel.
    pub channel: String,
    /// Its response.
    pub response: Response,
    /// Scale factor, output per input.
    pub factor: f64,
    /// Bias of the line, deg/h, the Earth rate included.
    pub bias: f64,
    /// Full scale, deg/h.
    pub full_scale: f64,
    /// Residual of each level about the line, deg/h, with its standard uncertainty.
    pub levels: Vec<(f64, f64)>,
    /// Each step about the line.
    pub steps: Vec<StepResidual>,
    /// Unit of the scale factor and output units in one deg/h of input at K = 1.
    pub as_recorded: (&'static str, f64),
    largest: Option<Largest>,
    largest_of_rate: Option<(Largest, f64)>,
    line: DMatrix<f64>,
    /// Covariance of the residuals of the levels, (deg/h)².
    covariance: DMatrix<f64>,
}

/// The extras that the wanted measurands need.
fn extras(wanted: &dyn Fn(&str) -> bool, run: &TableRun) -> Vec<Extra> {
    let mut list = Vec::new();
    if wanted("scale_factor_hysteresis") {
        list.push(Extra::Approach);
    }
    if wanted("scale_factor_temperature_sensitivity") && run.blocks.has_temperature {
        list.extend([Extra::BiasOverTemperature, Extra::ScaleOverTemperature]);
    }
    for (id, order) in [("table_harmonic_1", 1), ("table_harmonic_2", 2)] {
        if wanted(id) && run.blocks.has_angle {
            list.extend([Extra::Cosine(order), Extra::Sine(order)]);
        }
    }
    list
}

/// Evaluates a channel; `None` when the steps do not give a line. `as_recorded` is the unit of the scale factor with the
/// factor from K.
pub fn evaluate(
    run: &TableRun,
    channel: usize,
    setup: &Setup,
    as_recorded: (&'static str, f64),
    wanted: &dyn Fn(&str) -> bool,
) -> Option<ScaleFactor> {
    let response = model::fit(&run.steps, channel, setup, &extras(wanted, run))?;
    let l = response.levels.len();
    let a = DMatrix::from_fn(l, 2, |i, j| if j == 0 { 1.0 } else { response.levels[i] });
    let line = (a.transpose() * &a).try_inverse()? * a.transpose();
    let means = DVector::from_vec(response.level_means());
    let fitted = &line * &means;
    let rest = DMatrix::identity(l, l) - &a * &line;
    let residuals = &rest * &means;
    let covariance = &rest * response.level_covariance() * rest.transpose();
    let factor = response.slope + fitted[1];
    let full_scale = setup
        .full_scale_deg_h
        .unwrap_or_else(|| response.levels.iter().fold(0.0, |m: f64, r| m.max(r.abs())));
    let dof = |level: usize| {
        let weights: Vec<f64> = rest.row(level).iter().copied().collect();
        response.of_levels(&weights).dof
    };
    let found = largest(residuals.as_slice(), &covariance, &dof);
    let from = setup.of_rate_from_deg_h.unwrap_or(0.1 * full_scale) * 0.995;
    let high: Vec<usize> = (0..l).filter(|i| response.levels[*i].abs() >= from && from > 0.0).collect();
    let of_rate = {
        let scale = |i: usize| 1.0 / response.levels[high[i]].abs();
        let values: Vec<f64> = (0..high.len()).map(|i| residuals[high[i]] * scale(i)).collect();
        let c = DMatrix::from_fn(high.len(), high.len(), |i, j| {
            covariance[(high[i], high[j])] * scale(i) * scale(j)
        });
        largest(&values, &c, &|i| dof(high[i])).map(|found| {
            let rate = response.levels[high[found.at]];
            (found, rate)
        })
    };
    let levels =
        (0..l).map(|i| (residuals[i], covariance[(i, i)].max(0.0).sqrt())).collect::<Vec<(f64, f64)>>();
    let steps = step_residuals(&run.steps, &response, &levels);
    Some(ScaleFactor {
        channel: run.blocks.gyros.get(channel)?.clone(),
        factor,
        bias: fitted[0],
        full_scale,
        levels,
        steps,
        as_recorded,
        largest: found,
        largest_of_rate: of_rate,
        line,
        covariance,
        response,
    })
}

/// Steps about the line: the residual of their level, and what is left of their own rows.
fn step_residuals(steps: &Steps, response: &Response, levels: &[(f64, f64)]) -> Vec<StepResidual> {
    let mut seen: Vec<usize> = steps.list.iter().map(|s| s.level).collect();
    seen.sort_unstable();
    seen.dedup();
    let mut out = Vec::new();
    for (s, step) in steps.list.iter().enumerate() {
        let own: Vec<f64> = response.rows.iter().filter(|(i, _)| *i == s).map(|(_, r)| *r).collect();
        let Some(level) = seen.iter().position(|l| *l == step.level) else { continue };
        if own.is_empty() {
            continue;
        }
        let visits = steps.list.iter().filter(|o| o.level == step.level).count() as f64;
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        out.push(StepResidual {
            step: s,
            residual: levels[level].0 + mean,
            standard: levels[level].1 * visits.sqrt(),
        });
    }
    out
}

impl ScaleFactor {
    /// Standard uncertainty of the scale factor from what scatters.
    pub fn factor_uncertainty(&self) -> f64 {
        self.of_line(1).standard
    }

    /// Output of the line where the input of the table and this rate, deg/h, cancel one another: offset and slope of the
    /// line are correlated, and near the rates of the test they hardly scatter together.
    pub fn output_without(&self, rate_deg_h: f64) -> Combination {
        let weights: Vec<f64> =
            (0..self.line.ncols()).map(|i| self.line[(0, i)] - rate_deg_h * self.line[(1, i)]).collect();
        let found = self.response.of_levels(&weights);
        Combination { value: self.bias - rate_deg_h * self.factor, ..found }
    }

    /// The estimate of one id; `None` for an id that is not given here.
    pub fn estimate(
        &self,
        id: &'static str,
        unit: &'static str,
        setup: &Setup,
        steps: &Steps,
    ) -> Option<Estimate> {
        let ppm = 1e6 / self.factor;
        let of_full_scale = 1e6 / (self.factor * self.full_scale);
        let slope = self.of_line(1);
        // Calibration of the table, its cosine with the input axis, and the thermometer.
        let temperature_slope =
            self.response.extra(Extra::ScaleOverTemperature).map_or(0.0, |c| c.value.abs());
        let alignment = setup.alignment_uncertainty_rad * setup.alignment_uncertainty_rad;
        let systematic = [
            1e6 * setup.rate_uncertainty,
            1e6 * alignment,
            temperature_slope * setup.temperature_uncertainty_deg_c,
        ];
        let measured =
            |value: f64, spread: Spread| Estimate::measured(id, &self.channel, value, unit, spread, METHOD);
        Some(match id {
            "scale_factor" => {
                let factor = self.as_recorded.1;
                let others = systematic.map(|u| u * 1e-6 * (self.factor * factor).abs());
                let mut e = measured(self.factor * factor, spread(&slope, factor.abs(), &others));
                e.unit = self.as_recorded.0;
                e.note(self.cited(setup, steps))
            }
            "scale_factor_error" => measured(
                (self.factor - 1.0) * 1e6,
                spread(&slope, 1e6, &systematic.map(|u| u * self.factor.abs())),
            ),
            "scale_factor_bias" => measured(self.bias, spread(&self.of_line(0), 1.0, &[])),
            "scale_factor_nonlinearity" => self
                .most(id, unit, self.largest.as_ref(), of_full_scale)
                .note(self.largest_at(self.largest.as_ref().map_or(0.0, |l| self.response.levels[l.at]))),
            "scale_factor_nonlinearity_of_rate" => {
                let found = self.largest_of_rate.as_ref();
                self.most(id, unit, found.map(|f| &f.0), ppm)
                    .note(self.largest_at(found.map_or(0.0, |f| f.1)))
            }
            "scale_factor_residual" => self.rms(id, unit, of_full_scale),
            "scale_factor_asymmetry" => match self.asymmetry() {
                Some((value, random)) => measured(value, spread(&random, 1e6 / self.factor.abs(), &[])),
                None => Estimate::not_identifiable(id, &self.channel, None, unit, METHOD)
                    .note(Note::new("on_table.one_sign")),
            },
            "scale_factor_odd" | "scale_factor_even" => match self.curvature() {
                Some((odd, even)) => {
                    let random = if id == "scale_factor_odd" { odd } else { even };
                    measured(random.value * of_full_scale, spread(&random, of_full_scale.abs(), &[]))
                }
                None => Estimate::not_identifiable(id, &self.channel, None, unit, METHOD)
                    .note(Note::new("on_table.few_levels")),
            },
            "scale_factor_repeatability" => self.repeatability(id, unit, steps),
            "scale_factor_hysteresis" => match self.response.extra(Extra::Approach) {
                // The coefficient is half the gap.
                Some(half) => {
                    measured(2.0 * half.value * of_full_scale, spread(&half, 2.0 * of_full_scale.abs(), &[]))
                }
                None => Estimate::not_identifiable(id, &self.channel, None, unit, METHOD)
                    .note(Note::new("on_table.one_approach")),
            },
            "scale_factor_temperature_sensitivity" => {
                match self.response.extra(Extra::ScaleOverTemperature) {
                    Some(slope) => {
                        let range = self.response.temperature_range.max(1e-9);
                        let reading = std::f64::consts::SQRT_2 * setup.temperature_uncertainty_deg_c / range
                            * slope.value.abs();
                        measured(slope.value, spread(&slope, 1.0, &[reading])).note(
                            Note::new("on_table.temperature_range").with("range", Arg::figures(range, 3)),
                        )
                    }
                    None => Estimate::not_identifiable(id, &self.channel, None, unit, METHOD)
                        .note(Note::new("on_table.no_temperature_range")),
                }
            }
            "table_harmonic_1" => self.harmonic(id, unit, 1),
            "table_harmonic_2" => self.harmonic(id, unit, 2),
            _ => return None,
        })
    }

    /// Bias (0) or slope about the fitted one (1) of the line.
    fn of_line(&self, row: usize) -> Combination {
        let weights: Vec<f64> = self.line.row(row).iter().copied().collect();
        self.response.of_levels(&weights)
    }

    /// What stands behind the scale factor: levels, steps, cycles, whether from the angle.
    fn cited(&self, setup: &Setup, steps: &Steps) -> Note {
        let key = if setup.by_angle { "on_table.from_angle" } else { "on_table.from_rate" };
        Note::new(key)
            .with("steps", steps.list.len())
            .with("levels", self.response.levels.len())
            .with("cycles", steps.cycles)
    }

    /// The largest residual, or its bound where chance explains it.
    /// Unit that the rates of the table read well in.
    pub fn rate_unit(&self) -> RateUnit {
        RateUnit::up_to(self.response.levels.iter().fold(0.0, |m: f64, l| m.max(l.abs())))
    }

    fn largest_at(&self, rate_deg_h: f64) -> Note {
        Note::new("on_table.largest_at").with("rate", self.rate_unit().figures(rate_deg_h, 4))
    }

    fn most(&self, id: &'static str, unit: &'static str, found: Option<&Largest>, factor: f64) -> Estimate {
        let Some(found) = found else {
            return Estimate::not_identifiable(id, &self.channel, None, unit, METHOD)
                .note(Note::new("on_table.few_levels"));
        };
        let factor = factor.abs();
        let curve: Vec<(f64, f64)> = found.curve.iter().map(|(z, v)| (*z, v * factor)).collect();
        let spread = Spread::Curve(curve);
        if found.by_chance > CLAIMED_BELOW {
            let bound =
                spread.bound(found.value * factor, 0.95).map(|value| UpperLimit { value, coverage: 0.95 });
            return Estimate::not_identifiable(id, &self.channel, bound, unit, METHOD);
        }
        Estimate::measured(id, &self.channel, found.value * factor, unit, spread, METHOD)
    }

    /// Root mean square of the residuals of the levels without what noise adds to it.
    fn rms(&self, id: &'static str, unit: &'static str, factor: f64) -> Estimate {
        let n = self.levels.len() as f64;
        let observed = self.levels.iter().map(|(r, _)| r * r).sum::<f64>() / n;
        let noise = self.levels.iter().map(|(_, u)| u * u).sum::<f64>() / n;
        // Variance of a sum of squares of correlated values.
        let r = DVector::from_iterator(self.levels.len(), self.levels.iter().map(|l| l.0));
        let c = &self.covariance;
        let cross = 4.0 * r.dot(&(c * &r)) + 2.0 * c.component_mul(c).sum();
        let standard = cross.max(0.0).sqrt() / n;
        let truth = observed - noise;
        let factor = factor.abs();
        let root = |v: f64| v.max(0.0).sqrt() * factor;
        if truth <= 1.645 * standard {
            let value = root(truth.max(0.0) + 1.645 * standard);
            return Estimate::not_identifiable(
                id,
                &self.channel,
                Some(UpperLimit { value, coverage: 0.95 }),
                unit,
                METHOD,
            );
        }
        let curve =
            (-12..=12).map(|z| 0.25 * f64::from(z)).map(|z| (z, root(truth + z * standard))).collect();
        Estimate::measured(id, &self.channel, root(truth), unit, Spread::Curve(curve), METHOD)
    }

    /// ε = (K₊ − K₋)/K from slopes of both signs with one intercept, ppm.
    fn asymmetry(&self) -> Option<(f64, Combination)> {
        let levels = &self.response.levels;
        let signs = |s: f64| levels.iter().filter(|r| *r * s > 1e-6 * self.full_scale).count();
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
        let random = self.response.of_levels(&weights);
        Some((1e6 * random.value / self.factor, random))
    }

    /// Cubic and quadratic term at full scale, deg/h, of a polynomial of third order.
    fn curvature(&self) -> Option<(Combination, Combination)> {
        let levels = &self.response.levels;
        if levels.len() < 5 {
            return None;
        }
        let a = DMatrix::from_fn(levels.len(), 4, |i, j| (levels[i] / self.full_scale).powi(j as i32));
        let h = (a.transpose() * &a).try_inverse()? * a.transpose();
        let row = |r: usize| h.row(r).iter().copied().collect::<Vec<f64>>();
        Some((self.response.of_levels(&row(3)), self.response.of_levels(&row(2))))
    }

    /// Standard deviation of the scale factors of single cycles.
    fn repeatability(&self, id: &'static str, unit: &'static str, steps: &Steps) -> Estimate {
        let mut factors = Vec::new();
        for cycle in 0..steps.cycles {
            let (mut x, mut y) = (vec![], vec![]);
            for r in self.steps.iter().filter(|r| steps.list[r.step].cycle == cycle) {
                let rate = steps.list[r.step].rate;
                x.push(rate);
                y.push(r.residual + self.bias + self.factor * rate);
            }
            if x.len() >= 2
                && let Some(slope) = super::design::slope_of(&x, &y)
            {
                factors.push(slope);
            }
        }
        let n = factors.len();
        if n < 2 {
            return Estimate::not_identifiable(id, &self.channel, None, unit, "cycle_scatter")
                .note(Note::new("on_table.one_cycle"));
        }
        let mean = factors.iter().sum::<f64>() / n as f64;
        let s2 = factors.iter().map(|f| (f - mean) * (f - mean)).sum::<f64>() / (n - 1) as f64;
        let value = 1e6 * s2.sqrt() / self.factor.abs();
        let dof = (n - 1) as f64;
        Estimate::measured(id, &self.channel, value, unit, Spread::ChiSquare { dof }, "cycle_scatter")
            .note(Note::new("on_table.cycles").with("n", n))
    }

    /// Amplitude of an error over a turn.
    fn harmonic(&self, id: &'static str, unit: &'static str, order: u8) -> Estimate {
        let parts = self.response.extra(Extra::Cosine(order)).zip(self.response.extra(Extra::Sine(order)));
        let Some((cosine, sine)) = parts else {
            return Estimate::not_identifiable(id, &self.channel, None, unit, "table_harmonic")
                .note(Note::new("on_table.no_harmonic"));
        };
        let amplitude = cosine.value.hypot(sine.value);
        let covariance = self.response.covariance_of(Extra::Cosine(order), Extra::Sine(order));
        let standard = ((cosine.value * cosine.standard).powi(2)
            + (sine.value * sine.standard).powi(2)
            + 2.0 * cosine.value * sine.value * covariance)
            .max(0.0)
            .sqrt()
            / amplitude.max(f64::MIN_POSITIVE);
        let chance = 0.5 * (cosine.standard.powi(2) + sine.standard.powi(2));
        // Square of the distance from none in standard deviations.
        let determinant = (cosine.standard * sine.standard).powi(2) - covariance * covariance;
        let distance = ((cosine.value * sine.standard).powi(2) + (sine.value * cosine.standard).powi(2)
            - 2.0 * cosine.value * sine.value * covariance)
            / determinant.max(f64::MIN_POSITIVE);
        // By chance alone it is as large once in a hundred tests.
        if distance < 2.0 * 100f64.ln() {
            let value = amplitude + 1.645 * chance.sqrt();
            return Estimate::not_identifiable(
                id,
                &self.channel,
                Some(UpperLimit { value, coverage: 0.95 }),
                unit,
                "table_harmonic",
            );
        }
        let random = Combination { value: amplitude, standard, dof: cosine.dof.min(sine.dof) };
        let phase = sine.value.atan2(cosine.value).to_degrees();
        Estimate::measured(id, &self.channel, amplitude, unit, spread(&random, 1.0, &[]), "table_harmonic")
            .note(Note::new("on_table.phase").with("phase", Arg::figures(phase, 3)))
    }
}
