//! A scale factor that follows a recorded column other than temperature.

use super::sf_temperature::{self, is_moving};
use crate::effect::mean::first;
use crate::effect::shared::reach::{large_rates, reach, varies};
use crate::effect::sizing::numbers;
use crate::effect::{
    COLUMN_TEXT, Column, Drivers, MeanModel, Param, Place, SearchContext, Sizing, Starts, Value, Values,
    number, text,
};
use crate::numeric::range::Bounds;

pub struct SfDriver;

static PARAMS: [Param; 2] = [
    Param::reported("coefficient_ppm", "ppm", -1e9, 1e9).signed(),
    Param::inner("reference", "", -1e12, 1e12),
];

describe! {
    SfDriver, "sf_driver", Mean in InputRate, needs [TableRate],
    confusers [SfTemperature, SfError, ColumnProduct],
    texts [COLUMN_TEXT],
    properties [carried_over]
}

/// Columns that the scale factor may follow.
fn columns(drivers: &Drivers) -> Vec<Column> {
    let follows = |c: &Column| (*c == Column::Supply || c.is_other()) && varies(drivers.column(*c));
    drivers.columns().filter(follows).collect()
}

/// The column that a nonlinear parameter selects.
fn decode(nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Column> {
    let index = nonlinear_parameters.first()?.round() as usize;
    drivers.columns().nth(index)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The product that a column makes with the rate, deg/h for 1 ppm a unit.
fn product(column: Column, reference: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    sf_temperature::product(drivers.column(column)?, reference, drivers)
}

impl MeanModel for SfDriver {
    fn applies(&self, drivers: &Drivers) -> bool {
        is_moving(drivers) && !columns(drivers).is_empty()
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let candidates = columns(drivers);
        let trials = candidates.len() as f64;
        let scored = |column: Column| {
            let reference = mean(drivers.column(column)?);
            let index = drivers.columns().position(|c| c == column)?;
            Some((context.gain(&product(column, reference, drivers)?), vec![index as f64]))
        };
        Starts::best(candidates.into_iter().filter_map(scored), trials)
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        vec![Bounds::new(0.0, drivers.columns().count().saturating_sub(1) as f64)]
    }

    fn column(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
        let column = decode(nonlinear_parameters, drivers)?;
        product(column, mean(drivers.column(column)?), drivers)
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<f64> {
        let reference = decode(nonlinear_parameters, drivers).and_then(|c| Some(mean(drivers.column(c)?)));
        vec![first(coefficients), reference.unwrap_or(f64::NAN)]
    }

    fn texts(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Vec<(&'static str, String)> {
        let column = decode(nonlinear_parameters, drivers);
        column.map(|c| (COLUMN_TEXT, c.name().to_owned())).into_iter().collect()
    }

    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        let candidates = columns(drivers);
        let trials = candidates.len() as f64;
        let of = |column: &Column| {
            let reference = mean(drivers.column(*column)?);
            let texts = [(COLUMN_TEXT.to_owned(), Value::Text(column.name().to_owned()))];
            let place = texts.into_iter().chain(numbers([(PARAMS[1].name, reference)])).collect();
            let sizing = Sizing::searched(&PARAMS[0], vec![place], 1, trials);
            Some(Sizing { column: Some(*column), ..sizing })
        };
        candidates.iter().filter_map(of).collect()
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let column = Column::of_name(text(values, COLUMN_TEXT)?);
        let (coefficient, reference) =
            (number(values, PARAMS[0].name)?, number(values, PARAMS[1].name).unwrap_or(0.0));
        Some(product(column, reference, drivers)?.into_iter().map(|x| coefficient * x).collect())
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let mut out = large_rates(drivers);
        if let Some(column) = decode(nonlinear_parameters, drivers) {
            let product = self.column(nonlinear_parameters, drivers);
            let values = drivers.column(column).unwrap_or(&[]);
            out.extend(product.iter().flat_map(|p| reach(column.domain(), values, p)));
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
