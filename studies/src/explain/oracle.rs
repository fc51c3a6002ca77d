//! What a fit reaches that is given the kind, the true shape and the true noise: widths of intervals, removed variance.

use super::case::{Case, Left, Realisation};
use super::claim::Claim;
use super::effect::Process;
use super::modes::{cosine_modes, mode_frequency, sinc};
use super::noise::{markov_variance, resonance_variance};
use super::strength::{Spectrum, solve};
use std::f64::consts::TAU;

/// Figures of the fit given the truth.
#[derive(Clone, Debug, Default)]
pub struct Told {
    /// Parameter and the width of its 95 % interval.
    pub widths: Vec<(&'static str, f64)>,
    /// Share of the contribution's variance that the fit removes.
    pub removed: Option<f64>,
}

/// Both sides of a normal 95 % interval in standard deviations.
const WIDTH: f64 = 2.0 * 1.959_964;

/// Parameters in which the course is linear.
const LINEAR: &[&str] = &[
    "coefficient_deg_h_per_degC_per_min",
    "loop_width_deg_h",
    "slope_deg_h_per_h",
    "step_deg_h",
    "amplitude_deg_h",
    "asymmetry_ppm",
    "cubic_ppm_at_max",
    "coefficient_ppm_per_degC",
    "misalignment_mrad",
    "coefficient_deg_h_per_V",
];

fn parameter(left: &Left, name: &str) -> Option<f64> {
    left.effect.parameters.iter().find(|(n, _)| *n == name).map(|(_, v)| *v)
}

/// Derivatives of the course by its parameters; the unnamed ones must be fitted too.
fn tangents(case: &Case, left: &Left) -> Vec<(&'static str, Vec<f64>)> {
    let s = &case.setting;
    let course = &left.effect.course;
    match left.effect.kind.as_str() {
        "line" => {
            let (Some(f), Some(size)) = (parameter(left, "frequency_hz"), parameter(left, "amplitude_deg_h"))
            else {
                return Vec::new();
            };
            // The phase is read off the course itself.
            let seen = size * sinc(f * s.interval_s());
            let dot = |g: &dyn Fn(f64) -> f64| {
                s.time_s.iter().zip(course).map(|(&t, y)| y * g(TAU * f * t)).sum::<f64>() * 2.0
                    / s.rows as f64
            };
            let phase = (-dot(&f64::sin)).atan2(dot(&f64::cos));
            let wave = |g: &dyn Fn(f64) -> f64| s.time_s.iter().map(|t| g(*t)).collect::<Vec<f64>>();
            vec![
                ("amplitude_deg_h", wave(&|t| seen / size * (TAU * f * t + phase).cos())),
                ("frequency_hz", wave(&|t| -seen * TAU * t * (TAU * f * t + phase).sin())),
                ("", wave(&|t| -seen * (TAU * f * t + phase).sin())),
            ]
        }
        "warmup_exponential" => {
            let Some(time_s) = parameter(left, "time_constant_s") else { return Vec::new() };
            let Some(size) = parameter(left, "amplitude_deg_h") else { return Vec::new() };
            let change = s.time_s.iter().zip(course).map(|(t, y)| y * t / (time_s * time_s)).collect();
            vec![("amplitude_deg_h", course.iter().map(|y| y / size).collect()), ("time_constant_s", change)]
        }
        "diurnal" | "earth_rate_projection" | "table_harmonic" => Vec::new(),
        _ => LINEAR
            .iter()
            .filter_map(|name| Some((*name, parameter(left, name)?)))
            .map(|(name, value)| (name, course.iter().map(|y| y / value).collect()))
            .collect(),
    }
}

/// Standard deviations of linear parameters, columns of the claim fitted beside them under their priors.
fn deviations(case: &Case, tangents: &[Vec<f64>], lambda: &[f64]) -> Vec<f64> {
    let columns = case.setting.free_columns();
    let modes: Vec<(Vec<f64>, f64)> = tangents
        .iter()
        .map(|t| (cosine_modes(t)[1..].to_vec(), 0.0))
        .chain(columns.iter().map(|(c, sd)| (cosine_modes(c)[1..].to_vec(), sd.powi(-2))))
        .collect();
    let m = modes.len();
    let product =
        |a: &[f64], b: &[f64]| a.iter().zip(b).zip(lambda).map(|((a, b), l)| a * b / l).sum::<f64>();
    let information: Vec<Vec<f64>> = (0..m)
        .map(|i| {
            (0..m)
                .map(|j| product(&modes[i].0, &modes[j].0) + if i == j { modes[i].1 } else { 0.0 })
                .collect()
        })
        .collect();
    // Unit scale first: the parameters differ by many orders of magnitude.
    let scale: Vec<f64> = (0..m).map(|i| information[i][i].sqrt().max(1e-300)).collect();
    let unit: Vec<Vec<f64>> =
        (0..m).map(|i| (0..m).map(|j| information[i][j] / (scale[i] * scale[j])).collect()).collect();
    (0..tangents.len())
        .map(|i| {
            let e = (0..m).map(|j| f64::from(u8::from(i == j))).collect();
            solve(unit.clone(), e)[i].max(0.0).sqrt() / scale[i]
        })
        .collect()
}

/// Derivatives of the modes' log variance by the logarithms of the effect's parameters, then of N, B, K with priors.
fn spectral(case: &Case, left: &Left, lambda: &[f64]) -> Vec<(&'static str, f64, Vec<f64>, f64)> {
    let s = &case.setting;
    let (n, rate, c) = (s.rows, s.claim.rate_hz, &s.claim);
    let f = |i: usize| mode_frequency(i + 1, n, rate);
    let (d, u) = (&s.departure, &c.uncertainty);
    let stated = [(c.n, d.n_rel, u.n_rel), (c.b, d.b_rel, u.b_rel), (c.k, d.k_rel, u.k_rel)];
    let own = ["N_deg_rt_h", "B_deg_h", "K_deg_h_rt_h"];
    let mut out = Vec::new();
    for (j, (claimed, rel, prior)) in stated.into_iter().enumerate() {
        let total = parameter(left, own[j]);
        let value = total.unwrap_or(claimed * (1.0 + rel));
        let share = if claimed > 0.0 { (value / claimed).powi(2) } else { 0.0 };
        let slope = lambda.iter().enumerate().map(|(i, l)| 2.0 * c.parts(f(i))[j] * share / l).collect();
        let name = if total.is_some() { own[j] } else { "" };
        out.push((name, value, slope, if total.is_some() { 0.0 } else { prior.powi(-2) }));
    }
    let step = 1e-4f64;
    let mut add = |name: &'static str, value: f64, density: &dyn Fn(f64, f64) -> f64| {
        let change =
            |i: usize, l: f64| (density(f(i), 1.0 + step) - density(f(i), 1.0 - step)) / (2.0 * step * l);
        out.push((name, value, lambda.iter().enumerate().map(|(i, &l)| change(i, l)).collect(), 0.0));
    };
    match left.effect.process {
        Some(Process::Markov { sigma, time_s }) => {
            add("sigma_deg_h", sigma, &|f, x| markov_variance(f, rate, sigma * x, time_s));
            add("correlation_time_s", time_s, &|f, x| markov_variance(f, rate, sigma, time_s * x));
        }
        Some(Process::Resonance { sigma, frequency_hz: at, time_s }) => {
            add("amplitude_rms_deg_h", sigma, &|f, x| resonance_variance(f, rate, sigma * x, at, time_s));
            add("coherence_time_s", time_s, &|f, x| resonance_variance(f, rate, sigma, at, time_s * x));
            // The bell is narrow against its frequency: a relative step must stay inside it.
            let narrow = 1.0 / (at * time_s);
            let shift =
                |f: f64, x: f64| resonance_variance(f, rate, sigma, at * (1.0 + (x - 1.0) * narrow), time_s);
            add("frequency_hz", at * narrow, &shift);
        }
        _ => {}
    }
    out
}

