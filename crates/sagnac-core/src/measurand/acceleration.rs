//! Sensitivity of the bias to acceleration and its squares, from positions in the field of gravity.

use super::descriptor::Measurand;
use crate::estimate::{Estimate, Spread};
use crate::message::{Arg, note};
use crate::rate_table::acceleration::{Acceleration, Term};

const FORMULAS: &[&str] = &[
    "y_p = D + Ω_p + D_I·a_I + D_O·a_O + D_S·a_S + …",
    "… + D_II·a_I² + D_OO·a_O² + D_IO·a_I·a_O + D_IS·a_I·a_S + D_OS·a_O·a_S",
    "a_I² + a_O² + a_S² = g²",
];

/// Name of the method.
const METHOD: &str = "gravity_positions";

const fn sensitivity(
    id: &'static str,
    unit: &'static str,
    doc: &'static str,
    evaluate: fn(&Measurand, &Acceleration) -> Vec<Estimate>,
) -> Measurand {
    Measurand::of_acceleration(id, unit, doc, evaluate).signed()
}

/// Along the input axis.
pub static G_SENSITIVITY_I: Measurand = sensitivity(
    "g_sensitivity_i",
    "deg/h/g",
    "change of the bias with the acceleration along the input axis",
    |m, found| vec![coefficient(m, found, Term::I)],
)
.also_called(&["g_sensitivity", "g_dependent_bias"])
.formulas(FORMULAS, "IEEE Std 517-1974; IEEE Std 952-2020, 12.11");

/// Along the output axis.
pub static G_SENSITIVITY_O: Measurand = sensitivity(
    "g_sensitivity_o",
    "deg/h/g",
    "change of the bias with the acceleration along the output axis",
    |m, found| vec![coefficient(m, found, Term::O)],
);

/// Along the third axis.
pub static G_SENSITIVITY_S: Measurand = sensitivity(
    "g_sensitivity_s",
    "deg/h/g",
    "change of the bias with the acceleration along the axis S = I x O",
    |m, found| vec![coefficient(m, found, Term::S)],
);

/// Square along the input axis.
pub static G2_SENSITIVITY_II: Measurand = sensitivity(
    "g2_sensitivity_ii",
    "deg/h/g^2",
    "change of the bias with the square of the acceleration along the input axis, beside that along S",
    |m, found| vec![coefficient(m, found, Term::II)],
);

/// Square along the output axis.
pub static G2_SENSITIVITY_OO: Measurand = sensitivity(
    "g2_sensitivity_oo",
    "deg/h/g^2",
    "change of the bias with the square of the acceleration along the output axis, beside that along S",
    |m, found| vec![coefficient(m, found, Term::OO)],
);

/// Product along input and output axis.
pub static G2_SENSITIVITY_IO: Measurand = sensitivity(
    "g2_sensitivity_io",
    "deg/h/g^2",
    "change of the bias with the product of the accelerations along input and output axis",
    |m, found| vec![coefficient(m, found, Term::IO)],
);

/// Product along the input axis and S.
pub static G2_SENSITIVITY_IS: Measurand = sensitivity(
    "g2_sensitivity_is",
    "deg/h/g^2",
    "change of the bias with the product of the accelerations along the input axis and S",
    |m, found| vec![coefficient(m, found, Term::IS)],
);

/// Product along the output axis and S.
pub static G2_SENSITIVITY_OS: Measurand = sensitivity(
    "g2_sensitivity_os",
    "deg/h/g^2",
    "change of the bias with the product of the accelerations along the output axis and S",
    |m, found| vec![coefficient(m, found, Term::OS)],
);

fn coefficient(m: &Measurand, found: &Acceleration, term: Term) -> Estimate {
    let empty = || m.not_identifiable(&found.channel, None, METHOD);
    let Some(at) = found.design.terms.iter().position(|t| *t == term) else {
        return empty().note(note!("acceleration.not_in_model"));
    };
    let Some(Some(c)) = found.coefficients.get(at) else {
        let missing: Vec<Arg> = found.design.missing().map(|t| Arg::from(t.name())).collect();
        let terms = Arg::Several(missing, ", ".into());
        return empty().note(note!(
            "acceleration.not_determined",
            rank = found.design.rank,
            of = found.design.terms.len(),
            terms
        ));
    };
    let spread = Spread::StudentT { standard_uncertainty: c.standard, dof: c.dof };
    m.measured(&found.channel, c.value, spread, METHOD).note(note!(
        "acceleration.model",
        positions = found.means.len(),
        rank = found.design.rank,
        of = found.design.terms.len()
    ))
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{notes, number, shows, student, withholds};
    use super::*;
    use crate::numeric::reml::Combination;
    use crate::rate_table::acceleration::{AccelerationTest, Order};
    use crate::rate_table::setup::{Input, ReferenceInput};

    /// Faces of a cube, of a unit whose coefficients are 0.1, 0.2, … with a deviation of 0.01.
    fn faces(order: Order) -> Acceleration {
        let elevations = [90.0, -90.0, 0.0, 0.0, 0.0, 0.0];
        let position = |elevation: f64| ReferenceInput {
            phase: None,
            from_s: None,
            to_s: None,
            channel: None,
            input: Input::Position { heading: (90.0, 0.0), elevation: (elevation, 0.0) },
        };
        let test = AccelerationTest {
            order,
            scale_factor_uncertainty: 0.0,
            positions: elevations.into_iter().map(position).collect(),
            rolls_deg: vec![0.0, 0.0, 0.0, 90.0, 180.0, 270.0],
        };
        let design = test.design();
        let of = |(k, deviation): (usize, &Option<f64>)| {
            deviation.map(|_| Combination { value: 0.1 * (k + 1) as f64, standard: 0.01, dof: 9.0 })
        };
        let coefficients = design.deviations.iter().enumerate().map(of).collect();
        Acceleration { channel: "g".into(), design, coefficients, means: vec![(0.0, 0.0); 6] }
    }

    #[test]
    fn each_row_is_its_own_coefficient() {
        let found = faces(Order::Linear);
        for (m, value) in [(&G_SENSITIVITY_I, 0.2), (&G_SENSITIVITY_O, 0.3), (&G_SENSITIVITY_S, 0.4)] {
            let row = m.evaluate_acceleration(&found).remove(0);
            shows(&row, value, METHOD);
            assert_eq!(student(&row), (0.01, 9.0));
        }
        let absent = G2_SENSITIVITY_II.evaluate_acceleration(&found).remove(0);
        withholds(&absent, None, METHOD);
        assert_eq!(notes(&absent), ["acceleration.not_in_model"]);
    }

    #[test]
    fn products_that_the_positions_do_not_tell_are_withheld_with_the_rank() {
        let found = faces(Order::Quadratic);
        shows(&G2_SENSITIVITY_OO.evaluate_acceleration(&found)[0], 0.6, METHOD);
        for m in [&G2_SENSITIVITY_IO, &G2_SENSITIVITY_IS, &G2_SENSITIVITY_OS] {
            let row = m.evaluate_acceleration(&found).remove(0);
            withholds(&row, None, METHOD);
            assert_eq!(number(&row, "acceleration.not_determined", "rank"), 6.0);
        }
    }
}
