//! Influences and repeatability at their edges: nothing at all, below the noise, beside drifts, with a temperature that goes
//! with the levels or the order of the runs, and the shortest tests that `check` accepts.

use super::case::{Simulated, Truth};
use super::table;
use crate::bench::noise_source::{NoiseSource, add, csv};
use serde::Deserialize;

/// deg/sqrt(h)
const N: f64 = 0.002;
/// Band of the noise without and with vibration, Hz.
const BAND_HZ: (f64, f64) = (0.5, 2.0);

/// A test of an influence or of repeatability.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bench {
    /// Intervals in turns, without an influence and with it.
    Turns(Turns),
    /// Switching off and on.
    Runs(Runs),
}

impl table::Bench for Bench {
    fn simulated(&self, _: &[String], seed: u64) -> Simulated {
        match self {
            Bench::Turns(turns) => turns.simulated(seed),
            Bench::Runs(runs) => runs.simulated(seed),
        }
    }
}

/// What is changed on purpose.
#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Kind {
    Field,
    Supply,
    Shaker,
}

/// How a kind of influence is tested.
struct Named {
    sensitivity: &'static str,
    test: &'static str,
    role: &'static str,
    unit: &'static str,
    /// Level of the reference.
    reference: f64,
}

impl Kind {
    fn named(self) -> Named {
        let of =
            |sensitivity, test, role, unit, reference| Named { sensitivity, test, role, unit, reference };
        match self {
            Kind::Field => of("magnetic_sensitivity", "magnetic_test", "magnetic_field", "mT", 0.0),
            Kind::Supply => of("supply_sensitivity", "supply_test", "supply", "V", 5.0),
            Kind::Shaker => of("vibration_sensitivity", "vibration_test", "vibration", "g", 0.0),
        }
    }
}

/// A comparison with intervals in turns.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turns {
    kind: Kind,
    /// Levels without the reference, one an interval between two without.
    levels: Vec<f64>,
    #[serde(default = "interval_s")]
    interval_s: f64,
    /// Change of the bias per drive: the level, of a shaker its square.
    #[serde(default)]
    per_unit: f64,
    /// deg/h over the test.
    #[serde(default = "drift")]
    drift: f64,
    /// Flicker, deg/h.
    #[serde(default)]
    flicker: f64,
    /// Growth of N per unit of the level.
    #[serde(default)]
    louder: f64,
    /// degC per unit of the level, and deg/h/degC.
    #[serde(default)]
    warms: (f64, f64),
    /// Coefficient that the procedure allows for, deg/h/degC.
    allowed: Option<f64>,
}

fn interval_s() -> f64 {
    75.0
}

fn drift() -> f64 {
    0.05
}

impl Turns {
    fn drive(&self, level: f64) -> f64 {
        if self.kind == Kind::Shaker { level * level } else { level }
    }

    fn dt_s(&self) -> f64 {
        if self.kind == Kind::Shaker { 0.2 } else { 1.0 }
    }

    fn simulated(&self, seed: u64) -> Simulated {
        let mut source = NoiseSource::new(seed);
        let dt = self.dt_s();
        let each = (self.interval_s / dt).round() as usize;
        let count = each * (2 * self.levels.len() + 1);
        let level = |i: usize| {
            let interval = i / each;
            if interval % 2 == 1 { self.levels[interval / 2] } else { 0.0 }
        };
        let mut rate = source.white(N, dt, count);
        for (i, r) in rate.iter_mut().enumerate() {
            *r *= 1.0 + self.louder * level(i).abs();
        }
        if self.flicker > 0.0 {
            add(&mut rate, &source.flicker(self.flicker, dt, count));
        }
        let temperature: Vec<f64> =
            (0..count).map(|i| 20.0 + self.warms.0 * level(i) + 0.003 * source.normal()).collect();
        for (i, r) in rate.iter_mut().enumerate() {
            *r += 12.5
                + self.drift * i as f64 / count as f64
                + self.per_unit * self.drive(level(i))
                + self.warms.1 * self.warms.0 * level(i);
        }
        let time: Vec<f64> = (0..count).map(|i| i as f64 * dt).collect();
        let reference = self.kind.named().reference;
        let told: Vec<f64> = (0..count).map(|i| reference + level(i)).collect();
        let drives: Vec<f64> = (0..count).map(|i| self.drive(level(i))).collect();
        Simulated {
            csv: csv("time_s,rate_deg_h,temp_degC,level", &[&time, &rate, &temperature, &told]),
            procedure: self.procedure(),
            truths: self.truths(&drives),
        }
    }

    fn truths(&self, drives: &[f64]) -> Vec<Truth> {
        let Named { sensitivity, reference, .. } = self.kind.named();
        let mut truths = vec![Truth::new(sensitivity, self.per_unit)];
        if self.louder == 0.0 && self.flicker == 0.0 && self.allowed.is_none() {
            // White noise and a line, the mean and the drift free: what an oracle of the noise is left with.
            truths[0].oracle = Some(1.96 * 60.0 * N / self.dt_s().sqrt() / free(drives).sqrt());
        }
        let mut seen: Vec<f64> = vec![];
        for level in &self.levels {
            if seen.contains(level) {
                continue;
            }
            seen.push(*level);
            let channel = format!("rate@{}", reference + level);
            truths.push(Truth::new("bias_shift", self.per_unit * self.drive(*level)).on(&channel));
            if self.kind == Kind::Shaker {
                truths.push(Truth::new("angle_random_walk_shift", N * self.louder * level).on(&channel));
                let band = format!("{channel}:{}-{}Hz", BAND_HZ.0, BAND_HZ.1);
                truths.push(Truth::new("noise_density_ratio", 1.0 + self.louder * level).on(&band));
            }
        }
        truths
    }

