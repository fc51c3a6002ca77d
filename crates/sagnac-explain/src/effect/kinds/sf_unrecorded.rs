//! A scale factor that follows a quantity which was not recorded: it changes smoothly over the record. It is reported as a scale
//! factor that follows a driver, without a column.

use super::sf_temperature::is_moving;
use crate::effect::shared::polynomial::sum;
use crate::effect::shared::reach::{large_rates, record};
use crate::effect::shared::search::gain_of;
use crate::effect::{
    Drivers, MeanModel, Param, Place, Regressors, SearchContext, Starts, Values, list, number,
};
use crate::numeric::range::Bounds;
use std::f64::consts::PI;

pub struct SfUnrecorded;

static PARAMS: [Param; 2] =
    [Param::inner("start_s", "s", -1e12, 1e12), Param::inner("length_s", "s", 1e-6, 1e12)];

/// Name of the list of the coefficients of the cosines, ppm.
const COEFFICIENTS_LIST: &str = "coefficients_ppm";
/// Most cosines: the shortest period is a fourth of the record.
const MAX_COSINES: usize = 8;

describe! {
    SfUnrecorded, "sf_unrecorded", Mean in InputRate, needs [TableRate],
    confusers [SfDriver, SfTemperature, SfError],
    lists [Param::inner(COEFFICIENTS_LIST, "ppm", -1e9, 1e9)],
    properties [reported_as SfDriver, free_form]
}

/// Rate of the table times cosines over a time, deg/h for 1 ppm.
fn columns(start_s: f64, length_s: f64, count: usize, drivers: &Drivers) -> Vec<Vec<f64>> {
    let Some(rate) = &drivers.table_rate else { return vec![] };
    let cosine = |k: usize, i: usize| (PI * k as f64 * (drivers.time_s(i) - start_s) / length_s).cos();
    let one =
        |k: usize| rate.iter().enumerate().map(|(i, r)| 3600e-6 * r * cosine(k, i)).collect::<Vec<f64>>();
    (1..=count).map(one).collect()
}

impl MeanModel for SfUnrecorded {
    fn applies(&self, drivers: &Drivers) -> bool {
        is_moving(drivers) && drivers.table_rate.as_ref().is_some_and(|r| r.len() >= 64)
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        if !self.applies(drivers) || !context.is_of(drivers.samples) {
            return Starts::none();
        }
        let price = 0.5 * (drivers.samples as f64).ln();
        let all = columns(drivers.time_s(0), drivers.length_s(), MAX_COSINES, drivers);
        let scored = (1..=MAX_COSINES).map(|count| {
            let gain = gain_of(Regressors::columns(all[..count].iter().cloned()), context);
            (gain - price * count as f64, vec![count as f64])
        });
        Starts::best(scored, MAX_COSINES as f64)
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![Bounds::new(1.0, MAX_COSINES as f64)]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let count = nonlinear_parameters.first().map_or(0, |c| c.round() as usize);
        Regressors::columns(columns(drivers.time_s(0), drivers.length_s(), count, drivers))
    }

    fn parameters(
        &self,
        _nonlinear_parameters: &[f64],
        _coefficients: &[f64],
        drivers: &Drivers,
    ) -> Vec<f64> {
        vec![drivers.time_s(0), drivers.length_s()]
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
        let of = |i: usize| number(values, PARAMS[i].name);
        let coefficients = list(values, COEFFICIENTS_LIST);
        let columns = columns(of(0)?, of(1)?, coefficients.len(), drivers);
        (!columns.is_empty()).then(|| sum(coefficients, &columns))
    }

    fn places(&self, _nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let mut out = large_rates(drivers);
        if !out.is_empty() {
            out.extend(record(drivers));
        }
        out
    }

    fn whole(&self) -> &'static [usize] {
        &[0]
    }

    // A column that explains the change is the simpler cause, and so is a law of the rate itself.
    fn odds(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> f64 {
        -3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Effect as _, Value};

    #[test]
    fn a_change_over_the_record_multiplies_the_rate() {
        let drivers = Drivers {
            dt_s: 1.0,
            samples: 101,
            averaged: 1,
            table_rate: Some((0..101).map(|i| if i % 2 == 0 { 10.0 } else { -5.0 }).collect()),
            ..Drivers::default()
        };
        let stated = Values::from([
            ("start_s".to_owned(), Value::Number(0.0)),
            ("length_s".to_owned(), Value::Number(100.0)),
            (COEFFICIENTS_LIST.to_owned(), Value::List(vec![20.0])),
        ]);
        let course = SfUnrecorded.course(&stated, &drivers).unwrap();
        // 20 ppm of 36 000 deg/h at the start, nothing in the middle, as much the other way at the end.
        assert!((course[0] - 0.72).abs() < 1e-12 && course[50].abs() < 1e-12, "{course:?}");
        assert!((course[100] + 0.72).abs() < 1e-12 && (course[1] + 0.36 * 0.999_506_56).abs() < 1e-6);
        assert_eq!(SfUnrecorded.reported_kind(), "sf_driver");
    }
}
