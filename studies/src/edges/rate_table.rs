//! Scale factor and what belongs to it, from rates of a table that are known exactly.
//!
//! The output of every step is a polynomial of its rate with its own terms beside; the truths are sums over the same rates,
//! with equal weights.

use super::case::{Simulated, Truth};
use super::on_table::{column, procedure};
use super::table;
use crate::bench::noise_source::{NoiseSource, csv};
use serde::Deserialize;

/// Full scale, deg/h.
const FULL: f64 = 360_000.0;
/// deg/√h
const N: f64 = 0.02;

/// Samples a second, and seconds at one rate.
const HZ: usize = 4;
const DWELL: usize = 26;
const SETTLING: usize = 2;

/// A test with known rates.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bench {
    /// Rates of a table, gone through in cycles.
    Rates(Rates),
    /// The same with a unit without a loop, whose response is the sine of so many seconds times the rate.
    Sine(f64),
    /// Turns of two axes by hand.
    Turns(Turns),
}

impl table::Bench for Bench {
    fn simulated(&self, _: &[String], seed: u64) -> Simulated {
        match self {
            Bench::Rates(rates) => Unit { of: rates, rates: rates.cycle(seed) }.simulated(seed),
            Bench::Sine(phase_s) => sine(*phase_s, seed),
            Bench::Turns(turns) => turns.simulated(seed),
        }
    }
}

/// A unit, and the rates that it is turned at.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rates {
    /// Rates of the way up, deg/s.
    up: Vec<f64>,
    /// All but the largest rate are off these by as much at random, deg/s.
    off: f64,
    /// Without the way down.
    one_way: bool,
    cycles: usize,
    error_ppm: f64,
    odd_ppm: f64,
    even_ppm: f64,
    asymmetry_ppm: f64,
    hysteresis_ppm: f64,
    per_degree_ppm: f64,
    /// Amplitudes, deg/h.
    harmonics: [f64; 2],
    /// Scatter of the scale factor between cycles.
    cycle_ppm: f64,
    /// deg/h over the test.
    drift: f64,
    /// Temperature follows the square of the rate, by so many degrees at full scale, late by a minute.
    heated: f64,
}

impl Default for Rates {
    fn default() -> Rates {
        Rates {
            up: vec![-100.0, -60.0, -30.0, -10.0, -2.0, 0.0, 2.0, 10.0, 30.0, 60.0, 100.0],
            off: 0.0,
            one_way: false,
            cycles: 3,
            error_ppm: 0.0,
            odd_ppm: 0.0,
            even_ppm: 0.0,
            asymmetry_ppm: 0.0,
            hysteresis_ppm: 0.0,
            per_degree_ppm: 0.0,
            harmonics: [0.0; 2],
            cycle_ppm: 0.0,
            drift: 0.0,
            heated: 0.0,
        }
    }
}

impl Rates {
    /// Rates of a cycle of a seed, deg/s.
    fn cycle(&self, seed: u64) -> Vec<f64> {
        let mut source = NoiseSource::new(seed ^ 0x9a9);
        let mut moved = |r: &f64| if r.abs() < 99.0 { r + source.uniform(-self.off, self.off) } else { *r };
        let up: Vec<f64> = self.up.iter().map(&mut moved).collect();
        let down = if self.one_way { 0 } else { up.len().saturating_sub(2) };
        up.iter().chain(up.iter().rev().skip(1).take(down)).copied().collect()
    }
}

/// A unit with the rates of its cycle, deg/s.
struct Unit<'a> {
    of: &'a Rates,
    rates: Vec<f64>,
}

