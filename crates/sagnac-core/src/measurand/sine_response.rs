//! Phase per rate of an open-loop unit, whose response to a rate table is a sine, and what else follows from the sine.

use super::descriptor::{Measurand, Stimulus};
use super::evidence::TableEvidence;
use crate::estimate::{Estimate, Spread};
use crate::message::{Arg, Note};
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
        Some(fit) => of(&OfSine { fit, method }, &fit.fit.coefficient(sine::SLOPE)),
        None => m.not_identifiable(&e.channel, None, method).note(Note::new("on_table.no_sine")),
    }
}

/// What the sine leaves of full scale, ppm.
pub(super) fn residual(m: &Measurand, e: &TableEvidence<'_>) -> Estimate {
    row(m, e, |s, _| {
        let of_full_scale = 1e6 * s.fit.rms / e.full_scale_deg_h();
        m.measured(&e.channel, of_full_scale, Spread::ChiSquare { dof: s.fit.dof }, s.method).note(
            Note::new("on_table.sine_left")
                .with("rms", Arg::figures(s.fit.rms * RAD_S * 1e3, 3))
                .with("line", Arg::figures(s.fit.rms_of_line * RAD_S * 1e3, 3)),
        )
    })
}

/// Change of the slope at zero rate with temperature, ppm/degC.
pub(super) fn temperature_sensitivity(m: &Measurand, e: &TableEvidence<'_>) -> Estimate {
    row(m, e, |s, slope| {
        let range = s.fit.temperature_range;
        if range <= 0.0 {
            return m
                .not_identifiable(&e.channel, None, s.method)
                .note(Note::new("on_table.no_temperature_range"));
        }
        let gain = s.fit.fit.coefficient(sine::GAIN_OVER_TEMPERATURE);
        let value = gain.value / slope.value;
        let reading = std::f64::consts::SQRT_2 * e.setup.temperature_uncertainty_deg_c / range * value.abs();
        m.measured(&e.channel, value, spread(&gain, 1.0 / slope.value.abs(), &[reading]), s.method)
            .note(Note::new("on_table.temperature_range").with("range", Arg::figures(range, 3)))
    })
}
