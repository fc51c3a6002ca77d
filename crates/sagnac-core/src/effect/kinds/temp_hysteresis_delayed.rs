//! A bias that depends on the direction from which a temperature behind a delay was reached: that of the coil, of which the
//! thermometer on the housing is ahead. It is reported as temperature hysteresis.

use super::temp_hysteresis::{PLAY, SENSE, WIDTH, state, turns};
use crate::effect::shared::reach::{reach, varies};
use crate::effect::shared::search::{best_of, log_grid};
use crate::effect::shared::thermal::{delayed, smooth};
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Starts, Values, number,
};
use crate::numeric::range::{Bounds, ends};

pub struct TempHysteresisDelayed;

static PARAMS: [Param; 4] = [WIDTH, PLAY, SENSE, Param::inner("time_constant_s", "s", 1e-6, 1e6)];

describe! {
    TempHysteresisDelayed, "temp_hysteresis_delayed", Mean in Temperature, needs [Temperature],
    confusers ["temp_hysteresis", "temp_rate_delayed", "thermal_lag"],
    with {
        fn reported_kind(&self) -> &'static str {
            "temp_hysteresis"
        }
    }
}

/// State of the play of the delayed temperature; both begin settled.
fn column(play: f64, time_constant_s: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    let t = smooth(drivers)?;
    if !(time_constant_s > 0.0 && time_constant_s.is_finite()) {
        return None;
    }
    state(&delayed(t, time_constant_s, drivers.dt_s), play, 0.0)
}

impl MeanModel for TempHysteresisDelayed {
    /// A temperature that never turns has no second branch.
    fn applies(&self, drivers: &Drivers) -> bool {
        smooth(drivers).is_some_and(|t| varies(Some(t)) && turns(t))
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let bounds = self.bounds(drivers);
        let [plays, delays] = [&bounds[0], &bounds[1]].map(|b| log_grid(b.low, b.high, 7));
        let points = plays.iter().flat_map(|play| delays.iter().map(|delay| vec![*play, *delay]));
        let looked = |b: &Bounds| (b.high / b.low).ln().max(1.0);
        let trials = looked(&bounds[0]) * looked(&bounds[1]);
        Starts { points: best_of(self, points, 2, drivers, context), trials }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        let range = smooth(drivers).map_or(Bounds::new(0.0, 1.0), ends).width().max(1e-6);
        let low = drivers.dt_s;
        vec![
            Bounds::new(0.005 * range, 0.5 * range),
            Bounds::new(low, (0.1 * drivers.length_s()).max(4.0 * low)),
        ]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let [play, delay] = nonlinear_parameters else { return Regressors::default() };
        Regressors { columns: column(*play, *delay, drivers).into_iter().collect(), ..Regressors::default() }
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        match (nonlinear_parameters, coefficients) {
            ([play, delay], [width]) => vec![width.abs(), *play, width.signum(), *delay],
            _ => vec![f64::NAN; 4],
        }
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let [width, play, delay] = [0, 1, 3].map(|i: usize| number(values, PARAMS[i].name));
        let sense = number(values, PARAMS[2].name).unwrap_or(1.0);
        Some(column(play?, delay?, drivers)?.into_iter().map(|x| sense * width.unwrap_or(0.0) * x).collect())
    }

    fn places(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let ([play, delay], [_]) = (nonlinear_parameters, coefficients) else { return vec![] };
        let course = column(*play, *delay, drivers).unwrap_or_default();
        reach(Domain::Temperature, smooth(drivers).unwrap_or(&[]), &course)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn branches_change_later_than_the_temperature_turns() {
        // Cycles of 2000 s: the state turns from one branch to the other behind the delay.
        let t: Vec<f64> =
            (0..6000).map(|i| 20.0 - 10.0 * (std::f64::consts::PI * f64::from(i) / 1000.0).cos()).collect();
        let drivers = Drivers { dt_s: 1.0, samples: 6000, temperature: Some(t), ..Drivers::default() };
        let later = |delay: f64| {
            let state = column(0.5, delay, &drivers).unwrap();
            // The second maximum of the temperature is at 3000 s.
            (3000..).position(|i| state[i] <= 0.0).unwrap()
        };
        let [short, long] = [1.0, 100.0].map(later);
        // A first-order delay of 100 s turns by the arc tangent of π/10 of a cycle later, 97 s.
        assert!((90..=105).contains(&(long - short)), "{short} {long}");
        assert!(column(0.5, 0.0, &drivers).is_none());
    }
}