impl Unit<'_> {
    /// Output at a rate in deg/h, all but what changes with time.
    fn response(&self, x: f64) -> f64 {
        let u = x / FULL;
        let bent = 1e-6 * FULL * (self.of.odd_ppm * u.powi(3) + self.of.even_ppm * u * u);
        x * (1.0 + 1e-6 * self.of.error_ppm) + bent + 0.5e-6 * self.of.asymmetry_ppm * x.abs()
    }

    /// Rates of all steps, deg/h.
    fn steps(&self) -> Vec<f64> {
        (0..self.of.cycles).flat_map(|_| self.rates.iter().map(|r| 3600.0 * r)).collect()
    }

    fn levels(&self) -> Vec<f64> {
        let mut levels: Vec<f64> = self.rates.iter().map(|r| 3600.0 * r).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        levels
    }

    /// Slope of the line of least squares through the levels, and what it leaves of each.
    fn line(&self) -> (f64, Vec<f64>) {
        let x = self.levels();
        let n = x.len() as f64;
        let y: Vec<f64> = x.iter().map(|x| self.response(*x)).collect();
        let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
        let sxx: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
        let slope = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum::<f64>() / sxx;
        let left = x.iter().zip(&y).map(|(x, y)| y - my - slope * (x - mx)).collect();
        (slope, left)
    }

    fn truths(&self) -> Vec<Truth> {
        let Rates { cycles, asymmetry_ppm, odd_ppm, even_ppm, cycle_ppm, harmonics, .. } = self.of;
        let (slope, left) = self.line();
        let ppm = 1e6 / slope;
        let largest = left.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
        let of_rate = self.levels().into_iter().zip(&left).filter(|(x, _)| x.abs() >= 0.0999 * FULL);
        let of_rate = of_rate.fold(0.0, |m: f64, (x, r)| m.max((r / x).abs()));
        let rms = (left.iter().map(|r| r * r).sum::<f64>() / left.len() as f64).sqrt();
        let square: f64 = self.rates.iter().map(|r| 3600.0 * r).map(|x| x * x).sum();
        let of_step = 60.0 * N / ((DWELL - SETTLING) as f64).sqrt();
        // One or two cycles leave few degrees of freedom: Student's interval is wide by what the noise is not known to,
        // and its width says nothing of what is lost.
        let told = (*cycles > 2).then(|| 1.96e6 * of_step / self.left_of_rates().sqrt());
        let of_cycle = 1e6 * of_step / square.sqrt();
        vec![
            Truth { oracle: told.map(|t| 1e-6 * t), ..Truth::new("scale_factor", slope) },
            Truth { oracle: told, ..Truth::new("scale_factor_error", 1e6 * (slope - 1.0)) },
            Truth::new("scale_factor_nonlinearity", largest * ppm / FULL),
            Truth::new("scale_factor_nonlinearity_of_rate", of_rate * ppm),
            Truth::new("scale_factor_residual", rms * ppm / FULL),
            Truth::new("scale_factor_asymmetry", asymmetry_ppm / slope),
            Truth::new("scale_factor_odd", odd_ppm / slope),
            Truth::new("scale_factor_even", even_ppm / slope),
            Truth::new("scale_factor_repeatability", of_cycle.hypot(*cycle_ppm)),
            Truth::new("scale_factor_hysteresis", self.of.hysteresis_ppm / slope),
            Truth::new("scale_factor_temperature_sensitivity", self.of.per_degree_ppm / slope),
            Truth::new("table_harmonic_1", harmonics[0]),
            Truth::new("table_harmonic_2", harmonics[1]),
        ]
    }

    /// Square sum of the rates of all steps without what a bias takes of them, and a drift along a line or a sensitivity to
    /// the temperature that follows the rates, where there is one: these are fitted too by one who knows the noise.
    fn left_of_rates(&self) -> f64 {
        let steps = self.steps();
        let mut others: Vec<Vec<f64>> = vec![vec![1.0; steps.len()]];
        if self.of.drift != 0.0 {
            others.push((0..steps.len()).map(|i| i as f64).collect());
        }
        if self.of.heated != 0.0 {
            // Mean over a step of what follows the square of the rate late by a minute.
            let (mut warm, late) = (0.0, 60.0 / DWELL as f64 * (1.0 - (-(DWELL as f64) / 60.0).exp()));
            let column = steps.iter().map(|x| {
                let target = (x / FULL).powi(2);
                let mean = target + (warm - target) * late;
                warm = target + (warm - target) * (-(DWELL as f64) / 60.0).exp();
                x * mean
            });
            others.push(column.collect());
        }
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let without = |mut v: Vec<f64>, basis: &[Vec<f64>]| {
            for b in basis {
                let share = dot(&v, b) / dot(b, b);
                v.iter_mut().zip(b).for_each(|(v, b)| *v -= share * b);
            }
            v
        };
        for column in others {
            basis.push(without(column, &basis));
        }
        let left = without(steps, &basis);
        dot(&left, &left)
    }

    fn simulated(&self, seed: u64) -> Simulated {
        let Rates { cycles, cycle_ppm, heated, per_degree_ppm, hysteresis_ppm, harmonics, drift, .. } =
            *self.of;
        let mut source = NoiseSource::new(seed);
        let dt = 1.0 / HZ as f64;
        let steps = self.steps();
        let rows = steps.len() * DWELL * HZ;
        let white = source.white(N, dt, rows);
        let of_cycle: Vec<f64> = (0..cycles).map(|_| cycle_ppm * source.normal()).collect();
        let mut columns = Columns::default();
        let (mut angle, mut warm) = (12.0f64, 0.0f64);
        for (row, noise) in white.iter().enumerate() {
            let step = row / (DWELL * HZ);
            let (x, before) = (steps[step], if step == 0 { f64::NAN } else { steps[step - 1] });
            let share = row as f64 / rows as f64;
            warm += (heated * (x / FULL).powi(2) - warm) * dt / 60.0;
            let off = if heated > 0.0 { warm } else { 1.7 * (9.0 * share).sin() + 0.9 * share };
            // About the mean of the test, near enough: what is left moves the scale factor by far less than the noise.
            let cold = if heated > 0.0 { 0.0 } else { 0.9 * 0.5 + 1.7 * (1.0 - 9f64.cos()) / 9.0 };
            let approach = if before < x {
                0.5
            } else if before > x {
                -0.5
            } else {
                0.0
            };
            let psi = (angle + 0.5 * x / 3600.0 * dt).to_radians();
            let y = self.response(x)
                + 1e-6 * x * (per_degree_ppm * (off - cold) + of_cycle[step / self.rates.len()])
                + 1e-6 * FULL * hysteresis_ppm * approach
                + harmonics[0] * (psi - 0.7).cos()
                + harmonics[1] * (2.0 * psi + 0.3).cos()
                + 2.0
                + drift * share
                + noise;
            columns.push([row as f64 * dt, y, x / 3600.0, angle.rem_euclid(360.0), 22.0 + off]);
            angle += x / 3600.0 * dt;
        }
        columns.simulated("of_rate_from = \"10 deg/s\"", self.truths())
    }
}

