//! The exact Whittle deviance of a record: every cosine mode of all its samples, neighbouring modes averaged where the
//! expected power hardly changes. Written for a model with every kind of term, and apart from the fit under test.

use super::mixes::TAU0_S;
use nalgebra::{DMatrix, DVector};
use sagnac::noise::composite::{Bandwidth, Composite, Damped, Parameter, Sampling};
use sagnac::noise::data::NoiseType;
use sagnac::noise::model::{Bin, Spectral, TERMS};
use sagnac::numeric::cosine::dct2;

/// Modes that stand alone.
const SINGLE: usize = 100;
/// Relative width of a band of modes.
const RELATIVE_WIDTH: f64 = 0.01;
/// Bands over the width of the narrowest peak.
const BANDS_PER_PEAK: f64 = 12.0;
/// Terms with a spectrum.
const SPECTRAL: usize = 4;

struct Row {
    from: usize,
    to: usize,
    frequency_hz: f64,
    dof: f64,
    /// Expected power of each unit term, mean over the modes.
    unit: [f64; SPECTRAL],
    /// Power of a ramp of 1 deg/h/h.
    ramp: f64,
}

/// The modes of records of one length.
pub struct Layout {
    rows: Vec<Row>,
    ramp_modes: Vec<f64>,
    samples: usize,
}

/// Mean power of each band, and its cross term with a unit ramp.
pub struct Data {
    /// Squares of the modes.
    pub power: Vec<f64>,
    /// Their products with those of a ramp.
    pub cross: Vec<f64>,
}

/// Expected power of a cosine mode of white noise of unit variance behind a moving average of `n` samples. Exact: where
/// the gain is zero the two ends of the record leave a little.
fn moving_average_mode(mode: usize, samples: usize, n: usize) -> f64 {
    let m = samples as f64;
    let a = std::f64::consts::PI * mode as f64 / m;
    let covariance = |d: usize| (n - d) as f64 / (n * n) as f64;
    let sum: f64 = (1..n)
        .map(|d| {
            let x = a * d as f64;
            covariance(d) * ((1.0 - d as f64 / m) * x.cos() - x.sin() / (m * a.sin()))
        })
        .sum();
    covariance(0) + 2.0 * sum
}

impl Layout {
    /// Modes of a record of so many samples, in bands as fine as the truth needs.
    pub fn new(samples: usize, truth: &Composite) -> Layout {
        let step_hz = 0.5 / (samples as f64 * TAU0_S);
        let narrowest = truth
            .quasi_periodic
            .iter()
            .map(|d| 1.0 / (std::f64::consts::PI * d.decay_time_s))
            .fold(f64::INFINITY, f64::min);
        let widest = (narrowest / BANDS_PER_PEAK / step_hz).max(1.0);
        let ramp: Vec<f64> = (0..samples).map(|i| (i as f64 + 0.5) * TAU0_S / 3600.0).collect();
        let ramp_modes = dct2(&ramp);
        let mut rows = vec![];
        let mut from = 1;
        while from < samples {
            let width = if from < SINGLE { 1.0 } else { (from as f64 * RELATIVE_WIDTH).min(widest).max(1.0) };
            let to = (from + width as usize - 1).min(samples - 1);
            let dof = (to - from + 1) as f64;
            let mut unit = [0.0; SPECTRAL];
            // A band is narrow: its mean power is that of three points by Simpson's rule.
            let (low, high) = (from as f64, to as f64);
            let points: Vec<(f64, f64)> = if to == from {
                vec![(low, 1.0)]
            } else {
                vec![(low, 1.0 / 6.0), (0.5 * (low + high), 4.0 / 6.0), (high, 1.0 / 6.0)]
            };
            for (u, term) in unit.iter_mut().zip(TERMS) {
                *u = points
                    .iter()
                    .map(|(k, weight)| {
                        let bin = Bin {
                            frequency_hz: k * step_hz,
                            tau_s: TAU0_S,
                            filling: 1.0,
                            mode: k.round() as usize,
                            blocks: samples,
                            segment: 0,
                        };
                        weight * Spectral::density(&term, &bin)
                    })
                    .sum();
            }
            if let Some(Bandwidth::MovingAverage { samples: n }) = truth.bandwidth {
                let sum: f64 = (from..=to).map(|k| moving_average_mode(k, samples, n as usize)).sum();
                unit[0] *= sum / dof;
            }
            let square: f64 = ramp_modes[from..=to].iter().map(|r| r * r).sum();
            rows.push(Row {
                from,
                to,
                frequency_hz: 0.5 * (low + high) * step_hz,
                dof,
                unit,
                ramp: square * TAU0_S / dof,
            });
            from = to + 1;
        }
        Layout { rows, ramp_modes, samples }
    }

