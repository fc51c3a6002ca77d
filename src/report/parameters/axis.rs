//! The noise of one axis of a unit as its result states it: measured, bounded, or not stated.

use crate::estimate::Interval;
use crate::measurand::{
    ANGLE_RANDOM_WALK, BIAS_INSTABILITY, BIAS_TEMPERATURE_SENSITIVITY, Measurand, QUANTIZATION, RATE_RAMP,
    RATE_RANDOM_WALK, SCALE_FACTOR_TEMPERATURE_SENSITIVITY, STATIC_BIAS,
};
use crate::noise::composite::{Composite, Damped};
use crate::noise::model::NoiseModel;
use crate::record::{MeasurandRecord, RunRecord};

/// One quantity of a result, in the unit of its measurand.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Level {
    /// A value with its interval, if any.
    Measured {
        /// The value.
        value: f64,
        /// Interval of the value.
        interval: Option<Interval>,
    },
    /// An upper limit: the recording does not resolve the quantity.
    AtMost {
        /// The limit.
        value: f64,
        /// Probability with which such limits lie above the true value.
        coverage: f64,
    },
    /// No row, or a row that states neither.
    #[default]
    NotStated,
}

impl Level {
    /// The value to be used: what was measured, else the upper limit.
    pub fn used(self) -> Option<f64> {
        match self {
            Level::Measured { value, .. } | Level::AtMost { value, .. } => Some(value),
            Level::NotStated => None,
        }
    }

    /// What was measured; 0 without a value.
    pub fn measured(self) -> f64 {
        match self {
            Level::Measured { value, .. } => value,
            _ => 0.0,
        }
    }

    /// The level times a factor.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Level {
        match self {
            Level::Measured { value, interval } => Level::Measured {
                value: value * factor,
                interval: interval.map(|i| Interval { low: i.low * factor, high: i.high * factor, ..i }),
            },
            Level::AtMost { value, coverage } => Level::AtMost { value: value * factor, coverage },
            Level::NotStated => Level::NotStated,
        }
    }

    fn of(row: &MeasurandRecord) -> Level {
        match (row.value, row.upper_limit) {
            (Some(value), _) => Level::Measured { value, interval: row.interval },
            (None, Some(limit)) => Level::AtMost { value: limit.value, coverage: limit.coverage },
            (None, None) => Level::NotStated,
        }
    }
}

/// One axis of a unit, each quantity in the unit of its measurand.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Channel of the result.
    pub channel: String,
    /// Angle random walk N.
    pub white: Level,
    /// Flicker coefficient B.
    pub flicker: Level,
    /// Rate random walk K.
    pub random_walk: Level,
    /// Quantisation Q.
    pub quantization: Level,
    /// Rate ramp R.
    pub ramp: Level,
    /// Static bias.
    pub bias: Level,
    /// Temperature sensitivity of the bias.
    pub temperature_sensitivity: Level,
    /// Temperature sensitivity of the scale factor.
    pub scale_factor_temperature: Level,
    /// First-order Markov processes that were measured.
    pub markov: Vec<Damped>,
    /// Quasi-periodic disturbances that were measured.
    pub quasi_periodic: Vec<Damped>,
    /// Interval of the samples, s; `None` where the result has none.
    pub sample_interval_s: Option<f64>,
    /// Length of the recording, s.
    pub duration_s: f64,
}

impl Axis {
    /// The axes of a result: every channel with a row that a target may use, in the order of the rows.
    pub fn all(record: &RunRecord) -> Vec<Axis> {
        let used: [&Measurand; 8] = [
            &ANGLE_RANDOM_WALK,
            &BIAS_INSTABILITY,
            &RATE_RANDOM_WALK,
            &QUANTIZATION,
            &RATE_RAMP,
            &STATIC_BIAS,
            &BIAS_TEMPERATURE_SENSITIVITY,
            &SCALE_FACTOR_TEMPERATURE_SENSITIVITY,
        ];
        let mut channels: Vec<&str> = vec![];
        for row in &record.measurands {
            if used.iter().any(|m| m.id == row.id) && !channels.contains(&row.channel.as_str()) {
                channels.push(&row.channel);
            }
        }
        channels.into_iter().map(|channel| Axis::of(record, channel)).collect()
    }

