//! A model with the covariance of its parameters, and what follows for quantities computed from it.

use super::{Composite, Line};
use crate::noise::data::NoiseType;

/// A parameter of a [`Composite`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// N, B, K, Q or R.
    Coefficient(NoiseType),
    /// Standard deviation of a Markov process, deg/h.
    MarkovSigma(usize),
    /// Its correlation time, s.
    MarkovTime(usize),
    /// Rms of a quasi-periodic disturbance, deg/h.
    QuasiPeriodicRms(usize),
    /// Its centre frequency, Hz.
    QuasiPeriodicFrequency(usize),
    /// Its coherence time, s.
    QuasiPeriodicTime(usize),
    /// Time constant of a first-order filter, s.
    FilterTime,
    /// Amplitude of a line, deg/h.
    LineAmplitude(usize),
}

/// Noise of a record: the best description and how well its parameters are known.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Described {
    /// The description.
    pub model: Composite,
    /// Parameters that were fitted.
    pub parameters: Vec<Parameter>,
    /// Their covariance, in the units of the parameters.
    pub covariance: Vec<Vec<f64>>,
}

impl Composite {
    /// The value of a parameter; 0 where the model lacks it.
    pub fn value(&self, parameter: Parameter) -> f64 {
        let markov = |i: usize| self.markov.get(i);
        let periodic = |i: usize| self.quasi_periodic.get(i);
        match parameter {
            Parameter::Coefficient(term) => self.terms.coefficient(term),
            Parameter::MarkovSigma(i) => markov(i).map_or(0.0, |d| d.rms_deg_h),
            Parameter::MarkovTime(i) => markov(i).map_or(0.0, |d| d.decay_time_s),
            Parameter::QuasiPeriodicRms(i) => periodic(i).map_or(0.0, |d| d.rms_deg_h),
            Parameter::QuasiPeriodicFrequency(i) => periodic(i).map_or(0.0, |d| d.frequency_hz),
            Parameter::QuasiPeriodicTime(i) => periodic(i).map_or(0.0, |d| d.decay_time_s),
            Parameter::FilterTime => match self.bandwidth {
                Some(super::Bandwidth::FirstOrder { time_constant_s }) => time_constant_s,
                _ => 0.0,
            },
            Parameter::LineAmplitude(i) => self.lines.get(i).map_or(0.0, |l| l.amplitude_deg_h),
        }
    }

    /// The model with one parameter changed; unchanged where the model lacks it.
    #[must_use]
    pub fn with(&self, parameter: Parameter, value: f64) -> Composite {
        let mut out = self.clone();
        match parameter {
            Parameter::Coefficient(term) => out.terms = out.terms.with(term, value),
            Parameter::FilterTime => {
                if let Some(super::Bandwidth::FirstOrder { time_constant_s }) = &mut out.bandwidth {
                    *time_constant_s = value;
                }
            }
            Parameter::LineAmplitude(i) => {
                if let Some(line) = out.lines.get_mut(i) {
                    line.amplitude_deg_h = value;
                }
            }
            Parameter::MarkovSigma(i) | Parameter::MarkovTime(i) => {
                if let Some(d) = out.markov.get_mut(i) {
                    if matches!(parameter, Parameter::MarkovSigma(_)) {
                        d.rms_deg_h = value
                    } else {
                        d.decay_time_s = value
                    }
                }
            }
            Parameter::QuasiPeriodicRms(i)
            | Parameter::QuasiPeriodicFrequency(i)
            | Parameter::QuasiPeriodicTime(i) => {
                if let Some(d) = out.quasi_periodic.get_mut(i) {
                    match parameter {
                        Parameter::QuasiPeriodicRms(_) => d.rms_deg_h = value,
                        Parameter::QuasiPeriodicFrequency(_) => d.frequency_hz = value,
                        _ => d.decay_time_s = value,
                    }
                }
            }
        }
        out
    }
}

/// A quantity that follows from a description.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Propagated {
    /// Value at the parameters of the description.
    pub value: f64,
    /// Standard uncertainty, same unit.
    pub standard_uncertainty: f64,
}

