//! A gyro at rest that is switched off and on, or put under an influence. Uses nothing of the program under test.

use super::chance::{Chance, Noise, noise};

/// What was recorded: time, rate, temperature, level.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    /// s
    pub time_s: Vec<f64>,
    /// deg/h
    pub rate: Vec<f64>,
    /// degC
    pub temperature: Vec<f64>,
    /// Of the influence, in its unit.
    pub level: Vec<f64>,
}

/// A series of runs.
#[derive(Clone, Debug)]
pub struct Series {
    /// Runs of the unit.
    pub runs: usize,
    /// Length of a run, s.
    pub run_s: f64,
    /// Time off between runs, s.
    pub pause_s: f64,
    /// Standard deviation of the bias between runs, deg/h.
    pub between: f64,
    /// Change from the first run to the last, deg/h.
    pub trend: f64,
    /// Change with the temperature of the run, deg/h/degC, and standard deviation of that, degC.
    pub per_deg_c: (f64, f64),
    /// Bias and Earth rate together, deg/h.
    pub level: f64,
    /// Noise of the rate.
    pub noise: Noise,
    /// Sampling interval, s.
    pub dt: f64,
}

impl Series {
    /// The noise goes on while the unit is off.
    pub fn record(&self, seed: u64) -> Recorded {
        let mut chance = Chance::new(seed);
        let biases: Vec<f64> = (0..self.runs).map(|_| self.between * chance.normal()).collect();
        let warm: Vec<f64> = (0..self.runs).map(|_| self.per_deg_c.1 * chance.normal()).collect();
        let cycle = ((self.run_s + self.pause_s) / self.dt).round() as usize;
        let on = (self.run_s / self.dt).round() as usize;
        let y = noise(self.noise, self.dt, cycle * self.runs, &mut chance);
        let mut out = Recorded::default();
        for run in 0..self.runs {
            let share = run as f64 / (self.runs - 1).max(1) as f64;
            let bias = self.level + biases[run] + self.trend * share + self.per_deg_c.0 * warm[run];
            for (i, noise) in y.iter().enumerate().skip(run * cycle).take(on) {
                out.time_s.push(i as f64 * self.dt);
                out.rate.push(bias + noise);
                out.temperature.push(20.0 + warm[run] + 0.003 * chance.normal());
            }
        }
        out
    }
}

/// Intervals in turns at levels.
#[derive(Clone, Debug)]
pub struct Turns {
    /// Level of each interval, in its unit; the first is the reference.
    pub levels: Vec<f64>,
    /// Length of an interval, s.
    pub interval_s: f64,
    /// Bias at a level, deg/h.
    pub bias: fn(f64, f64) -> f64,
    /// Argument of it.
    pub per_unit: f64,
    /// Drift over the test, deg/h.
    pub drift: f64,
    /// Factor on N at the level.
    pub noisier: fn(f64) -> f64,
    /// degC with the influence, reached at once.
    pub warms: f64,
    /// Bias and Earth rate together, deg/h.
    pub level: f64,
    /// Noise of the rate.
    pub noise: Noise,
    /// Sampling interval, s.
    pub dt: f64,
}

impl Turns {
    /// The recording of a seed.
    pub fn record(&self, seed: u64) -> Recorded {
        let mut chance = Chance::new(seed);
        let each = (self.interval_s / self.dt).round() as usize;
        let count = each * self.levels.len();
        let slow = noise(Noise { n: 0.0, ..self.noise }, self.dt, count, &mut chance);
        let white = 60.0 * self.noise.n / self.dt.sqrt();
        let reference = self.levels[0];
        let mut out = Recorded::default();
        for (i, slow) in slow.iter().enumerate() {
            let level = self.levels[i / each];
            let on = f64::from((level - reference).abs() > 1e-9);
            out.time_s.push(i as f64 * self.dt);
            out.rate.push(
                self.level
                    + self.drift * i as f64 / count as f64
                    + (self.bias)(self.per_unit, level - reference)
                    + slow
                    + white * (self.noisier)(level - reference) * chance.normal(),
            );
            out.temperature.push(20.0 + self.warms * on + 0.003 * chance.normal());
            out.level.push(level);
        }
        out
    }
}

/// A bias proportional to the level.
pub fn linear(k: f64, level: f64) -> f64 {
    k * level
}