/// The fit given the truth, for a case with one effect.
pub fn told(case: &Case, made: &Realisation) -> Told {
    let [left] = case.left_out.as_slice() else { return Told::default() };
    let s = &case.setting;
    let spectrum = Spectrum::of(s);
    let e = &left.effect;
    let lambda = spectrum.truth(s, Some(e));
    if !e.course.is_empty() && e.own_gain.is_none() {
        let tangents = tangents(case, left);
        let vectors: Vec<Vec<f64>> = tangents.iter().map(|(_, t)| t.clone()).collect();
        let sds = deviations(case, &vectors, &lambda);
        let named = tangents.iter().zip(&sds).filter(|((name, _), _)| !name.is_empty());
        let widths = named.map(|((name, _), sd)| (*name, WIDTH * sd)).collect();
        // A shape known but for its size loses the square of the size's relative error.
        let size = deviations(case, std::slice::from_ref(&e.course), &lambda)[0];
        return Told { widths, removed: Some(1.0 - size * size) };
    }
    let slopes = spectral(case, left, &lambda);
    let m = slopes.len();
    let product = |a: &[f64], b: &[f64]| 0.5 * a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let information: Vec<Vec<f64>> = (0..m)
        .map(|i| {
            (0..m)
                .map(|j| product(&slopes[i].2, &slopes[j].2) + if i == j { slopes[i].3 } else { 0.0 })
                .collect()
        })
        .collect();
    let widths = (0..m)
        .filter(|&i| !slopes[i].0.is_empty() && e.own_gain.is_none())
        .map(|i| {
            let unit = (0..m).map(|j| f64::from(u8::from(i == j))).collect();
            let variance = solve(information.clone(), unit)[i].max(0.0);
            (slopes[i].0, WIDTH * slopes[i].1 * variance.sqrt())
        })
        .collect();
    Told { widths, removed: wiener(case, made, left, &lambda) }
}

/// Variance removed by the best linear estimate of a process, from the recording itself.
fn wiener(case: &Case, made: &Realisation, left: &Left, lambda: &[f64]) -> Option<f64> {
    let s = &case.setting;
    let (n, rate) = (s.rows, s.claim.rate_hz);
    let own = made.contributions.first().filter(|c| !c.is_empty())?;
    let density = |f: f64| match left.effect.process {
        Some(Process::Markov { sigma, time_s }) => markov_variance(f, rate, sigma, time_s),
        Some(Process::Resonance { sigma, frequency_hz, time_s }) => {
            resonance_variance(f, rate, sigma, frequency_hz, time_s)
        }
        Some(Process::Terms { n, b, k }) => {
            Claim { n, b, k, rate_hz: rate, ..Claim::default() }.mode_variance(f, [0.0; 3])
        }
        Some(Process::HalfPower { at_1_hz }) => at_1_hz / f.sqrt() * rate,
        None => 0.0,
    };
    let residual: Vec<f64> = made.rate_deg_h.iter().zip(s.known(|_| 0.0)).map(|(y, m)| y - m).collect();
    let (data, truth) = (cosine_modes(&residual), cosine_modes(own));
    let mut rest = 0.0;
    for (i, l) in lambda.iter().enumerate() {
        let k = i + 1;
        let gain = (density(mode_frequency(k, n, rate)) / l).min(1.0);
        rest += (truth[k] - gain * data[k]).powi(2);
    }
    Some(1.0 - rest / truth[1..].iter().map(|v| v * v).sum::<f64>())
}
