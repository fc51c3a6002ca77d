//! Rounding of a rate forgets its remainder: the mean is known to half a step, the noise to less.

use super::{analyzed, case, holds, limit, objections, run};
use crate::support::measurand;
use sagnac_studies::bench::noise_source::NoiseSource;

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

#[test]
fn a_rate_that_hardly_ever_leaves_its_step_shows_neither_noise_nor_mean() {
    let folder = tempfile::tempdir().unwrap();
    let mut source = NoiseSource::new(21);
    // 0.12 deg/h a sample, rounded to 2.4 deg/h: 0.79 leaves the step some ten times, 0.3 never.
    let noise = source.white(0.002, 1.0, 36_000);
    for (bias, constant) in [(0.79, false), (0.3, true)] {
        let rounded: Vec<f64> = noise.iter().map(|v| ((v + bias) / 2.4).round() * 2.4).collect();
        assert_eq!(rounded.iter().all(|v| *v == 0.0), constant, "{bias}");
        let found = analyzed(folder.path(), 1.0, &rounded);
        let row = measurand(&found, "static_bias");
        assert!(constant || holds(row, bias), "{row}");
        assert_eq!(row["interval"]["low"].is_null(), constant, "{row}");
        assert_eq!(objections(row).contains(&"rate_rounding"), constant, "{row}");
        for id in ["angle_random_walk", "russian_drift_100s"] {
            let row = measurand(&found, id);
            assert!(objections(row).contains(&"rate_rounding"), "{bias}: {row}");
        }
    }
}
