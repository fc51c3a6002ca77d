//! The quantities of a target: name and unit there, what of the result each stands for, and its conversion.

use super::axis::{Axis, Level};
use super::form::{allan_deviation, one_process, smallest_deviation};
use crate::measurand::{
    ANGLE_RANDOM_WALK, BIAS_INSTABILITY, BIAS_TEMPERATURE_SENSITIVITY, Measurand, RATE_RANDOM_WALK,
    SCALE_FACTOR_TEMPERATURE_SENSITIVITY, STATIC_BIAS,
};
use std::f64::consts::PI;

/// deg/h in rad/s.
const DEG_H: f64 = PI / 180.0 / 3600.0;
/// deg/√h in rad/s/√Hz.
const DEG_RT_H: f64 = PI / 180.0 / 60.0;
/// deg/h/√h in rad/s²/√Hz.
const DEG_H_RT_H: f64 = PI / 180.0 / 3600.0 / 60.0;
/// ppm in percent.
const PPM: f64 = 1e-4;
/// Averaging time of the deviation that `imu_utils` takes for white noise, s.
const ONE_SECOND: f64 = 1.0;
/// Factor by which ArduPilot's coefficients of temperature are written larger.
const ARDUPILOT_SCALE: f64 = 1e6;

/// What of a result a quantity stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// Angle random walk.
    White,
    /// Flicker coefficient.
    Flicker,
    /// Rate random walk.
    RandomWalk,
    /// Static bias.
    Bias,
    /// Temperature sensitivity of the bias.
    TemperatureSensitivity,
    /// Temperature sensitivity of the scale factor.
    ScaleFactorTemperature,
    /// The one process that stands for the slow noise.
    SlowProcess,
    /// The Allan deviation of everything measured.
    Deviation,
    /// The step of the target, which no result decides.
    Step,
}

impl Source {
    /// The measurand whose row it is, and the level of an axis; `None` where several rows decide, or none.
    pub fn row(self, axis: &Axis) -> Option<(&'static Measurand, Level)> {
        match self {
            Source::White => Some((&ANGLE_RANDOM_WALK, axis.white)),
            Source::Flicker => Some((&BIAS_INSTABILITY, axis.flicker)),
            Source::RandomWalk => Some((&RATE_RANDOM_WALK, axis.random_walk)),
            Source::Bias => Some((&STATIC_BIAS, axis.bias)),
            Source::TemperatureSensitivity => {
                Some((&BIAS_TEMPERATURE_SENSITIVITY, axis.temperature_sensitivity))
            }
            Source::ScaleFactorTemperature => {
                Some((&SCALE_FACTOR_TEMPERATURE_SENSITIVITY, axis.scale_factor_temperature))
            }
            Source::SlowProcess | Source::Deviation | Source::Step => None,
        }
    }
}

/// One quantity of a target.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    /// Name in the file. `#` stands for the axis; without it, formats that do not write axes take the worst of them.
    pub name: &'static str,
    /// Unit in the file.
    pub unit: &'static str,
    /// What it stands for.
    pub source: Source,
    /// The value for an axis and a step of the target in s; `None` where the result does not state it.
    pub of: fn(&Axis, f64) -> Option<f64>,
}

/// White noise as a density.
pub const fn density(name: &'static str) -> Quantity {
    Quantity {
        name,
        unit: "rad/s/√Hz",
        source: Source::White,
        of: |axis, _| Some(axis.white.used()? * DEG_RT_H),
    }
}

/// White noise as the standard deviation of one step.
pub const fn deviation_of_step(name: &'static str) -> Quantity {
    let of = |axis: &Axis, step_s: f64| Some(axis.white.used()? * DEG_RT_H / step_s.sqrt());
    Quantity { name, unit: "rad/s", source: Source::White, of }
}

/// White noise as a random walk of the angle.
pub const fn angle_random_walk(name: &'static str) -> Quantity {
    Quantity { name, unit: "deg/√h", source: Source::White, of: |axis, _| axis.white.used() }
}

/// Random walk of the rate as a density.
pub const fn walk_density(name: &'static str) -> Quantity {
    let of = |axis: &Axis, _| Some(axis.random_walk.used()? * DEG_H_RT_H);
    Quantity { name, unit: "rad/s²/√Hz", source: Source::RandomWalk, of }
}

/// Random walk of the rate as the standard deviation of the drift in one step, over the length of the step.
pub const fn walk_of_step(name: &'static str) -> Quantity {
    let of = |axis: &Axis, step_s: f64| Some(axis.random_walk.used()? * DEG_H_RT_H / step_s.sqrt());
    Quantity { name, unit: "rad/s²", source: Source::RandomWalk, of }
}

