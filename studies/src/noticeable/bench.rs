//! Recordings whose noise and drivers are made by sums that share nothing with the analysis, with one effect of a size set
//! into them.

use crate::bench::noise_source::{NoiseSource, add};
use sagnac::effect::Column;
use sagnac::series::{Faults, Series};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Rows.
pub const ROWS: usize = 6000;
/// Sample interval, s.
pub const DT_S: f64 = 1.0;
/// Coefficients that the claim states: deg/√h, deg/h, deg/h/√h.
const CLAIMED: [f64; 3] = [0.003, 0.004, 0.006];
/// Relative deviations that it states of them.
const KNOWN: [f64; 3] = [0.015, 0.12, 0.15];
/// Deviations of the truth from what is claimed: the edges of what the claim allows.
const EDGE: f64 = 1.5;
/// Claimed temperature coefficient, deg/h/°C, with its deviation.
const TEMPERATURE: [f64; 2] = [0.002, 1e-4];
/// Stated deviation of the scale factor, ppm.
const SCALE_FACTOR_PPM: f64 = 0.2;

/// Where a recording is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// At rest, with a thermometer and a barometer.
    AtRest,
    /// On a table that turns in steps.
    OnTable,
}

/// An effect of a size.
#[derive(Debug, Clone)]
pub struct Set<'a> {
    /// Kind, as the program calls it.
    pub kind: &'a str,
    /// What its parameter exceeds the claimed value by.
    pub size: f64,
    /// Other parameters.
    pub at: &'a BTreeMap<String, f64>,
}

/// The claim of a place.
pub fn claim(place: Place) -> String {
    let ([n, b, k], [dn, db, dk]) = (CLAIMED, KNOWN);
    let (columns, own, known) = match place {
        Place::AtRest => (
            "\"temp_degC\", \"pressure_hPa\"",
            format!(
                "[temperature]\ncoefficient_deg_h_per_degC = {}\nreference_degC = 20.0\n",
                TEMPERATURE[0]
            ),
            format!("temperature_coefficient_deg_h_per_degC = {}\n", TEMPERATURE[1]),
        ),
        Place::OnTable => (
            "\"table_rate_deg_s\"",
            "[scale_factor]\nerror_ppm = 12.0\n".to_owned(),
            format!("scale_factor_ppm = {SCALE_FACTOR_PPM}\n"),
        ),
    };
    format!(
        "[recording]\ncase = \"noticeable\"\nsample_rate_hz = {}\ncolumns = [\"time_s\", \"rate_deg_h\", {columns}]\n\
         [noise]\nN_deg_rt_h = {n}\nB_deg_h = {b}\nK_deg_h_rt_h = {k}\n[bias]\nvalue_deg_h = -3.1\n{own}\
         [uncertainty]\nN_rel = {dn}\nB_rel = {db}\nK_rel = {dk}\nbias_deg_h = 0.03\n{known}",
        1.0 / DT_S
    )
}

/// A recording of a seed. The values of the claim are off by 1.5 of its deviations, up or down as bits of the seed say, the
/// lowest left out.
pub fn recording(place: Place, seed: u64, set: Option<&Set<'_>>) -> Series {
    let mut source = NoiseSource::new(seed);
    let sign = |turn: u32| if (seed >> (turn + 1)) & 1 == 0 { EDGE } else { -EDGE };
    let mut levels = [0, 1, 2].map(|i| CLAIMED[i] * (1.0 + sign(i as u32) * KNOWN[i]));
    match set.map(|s| (s.kind, s.size)) {
        Some(("excess_arw", size)) => levels[0] = CLAIMED[0] + size,
        Some(("excess_flicker", size)) => levels[1] = CLAIMED[1] + size,
        Some(("excess_rrw", size)) => levels[2] = CLAIMED[2] + size,
        _ => {}
    }
    let mut rate = vec![-3.1; ROWS];
    let mut white = source.white(levels[0], DT_S, ROWS);
    if let Some(Set { kind: "noise_variance_time", size, .. }) = set {
        white.iter_mut().skip(ROWS / 2).for_each(|w| *w *= size);
    }
    add(&mut rate, &white);
    add(&mut rate, &source.flicker(levels[1], DT_S, ROWS));
    add(&mut rate, &source.walk(levels[2], DT_S, ROWS));
    let columns = columns(place, &mut source);
    add(&mut rate, &mean(place, &columns, sign(3), set));
    if let Some(set) = set {
        add(&mut rate, &course(set, &columns, &mut source));
    }
    series(rate, columns)
}

