//! A sinusoid whose frequency changes steadily. It has no kind of its own in the format of explanations.

use crate::effect::shared::reach::record;
use crate::effect::shared::sinusoid::{Sweep, polar, wave};
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Starts, Values, number,
};
use crate::numeric::range::Bounds;
use sagnac_fft::real_forward;

pub struct DriftingLine;

static PARAMS: [Param; 5] = [
    Param::reported("frequency_hz", "Hz", 0.0, 1e6),
    Param::reported("drift_hz_per_s", "Hz/s", -1e6, 1e6),
    Param::reported("amplitude_deg_h", "deg/h", 0.0, 1e6),
    Param::inner("phase_deg", "deg", -360.0, 360.0),
    Param::inner("middle_s", "s", -1e12, 1e12),
];

describe! {
    DriftingLine, "drifting_line", Mean in Frequency, needs [],
    confusers [Line, QuasiPeriodic, ExcessArw],
    properties [outside_format, free_form]
}

/// Samples times sweeps that a search may take: a tenth of a second.
const SEARCH_BUDGET: f64 = 4e6;
/// Samples that a sweep is taken out of at a time.
const BLOCK_SAMPLES: usize = 4096;
/// Fewest samples of a record in which a drifting line is sought.
const MIN_SAMPLES: usize = 256;

/// Rates of change on either side of 0 that are tried: steps of 2/T², which turn the phase at the ends by a quarter.
fn rates(samples: usize) -> usize {
    let most = 0.1 * samples as f64;
    (SEARCH_BUDGET / samples.max(1) as f64).clamp(16.0, most.max(16.0)) as usize
}

fn step(drivers: &Drivers) -> f64 {
    2.0 / drivers.length_s().powi(2)
}

fn middle_s(drivers: &Drivers) -> f64 {
    drivers.start_s + 0.5 * (drivers.samples as f64 - 1.0) * drivers.dt_s
}

/// A line that sweeps, its frequency that of a moment.
fn sweep(frequency_hz: f64, drift_hz_s: f64, middle_s: f64, drivers: &Drivers) -> Sweep {
    Sweep { first_s: drivers.time_s(0) - middle_s, dt_s: drivers.dt_s, frequency_hz, drift_hz_s }
}

fn columns(frequency: f64, drift: f64, middle_s: f64, drivers: &Drivers) -> Vec<Vec<f64>> {
    sweep(frequency, drift, middle_s, drivers).pair(drivers.samples)
}

