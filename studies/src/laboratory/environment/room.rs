//! Air of a laboratory room: day, air conditioning switched by a relay, doors, people.

use super::span::Span;
use crate::laboratory::dice::Dice;
use crate::laboratory::environment::people;
use crate::laboratory::process::instants;

/// Air of the room, °C.
pub fn air(dice: &mut Dice, span: &Span, outside_deg_c: &[f64]) -> Vec<f64> {
    let wanted = dice.uniform(20.0, 24.0);
    let cooled = dice.chance(0.7);
    let band = dice.uniform(0.3, 0.9);
    let leak_s = dice.uniform(8_000.0, 30_000.0);
    let strength = dice.uniform(1.5, 4.0) / 3600.0;
    let door_s = dice.decades(900.0, 6000.0);
    let doors = instants(dice, span.duration_s(), door_s);
    let crowd = dice.uniform(0.2, 1.2) / 3600.0;
    let (mut inside, mut running, mut door) = (wanted + dice.uniform(-0.5, 0.5), false, 0);
    let mut open_s = 0.0f64;
    (0..span.length)
        .map(|i| {
            while door < doors.len() && doors[door] <= span.time_s(i) {
                // By day doors open, at night hardly.
                if dice.chance(people::busyness(span.hour(i))) {
                    open_s = dice.decades(5.0, 90.0);
                }
                door += 1;
            }
            if cooled {
                running = if running { inside > wanted - band } else { inside > wanted + band };
            }
            let now = inside;
            let draught =
                if open_s > 0.0 { (0.5 * (outside_deg_c[i] + wanted) - inside) / 2500.0 } else { 0.0 };
            open_s -= span.step_s;
            inside += span.step_s
                * ((0.3 * outside_deg_c[i] + 0.7 * wanted + 0.8 - inside) / leak_s
                    + draught
                    + crowd * people::busyness(span.hour(i))
                    - if running { strength } else { 0.0 });
            now
        })
        .collect()
}
