//! A period of one day.

use crate::effect::mean::first;
use crate::effect::shared::reach::record;
use crate::effect::shared::search::{best_of, log_grid};
use crate::effect::shared::sinusoid::{columns, polar, wave};
use crate::effect::sizing::numbers;
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Sizing, Starts, Values, number,
};
use crate::numeric::range::Bounds;

pub struct Diurnal;

static PARAMS: [Param; 3] = [
    Param::reported("amplitude_deg_h", "deg/h", 0.0, 1e5),
    Param::reported("period_s", "s", 80_000.0, 93_000.0),
    Param::inner("phase_deg", "deg", -360.0, 360.0),
];

describe! {
    Diurnal, "diurnal", Mean in Frequency, needs [],
    confusers [Line, TempLinear, UnobservedDriver, RateRamp],
    properties [slow]
}

/// Length of a day, s.
const DAY_S: f64 = 86_400.0;

impl MeanModel for Diurnal {
    fn applies(&self, drivers: &Drivers) -> bool {
        drivers.samples >= 16 && drivers.length_s() > 0.5 * DAY_S
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let Bounds { low, high } = self.bounds(drivers)[0];
        if low == high {
            return Starts { points: vec![vec![DAY_S]], trials: 1.0 };
        }
        let grid = log_grid(low, high, 5);
        Starts { points: best_of(self, grid.into_iter().map(|p| vec![p]), 2, drivers, context), trials: 1.0 }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        if drivers.length_s() > 2.0 * DAY_S {
            vec![Bounds::new(82_800.0, 90_000.0)]
        } else {
            vec![Bounds::new(DAY_S, DAY_S)]
        }
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        Regressors::columns(nonlinear_parameters.iter().flat_map(|period| columns(1.0 / period, drivers)))
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        let (amplitude, phase) = polar(coefficients);
        vec![amplitude, first(nonlinear_parameters), phase]
    }

    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        let Bounds { low, high } = self.bounds(drivers)[0];
        let phases = [0.0, 45.0, 90.0, 135.0];
        let places = phases.map(|phase| numbers([(PARAMS[1].name, DAY_S), (PARAMS[2].name, phase)])).into();
        vec![Sizing::searched(&PARAMS[0], places, if low == high { 2 } else { 3 }, 1.0)]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let period = number(values, PARAMS[1].name).unwrap_or(DAY_S);
        let phase = number(values, PARAMS[2].name).unwrap_or(0.0);
        if period.is_nan() || period <= 0.0 {
            return None;
        }
        let columns = columns(1.0 / period, drivers);
        Some(wave(number(values, PARAMS[0].name)?, phase, &columns))
    }

    /// A line of just this period is seldom anything else.
    fn odds(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> f64 {
        3.0
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let Some(f) = nonlinear_parameters.first().map(|p| 1.0 / p) else { return vec![] };
        let half = 0.5 / drivers.length_s();
        let frequency = Place { domain: Domain::Frequency, from: (f - half).max(0.0), to: f + half };
        [vec![frequency], record(drivers)].concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_day_turns_the_sign() {
        let drivers = Drivers { dt_s: 3600.0, start_s: 0.0, samples: 24, ..Drivers::default() };
        let course = Diurnal.course(&numbers([("amplitude_deg_h", 3.0)]), &drivers).unwrap();
        for i in 0..12 {
            assert!((course[i] + course[i + 12]).abs() < 1e-9, "{i}");
        }
        // The mean of an hour leaves sin(π/24)/(π/24) of a day's cosine.
        let left = (std::f64::consts::PI / 24.0).sin() / (std::f64::consts::PI / 24.0);
        assert!((course[0] - 3.0 * left).abs() < 1e-9 && course[6].abs() < 1e-9, "{}", course[0]);
        assert!(!Diurnal.applies(&Drivers { samples: 11, ..drivers.clone() }));
        assert_eq!(Diurnal.bounds(&drivers)[0].width(), 0.0);
    }
}
