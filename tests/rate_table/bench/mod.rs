//! A rate table and a gyro on it as geometry and mechanics. Imports nothing of the program under test.
#![allow(dead_code)]

mod drift;
mod small;

use drift::Drift;
pub use small::SmallRates;

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Rotation of the Earth, deg/h (7.292115e-5 rad/s).
pub const EARTH: f64 = 15.041_067;

const ARCSEC_PER_TURN: f64 = 1_296_000.0;

/// A gyro on a table about the vertical.
#[derive(Debug, Clone)]
pub struct Bench {
    /// Deviation of the scale factor from nominal, ppm, at `reference_c`.
    pub error_ppm: f64,
    /// Change with temperature, ppm/degC.
    pub ppm_per_c: f64,
    /// Reference temperature, degC.
    pub reference_c: f64,
    /// Cubic and quadratic error at full scale, ppm of full scale.
    pub cubic_ppm: f64,
    pub even_ppm: f64,
    /// Gap between a rate reached from below and from above, ppm of full scale.
    pub hysteresis_ppm: f64,
    /// Standard deviation of the scale factor between cycles, ppm.
    pub cycle_ppm: f64,
    /// Bias, deg/h, and its change with temperature, deg/h/degC.
    pub bias: f64,
    pub bias_per_c: f64,
    /// N, deg/sqrt(h); 1/f noise of the one-sided density b²/(2πf), deg/h; K, deg/h/sqrt(h).
    pub n: f64,
    pub b: f64,
    pub k: f64,
    /// Angle of one count of the output, arcsec; 0 for none.
    pub count_arcsec: f64,
    /// Error of a reading of the table angle, arcsec.
    pub reading_arcsec: f64,
    /// Tilt of the input axis to the axis of the table, rad, and its direction, rad.
    pub tilt: f64,
    pub direction: f64,
    /// Latitude, deg.
    pub latitude: f64,
    /// Rates of one cycle, deg/s; full scale is the largest.
    pub rates: Vec<f64>,
    pub cycles: usize,
    /// Time at a rate, s.
    pub dwell_s: f64,
    /// Acceleration of the table, deg/s².
    pub acceleration: f64,
    /// Sample rate, Hz.
    pub hz: f64,
    /// Temperature: mean, drift over the test and amplitude of a swing, degC.
    pub temperature: (f64, f64, f64),
    pub seed: u64,
}

impl Default for Bench {
    fn default() -> Bench {
        let up = [0.0, 1.0, 5.0, 10.0, 50.0, 100.0];
        let mut rates: Vec<f64> = up.to_vec();
        rates.extend(up.iter().rev().skip(1));
        rates.extend(up.iter().skip(1).map(|r| -r));
        rates.extend(up.iter().rev().skip(1).take(4).map(|r| -r));
        Bench {
            error_ppm: 40.0,
            ppm_per_c: 12.0,
            reference_c: 25.0,
            cubic_ppm: 8.0,
            even_ppm: 3.0,
            hysteresis_ppm: 0.0,
            cycle_ppm: 0.0,
            bias: 0.35,
            bias_per_c: 0.0,
            n: 0.004,
            b: 0.005,
            k: 0.0,
            count_arcsec: 0.0,
            reading_arcsec: 0.5,
            tilt: 1e-3,
            direction: 0.7,
            latitude: 55.98,
            rates,
            cycles: 3,
            dwell_s: 40.0,
            acceleration: 50.0,
            hz: 10.0,
            temperature: (25.0, 1.5, 1.0),
            seed: 1,
        }
    }
}

/// What was recorded.
#[derive(Debug, Clone, Default)]
pub struct Recorded {
    pub time_s: Vec<f64>,
    pub rate_deg_h: Vec<f64>,
    /// Rate asked of the table, deg/h.
    pub table_rate_deg_h: Vec<f64>,
    /// Reading of the table angle, arcsec, 0 to a turn.
    pub table_angle_arcsec: Vec<f64>,
    pub temperature: Vec<f64>,
    /// Temperature of every sample without its rounding.
    pub true_temperature: Vec<f64>,
    /// Mean of the drift over the test, deg/h: what the bias of the test has of it.
    pub drift: f64,
    /// Scale factor deviation of each cycle, ppm.
    pub cycles_ppm: Vec<f64>,
}

fn normal(rng: &mut Xoshiro256PlusPlus) -> f64 {
    StandardNormal.sample(rng)
}

impl Bench {
    pub fn full_scale(&self) -> f64 {
        self.rates.iter().fold(0.0, |m: f64, r| m.max(r.abs())) * 3600.0
    }

    /// Static error of the response beyond a line, deg/h, at a rate in deg/h.
    pub fn curve(&self, rate: f64) -> f64 {
        let full = self.full_scale();
        let x = rate / full;
        1e-6 * full * (self.cubic_ppm * x.powi(3) + self.even_ppm * x * x)
    }

