//! A gyro in positions in the field of gravity. Imports nothing of the program under test.

use super::EARTH;
use super::noise_source::NoiseSource;

/// Elevation of the input axis and angle about it, deg, of the schedule that tells every term: from an exchange of positions for
/// the largest determinant.
pub const FOURTEEN: [(f64, f64); 14] = [
    (90.0, 0.0),
    (45.0, 45.0),
    (45.0, 135.0),
    (45.0, 225.0),
    (45.0, 315.0),
    (0.0, 0.0),
    (0.0, 45.0),
    (0.0, 90.0),
    (0.0, 180.0),
    (0.0, 270.0),
    (-45.0, 45.0),
    (-45.0, 135.0),
    (-45.0, 225.0),
    (-45.0, 315.0),
];

/// A gyro whose input axis points east, or up and down.
#[derive(Debug, Clone)]
pub struct Gravity {
    /// Bias, deg/h.
    pub bias: f64,
    /// Along I, O and S, deg/h/g.
    pub linear: [f64; 3],
    /// II, OO, IO, IS, OS, deg/h/g².
    pub quadratic: [f64; 5],
    /// deg/√h
    pub n: f64,
    /// deg/h
    pub b: f64,
    /// Deviation of the scale factor, relative.
    pub scale_factor: f64,
    /// Deviation of each direction, rad.
    pub tilt: f64,
    /// Time in a position, s, at a sample a second.
    pub dwell_s: usize,
    /// Latitude, deg.
    pub latitude: f64,
}

impl Default for Gravity {
    fn default() -> Gravity {
        Gravity {
            bias: 0.2,
            linear: [0.05, -0.03, 0.02],
            quadratic: [0.0; 5],
            n: 0.002,
            b: 0.0,
            scale_factor: 0.0,
            tilt: 0.0,
            dwell_s: 300,
            latitude: 55.98,
        }
    }
}

impl Gravity {
    /// The output in positions one after another, deg/h, one a second; the first ten of each are of the turn to it.
    pub fn record(&self, positions: &[(f64, f64)], seed: u64) -> Vec<f64> {
        let mut source = NoiseSource::new(seed);
        let mut noise = source.white(self.n, 1.0, self.dwell_s * positions.len());
        if self.b > 0.0 {
            super::noise_source::add(
                &mut noise,
                &source.flicker(self.b, 1.0, self.dwell_s * positions.len()),
            );
        }
        let gain = 1.0 + self.scale_factor * source.normal();
        let mut out = vec![];
        for (at, (elevation, roll)) in positions.iter().enumerate() {
            let raised = elevation.to_radians() + self.tilt * source.normal();
            let turned = roll.to_radians() + self.tilt * source.normal();
            let heading = std::f64::consts::FRAC_PI_2 + self.tilt * source.normal();
            let [i, o, s] = [raised.sin(), -raised.cos() * turned.sin(), -raised.cos() * turned.cos()];
            let latitude = self.latitude.to_radians();
            let earth =
                EARTH * (latitude.cos() * raised.cos() * heading.cos() + latitude.sin() * raised.sin());
            let [di, d_o, ds] = self.linear;
            let [dii, doo, dio, dis, dos] = self.quadratic;
            let still = gain * earth
                + self.bias
                + di * i
                + d_o * o
                + ds * s
                + dii * i * i
                + doo * o * o
                + dio * i * o
                + dis * i * s
                + dos * o * s;
            for k in 0..self.dwell_s {
                // A turn of some degrees a second shows in the output.
                let turn = if k < 10 { 9000.0 * (k as f64 - 4.5).signum() } else { 0.0 };
                out.push(still + noise[at * self.dwell_s + k] + turn);
            }
        }
        out
    }
}
