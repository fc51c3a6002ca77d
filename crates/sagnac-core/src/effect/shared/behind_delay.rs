//! Courses of a temperature behind a first-order delay that the fit finds: that of a coil of which the thermometer is ahead.

use super::decay::decay;
use super::search::{best_of, log_grid};
use super::thermal::{delayed, smooth};
use crate::effect::{Drivers, MeanModel, Regressors, SearchContext, Starts};
use crate::numeric::range::Bounds;

/// The delayed temperature, °C; `None` without a temperature or for what is no time constant.
pub(in crate::effect) fn late(time_constant_s: f64, drivers: &Drivers) -> Option<Vec<f64>> {
    let t = smooth(drivers)?;
    (time_constant_s > 0.0 && time_constant_s.is_finite()).then(|| delayed(t, time_constant_s, drivers.dt_s))
}

/// Bounds of the time constant, s: behind a delay that is long against the record every temperature is a straight line.
pub(in crate::effect) fn bounds(drivers: &Drivers) -> Vec<Bounds> {
    let low = drivers.dt_s;
    vec![Bounds::new(low, (0.25 * drivers.length_s()).max(4.0 * low))]
}

/// Where the search for the time constant begins.
pub(in crate::effect) fn starts(
    course: &dyn MeanModel,
    drivers: &Drivers,
    context: &SearchContext<'_>,
) -> Starts {
    let Bounds { low, high } = bounds(drivers)[0];
    let grid = log_grid(low, high, 24);
    let points = best_of(course, grid.into_iter().map(|t| vec![t]), 2, drivers, context);
    Starts { points, trials: (high / low).ln().max(1.0) }
}

/// A column of a time constant, and beside it what is left of the state at the beginning, which is not known.
pub(in crate::effect) fn regressors(
    nonlinear_parameters: &[f64],
    drivers: &Drivers,
    column: impl Fn(f64, &Drivers) -> Option<Vec<f64>>,
) -> Regressors {
    let Some(time) = nonlinear_parameters.first().filter(|t| **t > 0.0) else {
        return Regressors::default();
    };
    Regressors {
        columns: column(*time, drivers).into_iter().collect(),
        nuisance: initial(Some(*time), drivers),
        ..Regressors::default()
    }
}

/// What is left of the state at the beginning of a stated delay.
pub(in crate::effect) fn initial(time_constant_s: Option<f64>, drivers: &Drivers) -> Vec<Vec<f64>> {
    time_constant_s.filter(|t| *t > 0.0).map(|t| decay(t, drivers)).into_iter().collect()
}
