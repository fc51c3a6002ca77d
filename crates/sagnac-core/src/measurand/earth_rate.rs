//! Earth rate along the input axis, from the site.

use super::descriptor::Measurand;
use crate::estimate::{Component, InputQuantity, Spread};

/// Earth rate along the input axis.
pub static EARTH_RATE_COMPONENT: Measurand = Measurand::at_rest(
    "earth_rate_component",
    "deg/h",
    "Earth rate along the input axis, from the site",
    |m, gyro, _| {
        let Some(earth) = gyro.earth else { return vec![] };
        let spread = Spread::Normal { standard_uncertainty: earth.uncertainty_deg_h };
        let of_site = Component::of(InputQuantity::EarthRate, earth.uncertainty_deg_h, "deg/h", 1.0);
        vec![m.measured(&gyro.channel, earth.rate_deg_h, spread, "from_site").components(&[of_site])]
    },
)
.signed()
.from_site();

#[cfg(test)]
mod tests {
    use super::super::Options;
    use super::super::evidence::Earth;
    use super::super::test_evidence::{gyro, normal, shows};
    use super::*;

    #[test]
    fn the_row_is_that_of_the_site_and_none_without_one() {
        let (mut gyro, options) = (gyro(), Options { remove_earth_rate: true });
        assert!(EARTH_RATE_COMPONENT.evaluate_gyro(&gyro, &options).is_empty());
        gyro.earth = Some(Earth { rate_deg_h: -8.4, uncertainty_deg_h: 0.02 });
        let rows = EARTH_RATE_COMPONENT.evaluate_gyro(&gyro, &options);
        shows(&rows[0], -8.4, "from_site");
        assert_eq!(normal(&rows[0]), 0.02);
    }
}
