//! Courses of a temperature behind a first-order delay that the fit finds: that of a coil of which the thermometer is ahead.

use super::decay::decay;
use super::search::{best_of, log_grid};
use super::thermal::{delayed, smooth};
use crate::effect::{Drivers, MeanModel, SearchContext, Starts};
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

/// Points from which the search for the time constant begins.
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

/// Remainder of the unknown state at the beginning of the record, for a time constant as the only nonlinear parameter.
pub(in crate::effect) fn initial_state(nonlinear_parameters: &[f64], drivers: &Drivers) -> Vec<Vec<f64>> {
    nonlinear_parameters.iter().filter(|t| **t > 0.0).map(|t| decay(*t, drivers)).collect()
}
