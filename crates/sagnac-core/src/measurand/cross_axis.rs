//! Output of one channel per rate about the input axis of another, from turns by known angles.

use super::descriptor::{Measurand, OfKnownInput, TurnAxis};
use super::evidence::KnownInputEvidence;
use crate::estimate::{Component, Estimate, InputQuantity};
use crate::message::{Arg, note};
use crate::rate_table::combine::{evenly, spread};
use crate::rate_table::turns::Turned;

/// Output of one axis per rate about another; its rows are named `output<-axis`.
pub static CROSS_AXIS: Measurand = Measurand::of_known_input(
    "cross_axis",
    "1",
    "output of one axis per rate about another",
    OfKnownInput { positions: false, turns: Some(TurnAxis::Other), evaluate },
)
.signed();

fn evaluate(m: &Measurand, known: &KnownInputEvidence<'_>) -> Vec<Estimate> {
    let others = known.turns.into_iter().flat_map(|t| &t.table).filter(|t| t.output != t.axis);
    others.map(|t| of_turn(m, t, &format!("{}<-{}", t.output, t.axis), t.factor.value, 1.0)).collect()
}

/// A row from turns about one axis: a value whose derivative by the factor of the turns is `per_factor`.
pub(super) fn of_turn(m: &Measurand, t: &Turned, channel: &str, value: f64, per_factor: f64) -> Estimate {
    let by_angle = Component::of(InputQuantity::TableAngle, t.by_angle, "1", per_factor);
    let by_earth = Component::of(InputQuantity::EarthOverTurns, t.by_earth / 3f64.sqrt(), "1", per_factor);
    let scatter = spread(&t.factor, per_factor, std::slice::from_ref(&by_angle));
    let spread = evenly(scatter, value, per_factor * t.by_earth);
    m.measured(channel, value, spread, "known_angles")
        .components(&[by_angle, by_earth])
        .note(note!("known.turns", axis = Arg::Text(t.axis.clone())))
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{combination, near, shows, student, told};
    use super::*;
    use crate::rate_table::turns::Turns;

    fn turned(output: &str, axis: &str, value: f64) -> Turned {
        let factor = combination(value, 2e-6);
        Turned { output: output.into(), axis: axis.into(), factor, by_angle: 3e-6, by_earth: 1.2e-6 }
    }

    #[test]
    fn turns_about_another_axis_are_rows_named_by_both() {
        let turns =
            Turns { table: vec![turned("x", "x", 1.0), turned("x", "y", -4e-4), turned("y", "x", 5e-4)] };
        let rows =
            CROSS_AXIS.evaluate_known_input(&KnownInputEvidence { positions: &[], turns: Some(&turns) });
        assert_eq!(rows.iter().map(|r| r.channel.as_str()).collect::<Vec<_>>(), ["x<-y", "y<-x"]);
        shows(&rows[0], -4e-4, "known_angles");
        assert_eq!(told(&rows[0], "known.turns", "axis"), &Arg::Text("y".into()));
        // 2² + 3² and the even contribution of ±1.2, whose variance is 1.2²/3.
        near(student(&rows[0]).0, (13.0f64 + 0.48).sqrt() * 1e-6);
        let none = CROSS_AXIS.evaluate_known_input(&KnownInputEvidence { positions: &[], turns: None });
        assert!(none.is_empty());
    }

    #[test]
    fn a_value_per_factor_takes_its_uncertainties_times_that() {
        let row = of_turn(&CROSS_AXIS, &turned("x", "x", 1.0), "x", 7.0, 1e6);
        shows(&row, 7.0, "known_angles");
        near(student(&row).0, (13.0f64 + 0.48).sqrt());
    }
}
