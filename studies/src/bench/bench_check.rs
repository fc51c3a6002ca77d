//! A reference gyro on a table beside two thermometers, as a check of the bench records them. Imports nothing of the program under
//! test.

use super::noise_source::NoiseSource;
use super::rate_table::RateTable;

/// Angle of a count of the reference gyro, arcsec.
pub const COUNT_ARCSEC: f64 = 0.05;

/// A bench on a day.
#[derive(Debug, Clone)]
pub struct BenchCheck {
    /// The table and the gyro on it.
    pub table: RateTable,
    /// Reading of the thermometer of the bench minus that of the reference, K.
    pub difference: f64,
    /// Change of the difference over the recording, K.
    pub drift: f64,
    /// Noise of each thermometer: standard deviation of a reading, and of an error that lasts a minute, K.
    pub noise: (f64, f64),
    /// Last digit of the readings, K.
    pub digit: f64,
    /// Day of the recording, and hour at which it begins.
    pub date: (&'static str, u32),
    /// Seed of the thermometers.
    pub seed: u64,
}

/// A reference gyro with its certified bias of 0.02 deg/h, at rest and at six turns a minute both ways.
pub fn reference(seed: u64) -> RateTable {
    RateTable {
        error_ppm: 2.0,
        ppm_per_c: 0.0,
        cubic_ppm: 0.0,
        even_ppm: 0.0,
        bias: 0.02,
        b: 0.002,
        tilt: 2e-4,
        count_arcsec: COUNT_ARCSEC,
        rates: vec![0.0, 36.0, 0.0, -36.0],
        cycles: 3,
        dwell_s: 66.0,
        hz: 5.0,
        temperature: (22.0, 0.1, 0.05),
        seed,
        ..RateTable::default()
    }
}

impl Default for BenchCheck {
    fn default() -> BenchCheck {
        BenchCheck {
            table: reference(71),
            difference: 0.04,
            drift: 0.0,
            noise: (0.005, 0.002),
            digit: 0.01,
            date: ("2026-11-24", 6),
            seed: 72,
        }
    }
}

impl BenchCheck {
    /// The recording as the laboratory saves it: stamps with their date, counts, table and two thermometers.
    pub fn csv(&self) -> String {
        let recorded = self.table.record();
        let mut source = NoiseSource::new(self.seed);
        let (rows, dt) = (recorded.time_s.len(), 1.0 / self.table.hz);
        let slow = [source.markov(self.noise.1, 60.0, dt, rows), source.markov(self.noise.1, 60.0, dt, rows)];
        let mut text =
            String::from("time,counts,table_rate_deg_s,table_angle_deg,temp_degC,temp_reference_degC\n");
        for i in 0..rows {
            let along = i as f64 / rows as f64 - 0.5;
            let difference = self.difference + self.drift * along;
            let mut read = |true_value: f64, slow: f64| {
                let value = true_value + slow + self.noise.0 * source.normal();
                (value / self.digit).round() * self.digit
            };
            let own = read(recorded.true_temperature[i] + difference, slow[0][i]);
            let reference = read(recorded.true_temperature[i], slow[1][i]);
            let (seconds, milli) = ((i as f64 * dt) as u32, (1000.0 * i as f64 * dt).round() as u32 % 1000);
            text.push_str(&format!(
                "{}T{:02}:{:02}:{:02}.{milli:03}Z,{:.0},{},{:.5},{own:.2},{reference:.2}\n",
                self.date.0,
                self.date.1 + seconds / 3600,
                seconds / 60 % 60,
                seconds % 60,
                recorded.rate_deg_h[i] * dt / COUNT_ARCSEC,
                recorded.table_rate_deg_h[i] / 3600.0,
                recorded.table_angle_arcsec[i] / 3600.0,
            ));
        }
        text
    }
}