/// Time, output, rate and angle of the table, temperature.
#[derive(Default)]
struct Columns([Vec<f64>; 5]);

impl Columns {
    fn push(&mut self, row: [f64; 5]) {
        self.0.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
    }

    /// A test for all that is true of the unit; `asked` stands in the procedure's table.
    fn simulated(&self, asked: &str, truths: Vec<Truth>) -> Simulated {
        let sections = format!(
            "[rate_table]\nsettling = \"2 s\"\nminimum_step = \"15 s\"\nwhole_turns = false\nfull_scale = \"100 deg/s\"\n\
             {asked}\n[conditions]\nminimum_duration = \"1 min\""
        );
        let columns = [
            column("rate", "rate_deg_h", "rate", "deg/h"),
            column("table", "table_rate_deg_s", "table_rate", "deg/s"),
            column("angle", "table_angle_deg", "table_angle", "deg"),
            column("temp", "temp_degC", "temperature", "degC"),
        ];
        let ids: Vec<&str> = truths.iter().map(|t| t.id.as_str()).collect();
        Simulated {
            csv: csv(
                "time_s,rate_deg_h,table_rate_deg_s,table_angle_deg,temp_degC",
                &self.0.each_ref().map(Vec::as_slice),
            ),
            procedure: procedure("Rates", &columns, &sections, &ids),
            truths,
        }
    }
}

