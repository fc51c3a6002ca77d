//! What a joint fit changes: variances, times and frequencies of every kind of part, and the ramp.

use crate::noise::composite::{Bandwidth, Composite, Damped, Parameter, Sampling};
use crate::noise::data::NoiseType;
use crate::noise::evidence::Zone;
use crate::noise::model::NoiseModel;

/// Terms with a spectrum that every model may have, in the order of their variances.
pub const BASE_TERMS: [NoiseType; 4] =
    [NoiseType::AngleRandomWalk, NoiseType::Flicker, NoiseType::RateRandomWalk, NoiseType::Quantization];

/// Position of quantisation among the variances.
pub const QUANTIZATION_INDEX: usize = 3;
/// Parts accepted at most.
pub const MAX_PROCESSES: usize = 4;
/// Shortest correlation time that is told from white noise, sample intervals: the corner then lies at half the Nyquist
/// frequency, so that an octave of the fall beyond it is seen. A process with a higher corner is white noise.
pub const MIN_TIME_SAMPLES: f64 = 0.637;
/// Longest correlation time that is told from random walk: this share of the record.
pub const MAX_TIME_SHARE: f64 = 0.125;

/// What a damped process stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProcessKind {
    /// First-order Markov noise.
    Markov,
    /// Quasi-periodic disturbance.
    QuasiPeriodic,
}

/// The nonlinear part of a model: what there is beside N, B, K, Q and R, with its times and frequencies.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shape {
    /// Bandwidth of the measurement.
    pub filter: Option<Bandwidth>,
    /// Damped processes; their rms is left to the fit and 1 here.
    pub damped: Vec<(ProcessKind, Damped)>,
}

impl Shape {
    /// True when there is nothing beside N, B, K, Q and R.
    pub fn is_plain(&self) -> bool {
        self.filter.is_none() && self.damped.is_empty()
    }

    /// With one more process.
    #[must_use]
    pub fn with(&self, kind: ProcessKind, frequency_hz: f64, decay_time_s: f64) -> Shape {
        let mut out = self.clone();
        out.damped.push((kind, Damped { rms_deg_h: 1.0, frequency_hz, decay_time_s }));
        out
    }
}

/// A point of the joint likelihood.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointPoint {
    /// N², B², K², Q², then the variances of the damped processes.
    pub variance: Vec<f64>,
    /// Times and frequencies.
    pub shape: Shape,
    /// Ramp, deg/h/h.
    pub ramp: f64,
    /// −2 ln L up to a constant of the evidence.
    pub deviance: f64,
}

impl JointPoint {
    /// N, B, K, Q and R.
    pub fn terms(&self) -> NoiseModel {
        let root = |i: usize| self.variance.get(i).copied().unwrap_or(0.0).max(0.0).sqrt();
        NoiseModel { n: root(0), b: root(1), k: root(2), q: root(3), r: self.ramp }
    }

    /// The whole model.
    pub fn composite(&self, sampling: Sampling) -> Composite {
        let mut out =
            Composite { terms: self.terms(), bandwidth: self.shape.filter, sampling, ..Default::default() };
        for ((kind, process), variance) in
            self.shape.damped.iter().zip(self.variance.iter().skip(BASE_TERMS.len()))
        {
            let process = Damped { rms_deg_h: variance.max(0.0).sqrt(), ..*process };
            match kind {
                ProcessKind::Markov => out.markov.push(process),
                ProcessKind::QuasiPeriodic => out.quasi_periodic.push(process),
            }
        }
        out
    }
}

/// A parameter of a [`JointPoint`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variable {
    /// A variance, by position.
    Variance(usize),
    /// Logarithm of the time constant of a first-order filter.
    FilterTime,
    /// Logarithm of the decay time of a process, by position.
    DecayTime(usize),
    /// Centre frequency of a process, by position.
    Frequency(usize),
    /// The ramp.
    Ramp,
}

impl JointPoint {
    /// Value in the unit that is reported: coefficients and standard deviations, times in s, frequencies in Hz.
    pub fn reported(&self, variable: Variable) -> f64 {
        let process = |i: usize| self.shape.damped.get(i).map(|(_, d)| *d);
        match variable {
            Variable::Variance(i) => self.variance.get(i).copied().unwrap_or(0.0).max(0.0).sqrt(),
            Variable::FilterTime => match self.shape.filter {
                Some(Bandwidth::FirstOrder { time_constant_s }) => time_constant_s,
                _ => 0.0,
            },
            Variable::DecayTime(i) => process(i).map_or(0.0, |d| d.decay_time_s),
            Variable::Frequency(i) => process(i).map_or(0.0, |d| d.frequency_hz),
            Variable::Ramp => self.ramp,
        }
    }

