//! The claimed temperature dependence acts through a delayed temperature.

use crate::effect::mean::first;
use crate::effect::shared::first_order::{delayed, initial_state};
use crate::effect::shared::reach::{reach, varies};
use crate::effect::shared::search::{best_of, log_grid};
use crate::effect::shared::thermal::{range, rate, smooth};
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Sizing, Starts, StatePrior, Values,
    number,
};
use crate::numeric::range::Bounds;

pub struct ThermalLag;

static PARAMS: [Param; 1] = [Param::reported("time_constant_s", "s", 1e-6, 1e6)];

describe! {
    ThermalLag, "thermal_lag", Mean in Lag, needs [Temperature],
    confusers [TempRate, TempHysteresis, WarmupExponential, TimeOffset],
    properties [slow, law Lag]
}

/// The claimed coefficient times the difference between delayed and present temperature, deg/h.
fn difference(time_constant_s: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    let coefficient = drivers.claim.temperature?.coefficient_deg_h_per_degc;
    let t = smooth(drivers)?;
    if !(time_constant_s > 0.0 && time_constant_s.is_finite()) {
        return None;
    }
    let late = delayed(t, time_constant_s, drivers.dt_s);
    Some(late.iter().zip(t).map(|(d, t)| coefficient * (d - t)).collect())
}

/// The state before the record: the claimed coefficient times the range of the temperature.
fn state(drivers: &Drivers) -> Option<StatePrior> {
    let coefficient = drivers.claim.temperature?.coefficient_deg_h_per_degc;
    Some(StatePrior { column: None, deviation: coefficient.abs() * range(drivers)? })
}

impl MeanModel for ThermalLag {
    fn applies(&self, drivers: &Drivers) -> bool {
        drivers.claim.temperature.is_some_and(|t| t.coefficient_deg_h_per_degc != 0.0)
            && varies(drivers.temperature.as_deref())
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let Bounds { low, high } = self.bounds(drivers)[0];
        let grid = log_grid(low, high, 32);
        let points = best_of(self, grid.into_iter().map(|t| vec![t]), 3, drivers, context);
        Starts { points, trials: (high / low).ln().max(1.0) }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        let low = drivers.dt_s;
        vec![Bounds::new(low, (0.5 * drivers.length_s()).max(4.0 * low))]
    }

    /// The state at the beginning is not known: what is left of it decays beside the effect.
    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let Some(time) = nonlinear_parameters.first().filter(|t| **t > 0.0) else {
            return Regressors::default();
        };
        Regressors {
            offset: difference(*time, drivers),
            columns: vec![],
            nuisance: initial_state(nonlinear_parameters, drivers),
            states: state(drivers).into_iter().collect(),
        }
    }

    fn parameters(
        &self,
        nonlinear_parameters: &[f64],
        _coefficients: &[f64],
        _drivers: &Drivers,
    ) -> Vec<f64> {
        vec![first(nonlinear_parameters)]
    }

    fn score_step(&self, drivers: &Drivers) -> Option<f64> {
        Some(drivers.dt_s)
    }

    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        let Bounds { low, high } = self.bounds(drivers)[0];
        let sizing = Sizing::searched(&PARAMS[0], vec![Values::new()], 2, (high / low).ln());
        vec![sizing.from((low * high).sqrt())]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        difference(number(values, PARAMS[0].name)?, drivers)
    }

    fn nuisance_columns(&self, values: &Values, drivers: &Drivers) -> Vec<Vec<f64>> {
        initial_state(&[number(values, PARAMS[0].name).unwrap_or(f64::NAN)], drivers)
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let Some(time) = nonlinear_parameters.first() else { return vec![] };
        let (from, to) = (0.5 * time, (1.5 * time).min(drivers.length_s()));
        let rates = rate(drivers).unwrap_or_default();
        let mut places = vec![Place { domain: Domain::Lag, from: from.min(to), to }];
        places.extend(reach(Domain::TemperatureRate, &rates, &rates));
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn behind_a_long_ramp_the_bias_trails_by_the_time_constant() {
        // 0.02 °C/s: the delayed temperature is 40 s · 0.02 °C/s behind.
        let ramp: Vec<f64> = (0..1000).map(|i| 0.02 * f64::from(i)).collect();
        let claimed = crate::effect::Temperature { coefficient_deg_h_per_degc: 0.5, reference_degc: 20.0 };
        let claim = crate::effect::ClaimedMean { temperature: Some(claimed), ..Default::default() };
        let drivers =
            Drivers { dt_s: 1.0, samples: 1000, temperature: Some(ramp), claim, ..Drivers::default() };
        let course = difference(40.0, &drivers).unwrap();
        assert!(course[0] == 0.0 && (course[999] + 0.4).abs() < 1e-9, "{}", course[999]);
        assert!(difference(0.0, &drivers).is_none() && difference(f64::INFINITY, &drivers).is_none());
    }
}
