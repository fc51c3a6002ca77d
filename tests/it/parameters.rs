//! `sagnac export`: parameters for other programs. Each is simulated as its program does it, by a formula of its own here, and the
//! analysis of the simulation gives the result back.

use crate::support::synthetic::white;
use crate::support::{measurand, result, sagnac};
use serde_json::Value;
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;
use std::sync::OnceLock;

/// rad/s in deg/h.
const RAD_S: f64 = 180.0 / PI * 3600.0;
/// Samples of a recording, at 1 Hz.
const SAMPLES: u64 = 40_000;

/// Independent noise of unit variance: sequences of one seed are told apart by `stream`.
fn noise(seed: u64, stream: u64, i: u64) -> f64 {
    white(1000 * seed + stream, i)
}

/// Writes a recording in rad/s at 1 Hz and analyses it.
fn analysed(folder: &Path, name: &str, rate_rad_s: &[f64]) -> Value {
    let mut text = String::from("time_s,rate\n");
    for (i, rate) in rate_rad_s.iter().enumerate() {
        let _ = writeln!(text, "{i},{rate:e}");
    }
    std::fs::write(folder.join(format!("{name}.csv")), text).unwrap();
    let args = ["analyze", &format!("{name}.csv"), "--rate", "rate", "--unit", "rad/s", "--out", name];
    let said = sagnac(folder, &args);
    assert_eq!(said.code, 0, "{said:?}");
    result(&folder.join(name))
}

/// White noise of a deviation per sample, and a bias: x' = kept·x + step·w.
fn with_bias(seed: u64, deviation: f64, kept: f64, step: f64) -> Vec<f64> {
    let mut bias = 0.0;
    (0..SAMPLES)
        .map(|i| {
            bias = kept * bias + step * noise(seed, 1, i);
            bias + deviation * noise(seed, 2, i)
        })
        .collect()
}

/// Flicker noise of coefficient `b` by the fractional difference of white noise (Kasdin, Proc. IEEE 83(5) 1995), its density
/// b²/(2πf), and white noise beside it.
fn with_flicker(seed: u64, deviation: f64, b: f64, terms: usize) -> Vec<f64> {
    let mut filter = vec![1.0];
    for k in 1..terms {
        filter.push(filter[k - 1] * (k as f64 - 1.5) / k as f64);
    }
    let mut out: Vec<f64> = Vec::with_capacity(terms);
    for i in 0..terms {
        let past: f64 = (1..=i).map(|k| filter[k] * out[i - k]).sum();
        out.push(b * noise(seed, 3, i as u64) - past);
    }
    out.iter().enumerate().map(|(i, f)| f + deviation * noise(seed, 4, i as u64)).collect()
}

/// Results whose parameters are exported: with a random walk, with a Markov process, with flicker noise.
struct Units {
    folder: tempfile::TempDir,
    walk: Value,
    markov: Value,
    flicker: Value,
}

fn units() -> &'static Units {
    static UNITS: OnceLock<Units> = OnceLock::new();
    UNITS.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        // 0.1 deg/√h, 0.6 deg/h/√h.
        let walk = with_bias(1, 6.0 / RAD_S, 1.0, 0.6 / 60.0 / RAD_S);
        // 10 deg/h over 200 s.
        let kept = (-1.0_f64 / 200.0).exp();
        let markov = with_bias(2, 6.0 / RAD_S, kept, 10.0 * (1.0 - kept * kept).sqrt() / RAD_S);
        let flicker = with_flicker(3, 3.0 / RAD_S, 3.0 / RAD_S, 12_000);
        let at = folder.path();
        Units {
            walk: analysed(at, "walk", &walk),
            markov: analysed(at, "markov", &markov),
            flicker: analysed(at, "flicker", &flicker),
            folder,
        }
    })
}

/// The file of a target for a unit.
fn exported(unit: &str, target: &str, more: &[&str]) -> String {
    let said = sagnac(units().folder.path(), &[&["export", unit, "--for", target][..], more].concat());
    assert_eq!((said.code, said.err.as_str()), (0, ""), "{said:?}");
    said.out
}