/// A bias proportional to the square of the level.
pub fn squared(k: f64, level: f64) -> f64 {
    k * level * level
}

/// A bias that follows the level by a parabola.
pub fn parabola(k: f64, level: f64) -> f64 {
    k * level * (1.0 + 0.005 * level)
}

/// A bias that changes when the influence is there.
pub fn present(k: f64, level: f64) -> f64 {
    if level.abs() > 1e-9 { k } else { 0.0 }
}

/// Rates of a table in turns within intervals, and what the influence does to the scale factor.
#[derive(Clone, Debug)]
pub struct Turned {
    /// Intervals at levels, with what the influence does to the bias.
    pub turns: Turns,
    /// Rates, deg/s, one after the other from the beginning of every interval.
    pub rates: Vec<f64>,
    /// Error of the scale factor, ppm.
    pub error: f64,
    /// Change of the scale factor per unit of the level, ppm.
    pub per_unit: f64,
}

impl Turned {
    /// The recording of a seed, and the rate of the table beside it, deg/s.
    pub fn record(&self, seed: u64) -> (Recorded, Vec<f64>) {
        let mut recorded = self.turns.record(seed);
        let stretch = self.turns.interval_s / self.rates.len() as f64;
        let at = |t: f64| self.rates[((t % self.turns.interval_s) / stretch) as usize % self.rates.len()];
        let table: Vec<f64> = recorded.time_s.iter().map(|t| at(*t)).collect();
        let reference = self.turns.levels[0];
        for (i, rate) in table.iter().enumerate() {
            let ppm = self.error + self.per_unit * (recorded.level[i] - reference);
            recorded.rate[i] += 3600.0 * rate * (1.0 + 1e-6 * ppm);
        }
        (recorded, table)
    }
}

/// Noise of the samples.
pub const NOISE: Noise = Noise { n: 0.002, b: 0.001, k: 0.0003 };
/// Levels of a magnetic field, mT.
pub const FIELD: [f64; 9] = [0.0, 0.5, 0.0, -0.5, 0.0, 0.5, 0.0, -0.5, 0.0];
/// Levels of a supply, V.
pub const SUPPLY: [f64; 9] = [5.0, 4.75, 5.0, 5.25, 5.0, 4.75, 5.0, 5.25, 5.0];
/// Levels of a shaker, g.
pub const SHAKER: [f64; 9] = [0.0, 2.0, 0.0, 4.0, 0.0, 2.0, 0.0, 4.0, 0.0];

/// Levels of a pressure, kPa.
pub const PRESSURE: [f64; 9] = [101.3, 80.0, 101.3, 150.0, 101.3, 80.0, 101.3, 150.0, 101.3];
/// Levels of a field that is switched on.
pub const SWITCHED: [f64; 9] = [0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0];

/// Earth rate and bias together, deg/h.
const LEVEL: f64 = 12.467 + 0.12;

/// Eight runs whose bias scatters by so much, deg/h.
pub fn series(between: f64) -> Series {
    Series {
        runs: 8,
        run_s: 360.0,
        pause_s: 1200.0,
        between,
        trend: 0.0,
        per_deg_c: (0.0, 0.3),
        level: LEVEL,
        noise: NOISE,
        dt: 1.0,
    }
}

/// Intervals at levels in turn, with a bias of so many deg/h per unit of the level.
pub fn turns(levels: &[f64], per_unit: f64) -> Turns {
    Turns {
        levels: levels.to_vec(),
        interval_s: 120.0,
        bias: linear,
        per_unit,
        drift: 0.05,
        noisier: |_| 1.0,
        warms: 0.0,
        level: LEVEL,
        noise: NOISE,
        dt: 1.0,
    }
}

/// Intervals on a shaker: a bias that follows the square of the level, and noise that follows it by `noisier`.
pub fn shaken(per_unit: f64, noisier: fn(f64) -> f64) -> Turns {
    Turns { bias: squared, noisier, dt: 0.2, ..turns(&SHAKER, per_unit) }
}

/// Intervals at pressures, in which a table turns there and back.
pub fn turned(per_kpa: f64, ppm_per_kpa: f64) -> Turned {
    let rates = vec![10.0, -10.0, 20.0, -20.0];
    Turned { turns: turns(&PRESSURE, per_kpa), rates, error: 120.0, per_unit: ppm_per_kpa }
}
