//! Output of one channel per rate about the input axis of another, from turns by known angles.

use super::descriptor::{Measurand, OfKnownInput, TurnAxis};
use super::evidence::KnownInputEvidence;
use crate::estimate::Estimate;
use crate::message::{Arg, Note};
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
    let scatter = spread(&t.factor, per_factor, &[per_factor * t.by_angle]);
    let spread = evenly(scatter, value, per_factor * t.by_earth);
    m.measured(channel, value, spread, "known_angles")
        .note(Note::new("known.turns").with("axis", Arg::Text(t.axis.clone())))
}
