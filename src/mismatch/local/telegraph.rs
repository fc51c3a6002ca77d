//! Jumps back and forth between two levels.
//!
//! A two-level path is sought in averages of several lengths and judged by generalised least squares under the noise of
//! the hypothesis, less what it takes to write the path down. A process with the same spectrum gains by its spectrum
//! alone; only what the path gains beyond that tells two levels from it.

use super::two_level::{Chain, path_cost};
use crate::effect::{EFFECTS, Model, SpectralLook, SpectrumAct, averages};
use crate::estimate::chi_square_quantile;
use crate::mismatch::candidates::Tried;
use crate::mismatch::hypothesis::{Normal, kept, part_modes};
use crate::mismatch::noise_fit::{self, SpectrumIn};
use crate::mismatch::problem::Problem;
use crate::numeric::cosine::{dct2, inverse_dct2};

/// Averages that are looked at in one length, at most and at least.
const MOST: usize = 65_536;
const LEAST: usize = 64;
/// Jumps below which a course is none of this kind: a level that leaves and returns has two.
const JUMPS: usize = 3;
/// Turns of Baum-Welch.
const TURNS: usize = 25;
/// Turns of path and background.
const ROUNDS: usize = 3;

/// Jumps between two levels.
#[derive(Debug, Clone, PartialEq)]
pub struct Telegraph {
    /// 0 and 1 for the two levels less their mean, for each sample.
    pub path: Vec<f64>,
    /// Between the levels, deg/h.
    pub amplitude_deg_h: f64,
    /// Its 95 % interval.
    pub amplitude_ci95: [f64; 2],
    /// Mean time at a level, s.
    pub mean_dwell_s: f64,
    /// Its 95 % interval.
    pub dwell_ci95: [f64; 2],
    /// Jumps.
    pub jumps: usize,
    /// Gain of log-likelihood less the cost of the path.
    pub gain: f64,
    /// Gain of the best single process in its place: a Markov process, or flicker or random walk set free.
    pub rival_gain: f64,
    /// Amplitude and the two rates of change.
    pub parameters: usize,
    /// Bound of the probability of such a gain under the hypothesis, or under the rival where that explains more.
    pub p_value: f64,
}

/// What does not change while paths are tried.
struct Ground<'a> {
    problem: &'a Problem,
    tried: &'a Tried,
    residual: Vec<f64>,
    inverse: Vec<f64>,
    columns: Vec<(Vec<f64>, f64)>,
    /// Share of each mode that is slow noise.
    slow: Vec<f64>,
    /// Variance of a sample's white noise, (deg/h)².
    white: f64,
}

struct Judged {
    path: Vec<bool>,
    amplitude: f64,
    deviation: f64,
    gain: f64,
    chain: Chain,
    averaged: usize,
    looks: f64,
}

