//! Measurands of every kind of test, each on a small record made for it.

use crate::noise::units;
use crate::stored::Figures;
use crate::truths::noise;
use sagnac_core::estimate::Estimate;
use sagnac_core::influence::comparison::{self, BandChange, Beside, NoiseChange};
use sagnac_core::influence::nuisance::Nuisance;
use sagnac_core::influence::{
    ComparisonTest, Influence, Law, LevelUnit, RepeatabilityTest, Setting, intervals, repeatability, runs,
};
use sagnac_core::measurand::{
    ComparisonEvidence, Earth, GyroEvidence, KnownInputEvidence, MEASURANDS, Options, TableEvidence,
    table_extras,
};
use sagnac_core::noise::in_band::BandMean;
use sagnac_core::rate_table::blocks::{Block, Blocks};
use sagnac_core::rate_table::setup::{Input, ReferenceInput};
use sagnac_core::rate_table::steps::Step;
use sagnac_core::rate_table::{Setup, TableRun, alignment, dead_zone, known, scale_factor, sine, turns};
use sagnac_core::temperature::findings::{findings, schedule};
use sagnac_core::temperature::start::{Start, start};
use sagnac_core::temperature::track::Means;
use sagnac_core::temperature::{StartAsked, TemperatureTest, WarmUpTest, warm_up};
use std::f64::consts::PI;

/// Rows of a measurand under its id.
fn add(figures: &mut Figures, of: &str, id: &str, rows: &[Estimate]) {
    for (at, row) in rows.iter().enumerate() {
        figures.add(format!("{of}: {id} {at}"), row);
    }
}

fn rest(figures: &mut Figures, of: &str, gyro: &GyroEvidence) {
    for measurand in MEASURANDS {
        for remove_earth_rate in [false, true] {
            if remove_earth_rate && measurand.options.is_empty() {
                continue;
            }
            let rows = measurand.evaluate_gyro(gyro, &Options { remove_earth_rate });
            add(figures, of, &format!("{} {remove_earth_rate}", measurand.id), &rows);
        }
    }
}

#[test]
fn at_rest() {
    let mut figures = Figures::default();
    for unit in units() {
        let mut gyro = unit.evidence();
        rest(&mut figures, unit.name, &gyro);
        gyro.earth = Some(Earth { rate_deg_h: 0.7, uncertainty_deg_h: 0.02 });
        gyro.several = true;
        let site = MEASURANDS.iter().filter(|m| m.from_site || !m.options.is_empty());
        for measurand in site {
            let rows = measurand.evaluate_gyro(&gyro, &Options { remove_earth_rate: true });
            add(&mut figures, &format!("{} with a site", unit.name), measurand.id, &rows);
        }
    }
    figures.check("at_rest.txt");
}

/// A test over temperature: −20 to 50 degC and back, twice.
fn over_temperature() -> (Means, TemperatureTest) {
    let (block_s, n) = (10.0, 4000usize);
    let course = |t: f64| {
        let phase = (t / 20_000.0).rem_euclid(1.0);
        let up = if phase < 0.4 {
            phase / 0.4
        } else if phase < 0.5 {
            1.0
        } else if phase < 0.9 {
            (0.9 - phase) / 0.4
        } else {
            0.0
        };
        -20.0 + 70.0 * up
    };
    let times: Vec<f64> = (0..n).map(|i| (i as f64 + 0.5) * block_s).collect();
    let sensor: Vec<f64> = times.iter().map(|t| course(*t)).collect();
    let e = noise(31, n, 0.05);
    let mut slow = 0.0;
    let rate = times
        .iter()
        .zip(&e)
        .map(|(t, e)| {
            slow += 0.02 * e;
            let coil = course(t - 200.0);
            let x = (coil - 15.0) / 35.0;
            2.0 + 0.4 * x - 0.2 * x * x + 0.05 * (course(t + 5.0) - course(t - 5.0)) * 6.0 + slow + e
        })
        .collect();
    let test = TemperatureTest {
        channel: "t".into(),
        command: None,
        low_deg_c: -20.0,
        high_deg_c: 50.0,
        end_tolerance_deg_c: 1.0,
        overshoot_deg_c: None,
        ramp_rate_deg_c_h: None,
        ramp_rate_tolerance: 0.1,
        slowest_deg_c_h: 1.0,
        fastest_deg_c_h: 100.0,
        dwell_s: None,
        dwell_drift_deg_c_h: 1.0,
        ramps_each_way: 1,
        sensor_uncertainty_deg_c: 0.1,
        coverage_factor: 2.0,
        zones_deg_c: vec![-20.0, 15.0, 50.0],
        residual_average_s: 100.0,
        highest_order: 3,
        segments: vec![],
    };
    (Means { block_s, samples: 10, first_s: 0.0, values: vec![rate, sensor] }, test)
}

