//! Different scale factors for positive and negative rate.

use crate::effect::shared::reach::large_rates;
use crate::effect::{Drivers, Param};
use crate::numeric::range::{Bounds, ends};

pub struct SfAsymmetry;

static PARAMS: [Param; 1] = [Param::reported("asymmetry_ppm", "ppm", -1e5, 1e5).signed()];

describe! {
    SfAsymmetry, "sf_asymmetry", Mean in InputRate, needs [TableRate],
    confusers ["sf_error", "sf_nonlinearity", "temp_linear"]
}

fn column(drivers: &Drivers) -> Option<Vec<f64>> {
    Some(drivers.table_rate.as_ref()?.iter().map(|r| 1800e-6 * r.abs()).collect())
}

linear! { SfAsymmetry, replaces None, places large_rates }

/// Rates of one sign alone cannot show it.
fn applies(drivers: &Drivers) -> bool {
    let Some(rate) = &drivers.table_rate else { return false };
    let Bounds { low, high } = ends(rate);
    low.is_finite() && high.is_finite() && low < -0.01 * high.abs() && high > 0.01 * low.abs()
}
