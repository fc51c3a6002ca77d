//! Temperature, its rate of change and its delay.

use crate::effect::Drivers;

/// Temperature without the noise of its sensor where it is known, °C.
pub(in crate::effect) fn smooth(drivers: &Drivers) -> Option<&[f64]> {
    drivers.smooth_temperature.as_deref().or(drivers.temperature.as_deref())
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

/// The temperature behind a first-order delay that begins settled, °C. Between samples the temperature is taken for a
/// straight line.
pub(in crate::effect) fn delayed(t: &[f64], time_constant_s: f64, dt_s: f64) -> Vec<f64> {
    let Some(first) = t.first() else { return vec![] };
    let a = dt_s / time_constant_s;
    let (kept, lost) = ((-a).exp(), -(-a).exp_m1());
    let mut at = *first;
    let mut out = Vec::with_capacity(t.len());
    out.push(at);
    for pair in t.windows(2) {
        // Response to a line from one sample to the next: it trails behind by the time constant.
        let slope = pair[1] - pair[0];
        at = kept * at + lost * pair[0] + slope * (1.0 - lost / a);
        out.push(at);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delayed_ramp_trails_by_the_time_constant() {
        let ramp: Vec<f64> = (0..4000).map(|i| 0.01 * f64::from(i)).collect();
        let (dt, time) = (0.5, 40.0);
        let late = delayed(&ramp, time, dt);
        // T − τ·dT/dt·(1 − e^(−t/τ)).
        for i in [1usize, 10, 100, 3999] {
            let t = i as f64 * dt;
            let expected = ramp[i] - time * 0.02 * (1.0 - (-t / time).exp());
            assert!((late[i] - expected).abs() < 1e-9, "{i}");
        }
        assert!(delayed(&[], 1.0, 1.0).is_empty());
    }

    #[test]
    fn the_rate_of_a_ramp_is_its_slope_everywhere() {
        let t: Vec<f64> = (0..20).map(|i| 20.0 + 0.05 * f64::from(i)).collect();
        let drivers = Drivers { dt_s: 3.0, samples: 20, temperature: Some(t), ..Drivers::default() };
        for r in rate(&drivers).unwrap() {
            assert!((r - 1.0).abs() < 1e-9);
        }
    }
}
