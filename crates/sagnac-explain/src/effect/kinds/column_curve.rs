//! A bent dependence on a column whose bends have no kind of their own in the format of explanations.

use crate::effect::mean::first;
use crate::effect::shared::polynomial::{Scale, powers, sum};
use crate::effect::shared::reach::{reach, varies};
use crate::effect::shared::response::COEFFICIENTS_LIST;
use crate::effect::shared::search::gain_of;
use crate::effect::shared::thermal;
use crate::effect::{
    Column, Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Starts, Values, list, number,
};
use crate::numeric::range::Bounds;

pub struct ColumnCurve;

static PARAMS: [Param; 3] = [
    Param::inner("column", "", 0.0, 3.0),
    Param::inner("center", "", -1e9, 1e9),
    Param::inner("half_range", "", 1e-12, 1e9),
];

describe! {
    ColumnCurve, "column_curve", Mean in Supply, needs [],
    confusers [SupplySensitivity, CrossAxis, TempRate, SfAsymmetry],
    lists [
        Param::inner(COEFFICIENTS_LIST, "deg/h", -1e6, 1e6)
    ],
    properties [carried_over, outside_format, free_form]
}

/// Quantities that the curve may follow: supply, rate of the other axis, rate of change of temperature, rate of the table.
const CURVE_DOMAINS: [Domain; 4] =
    [Domain::Supply, Domain::OuterRate, Domain::TemperatureRate, Domain::InputRate];
/// Highest power.
const MAX_ORDER: usize = 4;

fn values(domain: Domain, drivers: &Drivers) -> Option<Vec<f64>> {
    let column = |c: Column| drivers.column(c).filter(|x| varies(Some(x))).map(<[f64]>::to_vec);
    match domain {
        Domain::Supply => column(Column::Supply),
        Domain::OuterRate => column(Column::OuterRate),
        Domain::InputRate => column(Column::TableRate),
        Domain::TemperatureRate => {
            varies(drivers.temperature.as_deref()).then(|| thermal::rate(drivers)).flatten()
        }
        _ => None,
    }
}

/// Column and highest power of a shape.
fn decode(nonlinear_parameters: &[f64]) -> Option<(Domain, usize)> {
    let [column, order] = nonlinear_parameters else { return None };
    Some((*CURVE_DOMAINS.get(column.round() as usize)?, (order.round() as usize).clamp(2, MAX_ORDER)))
}

impl MeanModel for ColumnCurve {
    fn applies(&self, drivers: &Drivers) -> bool {
        CURVE_DOMAINS.iter().any(|d| values(*d, drivers).is_some())
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        // Each further order must pay for its parameter.
        let price = 0.5 * (drivers.samples.max(2) as f64).ln();
        let mut scored: Vec<(f64, Vec<f64>)> = vec![];
        for (i, _) in CURVE_DOMAINS.iter().enumerate().filter(|(_, d)| values(**d, drivers).is_some()) {
            for order in 2..=MAX_ORDER {
                let point = vec![i as f64, order as f64];
                let gain = gain_of(self.regressors(&point, drivers), context);
                scored.push((gain - price * order as f64, point));
            }
        }
        let trials = scored.len() as f64;
        Starts::best(scored, trials)
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![Bounds::new(0.0, (CURVE_DOMAINS.len() - 1) as f64), Bounds::new(2.0, MAX_ORDER as f64)]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let shape = decode(nonlinear_parameters);
        let values = shape.and_then(|(domain, order)| Some((values(domain, drivers)?, order)));
        Regressors::columns(values.into_iter().flat_map(|(v, order)| powers(&v, Scale::of(&v), order)))
    }

    fn parameters(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<f64> {
        let scale =
            decode(nonlinear_parameters).and_then(|(domain, _)| Some(Scale::of(&values(domain, drivers)?)));
        let Scale { center, half } = scale.unwrap_or(Scale { center: f64::NAN, half: f64::NAN });
        vec![first(nonlinear_parameters), center, half]
    }

    fn linear_list(&self) -> Option<&'static str> {
        Some(COEFFICIENTS_LIST)
    }

    fn course(&self, given: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let of = |i: usize| number(given, PARAMS[i].name);
        let coefficients = list(given, COEFFICIENTS_LIST);
        let order = coefficients.len().clamp(1, MAX_ORDER);
        let (domain, _) = decode(&[of(0)?, order as f64])?;
        let half = of(2).filter(|h| *h > 0.0)?;
        Some(sum(coefficients, &powers(&values(domain, drivers)?, Scale { center: of(1)?, half }, order)))
    }

    fn places(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let Some((domain, _)) = decode(nonlinear_parameters) else { return vec![] };
        let Some(values) = values(domain, drivers) else { return vec![] };
        reach(domain, &values, &sum(coefficients, &self.regressors(nonlinear_parameters, drivers).columns))
    }

    fn whole(&self) -> &'static [usize] {
        &[0, 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_of_the_supply_is_a_polynomial_of_it() {
        let supply: Vec<f64> = (0..=20).map(|i| 4.0 + 0.1 * f64::from(i)).collect();
        let drivers =
            Drivers { dt_s: 1.0, samples: 21, averaged: 1, supply: Some(supply), ..Drivers::default() };
        let parts = ColumnCurve.regressors(&[0.0, 3.0], &drivers);
        assert_eq!(parts.columns.len(), 3);
        for (k, column) in parts.columns.iter().enumerate() {
            assert!((column[0] - (-1f64).powi(k as i32 + 1)).abs() < 1e-12 && column[10].abs() < 1e-12);
        }
        assert!(
            ColumnCurve.regressors(&[1.0, 2.0], &drivers).columns.is_empty(),
            "no rate of the other axis"
        );
    }
}
