//! Change of the angle random walk at every level of an influence, from the noise of both states.

use super::descriptor::Measurand;
use crate::estimate::{Estimate, Spread};
use crate::influence::comparison::NoiseChange;
use crate::message::{Arg, Note};

/// Change of N at every level.
pub static ANGLE_RANDOM_WALK_SHIFT: Measurand = Measurand::of_influence(
    "angle_random_walk_shift",
    "deg/sqrt(h)",
    "change of N at one level of an influence",
    None,
    |m, compared| compared.noise.iter().map(|change| row(m, change)).collect(),
)
.signed();

fn row(m: &Measurand, change: &NoiseChange) -> Estimate {
    const METHOD: &str = "whittle";
    let (Some(a), Some(b)) = (change.without, change.with) else {
        let none = m.not_identifiable(&change.channel, None, METHOD);
        return none.note(Note::new("compared.noise_not_shown"));
    };
    let spread = Spread::Normal { standard_uncertainty: a.1.hypot(b.1) };
    m.measured(&change.channel, b.0 - a.0, spread, METHOD).note(
        Note::new("compared.noise").with("without", Arg::figures(a.0, 4)).with("with", Arg::figures(b.0, 4)),
    )
}