impl MeanModel for DriftingLine {
    fn applies(&self, drivers: &Drivers) -> bool {
        drivers.samples >= MIN_SAMPLES
    }

    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let n = drivers.samples;
        if n < MIN_SAMPLES || !context.is_of(n) {
            return Starts::none();
        }
        let rates = rates(n);
        let padded = n.next_power_of_two();
        let plan = real_forward(padded);
        let (mut even, mut odd) = (plan.make_input_vec(), plan.make_input_vec());
        let (mut with_cos, mut with_sin) = (plan.make_output_vec(), plan.make_output_vec());
        let (mut cosine, mut sine) = ([0.0; BLOCK_SAMPLES], [0.0; BLOCK_SAMPLES]);
        let (middle, step) = (middle_s(drivers), step(drivers));
        let cell = 1.0 / (padded as f64 * drivers.dt_s);
        let Bounds { low, high } = self.bounds(drivers)[0];
        let (first, last) = ((low / cell).ceil() as usize, ((high / cell) as usize).min(with_cos.len() - 1));
        let mut best = (0.0, vec![]);
        for r in 1..=rates {
            let drift = r as f64 * step;
            even[n..].fill(0.0);
            odd[n..].fill(0.0);
            let swept = sweep(0.0, drift, middle, drivers);
            let blocks = even[..n]
                .chunks_mut(BLOCK_SAMPLES)
                .zip(odd[..n].chunks_mut(BLOCK_SAMPLES))
                .zip(context.score.chunks(BLOCK_SAMPLES));
            for (b, ((even, odd), score)) in blocks.enumerate() {
                let (cosine, sine) = (&mut cosine[..score.len()], &mut sine[..score.len()]);
                swept.turns(b * BLOCK_SAMPLES, cosine, sine);
                for (i, (x, (c, s))) in score.iter().zip(cosine.iter().zip(&*sine)).enumerate() {
                    (even[i], odd[i]) = (x * c, x * s);
                }
            }
            // One after the other: two at once would need twice the memory beside them.
            let done = plan.process(&mut even, &mut with_cos).is_ok()
                && plan.process(&mut odd, &mut with_sin).is_ok();
            if !done {
                break;
            }
            for k in first..=last {
                let (c, s) = (with_cos[k], with_sin[k]);
                // (C ∓ iS): the sweep taken out up and down.
                let up = (c.re + s.im).powi(2) + (c.im - s.re).powi(2);
                let down = (c.re - s.im).powi(2) + (c.im + s.re).powi(2);
                let (power, sign) = if up > down { (up, 1.0) } else { (down, -1.0) };
                if power > best.0 {
                    let mode = (2 * n * k / padded).clamp(1, n - 1);
                    let gain = power * context.powers[mode] / n as f64;
                    if gain > best.0 {
                        best = (gain, vec![k as f64 * cell, sign * drift]);
                    }
                }
            }
        }
        let points = if best.1.is_empty() { vec![] } else { vec![best.1] };
        Starts { points, trials: n as f64 * rates as f64 }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        let resolution = 1.0 / drivers.length_s();
        let most = (rates(drivers.samples) + 1) as f64 * step(drivers);
        vec![
            Bounds::new(3.0 * resolution, (0.5 / drivers.dt_s).max(4.0 * resolution)),
            Bounds::new(-most, most),
        ]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let [frequency, drift] = nonlinear_parameters else { return Regressors::default() };
        Regressors::columns(columns(*frequency, *drift, middle_s(drivers), drivers))
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<f64> {
        let (amplitude, phase) = polar(coefficients);
        let [frequency, drift] = *nonlinear_parameters else { return vec![f64::NAN; PARAMS.len()] };
        vec![frequency, drift, amplitude, phase, middle_s(drivers)]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let of = |i: usize| number(values, PARAMS[i].name);
        Some(wave(of(2)?, of(3).unwrap_or(0.0), &columns(of(0)?, of(1)?, of(4)?, drivers)))
    }

    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let [frequency, drift] = *nonlinear_parameters else { return vec![] };
        let half = 0.5 * drift.abs() * drivers.length_s() + 0.5 / drivers.length_s();
        let band =
            Place { domain: Domain::Frequency, from: (frequency - half).max(0.0), to: frequency + half };
        [vec![band], record(drivers)].concat()
    }

    fn steps(&self, drivers: &Drivers) -> Vec<f64> {
        vec![0.2 / drivers.length_s(), 0.3 * step(drivers)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn a_sweep_is_found_at_its_frequency_and_rate() {
        let n = 4000;
        let drivers = Drivers { dt_s: 0.5, start_s: 7.0, samples: n, averaged: 1, ..Drivers::default() };
        for drift in [4e-5, -2.5e-5] {
            let (f, power) = (0.31, 0.04);
            let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(3);
            let mut noise = || -> f64 { StandardNormal.sample(&mut rng) };
            let residual: Vec<f64> = wave(0.1, 40.0, &columns(f, drift, middle_s(&drivers), &drivers))
                .iter()
                .map(|x| x + 0.2 * noise())
                .collect();
            let score: Vec<f64> = residual.iter().map(|r| r / power).collect();
            let (modes, powers) = (crate::numeric::cosine::dct2(&residual), vec![power; n]);
            let context = SearchContext { score: &score, modes: &modes, powers: &powers };
            let found = DriftingLine.starts(&drivers, &context).points.remove(0);
            assert!((found[0] - f).abs() < 2.0 / 2000.0, "{found:?}");
            assert!((found[1] - drift).abs() < 1.5 * step(&drivers), "{found:?}");
        }
    }

    #[test]
    fn the_shortest_record_is_searched_and_a_shorter_one_is_not() {
        for (n, lines) in [(MIN_SAMPLES, 1), (MIN_SAMPLES - 1, 0)] {
            let drivers = Drivers { dt_s: 1.0, samples: n, averaged: 1, ..Drivers::default() };
            let score: Vec<f64> = (0..n).map(|i| (0.9 * i as f64).sin()).collect();
            let context = SearchContext { score: &score, modes: &score, powers: &vec![1.0; n] };
            let starts = DriftingLine.starts(&drivers, &context);
            assert_eq!((starts.points.len(), DriftingLine.applies(&drivers)), (lines, lines == 1), "{n}");
            assert_eq!(starts.trials > 1.0, lines == 1);
        }
    }
}