    /// The powers of a record.
    pub fn data(&self, y: &[f64]) -> Data {
        assert_eq!(y.len(), self.samples);
        let first = y[0];
        let centred: Vec<f64> = y.iter().map(|v| v - first).collect();
        let modes = dct2(&centred);
        let mean = |row: &Row, value: &dyn Fn(usize) -> f64| {
            (row.from..=row.to).map(value).sum::<f64>() * TAU0_S / row.dof
        };
        Data {
            power: self.rows.iter().map(|r| mean(r, &|k| modes[k] * modes[k])).collect(),
            cross: self.rows.iter().map(|r| mean(r, &|k| modes[k] * self.ramp_modes[k])).collect(),
        }
    }

    fn term(&self, model: &Composite, term: usize, row: &Row) -> f64 {
        let square = model.terms.coefficient(TERMS[term]).powi(2);
        if square == 0.0 {
            return 0.0;
        }
        match &model.bandwidth {
            // A moving average has nothing to fit: its gain is in the unit powers.
            None | Some(Bandwidth::MovingAverage { .. }) => square * row.unit[term],
            Some(Bandwidth::FirstOrder { time_constant_s }) if term == 0 => {
                // White noise behind the filter is a Markov process.
                let rms_deg_h = (square * 3600.0 / (2.0 * time_constant_s)).sqrt();
                let process = Damped { rms_deg_h, frequency_hz: 0.0, decay_time_s: *time_constant_s };
                self.damped(&process, row)
            }
            Some(filter) => {
                let f = row.frequency_hz;
                let plain = sagnac::noise::model::unit_density(TERMS[term], f, TAU0_S);
                let through = filter.unit_density(TERMS[term], f, TAU0_S, Sampling::Averaging);
                square * row.unit[term] * through / plain
            }
        }
    }

    fn damped(&self, process: &Damped, row: &Row) -> f64 {
        // Exact up to the highest mode: where a density is low, the two ends of a record leave power from elsewhere.
        let mode = |k: usize| process.mode_power(k, self.samples, TAU0_S, Sampling::Averaging);
        mode((row.from + row.to) / 2)
    }

    /// Expected power of each band without the ramp.
    pub fn expected(&self, model: &Composite) -> Vec<f64> {
        self.rows
            .iter()
            .map(|row| {
                (0..SPECTRAL).map(|t| self.term(model, t, row)).sum::<f64>()
                    + model
                        .markov
                        .iter()
                        .chain(&model.quasi_periodic)
                        .map(|d| self.damped(d, row))
                        .sum::<f64>()
            })
            .collect()
    }

    /// The part of the expected powers that a parameter acts on.
    fn touched(&self, model: &Composite, parameter: Parameter) -> Vec<f64> {
        let rows = self.rows.iter();
        match parameter {
            Parameter::Coefficient(t) => {
                let t = TERMS.iter().position(|x| *x == t).expect("a term");
                rows.map(|row| if t < SPECTRAL { self.term(model, t, row) } else { 0.0 }).collect()
            }
            Parameter::MarkovSigma(i) | Parameter::MarkovTime(i) => {
                rows.map(|row| self.damped(&model.markov[i], row)).collect()
            }
            Parameter::QuasiPeriodicRms(i)
            | Parameter::QuasiPeriodicFrequency(i)
            | Parameter::QuasiPeriodicTime(i) => {
                rows.map(|row| self.damped(&model.quasi_periodic[i], row)).collect()
            }
            Parameter::LineAmplitude(_) => rows.map(|_| 0.0).collect(),
            Parameter::FilterTime => {
                rows.map(|row| (0..SPECTRAL).map(|t| self.term(model, t, row)).sum()).collect()
            }
        }
    }

    /// ∂ s / ∂ ln θ of every band.
    pub fn slope(&self, model: &Composite, parameter: Parameter) -> Vec<f64> {
        if let Parameter::Coefficient(_) | Parameter::MarkovSigma(_) | Parameter::QuasiPeriodicRms(_) =
            parameter
        {
            return self.touched(model, parameter).into_iter().map(|s| 2.0 * s).collect();
        }
        let (at, step) = (model.value(parameter), 1e-4f64);
        let up = self.touched(&model.with(parameter, at * step.exp()), parameter);
        let down = self.touched(&model.with(parameter, at * (-step).exp()), parameter);
        up.iter().zip(down).map(|(u, d)| (u - d) / (2.0 * step)).collect()
    }

