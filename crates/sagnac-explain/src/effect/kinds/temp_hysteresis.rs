//! A bias that depends on the direction from which a temperature was reached.

use crate::effect::shared::reach::{reach, varies};
use crate::effect::shared::response::ANY_SHAPE;
use crate::effect::shared::search::{best_of, log_grid};
use crate::effect::shared::thermal::smooth;
use crate::effect::sizing::numbers;
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Sizing, Starts, Unmodelled, Values,
    number,
};
use crate::numeric::range::{Bounds, ends};

pub struct TempHysteresis;

/// Distance of the branches.
pub(super) const LOOP_WIDTH: Param = Param::reported("loop_width_deg_h", "deg/h", -1e6, 1e6);
/// Half of what the temperature turns by before the state turns.
const PLAY_WIDTH: Param = Param::inner("play_degC", "°C", 1e-6, 300.0);
/// 1: higher while heating; −1: higher while cooling. The width of a loop has no sign.
const LOOP_SENSE: Param = Param::inner("sense", "", -1.0, 1.0);

static PARAMS: [Param; 4] = [LOOP_WIDTH, PLAY_WIDTH, Param::inner("first_state", "", -1.0, 1.0), LOOP_SENSE];

describe! {
    TempHysteresis, "temp_hysteresis", Mean in Temperature, needs [Temperature],
    confusers [TempRate, ThermalLag, TempPolynomial],
    properties [slow, carried_over, law Hysteresis]
}

/// Half the play's state, −1/2 on a cooling branch to 1/2 on a heating one: multiplied by the width of the loop.
fn state(t: &[f64], play: f64, first: f64) -> Option<Vec<f64>> {
    if !(play > 0.0 && first.is_finite()) {
        return None;
    }
    let mut at = t.first()? - first.clamp(-1.0, 1.0) * play;
    let follow = |t: &f64| {
        at = at.max(t - play).min(t + play);
        0.5 * (t - at) / play
    };
    Some(t.iter().map(follow).collect())
}

fn column(play: f64, first: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    state(smooth(drivers)?, play, first)
}

/// True where a temperature reverses by enough for both branches to be seen.
pub(super) fn reverses(t: &[f64]) -> bool {
    let branches = state(t, 0.05 * ends(t).width(), 0.0).unwrap_or_default();
    branches.iter().any(|b| *b > 0.49) && branches.iter().any(|b| *b < -0.49)
}

impl MeanModel for TempHysteresis {
    /// A temperature that never turns has no second branch.
    fn applies(&self, drivers: &Drivers) -> bool {
        smooth(drivers).is_some_and(|t| varies(Some(t)) && reverses(t))
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let Bounds { low, high } = self.bounds(drivers)[0];
        let grid = log_grid(low, high, 12);
        let points = grid.into_iter().flat_map(|r| [-1.0, 0.0, 1.0].map(|first| vec![r, first]));
        Starts { points: best_of(self, points, 3, drivers, context), trials: (high / low).ln().max(1.0) }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        let range = smooth(drivers).map_or(Bounds::new(0.0, 1.0), ends).width().max(1e-6);
        vec![Bounds::new(0.005 * range, 0.5 * range), Bounds::new(-1.0, 1.0)]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let [play, first] = nonlinear_parameters else { return Regressors::default() };
        Regressors::columns(column(*play, *first, drivers))
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        match (nonlinear_parameters, coefficients) {
            ([play, first], [width]) => vec![width.abs(), *play, *first, width.signum()],
            _ => vec![f64::NAN; 4],
        }
    }

    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        let Bounds { low, high } = self.bounds(drivers)[0];
        let places = log_grid(2.0 * low, high, 5).into_iter().map(|play| numbers([(PARAMS[1].name, play)]));
        vec![Sizing::searched(&PARAMS[0], places.collect(), 3, (high / low).ln())]
    }

    fn unmodelled(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> Unmodelled {
        ANY_SHAPE
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let width = number(values, PARAMS[0].name)?;
        let Bounds { low, high } = ends(smooth(drivers)?);
        let play = number(values, PARAMS[1].name).unwrap_or(0.1 * (high - low));
        let first = number(values, PARAMS[2].name).unwrap_or(0.0);
        let sense = number(values, PARAMS[3].name).unwrap_or(1.0);
        Some(column(play, first, drivers)?.into_iter().map(|x| sense * width * x).collect())
    }

    fn places(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let ([play, first], [_]) = (nonlinear_parameters, coefficients) else { return vec![] };
        let course = column(*play, *first, drivers).unwrap_or_default();
        reach(Domain::Temperature, smooth(drivers).unwrap_or(&[]), &course)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Value;

    #[test]
    fn the_branches_of_a_cycle_are_apart_by_the_width_of_the_loop_whatever_the_rate() {
        for samples in [200usize, 2000] {
            let t: Vec<f64> = (0..samples)
                .map(|i| 20.0 - 10.0 * (4.0 * std::f64::consts::PI * i as f64 / samples as f64).cos())
                .collect();
            let drivers = Drivers { dt_s: 1.0, samples, temperature: Some(t.clone()), ..Drivers::default() };
            let state = column(1.0, 0.0, &drivers).unwrap();
            // The middle of the first heating and of the first cooling: the same temperature, opposite states.
            let (up, down) = (samples / 8, samples * 3 / 8);
            assert!((t[up] - t[down]).abs() < 1e-9);
            assert!((state[up] - state[down] - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_loop_that_is_lower_while_heating_has_a_width_too() {
        let t: Vec<f64> = (0..400).map(|i| 20.0 - 10.0 * (f64::from(i) / 30.0).cos()).collect();
        let drivers = Drivers { dt_s: 1.0, samples: 400, temperature: Some(t), ..Drivers::default() };
        let told = TempHysteresis.parameters(&[1.0, 0.0], &[-0.3], &drivers);
        assert_eq!(told, [0.3, 1.0, 0.0, -1.0]);
        let values: Values =
            PARAMS.iter().zip(&told).map(|(p, v)| (p.name.to_owned(), Value::Number(*v))).collect();
        let course = TempHysteresis.course(&values, &drivers).unwrap();
        let state = column(1.0, 0.0, &drivers).unwrap();
        assert!(course.iter().zip(&state).all(|(c, s)| (c + 0.3 * s).abs() < 1e-12));
    }
}
