//! Judgements on simulated recordings, and of the small statistics behind them.

use super::clock_check::{ClockRemark, clock_remark, earth};
use super::inspect_source;
use super::tracks::{LevelFinder, LinearFit, runs};
use crate::ingest::{MemoryColumn, Source};
use crate::noise::block_series::BlockSeriesAccumulator;
use crate::noise::lines::SpectralLine;
use crate::noise::model::NoiseModel;
use crate::noise::motion::{Motion, Quietest, motion, scatter};
use crate::noise::simulate::{Setup, Simulator};
use std::f64::consts::TAU;

type Columns = Vec<(&'static str, Vec<f64>)>;

/// What is said of a recording in memory, on one line.
fn told(columns: Columns, rate_hz: Option<f64>) -> String {
    let columns = columns.into_iter().map(|(name, values)| MemoryColumn::new(name, values)).collect();
    let source = Source::from_columns("unit.csv", columns, 4096).unwrap();
    let text = inspect_source(&source, rate_hz, crate::i18n::Lang::En, &mut |_, _| {}).unwrap();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn noise(n: f64, seed: u64, tau0_s: f64, samples: usize) -> Vec<f64> {
    let model = NoiseModel { n, ..Default::default() };
    Simulator::new(&model, &Setup::for_record(seed, tau0_s, samples as u64)).take(samples)
}

fn stamps(tau0_s: f64, samples: usize) -> Vec<f64> {
    (0..samples).map(|i| i as f64 * tau0_s).collect()
}

/// The N that is stated.
fn angle_random_walk(text: &str) -> f64 {
    text.split("N = ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap()
}

#[track_caller]
fn says(text: &str, wanted: &[&str]) {
    for w in wanted {
        assert!(text.contains(w), "`{w}` is not in:\n{text}");
    }
}

#[track_caller]
fn keeps_quiet(text: &str, unwanted: &[&str]) {
    for w in unwanted {
        assert!(!text.contains(w), "`{w}` is in:\n{text}");
    }
}

#[test]
fn a_record_states_how_long_the_next_one_must_be_for_slow_terms() {
    let told = |n: f64, samples: usize| {
        told(vec![("time_s", stamps(1.0, samples)), ("rate_deg_h", noise(n, 1, 1.0, samples))], None)
    };
    let text = told(0.01, 37_800);
    says(
        &text,
        &[
            "record for B, K `rate_deg_h`: No value here. If B = ",
            "of recording give it a value in 8 of 10 records; if half of that, ",
            "No value here. If K = ",
            "Assumed for these lengths: N = ",
            "°/√h, the other terms as found",
        ],
    );
    // A bound by ten hours takes about as long to be resolved, and half of it longer.
    let hours = |text: &str| text.split(' ').next().unwrap().parse::<f64>().unwrap();
    let of_b = text.split("If B = ").nth(1).unwrap();
    let (at_bound, at_half) = (
        hours(of_b.split("its bound, ").nth(1).unwrap()),
        hours(of_b.split("if half of that, ").nth(1).unwrap()),
    );
    assert!((5.0..60.0).contains(&at_bound) && at_half > 2.0 * at_bound, "{at_bound} {at_half}");
}

#[test]
fn a_long_rest_supports_the_static_test() {
    let n = 37_800;
    let text = told(vec![("time_s", stamps(1.0, n)), ("rate_deg_h", noise(0.01, 1, 1.0, n))], None);
    says(
        &text,
        &[
            "static test Yes: at rest, 10.5 h",
            "up to 3780 s (1.05 h) for a flicker floor (T/10), up to 7560 s (2.1 h) for a fit",
            "1 Hz, one sample every 1 s",
            "`rate_deg_h`: No 1/f noise resolved",
            "temperature test No: no temperature column.",
            "scale factor No: no column with a table rate",
        ],
    );
    keeps_quiet(&text, &["sample clock is off", "known angle", "Earth rate The"]);
    let n = angle_random_walk(&text);
    assert!((n / 0.01 - 1.0).abs() < 0.02, "{n}");
}

#[test]
fn the_smallest_flicker_shrinks_with_the_record() {
    let bound = |n: usize| {
        let text = told(vec![("time_s", stamps(1.0, n)), ("rate_deg_h", noise(0.01, 2, 1.0, n))], None);
        let after =
            text.split("could show B from about ").nth(1).unwrap().split(' ').next().unwrap().to_owned();
        after.parse::<f64>().unwrap()
    };
    let (short, long) = (bound(1200), bound(40_000));
    assert!(long < 0.5 * short && long > 0.0, "{short} {long}");
}

#[test]
fn a_short_rest_supports_it_in_part_only() {
    let text =
        told(vec![("time_s", stamps(0.01, 60_000)), ("rate_deg_h", noise(0.01, 3, 0.01, 60_000))], None);
    says(&text, &["static test Partly: at rest, but 10 min is less than the required 10 h"]);
}

#[test]
fn a_turn_is_no_rest_for_any_axis() {
    let mut x = noise(0.01, 4, 0.01, 6000);
    // 90 deg in 10 s.
    x.iter_mut().skip(2000).take(1000).for_each(|v| *v += 9.0 * 3600.0);
    let y = noise(0.01, 5, 0.01, 6000);
    let text = told(vec![("time_s", stamps(0.01, 6000)), ("rate_x_deg_h", x), ("rate_y_deg_h", y)], None);
    says(
        &text,
        &[
            "static test No: `rate_x_deg_h` moved",
            "`rate_x_deg_h` covers 90 deg",
            "Not at rest: another axis of the unit was rotated.",
            "Angle random walk is not determined from a moving record.",
        ],
    );
    keeps_quiet(&text, &["bias instability", "averaging times", "Earth rate The"]);
}

#[test]
fn a_slow_change_with_the_temperature_is_told_from_a_turn() {
    let n = 8000;
    let temperature: Vec<f64> = (0..n).map(|i| 20.0 + 40.0 * (f64::from(i) / 8000.0 * TAU).sin()).collect();
    let rate = |with: f64| -> Vec<f64> {
        noise(0.5, 6, 1.0, 8000).iter().zip(&temperature).map(|(r, t)| r + with * (t - 20.0)).collect()
    };
    let text = told(
        vec![("time_s", stamps(1.0, 8000)), ("rate_deg_h", rate(40.0)), ("temp_degC", temperature.clone())],
        None,
    );
    says(
        &text,
        &[
            "Not proven to be at rest",
            "static test No: the output of `rate_deg_h` changes slowly",
            "temperature test Yes, for the bias: `temp_degC` spans 80 °C",
        ],
    );
    let steady = told(
        vec![("time_s", stamps(1.0, 8000)), ("rate_deg_h", rate(0.0)), ("temp_degC", temperature.clone())],
        None,
    );
    says(&steady, &["At rest, as far as the output shows", "temperature test Yes, for the bias"]);
    let up: Vec<f64> = (0..n).map(|i| 20.0 + 0.002 * f64::from(i)).collect();
    let one_way =
        told(vec![("time_s", stamps(1.0, 8000)), ("rate_deg_h", rate(0.0)), ("temp_degC", up)], None);
    says(&one_way, &["temperature test Partly", "in one direction only", "steepest trend 7.2 °C/h"]);
}

#[test]
fn noise_alone_is_not_taken_for_motion() {
    // A rough MEMS unit at 100 Hz, and a fibre-optic one at 1 Hz: no false alarm in 60 records.
    for seed in 0..30 {
        for (n, tau0_s) in [(3.0, 0.01), (0.01, 1.0)] {
            let mut blocks = BlockSeriesAccumulator::default();
            let mut quietest = Quietest::new(tau0_s);
            let samples = noise(n, 100 + seed, tau0_s, 6000);
            blocks.push(&samples, 0);
            quietest.push(&samples, false);
            let found = motion(&blocks.finish(), tau0_s, quietest.finish(), 0.0);
            assert!(found.is_rest(), "{seed} {n}: {found:?}");
        }
    }
}

#[test]
fn too_few_samples_are_not_judged() {
    let mut blocks = BlockSeriesAccumulator::default();
    blocks.push(&[1.0, 2.0], 0);
    assert_eq!(motion(&blocks.finish(), 1.0, None, 0.0), Motion::Unknown);
}

fn line(frequency_hz: f64, resolution_hz: f64) -> SpectralLine {
    SpectralLine {
        frequency_hz,
        resolution_hz,
        amplitude_deg_h: 1.0,
        excess: 50.0,
        false_alarm_probability: 1e-9,
        harmonic_of: None,
        harmonic_order: 1,
        sinusoid: None,
    }
}

#[test]
fn lines_near_mains_tell_of_the_clock() {
    let at = |f: f64| clock_remark(&line(f, 0.05), 1e-3);
    match at(124.65) {
        Some(ClockRemark::Off { mains_hz, factor, .. }) => {
            assert_eq!(mains_hz, 120.0);
            assert!((factor - 1.038_75).abs() < 1e-9);
        }
        other => panic!("{other:?}"),
    }
    assert!(matches!(at(48.0), Some(ClockRemark::Off { mains_hz: 50.0, .. })));
    // Within half a per cent mains is where it should be; beyond six it is something else.
    for quiet in [120.0, 120.5, 49.8, 53.5, 130.0, 387.0] {
        assert_eq!(at(quiet), None, "{quiet}");
    }
    // Too coarse a spectrum cannot tell.
    assert_eq!(clock_remark(&line(121.0, 2.0), 1e-3), None);
    assert!(matches!(at(499.0), Some(ClockRemark::AtNyquist { .. })));
    // 50 Hz sampled 64 times a second folds to 14 Hz.
    assert!(matches!(
        clock_remark(&line(14.02, 0.01), 1.0 / 64.0),
        Some(ClockRemark::Alias { mains_hz: 50.0, .. })
    ));
    assert_eq!(clock_remark(&line(17.0, 0.01), 1.0 / 64.0), None);
    // At 2 Hz almost any frequency is near some alias.
    assert_eq!(clock_remark(&line(0.4, 0.001), 0.5), None);
}

#[test]
fn a_line_in_a_recording_gives_the_clock_away() {
    let n = 30_000;
    let hum = (0..n).map(|i| 50.0 * (TAU * 124.65 * i as f64 * 1e-3).sin());
    let rate: Vec<f64> = noise(0.01, 7, 1e-3, n).iter().zip(hum).map(|(r, h)| r + h).collect();
    let text = told(vec![("time_s", stamps(1e-3, n)), ("rate_deg_h", rate.clone())], None);
    says(&text, &["the sample clock is off by 3.9 %: the true rate is 962.7 Hz, not 1000 Hz"]);
    // The same by the true clock: the line stands at 120 Hz, and nothing is said.
    let true_s = 124.65 / 120.0 * 1e-3;
    let text = told(vec![("time_s", stamps(true_s, n)), ("rate_deg_h", rate)], None);
    keeps_quiet(&text, &["sample clock is off"]);
    says(&text, &["120 Hz, amplitude"]);
}

#[test]
fn three_axes_may_show_the_earth() {
    assert!(earth(&[11.0, 9.0, 5.0]).is_some());
    assert_eq!(earth(&[11.0, 9.0, 8.0]), None);
    assert_eq!(earth(&[15.041]), None);
    let axis = |mean: f64, seed| noise(0.01, seed, 0.1, 6000).iter().map(|r| r + mean).collect::<Vec<_>>();
    let text = told(
        vec![
            ("time_s", stamps(0.1, 6000)),
            ("rate_x_deg_h", axis(11.48, 8)),
            ("rate_y_deg_h", axis(9.19, 9)),
            ("rate_z_deg_h", axis(1.25, 10)),
        ],
        None,
    );
    says(&text, &["Earth rate The mean vector of the three axes has a length of 14.7"]);
}

#[test]
fn a_table_held_at_levels_supports_the_scale_factor() {
    let table: Vec<f64> = (0..220).map(|i| f64::from(i % 11 - 5) * 20.0).collect();
    let counts: Vec<f64> = table.iter().map(|r| -26_000.0 * r + 100.0).collect();
    let text = told(vec![("table_rate_deg_s", table.clone()), ("gyro_raw_counts", counts)], None);
    says(
        &text,
        &[
            "rows are counted (220)",
            "held at 11 rates from -100 to 100 deg/s, both signs",
            "`gyro_raw_counts` follows it: correlation -1.00000, slope -26000 count per 1 deg/s",
            "`gyro_raw_counts` looks like a gyro output in counts",
            "static test No: the table moves",
        ],
    );
    let one_sign: Vec<f64> = table.iter().map(|r| r.abs()).collect();
    says(&told(vec![("table_rate_deg_s", one_sign), ("rate_deg_s", table)], None), &["one sign only"]);
}

#[test]
fn levels_are_told_from_a_sweep() {
    let facts = |values: Vec<f64>| {
        let mut levels = LevelFinder::default();
        values.chunks(1000).for_each(|c| levels.push(c));
        levels.finish(false).unwrap().levels.len()
    };
    // 200 000 samples: more than are kept.
    let steps = (0..200_000).map(|i| f64::from(i / 10_000) * 5.0 + 1e-4 * f64::from(i % 7)).collect();
    assert_eq!(facts(steps), 20);
    let sweep = (0..20_000).map(|i| 100.0 * (f64::from(i) * 1e-2).sin()).collect();
    assert_eq!(facts(sweep), 0);
    assert_eq!(facts(vec![3.0; 50]), 1);
    assert_eq!(LevelFinder::default().finish(true), None);
}

#[test]
fn what_cannot_be_used_is_said_and_does_no_harm() {
    let n = 2000;
    let text = told(
        vec![
            ("rate_deg_h", noise(0.1, 11, 0.1, n)),
            ("temp_degC", vec![f64::NAN; n]),
            ("reset", vec![0.0; n]),
        ],
        None,
    );
    says(
        &text,
        &[
            "`temp_degC`: no values.",
            "rows are counted (2 000). Give --sample-rate HZ",
            "static test No: the sample interval is unknown.",
            "`reset` never changes.",
        ],
    );
    keeps_quiet(&text, &["N ="]);
    let text = told(vec![("rate_deg_h", noise(0.1, 11, 0.1, n))], Some(10.0));
    says(&text, &["The given sample rate, 10 Hz", "200 s is less than the required 10 h"]);
    let n = angle_random_walk(&text);
    assert!((n / 0.1 - 1.0).abs() < 0.1, "{n}");
    // Rows share their stamps without any regularity: no rate follows from them.
    let coarse: Vec<f64> = (0..2000u32)
        .scan(0.0, |t, i| {
            *t += f64::from(u32::from(i.wrapping_mul(2_654_435_761) >> 20 < 400)) * f64::from(1 + i % 3);
            Some(*t)
        })
        .collect();
    let text = told(vec![("time_s", coarse), ("rate_deg_h", noise(0.1, 11, 0.1, 2000))], None);
    says(
        &text,
        &["The time column cannot be used: `time_s`: 90 % of the timestamps equal", "rows are counted"],
    );
}

#[test]
fn a_guessed_unit_and_a_missing_gyro_are_said() {
    let n = 1000;
    let text = told(vec![("time_s", stamps(1.0, n)), ("gyro_z", noise(0.1, 12, 1.0, n))], None);
    says(&text, &["gyro_z rate deg/h?", "The unit of `gyro_z` is not stated and was assumed."]);
    let text = told(vec![("time_s", stamps(1.0, n)), ("phase_s", noise(0.1, 12, 1.0, n))], None);
    says(&text, &["No column was recognised as a gyro output", "tests None: no gyro output was recognised."]);
}

#[test]
fn gaps_are_counted_and_located() {
    let mut time = stamps(0.1, 3000);
    time.iter_mut().skip(1500).for_each(|t| *t += 2.0);
    let text = told(vec![("time_s", time), ("rate_deg_h", noise(0.1, 13, 0.1, 3000))], None);
    says(
        &text,
        &["gaps: 1 (samples missing: 20)", "row 1501, 152 s:", "Gaps split the samples into 2 stretches"],
    );
}

#[test]
fn a_mean_that_was_taken_out_is_noticed() {
    let mut rate = noise(0.1, 14, 1.0, 4000);
    let mean = rate.iter().sum::<f64>() / 4000.0;
    rate.iter_mut().for_each(|r| *r -= mean);
    says(
        &told(vec![("time_s", stamps(1.0, 4000)), ("rate_deg_h", rate)], None),
        &["the bias cannot be determined"],
    );
}

#[test]
fn small_statistics_follow_their_definitions() {
    assert_eq!(runs(&[0.0, 5.0, 10.0, 9.5, 10.0, 4.0, 0.0, 8.0]), (2, 1));
    assert_eq!(runs(&[f64::NAN]), (0, 0));
    let s = scatter(&[1.0, -1.0, 1.0, -1.0]).unwrap();
    assert!(
        (s.deviation - (4.0f64 / 3.0).sqrt()).abs() < 1e-12 && (s.of_steps - 2.0f64.sqrt()).abs() < 1e-12
    );
    let mut follow = LinearFit::default();
    follow.push(&[1.0, 2.0, f64::NAN, 3.0], &[5.0, 3.0, 0.0, 1.0]);
    assert_eq!(follow.finish(), Some((-1.0, -2.0)));
    let mut quietest = Quietest::new(1.0);
    quietest.push(&[5.0; 64], true);
    assert_eq!(quietest.finish(), None);
    quietest.push(&(0..64).map(|i| f64::from(i % 2)).collect::<Vec<_>>(), true);
    assert!((quietest.finish().unwrap() - (8.0f64 / 31.0).sqrt()).abs() < 1e-12);
}
