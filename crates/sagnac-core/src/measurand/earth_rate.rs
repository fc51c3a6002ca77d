//! Earth rate along the input axis, from the site.

use super::descriptor::Measurand;
use crate::estimate::Spread;

/// Earth rate along the input axis.
pub static EARTH_RATE_COMPONENT: Measurand = Measurand::at_rest(
    "earth_rate_component",
    "deg/h",
    "Earth rate along the input axis, from the site",
    |m, gyro, _| {
        let Some(earth) = gyro.earth else { return vec![] };
        let spread = Spread::Normal { standard_uncertainty: earth.uncertainty_deg_h };
        vec![m.measured(&gyro.channel, earth.rate_deg_h, spread, "from_site")]
    },
)
.signed()
.from_site();
