//! The bias follows the history of the recorded temperature by more than one law at once: a curve, flow of heat through
//! layers, hysteresis. The law that explains most gives the finding its name.

use super::temp_hysteresis::TempHysteresis;
use super::temp_hysteresis_loops::TempHysteresisLoops;
use super::temp_linear::TempLinear;
use super::temp_linear_delayed::TempLinearDelayed;
use super::temp_polynomial::TempPolynomial;
use super::temp_rate::TempRate;
use super::temp_rate_delayed::TempRateDelayed;
use super::thermal_lag::ThermalLag;
use crate::effect::shared::polynomial::sum;
use crate::effect::shared::reach::reach;
use crate::effect::shared::response::{
    self, CENTER_NAME, COEFFICIENTS_LIST, HALF_RANGE, SCALES_LIST, TERMS_LIST,
};
use crate::effect::shared::thermal::smooth;
use crate::effect::{
    Domain, Drivers, Effect, MeanModel, Param, Place, Regressors, SearchContext, Starts, Unmodelled, Values,
};
use crate::numeric::range::Bounds;

pub struct TempResponse;

static PARAMS: [Param; 2] =
    [Param::inner(CENTER_NAME, "", -1e12, 1e12), Param::inner(HALF_RANGE, "", 1e-12, 1e12)];

describe! {
    TempResponse, "temp_response", Mean in Temperature, needs [Temperature],
    confusers [TempPolynomial, TempRate, ThermalLag, TempHysteresis],
    lists [
        Param::inner(TERMS_LIST, "", 1.0, 13.0),
        Param::inner(SCALES_LIST, "", 0.0, 1e9),
        Param::inner(COEFFICIENTS_LIST, "deg/h", -1e6, 1e6)
    ],
    properties [slow, carried_over, outside_format],
    with {
        fn named_by_law(&self) -> &'static [&'static dyn Effect] {
            const LAWS: &[&dyn Effect] = &[
                &TempPolynomial,
                &TempRate,
                &TempRateDelayed,
                &ThermalLag,
                &TempHysteresis,
                &TempHysteresisLoops,
                &TempLinear,
                &TempLinearDelayed,
            ];
            LAWS
        }
    }
}

fn mask(nonlinear_parameters: &[f64]) -> u32 {
    nonlinear_parameters.first().map_or(0, |m| *m as u32)
}

impl MeanModel for TempResponse {
    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let found = smooth(drivers).and_then(|t| response::search(t, drivers, context));
        let trials = found.as_ref().map_or(1.0, |f| f.trials);
        Starts { points: found.map(|f| vec![f64::from(f.mask)]).into_iter().collect(), trials }
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![Bounds::new(0.0, f64::from(u32::MAX))]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let t = smooth(drivers);
        t.map_or_else(Regressors::default, |t| response::regressors(mask(nonlinear_parameters), t, drivers))
    }

    fn parameters(
        &self,
        _nonlinear_parameters: &[f64],
        _coefficients: &[f64],
        drivers: &Drivers,
    ) -> Vec<f64> {
        smooth(drivers).map_or(vec![f64::NAN; 2], |t| response::stated_range(t).to_vec())
    }

    fn unmodelled(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> Unmodelled {
        Unmodelled { first_parameter: 0.0, ..response::ANY_SHAPE }
    }

    fn lists(
        &self,
        nonlinear_parameters: &[f64],
        coefficients: &[f64],
        _drivers: &Drivers,
    ) -> Vec<(&'static str, Vec<f64>)> {
        response::stated_lists(mask(nonlinear_parameters), coefficients)
    }

    fn same_cause(&self, _earlier: &[f64], _nonlinear_parameters: &[f64]) -> bool {
        true
    }

    fn linear_list(&self) -> Option<&'static str> {
        Some(COEFFICIENTS_LIST)
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        response::course(values, smooth(drivers)?, drivers)
    }

    fn nuisance_columns(&self, values: &Values, drivers: &Drivers) -> Vec<Vec<f64>> {
        response::initial_states(values, drivers)
    }

    fn places(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let columns = self.regressors(nonlinear_parameters, drivers).columns;
        let course = sum(coefficients, &columns);
        reach(Domain::Temperature, smooth(drivers).unwrap_or(&[]), &course)
    }

    fn whole(&self) -> &'static [usize] {
        &[0]
    }
}
