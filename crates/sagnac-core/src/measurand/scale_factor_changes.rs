//! What the scale factor changes by: between cycles, with the direction of approach, with temperature.

use super::descriptor::{Measurand, Stimulus};
use super::evidence::TableEvidence;
use super::scale_factor_over_temperature;
use super::scale_factor_shape::of_line;
use super::sine_response;
use crate::estimate::{Estimate, Spread};
use crate::message::{Arg, note};
use crate::rate_table::combine::spread;
use crate::rate_table::design::Extra;
use crate::rate_table::design::slope_of;
use crate::rate_table::scale_factor::{METHOD, ScaleFactor};
use crate::rate_table::steps::Steps;

/// Scatter of the scale factor between cycles.
pub static SCALE_FACTOR_REPEATABILITY: Measurand = Measurand::of_steps(
    "scale_factor_repeatability",
    "ppm",
    "spread between repeated runs",
    Stimulus::Rates,
    |m, e| of_line(e, |line| repeatability(m, line, e.steps)),
);

/// Difference between rates reached from below and above.
pub static SCALE_FACTOR_HYSTERESIS: Measurand = Measurand::of_steps(
    "scale_factor_hysteresis",
    "ppm",
    "difference between rates reached from below and above",
    Stimulus::Rates,
    |m, e| of_line(e, |line| hysteresis(m, line)),
)
.extras(&[Extra::Approach])
.signed();

/// Change of the scale factor with temperature.
pub static SCALE_FACTOR_TEMPERATURE_SENSITIVITY: Measurand = Measurand::of_steps(
    "scale_factor_temperature_sensitivity",
    "ppm/degC",
    "change of scale factor with temperature",
    Stimulus::Rates,
    |m, e| {
        if e.setup.sine {
            return vec![sine_response::temperature_sensitivity(m, e)];
        }
        match &e.over_temperature {
            Some(soaks) => vec![scale_factor_over_temperature::slope(m, e, soaks)],
            None => of_line(e, |line| temperature_sensitivity(m, line, e)),
        }
    },
)
.extras(&[Extra::BiasOverTemperature, Extra::ScaleOverTemperature])
.also_called(&["sf_temperature_coefficient", "sf_temperature_sensitivity", "sf_tc"])
.signed();

/// Standard deviation of the scale factors of single cycles.
fn repeatability(m: &Measurand, line: &ScaleFactor, steps: &Steps) -> Estimate {
    const METHOD: &str = "cycle_scatter";
    let mut factors = Vec::new();
    for cycle in 0..steps.cycles {
        let (mut x, mut y) = (vec![], vec![]);
        for r in line.steps.iter().filter(|r| steps.list[r.step].cycle == cycle) {
            let rate = steps.list[r.step].rate;
            x.push(rate);
            y.push(r.residual + line.bias + line.factor * rate);
        }
        if x.len() >= 2
            && let Some(slope) = slope_of(&x, &y)
        {
            factors.push(slope);
        }
    }
    let n = factors.len();
    if n < 2 {
        return m.not_identifiable(&line.channel, None, METHOD).note(note!("on_table.one_cycle"));
    }
    let mean = factors.iter().sum::<f64>() / n as f64;
    let s2 = factors.iter().map(|f| (f - mean) * (f - mean)).sum::<f64>() / (n - 1) as f64;
    let value = 1e6 * s2.sqrt() / line.factor.abs();
    m.measured(&line.channel, value, Spread::ChiSquare { dof: (n - 1) as f64 }, METHOD)
        .note(note!("on_table.cycles", n))
}

fn hysteresis(m: &Measurand, line: &ScaleFactor) -> Estimate {
    // The coefficient is half the gap.
    let Some(half) = line.response.extra(Extra::Approach) else {
        return m.not_identifiable(&line.channel, None, METHOD).note(note!("on_table.one_approach"));
    };
    let ppm = line.ppm_of_full_scale();
    m.measured(&line.channel, 2.0 * half.value * ppm, spread(&half, 2.0 * ppm.abs(), &[]), METHOD)
}

