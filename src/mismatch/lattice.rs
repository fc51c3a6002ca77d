//! Whether the values of a recording lie on a lattice, and its step as an angle increment.

use super::regular::Regular;

/// Values looked at.
const LOOKED: usize = 4096;

/// The step of the lattice that the values lie on, as the angle increment of a sample, arcsec. `None` where there is
/// none, or where it is no more than the last digit that the file writes.
pub fn increment_arcsec(regular: &Regular) -> Option<f64> {
    let values: Vec<f64> = regular
        .rate
        .iter()
        .zip(&regular.grid.present)
        .filter(|(_, p)| **p)
        .map(|(v, _)| *v)
        .take(LOOKED)
        .collect();
    let mut steps: Vec<f64> = values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > 0.0).collect();
    if steps.len() < 32 {
        return None;
    }
    steps.sort_by(f64::total_cmp);
    let largest = values.iter().fold(0.0, |a: f64, v| a.max(v.abs())).max(1e-30);
    // The smallest difference that is more than the rounding of the digits written.
    let rounding = largest * 1e-9;
    let tiny = steps.iter().copied().find(|d| *d > rounding)?;
    // Several of the smallest differences agree on one step, or there is no lattice.
    let near: Vec<f64> = steps.iter().copied().filter(|d| *d > rounding && *d < 1.5 * tiny).collect();
    if near.len() < 3 {
        return None;
    }
    let mut step = near.iter().sum::<f64>() / near.len() as f64;
    // Larger differences give more digits of the step, for as long as they are told apart from their neighbours.
    for _ in 0..3 {
        let (mut wide, mut count) = (0.0, 0.0);
        for d in &steps {
            let times = (d / step).round();
            if (1.0..2000.0).contains(&times) {
                wide += d * times;
                count += times * times;
            }
        }
        if count > 0.0 {
            step = wide / count;
        }
    }
    let on = steps.iter().filter(|d| {
        let times = **d / step;
        (times - times.round()).abs() < 0.05
    });
    let share = on.count() as f64 / steps.len() as f64;
    let distinct = steps.last().copied().unwrap_or(0.0) / step;
    // A step of a round decimal number is how the file was written, which a few dozens of levels do not tell; an angle
    // increment is seen in the spectrum as well, and that decides.
    (share > 0.99 && distinct < 2000.0).then_some(step * regular.grid.dt_s)
}