impl<'a> Ground<'a> {
    fn new(problem: &'a Problem, tried: &'a Tried) -> Ground<'a> {
        let scene = &problem.scenes.full;
        let courses = &tried.hypothesis.courses;
        let mut columns: Vec<(Vec<f64>, f64)> =
            kept(scene, courses).into_iter().map(|n| (n.modes.clone(), n.deviation)).collect();
        for part in part_modes(scene, courses) {
            columns.extend(part.free.into_iter().chain(part.beside).map(|c| (c, f64::INFINITY)));
        }
        let powers = &tried.fit.powers;
        let mut high: Vec<f64> = powers[powers.len() / 2..].to_vec();
        let white = super::median(&mut high);
        let slow = powers.iter().map(|p| if p.is_finite() { (1.0 - white / p).max(0.0) } else { 0.0 });
        Ground {
            problem,
            tried,
            residual: inverse_dct2(&tried.fit.mean.residual),
            inverse: powers.iter().map(|p| 1.0 / p).collect(),
            columns,
            slow: slow.collect(),
            white,
        }
    }

    /// The best estimate of the slow noise under a path, deg/h.
    fn background(&self, course: &[f64]) -> Vec<f64> {
        let rest: Vec<f64> = self.residual.iter().zip(course).map(|(r, c)| r - c).collect();
        let modes: Vec<f64> = dct2(&rest).iter().zip(&self.slow).map(|(x, s)| x * s).collect();
        inverse_dct2(&modes)
    }

    /// Amplitude, its deviation and the gain of a path.
    fn amplitude(&self, path: &[bool]) -> (f64, f64, f64) {
        let series: Vec<f64> = path.iter().map(|p| f64::from(u8::from(*p))).collect();
        let modes = self.problem.scenes.full.transform(&series);
        let data = &self.tried.fit.mean.residual;
        let old: Vec<(&[f64], f64)> = self.columns.iter().map(|(c, d)| (c.as_slice(), *d)).collect();
        let before = Normal::new(&old, data, &self.inverse);
        let left = before.solve().2;
        let (c, covariance, after) = before.with(&old, &[&modes], data, false, &self.inverse).solve();
        let at = old.len();
        let variance = if covariance.nrows() > at { covariance[(at, at)] } else { 0.0 };
        (c.get(at).copied().unwrap_or(0.0), variance.max(0.0).sqrt(), 0.5 * (left - after))
    }

    /// Paths from one start in averages of `m`; the best by gain less cost.
    fn search(&self, m: usize, start: Chain) -> Option<Judged> {
        let n = self.residual.len();
        let mut background = vec![0.0; n];
        let mut chain = start;
        let mut best: Option<Judged> = None;
        for _ in 0..ROUNDS {
            let rest: Vec<f64> = self.residual.iter().zip(&background).map(|(r, b)| r - b).collect();
            let values = averages(&rest, m);
            let floor = 0.5 * self.white / m as f64;
            for _ in 0..TURNS {
                chain = chain.improved(&values, floor);
            }
            let short = chain.path(&values);
            let (cost, jumps) = path_cost(&short);
            if jumps < JUMPS {
                break;
            }
            let path: Vec<bool> =
                (0..n).map(|i| short.get((i / m).min(short.len() - 1)).copied().unwrap_or(false)).collect();
            let (amplitude, deviation, gain) = self.amplitude(&path);
            let gain = gain - cost;
            let course: Vec<f64> = path.iter().map(|p| amplitude * f64::from(u8::from(*p))).collect();
            let improved = best.as_ref().is_none_or(|b| gain > b.gain + 0.1);
            if improved {
                let looks = (values.len() as f64).ln();
                best = Some(Judged { path, amplitude, deviation, gain, chain, averaged: m, looks });
            } else {
                break;
            }
            if self.slow.iter().all(|s| *s < 0.02) {
                break;
            }
            background = self.background(&course);
        }
        best
    }
}

/// Looks for a telegraph signal in the residual of a hypothesis.
pub fn telegraph(problem: &Problem, tried: &Tried) -> Option<Telegraph> {
    let ground = Ground::new(problem, tried);
    let n = ground.residual.len();
    let mut m = n.div_ceil(MOST).max(1);
    let mut found: Vec<Judged> = vec![];
    let mut lengths = 0.0f64;
    while n / m >= LEAST {
        lengths += 1.0;
        let values = averages(&ground.residual, m);
        for start in starts(&values, ground.white / m as f64) {
            found.extend(ground.search(m, start));
        }
        m *= 4;
    }
    let best = found.into_iter().filter(|j| j.gain > 0.0).max_by(|a, b| a.gain.total_cmp(&b.gain))?;
    let jumps = best.path.windows(2).filter(|w| w[0] != w[1]).count();
    let rival_gain = rival(problem, tried);
    // A path and its numbers written down in `gain` nats less than the noise needs has a probability below e^−gain
    // (Kraft); each of the three numbers is written to its own precision, ½ ln M nats.
    let beyond = best.gain - 1.5 * best.looks;
    let log_p = lengths.ln() - beyond;
    let log_rival = rival_gain - best.gain;
    let p_value = log_p.max(log_rival).min(0.0).exp().max(1e-300);
    let step = best.averaged as f64 * problem.drivers.dt_s;
    let mean_dwell_s = dwell(&best.chain, step);
    let share = best.path.iter().filter(|p| **p).count() as f64 / n as f64;
    // Of J jumps in a fixed time, by the χ² law of a Poisson count.
    let count = jumps as f64;
    let longest = 2.0 * count / chi_square_quantile(0.025, 2.0 * count);
    let shortest = 2.0 * count / chi_square_quantile(0.975, 2.0 * count + 2.0);
    let half = 1.959_964 * best.deviation;
    let size = best.amplitude.abs();
    Some(Telegraph {
        path: best.path.iter().map(|p| f64::from(u8::from(*p)) - share).collect(),
        amplitude_deg_h: size,
        amplitude_ci95: [(size - half).max(0.0), size + half],
        mean_dwell_s,
        dwell_ci95: [mean_dwell_s * shortest, mean_dwell_s * longest],
        jumps,
        gain: best.gain,
        rival_gain,
        parameters: 3,
        p_value,
    })
}