fn temperature_sensitivity(m: &Measurand, line: &ScaleFactor, e: &TableEvidence<'_>) -> Estimate {
    let Some(slope) = line.response.extra(Extra::ScaleOverTemperature) else {
        return m.not_identifiable(&line.channel, None, METHOD).note(note!("on_table.no_temperature_range"));
    };
    let range = line.response.temperature_range.max(1e-9);
    let reading = [e.setup.of_thermometer(std::f64::consts::SQRT_2 / range * slope.value)];
    m.measured(&line.channel, slope.value, spread(&slope, 1.0, &reading), METHOD)
        .components(&reading)
        .note(note!("on_table.temperature_range", range = Arg::figures(range, 3)))
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{
        chi_square, diagonal, line, near, notes, number, on_table, shows, steps, student, withholds,
    };
    use super::*;
    use crate::rate_table::Setup;
    use crate::rate_table::scale_factor::StepResidual;

    fn row(m: &Measurand, setup: &Setup, steps: &Steps, line: &ScaleFactor) -> Estimate {
        let mut rows = m.evaluate_steps(&on_table(setup, steps, Some(line.clone())));
        assert_eq!(rows.len(), 1);
        rows.remove(0)
    }

    /// A factor of −2 and a full scale of 125 deg/h: 1 deg/h is −4000 ppm of full scale.
    fn found(extras: &[Extra], coefficients: &[f64], variances: &[f64]) -> (Steps, ScaleFactor) {
        let means = [&[0.0; 3], coefficients].concat();
        let covariance = diagonal(&[&[0.0; 3], variances].concat());
        let (steps, mut line) = line(&[-100.0, 0.0, 100.0], &means, extras, covariance);
        (line.factor, line.full_scale, line.bias) = (-2.0, 125.0, 5.0);
        line.response.temperature_range = 40.0;
        (steps, line)
    }

    /// Residuals of steps in cycles: slopes of so many 1e-3 about that of the line, by the rates of each cycle.
    fn residuals(steps: &Steps, slopes: &[f64]) -> Vec<StepResidual> {
        let one = |(i, s): (usize, &crate::rate_table::steps::Step)| StepResidual {
            step: i,
            residual: 1e-3 * slopes[s.cycle] * s.rate + s.cycle as f64,
            standard: 0.1,
        };
        steps.list.iter().enumerate().map(one).collect()
    }

    #[test]
    fn repeatability_is_the_deviation_of_the_slopes_of_cycles() {
        let (_, mut line) = found(&[], &[], &[]);
        let setup = Setup::default();
        let steps_of = |cycles: usize| {
            let rates: Vec<f64> = (0..3 * cycles).map(|i| [-100.0, 20.0, 100.0][i % 3]).collect();
            steps(&rates, &rates, 3)
        };
        let three = steps_of(3);
        line.steps = residuals(&three, &[3.0, 1.0, 2.0]);
        let found = row(&SCALE_FACTOR_REPEATABILITY, &setup, &three, &line);
        // 1e-3 of a factor of 2.
        shows(&found, 500.0, "cycle_scatter");
        assert_eq!((chi_square(&found), number(&found, "on_table.cycles", "n")), (2.0, 3.0));
        let two = steps_of(2);
        line.steps = residuals(&two, &[3.0, 1.0]);
        shows(&row(&SCALE_FACTOR_REPEATABILITY, &setup, &two, &line), 500.0 * 2f64.sqrt(), "cycle_scatter");
        let one = steps_of(1);
        line.steps = residuals(&one, &[3.0]);
        let none = row(&SCALE_FACTOR_REPEATABILITY, &setup, &one, &line);
        withholds(&none, None, "cycle_scatter");
        assert_eq!(notes(&none), ["on_table.one_cycle"]);
    }

    #[test]
    fn hysteresis_is_twice_the_coefficient_of_the_approach() {
        let setup = Setup::default();
        let (steps, line) = found(&[Extra::Approach], &[0.02], &[9e-6]);
        let shown = row(&SCALE_FACTOR_HYSTERESIS, &setup, &steps, &line);
        shows(&shown, -160.0, METHOD);
        near(student(&shown).0, 24.0);
        let (steps, line) = found(&[], &[], &[]);
        let none = row(&SCALE_FACTOR_HYSTERESIS, &setup, &steps, &line);
        withholds(&none, None, METHOD);
        assert_eq!(notes(&none), ["on_table.one_approach"]);
    }

    #[test]
    fn the_sensitivity_to_temperature_has_the_reading_of_both_ends() {
        let setup = Setup { temperature_uncertainty_deg_c: 0.5, ..Setup::default() };
        let (steps, line) = found(&[Extra::ScaleOverTemperature], &[-8.0], &[0.01]);
        let shown = row(&SCALE_FACTOR_TEMPERATURE_SENSITIVITY, &setup, &steps, &line);
        shows(&shown, -8.0, METHOD);
        // √2·0.5/40 of 8 is √0.02.
        near(student(&shown).0, 0.03f64.sqrt());
        near(number(&shown, "on_table.temperature_range", "range"), 40.0);
        let (steps, line) = found(&[], &[], &[]);
        let none = row(&SCALE_FACTOR_TEMPERATURE_SENSITIVITY, &setup, &steps, &line);
        withholds(&none, None, METHOD);
        assert_eq!(notes(&none), ["on_table.no_temperature_range"]);
    }
}