/// Flicker coefficient.
pub const fn flicker(name: &'static str) -> Quantity {
    Quantity {
        name,
        unit: "rad/s",
        source: Source::Flicker,
        of: |axis, _| Some(axis.flicker.used()? * DEG_H),
    }
}

/// Correlation time of the one process.
pub const fn correlation_time(name: &'static str) -> Quantity {
    let of = |axis: &Axis, _| Some(one_process(axis)?.decay_time_s);
    Quantity { name, unit: "s", source: Source::SlowProcess, of }
}

/// The one process as its standard deviation.
pub const fn process_deviation(name: &'static str) -> Quantity {
    let of = |axis: &Axis, _| Some(one_process(axis)?.rms_deg_h / 3600.0);
    Quantity { name, unit: "deg/s", source: Source::SlowProcess, of }
}

/// The one process as the density of the noise that drives it.
pub const fn process_density(name: &'static str) -> Quantity {
    let of = |axis: &Axis, _| {
        let process = one_process(axis)?;
        Some(process.rms_deg_h * DEG_H * (2.0 / process.decay_time_s).sqrt())
    };
    Quantity { name, unit: "rad/s²/√Hz", source: Source::SlowProcess, of }
}

/// The one process as what gnss-ins-sim takes for its stability: the standard deviation of the noise of a step over the length of
/// the step, with a factor 1 − step/T from step to step.
pub const fn process_of_step(name: &'static str) -> Quantity {
    let of = |axis: &Axis, step_s: f64| {
        let process = one_process(axis)?;
        let kept = 1.0 - step_s / process.decay_time_s;
        let lost = (1.0 - kept * kept).max(0.0);
        // deg/h per second of a step: the program multiplies by the step in s.
        Some(process.rms_deg_h * lost.sqrt() / step_s)
    };
    Quantity { name, unit: "deg/h", source: Source::SlowProcess, of }
}

/// Allan deviation at 1 s times the root of the sample rate.
pub const fn deviation_at_one_second(name: &'static str) -> Quantity {
    let of = |axis: &Axis, step_s: f64| {
        let deviation = allan_deviation(&axis.measured(), ONE_SECOND, axis);
        (deviation > 0.0).then(|| deviation * DEG_H / step_s.sqrt())
    };
    Quantity { name, unit: "rad/s", source: Source::Deviation, of }
}

/// Smallest Allan deviation.
pub const fn smallest_allan_deviation(name: &'static str) -> Quantity {
    let of = |axis: &Axis, _| Some(smallest_deviation(axis)? * DEG_H);
    Quantity { name, unit: "rad/s", source: Source::Deviation, of }
}

/// Static bias in deg/h.
pub const fn bias_deg_h(name: &'static str) -> Quantity {
    Quantity { name, unit: "deg/h", source: Source::Bias, of: |axis, _| axis.bias.used() }
}

/// Static bias in deg/s.
pub const fn bias_deg_s(name: &'static str) -> Quantity {
    Quantity { name, unit: "deg/s", source: Source::Bias, of: |axis, _| Some(axis.bias.used()? / 3600.0) }
}

/// Static bias in rad/s.
pub const fn bias_rad_s(name: &'static str) -> Quantity {
    Quantity { name, unit: "rad/s", source: Source::Bias, of: |axis, _| Some(axis.bias.used()? * DEG_H) }
}

/// Temperature sensitivity of the bias.
pub const fn temperature_sensitivity(name: &'static str) -> Quantity {
    let of = |axis: &Axis, _| Some(axis.temperature_sensitivity.used()? * DEG_H);
    Quantity { name, unit: "rad/s/degC", source: Source::TemperatureSensitivity, of }
}

/// Temperature sensitivity of the bias as ArduPilot writes it.
pub const fn scaled_temperature_sensitivity(name: &'static str) -> Quantity {
    let of = |axis: &Axis, _| Some(axis.temperature_sensitivity.used()? * DEG_H * ARDUPILOT_SCALE);
    Quantity { name, unit: "1e-6 rad/s/degC", source: Source::TemperatureSensitivity, of }
}

/// Temperature sensitivity of the scale factor.
pub const fn scale_factor_temperature(name: &'static str) -> Quantity {
    let of = |axis: &Axis, _| Some(axis.scale_factor_temperature.used()? * PPM);
    Quantity { name, unit: "%/degC", source: Source::ScaleFactorTemperature, of }
}

