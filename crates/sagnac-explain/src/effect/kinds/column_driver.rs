//! The bias follows a recorded column that has no kind of its own: its value, its rate of change, a delayed or curved
//! function of it, or the direction from which a value was reached.

use crate::effect::shared::chance::follows_by_chance;
use crate::effect::shared::polynomial::sum;
use crate::effect::shared::reach::{reach, varies};
use crate::effect::shared::response::{
    self, CENTER_NAME, COEFFICIENTS_LIST, HALF_RANGE, SCALES_LIST, TERMS_LIST,
};
use crate::effect::{
    COLUMN_TEXT, Column, Domain, Drivers, MeanModel, OtherDriver, Param, Place, Regressors, ResponseLaw,
    SearchContext, Sizing, Starts, Unmodelled, Value, Values, text,
};
use crate::numeric::range::Bounds;

pub struct ColumnDriver;

static PARAMS: [Param; 3] = [
    Param::reported("coefficient", "", -1e12, 1e12).signed(),
    Param::inner(CENTER_NAME, "", -1e12, 1e12),
    Param::inner(HALF_RANGE, "", 1e-12, 1e12),
];

/// Name of the text that says by which law.
const LAW_TEXT: &str = "law";

describe! {
    ColumnDriver, "column_driver", Mean in Driver, needs [],
    confusers [UnobservedDriver, ExcessRrw, TempResponse],
    lists [
        Param::inner(TERMS_LIST, "", 1.0, 13.0),
        Param::inner(SCALES_LIST, "", 0.0, 1e9),
        Param::inner(COEFFICIENTS_LIST, "deg/h", -1e6, 1e6)
    ],
    texts [COLUMN_TEXT, LAW_TEXT],
    properties [slow, carried_over, follows_any_column]
}

/// A shape, from its nonlinear parameters: a column, terms, a law.
struct Shape<'a> {
    driver: &'a OtherDriver,
    mask: u32,
    law: ResponseLaw,
}

fn decode<'a>(nonlinear_parameters: &[f64], drivers: &'a Drivers) -> Option<Shape<'a>> {
    let [column, mask, law] = nonlinear_parameters else { return None };
    let driver = drivers.others.get(*column as usize)?;
    Some(Shape { driver, mask: *mask as u32, law: *ResponseLaw::ALL.get(*law as usize)? })
}

