//! Noise of a unit at rest, beside its bias.

use super::case::{Simulated, Truth};
use super::noise_bands;
use super::rest::{N, Part, Rest};
use super::table::Bench;
use crate::bench::EARTH;
use crate::bench::noise_source::{NoiseSource, add, csv};
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

/// Steps a sample is cut into where a process is averaged over it.
const FINE: usize = 16;

impl Bench for Rest {
    fn simulated(&self, ids: &[String], seed: u64) -> Simulated {
        let mut source = NoiseSource::new(seed);
        let mut values = source.white(N, self.dt_s, self.samples);
        for part in &self.parts {
            add(&mut values, &self.drawn(part, &mut source));
        }
        // The site is declared with its uncertainty; the unit stands where it stands.
        let arcsec = PI / 180.0 / 3600.0;
        let (latitude, elevation) = (
            56f64.to_radians() + 10.0 * arcsec * source.normal(),
            60f64.to_radians() + 30.0 * arcsec * source.normal(),
        );
        // An axis towards north, raised by the elevation.
        let earth = EARTH * (latitude.cos() * elevation.cos() + latitude.sin() * elevation.sin());
        values.iter_mut().for_each(|v| *v += self.bias + earth);
        let mut truths = self.of_white();
        truths.extend(self.of_slow());
        truths.extend(noise_bands::truths(self));
        truths.extend(self.parts.iter().flat_map(|part| self.of_part(part)));
        truths.push(Truth::new("earth_rate_component", earth));
        Simulated { csv: csv("rate_deg_h", &[&values]), procedure: procedure(self.dt_s, ids), truths }
    }
}

impl Rest {
    fn drawn(&self, part: &Part, source: &mut NoiseSource) -> Vec<f64> {
        let (len, dt_s) = (self.samples, self.dt_s);
        match *part {
            Part::Flicker(b) => {
                let step = 2f64.ln() / 4.0;
                let sigma = b * (step / PI).sqrt();
                let (mut sum, mut tau_s) = (vec![0.0; len], 0.5 * dt_s);
                while tau_s < dt_s * len as f64 {
                    add(&mut sum, &source.markov(sigma, tau_s, dt_s, len));
                    tau_s *= step.exp();
                }
                sum
            }
            Part::Walk(k) => source.walk(k, dt_s, len),
            Part::Ramp(r) => {
                let middle = 0.5 * self.length_h();
                (0..len).map(|i| r * (i as f64 * dt_s / 3600.0 - middle)).collect()
            }
            Part::Quantized(q) => {
                let errors: Vec<f64> = (0..=len).map(|_| q * source.normal()).collect();
                errors.windows(2).map(|w| (w[1] - w[0]) / dt_s).collect()
            }
            Part::Line { amplitude, hz } => {
                let phase = source.uniform(0.0, TAU);
                (0..len).map(|i| amplitude * (TAU * hz * dt_s * i as f64 + phase).sin()).collect()
            }
            Part::Markov { sigma, tau_s } => {
                let fine = source.markov(sigma, tau_s, dt_s / FINE as f64, FINE * len);
                fine.chunks_exact(FINE).map(|c| c.iter().sum::<f64>() / FINE as f64).collect()
            }
            Part::Periodic { rms, hz, decay_s } => {
                let (a, b) = (source.markov(rms, decay_s, dt_s, len), source.markov(rms, decay_s, dt_s, len));
                let at = |i: usize| TAU * hz * dt_s * i as f64;
                (0..len).map(|i| a[i] * at(i).cos() + b[i] * at(i).sin()).collect()
            }
        }
    }

    fn length_h(&self) -> f64 {
        self.samples as f64 * self.dt_s / 3600.0
    }

    /// Size of the first part of a kind; none is nothing.
    fn size(&self, of: impl Fn(&Part) -> Option<f64>) -> f64 {
        self.parts.iter().find_map(of).unwrap_or(0.0)
    }

    fn walk(&self) -> f64 {
        self.size(|p| if let Part::Walk(k) = p { Some(*k) } else { None })
    }

