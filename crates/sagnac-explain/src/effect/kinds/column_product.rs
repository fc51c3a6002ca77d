//! A contribution proportional to the product of two columns, or of one with the time. It has no kind of its own in the
//! format of explanations.

use crate::effect::mean;
use crate::effect::shared::polynomial::{Scale, sum};
use crate::effect::shared::reach::{reach, record, varies};
use crate::effect::shared::response::COEFFICIENTS_LIST;
use crate::effect::shared::search::gain_of;
use crate::effect::{
    Column, Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Starts, Values, list, number,
};
use crate::numeric::range::{Bounds, ends};

pub struct ColumnProduct;

static PARAMS: [Param; 5] = [
    Param::inner("pair", "", 0.0, 8.0),
    Param::inner("first_center", "", -1e9, 1e9),
    Param::inner("first_half_range", "", 1e-12, 1e9),
    Param::inner("second_center", "", -1e9, 1e9),
    Param::inner("second_half_range", "", 1e-12, 1e9),
];

describe! {
    ColumnProduct, "column_product", Mean in Temperature, needs [],
    confusers [SupplySensitivity, TempPolynomial, SfTemperature, UnobservedDriver],
    lists [
        Param::inner(COEFFICIENTS_LIST, "deg/h", -1e6, 1e6)
    ],
    properties [outside_format, free_form]
}

/// A factor of a product.
#[derive(Clone, Copy, PartialEq)]
enum Factor {
    Of(Column),
    Time,
}

use Column::{OuterRate, Supply, TableRate, Temperature};

/// The products. Temperature and rate of the table are left out: they have a kind of their own.
const FACTOR_PAIRS: [(Factor, Factor); 9] = [
    (Factor::Of(Temperature), Factor::Of(Supply)),
    (Factor::Of(Temperature), Factor::Of(OuterRate)),
    (Factor::Of(Temperature), Factor::Time),
    (Factor::Of(Supply), Factor::Of(TableRate)),
    (Factor::Of(Supply), Factor::Of(OuterRate)),
    (Factor::Of(Supply), Factor::Time),
    (Factor::Of(TableRate), Factor::Of(OuterRate)),
    (Factor::Of(TableRate), Factor::Time),
    (Factor::Of(OuterRate), Factor::Time),
];

fn values(factor: Factor, drivers: &Drivers) -> Option<Vec<f64>> {
    match factor {
        Factor::Of(column) => drivers.column(column).filter(|c| varies(Some(c))).map(<[f64]>::to_vec),
        Factor::Time => Some(drivers.of_time(|t| t)),
    }
}

fn domain(factor: Factor) -> Domain {
    match factor {
        Factor::Of(column) => column.domain(),
        Factor::Time => Domain::Time,
    }
}

fn pair(nonlinear_parameters: &[f64]) -> Option<(Factor, Factor)> {
    FACTOR_PAIRS.get(nonlinear_parameters.first()?.round() as usize).copied()
}

/// Middle and half width of a factor; a rate is not centred, since a product with it is zero at rest.
fn scale(factor: Factor, values: &[f64]) -> Scale {
    let Bounds { low, high } = ends(values);
    match factor {
        Factor::Of(TableRate | OuterRate) => {
            Scale { center: 0.0, half: low.abs().max(high.abs()).max(1e-12) }
        }
        _ => Scale::of(values),
    }
}

/// u v, u and v.
fn columns(
    (first, second): (Factor, Factor),
    scales: [Scale; 2],
    drivers: &Drivers,
) -> Option<[Vec<f64>; 3]> {
    let scaled = |factor, scale: Scale| -> Option<Vec<f64>> {
        Some(values(factor, drivers)?.into_iter().map(|v| scale.scaled(v)).collect())
    };
    let (u, v) = (scaled(first, scales[0])?, scaled(second, scales[1])?);
    Some([u.iter().zip(&v).map(|(u, v)| u * v).collect(), u, v])
}

fn own_scales((first, second): (Factor, Factor), drivers: &Drivers) -> Option<[Scale; 2]> {
    Some([scale(first, &values(first, drivers)?), scale(second, &values(second, drivers)?)])
}

impl MeanModel for ColumnProduct {
    fn applies(&self, drivers: &Drivers) -> bool {
        FACTOR_PAIRS.iter().any(|(a, b)| values(*a, drivers).is_some() && values(*b, drivers).is_some())
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let points = (0..FACTOR_PAIRS.len()).map(|i| vec![i as f64]);
        let scored = points.map(|point| (gain_of(self.regressors(&point, drivers), context), point));
        let scored: Vec<(f64, Vec<f64>)> = scored.filter(|(gain, _)| *gain > 0.0).collect();
        let trials = scored.len() as f64;
        Starts::best(scored, trials)
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![Bounds::new(0.0, (FACTOR_PAIRS.len() - 1) as f64)]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let columns = pair(nonlinear_parameters).and_then(|p| columns(p, own_scales(p, drivers)?, drivers));
        Regressors::columns(columns.into_iter().flatten())
    }

    fn parameters(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<f64> {
        let scales = pair(nonlinear_parameters).and_then(|p| own_scales(p, drivers));
        let [first, second] = scales.unwrap_or([Scale { center: f64::NAN, half: f64::NAN }; 2]);
        vec![mean::first(nonlinear_parameters), first.center, first.half, second.center, second.half]
    }

    fn linear_list(&self) -> Option<&'static str> {
        Some(COEFFICIENTS_LIST)
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let of = |i: usize| number(values, PARAMS[i].name);
        let scales = [Scale { center: of(1)?, half: of(2)? }, Scale { center: of(3)?, half: of(4)? }];
        let columns = columns(pair(&[of(0)?])?, scales, drivers)?;
        Some(sum(list(values, COEFFICIENTS_LIST), &columns))
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let Some((first, second)) = pair(nonlinear_parameters) else { return vec![] };
        let Some([product, ..]) =
            own_scales((first, second), drivers).and_then(|scales| columns((first, second), scales, drivers))
        else {
            return vec![];
        };
        let mut out = vec![];
        for factor in [first, second] {
            if factor == Factor::Time {
                out.extend(record(drivers));
            } else if let Some(values) = values(factor, drivers) {
                out.extend(reach(domain(factor), &values, &product));
            }
        }
        out
    }

    fn whole(&self) -> &'static [usize] {
        &[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_columns_of_a_product_are_what_its_formula_says() {
        let nine = |x: [f64; 3]| Some(x.repeat(3));
        let drivers = Drivers {
            dt_s: 2.0,
            samples: 9,
            averaged: 1,
            temperature: nine([10.0, 20.0, 30.0]),
            supply: nine([5.0, 4.0, 6.0]),
            ..Drivers::default()
        };
        let parts = ColumnProduct.regressors(&[0.0], &drivers);
        let begin: Vec<&[f64]> = parts.columns.iter().map(|c| &c[..3]).collect();
        assert_eq!(begin, [[0.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.0, -1.0, 1.0]]);
        assert!(ColumnProduct.regressors(&[1.0], &drivers).columns.is_empty(), "no rate of the other axis");
        let with_time = ColumnProduct.regressors(&[2.0], &drivers);
        assert_eq!(with_time.columns[0][..3], [1.0, -0.0, -0.5]);
    }
}
