//! A bias that depends on the direction from which a temperature was reached, as a sum of loops of several widths: large turns
//! of the temperature and small ones leave their own. It is reported as temperature hysteresis.

use super::temp_hysteresis::{LOOP_WIDTH, reverses};
use crate::effect::shared::polynomial::sum;
use crate::effect::shared::reach::{reach, varies};
use crate::effect::shared::response::{ANY_SHAPE, COEFFICIENTS_LIST, PLAY_WIDTHS, play};
use crate::effect::shared::thermal::smooth;
use crate::effect::{Domain, Drivers, MeanModel, Param, Place, Regressors, Unmodelled, Values, list, number};
use crate::numeric::range::{Bounds, ends};

pub struct TempHysteresisLoops;

static PARAMS: [Param; 3] = [
    LOOP_WIDTH,
    Param::inner("middle_degC", "°C", -300.0, 1000.0),
    Param::inner("half_range_degC", "°C", 1e-6, 1000.0),
];

/// Number of parts of the range of the temperature in which its branches are compared.
const TEMPERATURE_BINS: usize = 24;
/// Number of points of the record at which they are compared.
const COMPARED_POINTS: usize = 2000;
/// Change from one such point to the next, in parts of the range, below which a temperature neither rises nor falls.
const STEADY_CHANGE: f64 = 0.002;
describe! {
    TempHysteresisLoops, "temp_hysteresis_loops", Mean in Temperature, needs [Temperature],
    confusers [TempHysteresis, TempRateDelayed, ThermalLag],
    lists [Param::inner(COEFFICIENTS_LIST, "deg/h", -1e6, 1e6)],
    properties [slow, reported_as TempHysteresis]
}

/// The temperature in units of half its range, and the state of each play.
fn columns(t: &[f64], middle: f64, half: f64) -> Vec<Vec<f64>> {
    let scaled: Vec<f64> = t.iter().map(|t| (t - middle) / half).collect();
    let states: Vec<Vec<f64>> = PLAY_WIDTHS.iter().map(|width| play(&scaled, *width)).collect();
    std::iter::once(scaled).chain(states).collect()
}

/// Middle and half of the range of the recorded temperature.
fn range(t: &[f64]) -> [f64; 2] {
    let Bounds { low, high } = ends(t);
    [0.5 * (low + high), 0.5 * (high - low)]
}

/// Largest difference of a course between rising and falling temperature in one of [`TEMPERATURE_BINS`] parts of its range; NaN where no part
/// was passed in both directions.
fn widest(t: &[f64], course: &[f64]) -> f64 {
    let Bounds { low, high } = ends(t);
    let step = (t.len() / COMPARED_POINTS).max(1);
    let mut sums = [[(0.0, 0.0); 2]; TEMPERATURE_BINS];
    for i in (step..t.len().min(course.len())).step_by(step) {
        let change = t[i] - t[i - step];
        if change.abs() > STEADY_CHANGE * (high - low) {
            let bin = ((t[i] - low) / (high - low) * TEMPERATURE_BINS as f64) as usize;
            let (sum, count) = &mut sums[bin.min(TEMPERATURE_BINS - 1)][usize::from(change > 0.0)];
            *sum += course[i];
            *count += 1.0;
        }
    }
    let both = sums.iter().filter(|[down, up]| down.1 > 0.0 && up.1 > 0.0);
    both.map(|[down, up]| (up.0 / up.1 - down.0 / down.1).abs()).fold(f64::NAN, f64::max)
}

impl MeanModel for TempHysteresisLoops {
    /// A temperature that never turns has no second branch.
    fn applies(&self, drivers: &Drivers) -> bool {
        smooth(drivers).is_some_and(|t| varies(Some(t)) && reverses(t))
    }

    fn regressors(&self, _nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let columns = smooth(drivers).map(|t| {
            let [middle, half] = range(t);
            columns(t, middle, half)
        });
        Regressors::columns(columns.into_iter().flatten())
    }

    fn parameters(&self, _nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<f64> {
        let Some(t) = smooth(drivers) else { return vec![f64::NAN; 3] };
        let [middle, half] = range(t);
        let states = columns(t, middle, half).split_off(1);
        vec![widest(t, &sum(coefficients.get(1..).unwrap_or(&[]), &states)), middle, half]
    }

    fn unmodelled(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> Unmodelled {
        ANY_SHAPE
    }

    fn linear_list(&self) -> Option<&'static str> {
        Some(COEFFICIENTS_LIST)
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let [middle, half] = [1, 2].map(|i: usize| number(values, PARAMS[i].name));
        let (middle, half) = (middle?, half.filter(|h| *h > 0.0)?);
        let coefficients = list(values, COEFFICIENTS_LIST);
        let columns = columns(smooth(drivers)?, middle, half);
        (coefficients.len() == columns.len()).then(|| sum(coefficients, &columns))
    }

    fn places(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let course = sum(coefficients, &self.regressors(nonlinear_parameters, drivers).columns);
        reach(Domain::Temperature, smooth(drivers).unwrap_or(&[]), &course)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::sizing::numbers;

    #[test]
    fn branches_are_apart_by_the_sum_of_the_states_where_all_have_turned() {
        let swing = |i: usize| 20.0 - 10.0 * (4.0 * std::f64::consts::PI * i as f64 / 2000.0).cos();
        let t: Vec<f64> = (0..2000).map(swing).collect();
        let drivers =
            Drivers { dt_s: 1.0, samples: 2000, temperature: Some(t.clone()), ..Drivers::default() };
        let coefficients = [0.3, 0.1, 0.2, 0.0, 0.0];
        let mut stated: Values = numbers([(PARAMS[1].name, 20.0), (PARAMS[2].name, 10.0)]);
        stated.insert(COEFFICIENTS_LIST.to_owned(), crate::effect::Value::List(coefficients.to_vec()));
        let course = TempHysteresisLoops.course(&stated, &drivers).unwrap();
        // The middle of a heating and of the next cooling.
        let (up, down) = (250, 750);
        assert!((t[up] - t[down]).abs() < 1e-9 && (course[up] - course[down] - 0.3).abs() < 1e-12);
        let [width, middle, half] = TempHysteresisLoops.parameters(&[], &coefficients, &drivers)[..] else {
            panic!("three parameters")
        };
        assert!((width - 0.3).abs() < 1e-12 && (middle - 20.0).abs() < 1e-9 && (half - 10.0).abs() < 1e-9);
        // Too few coefficients state nothing.
        stated.insert(COEFFICIENTS_LIST.to_owned(), crate::effect::Value::List(vec![0.3]));
        assert!(TempHysteresisLoops.course(&stated, &drivers).is_none());
    }
}