    /// Sets a variable from a reported value.
    pub fn set_reported(&mut self, variable: Variable, value: f64) {
        match variable {
            Variable::Variance(i) => {
                if let Some(v) = self.variance.get_mut(i) {
                    *v = value * value;
                }
            }
            Variable::FilterTime => {
                if let Some(Bandwidth::FirstOrder { time_constant_s }) = &mut self.shape.filter {
                    *time_constant_s = value;
                }
            }
            Variable::DecayTime(i) => {
                if let Some((_, d)) = self.shape.damped.get_mut(i) {
                    d.decay_time_s = value;
                }
            }
            Variable::Frequency(i) => {
                if let Some((_, d)) = self.shape.damped.get_mut(i) {
                    d.frequency_hz = value;
                }
            }
            Variable::Ramp => self.ramp = value,
        }
    }

    /// The parameter of the [`Composite`] of this point that a variable is.
    pub fn parameter(&self, variable: Variable) -> Option<Parameter> {
        let place = |i: usize| {
            let kind = self.shape.damped.get(i)?.0;
            let before = self.shape.damped.iter().take(i).filter(|(k, _)| *k == kind).count();
            Some((kind, before))
        };
        Some(match variable {
            Variable::Ramp => Parameter::Coefficient(NoiseType::RateRamp),
            Variable::FilterTime => Parameter::FilterTime,
            Variable::Variance(i) if i < BASE_TERMS.len() => Parameter::Coefficient(*BASE_TERMS.get(i)?),
            Variable::Variance(i) => match place(i - BASE_TERMS.len())? {
                (ProcessKind::Markov, j) => Parameter::MarkovSigma(j),
                (ProcessKind::QuasiPeriodic, j) => Parameter::QuasiPeriodicRms(j),
            },
            Variable::DecayTime(i) => match place(i)? {
                (ProcessKind::Markov, j) => Parameter::MarkovTime(j),
                (ProcessKind::QuasiPeriodic, j) => Parameter::QuasiPeriodicTime(j),
            },
            Variable::Frequency(i) => Parameter::QuasiPeriodicFrequency(place(i)?.1),
        })
    }
}

/// Which variables a fit may change.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Free {
    /// Free variances, in the order of [`JointPoint::variance`].
    pub variance: Vec<bool>,
    /// Whether times and frequencies are free.
    pub nonlinear: bool,
    /// Whether the ramp is free (restricted likelihood) or held.
    pub ramp: bool,
    /// One variable that is held whatever the others say.
    pub held: Option<Variable>,
}

impl Free {
    /// Every variance of a shape; the ramp and the times and frequencies as asked.
    pub fn all(shape: &Shape, ramp: bool, nonlinear: bool) -> Free {
        Free { variance: vec![true; BASE_TERMS.len() + shape.damped.len()], nonlinear, ramp, held: None }
    }
}

/// Parts found beside N, B, K, Q and R.
#[derive(Debug, Clone, PartialEq)]
pub struct Extras {
    /// The shape of the model.
    pub shape: Shape,
    /// Resonances that the bands must resolve.
    pub zones: Vec<Zone>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variables_are_the_parameters_of_the_composite() {
        let shape = Shape { filter: Some(Bandwidth::FirstOrder { time_constant_s: 0.3 }), damped: vec![] };
        let shape = shape.with(ProcessKind::QuasiPeriodic, 0.1, 50.0).with(ProcessKind::Markov, 0.0, 20.0);
        let mut point =
            JointPoint { variance: vec![4.0, 0.0, 0.0, 0.0, 9.0, 16.0], shape, ramp: -1.0, deviance: 0.0 };
        let model = point.composite(Sampling::Averaging);
        for variable in [
            Variable::Variance(0),
            Variable::Variance(4),
            Variable::Variance(5),
            Variable::FilterTime,
            Variable::DecayTime(0),
            Variable::DecayTime(1),
            Variable::Frequency(0),
            Variable::Ramp,
        ] {
            let parameter = point.parameter(variable).unwrap();
            assert_eq!(model.value(parameter), point.reported(variable), "{variable:?}");
            let changed = 1.5 * point.reported(variable);
            point.set_reported(variable, changed);
            assert_eq!(point.reported(variable), changed, "{variable:?}");
        }
        assert_eq!((model.markov[0].rms_deg_h, model.quasi_periodic[0].rms_deg_h), (4.0, 3.0));
    }
}
