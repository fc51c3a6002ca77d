//! Temperature and its rate of change.

use crate::effect::Drivers;

/// Temperature without the noise of its sensor where it is known, °C.
pub(in crate::effect) fn smooth(drivers: &Drivers) -> Option<&[f64]> {
    drivers.smooth_temperature.as_deref().or(drivers.temperature.as_deref())
}

/// Range of the temperature in the record, °C.
pub(in crate::effect) fn range(drivers: &Drivers) -> Option<f64> {
    let ends = |(low, high): (f64, f64), t: &f64| (low.min(*t), high.max(*t));
    let (low, high) = smooth(drivers)?.iter().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    (high >= low).then_some(high - low)
}

/// Rate of change of the temperature, °C/min; differences over two samples, over one at the ends.
pub(in crate::effect) fn rate(drivers: &Drivers) -> Option<Vec<f64>> {
    let t = smooth(drivers)?;
    let n = t.len();
    if n < 2 {
        return None;
    }
    let per_min = 60.0 / drivers.dt_s;
    let at = |i: usize| {
        let (a, b) = (i.saturating_sub(1), (i + 1).min(n - 1));
        (t[b] - t[a]) / (b - a) as f64 * per_min
    };
    Some((0..n).map(at).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_of_a_ramp_is_its_slope_everywhere() {
        let t: Vec<f64> = (0..20).map(|i| 20.0 + 0.05 * f64::from(i)).collect();
        let drivers = Drivers { dt_s: 3.0, samples: 20, temperature: Some(t), ..Drivers::default() };
        for r in rate(&drivers).unwrap() {
            assert!((r - 1.0).abs() < 1e-9);
        }
    }
}
