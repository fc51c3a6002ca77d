//! Units without Shupe effect, lag or hysteresis: what lag and rate of temperature leave open.

use sagnac_studies::bench::chamber::programme;
use sagnac_studies::thermal::ambiguity::{plain, tally};

#[test]
fn a_unit_with_nothing_but_a_curve_over_temperature_is_not_told_a_shupe_effect() {
    let units = [(true, [60.0, 20.0]), (false, [50.0, 16.0])];
    let name = "a_unit_with_nothing_but_a_curve_over_temperature_is_not_told_a_shupe_effect";
    for (curved, rates) in crate::support::long::cases(name, &units, 1) {
        let legs = programme(&rates, 3600.0);
        let tallies = tally(|c| plain(c, curved), (-40.0, &legs), 1..9);
        for id in ["bias_temperature_rate_sensitivity", "thermal_hysteresis"] {
            let t = &tallies[id].coverage;
            assert!(t.stated() == 8 && t.inside() >= 6, "{curved} {id}: {} of {}", t.inside(), t.stated());
        }
        // No lag is stated where there is none, but by chance.
        let lags = tallies["thermal_lag"].coverage.stated();
        assert!(lags <= 2, "{curved}: {lags}");
    }
}
