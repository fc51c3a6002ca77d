//! What the scale factor changes by: between cycles, with the direction of approach, with temperature.

use super::descriptor::{Measurand, Stimulus};
use super::evidence::TableEvidence;
use super::scale_factor_shape::of_line;
use super::sine_response;
use crate::estimate::{Estimate, Spread};
use crate::message::{Arg, Note};
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
        of_line(e, |line| temperature_sensitivity(m, line, e))
    },
)
.extras(&[Extra::BiasOverTemperature, Extra::ScaleOverTemperature])
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
        return m.not_identifiable(&line.channel, None, METHOD).note(Note::new("on_table.one_cycle"));
    }
    let mean = factors.iter().sum::<f64>() / n as f64;
    let s2 = factors.iter().map(|f| (f - mean) * (f - mean)).sum::<f64>() / (n - 1) as f64;
    let value = 1e6 * s2.sqrt() / line.factor.abs();
    m.measured(&line.channel, value, Spread::ChiSquare { dof: (n - 1) as f64 }, METHOD)
        .note(Note::new("on_table.cycles").with("n", n))
}

fn hysteresis(m: &Measurand, line: &ScaleFactor) -> Estimate {
    // The coefficient is half the gap.
    let Some(half) = line.response.extra(Extra::Approach) else {
        return m.not_identifiable(&line.channel, None, METHOD).note(Note::new("on_table.one_approach"));
    };
    let ppm = line.ppm_of_full_scale();
    m.measured(&line.channel, 2.0 * half.value * ppm, spread(&half, 2.0 * ppm.abs(), &[]), METHOD)
}

fn temperature_sensitivity(m: &Measurand, line: &ScaleFactor, e: &TableEvidence<'_>) -> Estimate {
    let Some(slope) = line.response.extra(Extra::ScaleOverTemperature) else {
        return m
            .not_identifiable(&line.channel, None, METHOD)
            .note(Note::new("on_table.no_temperature_range"));
    };
    let range = line.response.temperature_range.max(1e-9);
    let reading =
        std::f64::consts::SQRT_2 * e.setup.temperature_uncertainty_deg_c / range * slope.value.abs();
    m.measured(&line.channel, slope.value, spread(&slope, 1.0, &[reading]), METHOD)
        .note(Note::new("on_table.temperature_range").with("range", Arg::figures(range, 3)))
}
