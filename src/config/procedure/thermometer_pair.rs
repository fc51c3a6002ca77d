//! Two thermometers at one place that are compared: what a procedure states of them.

use crate::config::table::Table;
use crate::units::Unit;

/// Unit of a difference of temperatures.
const DIFFERENCE_UNIT: &str = "K";

/// Two thermometers at one place. The mean of `channel` minus `reference` over the evaluated time has a row of its own, in K, and
/// limits by [[derived_limit]].
#[derive(Table)]
#[table("thermometer_pair")]
pub(crate) struct ThermometerPairKeys {
    /// Id of the difference in results and limits; no id of a measurand.
    #[key(id, required, example = "thermometer_difference")]
    id: Option<String>,
    /// Channel with the role `temperature` that is compared.
    #[key(id, required, example = "temp")]
    channel: Option<String>,
    /// Channel with the role `temperature` that it is compared with.
    #[key(id, required, example = "temp_reference")]
    reference: Option<String>,
    /// Standard uncertainty (k = 1) of the difference: both sensors with their calibrations, and the temperature between their places.
    #[key(difference = "degC", min = 0, example = "0.03 degC")]
    uncertainty_deg_c: f64,
}

/// Two thermometers that are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct ThermometerPair {
    /// Id of the difference.
    pub id: String,
    /// Channel that is compared.
    pub channel: String,
    /// Channel that it is compared with.
    pub reference: String,
    /// Standard uncertainty of the difference by calibration and place, K.
    pub standard_uncertainty_k: f64,
    /// Unit of the row.
    pub unit: Unit,
}

impl From<ThermometerPairKeys> for Option<ThermometerPair> {
    fn from(keys: ThermometerPairKeys) -> Option<ThermometerPair> {
        Some(ThermometerPair {
            id: keys.id?,
            channel: keys.channel?,
            reference: keys.reference?,
            standard_uncertainty_k: keys.uncertainty_deg_c,
            unit: Unit::parse(DIFFERENCE_UNIT).ok()?,
        })
    }
}
