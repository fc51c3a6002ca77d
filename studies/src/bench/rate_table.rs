//! A rate table and a gyro on it as geometry and mechanics. Imports nothing of the program under test.

use super::EARTH;
use super::drift::{Drift, normal};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

pub(super) const ARCSEC_PER_TURN: f64 = 1_296_000.0;

/// A gyro on a table about the vertical.
#[derive(Debug, Clone)]
pub struct RateTable {
    /// Deviation of the scale factor from nominal, ppm, at `reference_c`.
    pub error_ppm: f64,
    /// Change with temperature, ppm/degC.
    pub ppm_per_c: f64,
    /// Reference temperature, degC.
    pub reference_c: f64,
    /// Cubic error at full scale, ppm of full scale.
    pub cubic_ppm: f64,
    /// Quadratic error at full scale, ppm of full scale.
    pub even_ppm: f64,
    /// Gap between a rate reached from below and from above, ppm of full scale.
    pub hysteresis_ppm: f64,
    /// Standard deviation of the scale factor between cycles, ppm.
    pub cycle_ppm: f64,
    /// Bias, deg/h.
    pub bias: f64,
    /// Its change with temperature, deg/h/degC.
    pub bias_per_c: f64,
    /// N, deg/sqrt(h).
    pub n: f64,
    /// 1/f noise of the one-sided density b²/(2πf), deg/h.
    pub b: f64,
    /// K, deg/h/sqrt(h).
    pub k: f64,
    /// Angle of one count of the output, arcsec; 0 for none.
    pub count_arcsec: f64,
    /// Error of a reading of the table angle, arcsec.
    pub reading_arcsec: f64,
    /// Tilt of the input axis to the axis of the table, rad.
    pub tilt: f64,
    /// Direction of the tilt, rad.
    pub direction: f64,
    /// Latitude, deg.
    pub latitude: f64,
    /// Rates of one cycle, deg/s; full scale is the largest.
    pub rates: Vec<f64>,
    /// Cycles of these rates.
    pub cycles: usize,
    /// Time at a rate, s.
    pub dwell_s: f64,
    /// Acceleration of the table, deg/s².
    pub acceleration: f64,
    /// Sample rate, Hz.
    pub hz: f64,
    /// Temperature: mean, drift over the test and amplitude of a swing, degC.
    pub temperature: (f64, f64, f64),
    /// Lowest and highest output, deg/h.
    pub rails: Option<(f64, f64)>,
    /// Time that the output stays at its rail after an input beyond it, s.
    pub recovery_s: f64,
    /// Seed of the noise.
    pub seed: u64,
}

impl Default for RateTable {
    fn default() -> RateTable {
        let up = [0.0, 1.0, 5.0, 10.0, 50.0, 100.0];
        let mut rates: Vec<f64> = up.to_vec();
        rates.extend(up.iter().rev().skip(1));
        rates.extend(up.iter().skip(1).map(|r| -r));
        rates.extend(up.iter().rev().skip(1).take(4).map(|r| -r));
        RateTable {
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
            rails: None,
            recovery_s: 0.0,
            seed: 1,
        }
    }
}

/// What was recorded.
#[derive(Debug, Clone, Default)]
pub struct Recorded {
    /// s
    pub time_s: Vec<f64>,
    /// Output of the gyro, deg/h.
    pub rate_deg_h: Vec<f64>,
    /// Rate asked of the table, deg/h.
    pub table_rate_deg_h: Vec<f64>,
    /// Reading of the table angle, arcsec, 0 to a turn.
    pub table_angle_arcsec: Vec<f64>,
    /// Reading of the thermometer, degC.
    pub temperature: Vec<f64>,
    /// Temperature of every sample without its rounding.
    pub true_temperature: Vec<f64>,
    /// Mean of the drift over the test, deg/h: what the bias of the test has of it.
    pub drift: f64,
    /// Scale factor deviation of each cycle, ppm.
    pub cycles_ppm: Vec<f64>,
}

/// Where the output was held by the last overload.
struct Rail {
    /// deg/h
    output: f64,
    /// s
    until_s: f64,
}

impl RateTable {
    /// Largest rate, deg/h.
    pub fn full_scale(&self) -> f64 {
        self.rates.iter().fold(0.0, |m: f64, r| m.max(r.abs())) * 3600.0
    }

    /// Static error of the response beyond a line, deg/h, at a rate in deg/h.
    pub fn curve(&self, rate: f64) -> f64 {
        let full = self.full_scale();
        let x = rate / full;
        1e-6 * full * (self.cubic_ppm * x.powi(3) + self.even_ppm * x * x)
    }

    /// The output at a time, s: at its rail beyond it, and until it has recovered.
    fn within_rails(&self, output: f64, time_s: f64, rail: &mut Rail) -> f64 {
        let Some((low, high)) = self.rails else { return output };
        if !(low..=high).contains(&output) {
            *rail = Rail { output: output.clamp(low, high), until_s: time_s + self.recovery_s };
        }
        if time_s <= rail.until_s { rail.output } else { output }
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
        let mut rail = Rail { output: 0.0, until_s: f64::NEG_INFINITY };
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
                y = self.within_rails(y, t, &mut rail);
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
