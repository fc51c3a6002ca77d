//! An influence that the procedure declares, at its edges: pressures at rest and on a table, a field that is switched on.

use super::case::{Simulated, Truth};
use super::table::Bench;
use crate::bench::noise_source::{NoiseSource, add, csv};
use serde::Deserialize;

/// deg/sqrt(h)
const N: f64 = 0.002;
/// Level of the reference, kPa.
const REFERENCE: f64 = 100.0;
/// Rates of the table within every interval, deg/s.
const RATES: [f64; 4] = [10.0, -10.0, 20.0, -20.0];

/// The law that the procedure declares.
#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Law {
    Linear,
    Quadratic,
    LinearQuadratic,
    OnOff,
}

impl Law {
    fn word(self) -> &'static str {
        match self {
            Law::Linear => "linear",
            Law::Quadratic => "quadratic",
            Law::LinearQuadratic => "linear_quadratic",
            Law::OnOff => "on_off",
        }
    }

    fn has(self, degree: u8) -> bool {
        match degree {
            1 => matches!(self, Law::Linear | Law::LinearQuadratic),
            _ => matches!(self, Law::Quadratic | Law::LinearQuadratic),
        }
    }
}

/// A unit under an influence in intervals, each between two without.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Declared {
    law: Law,
    /// Levels against the reference, one an interval with the influence.
    levels: Vec<f64>,
    /// Rates of a table in every interval.
    turns: bool,
    interval_s: f64,
    /// Change of the bias per level and per square of it, and by the presence of the influence alone; deg/h.
    bias: [f64; 3],
    /// The same of the scale factor, ppm.
    scale_factor: [f64; 3],
    /// Error of the scale factor, ppm.
    error: f64,
    /// deg/h over the test: in proportion to time, and to its square.
    drift: [f64; 2],
    /// Flicker, deg/h.
    flicker: f64,
    /// Time constant that the bias follows with, s.
    lag_s: f64,
    /// degC per unit of the level, and deg/h/degC.
    warms: (f64, f64),
    /// Scatter of the scale factor from interval to interval, ppm.
    scatter: f64,
}

impl Default for Declared {
    fn default() -> Declared {
        Declared {
            law: Law::LinearQuadratic,
            levels: vec![-20.0, 50.0, -20.0, 50.0],
            turns: true,
            interval_s: 80.0,
            bias: [0.0; 3],
            scale_factor: [0.0; 3],
            error: 100.0,
            drift: [0.05, 0.0],
            flicker: 0.0,
            lag_s: 0.0,
            warms: (0.0, 0.0),
            scatter: 0.0,
        }
    }
}

/// A change by its coefficients at a level.
fn change([linear, quadratic, present]: [f64; 3], level: f64) -> f64 {
    let there = if level == 0.0 { 0.0 } else { present };
    linear * level + quadratic * level * level + there
}

impl Declared {
    /// Reference; a switch has none.
    fn reference(&self) -> f64 {
        if self.law == Law::OnOff || self.law == Law::Quadratic { 0.0 } else { REFERENCE }
    }

