//! The samples of units at rest. The truth behind each is in `samples/README.md`.
//!
//! `cargo test --test it noise -- --ignored write_the_samples` writes them anew; the seeds are fixed, and the files the
//! same bytes on every machine.

use sagnac::noise::model::NoiseModel;
use sagnac::noise::simulate::{Setup, Simulator};
use std::fmt::Write;
use std::path::PathBuf;

/// A recording to be simulated.
struct Unit {
    file: &'static str,
    seed: u64,
    model: NoiseModel,
    bias_deg_h: f64,
    tau0_s: f64,
    hours: f64,
    faults: bool,
}

/// Earth rate on a vertical axis at 55.98° north, deg/h.
const EARTH_DEG_H: f64 = 12.467_4;
/// Warm-up of the unit: amplitude, deg/h, and time constant, s.
const WARM_UP: (f64, f64) = (0.02, 300.0);

fn units() -> [Unit; 4] {
    let unit = |file, seed, (n, b), bias_deg_h, tau0_s, hours| Unit {
        file,
        seed,
        model: NoiseModel { n, b, ..NoiseModel::default() },
        bias_deg_h,
        tau0_s,
        hours,
        faults: false,
    };
    [
        unit("unit-pass.csv", 2101, (0.002, 0.003), 0.12, 10.0, 100.5),
        unit("unit-fail.csv", 2102, (0.0034, 0.003), 0.12, 10.0, 100.5),
        unit("unit-indeterminate.csv", 2103, (0.002, 0.003), -0.05, 1.0, 10.6),
        Unit { faults: true, ..unit("unit-faults.csv", 2104, (0.002, 0.003), 0.08, 1.0, 10.6) },
    ]
}

fn path(unit: &Unit) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("samples").join(unit.file)
}

#[test]
fn the_samples_are_what_the_generator_gives() {
    for unit in units() {
        let text = std::fs::read_to_string(path(&unit)).unwrap();
        assert!(text == recording(&unit), "{}", unit.file);
    }
}

#[test]
#[ignore = "writes the samples"]
fn write_the_samples() {
    for unit in units() {
        std::fs::write(path(&unit), recording(&unit)).unwrap();
    }
}

fn recording(unit: &Unit) -> String {
    let samples = (unit.hours * 3600.0 / unit.tau0_s).round() as usize;
    let setup = Setup::for_record(unit.seed, unit.tau0_s, samples as u64);
    let rate = Simulator::new(&unit.model, &setup).take(samples);
    // The thermometer: its own white noise of 0.01 °C about a slow swing of the chamber.
    let thermometer = NoiseModel { n: 0.01 * unit.tau0_s.sqrt() / 60.0, ..NoiseModel::default() };
    let setup = Setup::for_record(unit.seed + 1000, unit.tau0_s, samples as u64);
    let noise = Simulator::new(&thermometer, &setup).take(samples);
    let mut out = String::from("# serial: SN-0001\ntime_s,rate_deg_h,temp_degC\n");
    for (i, (rate, noise)) in rate.iter().zip(&noise).enumerate() {
        let t = i as f64 * unit.tau0_s;
        let rate = rate + EARTH_DEG_H + unit.bias_deg_h + WARM_UP.0 * (-t / WARM_UP.1).exp();
        let swing = 0.06 * (2.0 * std::f64::consts::PI * t / 5400.0).sin();
        let temperature = 20.02 + swing - 0.8 * (-t / 420.0).exp() + noise;
        let row = format!("{t:.0},{rate:.5},{temperature:.3}");
        if unit.faults {
            faulty(&mut out, i, &row, t, rate, temperature);
        } else {
            let _ = writeln!(out, "{row}");
        }
    }
    out
}

/// One of every fault that a reader must find.
fn faulty(out: &mut String, i: usize, row: &str, t: f64, rate: f64, temperature: f64) {
    let _ = match i {
        // A gap of 90 samples.
        12_000..12_090 => Ok(()),
        // A row that was written twice.
        15_000 => writeln!(out, "{row}\n{row}"),
        // A stamp that jumps back.
        17_000 => writeln!(out, "{:.0},{rate:.5},{temperature:.3}", t - 40.0),
        20_000 => writeln!(out, "{t:.0},,{temperature:.3}"),
        20_500 => writeln!(out, "{t:.0},#N/A,{temperature:.3}"),
        // Three spikes.
        23_000 | 26_000 | 29_000 => writeln!(out, "{t:.0},{:.5},{temperature:.3}", rate + 3.0),
        // A sensor that stands still for 40 samples.
        32_000..32_040 => writeln!(out, "{t:.0},12.54321,{temperature:.3}"),
        _ => writeln!(out, "{row}"),
    };
}