/// The number behind a name and what separates it; in a comment only where the name begins one.
fn number(text: &str, name: &str) -> f64 {
    let values = text.lines().filter(|line| name.starts_with('#') || !line.starts_with(['#', '%']));
    let found = values.filter_map(|line| line.split_once(name)).next();
    let (_, rest) = found.unwrap_or_else(|| panic!("no `{name}` in\n{text}"));
    let end = rest.find(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c))).unwrap_or(rest.len());
    rest[..end].parse().unwrap_or_else(|e| panic!("{e} behind `{name}` in\n{text}"))
}

fn value(of: &Value, id: &str) -> f64 {
    measurand(of, id)["value"].as_f64().unwrap_or_else(|| panic!("{id}: {}", measurand(of, id)))
}

/// The second result has the value of the first within its own interval, widened from 95 % to 99.9 %.
fn same(first: &Value, again: &Value, id: &str) {
    let (old, row) = (value(first, id), measurand(again, id));
    let end = |name: &str| row["interval"][name].as_f64().unwrap_or_else(|| panic!("{id}: {row}"));
    let now = value(again, id);
    let (low, high) = (now + 1.68 * (end("low") - now), now + 1.68 * (end("high") - now));
    assert!(low <= old && old <= high, "{id}: {old} is not within {low} … {high}");
}

#[test]
fn kalibr_gives_the_result_back() {
    let text = exported("walk", "kalibr", &[]);
    assert_eq!(number(&text, "update_rate: "), 1.0);
    let dt = 1.0 / number(&text, "update_rate: ");
    // As Kalibr discretises: σ/√dt and σ_b √dt.
    let deviation = number(&text, "gyroscope_noise_density: ") / dt.sqrt();
    let step = number(&text, "gyroscope_random_walk: ") * dt.sqrt();
    let again = analysed(units().folder.path(), "kalibr", &with_bias(11, deviation, 1.0, step));
    same(&units().walk, &again, "angle_random_walk");
    same(&units().walk, &again, "rate_random_walk");
}

#[test]
fn autopilots_give_the_result_back() {
    for (target, white_name, walk_name, seed) in [
        ("px4", "EKF2_GYR_NOISE\t", "EKF2_GYR_B_NOISE\t", 12),
        ("ardupilot", "EK3_GYRO_P_NSE,", "EK3_GBIAS_P_NSE,", 13),
    ] {
        let text = exported("walk", target, &["--step-rate", "1"]);
        // Both filters: variance of the angle of a step (dt·noise)², of the bias (dt·walk)².
        let dt = 1.0;
        let (angle, drift) = (dt * number(&text, white_name), dt * number(&text, walk_name));
        let again = analysed(units().folder.path(), target, &with_bias(seed, angle / dt, 1.0, drift));
        same(&units().walk, &again, "angle_random_walk");
        same(&units().walk, &again, "rate_random_walk");
        // The values hold for one step only: at its own they are larger by the root of the ratio.
        let own = number(&exported("walk", target, &[]), white_name) / number(&text, white_name);
        let steps = if target == "px4" { 0.010_f64 } else { 0.012 };
        assert!((own * steps.sqrt() - 1.0).abs() < 1e-5, "{target}: {own}");
    }
}

#[test]
fn imu_utils_gives_the_white_noise_back() {
    let text = exported("walk", "imu_utils", &[]);
    let (n, k) = (value(&units().walk, "angle_random_walk"), value(&units().walk, "rate_random_walk"));
    // σ²(τ) = N²/τ + K²τ/3, τ in hours; the deviation at 1 s and 1 Hz is that of a sample.
    let at = |tau_s: f64| ((n * n / (tau_s / 3600.0)) + k * k * tau_s / 3600.0 / 3.0).sqrt() / RAD_S;
    let gyr_n = number(&text, "gyr_n: ");
    assert!(gyr_n >= at(1.0) * (1.0 - 1e-5) && gyr_n < 1.02 * at(1.0), "{gyr_n} {}", at(1.0));
    let lowest = (0..13).map(|i| at(f64::from(1 << i))).fold(f64::INFINITY, f64::min);
    let gyr_w = number(&text, "gyr_w: ");
    assert!((gyr_w / lowest - 1.0).abs() < 0.02, "{gyr_w} {lowest}");
    let again = analysed(units().folder.path(), "imu_utils", &with_bias(14, gyr_n, 0.0, 0.0));
    same(&units().walk, &again, "angle_random_walk");
}

