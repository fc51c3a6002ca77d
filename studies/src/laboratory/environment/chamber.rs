//! A climatic chamber: heater and compressor switched by a thermostat with hysteresis, after a programme of ramps and soaks.

use super::span::Span;
use crate::laboratory::dice::Dice;

/// A part of a programme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Temperature at its end, °C.
    pub to_deg_c: f64,
    /// Length, s.
    pub duration_s: f64,
}

/// A programme that fills a duration: up and down at 4 to 60 °C/h with soaks, between temperatures drawn from a range. At
/// least one turn lies within the recording.
pub fn programme(dice: &mut Dice, duration_s: f64, low: f64, high: f64) -> (f64, Vec<Leg>) {
    let start = dice.uniform(low + 0.2 * (high - low), high - 0.2 * (high - low));
    // Fast enough for two changes of direction.
    let slowest = (2.5 * (high - low) / (duration_s / 3600.0)).clamp(4.0, 50.0);
    let rate_per_h = dice.decades(slowest, 60.0);
    let (mut at, mut left, mut up) = (start, duration_s, dice.chance(0.5));
    let mut legs = vec![];
    if dice.chance(0.7) {
        legs.push(Leg { to_deg_c: at, duration_s: dice.uniform(0.03, 0.1) * duration_s });
        left -= legs[0].duration_s;
    }
    while left > 0.0 {
        let to = if up {
            dice.uniform(high - 0.3 * (high - low), high)
        } else {
            dice.uniform(low, low + 0.3 * (high - low))
        };
        let ramp_s = (to - at).abs() / rate_per_h * 3600.0 * dice.uniform(0.8, 1.25);
        let soak_s = dice.uniform(0.02, 0.18) * duration_s;
        legs.push(Leg { to_deg_c: to, duration_s: ramp_s.max(60.0) });
        legs.push(Leg { to_deg_c: to, duration_s: soak_s });
        left -= ramp_s.max(60.0) + soak_s;
        at = to;
        up = !up;
    }
    (start, legs)
}

/// Air of the chamber. The relay switches at a fraction of a degree beside the setpoint; the air answers within minutes and
/// the walls within an hour, so that the air overshoots.
pub fn air(dice: &mut Dice, span: &Span, start_deg_c: f64, legs: &[Leg]) -> Vec<f64> {
    let band = dice.uniform(0.08, 0.5);
    let (air_s, wall_s) = (dice.uniform(150.0, 400.0), dice.uniform(1500.0, 4000.0));
    let room = dice.uniform(20.0, 25.0);
    let (heat, cold) = (dice.uniform(45.0, 70.0), dice.uniform(45.0, 70.0));
    let (mut inside, mut wall, mut effort) = (start_deg_c, start_deg_c, 0.0f64);
    let (mut leg, mut since, mut from) = (0, 0.0, start_deg_c);
    // The valve of the compressor stays for this long at least.
    let (shortest, mut held) = (dice.uniform(15.0, 60.0), 0.0);
    (0..span.length)
        .map(|_| {
            while leg < legs.len() && since >= legs[leg].duration_s {
                (since, from) = (since - legs[leg].duration_s, legs[leg].to_deg_c);
                leg += 1;
            }
            let wanted = legs.get(leg).map_or(from, |l| from + (l.to_deg_c - from) * since / l.duration_s);
            let wish = match inside - wanted {
                e if e > band => -1.0,
                e if e < -band => 1.0,
                _ => effort,
            };
            held += span.step_s;
            if wish != effort && held >= shortest {
                (effort, held) = (wish, 0.0);
            }
            let power = if effort > 0.0 {
                heat
            } else if effort < 0.0 {
                -cold
            } else {
                0.0
            };
            let now = inside;
            inside += span.step_s
                * ((power + wall - inside) / (2.0 * air_s)
                    + (wall - inside) / air_s
                    + (room - inside) / 20_000.0);
            wall += span.step_s * (inside - wall) / wall_s;
            since += span.step_s;
            now
        })
        .collect()
}
