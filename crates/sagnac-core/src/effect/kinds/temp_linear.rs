//! A linear temperature coefficient that differs from the claimed one.

use crate::effect::shared::thermal::smooth;
use crate::effect::{
    Column, Domain, Drivers, Effect, MeanModel, Model, Nuisance, Param, Place, Regressors, SearchContext,
    Sizing, Starts, Values, number,
};
use crate::numeric::range::{Bounds, ends};

pub struct TempLinear;

/// The coefficient in all, that of the claim included.
pub(super) const COEFFICIENT: Param =
    Param::reported("coefficient_deg_h_per_degC", "deg/h/°C", -1e5, 1e5).corrects_claim();

static PARAMS: [Param; 1] = [COEFFICIENT];

impl Effect for TempLinear {
    fn kind(&self) -> &'static str {
        "temp_linear"
    }
    fn params(&self) -> &'static [Param] {
        &PARAMS
    }
    fn needs(&self) -> &'static [Column] {
        &[Column::Temperature]
    }
    fn domain(&self) -> Domain {
        Domain::Temperature
    }
    fn confusers(&self) -> &'static [&'static str] {
        &["temp_polynomial", "temp_rate", "thermal_lag"]
    }
    fn model(&self) -> Model {
        Model::Mean(&TempLinear)
    }
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

    fn applies(&self, drivers: &Drivers) -> bool {
        crate::effect::shared::reach::varies(drivers.temperature.as_deref())
    }

    fn starts(&self, _drivers: &Drivers, _look: &SearchContext<'_>) -> Starts {
        Starts::linear()
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![]
    }

    fn regressors(&self, _shape: &[f64], drivers: &Drivers) -> Regressors {
        let from = reference(drivers);
        // The noise of the thermometer drives nothing: with it the coefficient comes out too small, the more so the larger the
        // slow noise is taken to be.
        let free = smooth(drivers).into_iter().map(|c| c.iter().map(|t| t - from).collect()).collect();
        Regressors { columns: free, ..Regressors::default() }
    }

    fn parameters(&self, _shape: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<f64> {
        vec![coefficients.first().map_or(f64::NAN, |c| c + claimed(drivers))]
    }

    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        vec![Sizing::linear(&PARAMS[0]).claimed(claimed(drivers))]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let extra = number(values, PARAMS[0].name)? - claimed(drivers);
        let from = reference(drivers);
        Some(smooth(drivers)?.iter().map(|t| extra * (t - from)).collect())
    }

    fn places(&self, _shape: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let Some(t) = &drivers.temperature else { return vec![] };
        let Bounds { low: from, high: to } = ends(t);
        vec![Place { domain: Domain::Temperature, from, to }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Value;

    #[test]
    fn a_stated_coefficient_adds_what_it_exceeds_the_claimed_one_by() {
        let claimed = crate::effect::Temperature { coefficient_deg_h_per_degc: 0.1, reference_degc: 25.0 };
        let claim = crate::effect::ClaimedMean { temperature: Some(claimed), ..Default::default() };
        let drivers = Drivers { temperature: Some(vec![25.0, 35.0]), claim, ..Drivers::default() };
        let course = TempLinear
            .course(&Values::from([("coefficient_deg_h_per_degC".to_owned(), Value::Number(0.3))]), &drivers)
            .unwrap();
        assert!(course[0] == 0.0 && (course[1] - 2.0).abs() < 1e-12, "{course:?}");
        assert_eq!(TempLinear.parameters(&[], &[0.2], &drivers), [0.1 + 0.2]);
    }
}
