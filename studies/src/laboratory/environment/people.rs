//! People and traffic: how busy an hour is, and the shaking that it brings.

use super::span::Span;
use crate::laboratory::dice::Dice;
use crate::laboratory::process::instants;

/// How busy an hour of the day is, 0.05 to 1: two rush hours and a working day.
pub fn busyness(hour: f64) -> f64 {
    let hump = |at: f64, width: f64| 1.0 / (1.0 + ((hour - at) / width).powi(4));
    (0.05 + 0.55 * hump(12.5, 4.5) + 0.4 * hump(8.3, 1.0) + 0.4 * hump(17.6, 1.3)).min(1.0)
}

/// Level of shaking: a floor, and vehicles that come and pass within half a minute. Unit: that of the floor.
pub fn shaking(dice: &mut Dice, span: &Span, floor: f64) -> Vec<f64> {
    let mut level = vec![floor; span.length];
    let wait = dice.decades(60.0, 500.0);
    for at in instants(dice, span.duration_s(), wait) {
        let middle = (at / span.step_s) as usize;
        if !dice.chance(busyness(span.hour(middle))) {
            continue;
        }
        let (size, half_s) = (floor * dice.decades(0.3, 6.0), dice.uniform(5.0, 25.0));
        let reach = (4.0 * half_s / span.step_s) as usize;
        let first = middle.saturating_sub(reach);
        let near = &mut level[first..(middle + reach).min(span.length)];
        for (i, l) in (first..).zip(near) {
            let far = (i as f64 - middle as f64) * span.step_s / half_s;
            *l += size / (1.0 + far * far);
        }
    }
    level
}
