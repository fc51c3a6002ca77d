//! A ring-laser unit in two positions: LN-100.

use super::{analyse, assert_digits, curve, value};
use crate::support::real::set;

/// Overlapping Allan deviation in deg/h at octaves of the sample interval: down x, y, z, up x, y, z.
const LN100_CURVES: [[f64; 6]; 13] = [
    [210.0, 173.3, 266.7, 208.7, 177.6, 269.0],
    [67.49, 122.3, 66.33, 65.89, 122.9, 62.67],
    [35.16, 91.06, 34.17, 36.20, 92.63, 33.47],
    [19.80, 16.70, 21.67, 19.26, 16.51, 21.25],
    [13.13, 18.51, 17.14, 13.24, 18.09, 17.35],
    [4.877, 10.61, 4.892, 4.885, 11.29, 4.672],
    [1.597, 2.904, 1.342, 1.580, 2.091, 1.263],
    [1.127, 2.735, 1.124, 1.242, 2.515, 1.270],
    [0.6880, 0.8147, 0.8563, 0.8443, 1.108, 1.098],
    [0.3620, 0.5500, 0.4395, 0.2764, 0.7141, 0.2695],
    [0.1792, 0.2490, 0.2348, 0.1240, 0.1282, 0.1382],
    [0.07533, 0.1381, 0.08782, 0.09949, 0.1538, 0.1313],
    [0.0454, 0.07557, 0.0613, 0.04018, 0.07751, 0.04989],
];

#[test]
fn ln100_shows_the_earth_in_two_positions() {
    let Some(folder) = set("rlg_ln100_two_position") else { return };
    let axes = ["rate_x_deg_h", "rate_y_deg_h", "rate_z_deg_h"];
    let run = |name: &str| analyse(&folder.join(name), Ok("time_s"), &axes, "deg/h", None);
    let (down, up) = (run("x_down.parquet"), run("x_up.parquet"));
    let means = [[-11.9862, 9.125, -0.726], [11.4786, 9.187, 1.250]];
    for (half, (outcome, samples)) in [(&down, 19_216), (&up, 19_217)].into_iter().enumerate() {
        assert_eq!((outcome.record.recording[0].samples, outcome.record.integrity.gaps), (samples, 0));
        for (axis, name) in axes.into_iter().enumerate() {
            let bias = value(outcome, "static_bias", name);
            assert!((bias - means[half][axis]).abs() < 6e-4, "{name}: {bias}");
            let oadev = curve(outcome, name, "oadev");
            for (octave, row) in LN100_CURVES.iter().enumerate() {
                assert_digits(&format!("{name} {octave}"), oadev[&(1 << octave)], row[3 * half + axis], 3);
            }
        }
        // 33 µs rms of the steps are √2 times the jitter of a stamp.
        let jitter = outcome.record.integrity.timestamp_jitter_s.unwrap();
        assert!((jitter * 2f64.sqrt() / 33e-6 - 1.0).abs() < 0.05, "{jitter}");
        // Published to a bin of 0.06 Hz.
        for hz in [9.195, if half == 0 { 29.93 } else { 29.90 }] {
            assert!(outcome.record.lines.iter().any(|l| (l.frequency_hz - hz).abs() < 0.06), "{hz} Hz");
        }
    }
    let x = |outcome| value(outcome, "static_bias", axes[0]);
    assert!((0.5 * (x(&up) - x(&down)) - 11.7324).abs() < 1e-4);
    assert!((0.5 * (x(&up) + x(&down)) + 0.254).abs() < 5e-4);
}