#[test]
fn temperature() {
    let mut figures = Figures::default();
    let (means, test) = over_temperature();
    let found = findings(&means, 0, 1, schedule(&means, 1, None, &test), &test);
    let slow = MEASURANDS.iter().flat_map(|m| {
        let rows = m.evaluate_temperature("g", &found);
        rows.into_iter().map(|row| (m.id, row)).collect::<Vec<_>>()
    });
    for (at, (id, row)) in slow.enumerate() {
        figures.add(format!("{id} {at}"), &row);
    }
    figures.check("temperature.txt");
}

#[test]
fn warm_up_from_the_first_sample_and_later() {
    let mut figures = Figures::default();
    let n = 2000usize;
    let e = noise(41, n, 0.03);
    let transients: [(&str, &dyn Fn(f64) -> f64); 3] = [
        ("one decay", &|t| 0.8 * (-t / 300.0).exp()),
        ("two decays", &|t| 0.8 * (-t / 100.0).exp() - 0.3 * (-t / 900.0).exp()),
        ("none", &|_| 0.0),
    ];
    for (name, transient) in transients {
        let rate = (0..n).map(|i| 1.0 + transient(2.0 * i as f64 + 1.0) + e[i]).collect();
        let supply = (0..n).map(|i| if i < 30 { 0.0 } else { 5.0 }).collect();
        let means = Means { block_s: 2.0, samples: 20, first_s: 0.0, values: vec![rate, supply] };
        let supply = StartAsked::Supply { channel: "v".into() };
        for asked in [StartAsked::Declared, StartAsked::Nothing, supply] {
            let begun: Start = start(&asked, &means, Some(1), Some(0.0));
            let test = WarmUpTest { band_deg_h: 0.05, final_share: 0.25, start: asked.clone() };
            let found = warm_up::find(&means, 0, &test, begun);
            for measurand in MEASURANDS {
                let rows = found.as_ref().map(|f| measurand.evaluate_warm_up("g", f)).unwrap_or_default();
                add(&mut figures, &format!("{name} {asked:?}"), measurand.id, &rows);
            }
        }
    }
    figures.check("warm_up.txt");
}

/// Blocks of one second; `at` gives output, rate of the table, rate of the outer axis and temperature at a time.
fn blocks(count: usize, gyros: usize, at: impl Fn(f64) -> (Vec<f64>, f64, f64, f64)) -> Blocks {
    let mut angle = 0.0;
    let list = (0..count)
        .map(|i| {
            let (gyro, table_rate, outer_rate, temperature) = at(i as f64 + 0.5);
            let first = angle;
            angle += table_rate;
            Block {
                first_index: 10 * i as u64,
                first_row: 10 * i as u64 + 1,
                samples: 10,
                continues: i > 0,
                gyro,
                table_rate,
                outer_rate,
                temperature,
                beside: vec![],
                angle_first: first,
                angle_last: first + 0.9 * table_rate,
            }
        })
        .collect();
    Blocks {
        list,
        interval_s: 0.1,
        gyros: (0..gyros).map(|g| format!("g{g}")).collect(),
        has_angle: true,
        has_rate: true,
        has_temperature: true,
        has_outer: true,
    }
}

/// What was found of the steps, without their parts.
fn told(run: &TableRun) -> impl std::fmt::Debug {
    let of =
        |s: &Step| (s.from_s, s.to_s, s.rate, s.nominal, s.gyro[0], s.turns, s.level, s.approach, s.cycle);
    let list: Vec<_> = run.steps.list.iter().map(of).collect();
    (list, run.steps.levels.clone(), run.steps.cycles, run.steps.too_short)
}

/// Rates of the table in steps of 40 s.
fn rate_at(rates: &[f64], t: f64) -> f64 {
    rates[(t / 40.0) as usize % rates.len()]
}

