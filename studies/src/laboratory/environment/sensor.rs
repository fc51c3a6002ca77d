//! A sensor: it follows late, adds noise and rounds.

use super::span::Span;
use crate::laboratory::dice::Dice;

/// Properties of a sensor, in the unit of its quantity.
#[derive(Debug, Clone, Copy)]
pub struct Sensor {
    /// Time constant, s.
    pub lag_s: f64,
    /// Noise of a reading.
    pub noise: f64,
    /// Smallest difference between readings.
    pub resolution: f64,
}

impl Sensor {
    /// What it shows of a course at instants, s. Before the first row it had settled.
    pub fn read(&self, dice: &mut Dice, span: &Span, course: &[f64], time_s: &[f64]) -> Vec<f64> {
        let kept = if self.lag_s > 0.0 { (-span.step_s / self.lag_s).exp() } else { 0.0 };
        let mut state = course[0];
        let late: Vec<f64> = course
            .iter()
            .map(|x| {
                state = kept * state + (1.0 - kept) * x;
                state
            })
            .collect();
        let seen = span.at(&late, time_s).into_iter();
        seen.map(|x| ((x + self.noise * dice.normal()) / self.resolution).round() * self.resolution).collect()
    }
}