#[test]
fn simulators_with_one_process_give_it_back() {
    let dt = 1.0_f64;
    let sdf = exported("markov", "gazebo", &[]);
    let (sigma, time) =
        (number(&sdf, "<dynamic_bias_stddev>"), number(&sdf, "<dynamic_bias_correlation_time>"));
    // gz-sensors: the step of the bias is √(σ_b² τ/2 (1 − e^(−2dt/τ))).
    let gazebo = (
        number(&sdf, "<stddev>"),
        (-dt / time).exp(),
        (sigma * sigma * time / 2.0 * (1.0 - (-2.0 * dt / time).exp())).sqrt(),
    );
    let python = exported("markov", "gnss-ins-sim", &[]);
    let first = |name: &str| number(&python, &format!("'{name}': np.array(["));
    // gnss-ins-sim: arw/√dt; a = 1 − dt/T, b = dt·stability, both in rad.
    let gnss = (
        first("gyro_arw") / 60.0 * PI / 180.0 / dt.sqrt(),
        1.0 - dt / first("gyro_b_corr"),
        dt * first("gyro_b_stability") / RAD_S,
    );
    let matlab = exported("markov", "navego", &[]);
    let first = |name: &str| number(&matlab, &format!("imu.{name} = ["));
    // NaveGo: imu_si_errors, then a1 = e^(−dt/T), a2 = gb_dyn √(1 − e^(−2dt/T)).
    let kept = (-dt / first("gb_corr")).exp();
    let navego = (
        first("arw") / 60.0 * PI / 180.0 / dt.sqrt(),
        kept,
        first("gb_dyn") * PI / 180.0 * (1.0 - kept * kept).sqrt(),
    );
    for (name, seed, (deviation, kept, step)) in
        [("gazebo", 21, gazebo), ("gnss-ins-sim", 22, gnss), ("navego", 23, navego)]
    {
        let again = analysed(units().folder.path(), name, &with_bias(seed, deviation, kept, step));
        for id in ["angle_random_walk", "markov_sigma", "markov_correlation_time"] {
            same(&units().markov, &again, id);
        }
    }
}

#[test]
fn the_walk_of_navego_holds_for_its_rate() {
    let at = |rate: &str| number(&exported("walk", "navego", &["--step-rate", rate]), "imu.arrw = [");
    // noise_rrw adds arrw·dt·w in each step: K√dt.
    let k = value(&units().walk, "rate_random_walk") / 60.0 / RAD_S;
    for (rate, dt) in [("1", 1.0_f64), ("100", 0.01)] {
        assert!((at(rate) * dt / (k * dt.sqrt()) - 1.0).abs() < 1e-5, "{rate}");
    }
}