    fn of(record: &RunRecord, channel: &str) -> Axis {
        let level = |m: &Measurand| {
            let row = record.measurands.iter().find(|r| r.id == m.id && r.channel == channel);
            row.map(Level::of).unwrap_or_default()
        };
        let model = record.noise_models.iter().find(|m| m.channel == channel);
        let markov = model.map(|m| m.markov.as_slice()).unwrap_or_default();
        let quasi_periodic = model.map(|m| m.quasi_periodic.as_slice()).unwrap_or_default();
        let file = record.recording.first();
        Axis {
            channel: channel.to_owned(),
            white: level(&ANGLE_RANDOM_WALK),
            flicker: level(&BIAS_INSTABILITY),
            random_walk: level(&RATE_RANDOM_WALK),
            quantization: level(&QUANTIZATION),
            ramp: level(&RATE_RAMP),
            bias: level(&STATIC_BIAS),
            temperature_sensitivity: level(&BIAS_TEMPERATURE_SENSITIVITY),
            scale_factor_temperature: level(&SCALE_FACTOR_TEMPERATURE_SENSITIVITY),
            markov: markov.iter().map(|[rms, time]| gauss_markov(*rms, *time)).collect(),
            quasi_periodic: quasi_periodic
                .iter()
                .map(|[rms, frequency, time]| Damped {
                    rms_deg_h: *rms,
                    frequency_hz: *frequency,
                    decay_time_s: *time,
                })
                .collect(),
            sample_interval_s: file.map(|f| f.sample_interval_s).filter(|dt| *dt > 0.0),
            duration_s: record.recording.iter().map(|f| f.duration_s).sum(),
        }
    }

    /// The random noise that was measured, without the ramp.
    pub fn measured(&self) -> Composite {
        Composite {
            terms: NoiseModel {
                n: self.white.measured(),
                b: self.flicker.measured(),
                k: self.random_walk.measured(),
                q: self.quantization.measured(),
                r: 0.0,
            },
            markov: self.markov.clone(),
            quasi_periodic: self.quasi_periodic.clone(),
            ..Composite::default()
        }
    }

    /// The axis with every noise quantity times a factor.
    #[must_use]
    pub fn inflated(&self, factor: f64) -> Axis {
        let scaled = |d: &Damped| Damped { rms_deg_h: d.rms_deg_h * factor, ..*d };
        Axis {
            white: self.white.scaled(factor),
            flicker: self.flicker.scaled(factor),
            random_walk: self.random_walk.scaled(factor),
            quantization: self.quantization.scaled(factor),
            markov: self.markov.iter().map(scaled).collect(),
            quasi_periodic: self.quasi_periodic.iter().map(scaled).collect(),
            ..self.clone()
        }
    }
}

/// A first-order Gauss-Markov process of a standard deviation, deg/h, and a correlation time, s.
pub fn gauss_markov(rms_deg_h: f64, correlation_time_s: f64) -> Damped {
    Damped { rms_deg_h, frequency_hz: 0.0, decay_time_s: correlation_time_s }
}

#[cfg(test)]
mod tests {
    use super::super::example::{record, row};
    use super::*;

    #[test]
    fn an_axis_holds_values_limits_and_gaps_of_its_channel() {
        use crate::estimate::UpperLimit;
        let mut unresolved = row(&RATE_RANDOM_WALK, "y", 0.0);
        unresolved.value = None;
        unresolved.upper_limit = Some(UpperLimit { value: 0.4, coverage: 0.95 });
        let axes = Axis::all(&record(vec![
            row(&ANGLE_RANDOM_WALK, "x", 0.1),
            row(&ANGLE_RANDOM_WALK, "y", 0.2),
            unresolved,
            row(&crate::measurand::LINE_FREQUENCY, "z", 3.0),
        ]));
        assert_eq!(axes.iter().map(|a| a.channel.as_str()).collect::<Vec<_>>(), ["x", "y"]);
        assert_eq!((axes[0].white.used(), axes[0].random_walk.used()), (Some(0.1), None));
        assert_eq!(axes[1].random_walk, Level::AtMost { value: 0.4, coverage: 0.95 });
        // A limit is used, and is no part of what was measured.
        assert_eq!((axes[1].random_walk.used(), axes[1].measured().terms.k), (Some(0.4), 0.0));
        let twice = axes[1].inflated(2.0);
        assert_eq!((twice.white.used(), twice.random_walk.used()), (Some(0.4), Some(0.8)));
        assert_eq!(twice.bias, axes[1].bias);
    }
}
