//! Contributions that repeat with the angle of the table.

use super::sinusoid::{averaged, pair};
use crate::effect::{Domain, Drivers, Place};
use crate::numeric::range::{Bounds, ends};

/// Turn of the table within a sample, in turns: from the rate where it is there, else from the neighbouring angles.
fn turn(i: usize, angle: &[f64], drivers: &Drivers) -> f64 {
    if let Some(rate) = drivers.table_rate.as_ref().and_then(|r| r.get(i)) {
        return rate * drivers.dt_s / 360.0;
    }
    let (a, b) = (i.saturating_sub(1), (i + 1).min(angle.len() - 1));
    let apart = (angle[b] - angle[a] + 180.0).rem_euclid(360.0) - 180.0;
    if b > a { apart / (b - a) as f64 / 360.0 } else { 0.0 }
}

/// Cosine and sine of an order of the table angle, averaged over each sample.
pub(in crate::effect) fn columns(order: f64, drivers: &Drivers) -> Vec<Vec<f64>> {
    let Some(angle) = &drivers.table_angle else { return vec![] };
    pair(angle.len(), |i| (order * angle[i] / 360.0, averaged(order * turn(i, angle, drivers))))
}

/// The angles that the table went through.
pub(in crate::effect) fn visited(drivers: &Drivers) -> Vec<Place> {
    let Some(angle) = &drivers.table_angle else { return vec![] };
    let Bounds { low, high } = ends(angle);
    if low > high {
        return vec![];
    }
    let whole = high - low > 300.0;
    let (from, to) = if whole { (0.0, 360.0) } else { (low, high) };
    vec![Place { domain: Domain::Angle, from, to }]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turning_table_is_averaged_over_each_sample() {
        // A quarter turn a sample: its mean over the sample is 2√2/π of the wave.
        let angle = vec![10.0, 100.0, 190.0, 280.0];
        let drivers =
            Drivers { dt_s: 2.0, samples: 4, table_angle: Some(angle.clone()), ..Drivers::default() };
        let turning = Drivers { table_rate: Some(vec![45.0; 4]), ..drivers.clone() };
        let left = 8f64.sqrt() / std::f64::consts::PI;
        for columns in [columns(1.0, &drivers), columns(1.0, &turning)] {
            for (i, a) in angle.iter().enumerate().take(3).skip(1) {
                assert!((columns[0][i] - left * a.to_radians().cos()).abs() < 1e-12, "{columns:?}");
                assert!((columns[1][i] - left * a.to_radians().sin()).abs() < 1e-12, "{columns:?}");
            }
        }
        assert!(columns(1.0, &Drivers::default()).is_empty());
    }

    #[test]
    fn angles_over_nearly_a_turn_are_the_whole_turn() {
        let over = |angles: &[f64]| {
            let drivers = Drivers { table_angle: Some(angles.to_vec()), ..Drivers::default() };
            visited(&drivers).first().map(|p| (p.from, p.to))
        };
        assert_eq!(over(&[5.0, 200.0, 310.0]), Some((0.0, 360.0)));
        assert_eq!(over(&[5.0, 200.0, 300.0]), Some((5.0, 300.0)));
        assert_eq!(over(&[]), None);
    }
}
