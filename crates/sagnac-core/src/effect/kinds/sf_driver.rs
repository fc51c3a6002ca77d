//! A scale factor that follows a recorded column other than temperature.

use crate::effect::shared::reach::{large_rates, reach, varies};
use crate::effect::sizing::numbers;
use crate::effect::{
    Column, Domain, Drivers, MeanModel, Param, Place, Regressors, Resolution, SearchContext, Sizing, Starts,
    Value, Values, number, text,
};
use crate::numeric::range::Bounds;

pub struct SfDriver;

static PARAMS: [Param; 2] = [
    Param::reported("coefficient_ppm", "ppm", -1e9, 1e9).signed(),
    Param::inner("reference", "", -1e12, 1e12),
];

/// Name of the text that says which column.
const COLUMN: &str = "column";

describe! {
    SfDriver, "sf_driver", Mean in InputRate, needs [TableRate],
    confusers ["sf_temperature", "sf_error", "column_product"],
    with {
        fn text_params(&self) -> &'static [&'static str] {
            &[COLUMN]
        }
    }
}

/// Columns that the scale factor may follow.
fn columns(drivers: &Drivers) -> Vec<Column> {
    let follows = |c: &Column| (*c == Column::Supply || c.is_other()) && varies(drivers.column(*c));
    drivers.columns().filter(follows).collect()
}

/// The column that a nonlinear parameter stands for.
fn meant(nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Column> {
    let index = nonlinear_parameters.first()?.round() as usize;
    drivers.columns().nth(index)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Rate times the departure of the column from a reference, deg/h for 1 ppm a unit.
fn product(column: Column, reference: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    let (rate, values) = (drivers.table_rate.as_ref()?, drivers.column(column)?);
    Some(rate.iter().zip(values).map(|(r, v)| 3600e-6 * r * (v - reference)).collect())
}

impl MeanModel for SfDriver {
    fn resolution(&self) -> Resolution {
        Resolution::FullRate
    }

    fn applies(&self, drivers: &Drivers) -> bool {
        let moving = drivers.table_rate.as_ref().is_some_and(|r| r.iter().any(|r| *r != 0.0));
        moving && !columns(drivers).is_empty()
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let candidates = columns(drivers);
        let trials = candidates.len() as f64;
        let gain = |column: Column| {
            let reference = mean(drivers.column(column)?);
            let index = drivers.columns().position(|c| c == column)?;
            Some((index, context.gain(&product(column, reference, drivers)?)))
        };
        let best = candidates.into_iter().filter_map(gain).max_by(|a, b| a.1.total_cmp(&b.1));
        Starts { points: best.map(|(i, _)| vec![i as f64]).into_iter().collect(), trials }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        vec![Bounds::new(0.0, drivers.columns().count().saturating_sub(1) as f64)]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let column = meant(nonlinear_parameters, drivers);
        let product = column.and_then(|c| product(c, mean(drivers.column(c)?), drivers));
        Regressors { columns: product.into_iter().collect(), ..Regressors::default() }
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<f64> {
        let reference = meant(nonlinear_parameters, drivers).and_then(|c| Some(mean(drivers.column(c)?)));
        vec![coefficients.first().copied().unwrap_or(f64::NAN), reference.unwrap_or(f64::NAN)]
    }

    fn texts(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Vec<(&'static str, String)> {
        let column = meant(nonlinear_parameters, drivers);
        column.map(|c| (COLUMN, c.name().to_owned())).into_iter().collect()
    }

    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        let candidates = columns(drivers);
        let trials = candidates.len() as f64;
        let of = |column: &Column| {
            let reference = mean(drivers.column(*column)?);
            let texts = [(COLUMN.to_owned(), Value::Text(column.name().to_owned()))];
            let place = texts.into_iter().chain(numbers([(PARAMS[1].name, reference)])).collect();
            let sizing = Sizing::searched(&PARAMS[0], vec![place], 1, trials);
            Some(Sizing { column: Some(*column), ..sizing })
        };
        candidates.iter().filter_map(of).collect()
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let column = Column::of_name(text(values, COLUMN)?);
        let (coefficient, reference) =
            (number(values, PARAMS[0].name)?, number(values, PARAMS[1].name).unwrap_or(0.0));
        Some(product(column, reference, drivers)?.into_iter().map(|x| coefficient * x).collect())
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let mut out = large_rates(drivers);
        if let Some(column) = meant(nonlinear_parameters, drivers) {
            let domain = if column == Column::Supply { Domain::Supply } else { Domain::Driver };
            let product = self.regressors(nonlinear_parameters, drivers).columns;
            let values = drivers.column(column).unwrap_or(&[]);
            out.extend(product.first().into_iter().flat_map(|p| reach(domain, values, p)));
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
    use crate::effect::Value;

    #[test]
    fn the_scale_factor_is_the_claimed_one_at_the_reference() {
        let drivers = Drivers {
            table_rate: Some(vec![10.0, 10.0]),
            supply: Some(vec![5.0, 5.5]),
            ..Drivers::default()
        };
        let stated = Values::from([
            ("coefficient_ppm".to_owned(), Value::Number(40.0)),
            ("reference".to_owned(), Value::Number(5.0)),
            ("column".to_owned(), Value::Text("supply_v".to_owned())),
        ]);
        // 36 000 deg/h · 20 ppm.
        let course = SfDriver.course(&stated, &drivers).unwrap();
        assert!(course[0] == 0.0 && (course[1] - 0.72).abs() < 1e-12, "{course:?}");
    }
}
