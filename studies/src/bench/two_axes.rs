//! A gyro on a table of two axes as geometry. Imports nothing of the program under test.

use super::EARTH;
use super::drift::normal;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

/// A triad's axis on a table with a horizontal inner axis on a vertical outer one: the input axis lies nearly along the
/// inner axis, and the table turns about the outer one.
#[derive(Debug, Clone)]
pub struct TwoAxes {
    /// Tilts of the input axis about x and y of the plate, rad.
    pub tilt: (f64, f64),
    /// Deviation of the scale factor, ppm.
    pub error_ppm: f64,
    /// Bias, deg/h.
    pub bias: f64,
    /// N, deg/sqrt(h).
    pub n: f64,
    /// Latitude, deg.
    pub latitude: f64,
    /// Inner angles, deg.
    pub inner: Vec<f64>,
    /// Outer rates at each of them, deg/s.
    pub outer: Vec<f64>,
    /// Time at a rate, s.
    pub dwell_s: f64,
    /// Sample rate, Hz.
    pub hz: f64,
    /// Seed of the noise.
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
    /// s
    pub time_s: Vec<f64>,
    /// Output of the gyro, deg/h.
    pub rate_deg_h: Vec<f64>,
    /// Rate of the inner axis, deg/h.
    pub inner_rate_deg_h: Vec<f64>,
    /// Angle of the inner axis, arcsec, 0 to a turn.
    pub inner_angle_arcsec: Vec<f64>,
    /// Rate of the outer axis, deg/h.
    pub outer_rate_deg_h: Vec<f64>,
}

impl TwoAxes {
    /// The recording.
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
