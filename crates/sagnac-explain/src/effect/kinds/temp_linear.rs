//! A linear temperature coefficient that differs from the claimed one.

use crate::effect::shared::thermal::smooth;
use crate::effect::{Domain, Drivers, MeanModel, Nuisance, Param, Place};
use crate::numeric::range::{Bounds, ends};

pub struct TempLinear;

/// The coefficient in all, that of the claim included.
pub(super) const LINEAR_COEFFICIENT: Param =
    Param::reported("coefficient_deg_h_per_degC", "deg/h/°C", -1e5, 1e5).corrects_claim();

static PARAMS: [Param; 1] = [LINEAR_COEFFICIENT];

describe! {
    TempLinear, "temp_linear", Mean in Temperature, needs [Temperature],
    confusers [TempPolynomial, TempRate, ThermalLag],
    properties [slow, carried_over, law Linear]
}

/// The claimed coefficient, deg/h/°C; 0 where the claim states none.
pub(super) fn claimed(drivers: &Drivers) -> f64 {
    drivers.claim.temperature.map_or(0.0, |t| t.coefficient_deg_h_per_degc)
}

/// Temperature at which the claimed dependence is 0, °C.
pub(super) fn reference(drivers: &Drivers) -> f64 {
    drivers.claim.temperature.map_or(20.0, |t| t.reference_degc)
}

impl MeanModel for TempLinear {
    fn replaces(&self) -> Option<Nuisance> {
        Some(Nuisance::TemperatureCoefficient)
    }

    fn claimed_coefficient(&self, drivers: &Drivers) -> f64 {
        claimed(drivers)
    }

    /// The noise of the thermometer drives nothing: with it the coefficient comes out too small, the more so the larger the slow
    /// noise is taken to be.
    fn column(&self, _nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
        let from = reference(drivers);
        Some(smooth(drivers)?.iter().map(|t| t - from).collect())
    }

    fn places(&self, _nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let Some(t) = &drivers.temperature else { return vec![] };
        let Bounds { low: from, high: to } = ends(t);
        vec![Place { domain: Domain::Temperature, from, to }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::sizing::numbers;

    #[test]
    fn a_stated_coefficient_adds_what_it_exceeds_the_claimed_one_by() {
        let claimed = crate::effect::Temperature { coefficient_deg_h_per_degc: 0.1, reference_degc: 25.0 };
        let claim = crate::effect::ClaimedMean { temperature: Some(claimed), ..Default::default() };
        let drivers = Drivers { temperature: Some(vec![25.0, 35.0]), claim, ..Drivers::default() };
        let course = TempLinear.course(&numbers([("coefficient_deg_h_per_degC", 0.3)]), &drivers).unwrap();
        assert!(course[0] == 0.0 && (course[1] - 2.0).abs() < 1e-12, "{course:?}");
        assert_eq!(TempLinear.parameters(&[], &[0.2], &drivers), [0.1 + 0.2]);
    }
}