impl MeanModel for ColumnDriver {
    fn applies(&self, drivers: &Drivers) -> bool {
        drivers.others.iter().any(|o| varies(Some(&o.smooth)))
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let candidates = drivers.others.iter().enumerate().filter(|(_, o)| varies(Some(&o.smooth)));
        let columns = candidates.clone().count() as f64;
        let found = candidates.filter_map(|(i, other)| {
            let found = response::search(&other.smooth, drivers, context)?;
            (!follows_by_chance(&found, &other.smooth, drivers, context)).then_some((i, found))
        });
        let Some((i, best)) = found.max_by(|a, b| a.1.worth().total_cmp(&b.1.worth())) else {
            return Starts { trials: columns.max(1.0), ..Starts::none() };
        };
        let law = ResponseLaw::ALL.iter().position(|l| *l == best.law).unwrap_or(0);
        let point = vec![i as f64, f64::from(best.mask), law as f64];
        Starts { points: vec![point], trials: best.trials * columns }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        vec![
            Bounds::new(0.0, drivers.others.len().saturating_sub(1) as f64),
            Bounds::new(0.0, f64::from(u32::MAX)),
            Bounds::new(0.0, (ResponseLaw::ALL.len() - 1) as f64),
        ]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        decode(nonlinear_parameters, drivers)
            .map_or_else(Regressors::default, |m| response::regressors(m.mask, &m.driver.smooth, drivers))
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<f64> {
        let Some(m) = decode(nonlinear_parameters, drivers) else { return vec![f64::NAN; 3] };
        let [center, half] = response::stated_range(&m.driver.smooth);
        // A single term of a linear law or of a rate is a coefficient a unit of the column, or a unit of it an hour.
        let per_unit = response::per_unit(m.mask, m.law).map(|scale| scale / half);
        let coefficient = coefficients.first().zip(per_unit).map_or(f64::NAN, |(c, scale)| c * scale);
        vec![coefficient, center, half]
    }

    fn unmodelled(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Unmodelled {
        decode(nonlinear_parameters, drivers).map_or_else(Unmodelled::default, |m| {
            response::unmodelled(m.mask, m.law, &m.driver.smooth, drivers)
        })
    }

    fn lists(
        &self,
        nonlinear_parameters: &[f64],
        coefficients: &[f64],
        drivers: &Drivers,
    ) -> Vec<(&'static str, Vec<f64>)> {
        decode(nonlinear_parameters, drivers)
            .map_or_else(Vec::new, |m| response::stated_lists(m.mask, coefficients))
    }

    fn texts(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Vec<(&'static str, String)> {
        decode(nonlinear_parameters, drivers).map_or_else(Vec::new, |m| {
            vec![(COLUMN_TEXT, m.driver.column.name().to_owned()), (LAW_TEXT, m.law.id().to_owned())]
        })
    }

    fn same_cause(&self, earlier: &[f64], nonlinear_parameters: &[f64]) -> bool {
        earlier.first() == nonlinear_parameters.first()
    }

    /// Proportional to each column that varies.
    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        let varying = || drivers.others.iter().filter(|o| varies(Some(&o.smooth)));
        let trials = response::TERM_COUNT as f64 * varying().count() as f64;
        let of = |other: &OtherDriver| {
            let place = [(COLUMN_TEXT.to_owned(), Value::Text(other.column.name().to_owned()))].into();
            let sizing = Sizing::searched(&PARAMS[0], vec![place], 1, trials);
            Sizing { column: Some(other.column), ..sizing }
        };
        varying().map(of).collect()
    }

    fn sized_course(
        &self,
        _sizing: &Sizing,
        place: &Values,
        size: f64,
        drivers: &Drivers,
    ) -> Option<Vec<f64>> {
        let column = Column::of_name(text(place, COLUMN_TEXT)?);
        let driver = drivers.others.iter().find(|o| o.column == column)?;
        Some(driver.smooth.iter().map(|x| size * x).collect())
    }

    /// The curve of first order in the units of the column.
    fn claimed_size(&self, _sizing: &Sizing, place: &Values, size: f64, drivers: &Drivers) -> Values {
        let column = text(place, COLUMN_TEXT).map(Column::of_name);
        let driver = drivers.others.iter().find(|o| Some(o.column) == column);
        let [center, half] = driver.map_or([0.0, 1.0], |d| response::stated_range(&d.smooth));
        let lists = response::stated_lists(response::FIRST_ORDER, &[size * half]).into_iter();
        let lists = lists.map(|(name, list)| (name.to_owned(), Value::List(list)));
        let numbers = [(PARAMS[0].name, size), (CENTER_NAME, center), (HALF_RANGE, half)];
        let numbers = numbers.map(|(name, value)| (name.to_owned(), Value::Number(value)));
        let law = (LAW_TEXT.to_owned(), Value::Text(ResponseLaw::Linear.id().to_owned()));
        place.clone().into_iter().chain(lists).chain(numbers).chain([law]).collect()
    }

    fn linear_list(&self) -> Option<&'static str> {
        Some(COEFFICIENTS_LIST)
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let column = Column::of_name(text(values, COLUMN_TEXT)?);
        let driver = drivers.others.iter().find(|o| o.column == column)?;
        response::course(values, &driver.smooth, drivers)
    }

    fn nuisance_columns(&self, values: &Values, drivers: &Drivers) -> Vec<Vec<f64>> {
        response::initial_states(values, drivers)
    }

    fn places(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let Some(m) = decode(nonlinear_parameters, drivers) else { return vec![] };
        let course = sum(coefficients, &self.regressors(nonlinear_parameters, drivers).columns);
        reach(Domain::Driver, &m.driver.smooth, &course)
    }

    fn whole(&self) -> &'static [usize] {
        &[0, 1, 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stated_driver_is_found_by_the_name_of_its_column() {
        let pressure: Vec<f64> = (0..50).map(|i| 1000.0 + f64::from(i)).collect();
        let other = OtherDriver {
            column: Column::of_name("pressure_hPa"),
            values: pressure.clone(),
            smooth: pressure,
        };
        let drivers =
            Drivers { dt_s: 60.0, samples: 50, averaged: 1, others: vec![other], ..Drivers::default() };
        let mut stated: Values = response::stated_lists(1, &[2.0])
            .into_iter()
            .map(|(n, l)| (n.to_owned(), Value::List(l)))
            .collect();
        stated.insert(CENTER_NAME.to_owned(), Value::Number(1000.0));
        stated.insert(HALF_RANGE.to_owned(), Value::Number(50.0));
        stated.insert(COLUMN_TEXT.to_owned(), Value::Text("pressure_hPa".to_owned()));
        // 2 deg/h for each 50 hPa.
        let course = ColumnDriver.course(&stated, &drivers).unwrap();
        assert!((course[25] - 1.0).abs() < 1e-12, "{}", course[25]);
        let [coefficient, ..] = ColumnDriver.parameters(&[0.0, 1.0, 0.0], &[2.0], &drivers)[..] else {
            panic!("no coefficient")
        };
        assert!((coefficient - 2.0 / 24.5).abs() < 1e-12);
        stated.insert(COLUMN_TEXT.to_owned(), Value::Text("humidity".to_owned()));
        assert!(ColumnDriver.course(&stated, &drivers).is_none());
    }
}
