//! Sign of the output against the sign of the rate.

use super::descriptor::{Measurand, Stimulus};
use super::evidence::TableEvidence;
use crate::estimate::{Estimate, Spread};
use crate::message::note;
use crate::rate_table::scale_factor::{METHOD, ScaleFactor};

/// +1 where the output rises with the rate about the input axis, −1 where it falls.
pub static POLARITY: Measurand = Measurand::of_steps(
    "polarity",
    "1",
    "sign of the output: 1 where it rises with the rate, -1 where it falls",
    Stimulus::Rates,
    |m, e: &TableEvidence<'_>| e.line.as_ref().map(|line| polarity(m, line)).into_iter().collect(),
)
.signed();

/// Standard uncertainties that a slope must differ from 0 by for its sign to be known.
const KNOWN_FROM: f64 = 5.0;

fn polarity(m: &Measurand, line: &ScaleFactor) -> Estimate {
    if line.factor.abs() <= KNOWN_FROM * line.factor_uncertainty() {
        return m.not_identifiable(&line.channel, None, METHOD).note(note!("on_table.no_polarity"));
    }
    let spread = Spread::Normal { standard_uncertainty: 0.0 };
    m.measured(&line.channel, line.factor.signum(), spread, METHOD)
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{diagonal, line, notes, on_table, shows, withholds};
    use super::*;
    use crate::rate_table::Setup;

    /// The row of a line with this factor, whose slope is known to 0.01 by levels of 1 deg/h.
    fn row(factor: f64) -> Estimate {
        let (steps, mut line) = line(&[-1.0, 0.0, 1.0], &[0.0; 3], &[], diagonal(&[2e-4; 3]));
        line.factor = factor;
        let setup = Setup::default();
        POLARITY.evaluate_steps(&on_table(&setup, &steps, Some(line))).remove(0)
    }

    #[test]
    fn the_sign_of_a_slope_is_stated_where_it_is_known() {
        shows(&row(0.9), 1.0, METHOD);
        shows(&row(-1.1), -1.0, METHOD);
        assert_eq!(row(-1.1).interval95().map(|i| (i.low, i.high)), Some((-1.0, -1.0)));
        let unknown = row(0.04);
        withholds(&unknown, None, METHOD);
        assert_eq!(notes(&unknown), ["on_table.no_polarity"]);
    }
}
