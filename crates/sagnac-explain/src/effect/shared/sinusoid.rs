//! Sinusoids as samples see them, means over the sampling interval; and the gain by a sinusoid of each frequency.

use crate::effect::{Drivers, SearchContext};
use rayon::prelude::*;
use sagnac_fft::real_forward;
use std::f64::consts::PI;

/// Fewest samples that are computed on another core.
const PARALLEL_SAMPLES: usize = 1 << 14;

/// Samples through which a sinusoid is rotated from one to the next. A share holds whole blocks of them.
const ROTATED_SAMPLES: usize = 64;
/// Samples that are rotated side by side.
const ROTATION_LANES: usize = 8;

/// Factor by which a mean over so many cycles attenuates a sinusoid.
pub(in crate::effect) fn averaged(cycles: f64) -> f64 {
    let x = PI * cycles;
    if x.abs() < 1e-6 { 1.0 - x * x / 6.0 } else { x.sin() / x }
}

/// Cosine and sine of the phase of each sample, given in cycles, with what the sample's own mean leaves of them.
pub(in crate::effect) fn pair(samples: usize, phase: impl Fn(usize) -> (f64, f64) + Sync) -> Vec<Vec<f64>> {
    let of = |i: usize| {
        let (cycles, left) = phase(i);
        let (s, c) = (2.0 * PI * cycles.fract()).sin_cos();
        (left * c, left * s)
    };
    let (cosine, sine) = (0..samples).into_par_iter().with_min_len(PARALLEL_SAMPLES).map(of).unzip();
    vec![cosine, sine]
}

/// A sinusoid whose frequency changes steadily, on a grid of samples.
#[derive(Debug, Clone, Copy)]
pub(in crate::effect) struct Sweep {
    /// Time of the first sample, s.
    pub first_s: f64,
    /// Sampling interval, s.
    pub dt_s: f64,
    /// Frequency at time 0, Hz.
    pub frequency_hz: f64,
    /// Change of the frequency, Hz/s.
    pub drift_hz_s: f64,
}

impl Sweep {
    fn time_s(&self, i: usize) -> f64 {
        self.first_s + i as f64 * self.dt_s
    }

    /// Attenuation by the mean of a sample.
    fn left(&self, i: usize) -> f64 {
        averaged((self.frequency_hz + self.drift_hz_s * self.time_s(i)) * self.dt_s)
    }

    /// Cosine and sine of the phase, which is 0 at time 0, for the samples from `first` on: as many as both slices hold.
    pub fn turns(&self, first: usize, cosine: &mut [f64], sine: &mut [f64]) {
        let bend = self.bend();
        let blocks = cosine.chunks_mut(ROTATED_SAMPLES).zip(sine.chunks_mut(ROTATED_SAMPLES)).enumerate();
        for (b, (cosine, sine)) in blocks {
            let turns = self.block(first + b * ROTATED_SAMPLES, bend.as_ref());
            cosine.copy_from_slice(&turns.cosine[..cosine.len()]);
            sine.copy_from_slice(&turns.sine[..sine.len()]);
        }
    }

    /// Cosine and sine of the phase of each sample, with what the sample's own mean leaves of them.
    pub fn pair(&self, samples: usize) -> Vec<Vec<f64>> {
        let (mut cosine, mut sine) = (vec![0.0; samples], vec![0.0; samples]);
        let bend = self.bend();
        let shares =
            cosine.par_chunks_mut(PARALLEL_SAMPLES).zip(sine.par_chunks_mut(PARALLEL_SAMPLES)).enumerate();
        shares.for_each(|(share, (cosine, sine))| {
            let blocks = cosine.chunks_mut(ROTATED_SAMPLES).zip(sine.chunks_mut(ROTATED_SAMPLES)).enumerate();
            for (b, (cosine, sine)) in blocks {
                let first = share * PARALLEL_SAMPLES + b * ROTATED_SAMPLES;
                let turns = self.block(first, bend.as_ref());
                // Within a block it changes evenly.
                let from = self.left(first);
                let each = (self.left(first + ROTATED_SAMPLES) - from) / ROTATED_SAMPLES as f64;
                let outputs = cosine.iter_mut().zip(sine).zip(turns.cosine.iter().zip(&turns.sine));
                for (i, ((c, s), (turned_c, turned_s))) in outputs.enumerate() {
                    let left = from + each * i as f64;
                    (*c, *s) = (left * turned_c, left * turned_s);
                }
            }
        });
        vec![cosine, sine]
    }