    fn records(&self, seed: u64) -> String {
        let mut source = NoiseSource::new(seed);
        let each = self.interval_s as usize;
        let count = each * (2 * self.levels.len() + 1);
        let level = |i: usize| {
            let interval = i / each;
            if interval % 2 == 1 { self.levels[interval / 2] } else { 0.0 }
        };
        let mut rate = source.white(N, 1.0, count);
        if self.flicker > 0.0 {
            add(&mut rate, &source.flicker(self.flicker, 1.0, count));
        }
        let scattered: Vec<f64> = (0..=count / each).map(|_| self.scatter * source.normal()).collect();
        let mut bias = 0.0;
        let mut columns = [vec![], vec![], vec![], vec![]];
        for (i, r) in rate.iter_mut().enumerate() {
            let settled = change(self.bias, level(i));
            let share = if self.lag_s > 0.0 { 1.0 - (-1.0 / self.lag_s).exp() } else { 1.0 };
            bias += (settled - bias) * share;
            let time = i as f64 / count as f64;
            let warm = self.warms.0 * level(i);
            *r += 12.5 + bias + self.drift[0] * time + self.drift[1] * time * time + self.warms.1 * warm;
            let table = if self.turns { RATES[(i % each) / each.div_ceil(4)] } else { 0.0 };
            let ppm = self.error + change(self.scale_factor, level(i)) + scattered[i / each];
            *r += 3600.0 * table * (1.0 + 1e-6 * ppm);
            let own = [i as f64, 20.0 + warm + 0.003 * source.normal(), self.reference() + level(i), table];
            columns.iter_mut().zip(own).for_each(|(column, value)| column.push(value));
        }
        let [time, temperature, told, table] = &columns;
        csv("time_s,rate_deg_h,temp_degC,level,table_rate_deg_s", &[time, &rate, temperature, told, table])
    }

    fn truths(&self) -> Vec<Truth> {
        let mut truths = vec![];
        let mut per = |id, degree: u8, value, unit| {
            if self.law.has(degree) {
                truths.push(Truth::new(id, value).in_unit(unit));
            }
        };
        per("influence_sensitivity", 1, self.bias[0], "deg/h/kPa");
        per("influence_sensitivity_quadratic", 2, self.bias[1], "deg/h/kPa^2");
        if self.turns {
            let of = self.scale_factor;
            per("scale_factor_influence_sensitivity", 1, of[0], "ppm/kPa");
            per("scale_factor_influence_sensitivity_quadratic", 2, of[1], "ppm/kPa^2");
        }
        let mut seen: Vec<f64> = vec![];
        for level in &self.levels {
            if seen.contains(level) {
                continue;
            }
            seen.push(*level);
            let channel = format!("rate@level:{}", self.reference() + level);
            truths.push(Truth::new("bias_shift", change(self.bias, *level)).on(&channel));
            if self.turns {
                truths.push(Truth::new("scale_factor_shift", change(self.scale_factor, *level)).on(&channel));
            }
        }
        truths
    }

    fn procedure(&self, truths: &[Truth]) -> String {
        let mut ids: Vec<&str> = truths.iter().map(|t| t.id.as_str()).collect();
        ids.sort_unstable();
        ids.dedup();
        let measured: String = ids.iter().map(|id| format!("[[measurand]]\nid = \"{id}\"\n")).collect();
        let channel = |id: &str, column: &str, role: &str, unit: &str| {
            format!(
                "[[channel]]\nid = \"{id}\"\ncolumn = \"{column}\"\nrole = \"{role}\"\nunit = \"{unit}\"\n"
            )
        };
        let mut channels = channel("time", "time_s", "time", "s")
            + &channel("rate", "rate_deg_h", "rate", "deg/h")
            + &channel("temp", "temp_degC", "temperature", "degC")
            + &channel("level", "level", "pressure", "kPa");
        let mut acts_on = "bias";
        if self.turns {
            channels += &channel("table", "table_rate_deg_s", "table_rate", "deg/s");
            acts_on = "bias_and_scale_factor";
        }
        format!(
            "format = \"procedure/1\"\n[procedure]\nid = \"edges-declared\"\ntitle = \"Edges\"\nrevision = \"A\"\n\
             {channels}[influence_test]\nchannel = \"level\"\nlaw = \"{}\"\nacts_on = \"{acts_on}\"\n\
             reference = \"{} kPa\"\nsettling = \"0 s\"\nminimum_interval = \"20 s\"\nalternations = 1\n{measured}",
            self.law.word(),
            self.reference()
        )
    }
}

impl Bench for Declared {
    fn simulated(&self, _: &[String], seed: u64) -> Simulated {
        let truths = self.truths();
        Simulated { csv: self.records(seed), procedure: self.procedure(&truths), truths }
    }
}
