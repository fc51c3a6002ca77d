//! Earth rate along the input axis, from the site.

use super::{GyroEvidence, Measurand, Options};
use crate::estimate::{Estimate, Spread};

pub(super) struct EarthRateComponent;

impl Measurand for EarthRateComponent {
    fn ids(&self) -> &'static [&'static str] {
        &["earth_rate_component"]
    }

    fn evaluate(&self, _: &str, gyro: &GyroEvidence, _: &Options) -> Option<Estimate> {
        let earth = gyro.earth?;
        Some(Estimate::measured(
            "earth_rate_component",
            &gyro.channel,
            earth.rate_deg_h,
            "deg/h",
            Spread::Normal { standard_uncertainty: earth.uncertainty_deg_h },
            "from_site",
        ))
    }
}
