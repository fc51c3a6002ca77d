//! A transient that decays from the beginning of the record.

use crate::effect::shared::first_order::decay;
use crate::effect::shared::reach::beginning_s;
use crate::effect::shared::search::{best_of, log_grid};
use crate::effect::sizing::numbers;
use crate::effect::{Domain, Drivers, MeanModel, Param, Place, SearchContext, Sizing, Starts};
use crate::numeric::range::Bounds;

pub struct WarmupExponential;

static PARAMS: [Param; 2] = [
    Param::reported("amplitude_deg_h", "deg/h", -1e5, 1e5),
    Param::reported("time_constant_s", "s", 1e-6, 1e8),
];

describe! {
    WarmupExponential, "warmup_exponential", Mean in Time, needs [],
    confusers [RateRamp, ExcessRrw, ThermalLag, UnobservedDriver],
    properties [slow]
}

impl MeanModel for WarmupExponential {
    fn applies(&self, drivers: &Drivers) -> bool {
        drivers.samples >= 16
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let Bounds { low, high } = self.bounds(drivers)[0];
        let grid = log_grid(1.2 * low, high / 1.2, 32);
        let points = best_of(self, grid.into_iter().map(|t| vec![t]), 3, drivers, context);
        Starts { points, trials: (high / low).ln().max(1.0) }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        vec![Bounds::new(2.0 * drivers.dt_s, drivers.length_s().max(4.0 * drivers.dt_s))]
    }

    fn column(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Vec<f64>> {
        let time_constant_s = *nonlinear_parameters.first().filter(|t| **t > 0.0)?;
        Some(decay(time_constant_s, drivers))
    }

    /// Time constants from a hundredth of the record to its length.
    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        let Bounds { low, high } = self.bounds(drivers)[0];
        let times = log_grid((0.01 * high).max(low), high, 7).into_iter();
        let places = times.map(|time| numbers([(PARAMS[1].name, time)])).collect();
        vec![Sizing::searched(&PARAMS[0], places, 2, (high / low).ln())]
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let Some(time) = nonlinear_parameters.first() else { return vec![] };
        let from = beginning_s(drivers);
        vec![Place { domain: Domain::Time, from, to: from + (3.0 * time).min(drivers.length_s()) }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transient_falls_by_e_in_its_time_constant() {
        let drivers = Drivers { dt_s: 1.0, samples: 3000, averaged: 1, ..Drivers::default() };
        let stated = numbers([("amplitude_deg_h", 2.0), ("time_constant_s", 1000.0)]);
        let course = WarmupExponential.course(&stated, &drivers).unwrap();
        assert!(
            (course[0] - 2.0).abs() < 1e-6 && (course[0] / course[1000] - std::f64::consts::E).abs() < 1e-9
        );
        assert_eq!(WarmupExponential.bounds(&drivers), [Bounds::new(2.0, 3000.0)]);
    }
}