    /// Rotation of the samples of a block by the change of the frequency; `None` for a steady frequency.
    fn bend(&self) -> Option<Turns> {
        let cycles = self.drift_hz_s * self.dt_s * self.dt_s;
        (cycles != 0.0).then(|| {
            let mut bend = Turns::default();
            for i in 1..ROTATED_SAMPLES {
                bend.set(i, cis(cycles * (i * (i - 1) / 2) as f64));
            }
            bend
        })
    }

    /// Cosine and sine of the phase of a block of samples: powers of one step, begun anew in each block before their rounding
    /// tells. Powers that are [`ROTATION_LANES`] apart do not wait for each other.
    fn block(&self, first: usize, bend: Option<&Turns>) -> Turns {
        let (f, drift, dt) = (self.frequency_hz, self.drift_hz_s, self.dt_s);
        let t = self.time_s(first);
        let step = cis(f * dt + drift * dt * (t + 0.5 * dt));
        let mut out = Turns::default();
        let mut at = cis(f * t + 0.5 * drift * t * t);
        let mut far = (1.0, 0.0);
        for i in 0..ROTATION_LANES {
            out.set(i, at);
            (at, far) = (turned(at, step), turned(far, step));
        }
        for from in (0..ROTATED_SAMPLES - ROTATION_LANES).step_by(ROTATION_LANES) {
            for i in from..from + ROTATION_LANES {
                let (c, s) = (out.cosine[i], out.sine[i]);
                out.cosine[i + ROTATION_LANES] = c * far.0 - s * far.1;
                out.sine[i + ROTATION_LANES] = c * far.1 + s * far.0;
            }
        }
        if let Some(bend) = bend {
            for i in 0..ROTATED_SAMPLES {
                let at = (out.cosine[i], out.sine[i]);
                out.set(i, turned(at, (bend.cosine[i], bend.sine[i])));
            }
        }
        out
    }
}

/// Cosines and sines of the samples of a block.
struct Turns {
    cosine: [f64; ROTATED_SAMPLES],
    sine: [f64; ROTATED_SAMPLES],
}

impl Default for Turns {
    fn default() -> Turns {
        Turns { cosine: [1.0; ROTATED_SAMPLES], sine: [0.0; ROTATED_SAMPLES] }
    }
}

impl Turns {
    fn set(&mut self, i: usize, (cosine, sine): (f64, f64)) {
        (self.cosine[i], self.sine[i]) = (cosine, sine);
    }
}

/// Cosine and sine of a phase in cycles.
fn cis(cycles: f64) -> (f64, f64) {
    let (s, c) = (2.0 * PI * cycles.fract()).sin_cos();
    (c, s)
}

