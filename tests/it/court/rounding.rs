//! Rounding of a rate forgets its remainder: the mean is known to half a step, the noise to less.

use super::{case, holds, limit, objections, run};
use crate::support::measurand;

#[test]
fn the_mean_of_a_rounded_rate_is_known_to_half_a_step() {
    let folder = tempfile::tempdir().unwrap();
    let limits = limit(folder.path(), "static_bias", "max_abs = \"0.5 deg/h\"");
    let (said, result) = run(folder.path(), &case("rounded-rate/unit.csv"), &limits);
    let bias = measurand(&result, "static_bias");
    assert_eq!((said.code, bias["verdict"].as_str()), (3, Some("indeterminate")), "{bias}");
    assert!(holds(bias, -0.717), "{bias}");
    let n = measurand(&result, "angle_random_walk");
    assert!(objections(n).contains(&"rate_rounding"), "{n}");
}