#[test]
fn rate_table() {
    let mut figures = Figures::default();
    let large: Vec<f64> = [0.0, 20.0, 50.0, 100.0, -100.0, -50.0, -20.0].map(|r| 3600.0 * r).to_vec();
    let small: Vec<f64> = [-8.0, -4.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 4.0, 8.0].to_vec();
    let e = noise(51, 1400, 1.0);
    let bent = |rate: f64| {
        let x = rate / 360_000.0;
        rate * (1.0 + 2e-5 * (PI * x).sin().powi(2)) + 1.2 + if rate > 0.0 { 1e-5 * rate } else { 0.0 }
    };
    let dead = |rate: f64| if rate.abs() < 1.2 { 0.0 } else { rate - 1.2 * rate.signum() };
    let open = |rate: f64| 300_000.0 * (rate / 300_000.0).sin();
    type Response<'a> = (&'a str, &'a [f64], &'a dyn Fn(f64) -> f64, f64);
    let cases: [Response<'_>; 4] = [
        ("large rates", &large, &bent, 0.5),
        ("small rates", &small, &dead, 0.05),
        ("small rates in steps", &small, &|r: f64| (r / 0.7).round() * 0.7, 0.02),
        ("open loop", &large, &open, 2.0),
    ];
    for (name, rates, response, sigma) in cases {
        let at = |t: f64| {
            let rate = rate_at(rates, t);
            let outer = if ((t / 40.0) as usize).is_multiple_of(2) { 7200.0 } else { 0.0 };
            let warm = 20.0 + 0.002 * t;
            let turned = 3.0 * (2.0 * PI * (t * rate) / 1_296_000.0).cos();
            let output = response(rate) + sigma * e[t as usize] + 2e-4 * outer + 0.01 * warm;
            (vec![output + if name == "large rates" { turned } else { 0.0 }], rate, outer, warm)
        };
        let setup = Setup {
            sine: name == "open loop",
            whole_turns: false,
            rate_uncertainty: 1e-6,
            scale_factor_uncertainty: Some(1e-4),
            temperature_uncertainty_deg_c: 0.1,
            ..Setup::default()
        };
        let run = TableRun::new(blocks(e.len(), 1, at), &setup);
        figures.add(format!("{name} steps"), &told(&run));
        for wanted in [false, true] {
            let extras = table_extras(&|_| wanted);
            let line = scale_factor::evaluate(&run, 0, &setup, &extras);
            let zone =
                line.as_ref().and_then(|l| dead_zone::evaluate(&run.steps, 0, &l.response, "g0", &setup));
            let evidence = TableEvidence {
                as_recorded: ("mV/(deg/s)", 0.3),
                earth: Some(Earth { rate_deg_h: 8.0, uncertainty_deg_h: 0.1 }),
                sine: setup.sine.then(|| sine::fit(&run.steps, 0)).flatten(),
                dead_zone: zone,
                alignment: Some(alignment::evaluate(&run.steps, "g0", 0, 12.5, 1e-5, false)),
                line,
                ..TableEvidence::new(0, "g0", &setup, &run.steps)
            };
            for measurand in MEASURANDS {
                let rows = measurand.evaluate_steps(&evidence);
                add(&mut figures, &format!("{name} {wanted}"), measurand.id, &rows);
            }
            let bare = TableEvidence { line: None, sine: None, dead_zone: None, alignment: None, ..evidence };
            for measurand in MEASURANDS.iter().filter(|_| wanted) {
                let rows = measurand.evaluate_steps(&bare);
                add(&mut figures, &format!("{name} without a line"), measurand.id, &rows);
            }
        }
    }
    figures.check("rate_table.txt");
}

/// A turn about the outer axis in steps, for the direction of the input axis.
#[test]
fn outer_axis() {
    let mut figures = Figures::default();
    let e = noise(61, 800, 0.3);
    let outer = [36_000.0, -36_000.0, 72_000.0, -72_000.0];
    let at = |t: f64| {
        let rate = rate_at(&outer, t);
        let angle = 2.0 * PI * rate * t / 1_296_000.0;
        [rate * 3e-4 + 2.0 * angle.cos() + e[t as usize], rate, rate, 20.0]
    };
    let made = blocks(e.len(), 1, |t| {
        let values = at(t);
        (vec![values[0]], values[1], values[2], values[3])
    });
    let setup = Setup { whole_turns: false, alignment_uncertainty_rad: 1e-5, ..Setup::default() };
    let run = TableRun::new(made, &setup);
    for vertical in [0.0, 12.5] {
        let found = alignment::evaluate(&run.steps, "g0", 0, vertical, 1e-5, false);
        figures.add(format!("tilts {vertical}"), &found);
        let line = scale_factor::evaluate(&run, 0, &setup, &[]);
        let evidence =
            TableEvidence { alignment: Some(found), line, ..TableEvidence::new(0, "g0", &setup, &run.steps) };
        for measurand in MEASURANDS {
            add(&mut figures, &format!("{vertical}"), measurand.id, &measurand.evaluate_steps(&evidence));
        }
    }
    figures.add("steps", &told(&run));
    figures.check("outer_axis.txt");
}

