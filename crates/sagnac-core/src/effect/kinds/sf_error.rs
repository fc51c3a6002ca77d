//! A scale factor that differs from the claimed one.

use crate::effect::shared::reach::{large_rates, varies};
use crate::effect::{Drivers, Param};

pub struct SfError;

static PARAMS: [Param; 1] = [Param::reported("error_ppm", "ppm", -1e5, 1e5).signed().corrects_claim()];

describe! {
    SfError, "sf_error", Mean in InputRate, needs [TableRate],
    confusers ["sf_asymmetry", "sf_nonlinearity", "sf_temperature", "time_offset"]
}

fn column(drivers: &Drivers) -> Option<Vec<f64>> {
    Some(drivers.table_rate.as_ref()?.iter().map(|r| 3600e-6 * r).collect())
}

linear! { SfError, replaces Some(crate::effect::Nuisance::ScaleFactor), places large_rates }

fn applies(drivers: &Drivers) -> bool {
    varies(drivers.table_rate.as_deref())
}
