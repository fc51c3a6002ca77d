//! Magnetic field: the Earth's with its day, and trams that draw current somewhere along their line.

use super::people::busyness;
use super::span::Span;
use crate::laboratory::dice::Dice;
use crate::laboratory::process::relaxation;
use std::f64::consts::TAU;

/// Field along an axis, µT.
pub fn field(dice: &mut Dice, span: &Span) -> Vec<f64> {
    let (earth, day) = (dice.uniform(-45.0, 45.0), dice.uniform(0.01, 0.04));
    let slow_ut = dice.decades(0.01, 0.05);
    let slow = relaxation(dice, span.length, span.step_s, 5400.0, slow_ut);
    let tram = dice.decades(0.1, 1.5);
    let (mut current, mut shown, mut left) = (0.0f64, 0.0f64, dice.waiting(60.0));
    (0..span.length)
        .map(|i| {
            left -= span.step_s;
            if left < 0.0 {
                // Accelerating, coasting or gone; at night gone most of the time.
                current = if dice.chance(busyness(span.hour(i))) {
                    *dice.one_of(&[0.0, 0.4, 1.0, -0.6])
                } else {
                    0.0
                };
                current *= dice.uniform(0.5, 1.5);
                left = dice.waiting(45.0);
            }
            shown += (current - shown) * (1.0 - (-span.step_s / 2.0).exp());
            earth + slow[i] + day * (TAU * span.hour(i) / 24.0).sin() + tram * shown
        })
        .collect()
}
