//! How a bias follows a quantity of the surroundings: by its value, its change, late, curved or with loops.

use super::curve::Curve;
use super::hysteresis::Hysteresis;
use crate::laboratory::dice::Dice;
use crate::laboratory::environment::span::Span;

/// A law, as the contract names them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// In proportion.
    Linear,
    /// In proportion to the change per hour.
    Rate,
    /// Late, through two stages.
    Lag,
    /// Curved.
    Curve,
    /// With loops.
    Hysteresis,
}

impl Law {
    /// Every law.
    pub const ALL: [Law; 5] = [Law::Linear, Law::Rate, Law::Lag, Law::Curve, Law::Hysteresis];

    /// Its name in the contract.
    pub fn name(self) -> &'static str {
        match self {
            Law::Linear => "linear",
            Law::Rate => "rate",
            Law::Lag => "lag",
            Law::Curve => "curve",
            Law::Hysteresis => "hysteresis",
        }
    }

    /// The response to a driver over a span; linear and rate with a coefficient of one per unit (and hour).
    pub fn respond(self, dice: &mut Dice, span: &Span, driver: &[f64]) -> Vec<f64> {
        let (low, high) = driver.iter().fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
        match self {
            Law::Linear => driver.to_vec(),
            // A seal that breathes: the difference of inside and outside, which follows the change within a minute or two.
            Law::Rate => {
                let leak_s = dice.uniform(40.0, 150.0);
                let behind = late(span, driver, leak_s);
                driver.iter().zip(&behind).map(|(x, b)| (x - b) / leak_s * 3600.0).collect()
            }
            Law::Lag => {
                let slow_s = dice.decades(0.01, 0.08) * span.duration_s();
                late(span, &late(span, driver, 0.75 * slow_s), 0.25 * slow_s)
            }
            Law::Curve => {
                let curve = Curve::draw(dice, low, high);
                driver.iter().map(|x| curve.at(*x)).collect()
            }
            Law::Hysteresis => {
                let typical = dice.uniform(0.08, 0.25) * (high - low);
                Hysteresis::draw(dice, typical.max(1e-9)).run(dice, driver)
            }
        }
    }
}

/// A course one stage later.
pub fn late(span: &Span, course: &[f64], time_constant_s: f64) -> Vec<f64> {
    let kept = (-span.step_s / time_constant_s).exp();
    let mut state = course[0];
    course
        .iter()
        .map(|x| {
            state = kept * state + (1.0 - kept) * x;
            state
        })
        .collect()
}