impl Described {
    /// Keeps those lines of the model that a condition holds for, their parameters with them.
    pub fn keep_lines(&mut self, kept: impl Fn(&Line) -> bool) {
        let places: Vec<bool> = self.model.lines.iter().map(kept).collect();
        let mut at = 0;
        self.model.lines.retain(|_| {
            at += 1;
            places.get(at - 1).copied().unwrap_or(false)
        });
        let moved = |i: usize| places.iter().take(i).filter(|k| **k).count();
        let stays: Vec<bool> = self
            .parameters
            .iter()
            .map(|p| match p {
                Parameter::LineAmplitude(i) => places.get(*i).copied().unwrap_or(false),
                _ => true,
            })
            .collect();
        let held = |i: usize| stays.get(i).copied().unwrap_or(false);
        self.covariance = (0..self.covariance.len())
            .filter(|i| held(*i))
            .map(|i| {
                let row = self.covariance.get(i).map(Vec::as_slice).unwrap_or_default();
                row.iter().enumerate().filter(|(j, _)| held(*j)).map(|(_, c)| *c).collect()
            })
            .collect();
        self.parameters = std::mem::take(&mut self.parameters)
            .into_iter()
            .zip(&stays)
            .filter(|(_, stays)| **stays)
            .map(|(p, _)| match p {
                Parameter::LineAmplitude(i) => Parameter::LineAmplitude(moved(i)),
                other => other,
            })
            .collect();
    }

    /// The correlation of two parameters; `None` where one was not fitted or has no variance.
    pub fn correlation(&self, one: Parameter, other: Parameter) -> Option<f64> {
        let place = |p: Parameter| self.parameters.iter().position(|q| *q == p);
        let (i, j) = (place(one)?, place(other)?);
        let at = |i: usize, j: usize| self.covariance.get(i)?.get(j).copied();
        let scale = (at(i, i)? * at(j, j)?).sqrt();
        (scale > 0.0).then_some((at(i, j)? / scale).clamp(-1.0, 1.0))
    }

    /// A quantity computed from the model, with its standard uncertainty from the covariance of the parameters, to first
    /// order.
    pub fn propagate(&self, quantity: impl Fn(&Composite) -> f64) -> Propagated {
        let value = quantity(&self.model);
        let gradient: Vec<f64> = self
            .parameters
            .iter()
            .map(|p| {
                let at = self.model.value(*p);
                let step = 1e-3 * at.abs();
                if step == 0.0 {
                    return 0.0;
                }
                let (up, down) = (self.model.with(*p, at + step), self.model.with(*p, at - step));
                (quantity(&up) - quantity(&down)) / (2.0 * step)
            })
            .collect();
        let mut square = 0.0;
        for (row, gi) in self.covariance.iter().zip(&gradient) {
            square += gi * row.iter().zip(&gradient).map(|(c, gj)| c * gj).sum::<f64>();
        }
        Propagated { value, standard_uncertainty: square.max(0.0).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Bandwidth, Damped};
    use super::*;
    use crate::noise::model::NoiseModel;

    #[test]
    fn a_correlation_is_that_of_the_covariance() {
        let (n, b) = (Parameter::Coefficient(NoiseType::AngleRandomWalk), Parameter::MarkovSigma(0));
        let described = Described {
            parameters: vec![n, b],
            covariance: vec![vec![4.0, -3.0], vec![-3.0, 9.0]],
            ..Described::default()
        };
        assert_eq!(described.correlation(n, b), Some(-0.5));
        assert_eq!(described.correlation(n, n), Some(1.0));
        assert_eq!(described.correlation(n, Parameter::MarkovTime(0)), None);
    }

    #[test]
    fn parameters_are_read_and_changed_one_by_one() {
        let model = Composite {
            terms: NoiseModel { n: 1.0, b: 2.0, k: 3.0, r: 4.0, q: 5.0 },
            markov: vec![Damped { rms_deg_h: 6.0, frequency_hz: 0.0, decay_time_s: 7.0 }],
            quasi_periodic: vec![Damped { rms_deg_h: 8.0, frequency_hz: 9.0, decay_time_s: 10.0 }],
            bandwidth: Some(Bandwidth::FirstOrder { time_constant_s: 11.0 }),
            ..Default::default()
        };
        let all = [
            Parameter::Coefficient(NoiseType::Flicker),
            Parameter::MarkovSigma(0),
            Parameter::MarkovTime(0),
            Parameter::QuasiPeriodicRms(0),
            Parameter::QuasiPeriodicFrequency(0),
            Parameter::QuasiPeriodicTime(0),
            Parameter::FilterTime,
        ];
        for p in all {
            let changed = model.with(p, 0.5);
            assert_eq!(changed.value(p), 0.5);
            for other in all.into_iter().filter(|o| *o != p) {
                assert_eq!(changed.value(other), model.value(other), "{p:?} {other:?}");
            }
        }
    }

    #[test]
    fn uncertainty_follows_the_gradient() {
        let described = Described {
            model: NoiseModel { n: 0.002, ..Default::default() }.into(),
            parameters: vec![Parameter::Coefficient(NoiseType::AngleRandomWalk)],
            covariance: vec![vec![1e-10]],
        };
        let Propagated { value, standard_uncertainty: u } = described.propagate(|m| m.terms.n * m.terms.n);
        assert!((value - 4e-6).abs() < 1e-18 && (u / (2.0 * 0.002 * 1e-5) - 1.0).abs() < 1e-6);
    }
}
