//! Errors over a revolution of the rate table.

use super::descriptor::{Measurand, Stimulus};
use super::scale_factor_shape::of_line;
use crate::estimate::{Estimate, SCORE_ONE_SIDED_95, UpperLimit};
use crate::message::{Arg, note};
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
        return m.not_identifiable(&line.channel, None, METHOD).note(note!("on_table.no_harmonic"));
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
        let value = amplitude + SCORE_ONE_SIDED_95 * chance.sqrt();
        return m.not_identifiable(&line.channel, Some(UpperLimit { value, coverage: 0.95 }), METHOD);
    }
    let random = Combination { value: amplitude, standard, dof: cosine.dof.min(sine.dof) };
    let phase = sine.value.atan2(cosine.value).to_degrees();
    m.measured(&line.channel, amplitude, spread(&random, 1.0, &[]), METHOD)
        .note(note!("on_table.phase", phase = Arg::figures(phase, 3)))
}

#[cfg(test)]
mod tests {
    use super::super::evidence::TableEvidence;
    use super::super::test_evidence::{line, near, notes, number, on_table, shows, student, withholds};
    use super::*;
    use crate::rate_table::Setup;
    use nalgebra::DMatrix;

    /// Cosine and sine of 3 and 4 deg/h times a size, with standard uncertainties of 0.2 and 0.3 and a covariance of 0.012.
    fn found(size: f64, order: u8) -> ScaleFactor {
        let mut covariance = DMatrix::zeros(5, 5);
        (covariance[(3, 3)], covariance[(4, 4)]) = (0.04, 0.09);
        (covariance[(3, 4)], covariance[(4, 3)]) = (0.012, 0.012);
        let extras = [Extra::Cosine(order), Extra::Sine(order)];
        line(&[-100.0, 0.0, 100.0], &[0.0, 0.0, 0.0, 3.0 * size, 4.0 * size], &extras, covariance).1
    }

    #[test]
    fn an_amplitude_is_the_root_of_both_squares_with_its_phase() {
        let row = harmonic(&TABLE_HARMONIC_1, &found(1.0, 1), 1);
        shows(&row, 5.0, "table_harmonic");
        // Var √(c² + s²) = (9·0.04 + 16·0.09 + 2·12·0.012)/25.
        near(student(&row).0, (2.088f64 / 25.0).sqrt());
        // An angle of the 3-4-5 triangle.
        near(number(&row, "on_table.phase", "phase"), 53.130_102_354_155_98);
        let row = harmonic(&TABLE_HARMONIC_2, &found(-1.0, 2), 2);
        near(number(&row, "on_table.phase", "phase"), 53.130_102_354_155_98 - 180.0);
    }

    #[test]
    fn an_amplitude_that_chance_gives_once_in_a_hundred_tests_is_bounded() {
        // The square of the distance from none is (c, s) C⁻¹ (c, s)ᵀ = (9·0.09 + 16·0.04 − 2·12·0.012)/(0.0036 − 0.000144)
        // times the square of the size; chance leaves more than 2 ln 100 in one test of a hundred.
        let square = 1.162 / 0.003_456;
        let limit = 2.0 * 100f64.ln();
        for (share, is_shown) in [(0.995, false), (1.005, true)] {
            let size = (share * limit / square).sqrt();
            let row = harmonic(&TABLE_HARMONIC_1, &found(size, 1), 1);
            if is_shown {
                shows(&row, 5.0 * size, "table_harmonic");
            } else {
                withholds(&row, Some(5.0 * size + SCORE_ONE_SIDED_95 * 0.065f64.sqrt()), "table_harmonic");
            }
        }
    }

    #[test]
    fn each_order_has_its_own_terms() {
        let (setup, line) = (Setup::default(), found(1.0, 2));
        let steps = crate::rate_table::steps::Steps::default();
        let e: TableEvidence<'_> = on_table(&setup, &steps, Some(line));
        shows(&TABLE_HARMONIC_2.evaluate_steps(&e)[0], 5.0, "table_harmonic");
        let none = &TABLE_HARMONIC_1.evaluate_steps(&e)[0];
        withholds(none, None, "table_harmonic");
        assert_eq!(notes(none), ["on_table.no_harmonic"]);
        assert!(TABLE_HARMONIC_1.evaluate_steps(&on_table(&setup, &steps, None)).is_empty());
    }
}
