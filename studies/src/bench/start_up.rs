//! A gyro that is switched on, as a sequence of events. Imports nothing of the program under test.

use super::noise_source::NoiseSource;

/// A unit, its supply and when it is switched on.
#[derive(Debug, Clone)]
pub struct SwitchedOn {
    /// Time of the recording at which the supply comes, s; below 0 where it was on before.
    pub on_s: f64,
    /// Time to the first sample, s.
    pub first_s: f64,
    /// Time to the valid-data bit, s.
    pub valid_s: f64,
    /// Inrush current, A, and its time constant, s.
    pub inrush: (f64, f64),
    /// Steady current, A.
    pub steady_a: f64,
    /// Noise of the current, A.
    pub noise_a: f64,
    /// Relative error of the instruments for voltage and current.
    pub errors: (f64, f64),
    /// Length, s.
    pub seconds: f64,
    /// Sample rate, Hz.
    pub hz: f64,
}

impl Default for SwitchedOn {
    fn default() -> SwitchedOn {
        SwitchedOn {
            on_s: 2.03,
            first_s: 0.40,
            valid_s: 4.2,
            inrush: (1.9, 0.05),
            steady_a: 0.7,
            noise_a: 0.02,
            errors: (0.0, 0.0),
            seconds: 120.0,
            hz: 50.0,
        }
    }
}

/// Supply voltage, V.
pub const SUPPLY_V: f64 = 5.0;

/// Switchings-on at temperatures one after the other in one recording, with the temperature of the unit as a further column.
pub fn over_temperature(starts: &[(f64, SwitchedOn)], seed: u64) -> String {
    let mut out = String::from("time_s,rate_deg_h,supply_V,current_A,status,temp_degC\n");
    let mut from_s = 0.0;
    for (number, (deg_c, start)) in starts.iter().enumerate() {
        for line in start.csv(seed + number as u64).lines().skip(1) {
            let (time, rest) = line.split_once(',').unwrap_or((line, ""));
            let t = from_s + time.parse::<f64>().unwrap_or(0.0);
            out.push_str(&format!("{t:.3},{rest},{deg_c}\n"));
        }
        from_s += start.seconds;
    }
    out
}

impl SwitchedOn {
    /// Time, rate in deg/h (empty before the first sample), voltage, current, status, as text.
    pub fn csv(&self, seed: u64) -> String {
        let mut source = NoiseSource::new(seed);
        let mut out = String::from("time_s,rate_deg_h,supply_V,current_A,status\n");
        for i in 0..(self.seconds * self.hz) as usize {
            let t = i as f64 / self.hz;
            let since = t - self.on_s;
            let is_on = since >= 0.0;
            let (peak, decay_s) = self.inrush;
            let current = if is_on {
                self.steady_a
                    + (peak - self.steady_a) * (-since / decay_s).exp()
                    + self.noise_a * source.normal()
            } else {
                0.0
            };
            let volts = if is_on { SUPPLY_V * (1.0 + self.errors.0) } else { 0.0 };
            let rate = if since >= self.first_s {
                format!("{:.4}", 12.5 + 3.0 * (-since / 2.0).exp() + 0.5 * source.normal())
            } else {
                String::new()
            };
            let status = if since >= self.valid_s { 1 } else { 0 };
            out.push_str(&format!(
                "{t:.3},{rate},{volts:.4},{:.5},{status}\n",
                current * (1.0 + self.errors.1)
            ));
        }
        out
    }
}
