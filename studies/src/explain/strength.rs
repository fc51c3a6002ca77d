//! Expected gain of log-likelihood by naming what is left out, the claim's nuisances profiled under their priors.
//!
//! In cosine modes a stationary record has independent modes of variance λ(f). With modes of expected square
//! v + r², r what remains of the mean, a claim of variances λ loses ½ Σ [(v + r²)/λ − 1 − ln(v/λ)] against the truth.

use super::claim::Claim;
use super::effect::{Effect, Process, White};
use super::modes::{cosine_modes, mode_frequency};
use super::noise::{markov_variance, quantisation_variance, resonance_variance};
use super::setting::Setting;
use super::stochastic::response;
use std::f64::consts::TAU;

/// The claim in cosine modes.
pub struct Spectrum {
    frequencies: Vec<f64>,
    parts: Vec<[f64; 3]>,
    fixed: Vec<f64>,
    columns: Vec<(Vec<f64>, f64)>,
    /// What the departures of columns' factors add to the mean.
    departed: Vec<f64>,
}

/// Solves a small symmetric system by elimination.
pub fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for i in 0..n {
        let pivot = a[i][i];
        if pivot.abs() < 1e-300 {
            continue;
        }
        for j in i + 1..n {
            let factor = a[j][i] / pivot;
            let row = a[i].clone();
            for (x, y) in a[j].iter_mut().zip(&row) {
                *x -= factor * y;
            }
            b[j] -= factor * b[i];
        }
    }
    for i in (0..n).rev() {
        let rest: f64 = (i + 1..n).map(|j| a[i][j] * b[j]).sum();
        b[i] = if a[i][i].abs() < 1e-300 { 0.0 } else { (b[i] - rest) / a[i][i] };
    }
    b
}

impl Spectrum {
    /// The claim of a setting; mode 0, the free bias, is left out.
    pub fn of(s: &Setting) -> Spectrum {
        let n = s.rows;
        let frequencies: Vec<f64> = (1..n).map(|k| mode_frequency(k, n, s.claim.rate_hz)).collect();
        let free = s.free_columns();
        let by = [s.departure.coefficient, s.departure.scale_ppm];
        let departures: Vec<f64> = match (s.claim.temperature.is_some(), free.len()) {
            (true, _) => by.to_vec(),
            (false, 1) => vec![by[1]],
            _ => Vec::new(),
        };
        let mut departed = vec![0.0; n - 1];
        let mut columns = Vec::new();
        for ((column, sd), departure) in free.into_iter().zip(departures) {
            let modes = cosine_modes(&column)[1..].to_vec();
            departed.iter_mut().zip(&modes).for_each(|(d, m)| *d += departure * m);
            columns.push((modes, sd));
        }
        let c: &Claim = &s.claim;
        Spectrum {
            parts: frequencies.iter().map(|&f| c.parts(f)).collect(),
            fixed: frequencies.iter().map(|&f| c.fixed(f)).collect(),
            frequencies,
            columns,
            departed,
        }
    }

    /// Variances of the modes in truth, with the effect or without.
    pub fn truth(&self, s: &Setting, effect: Option<&Effect>) -> Vec<f64> {
        let rate = s.claim.rate_hz;
        let scale = [s.departure.n_rel, s.departure.b_rel, s.departure.k_rel].map(|r| (1.0 + r).powi(2));
        let at = |(i, p): (usize, &[f64; 3])| {
            let f = self.frequencies[i];
            let mut white = p[0] * scale[0];
            let Some(e) = effect else {
                return white + p[1] * scale[1] + p[2] * scale[2] + self.fixed[i];
            };
            match &e.white {
                Some(White::Factor(factor)) => white *= factor * factor,
                Some(White::Echo { gain, lag }) => {
                    white *= 1.0 + gain * gain + 2.0 * gain * (TAU * f * *lag as f64 / rate).cos();
                }
                _ => {}
            }
            let passed = e.filter.map_or(1.0, |filter| response(filter, f, rate));
            let mut v = (white + p[1] * scale[1]) * passed + p[2] * scale[2] + self.fixed[i];
            v += match e.process {
                None => 0.0,
                Some(Process::Markov { sigma, time_s }) => markov_variance(f, rate, sigma, time_s),
                Some(Process::Resonance { sigma, frequency_hz, time_s }) => {
                    resonance_variance(f, rate, sigma, frequency_hz, time_s)
                }
                Some(Process::Terms { n, b, k }) => {
                    let added = Claim { n, b, k, rate_hz: rate, ..Claim::default() };
                    added.mode_variance(f, [0.0; 3])
                }
                Some(Process::HalfPower { at_1_hz }) => at_1_hz / f.sqrt() * rate,
            };
            if e.lsb_arcsec > 0.0 {
                v += quantisation_variance(f, rate, e.lsb_arcsec);
            }
            v
        };
        self.parts.iter().enumerate().map(at).collect()
    }

