//! A delay between the gyro and the columns beside it that grows: its clock runs at another rate. A line that the claim states,
//! as that of the mains, shows it too, at another frequency.

use crate::effect::mean::first;
use crate::effect::shared::delay::{claimed_mean_varies, follow, regressors, shifted};
use crate::effect::shared::reach::{beginning_s, record};
use crate::effect::shared::search::best_of;
use crate::effect::shared::stated_lines;
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Sizing, Starts, Values, list, number,
};
use crate::numeric::cosine::inverse_dct2;
use crate::numeric::range::Bounds;

pub struct ClockDrift;

static PARAMS: [Param; 1] = [Param::reported("drift_ppm", "ppm", -1e5, 1e5).signed()];

/// Amplitudes of the lines of the claim as the drifting clock shows them.
const LINE_AMPLITUDES: &str = "line_amplitudes_deg_h";
/// Their phases at `time_s` = 0, with the frequencies as they are shown.
const LINE_PHASES: &str = "line_phases_deg";

describe! {
    ClockDrift, "clock_drift", Mean in Lag, needs [],
    confusers [TimeOffset, SfError, DroppedSamples, Line],
    lists [
        Param::inner(LINE_AMPLITUDES, "deg/h", 0.0, 1e6),
        Param::inner(LINE_PHASES, "deg", -360.0, 360.0)
    ]
}

/// Lag of a sample in samples, for 1 ppm.
fn per_ppm(i: usize, drivers: &Drivers) -> f64 {
    1e-6 * (drivers.time_s(i) - beginning_s(drivers)) / drivers.dt_s
}

impl MeanModel for ClockDrift {
    fn applies(&self, drivers: &Drivers) -> bool {
        claimed_mean_varies(drivers) || stated_lines::any(drivers)
    }

    /// A drift is found by following it: from a stretch at the beginning, where the delay is still small, to the whole
    /// record. Or by a line as large as the stated one at another place.
    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let n = drivers.samples;
        if !self.applies(drivers) || !context.is_of(n) {
            return Starts::none();
        }
        let Bounds { low, high } = self.bounds(drivers)[0];
        let (by_lines, places) = stated_lines::starts(drivers, context);
        if !claimed_mean_varies(drivers) {
            let points = by_lines.into_iter().map(|d| vec![d]);
            return Starts { points: best_of(self, points, 3, drivers, context), trials: places.max(1.0) };
        }
        let mean = drivers.claimed_mean();
        let residual = inverse_dct2(context.modes);
        let track = |from: usize| {
            let (mut drift, mut until) = (0.0f64, from);
            loop {
                until = until.min(n);
                let step = 0.05 / per_ppm(until - 1, drivers).max(1e-12);
                let next = follow(&residual, &mean, until, drift, |i| per_ppm(i, drivers), step);
                if next.is_finite() && (low..=high).contains(&next) {
                    drift = next;
                }
                if until == n {
                    return drift;
                }
                until = until * 3 / 2 + 1;
            }
        };
        let begun = [1usize, 4, 16, 64, 256].map(|part| (n / part).clamp(32, n));
        let points = begun.into_iter().map(track).filter(|d| *d != 0.0).chain(by_lines).map(|d| vec![d]);
        let trials = (1e-6 * (high - low) * n as f64).max(1.0) + places;
        Starts { points: best_of(self, points, 3, drivers, context), trials }
    }

    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![Bounds::new(-1e5, 1e5)]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let Some(drift) = nonlinear_parameters.first() else { return Regressors::default() };
        let mut parts = Regressors::default();
        if claimed_mean_varies(drivers) {
            parts = regressors(&drivers.claimed_mean(), |i| drift * per_ppm(i, drivers));
        }
        if stated_lines::any(drivers) {
            let stated = stated_lines::taken_away(drivers);
            let fixed = parts.offset.get_or_insert_with(|| vec![0.0; drivers.samples]);
            fixed.iter_mut().zip(stated).for_each(|(f, s)| *f += s);
            parts.columns = stated_lines::drifted(*drift, drivers);
        }
        parts
    }

    fn lists(
        &self,
        _nonlinear_parameters: &[f64],
        coefficients: &[f64],
        _drivers: &Drivers,
    ) -> Vec<(&'static str, Vec<f64>)> {
        if coefficients.is_empty() {
            return vec![];
        }
        let (amplitudes, phases) = stated_lines::polars(coefficients);
        vec![(LINE_AMPLITUDES, amplitudes), (LINE_PHASES, phases)]
    }

    fn parameters(
        &self,
        nonlinear_parameters: &[f64],
        _coefficients: &[f64],
        _drivers: &Drivers,
    ) -> Vec<f64> {
        vec![first(nonlinear_parameters)]
    }

    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        // Of lines alone its size says nothing: one place is as far as another.
        if !claimed_mean_varies(drivers) {
            return vec![];
        }
        let Bounds { low, high } = self.bounds(drivers)[0];
        let begin = 0.1 / per_ppm(drivers.samples.max(2) - 1, drivers).max(1e-12);
        let beside = self.regressors(&[begin], drivers).nuisance.len();
        let trials = 1e-6 * (high - low) * drivers.samples as f64;
        vec![Sizing::searched(&PARAMS[0], vec![Values::new()], 1 + beside, trials).from(begin)]
    }

    /// The phases of stated lines are no small change.
    fn score_step(&self, drivers: &Drivers) -> Option<f64> {
        let small = 0.05 / per_ppm(drivers.samples.max(2) - 1, drivers).max(1e-12);
        (!stated_lines::any(drivers)).then_some(small)
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let drift = number(values, PARAMS[0].name)?;
        let mut course = shifted(&drivers.claimed_mean(), |i| drift * per_ppm(i, drivers)).0;
        let lines =
            stated_lines::course(drift, list(values, LINE_AMPLITUDES), list(values, LINE_PHASES), drivers);
        course.iter_mut().zip(lines).for_each(|(c, l)| *c += l);
        Some(course)
    }

    fn nuisance_columns(&self, values: &Values, drivers: &Drivers) -> Vec<Vec<f64>> {
        number(values, PARAMS[0].name).map_or_else(Vec::new, |d| self.regressors(&[d], drivers).nuisance)
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let Some(last) = nonlinear_parameters.first().map(|d| 1e-6 * d * drivers.length_s()) else {
            return vec![];
        };
        let lag = Place { domain: Domain::Lag, from: last.min(0.0), to: last.max(0.0) };
        let line = nonlinear_parameters.first().and_then(|d| stated_lines::place(*d, drivers));
        [vec![lag], record(drivers), line.into_iter().collect()].concat()
    }

    fn steps(&self, drivers: &Drivers) -> Vec<f64> {
        vec![0.05 / per_ppm(drivers.samples.max(2) - 1, drivers).max(1e-12)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lag_grows_by_a_millionth_of_the_time_for_each_ppm() {
        // One sample each second, from 100 s on: after 50 000 samples 1 ppm is 0.05 s.
        let drivers =
            Drivers { dt_s: 1.0, start_s: 100.0, samples: 50_001, averaged: 1, ..Drivers::default() };
        assert_eq!(per_ppm(0, &drivers), 0.0);
        assert!((per_ppm(50_000, &drivers) - 0.05).abs() < 1e-12);
        // In averages of ten the record began 4.5 s before the middle of the first.
        let coarse = Drivers { dt_s: 10.0, averaged: 10, ..drivers };
        assert!((per_ppm(0, &coarse) - 0.45e-6).abs() < 1e-15);
    }
}