    /// The recording.
    pub fn record(&self) -> Recorded {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(self.seed);
        let dt = 1.0 / self.hz;
        // Sub-steps of the mechanics within a sample.
        let fine = 10;
        let h = dt / f64::from(fine);
        let plan: Vec<(usize, f64)> =
            (0..self.cycles).flat_map(|c| self.rates.iter().map(move |r| (c, *r))).collect();
        // A last rest closes the test.
        let closing = (self.cycles.saturating_sub(1), 0.0);
        let sequence: Vec<(usize, f64)> = plan.into_iter().chain([closing]).collect();
        let total = sequence.len() as f64 * self.dwell_s;
        let cycles_ppm: Vec<f64> = (0..self.cycles).map(|_| self.cycle_ppm * normal(&mut rng)).collect();
        let mut out = Recorded { cycles_ppm: cycles_ppm.clone(), ..Recorded::default() };
        let (mut rate, mut angle, mut t) = (0.0f64, 37.0 * 3600.0, 0.0f64);
        let mut last = 0.0;
        let mut side = 0.0;
        let mut drift = Drift::new(self.b, self.k, &mut rng);
        let (sin, cos) = (self.latitude.to_radians().sin(), self.latitude.to_radians().cos());
        let axial = (1.0 - self.tilt * self.tilt).sqrt();
        let mut carry = 0.0;
        let swing = 2.0 * std::f64::consts::PI * 2.7 / total;
        for (i, (cycle, wanted)) in sequence.iter().enumerate() {
            if *wanted != last {
                side = if *wanted > last { 0.5 } else { -0.5 };
                last = *wanted;
            }
            let ends = (i + 1) as f64 * self.dwell_s;
            while t < ends - 0.5 * dt {
                let temperature = self.temperature.0
                    + self.temperature.1 * (t / total - 0.5)
                    + self.temperature.2 * (swing * t).sin();
                out.time_s.push(t);
                out.table_rate_deg_h.push(wanted * 3600.0);
                let reading = angle + self.reading_arcsec * normal(&mut rng);
                out.table_angle_arcsec.push(reading.rem_euclid(ARCSEC_PER_TURN));
                let mut input = 0.0;
                let mut true_rate = 0.0;
                for _ in 0..fine {
                    let step = self.acceleration * 3600.0 * h;
                    let before = rate;
                    rate += (wanted * 3600.0 - rate).clamp(-step, step);
                    let mean = 0.5 * (before + rate);
                    let psi = (angle + 0.5 * mean * h) / ARCSEC_PER_TURN * 2.0 * std::f64::consts::PI;
                    // The Earth's rotation in the frame of the table: north and west turn with ψ.
                    let (ex, ey, ez) = (EARTH * cos * psi.cos(), -EARTH * cos * psi.sin(), EARTH * sin);
                    input += self.tilt * (self.direction.cos() * ex + self.direction.sin() * ey)
                        + axial * (mean + ez);
                    true_rate += mean;
                    angle += mean * h;
                }
                let (input, true_rate) = (input / f64::from(fine), true_rate / f64::from(fine));
                let gain = 1.0
                    + 1e-6
                        * (self.error_ppm
                            + self.ppm_per_c * (temperature - self.reference_c)
                            + cycles_ppm[*cycle]);
                let full = self.full_scale();
                let moved = drift.next(dt, &mut rng);
                out.drift += moved;
                let mut y = gain * input
                    + self.curve(true_rate)
                    + 1e-6 * self.hysteresis_ppm * full * side
                    + self.bias
                    + self.bias_per_c * (temperature - self.reference_c)
                    + moved
                    + self.n / (dt / 3600.0).sqrt() * normal(&mut rng);
                if self.count_arcsec > 0.0 {
                    let angle = y * dt + carry;
                    let counts = (angle / self.count_arcsec).round();
                    carry = angle - counts * self.count_arcsec;
                    y = counts * self.count_arcsec / dt;
                }
                out.rate_deg_h.push(y);
                out.true_temperature.push(temperature);
                out.temperature.push((temperature * 100.0).round() / 100.0);
                t += dt;
            }
        }
        out.drift /= out.time_s.len() as f64;
        out
    }
}

impl Recorded {
    /// As the laboratory would save it: counts an interval, table in deg/s and deg.
    pub fn csv(&self, count_arcsec: f64, dt: f64) -> String {
        let mut out = String::from("time_s,counts,table_rate_deg_s,table_angle_deg,temp_degC\n");
        for i in 0..self.time_s.len() {
            out.push_str(&format!(
                "{:.1},{:.0},{},{:.5},{:.2}\n",
                self.time_s[i],
                self.rate_deg_h[i] * dt / count_arcsec,
                self.table_rate_deg_h[i] / 3600.0,
                self.table_angle_arcsec[i] / 3600.0,
                self.temperature[i]
            ));
        }
        out
    }
}

