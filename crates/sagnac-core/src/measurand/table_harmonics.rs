//! Errors over a revolution of the rate table.

use super::descriptor::{Measurand, Stimulus};
use super::scale_factor_shape::of_line;
use crate::estimate::{Estimate, UpperLimit};
use crate::message::{Arg, Note};
use crate::numeric::reml::Combination;
use crate::rate_table::combine::spread;
use crate::rate_table::design::Extra;
use crate::rate_table::scale_factor::ScaleFactor;

/// Error once per revolution.
pub static TABLE_HARMONIC_1: Measurand =
    Measurand::of_steps("table_harmonic_1", "deg/h", "error once per revolution", Stimulus::Rates, |m, e| {
        of_line(e, |line| harmonic(m, line, 1))
    })
    .extras(&[Extra::Cosine(1), Extra::Sine(1)]);

/// Error twice per revolution.
pub static TABLE_HARMONIC_2: Measurand = Measurand::of_steps(
    "table_harmonic_2",
    "deg/h",
    "error twice per revolution",
    Stimulus::Rates,
    |m, e| of_line(e, |line| harmonic(m, line, 2)),
)
.extras(&[Extra::Cosine(2), Extra::Sine(2)]);

const METHOD: &str = "table_harmonic";

/// Amplitude of an error over a turn.
fn harmonic(m: &Measurand, line: &ScaleFactor, order: u8) -> Estimate {
    let response = &line.response;
    let parts = response.extra(Extra::Cosine(order)).zip(response.extra(Extra::Sine(order)));
    let Some((cosine, sine)) = parts else {
        return m.not_identifiable(&line.channel, None, METHOD).note(Note::new("on_table.no_harmonic"));
    };
    let amplitude = cosine.value.hypot(sine.value);
    let covariance = response.covariance_of(Extra::Cosine(order), Extra::Sine(order));
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
        return m.not_identifiable(&line.channel, Some(UpperLimit { value, coverage: 0.95 }), METHOD);
    }
    let random = Combination { value: amplitude, standard, dof: cosine.dof.min(sine.dof) };
    let phase = sine.value.atan2(cosine.value).to_degrees();
    m.measured(&line.channel, amplitude, spread(&random, 1.0, &[]), METHOD)
        .note(Note::new("on_table.phase").with("phase", Arg::figures(phase, 3)))
}