    /// Power over expected power in bands of at least `least` modes, with their degrees of freedom; the ramp known.
    pub fn whitened(&self, data: &Data, truth: &Composite, least: f64) -> Vec<(f64, f64)> {
        let (expected, r) = (self.expected(truth), truth.terms.r);
        let mut out: Vec<(f64, f64)> = vec![];
        for (i, (row, s)) in self.rows.iter().zip(&expected).enumerate() {
            let power = data.power[i] - 2.0 * r * data.cross[i] + r * r * row.ramp;
            match out.last_mut() {
                Some((sum, dof)) if *dof < least => {
                    (*sum, *dof) = (*sum + row.dof * power / s, *dof + row.dof)
                }
                _ => out.push((row.dof * power / s, row.dof)),
            }
        }
        out.into_iter().map(|(sum, dof)| (sum / dof, dof)).collect()
    }

    /// −2 ln L up to a constant, for expected powers and a ramp.
    pub fn deviance(&self, data: &Data, expected: &[f64], r: f64) -> f64 {
        self.rows
            .iter()
            .zip(expected)
            .enumerate()
            .map(|(i, (row, s))| {
                let power = data.power[i] - 2.0 * r * data.cross[i] + r * r * row.ramp;
                if *s > 0.0 { row.dof * (s.ln() + power / s) } else { f64::INFINITY }
            })
            .sum()
    }

    /// The ramp that fits best, and its Fisher information.
    pub fn ramp(&self, data: &Data, expected: &[f64]) -> (f64, f64) {
        let (mut cross, mut square) = (0.0, 0.0);
        for (i, (row, s)) in self.rows.iter().zip(expected).enumerate() {
            cross += row.dof * data.cross[i] / s;
            square += row.dof * row.ramp / s;
        }
        (cross / square, square)
    }

    /// Fisher information of the logarithms of parameters other than the ramp, and −½ the gradient of the deviance.
    pub fn scoring(
        &self,
        data: Option<(&Data, f64)>,
        model: &Composite,
        expected: &[f64],
        parameters: &[Parameter],
    ) -> (DMatrix<f64>, DVector<f64>) {
        let slopes: Vec<Vec<f64>> = parameters.iter().map(|p| self.slope(model, *p)).collect();
        let count = parameters.len();
        let (mut information, mut gradient) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for (k, (row, s)) in self.rows.iter().zip(expected).enumerate() {
            let weight = 0.5 * row.dof / (s * s);
            let rest = data.map_or(0.0, |(d, r)| d.power[k] - 2.0 * r * d.cross[k] + r * r * row.ramp - s);
            for i in 0..count {
                gradient[i] += weight * slopes[i][k] * rest;
                for j in 0..=i {
                    information[(i, j)] += weight * slopes[i][k] * slopes[j][k];
                }
            }
        }
        for i in 0..count {
            for j in i + 1..count {
                information[(i, j)] = information[(j, i)];
            }
        }
        (information, gradient)
    }

    /// Cramér-Rao bounds of the parameters of the true structure, relative to their values.
    pub fn bounds(&self, truth: &Composite, parameters: &[Parameter]) -> Vec<f64> {
        let expected = self.expected(truth);
        let is_ramp = |p: &Parameter| *p == Parameter::Coefficient(NoiseType::RateRamp);
        let spectral: Vec<Parameter> = parameters.iter().copied().filter(|p| !is_ramp(p)).collect();
        let (information, _) = self.scoring(None, truth, &expected, &spectral);
        let inverse = information.try_inverse();
        let mut of_spectral = (0..spectral.len())
            .map(|i| inverse.as_ref().map_or(f64::INFINITY, |m| m[(i, i)].max(0.0).sqrt()));
        let ramp: f64 = self
            .rows
            .iter()
            .zip(&expected)
            .map(|(row, s)| row.dof * row.ramp / s)
            .sum::<f64>()
            .sqrt()
            .recip();
        parameters
            .iter()
            .map(|p| {
                if is_ramp(p) {
                    ramp / truth.terms.r.abs()
                } else {
                    of_spectral.next().unwrap_or(f64::INFINITY)
                }
            })
            .collect()
    }
}
