//! How well a record itself tells a slow term from the others: the deviance of the best description without the term
//! against that of the true structure. What no choice of threshold can get round.

use super::oracle::{Fit, Oracle};
use super::whittle::{Data, Layout};
use sagnac::noise::composite::{Composite, Parameter};
use sagnac::noise::data::NoiseType;
use sagnac::noise::model::unit_allan_variance;

/// Terms that can stand for one another at the lowest frequencies.
const SLOW: [NoiseType; 2] = [NoiseType::Flicker, NoiseType::RateRandomWalk];
/// Rise of the deviance from which a record counts as telling: the 5 % point of one amplitude.
pub const TELLING: f64 = 2.71;

/// Rise of the deviance when a slow term is taken out and the absent ones of flicker and random walk are let in; `None`
/// for other terms.
pub fn rise(
    term: NoiseType,
    truth: &Composite,
    parameters: &[Parameter],
    (layout, data, best): (&Layout, &Data, &Fit),
    record_s: f64,
) -> Option<f64> {
    if !SLOW.contains(&term) && term != NoiseType::RateRamp {
        return None;
    }
    let own = Parameter::Coefficient(term);
    let mut start = truth.with(own, 0.0);
    let mut free: Vec<Parameter> = parameters.iter().copied().filter(|p| *p != own).collect();
    for other in SLOW.into_iter().filter(|o| *o != term && truth.terms.coefficient(*o) == 0.0) {
        // As large as the term was, at a tenth of the record.
        let at = 0.1 * record_s;
        let ratio = unit_allan_variance(term, at) / unit_allan_variance(other, at);
        let share = truth.terms.coefficient(term).abs() * ratio.sqrt() / std::f64::consts::SQRT_2;
        start = start.with(Parameter::Coefficient(other), share);
        free.push(Parameter::Coefficient(other));
    }
    let rival = Oracle { layout, data, parameters: &free, start: &start };
    Some(rival.fit().deviance - best.deviance)
}
