//! Headings of a table: whether it turned at an instant, and whether a change of heading can be told from a step of the output.

use crate::effect::Drivers;
use crate::numeric::order::SortNumbers;

/// The table's angle where it takes on headings apart enough to distinguish the projection from a step.
pub fn turning(drivers: &Drivers) -> Option<&[f64]> {
    let angle = drivers.table_angle.as_deref()?;
    let n = angle.len().max(1) as f64;
    let mean = |f: fn(f64) -> f64| angle.iter().map(|a| f(a.to_radians())).sum::<f64>() / n;
    // 1 for a table at rest.
    let together = mean(f64::cos).hypot(mean(f64::sin));
    (together < 0.99).then_some(angle)
}

/// Change of the table's angle at an instant, and the usual one in as long a time elsewhere, deg.
fn turned(at_s: f64, drivers: &Drivers) -> Option<(f64, f64)> {
    let angle = drivers.table_angle.as_ref()?;
    let n = angle.len();
    let wide = (n / 100).max(2);
    let at = ((at_s / drivers.dt_s) as usize).min(n.saturating_sub(1));
    let (a, b) = (angle.get(at.saturating_sub(wide))?, angle.get((at + wide).min(n - 1))?);
    let apart = |a: f64, b: f64| ((b - a + 180.0).rem_euclid(360.0) - 180.0).abs();
    let mut usual: Vec<f64> =
        angle.windows(2 * wide + 1).step_by(wide).map(|w| apart(w[0], w[2 * wide])).collect();
    usual.sort_ascending();
    Some((apart(*a, *b), usual.get(usual.len() / 2).copied().unwrap_or(0.0)))
}

/// True where the table's angle changes at that instant and seldom else.
pub fn table_turned(at_s: f64, drivers: &Drivers) -> bool {
    turned(at_s, drivers).is_some_and(|(here, usual)| here > 0.01 && here > 5.0 * usual)
}

/// Logarithm of the odds of a change of heading against a step of the output, where nothing tells one from the other.
pub fn odds_of_same_step(at_s: f64, drivers: &Drivers) -> Option<f64> {
    let same = turning(drivers).is_none() && !table_turned(at_s, drivers);
    same.then_some(if drivers.claim.earth.is_some() { -0.1 } else { -2.0 })
}