/// Columns of a place.
fn columns(place: Place, source: &mut NoiseSource) -> BTreeMap<Column, Vec<f64>> {
    let hours = |i: usize| i as f64 * DT_S / 3600.0;
    match place {
        Place::AtRest => {
            let phase = source.uniform(0.0, TAU);
            // A room under its thermostat, and the weather.
            let temperature = (0..ROWS).map(|i| {
                22.0 + 3.0 * (1.0 - (-hours(i) / 0.4).exp()) + 1.5 * (TAU * hours(i) / 0.7 + phase).sin()
            });
            let weather = source.markov(1.0, 600.0, DT_S, ROWS);
            let mut smooth = vec![0.0; ROWS];
            let mut at = 0.0;
            for (s, w) in smooth.iter_mut().zip(&weather) {
                at += DT_S / 120.0 * (w - at);
                *s = 1013.0 + at;
            }
            BTreeMap::from([
                (Column::Temperature, temperature.collect()),
                (Column::of_name("pressure_hPa"), smooth),
            ])
        }
        Place::OnTable => {
            // Steps of two minutes, in an order that repeats twice.
            const STEPS: [f64; 12] = [0.0, 0.5, -0.5, 1.0, -1.0, 2.0, 0.0, -2.0, 5.0, -5.0, 0.2, -0.2];
            let step = |i: usize| STEPS[(i as f64 * DT_S / 120.0) as usize % STEPS.len()];
            BTreeMap::from([(Column::TableRate, (0..ROWS).map(step).collect())])
        }
    }
}

/// What a right claim of the place expects of the rate, its own value off by so many deviations unless that is the effect.
fn mean(place: Place, columns: &BTreeMap<Column, Vec<f64>>, off: f64, set: Option<&Set<'_>>) -> Vec<f64> {
    let of = |kind: &str| set.filter(|s| s.kind == kind).map(|s| s.size);
    match place {
        Place::AtRest => {
            let coefficient = TEMPERATURE[0] + of("temp_linear").unwrap_or(off * TEMPERATURE[1]);
            columns[&Column::Temperature].iter().map(|t| coefficient * (t - 20.0)).collect()
        }
        Place::OnTable => {
            let ppm = 12.0 + of("sf_error").unwrap_or(off * SCALE_FACTOR_PPM);
            columns[&Column::TableRate].iter().map(|r| 3600.0 * r * (1.0 + 1e-6 * ppm)).collect()
        }
    }
}

/// What an effect adds.
fn course(set: &Set<'_>, columns: &BTreeMap<Column, Vec<f64>>, source: &mut NoiseSource) -> Vec<f64> {
    let at = |name: &str| set.at.get(name).copied().unwrap_or(f64::NAN);
    let time = |i: usize| i as f64 * DT_S;
    let of_time = |f: &dyn Fn(f64) -> f64| (0..ROWS).map(|i| set.size * f(time(i))).collect::<Vec<f64>>();
    match set.kind {
        "temp_rate" => {
            let t = &columns[&Column::Temperature];
            let slope = |i: usize| {
                let (a, b) = (i.saturating_sub(1), (i + 1).min(ROWS - 1));
                (t[b] - t[a]) / ((b - a) as f64 * DT_S) * 60.0
            };
            (0..ROWS).map(|i| set.size * slope(i)).collect()
        }
        "column_driver" => {
            columns[&Column::of_name("pressure_hPa")].iter().map(|p| set.size * (p - 1013.0)).collect()
        }
        "rate_ramp" => of_time(&|t| t / 3600.0),
        "bias_step" => of_time(&|t| f64::from(u8::from(t >= at("time_s")))),
        "warmup_exponential" => of_time(&|t| (-t / at("time_constant_s")).exp()),
        "line" => {
            let phase = source.uniform(0.0, TAU);
            of_time(&|t| (TAU * at("frequency_hz") * t + phase).sin())
        }
        "markov_long" => source.markov(set.size, at("correlation_time_s"), DT_S, ROWS),
        _ => vec![0.0; ROWS],
    }
}

fn series(rate_deg_h: Vec<f64>, columns: BTreeMap<Column, Vec<f64>>) -> Series {
    let rows = rate_deg_h.len();
    Series {
        time_s: (0..rows).map(|i| i as f64 * DT_S).collect(),
        rate_deg_h,
        columns,
        index: (0..rows as u64).collect(),
        faults: Faults::default(),
        read_from: vec![],
        sample_interval_s: DT_S,
        sha256: String::new(),
        notes: vec![],
    }
}
