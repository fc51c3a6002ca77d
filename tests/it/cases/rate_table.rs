//! Rate tables: equal values by chance at rest, and the noise of a thermometer that is no range of temperature.

use super::{input, interval, run};
use crate::support::measurand;

#[test]
fn equal_values_at_rest_are_not_stuck() {
    let (said, found) =
        run("scale-factor", &input("stuck-that-is-none", "unit.csv.gz"), &["--serial", "J-1"]);
    assert_eq!(found["integrity"]["stuck"], 0, "{}", said.out);
    let conditions = found["conditions"].as_array().unwrap();
    assert!(conditions.iter().all(|c| c["status"] != "invalid"), "{}", said.out);
    let (low, high) = interval(measurand(&found, "scale_factor_error"));
    // One record: within three of the 95 % half widths of the truth, which an invalid run does not give.
    assert!((0.5 * (low + high) - 120.0).abs() < 0.75 * (high - low) && high - low < 6.0, "{low} {high}");
}

#[test]
fn thermometer_noise_is_no_range_of_temperature() {
    let (said, found) =
        run("scale-factor", &input("thermometer-noise-as-range", "unit.csv.gz"), &["--serial", "J-1"]);
    let row = measurand(&found, "scale_factor_error");
    let (low, high) = interval(row);
    // With a constant temperature column: 119.7 (117.5 to 121.9).
    assert!(low < 120.0 && 120.0 < high && high - low < 6.0, "{row} {}", said.out);
}