/// A triad's axis on a table with a horizontal inner axis on a vertical outer one: the input axis lies nearly along the
/// inner axis, and the table turns about the outer one.
#[derive(Debug, Clone)]
pub struct TwoAxes {
    /// Tilts of the input axis about x and y of the plate, rad.
    pub tilt: (f64, f64),
    pub error_ppm: f64,
    pub bias: f64,
    /// N, deg/sqrt(h).
    pub n: f64,
    pub latitude: f64,
    /// Inner angles, deg, and outer rates, deg/s.
    pub inner: Vec<f64>,
    pub outer: Vec<f64>,
    pub dwell_s: f64,
    pub hz: f64,
    pub seed: u64,
}

impl Default for TwoAxes {
    fn default() -> TwoAxes {
        TwoAxes {
            tilt: (1.2e-3, -0.8e-3),
            error_ppm: 80.0,
            bias: 0.4,
            n: 0.004,
            latitude: 55.98,
            inner: vec![0.0, 90.0, 180.0, 270.0],
            outer: vec![0.0, 20.0, -20.0, 0.0],
            dwell_s: 42.0,
            hz: 10.0,
            seed: 1,
        }
    }
}

/// What was recorded on two axes.
#[derive(Debug, Clone, Default)]
pub struct TwoAxesRecorded {
    pub time_s: Vec<f64>,
    pub rate_deg_h: Vec<f64>,
    pub inner_rate_deg_h: Vec<f64>,
    pub inner_angle_arcsec: Vec<f64>,
    pub outer_rate_deg_h: Vec<f64>,
}

impl TwoAxes {
    pub fn record(&self) -> TwoAxesRecorded {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(self.seed);
        let dt = 1.0 / self.hz;
        let mut out = TwoAxesRecorded::default();
        // z turned by a small vector (θx, θy, 0).
        let raw = [self.tilt.1, -self.tilt.0, 1.0];
        let size = raw.iter().map(|v| v * v).sum::<f64>().sqrt();
        let a = raw.map(|v| v / size);
        let (sin, cos) = (self.latitude.to_radians().sin(), self.latitude.to_radians().cos());
        let (mut t, mut beta, mut azimuth, mut rate): (f64, f64, f64, f64) = (0.0, 0.0, 0.3, 0.0);
        let mut until = 0.0;
        for inner in &self.inner {
            for outer in &self.outer {
                until += self.dwell_s;
                while t < until - 0.5 * dt {
                    // The inner axis goes to its angle at 30 deg/s, the outer one to its rate at 20 deg/s².
                    let move_by =
                        (inner.to_radians() - beta).clamp(-30f64.to_radians() * dt, 30f64.to_radians() * dt);
                    let inner_rate = move_by / dt;
                    rate += (outer - rate).clamp(-20.0 * dt, 20.0 * dt);
                    let omega = rate.to_radians();
                    let mid = azimuth + 0.5 * omega * dt;
                    let b = beta + 0.5 * move_by;
                    // Frame of the plate in north, west, up: z along the inner axis, x up at β = 0.
                    let z = [mid.cos(), mid.sin(), 0.0];
                    let up = [0.0, 0.0, 1.0];
                    let side = [
                        z[1] * up[2] - z[2] * up[1],
                        z[2] * up[0] - z[0] * up[2],
                        z[0] * up[1] - z[1] * up[0],
                    ];
                    let x: Vec<f64> = (0..3).map(|i| up[i] * b.cos() + side[i] * b.sin()).collect();
                    let y: Vec<f64> = (0..3).map(|i| -up[i] * b.sin() + side[i] * b.cos()).collect();
                    let axis: Vec<f64> = (0..3).map(|i| a[0] * x[i] + a[1] * y[i] + a[2] * z[i]).collect();
                    let earth = [EARTH * cos, 0.0, EARTH * sin];
                    let to_deg_h = 3600.0 * 180.0 / std::f64::consts::PI;
                    let turning: Vec<f64> =
                        (0..3).map(|i| (omega * up[i] + inner_rate * z[i]) * to_deg_h + earth[i]).collect();
                    let input: f64 = (0..3).map(|i| axis[i] * turning[i]).sum();
                    out.time_s.push(t);
                    out.rate_deg_h.push(
                        (1.0 + 1e-6 * self.error_ppm) * input
                            + self.bias
                            + self.n / (dt / 3600.0).sqrt() * normal(&mut rng),
                    );
                    out.inner_rate_deg_h.push(inner_rate * to_deg_h);
                    out.inner_angle_arcsec.push(beta.to_degrees().rem_euclid(360.0) * 3600.0);
                    out.outer_rate_deg_h.push(rate * 3600.0);
                    azimuth += omega * dt;
                    beta += move_by;
                    t += dt;
                }
            }
        }
        out
    }
}
