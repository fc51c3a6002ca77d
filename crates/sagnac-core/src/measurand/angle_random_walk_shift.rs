//! Change of the angle random walk at every level of an influence, from the noise of both states.

use super::descriptor::Measurand;
use crate::estimate::{Estimate, Spread};
use crate::influence::comparison::NoiseChange;
use crate::message::{Arg, note};

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
        return none.note(note!("compared.noise_not_shown"));
    };
    let spread = Spread::Normal { standard_uncertainty: a.1.hypot(b.1) };
    m.measured(&change.channel, b.0 - a.0, spread, METHOD).note(note!(
        "compared.noise",
        without = Arg::figures(a.0, 4),
        with = Arg::figures(b.0, 4)
    ))
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{near, normal, notes, number, shows, withholds};
    use super::*;

    #[test]
    fn the_change_is_that_with_less_that_without_and_both_uncertainties_count() {
        let change = NoiseChange {
            channel: "g@1".into(),
            without: Some((0.004, 3e-5)),
            with: Some((0.0025, 4e-5)),
            bands: vec![],
        };
        let found = row(&ANGLE_RANDOM_WALK_SHIFT, &change);
        shows(&found, -0.0015, "whittle");
        near(normal(&found), 5e-5);
        assert_eq!((found.channel.as_str(), found.unit), ("g@1", "deg/sqrt(h)"));
        assert_eq!(number(&found, "compared.noise", "without"), 0.004);
        assert_eq!(number(&found, "compared.noise", "with"), 0.0025);
        for missing in [NoiseChange { without: None, ..change.clone() }, NoiseChange { with: None, ..change }]
        {
            let none = row(&ANGLE_RANDOM_WALK_SHIFT, &missing);
            withholds(&none, None, "whittle");
            assert_eq!(notes(&none), ["compared.noise_not_shown"]);
        }
    }
}