#[test]
fn matlab_and_a_kalman_filter_give_flicker_noise_back() {
    let text = exported("flicker", "matlab", &[]);
    let first = |name: &str| number(&text, &format!("'{name}', ["));
    assert!(
        text.contains("'NoiseType', 'double-sided'") && text.contains("(terms - 1.5) ./ terms"),
        "{text}"
    );
    let rate = with_flicker(31, first("NoiseDensity"), first("BiasInstability"), 12_000);
    let again = analysed(units().folder.path(), "matlab", &rate);
    same(&units().flicker, &again, "bias_instability");
    // Flicker noise of instants has more at half the sample rate than that of means: 1/2 against 0.271, in B² over the rate.
    let (n, b) = (value(&units().flicker, "angle_random_walk"), value(&units().flicker, "bias_instability"));
    let more = value(&again, "angle_random_walk").powi(2) - n * n;
    assert!(more > 0.0 && more < 0.23 * b * b / 3600.0, "{more}");

    let filter: Value = serde_json::from_str(&exported("flicker", "kalman", &[])).unwrap();
    let axis = &filter["axes"][0];
    let names: Vec<&str> = axis["states"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
    assert_eq!(filter["axes"].as_array().unwrap().len(), 1);
    // The random walk is there as an upper limit only: the flicker noise is the other states.
    let kept: Vec<usize> = (0..names.len()).filter(|i| !names[*i].starts_with("random_walk")).collect();
    let matrix = |name: &str| -> Vec<Vec<f64>> {
        let at = |i: &usize, j: &usize| axis[name][i][j].as_f64().unwrap();
        kept.iter().map(|i| kept.iter().map(|j| at(i, j)).collect()).collect()
    };
    let rate = stepped(&matrix("F"), &matrix("Q"), filter["step_s"].as_f64().unwrap(), 32);
    let again = analysed(units().folder.path(), "kalman", &rate);
    same(&units().flicker, &again, "angle_random_walk");
    same(&units().flicker, &again, "bias_instability");
}

/// Rates of a filter: the angle of each step over its length.
fn stepped(f: &[Vec<f64>], q: &[Vec<f64>], step_s: f64, seed: u64) -> Vec<f64> {
    let size = f.len();
    // Cholesky: Q = L Lᵀ.
    let mut l = vec![vec![0.0; size]; size];
    for i in 0..size {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            l[i][j] = if i == j { (q[i][i] - sum).sqrt() } else { (q[i][j] - sum) / l[j][j] };
        }
    }
    assert!(l.iter().flatten().all(|v| v.is_finite()), "a covariance is positive definite");
    // Every process begins at its stationary standard deviation.
    let mut x: Vec<f64> = (0..size)
        .map(|i| {
            let stationary = if i == 0 { 0.0 } else { (q[i][i] / (1.0 - f[i][i] * f[i][i])).sqrt() };
            stationary * noise(seed, 99, i as u64)
        })
        .collect();
    (0..12_000)
        .map(|n| {
            let w: Vec<f64> = (0..size).map(|i| noise(seed, i as u64, n)).collect();
            x[0] = 0.0;
            let next = |i: usize| {
                let moved: f64 = (0..size).map(|j| f[i][j] * x[j]).sum();
                moved + (0..=i).map(|j| l[i][j] * w[j]).sum::<f64>()
            };
            x = (0..size).map(next).collect();
            x[0] / step_s
        })
        .collect()
}

#[test]
fn the_head_says_what_the_form_leaves_and_inflation_covers_it() {
    let plain = exported("flicker", "kalibr", &[]);
    assert!(plain.contains("# left out, for the form has no place for it: Bias instability B"), "{plain}");
    assert!(plain.contains("upper limit, for the recording does not resolve it"), "{plain}");
    let factor = number(&plain, "# times ");
    assert!(factor > 1.2, "{plain}");
    let more = exported("flicker", "kalibr", &["--inflate"]);
    let name = "gyroscope_noise_density: ";
    // The head shows three digits.
    assert!((number(&more, name) / number(&plain, name) / factor - 1.0).abs() < 0.01, "{more}");
    assert!(more.contains("so that σ(τ) is nowhere understated"), "{more}");
    let russian = exported("flicker", "kalibr", &["--lang", "ru"]);
    assert!(russian.contains("# опущено, в форме для этого нет места"), "{russian}");
    assert_eq!(number(&russian, name), number(&plain, name));
}

#[test]
fn a_file_is_written_once_and_wrong_calls_are_refused() {
    let at = units().folder.path();
    let said = sagnac(at, &["export", "walk", "--for", "px4", "--out", "walk.params", "--quiet"]);
    assert_eq!((said.code, said.out.as_str()), (0, "walk.params\n"), "{said:?}");
    assert!(std::fs::read_to_string(at.join("walk.params")).unwrap().contains("1\t1\tEKF2_GYR_NOISE\t"));
    for (args, why) in [
        (&["export", "walk", "--for", "gazebo", "--out", "walk.params"][..], "walk.params"),
        (&["export", "walk", "--for", "excel"], "excel"),
        (&["export", "walk", "--for", "kalibr", "--channels", "roll"], "no such channel: roll"),
        (&["export", "walk", "--for", "kalibr", "--step-rate", "0"], "above 0 Hz"),
        (&["export", "nowhere", "--for", "kalibr"], "nowhere"),
    ] {
        let said = crate::support::sagnac_as_typed(at, args, &[]);
        assert!(said.code == 2 && said.err.contains(why) && said.out.is_empty(), "{args:?}: {said:?}");
    }
}