    /// What white noise makes true, with a walk and a process beside it unless these are weak.
    fn of_white(&self) -> Vec<Truth> {
        let k = if self.weak { 0.0 } else { self.walk() };
        let hours = self.length_h();
        // E[s²] of n adjacent means over τ: N²/τ and K² n τ/6.
        let sigma = |window_s: f64| {
            let n = (self.samples as f64 * self.dt_s / window_s).floor();
            let tau_h = window_s / 3600.0;
            (N * N / tau_h + k * k * tau_h * n / 6.0).sqrt()
        };
        let (drift, short) =
            if k == 0.0 { (6.0 * N, 60.0 * N / 10f64.sqrt()) } else { (sigma(100.0), sigma(10.0)) };
        let russian = if k == 0.0 { N } else { 10f64.sqrt() / 60.0 * short };
        let of_mean = if k == 0.0 {
            1.96 * N / hours.sqrt()
        } else {
            1.96 * (N * N / hours + k * k * hours / 3.0).sqrt()
        };
        let of_n = 1.96 * N / (2.0 * self.samples as f64).sqrt();
        // What a short process adds lies below the frequencies of the walk of the angle.
        let power = self.size(|p| match p {
            Part::Markov { sigma, tau_s } => Some(2.0 * sigma * sigma * tau_s / 3600.0),
            _ => None,
        });
        let level = if power == 0.0 { N } else { (N * N + power).sqrt() };
        vec![
            Truth::new("static_bias", self.bias).oracle(of_mean),
            Truth::new("angle_random_walk", level).oracle(of_n),
            Truth::new("angle_random_walk_white", N).oracle(of_n),
            Truth::new("angle_random_walk_readout", N),
            Truth::new("russian_drift_100s", drift),
            Truth::new("russian_drift_100s_3sigma", 3.0 * drift),
            Truth::new("russian_sigma_10s", short),
            Truth::new("russian_arw_10s", russian),
            Truth::new("russian_drift_100s_predicted", drift),
            Truth::new("ratio_russian_to_allan_arw", russian / N),
        ]
    }

    /// The terms that are slower than white noise, and quantisation, by identification and by reading.
    fn of_slow(&self) -> Vec<Truth> {
        let k = self.walk();
        let b = self.size(|p| if let Part::Flicker(b) = p { Some(*b) } else { None });
        let r = self.size(|p| if let Part::Ramp(r) = p { Some(r.abs()) } else { None });
        let q = self.size(|p| if let Part::Quantized(q) = p { Some(*q) } else { None });
        vec![
            Truth::new("bias_instability", b),
            Truth::new("rate_random_walk", k),
            Truth::new("rate_ramp", r),
            Truth::new("quantization", q),
            Truth::new("rate_random_walk_readout", k),
            Truth::new("rate_ramp_readout", r),
            Truth::new("quantization_readout", q),
        ]
    }

    fn of_part(&self, part: &Part) -> Vec<Truth> {
        match *part {
            Part::Line { amplitude, hz } => {
                let samples = self.samples as f64;
                let sigma = 60.0 * N / self.dt_s.sqrt();
                let of_amplitude = 1.96 * sigma * (2.0 / samples).sqrt();
                let length_s = samples * self.dt_s;
                let of_frequency = 1.96 * 6f64.sqrt() / (PI * length_s) * sigma / amplitude / samples.sqrt();
                vec![
                    Truth::new("line_amplitude", amplitude).oracle(of_amplitude),
                    Truth::new("line_frequency", hz).oracle(of_frequency),
                ]
            }
            Part::Markov { sigma, tau_s } => {
                vec![Truth::new("markov_sigma", sigma), Truth::new("markov_correlation_time", tau_s)]
            }
            Part::Periodic { rms, hz, decay_s } => vec![
                Truth::new("quasi_periodic_amplitude", rms),
                Truth::new("quasi_periodic_frequency", hz),
                Truth::new("quasi_periodic_coherence_time", decay_s),
            ],
            Part::Flicker(_) | Part::Walk(_) | Part::Ramp(_) | Part::Quantized(_) => vec![],
        }
    }
}

fn procedure(dt_s: f64, ids: &[String]) -> String {
    let mut text = format!(
        "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n\
         [recording]\nsample_rate = \"{} Hz\"\n\
         [[channel]]\nid = \"rate\"\ncolumn = \"rate_deg_h\"\nrole = \"rate\"\nunit = \"deg/h\"\n\
         [site]\nlatitude = \"56 deg\"\nlatitude_uncertainty = \"10 arcsec\"\nelevation = \"60 deg\"\n\
         elevation_uncertainty = \"30 arcsec\"\nheading = \"0 deg\"\nheading_uncertainty = \"30 arcsec\"\n",
        1.0 / dt_s
    );
    text += &noise_bands::table(dt_s, ids);
    for id in ids {
        let earth = if *id == "static_bias" { "options.earth_rate = \"remove\"\n" } else { "" };
        // Writing to a text cannot fail.
        let _ = write!(text, "[[measurand]]\nid = \"{id}\"\n{earth}");
    }
    text
}