/// A response that is a sine: without a loop.
fn sine(phase_s: f64, seed: u64) -> Simulated {
    let usual = Rates::default();
    let cycle = usual.cycle(seed);
    let dt = 1.0 / HZ as f64;
    let rows = usual.cycles * cycle.len() * DWELL * HZ;
    let white = NoiseSource::new(seed).white(N, dt, rows);
    let mut columns = Columns::default();
    let mut angle = 0.0f64;
    for (row, noise) in white.iter().enumerate() {
        let rate = cycle[row / (DWELL * HZ) % cycle.len()];
        let phase = phase_s * rate.to_radians();
        let whole = if phase == 0.0 { 1.0 } else { phase.sin() / phase };
        let temperature = 22.0 + 1.5 * (8.0 * row as f64 / rows as f64).sin();
        let output = 3600.0 * rate * whole + 1.0 + noise;
        columns.push([row as f64 * dt, output, rate, angle.rem_euclid(360.0), temperature]);
        angle += rate * dt;
    }
    columns.simulated("response = \"sine\"", vec![Truth::new("sine_response", phase_s)])
}

/// Turns of two axes by hand, forth and back between rests, with the Earth across.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Turns {
    /// Output of the other axis per rate.
    cross: f64,
    /// The second turn goes on in the sense of the first.
    one_way: bool,
    /// deg/h over the test.
    drift: f64,
}

impl Turns {
    fn simulated(&self, seed: u64) -> Simulated {
        let Turns { cross, one_way, drift } = *self;
        let mut source = NoiseSource::new(seed);
        let dt = 0.1;
        let (n, rate) = (0.05, 36_000.0);
        // Rest of a minute, a turn of 36 s about x, rest, the turn back or on, rest.
        let second = if one_way { rate } else { -rate };
        let spans = [(0.0, 600), (rate, 360), (0.0, 600), (second, 360), (0.0, 600)];
        let rows: usize = spans.iter().map(|s| s.1).sum();
        let (wx, wy) = (source.white(n, dt, rows), source.white(n, dt, rows));
        let across = (source.uniform(-10.0, 10.0), source.uniform(-10.0, 10.0));
        let (mut time, mut x, mut y) = (vec![], vec![], vec![]);
        let mut roll = 0.0f64;
        for about in spans.iter().flat_map(|(rate, rows)| std::iter::repeat_n(*rate, *rows)) {
            let row = time.len();
            let share = row as f64 / rows as f64;
            let middle = roll + (0.5 * about * dt / 3600.0).to_radians();
            time.push(row as f64 * dt);
            x.push(about + 3.0 + wx[row]);
            y.push(
                cross * about + across.0 * middle.cos() + across.1 * middle.sin() - 1.0
                    + drift * share
                    + wy[row],
            );
            roll += (about * dt / 3600.0).to_radians();
        }
        let columns = [column("x", "x_deg_h", "rate", "deg/h"), column("y", "y_deg_h", "rate", "deg/h")];
        let sections = SECTIONS_OF_TURNS.replace("SECOND", if one_way { "360" } else { "-360" });
        Simulated {
            csv: csv("time_s,x_deg_h,y_deg_h", &[&time, &x, &y]),
            procedure: procedure("Turns", &columns, &sections, &["cross_axis"]),
            truths: vec![Truth::new("cross_axis", cross).on("y<-x")],
        }
    }
}

const SECTIONS_OF_TURNS: &str = r#"[rate_table]
[[rate_table.rest]]
from = "1 s"
to = "59 s"
[[rate_table.turn]]
channel = "x"
from = "59 s"
to = "97 s"
angle = "360 deg"
angle_uncertainty = "0.001 deg"
[[rate_table.rest]]
from = "97 s"
to = "155 s"
[[rate_table.turn]]
channel = "x"
from = "155 s"
to = "193 s"
angle = "SECOND deg"
angle_uncertainty = "0.001 deg"
[[rate_table.rest]]
from = "193 s"
to = "250 s"
[conditions]
minimum_duration = "1 min"
"#;