    /// Weighted remains of `d` behind the columns under their priors, and the priors' price.
    fn remains(&self, d: &[f64], lambda: &[f64]) -> (Vec<f64>, f64) {
        let m = self.columns.len();
        if m == 0 {
            return (d.to_vec(), 0.0);
        }
        let weighted =
            |x: &[f64], y: &[f64]| x.iter().zip(y).zip(lambda).map(|((x, y), l)| x * y / l).sum::<f64>();
        let a = (0..m)
            .map(|i| {
                let of = |j: usize| {
                    let prior = if i == j { self.columns[i].1.powi(-2) } else { 0.0 };
                    weighted(&self.columns[i].0, &self.columns[j].0) + prior
                };
                (0..m).map(of).collect()
            })
            .collect();
        let b = (0..m).map(|i| weighted(&self.columns[i].0, d)).collect();
        let beta = solve(a, b);
        let mut r = d.to_vec();
        let mut price = 0.0;
        for ((column, sd), factor) in self.columns.iter().zip(&beta) {
            r.iter_mut().zip(column).for_each(|(r, c)| *r -= factor * c);
            price += 0.5 * (factor / sd).powi(2);
        }
        (r, price)
    }

    /// Least loss of the claim's family against modes of variance `v` and mean `d`.
    fn loss(&self, s: &Setting, v: &[f64], d: &[f64]) -> f64 {
        let u = &s.claim.uncertainty;
        let priors = [u.n_rel, u.b_rel, u.k_rel];
        let lambda = |t: &[f64; 3]| -> Vec<f64> {
            let scale = t.map(|r| (1.0 + r).powi(2));
            let of =
                |(p, fixed): (&[f64; 3], &f64)| p[0] * scale[0] + p[1] * scale[1] + p[2] * scale[2] + fixed;
            self.parts.iter().zip(&self.fixed).map(of).collect()
        };
        let evaluate = |t: &[f64; 3]| {
            let l = lambda(t);
            let (r, price) = self.remains(d, &l);
            let of = |((v, r), l): ((&f64, &f64), &f64)| 0.5 * ((v + r * r) / l - 1.0 - (v / l).ln());
            let sum: f64 = v.iter().zip(&r).zip(&l).map(of).sum();
            let prior: f64 = t.iter().zip(priors).map(|(t, p)| 0.5 * (t / p).powi(2)).sum();
            (sum + price + prior, l, r)
        };
        let mut at = [s.departure.n_rel, s.departure.b_rel, s.departure.k_rel];
        let mut best = evaluate(&at);
        for _ in 0..15 {
            let mut g: Vec<f64> = (0..3).map(|j| at[j] / priors[j].powi(2)).collect();
            let mut h = vec![vec![0.0; 3]; 3];
            (0..3).for_each(|j| h[j][j] = priors[j].powi(-2));
            for (i, p) in self.parts.iter().enumerate() {
                let (l, r) = (best.1[i], best.2[i]);
                let slope: [f64; 3] = std::array::from_fn(|j| 2.0 * p[j] * (1.0 + at[j]) / l);
                let excess = 1.0 - (v[i] + r * r) / l;
                for j in 0..3 {
                    g[j] += 0.5 * excess * slope[j];
                    (0..3).for_each(|m| h[j][m] += 0.5 * slope[j] * slope[m]);
                }
            }
            let step = solve(h, g);
            let mut share = 1.0;
            let before = best.0;
            for _ in 0..8 {
                let next: [f64; 3] = std::array::from_fn(|j| (at[j] - share * step[j]).max(-0.95));
                let tried = evaluate(&next);
                if tried.0 < best.0 {
                    (at, best) = (next, tried);
                    break;
                }
                share *= 0.4;
            }
            if before - best.0 < 1e-3 {
                break;
            }
        }
        best.0
    }

    /// Expected gain of log-likelihood by an effect.
    pub fn gain(&self, s: &Setting, effect: &Effect) -> f64 {
        if let Some(gain) = effect.own_gain {
            return gain - effect.cost;
        }
        let plain = self.truth(s, None);
        let with = self.truth(s, Some(effect));
        let mut mean = self.departed.clone();
        if !effect.course.is_empty() {
            let modes = cosine_modes(&effect.course);
            mean.iter_mut().zip(&modes[1..]).for_each(|(m, d)| *m += d);
        }
        self.loss(s, &with, &mean) - self.loss(s, &plain, &self.departed) - effect.cost
    }
}
