//! A scale factor that differs from the claimed one.

use super::reach::varies;
use crate::effect::{Domain, Drivers, Param, Place};
use crate::numeric::range::{Bounds, ends};

pub struct SfError;

static PARAMS: [Param; 1] = [Param::reported("error_ppm", "ppm", -1e5, 1e5).signed().corrects_claim()];

describe! {
    SfError, "sf_error", Mean in InputRate, needs [TableRate],
    confusers ["sf_asymmetry", "sf_nonlinearity", "sf_temperature", "time_offset"]
}

/// Rates at which an effect that grows with the rate is at least half of its largest.
pub(super) fn large_rates(drivers: &Drivers) -> Vec<Place> {
    let Some(rate) = &drivers.table_rate else { return vec![] };
    let Bounds { low: from, high: to } = ends(rate);
    let largest = from.abs().max(to.abs());
    let Bounds { low: from, high: to } =
        ends(&rate.iter().copied().filter(|r| r.abs() >= 0.5 * largest).collect::<Vec<_>>());
    if from <= to { vec![Place { domain: Domain::InputRate, from, to }] } else { vec![] }
}

fn column(drivers: &Drivers) -> Option<Vec<f64>> {
    Some(drivers.table_rate.as_ref()?.iter().map(|r| 3600e-6 * r).collect())
}

linear! { SfError, replaces Some(crate::effect::Nuisance::ScaleFactor), places large_rates }

fn applies(drivers: &Drivers) -> bool {
    varies(drivers.table_rate.as_deref())
}
