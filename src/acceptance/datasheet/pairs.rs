//! Russian values beside Allan ones, over the lot.

use crate::measurand::{
    ANGLE_RANDOM_WALK, BIAS_INSTABILITY, BIAS_INSTABILITY_MINIMUM, Measurand, RUSSIAN_ARW_10S,
    RUSSIAN_DRIFT_100S, RUSSIAN_DRIFT_100S_3SIGMA,
};
use crate::numeric::order::quantile;
use crate::record::{SheetPair, SheetQuantity};

/// Quantities set side by side.
static MEASURAND_PAIRS: [(&Measurand, &Measurand); 5] = [
    (&RUSSIAN_DRIFT_100S, &BIAS_INSTABILITY_MINIMUM),
    (&RUSSIAN_DRIFT_100S, &BIAS_INSTABILITY),
    (&RUSSIAN_DRIFT_100S_3SIGMA, &BIAS_INSTABILITY_MINIMUM),
    (&RUSSIAN_DRIFT_100S_3SIGMA, &BIAS_INSTABILITY),
    (&RUSSIAN_ARW_10S, &ANGLE_RANDOM_WALK),
];

/// The pairs of each channel of which units have both values.
pub(super) fn pairs(quantities: &[SheetQuantity]) -> Vec<SheetPair> {
    let russian = |id: &str| quantities.iter().filter(|q| q.id == id).collect::<Vec<_>>();
    MEASURAND_PAIRS
        .iter()
        .flat_map(|(r, a)| {
            let sides = russian(r.id).into_iter().filter_map(|q| {
                let other = quantities.iter().find(|o| {
                    o.id == a.id && o.channel == q.channel && o.phase == q.phase && o.unit == q.unit
                });
                pair(q, other?)
            });
            sides.collect::<Vec<_>>()
        })
        .collect()
}

fn pair(russian: &SheetQuantity, allan: &SheetQuantity) -> Option<SheetPair> {
    let mut ratios: Vec<f64> = russian
        .values
        .iter()
        .filter_map(|r| {
            let other = allan.values.iter().find(|a| a.serial == r.serial)?;
            let (r, a) = (r.value?, other.value.filter(|a| *a > 0.0)?);
            Some(r / a)
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    let ratio = quantile(&ratios, 0.5)?;
    Some(SheetPair {
        channel: russian.channel.clone(),
        russian: russian.id.clone(),
        russian_value: russian.typical.as_ref()?.value,
        allan: allan.id.clone(),
        allan_value: allan.typical.as_ref()?.value,
        unit: russian.unit.clone(),
        ratio,
        range: [*ratios.first()?, *ratios.last()?],
        units: ratios.len(),
    })
}