/// One turn and another after it.
fn turned(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

/// Cosine and sine of a frequency; the phase counts from `time_s` = 0.
pub(in crate::effect) fn columns(frequency_hz: f64, drivers: &Drivers) -> Vec<Vec<f64>> {
    let sweep = Sweep { first_s: drivers.time_s(0), dt_s: drivers.dt_s, frequency_hz, drift_hz_s: 0.0 };
    sweep.pair(drivers.samples)
}

/// Amplitude and phase, deg, of `a cos x + b sin x` as `A cos(x + φ)`; NaN for other than two coefficients.
pub(in crate::effect) fn polar(coefficients: &[f64]) -> (f64, f64) {
    match coefficients {
        [a, b] => (a.hypot(*b), (-b).atan2(*a).to_degrees()),
        _ => (f64::NAN, f64::NAN),
    }
}

/// `A cos(x + φ)` of the columns that [`pair`] gives.
pub(in crate::effect) fn wave(amplitude: f64, phase_deg: f64, columns: &[Vec<f64>]) -> Vec<f64> {
    let (s, c) = phase_deg.to_radians().sin_cos();
    match columns {
        [cosine, sine] => cosine.iter().zip(sine).map(|(x, y)| amplitude * (c * x - s * y)).collect(),
        _ => vec![],
    }
}

/// Gains of log-likelihood, nats, of sinusoids at equidistant frequencies from 0.
pub(in crate::effect) struct LineGains {
    /// One a frequency.
    pub gains: Vec<f64>,
    /// Step of the frequencies, Hz: a half or less of the resolution of the record.
    pub step_hz: f64,
}

impl LineGains {
    /// From the score, padded to at least twice its length that transforms fast. Empty where it cannot be transformed.
    pub fn of(drivers: &Drivers, context: &SearchContext<'_>) -> LineGains {
        let n = context.score.len();
        let padded = (2 * n).next_power_of_two();
        let mut input = context.score.to_vec();
        input.resize(padded, 0.0);
        let plan = real_forward(padded);
        let mut spectrum = plan.make_output_vec();
        if n < 2 || plan.process(&mut input, &mut spectrum).is_err() {
            return LineGains { gains: vec![], step_hz: 1.0 };
        }
        // Mode k lies at k/(2n·dt). Weighted by the inverse covariance a sinusoid of amplitude 1 has n/2 over the power there.
        let power = |j: usize| {
            let mode = (2.0 * n as f64 * j as f64 / padded as f64).round() as usize;
            context.powers.get(mode.clamp(1, n - 1)).copied().unwrap_or(0.0)
        };
        let gains = spectrum.iter().enumerate().map(|(j, w)| w.norm_sqr() * power(j) / n as f64).collect();
        LineGains { gains, step_hz: 1.0 / (padded as f64 * drivers.dt_s) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_of_a_sinusoid_is_its_integral_over_the_interval() {
        for cycles in [1e-9f64, 0.1, 0.49, 0.9] {
            let steps = 20_000;
            let mean = (0..steps)
                .map(|i| (2.0 * PI * cycles * ((f64::from(i) + 0.5) / f64::from(steps) - 0.5)).cos())
                .sum::<f64>()
                / f64::from(steps);
            assert!((averaged(cycles) - mean).abs() < 1e-8, "{cycles}");
        }
    }

    #[test]
    fn a_rotated_sinusoid_is_that_of_its_phase() {
        for (first_s, dt_s, frequency_hz, drift_hz_s) in
            [(3e5, 0.01, 49.3, 0.0), (-500.0, 0.01, 21.7, 2.2e-3), (0.0, 1.0, 1e-4, -1e-9)]
        {
            let sweep = Sweep { first_s, dt_s, frequency_hz, drift_hz_s };
            let columns = sweep.pair(100_000);
            for i in (0..100_000).step_by(997).chain([63, 64, 16_383, 16_384, 99_999]) {
                let t = first_s + i as f64 * dt_s;
                let left = averaged((frequency_hz + drift_hz_s * t) * dt_s);
                let (s, c) = (2.0 * PI * (frequency_hz * t + 0.5 * drift_hz_s * t * t).fract()).sin_cos();
                let off = (columns[0][i] - left * c).abs().max((columns[1][i] - left * s).abs());
                assert!(off < 1e-7, "{sweep:?}, {i}: {off}");
            }
        }
    }

    #[test]
    fn amplitude_and_phase_give_the_columns_back() {
        let columns = pair(50, |i| (0.07 * i as f64, 1.0));
        let (amplitude, phase) = polar(&[0.3, -1.1]);
        for (i, x) in wave(amplitude, phase, &columns).iter().enumerate() {
            let y = 2.0 * PI * 0.07 * i as f64;
            assert!((x - (0.3 * y.cos() - 1.1 * y.sin())).abs() < 1e-12);
        }
    }

    #[test]
    fn a_mean_over_next_to_no_cycle_loses_a_sixth_of_the_square_of_its_angle() {
        // π·2e-7: the square over 6 is 6.58e-14, some hundred roundings.
        let lost = (PI * 2e-7).powi(2) / 6.0;
        assert!((1.0 - averaged(2e-7) - lost).abs() < 2e-16, "{:e}", 1.0 - averaged(2e-7));
        assert_eq!(averaged(0.0), 1.0);
    }
}