/// Rate of the steps.
pub const fn step_rate(name: &'static str) -> Quantity {
    Quantity { name, unit: "Hz", source: Source::Step, of: |_, step_s| Some(1.0 / step_s) }
}

#[cfg(test)]
mod tests {
    use super::super::axis::gauss_markov;
    use super::super::example::{record, row};
    use super::*;
    use crate::units::Unit;

    fn axis() -> Axis {
        let rows = [
            (&ANGLE_RANDOM_WALK, 0.3),
            (&BIAS_INSTABILITY, 2.0),
            (&RATE_RANDOM_WALK, 6.0),
            (&STATIC_BIAS, -7.2),
            (&BIAS_TEMPERATURE_SENSITIVITY, 3.6),
            (&SCALE_FACTOR_TEMPERATURE_SENSITIVITY, 50.0),
        ];
        Axis::all(&record(rows.map(|(m, v)| row(m, "x", v)).to_vec())).remove(0)
    }

    /// The value of a quantity for a step of 0.01 s.
    fn value(quantity: Quantity) -> f64 {
        (quantity.of)(&axis(), 0.01).unwrap()
    }

    #[test]
    fn densities_are_those_of_the_unit_system() {
        for (quantity, from, of) in [
            (density("a"), "deg/sqrt(h)", 0.3),
            (walk_density("a"), "deg/h/sqrt(h)", 6.0),
            (flicker("a"), "deg/h", 2.0),
            (bias_rad_s("a"), "deg/h", -7.2),
            (bias_deg_s("a"), "deg/h", -7.2),
        ] {
            let unit = quantity.unit.replace("√Hz", "sqrt(Hz)");
            let factor = Unit::parse(from).unwrap().factor_to(&Unit::parse(&unit).unwrap()).unwrap();
            assert!((value(quantity) / (of * factor) - 1.0).abs() < 1e-12, "{}", quantity.unit);
        }
    }

    #[test]
    fn values_of_a_step_give_the_variance_of_the_step() {
        // N over a step is σ of the angle N√dt: dt times the deviation of the step.
        let angle = 0.01 * value(deviation_of_step("a"));
        assert!((angle / (value(density("a")) * 0.1) - 1.0).abs() < 1e-12);
        let drift = 0.01 * value(walk_of_step("a"));
        assert!((drift / (value(walk_density("a")) * 0.1) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn each_form_of_the_one_process_has_its_standard_deviation() {
        let mut axis = axis();
        axis.markov = vec![gauss_markov(3600.0, 20.0)];
        let of = |q: Quantity| (q.of)(&axis, 0.01).unwrap();
        assert!((of(process_deviation("a")) - 1.0).abs() < 1e-12);
        // σ² = q²T/2.
        let rms = of(process_density("a")) * (20.0_f64 / 2.0).sqrt();
        assert!((rms / (PI / 180.0) - 1.0).abs() < 1e-12);
        // σ² = b²/(1 − a²) of x' = a x + b w, with b in deg/h.
        let (a, b) = (1.0 - 0.01 / 20.0_f64, 0.01 * of(process_of_step("a")));
        assert!((b / (1.0 - a * a).sqrt() / 3600.0 - 1.0).abs() < 1e-9);
        assert_eq!(of(correlation_time("a")), 20.0);
    }

    #[test]
    fn coefficients_of_temperature_have_the_scales_of_their_targets() {
        let slope = 0.001 * PI / 180.0;
        assert!((value(temperature_sensitivity("a")) / slope - 1.0).abs() < 1e-12);
        assert!((value(scaled_temperature_sensitivity("a")) / (slope * 1e6) - 1.0).abs() < 1e-12);
        assert!((value(scale_factor_temperature("a")) - 0.005).abs() < 1e-15);
    }

    #[test]
    fn what_the_result_does_not_state_has_no_value() {
        let nothing = Axis::all(&record(vec![row(&STATIC_BIAS, "x", 1.0)])).remove(0);
        for quantity in [
            density("a"),
            walk_density("a"),
            flicker("a"),
            correlation_time("a"),
            process_density("a"),
            deviation_at_one_second("a"),
            smallest_allan_deviation("a"),
            temperature_sensitivity("a"),
        ] {
            assert_eq!((quantity.of)(&nothing, 0.01), None, "{:?}", quantity.source);
        }
        assert!((value(deviation_at_one_second("a")) > value(deviation_of_step("a"))));
    }
}
