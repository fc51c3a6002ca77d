//! A gyro in a thermal chamber, from physics alone: chamber, housing and coil as differential equations, the play as a
//! body that is pushed, noise as sums of processes. Uses nothing of the program under test.
#![allow(dead_code)]

/// Numbers at random: splitmix for the seed, xorshift for the stream.
pub struct Chance(u64);

impl Chance {
    pub fn new(seed: u64) -> Chance {
        let mut z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        Chance((z ^ (z >> 31)) | 1)
    }

    pub fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn normal(&mut self) -> f64 {
        let (u, v) = (self.uniform().max(1e-300), self.uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }

    pub fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.uniform()
    }
}

/// Noise of a gyro: N in deg/sqrt(h), B in deg/h, K in deg/h/sqrt(h).
#[derive(Clone, Copy, Debug)]
pub struct Noise {
    pub n: f64,
    pub b: f64,
    pub k: f64,
}

/// Samples of rate noise that are means over `dt` s, deg/h.
pub fn noise(model: Noise, dt: f64, count: usize, chance: &mut Chance) -> Vec<f64> {
    // Flicker B²/(2πf) as relaxations an octave apart, from a part of dt to 300 times the record.
    let ratio: f64 = 2.0;
    let mut times = vec![];
    let mut t = 0.3 * dt;
    while t < 300.0 * dt * count as f64 {
        times.push(t);
        t *= ratio;
    }
    // ∫ 2T s²/(1 + (2πfT)²) d ln T / ln(ratio) = s²·(1/(2f))/ln(ratio), which must be B²/(2πf).
    let s = (model.b * model.b * ratio.ln() / std::f64::consts::PI).sqrt();
    let mut states: Vec<f64> = times.iter().map(|_| s * chance.normal()).collect();
    let decays: Vec<(f64, f64)> =
        times.iter().map(|t| ((-dt / t).exp(), (1.0 - (-2.0 * dt / t).exp()).sqrt())).collect();
    let white = 60.0 * model.n / dt.sqrt();
    let step = model.k * (dt / 3600.0).sqrt();
    let mut walk = 0.0;
    (0..count)
        .map(|_| {
            walk += step * chance.normal();
            let mut sum = walk + white * chance.normal();
            if model.b > 0.0 {
                for (x, (a, c)) in states.iter_mut().zip(&decays) {
                    *x = *a * *x + s * *c * chance.normal();
                    sum += *x;
                }
            }
            sum
        })
        .collect()
}

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
    pub noise: Noise,
    /// Bias at 20 degC and Earth rate together, deg/h.
    pub level: f64,
}

impl Unit {
    pub fn static_bias(&self, deg_c: f64) -> f64 {
        let x = deg_c - 20.0;
        self.a[0] * x + self.a[1] * x * x + self.a[2] * x * x * x
    }

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
    pub dt: f64,
    pub rate: Vec<f64>,
    /// Sensor, with its noise.
    pub temperature: Vec<f64>,
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