    fn procedure(&self) -> String {
        let Named { sensitivity, test, role, unit, reference } = self.kind.named();
        let louder = match self.kind {
            Kind::Shaker => format!(
                "[[measurand]]\nid = \"angle_random_walk_shift\"\n[[measurand]]\nid = \"noise_density_ratio\"\n\
                 [[noise_test.band]]\nfrom = \"{} Hz\"\nto = \"{} Hz\"\n",
                BAND_HZ.0, BAND_HZ.1
            ),
            _ => String::new(),
        };
        let allowed =
            self.allowed.map_or(String::new(), |a| format!("temperature_coefficient = \"{a} deg/h/degC\"\n"));
        procedure(&format!(
            "[[channel]]\nid = \"level\"\ncolumn = \"level\"\nrole = \"{role}\"\nunit = \"{unit}\"\n\
             [{test}]\nreference = \"{reference} {unit}\"\nsettling = \"0 s\"\nminimum_interval = \"20 s\"\n\
             alternations = 1\n{allowed}[[measurand]]\nid = \"{sensitivity}\"\n[[measurand]]\nid = \"bias_shift\"\n{louder}"
        ))
    }
}

/// Sum of squares of a course that a constant and a line leave.
fn free(course: &[f64]) -> f64 {
    let n = course.len() as f64;
    let mean = course.iter().sum::<f64>() / n;
    let t = |i: usize| i as f64 - 0.5 * (n - 1.0);
    let (mut tt, mut tx, mut xx) = (0.0, 0.0, 0.0);
    for (i, x) in course.iter().enumerate() {
        tt += t(i) * t(i);
        tx += t(i) * (x - mean);
        xx += (x - mean).powi(2);
    }
    xx - tx * tx / tt
}

fn procedure(own: &str) -> String {
    format!(
        "format = \"procedure/1\"\n[procedure]\nid = \"edges-influence\"\ntitle = \"Edges\"\nrevision = \"A\"\n\
         [[channel]]\nid = \"time\"\ncolumn = \"time_s\"\nrole = \"time\"\nunit = \"s\"\n\
         [[channel]]\nid = \"rate\"\ncolumn = \"rate_deg_h\"\nrole = \"rate\"\nunit = \"deg/h\"\n\
         [[channel]]\nid = \"temp\"\ncolumn = \"temp_degC\"\nrole = \"temperature\"\nunit = \"degC\"\n{own}"
    )
}

/// A series of switching off and on.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Runs {
    runs: usize,
    run_s: f64,
    /// Standard deviation between runs, deg/h.
    between: f64,
    /// deg/h from the first to the last.
    trend: f64,
    /// deg/h/degC.
    per_deg_c: f64,
    /// degC: from the first run to the last, and at random.
    warms: (f64, f64),
}

impl Default for Runs {
    fn default() -> Runs {
        Runs { runs: 8, run_s: 150.0, between: 0.0, trend: 0.0, per_deg_c: 0.0, warms: (0.0, 0.3) }
    }
}

impl Runs {
    fn simulated(&self, seed: u64) -> Simulated {
        let mut source = NoiseSource::new(seed);
        let each = self.run_s as usize;
        let mut columns = [vec![], vec![], vec![]];
        let mut biases = vec![];
        for run in 0..self.runs {
            let share = run as f64 / (self.runs - 1) as f64;
            let warm = self.warms.0 * share + self.warms.1 * source.normal();
            let bias = self.between * source.normal() + self.trend * share + self.per_deg_c * warm;
            biases.push(bias);
            let white = source.white(N, 1.0, each);
            for (i, w) in white.iter().enumerate() {
                columns[0].push(run as f64 * 1800.0 + i as f64);
                columns[1].push(12.5 + bias + w);
                columns[2].push(20.0 + warm + 0.003 * source.normal());
            }
        }
        let range = biases.iter().fold(f64::NEG_INFINITY, |m: f64, b| m.max(*b))
            - biases.iter().fold(f64::INFINITY, |m: f64, b| m.min(*b));
        let ids = [
            "bias_repeatability",
            "bias_repeatability_peak_to_peak",
            "bias_repeatability_trend",
            "bias_repeatability_temperature",
        ];
        let truths = [self.between, range, self.trend, self.per_deg_c];
        let measured: String = ids.iter().map(|id| format!("[[measurand]]\nid = \"{id}\"\n")).collect();
        let [time, rate, temperature] = &columns;
        Simulated {
            csv: csv("time_s,rate_deg_h,temp_degC", &[time, rate, temperature]),
            procedure: procedure(&format!(
                "[repeatability_test]\nsettling = \"0 s\"\nminimum_run = \"30 s\"\noff = \"5 min\"\nruns = 2\n{measured}"
            )),
            truths: ids.into_iter().zip(truths).map(|(id, truth)| Truth::new(id, truth)).collect(),
        }
    }
}
