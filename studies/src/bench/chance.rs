//! Numbers at random and noise of a gyro, made without the program under test.

/// Numbers at random: splitmix for the seed, xorshift for the stream.
pub struct Chance(u64);

impl Chance {
    /// A stream of its own for every seed.
    pub fn new(seed: u64) -> Chance {
        let mut z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        Chance((z ^ (z >> 31)) | 1)
    }

    /// From 0 to 1.
    pub fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Normal, of mean 0 and deviation 1.
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (self.uniform().max(1e-300), self.uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }

    /// Uniform from `a` to `b`.
    pub fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.uniform()
    }
}

/// Noise of a gyro.
#[derive(Clone, Copy, Debug)]
pub struct Noise {
    /// Angle random walk, deg/sqrt(h).
    pub n: f64,
    /// Bias instability, deg/h.
    pub b: f64,
    /// Rate random walk, deg/h/sqrt(h).
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
