//! Supply voltage: a battery that discharges, a regulator under load steps, or mains that sag.

use super::people::busyness;
use super::span::Span;
use crate::laboratory::dice::Dice;
use crate::laboratory::process::relaxation;
use std::f64::consts::TAU;

/// A load that is switched on and off, 0 or 1.
fn load(dice: &mut Dice, span: &Span, on_s: f64, off_s: f64) -> Vec<f64> {
    let (mut on, mut left) = (dice.chance(0.5), dice.waiting(off_s));
    (0..span.length)
        .map(|_| {
            left -= span.step_s;
            if left < 0.0 {
                on = !on;
                left = dice.waiting(if on { on_s } else { off_s });
            }
            f64::from(on)
        })
        .collect()
}

/// A supply of one of the three sorts, V.
pub fn voltage(dice: &mut Dice, span: &Span) -> Vec<f64> {
    let nominal = *dice.one_of(&[5.0, 12.0, 15.0, 27.0]);
    let load_s = dice.decades(200.0, 2500.0);
    let loads = load(dice, span, load_s, load_s);
    let ripple_s = dice.decades(20.0, 600.0);
    let ripple = relaxation(dice, span.length, span.step_s, ripple_s, 1.0);
    let sort = dice.count(0, 2);
    let resistance = nominal * dice.decades(0.002, 0.01);
    let used = dice.uniform(0.05, 0.3);
    let rest = dice.uniform(0.5, 0.98) - used;
    let sag = nominal * dice.uniform(0.005, 0.02);
    (0..span.length)
        .map(|i| {
            let past = i as f64 / span.length as f64;
            match sort {
                // Full at first, a plateau, then the knee.
                0 => {
                    let charge = used + rest * past;
                    nominal * (1.04 - 0.03 * charge + 0.012 * (-charge / 0.08).exp() - 0.05 * charge.powi(9))
                        - resistance * loads[i]
                        + 2e-4 * nominal * ripple[i]
                }
                1 => nominal - resistance * loads[i] + 5e-4 * nominal * ripple[i],
                _ => {
                    let city = busyness(span.hour(i));
                    nominal - sag * city + 8e-4 * nominal * ripple[i] - 0.2 * resistance * loads[i]
                        + 3e-4 * nominal * (TAU * span.time_s(i) / 900.0).sin()
                }
            }
        })
        .collect()
}
