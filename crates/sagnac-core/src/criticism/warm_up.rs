//! Whether a warm-up time is contradicted by running means, by the filter that the output went through, or by the lack of any
//! transient.

use crate::estimate::{Finding, Holds};
use crate::evidence::GyroEvidence;
use crate::message::{Arg, Note, note};
use crate::temperature::warm_up::WarmUpFindings;

pub(super) fn examine(gyro: &GyroEvidence) -> Vec<Finding> {
    let Some(found) = &gyro.warm_up else { return vec![] };
    let contradiction = contradiction(found);
    let of = |(found, advice)| Finding {
        measurands: vec!["warm_up_time", "turn_on_transient"],
        holds: Holds::Nothing,
        found,
        advice,
    };
    contradiction.map(of).into_iter().collect()
}

/// The contradiction and the advice; `None` where nothing contradicts the decays.
fn contradiction(found: &WarmUpFindings) -> Option<(Note, Note)> {
    if let Some(smoothed_s) = found.smoothed_s {
        let said = note!("criticism_found.smoothed", seconds = Arg::figures(smoothed_s, 2));
        return Some((said, "criticism_advice.smoothed".into()));
    }
    if let Some(d) = found.departure {
        let minutes = |s: f64| Arg::figures(s / 60.0, 3);
        let said = note!(
            "criticism_found.leaves_again",
            from = minutes(d.from_s),
            to = minutes(d.to_s),
            off = Arg::figures(d.deg_h, 2),
            band = Arg::Stated(found.test.band_deg_h),
            time = minutes(found.time.value)
        );
        return Some((said, "criticism_advice.leaves_again".into()));
    }
    // A unit that was warm before shows no transient either.
    found
        .is_contradicted()
        .then(|| ("criticism_found.no_transient".into(), "criticism_advice.no_transient".into()))
}
