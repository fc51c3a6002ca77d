//! A coherent sinusoid.

use crate::effect::mean::first;
use crate::effect::shared::search::{log_grid, peaks};
use crate::effect::shared::sinusoid::{LineGains, averaged, columns, polar, wave};
use crate::effect::sizing::numbers;
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Sizing, Starts, StatedLine, Values,
    number,
};
use crate::numeric::cosine::sinusoid_modes;
use crate::numeric::optimize::parabolic_peak;
use crate::numeric::range::Bounds;
use std::f64::consts::TAU;

pub struct Line;

static PARAMS: [Param; 3] = [
    Param::reported("frequency_hz", "Hz", 0.0, 1e6),
    Param::reported("amplitude_deg_h", "deg/h", 0.0, 1e6),
    Param::inner("phase_deg", "deg", -360.0, 360.0),
];

describe! {
    Line, "line", Mean in Frequency, needs [],
    confusers [QuasiPeriodic, Diurnal, TableHarmonic, ResetRipple],
    properties [carried_over, family Line, if_few_cycles UnobservedDriver]
}

/// Fewest cycles of a line in the record: a slow process with fewer looks the same.
const MIN_CYCLES: f64 = 2.5;

impl MeanModel for Line {
    fn applies(&self, drivers: &Drivers) -> bool {
        drivers.samples >= 32
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let n = drivers.samples;
        if n < 32 || !context.is_of(n) {
            return Starts::none();
        }
        let LineGains { mut gains, step_hz: step } = LineGains::of(drivers, context);
        let Bounds { low, high } = self.bounds(drivers)[0];
        for (j, gain) in gains.iter_mut().enumerate() {
            if !(low..=high).contains(&(j as f64 * step)) {
                *gain = 0.0;
            }
        }
        let apart = (3.0 / (drivers.length_s() * step)).ceil() as usize;
        let at = |j: usize| vec![((j as f64 + parabolic_peak(&gains, j)) * step).clamp(low, high)];
        Starts { points: peaks(&gains, 3, apart).into_iter().map(at).collect(), trials: n as f64 }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        let resolution = 1.0 / drivers.length_s();
        let low = MIN_CYCLES * resolution;
        vec![Bounds::new(low, (0.5 / drivers.dt_s - 0.5 * resolution).max(low))]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        Regressors::columns(nonlinear_parameters.iter().flat_map(|frequency| columns(*frequency, drivers)))
    }

    fn modes(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Option<Vec<Vec<f64>>> {
        let frequency = *nonlinear_parameters.first()?;
        let cycles = frequency * drivers.dt_s;
        if !(cycles > 0.0 && cycles < 0.5) {
            return None;
        }
        let before = frequency * drivers.time_s(0) - 0.5 * cycles;
        let mut modes = sinusoid_modes(drivers.samples, TAU * cycles, TAU * before.fract());
        let left = averaged(cycles);
        modes.iter_mut().flatten().for_each(|x| *x *= left);
        Some(modes.into())
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        let (amplitude, phase) = polar(coefficients);
        vec![first(nonlinear_parameters), amplitude, phase]
    }

    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        let Bounds { low, high } = self.bounds(drivers)[0];
        let frequencies = log_grid(2.0 * low, 0.95 * high, 12).into_iter();
        let places = frequencies.map(|f| numbers([(PARAMS[0].name, f)])).collect();
        vec![Sizing::searched(&PARAMS[1], places, 3, drivers.samples as f64)]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let StatedLine { frequency_hz, amplitude_deg_h, phase_deg } = self.claimed_line(values)?;
        Some(wave(amplitude_deg_h, phase_deg, &columns(frequency_hz, drivers)))
    }

    fn claimed_line(&self, values: &Values) -> Option<StatedLine> {
        Some(StatedLine {
            frequency_hz: number(values, PARAMS[0].name)?,
            amplitude_deg_h: number(values, PARAMS[1].name)?,
            phase_deg: number(values, PARAMS[2].name).unwrap_or(0.0),
        })
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let half = 0.5 / drivers.length_s();
        let at = |f: &f64| Place { domain: Domain::Frequency, from: (f - half).max(0.0), to: f + half };
        nonlinear_parameters.first().map(at).into_iter().collect()
    }

    fn steps(&self, drivers: &Drivers) -> Vec<f64> {
        vec![0.2 / drivers.length_s()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::cosine::dct2;

    #[test]
    fn the_search_finds_the_strongest_lines_and_their_gain() {
        let n = 3000;
        let drivers = Drivers { dt_s: 0.1, samples: n, averaged: 1, ..Drivers::default() };
        let (f, g) = (1.234_56, 4.011);
        let mut residual: Vec<f64> =
            (0..n).map(|i| (((i as u64 * 2_654_435_761) % 1_000_003) as f64 / 1e6 - 0.5) * 0.3).collect();
        for (size, f) in [(1.0, f), (0.5, g)] {
            for (r, x) in residual.iter_mut().zip(wave(size, 30.0, &columns(f, &drivers))) {
                *r += x;
            }
        }
        let power = 0.09 / 12.0;
        let score: Vec<f64> = residual.iter().map(|r| r / power).collect();
        let (modes, powers) = (dct2(&residual), vec![power; n]);
        let context = SearchContext { score: &score, modes: &modes, powers: &powers };
        let starts = Line.starts(&drivers, &context);
        assert!((starts.points[0][0] - f).abs() < 0.2 / 300.0, "{:?}", starts.points);
        assert!((starts.points[1][0] - g).abs() < 0.2 / 300.0, "{:?}", starts.points);
        // Half the square of amplitude over deviation, n/2 samples' worth.
        let left = averaged(f * 0.1);
        let expected = 0.5 * (n as f64 / 2.0) * left * left / power;
        let LineGains { gains, step_hz: step } = LineGains::of(&drivers, &context);
        let top = gains[(f / step) as usize..][..2].iter().copied().fold(0.0, f64::max);
        assert!((top / expected - 1.0).abs() < 0.25, "{top} {expected}");
    }
}
