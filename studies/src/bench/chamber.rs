//! A gyro in a thermal chamber, from physics alone: chamber, housing and coil as differential equations, the play as a
//! body that is pushed, noise as sums of processes. Uses nothing of the program under test.

use super::chance::{Chance, Noise, noise};

/// A leg of the chamber's programme.
#[derive(Clone, Copy, Debug)]
pub enum Leg {
    /// To a temperature, degC, at a rate, degC/h.
    Ramp(f64, f64),
    /// Hold, s.
    Hold(f64),
}

/// What the gyro does with temperature.
#[derive(Clone, Copy, Debug)]
pub struct Unit {
    /// Coefficients of (T − 20)^1, ^2, ^3, deg/h per degC, degC², degC³.
    pub a: [f64; 3],
    /// deg/h per degC/min of the coil.
    pub shupe: f64,
    /// Coil behind the sensor, s.
    pub lag_s: f64,
    /// Half of the gap, deg/h, and half width of the play, degC.
    pub hysteresis: (f64, f64),
    /// Noise of the rate.
    pub noise: Noise,
    /// Bias at 20 degC and Earth rate together, deg/h.
    pub level: f64,
}

impl Unit {
    /// Bias less that at 20 degC where the temperature rests, deg/h.
    pub fn static_bias(&self, deg_c: f64) -> f64 {
        let x = deg_c - 20.0;
        self.a[0] * x + self.a[1] * x * x + self.a[2] * x * x * x
    }

    /// Slope of the static bias, deg/h per degC.
    pub fn slope(&self, deg_c: f64) -> f64 {
        let x = deg_c - 20.0;
        self.a[0] + 2.0 * self.a[1] * x + 3.0 * self.a[2] * x * x
    }

    /// Peak to peak, rms about the mean, slope of the line of least squares, steepest slope; over a range, even weights.
    pub fn statistics(&self, low: f64, high: f64) -> (f64, f64, f64, f64) {
        let n = 4000;
        let t = |i: usize| low + (high - low) * (i as f64 + 0.5) / n as f64;
        let (mut lo, mut hi, mut steepest) = (f64::MAX, f64::MIN, 0.0f64);
        let (mut s1, mut s2, mut sxy, mut sxx) = (0.0, 0.0, 0.0, 0.0);
        for i in 0..n {
            let b = self.static_bias(t(i));
            lo = lo.min(b);
            hi = hi.max(b);
            let d = self.slope(t(i));
            if d.abs() > steepest.abs() {
                steepest = d;
            }
            let x = t(i) - 0.5 * (low + high);
            s1 += b;
            s2 += b * b;
            sxy += x * b;
            sxx += x * x;
        }
        let mean = s1 / n as f64;
        (hi - lo, (s2 / n as f64 - mean * mean).max(0.0).sqrt(), sxy / sxx, steepest)
    }
}

/// A recording.
pub struct Recorded {
    /// Sampling interval, s.
    pub dt: f64,
    /// deg/h
    pub rate: Vec<f64>,
    /// Sensor, with its noise, degC.
    pub temperature: Vec<f64>,
    /// Air of the chamber, degC.
    pub chamber: Vec<f64>,
}

/// Runs a programme. The housing with the sensor follows the chamber in 4 min; the coil follows the housing.
pub fn record(unit: &Unit, start: f64, legs: &[Leg], dt: f64, sensor_noise: f64, seed: u64) -> Recorded {
    let mut chance = Chance::new(seed);
    let mut chamber = start;
    let (mut housing, mut coil, mut centre, mut state) = (start, start, start, 0.0);
    let h = (dt / 10.0).min(2.0);
    let steps = (dt / h).round() as usize;
    let h = dt / steps as f64;
    let (mut rate, mut temperature, mut programme) = (vec![], vec![], vec![]);
    let (mut sum_b, mut sum_t, mut inner) = (0.0, 0.0, 0);
    let mut advance = |target: Option<(f64, f64)>, chamber: &mut f64| {
        if let Some((to, per_h)) = target {
            let most = per_h / 3600.0 * h;
            *chamber += (to - *chamber).clamp(-most, most);
        }
        housing += h * (*chamber - housing) / 240.0;
        let rate_c =
            if unit.lag_s > 0.0 { (housing - coil) / unit.lag_s } else { (*chamber - housing) / 240.0 };
        if unit.lag_s > 0.0 {
            coil += h * rate_c;
        } else {
            coil = housing;
        }
        let (half_gap, play) = unit.hysteresis;
        if play > 0.0 {
            if coil - centre > play {
                centre = coil - play;
            } else if coil - centre < -play {
                centre = coil + play;
            }
            state = (coil - centre) / play;
        }
        sum_b += unit.static_bias(coil) + unit.shupe * rate_c * 60.0 + half_gap * state;
        sum_t += housing;
        inner += 1;
        if inner == steps {
            rate.push(unit.level + sum_b / steps as f64);
            temperature.push(sum_t / steps as f64 + sensor_noise * chance.normal());
            programme.push(*chamber);
            (sum_b, sum_t, inner) = (0.0, 0.0, 0);
        }
    };
    for leg in legs {
        match leg {
            Leg::Ramp(to, per_h) => {
                while (chamber - to).abs() > 1e-9 {
                    advance(Some((*to, *per_h)), &mut chamber);
                }
            }
            Leg::Hold(s) => {
                for _ in 0..(s / h).round() as usize {
                    advance(None, &mut chamber);
                }
            }
        }
    }
    let added = noise(unit.noise, dt, rate.len(), &mut chance);
    rate.iter_mut().zip(added).for_each(|(r, n)| *r += n);
    Recorded { dt, rate, temperature, chamber: programme }
}

/// A decay after switching on, in noise: (amplitude in deg/h, time constant in s) each.
pub fn warm_up(
    decays: &[(f64, f64)],
    level: f64,
    model: Noise,
    dt: f64,
    count: usize,
    seed: u64,
) -> Vec<f64> {
    let mut chance = Chance::new(seed);
    let mut y = noise(model, dt, count, &mut chance);
    for (i, v) in y.iter_mut().enumerate() {
        let t = (i as f64 + 0.5) * dt;
        *v += level + decays.iter().map(|(a, c)| a * (-t / c).exp()).sum::<f64>();
    }
    y
}

/// One cycle between −40 and +60 at a rate, with dwells.
pub fn cycle(per_h: f64, dwell_s: f64) -> Vec<Leg> {
    vec![Leg::Ramp(60.0, per_h), Leg::Hold(dwell_s), Leg::Ramp(-40.0, per_h), Leg::Hold(dwell_s)]
}

/// Soak, then cycles at rates.
pub fn programme(rates: &[f64], dwell_s: f64) -> Vec<Leg> {
    let mut legs = vec![Leg::Hold(dwell_s.max(60.0))];
    for r in rates {
        legs.extend(cycle(*r, dwell_s));
    }
    legs
}