#[test]
fn known_inputs() {
    let mut figures = Figures::default();
    let e = noise(71, 1600, 0.02);
    let place = |t: f64| (t / 200.0) as usize;
    let earth = |place: usize| [10.0, -10.0, 4.0, 0.0][place % 4];
    // Four positions, then rest, a turn about each axis, and rest.
    let at = |t: f64| {
        let p = place(t);
        let turned = |axis: usize| if p == 5 + axis { 1.8 * 3600.0 } else { 0.0 };
        let gyro = |own: usize| {
            let cross = 2e-3 * turned(1 - own);
            let input = if p < 4 { earth(p) } else { 0.0 };
            0.5 + (1.0 + 1e-3 * (own as f64 + 1.0)) * (turned(own) + input) + cross + e[t as usize]
        };
        (vec![gyro(0), gyro(1)], f64::NAN, f64::NAN, 20.0)
    };
    let made = blocks(e.len(), 2, at);
    let input = |from: f64, to: f64, channel: Option<&str>, input: Input| ReferenceInput {
        phase: None,
        from_s: Some(from),
        to_s: Some(to),
        channel: channel.map(str::to_owned),
        input,
    };
    let position =
        |p: usize| Input::Position { heading: (90.0 * p as f64, 0.1), elevation: (5.0 * p as f64, 0.1) };
    let mut stated: Vec<ReferenceInput> =
        (0..4).map(|p| input(200.0 * p as f64, 200.0 * (p + 1) as f64, None, position(p))).collect();
    stated.push(input(800.0, 1000.0, None, Input::Rest));
    stated.push(input(1000.0, 1200.0, Some("g0"), Input::Turn { angle: (360.0, 0.01) }));
    stated.push(input(1200.0, 1400.0, Some("g1"), Input::Turn { angle: (360.0, 0.01) }));
    stated.push(input(1400.0, 1600.0, None, Input::Rest));
    let stretches = known::stretches(&made, &stated, &[]);
    figures.add("stretches", &stretches);
    let rate = |heading: (f64, f64), _: (f64, f64)| (earth((heading.0 / 90.0) as usize), 0.01);
    let positions: Vec<_> =
        (0..2).filter_map(|g| known::positions(&made, &stated, &stretches, g, &rate)).collect();
    let turned = turns::turns(&made, &stated, &stretches);
    figures.add("positions", &positions);
    figures.add("turns", &turned);
    for (name, positions, turns) in [
        ("both", &positions[..], turned.as_ref()),
        ("positions", &positions, None),
        ("turns", &[], turned.as_ref()),
    ] {
        for measurand in MEASURANDS {
            let rows = measurand.evaluate_known_input(&KnownInputEvidence { positions, turns });
            add(&mut figures, name, measurand.id, &rows);
        }
    }
    figures.check("known_inputs.txt");
}

#[test]
fn switching_off_and_on() {
    let mut figures = Figures::default();
    let e = noise(81, 1800, 0.1);
    let biases = [0.3, -0.2, 0.15, 0.4, -0.35, 0.1];
    for (name, spread, drift) in [("scatter", 1.0, 0.0), ("trend", 0.1, 2e-4), ("steady", 0.0, 0.0)] {
        let at = |t: f64| {
            let run = (t / 300.0) as usize;
            let on = t % 300.0 < 250.0;
            let warm = 20.0 + f64::from((run % 3) as u8);
            let output = 1.0 + spread * biases[run % 6] + drift * t + e[t as usize] + 0.05 * spread * warm;
            (vec![if on { output } else { f64::NAN }], f64::NAN, f64::NAN, warm)
        };
        let made = blocks(e.len(), 1, at);
        let test = RepeatabilityTest {
            settling_s: 20.0,
            minimum_run_s: 60.0,
            off_s: 10.0,
            fewest: 5,
            temperature: None,
            runs: vec![],
        };
        let series = runs::find(&made, &test, &[]);
        figures.add(format!("{name} runs"), &series);
        let found = repeatability::evaluate(&made, &series, 0, 0.4);
        figures.add(format!("{name} found"), &found);
        for measurand in MEASURANDS {
            let rows = found.as_ref().map(|f| measurand.evaluate_runs(f)).unwrap_or_default();
            add(&mut figures, name, measurand.id, &rows);
        }
    }
    figures.check("switching.txt");
}

