//! Static nonlinear dependence of the bias on temperature.

use crate::effect::shared::polynomial::{Scale, powers, sum};
use crate::effect::shared::reach::reach;
use crate::effect::shared::response::{self, COEFFICIENTS_LIST};
use crate::effect::shared::search::gain_of;
use crate::effect::shared::thermal::smooth;
use crate::effect::{
    Domain, Drivers, MeanModel, Nuisance, Param, Place, Regressors, SearchContext, Starts, Unmodelled,
    Values, list, number,
};
use crate::numeric::range::{Bounds, ends};

pub struct TempPolynomial;

static PARAMS: [Param; 2] =
    [Param::inner("center_degC", "°C", -200.0, 300.0), Param::inner("half_range_degC", "°C", 1e-9, 500.0)];

describe! {
    TempPolynomial, "temp_polynomial", Mean in Temperature, needs [Temperature],
    confusers [TempLinear, TempHysteresis, TempRate],
    lists [
        Param::inner(COEFFICIENTS_LIST, "deg/h", -1e6, 1e6)
    ],
    properties [slow, carried_over, law Curve]
}

/// Middle and half width of the temperatures.
fn scale(drivers: &Drivers) -> Option<Scale> {
    let Bounds { low, high } = ends(smooth(drivers)?);
    (high > low).then_some(Scale { center: 0.5 * (low + high), half: 0.5 * (high - low) })
}

/// Order of a shape.
fn order(nonlinear_parameters: &[f64]) -> usize {
    nonlinear_parameters.first().map_or(2, |o| o.round().clamp(2.0, 4.0) as usize)
}

impl MeanModel for TempPolynomial {
    fn replaces(&self) -> Option<Nuisance> {
        Some(Nuisance::TemperatureCoefficient)
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        // Each further order must pay for its parameter.
        let price = 0.5 * (drivers.samples.max(2) as f64).ln();
        let scored = (2..=4).map(|order| {
            let point = vec![f64::from(order)];
            (gain_of(self.regressors(&point, drivers), context) - price * f64::from(order), point)
        });
        Starts::best(scored, 3.0)
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![Bounds::new(2.0, 4.0)]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let scaled = smooth(drivers).zip(scale(drivers));
        let powers = scaled.map(|(t, scale)| powers(t, scale, order(nonlinear_parameters)));
        Regressors::columns(powers.into_iter().flatten())
    }

    fn parameters(
        &self,
        _nonlinear_parameters: &[f64],
        _coefficients: &[f64],
        drivers: &Drivers,
    ) -> Vec<f64> {
        scale(drivers).map_or(vec![f64::NAN; 2], |s| vec![s.center, s.half])
    }

    fn lists(
        &self,
        _nonlinear_parameters: &[f64],
        coefficients: &[f64],
        _drivers: &Drivers,
    ) -> Vec<(&'static str, Vec<f64>)> {
        vec![(COEFFICIENTS_LIST, coefficients.to_vec())]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let (center, half) = (number(values, PARAMS[0].name)?, number(values, PARAMS[1].name)?);
        let coefficients = list(values, COEFFICIENTS_LIST);
        if coefficients.is_empty() || half.is_nan() || half <= 0.0 {
            return None;
        }
        let order = coefficients.len().min(12);
        Some(sum(coefficients, &powers(smooth(drivers)?, Scale { center, half }, order)))
    }

    fn places(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let contribution = sum(coefficients, &self.regressors(nonlinear_parameters, drivers).columns);
        reach(Domain::Temperature, smooth(drivers).unwrap_or(&[]), &contribution)
    }

    fn unmodelled(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> Unmodelled {
        Unmodelled { first_parameter: 0.0, ..response::ANY_SHAPE }
    }

    fn whole(&self) -> &'static [usize] {
        &[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Value;
    use crate::effect::sizing::numbers;

    #[test]
    fn orders_are_powers_of_the_temperature_from_minus_one_to_one() {
        let drivers = Drivers { temperature: Some(vec![10.0, 30.0, 50.0]), ..Drivers::default() };
        let columns = TempPolynomial.regressors(&[3.0], &drivers).columns;
        assert_eq!(columns, [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]]);
        assert_eq!(TempPolynomial.parameters(&[3.0], &[], &drivers), [30.0, 20.0]);
        let mut stated = numbers([("center_degC", 20.0), ("half_range_degC", 10.0)]);
        stated.insert(COEFFICIENTS_LIST.to_owned(), Value::List(vec![0.5, -0.25]));
        // At 10, 30 and 50 °C: x = −1, 1, 3.
        assert_eq!(TempPolynomial.course(&stated, &drivers).unwrap(), [-0.75, 0.25, -0.75]);
    }
}
