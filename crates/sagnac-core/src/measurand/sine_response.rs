//! Phase per rate of an open-loop unit, whose response to a rate table is a sine, and what else follows from the sine.

use super::descriptor::{Measurand, Stimulus};
use super::evidence::TableEvidence;
use crate::estimate::{Estimate, Spread};
use crate::message::{Arg, note};
use crate::numeric::reml::Combination;
use crate::rate_table::combine::spread;
use crate::rate_table::sine::{self, Sine};

/// Phase per rate of an open-loop response.
pub static SINE_RESPONSE: Measurand = Measurand::of_steps(
    "sine_response",
    "s",
    "phase per rate of an open-loop response",
    Stimulus::OpenLoopRates,
    |m, e| {
        if !e.setup.sine {
            return vec![];
        }
        vec![row(m, e, |s, _| {
            let per = 1.0 / RAD_S;
            let spread = Spread::Normal { standard_uncertainty: s.fit.kappa_standard * per };
            m.measured(&e.channel, s.fit.kappa * per, spread, s.method)
        })]
    },
);

/// Radians a second in one degree an hour.
const RAD_S: f64 = std::f64::consts::PI / 180.0 / 3600.0;

/// A fitted sine with the name of its method.
pub(super) struct OfSine<'a> {
    pub fit: &'a Sine,
    pub method: &'static str,
}

/// A row that `of` makes of the sine and its slope at zero rate, or one that says that the response does not bend.
pub(super) fn row(
    m: &Measurand,
    e: &TableEvidence<'_>,
    of: impl Fn(&OfSine<'_>, &Combination) -> Estimate,
) -> Estimate {
    let method = "sine_response";
    match &e.sine {
        Some(fit) => of(&OfSine { fit, method }, &fit.fit.coefficient(sine::SLOPE_COLUMN)),
        None => m.not_identifiable(&e.channel, None, method).note(note!("on_table.no_sine")),
    }
}

/// What the sine leaves of full scale, ppm.
pub(super) fn residual(m: &Measurand, e: &TableEvidence<'_>) -> Estimate {
    row(m, e, |s, _| {
        let of_full_scale = 1e6 * s.fit.rms / e.full_scale_deg_h();
        m.measured(&e.channel, of_full_scale, Spread::ChiSquare { dof: s.fit.dof }, s.method).note(note!(
            "on_table.sine_left",
            rms = Arg::figures(s.fit.rms * RAD_S * 1e3, 3),
            line = Arg::figures(s.fit.rms_of_line * RAD_S * 1e3, 3)
        ))
    })
}

/// Change of the slope at zero rate with temperature, ppm/degC.
pub(super) fn temperature_sensitivity(m: &Measurand, e: &TableEvidence<'_>) -> Estimate {
    row(m, e, |s, slope| {
        let range = s.fit.temperature_range;
        if range <= 0.0 {
            return m
                .not_identifiable(&e.channel, None, s.method)
                .note(note!("on_table.no_temperature_range"));
        }
        let gain = s.fit.fit.coefficient(sine::GAIN_OVER_TEMPERATURE);
        let value = gain.value / slope.value;
        let reading = [e.setup.of_thermometer(std::f64::consts::SQRT_2 / range * value)];
        m.measured(&e.channel, value, spread(&gain, 1.0 / slope.value.abs(), &reading), s.method)
            .components(&reading)
            .note(note!("on_table.temperature_range", range = Arg::figures(range, 3)))
    })
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{
        chi_square, diagonal, fitted, near, normal, notes, number, on_table, shows, steps, student, withholds,
    };
    use super::super::{SCALE_FACTOR_RESIDUAL, SCALE_FACTOR_TEMPERATURE_SENSITIVITY};
    use super::*;
    use crate::rate_table::Setup;
    use crate::rate_table::steps::Steps;

    /// Seconds of arc in a radian: 1 deg/h is 1/206264.8… rad/s.
    const ARCSEC: f64 = 648_000.0 / std::f64::consts::PI;

    fn sine(slope: f64) -> Sine {
        let covariance = diagonal(&[0.0, 1e-6, 0.0, 0.0, 0.0, 2.45 * 2.45, 0.0, 0.0]);
        Sine {
            fit: fitted(&[0.0, slope, 0.0, 0.0, 0.0, 49.0, 0.0, 0.0], covariance),
            kappa: 2e-5,
            kappa_standard: 1e-8,
            slope,
            mean_slope: slope,
            rms: 3.0,
            rms_of_line: 9.0,
            dof: 20.0,
            temperature_range: 40.0,
            rows: vec![],
        }
    }

    fn setup() -> Setup {
        Setup { sine: true, temperature_uncertainty_deg_c: 0.4, ..Setup::default() }
    }

    fn with<'a>(setup: &'a Setup, steps: &'a Steps, sine: Option<Sine>) -> TableEvidence<'a> {
        TableEvidence { sine, ..on_table(setup, steps, None) }
    }

    #[test]
    fn phase_per_rate_is_that_of_a_radian_a_second() {
        let (setup, steps) = (setup(), Steps::default());
        let rows = SINE_RESPONSE.evaluate_steps(&with(&setup, &steps, Some(sine(0.98))));
        shows(&rows[0], 2e-5 * ARCSEC, "sine_response");
        near(normal(&rows[0]), 1e-8 * ARCSEC);
        let none = SINE_RESPONSE.evaluate_steps(&with(&setup, &steps, None));
        withholds(&none[0], None, "sine_response");
        assert_eq!(notes(&none[0]), ["on_table.no_sine"]);
        let straight = Setup { sine: false, ..setup };
        assert!(SINE_RESPONSE.evaluate_steps(&with(&straight, &steps, Some(sine(0.98)))).is_empty());
    }

    #[test]
    fn what_the_sine_leaves_is_a_part_of_full_scale() {
        let steps = steps(&[-600.0, 200.0, 500.0], &[0.0; 3], 3);
        for (full_scale_deg_h, expected) in [(Some(12_000.0), 250.0), (None, 5000.0)] {
            let setup = Setup { full_scale_deg_h, ..setup() };
            let row = &SCALE_FACTOR_RESIDUAL.evaluate_steps(&with(&setup, &steps, Some(sine(0.98))))[0];
            shows(row, expected, "sine_response");
            assert_eq!(chi_square(row), 20.0);
            // In mrad/s.
            near(number(row, "on_table.sine_left", "rms"), 3000.0 / ARCSEC);
            near(number(row, "on_table.sine_left", "line"), 9000.0 / ARCSEC);
        }
    }

    #[test]
    fn the_gain_over_temperature_is_relative_to_the_slope() {
        let (setup, steps) = (setup(), Steps::default());
        for sign in [1.0, -1.0] {
            let e = with(&setup, &steps, Some(sine(sign * 0.98)));
            let row = &SCALE_FACTOR_TEMPERATURE_SENSITIVITY.evaluate_steps(&e)[0];
            shows(row, sign * 50.0, "sine_response");
            // 2.45/0.98 of the fit, and √2·0.4/40 of 50 from both ends of the range.
            near(student(row).0, (2.5f64 * 2.5 + 0.5).sqrt());
            near(number(row, "on_table.temperature_range", "range"), 40.0);
        }
        let e = with(&setup, &steps, Some(Sine { temperature_range: 0.0, ..sine(0.98) }));
        let none = &SCALE_FACTOR_TEMPERATURE_SENSITIVITY.evaluate_steps(&e)[0];
        withholds(none, None, "sine_response");
        assert_eq!(notes(none), ["on_table.no_temperature_range"]);
    }
}