/// N and bands with and without an influence: both, and each alone.
fn changes_of_noise() -> [NoiseChange; 3] {
    let mean = |power| Some(BandMean { power, dof: 200.0 });
    let band = |without, with, lines| BandChange { channel: "g0 1 1-5Hz".into(), without, with, lines };
    let bands = vec![band(mean(0.04), mean(0.09), 0), band(mean(0.04), None, 1)];
    let change = |without, with| {
        let bands = bands.clone();
        NoiseChange { channel: "g0 1".into(), without, with, bands }
    };
    [
        change(Some((0.01, 1e-4)), Some((0.013, 2e-4))),
        change(None, Some((0.013, 2e-4))),
        change(Some((0.01, 1e-4)), None),
    ]
}

#[test]
fn under_influence() {
    let mut figures = Figures::default();
    let e = noise(91, 2100, 0.05);
    let of = |law, on_scale_factor| Setting {
        influence: Influence::Declared,
        law,
        on_scale_factor,
        name: "baro".into(),
        unit: LevelUnit::of("kPa"),
        ..Setting::supply()
    };
    let settings = [
        ("MagneticField", Setting::magnetic_field()),
        ("Supply", Setting::supply()),
        ("Vibration", Setting::vibration()),
        ("Declared linear_quadratic", of(Law::LinearQuadratic, true)),
        ("Declared on_off", of(Law::OnOff, false)),
    ];
    for (influence, setting) in settings {
        for (name, of_level, warmed) in [("acts", 0.2, 0.0), ("does not act", 0.0, 0.0), ("warms", 0.2, 0.5)]
        {
            let level_at = |t: f64| [0.0, 1.0, 0.0, 2.0, 0.0, 3.0, 0.0][(t / 300.0) as usize % 7];
            let mut made = blocks(e.len(), 1, |t| {
                let level = level_at(t);
                let drive = if influence == "Vibration" { level * level } else { level };
                let turned =
                    if setting.on_scale_factor { [9e3, -9e3][(t / 20.0) as usize % 2] } else { f64::NAN };
                let input = if setting.on_scale_factor { turned * (1.0 + 1e-5 * level) } else { 0.0 };
                (
                    vec![0.7 + input + of_level * drive + 2e-5 * t + e[t as usize]],
                    turned,
                    f64::NAN,
                    20.0 + warmed * drive,
                )
            });
            for block in &mut made.list {
                block.beside = vec![level_at(block.first_index as f64 * 0.1 + 0.5)];
            }
            let test = ComparisonTest {
                setting: setting.clone(),
                reference: 0.0,
                settling_s: 20.0,
                rate_settling_s: 1.0,
                minimum_interval_s: 60.0,
                alternations: 2,
                level_uncertainty: 0.02,
                temperature_difference_deg_c: 1.0,
                temperature_coefficient: (warmed > 0.0).then_some(0.05),
                declared: false,
                temperature: None,
                intervals: vec![],
                by_frequency: None,
            };
            let series = intervals::find(&made, &test, &["level".into()], &[]);
            figures.add(format!("{influence} {name} intervals"), &series);
            let temperature = Nuisance { channel: "t".into(), unit: "degC", temperature: true };
            let beside = Beside { temperature: Some(temperature), others: vec![] };
            let Some(bias) = comparison::evaluate(&made, &series, &test, &beside, 0) else { continue };
            figures.add(format!("{influence} {name} found"), &bias);
            let noise = changes_of_noise();
            for measurand in MEASURANDS {
                let rows = measurand.evaluate_comparison(&ComparisonEvidence {
                    bias: &bias,
                    noise: &noise,
                    by_frequency: None,
                });
                add(&mut figures, &format!("{influence} {name}"), measurand.id, &rows);
            }
        }
    }
    figures.check("influence.txt");
}