/// Levels at the quarters and at the tenths of the values, with long and short dwells.
fn starts(values: &[f64], white: f64) -> Vec<Chain> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted[((sorted.len() - 1) as f64 * share) as usize];
    let mut out = vec![];
    for (low, high) in [(0.25, 0.75), (0.05, 0.6), (0.4, 0.95)] {
        for steps in [8.0, 100.0] {
            let levels = [at(low), at(high)];
            if levels[1] > levels[0] {
                let variance = white.max(0.1 * (levels[1] - levels[0]).powi(2));
                out.push(Chain { levels, variance, change: [1.0 / steps; 2] });
            }
        }
    }
    out
}

/// Mean time at a level from the probabilities of change in a step.
fn dwell(chain: &Chain, step_s: f64) -> f64 {
    let [a, b] = chain.change;
    let sum = (a + b).clamp(1e-12, 0.999);
    // Changes within a step go unseen: rates follow from the relaxation of the chain.
    let rate = -(1.0 - sum).ln() / (step_s * sum);
    0.5 * (1.0 / (rate * a) + 1.0 / (rate * b))
}

/// Gain of the best single process: every spectral effect that adds to low frequencies, and B and K set free.
fn rival(problem: &Problem, tried: &Tried) -> f64 {
    let scene = &problem.scenes.full;
    let observed = scene.observed(&tried.fit.mean.residual);
    let before = tried.fit.noise.log_likelihood;
    let look = SpectralLook {
        bins: &scene.bins,
        observed: &observed,
        expected: &tried.fit.densities,
        lattice_arcsec: problem.scenes.lattice_arcsec,
    };
    let mut best = 0.0f64;
    for effect in EFFECTS.iter().filter(|e| ["markov_long", "markov_short"].contains(&e.kind())) {
        let Model::Spectrum(spectrum) = effect.model() else { continue };
        if spectrum.act() != SpectrumAct::Adds {
            continue;
        }
        let bounds = spectrum.bounds(&look);
        for start in spectrum.starts(&look) {
            let mut noise = tried.hypothesis.noise.clone();
            let fitted = start.iter().zip(&bounds).map(|(x, (low, high))| x.clamp(*low, *high)).collect();
            noise.spectra.push(SpectrumIn { effect: *effect, fitted, stated: false });
            best = best.max(noise_fit::fit(&mut noise, scene, &observed).log_likelihood - before);
        }
    }
    for i in 1..3 {
        for level in [1.0, 6.0, 33.0, 200.0] {
            let mut noise = tried.hypothesis.noise.clone();
            let beside = (noise.base[0] * 0.01).max(1e-9);
            noise.base[i] = noise.base[i].max(beside) * level;
            noise.freed[i] = true;
            best = best.max(noise_fit::fit(&mut noise, scene, &observed).log_likelihood - before);
        }
    }
    best
}
